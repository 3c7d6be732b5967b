//! Prints how punctually a drive answers a simulated cabinet over the loopback interface while a core
//! is kept busy and trajectories run, as a Markdown table with a list of what else was seen.
//!
//! ```text
//! realtime                 10 s at 5 ms, 10 s at 1 ms
//! realtime --full          10 minutes at 5 ms, 2 minutes at 1 ms, the same with ten subscribers, and
//!                          2 minutes of each without real-time priority for the drive
//! realtime --period 1 --seconds 60 [--subscribers] [--ordinary]
//! ```
//!
//! Cabinet, drive, subscribers and what keeps the core busy are processes of their own, as in use. Each
//! of them ends when its input does, so none is left over, however this one ends. On each core a witness
//! of a higher priority does nothing but wake: while it does not, the machine stands still.
//!
//! A cycle is lost by the drive if its answer came more than a period after its message, after the time
//! in which the machine stood still is taken off. Nothing else is: the times that the system, and the
//! cabinet's own threads, take to wake count against the drive. Exits with 1 if a drive with real-time
//! priority lost more than one cycle in 10 000, or if a live subscriber missed a message.
#![expect(clippy::print_stdout, reason = "a table is what it is for")]

use std::{
    env,
    io::{self, BufRead, BufReader, Write},
    net::SocketAddr,
    path::Path as FilePath,
    process::{Child, ChildStdin, Command, ExitCode, Stdio},
    sync::{
        Arc, Mutex, PoisonError,
        mpsc::{self, Receiver},
    },
    thread,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use iiwa_drive::{Cabinet, CabinetConfig, Drive, DriveConfig, LateAnswer};
use iiwa_kin::Robot;
use iiwa_link::{Client, Published, Remote, Server, Stream, TimedJoints};
use iiwa_path::{Blend, JointPath, Motion, Program, Ptp};
use iiwa_traj::{Timing, Trajectory};
use iiwasim_benches::{Result, machine};
use iiwasim_tests::ports::free_address;
use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// What is measured.
#[derive(Clone, Copy, Debug)]
struct Case {
    period_ms: u32,
    seconds: u64,
    /// Nine that follow the stream, and one that sleeps.
    subscribers: bool,
    /// The drive may not have real-time priority.
    ordinary: bool,
}

const fn case(period_ms: u32, seconds: u64) -> Case {
    Case { period_ms, seconds, subscribers: false, ordinary: false }
}

fn main() -> Result<ExitCode> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["--part", "cabinet", period_ms, sockets] => {
            be_cabinet(period_ms.parse()?, &serde_json::from_str(sockets)?)?;
        }
        ["--part", "drive", sockets] => be_drive(&serde_json::from_str(sockets)?)?,
        ["--part", "subscribers", at] => be_subscribers(at)?,
        ["--part", "busy"] => be_busy()?,
        ["--part", "witness"] => be_witness()?,
        [] => return report(&[case(5, 10), case(1, 10)]),
        ["--full"] => {
            return report(&[
                case(5, 600),
                case(1, 120),
                Case { subscribers: true, ..case(1, 120) },
                Case { ordinary: true, ..case(5, 120) },
                Case { ordinary: true, ..case(1, 120) },
                Case { ordinary: true, subscribers: true, ..case(1, 120) },
            ]);
        }
        ["--period", period_ms, "--seconds", seconds, options @ ..] => {
            let mut case = case(period_ms.parse()?, seconds.parse()?);
            for option in options {
                match *option {
                    "--subscribers" => case.subscribers = true,
                    "--ordinary" => case.ordinary = true,
                    _ => return Err(format!("no such option: {option}").into()),
                }
            }
            return report(&[case]);
        }
        _ => return Err("it takes nothing, --full, or --period MS --seconds S".into()),
    }
    Ok(ExitCode::SUCCESS)
}

fn report(cases: &[Case]) -> Result<ExitCode> {
    println!("On {}.\n", machine::processor());
    println!(
        "| period | time | subscribers | real time: cabinet, drive | messages | not answered in time \
         | of these lost by the drive | cabinet held up | median | 99.9 % | longest | trajectories |"
    );
    println!("|---:|---:|---|---|---:|---:|---:|---:|---:|---:|---:|---:|");
    let mut notes = Vec::new();
    let mut faults = Vec::new();
    for case in cases {
        let Some(measured) = measure(case)? else {
            notes
                .push("- `setpriv` cannot keep the drive from real-time priority here.".to_owned());
            continue;
        };
        print_row(case, &measured);
        note(case, &measured, &mut notes, &mut faults);
    }
    println!("\n{}", notes.join("\n"));
    if faults.is_empty() {
        return Ok(ExitCode::SUCCESS);
    }
    println!("\nNOT KEPT: {}", faults.join("; "));
    Ok(ExitCode::FAILURE)
}

fn print_row(case: &Case, measured: &Measured) {
    let Measured { cabinet, drive, runs, .. } = measured;
    let yes = |is| if is { "yes" } else { "no" };
    println!(
        "| {} ms | {} s | {} | {}, {} | {} | {} | {} | {} | {:.0} us | {:.0} us | {:.0} us | {} of {} |",
        case.period_ms,
        case.seconds,
        if case.subscribers { "10, one asleep" } else { "none" },
        yes(cabinet.real_time),
        yes(drive.real_time),
        cabinet.cycles,
        cabinet.late_us.len() as u64 + measured.never(),
        measured.lost(),
        cabinet.held_up,
        cabinet.latency_us[0],
        cabinet.latency_us[1],
        cabinet.latency_us[2],
        runs.done,
        runs.begun,
    );
}

/// One cycle in so many may be lost without a fault: a witness sees a standstill up to 0.25 ms after it has
/// begun, so that several in a row, at 1 ms, may leave a late answer unexplained.
const UNEXPLAINED: u64 = 10_000;

fn note(case: &Case, measured: &Measured, notes: &mut Vec<String>, faults: &mut Vec<String>) {
    let Measured { cabinet, drive, subscribers, runs, still } = measured;
    let name = format!("{} ms, {} s", case.period_ms, case.seconds);
    let mut say = |what: String| notes.push(format!("- {name}: {what}."));
    say(match still {
        None => "no witness: that takes real-time priority, `chrt` and `taskset`".to_owned(),
        Some(still) => {
            let longest_us = still.iter().map(|[from, to]| to - from).max().unwrap_or(0);
            let all_us: i64 = still.iter().map(|[from, to]| to - from).sum();
            format!(
                "the machine stood still {} times, {:.0} ms in all and {:.1} ms at most",
                still.len(),
                all_us as f64 * 1e-3,
                longest_us as f64 * 1e-3
            )
        }
    });
    say(format!(
        "{} messages reached the drive, which found the next one there already when it answered {} of them; \
         the longest that it took to answer was {:.0} us; its memory was {:.1} MB at the start and {:.1} MB \
         at most",
        drive.received, drive.behind, drive.slowest_us, drive.memory_mb[0], drive.memory_mb[1],
    ));
    if let Some(Subscribers { live, asleep }) = subscribers {
        let least = live.iter().map(|followed| followed.messages).min().unwrap_or(0);
        let missed: u64 = live.iter().map(|followed| followed.missed).sum();
        say(format!(
            "the live subscribers got {least} messages or more, and missed {missed} in all; the sleeper got {} \
             once awake, and had missed {}",
            asleep.messages, asleep.missed
        ));
        if missed > cabinet.cycles.saturating_sub(drive.received) {
            faults.push(format!("{name}: live subscribers missed {missed} messages"));
        }
    }
    if let Some([took, stood]) = measured.late_by_drive().max_by_key(|[took, stood]| took - stood) {
        say(format!(
            "the worst answer lost by the drive took {took} us, for {stood} us of which the machine stood still"
        ));
    }
    if runs.done < runs.begun {
        say(format!("a trajectory broke off: {}", runs.error));
    }
    if drive.real_time && measured.lost() * UNEXPLAINED > cabinet.cycles {
        faults.push(format!("{name}: the drive lost {} cycles", measured.lost()));
    }
}

/// What a case gave.
struct Measured {
    cabinet: CabinetSide,
    drive: DriveSide,
    subscribers: Option<Subscribers>,
    runs: Runs,
    /// When the machine stood still, in us; none without witnesses.
    still: Option<Vec<Section>>,
}

/// From when to when, in us of the system's clock.
type Section = [i64; 2];

impl Measured {
    /// Messages without any answer.
    fn never(&self) -> u64 {
        self.cabinet.cycles - self.cabinet.answered
    }

    /// Cycles lost by the drive: messages that have reached it, and were answered too late or never,
    /// though the machine went on.
    fn lost(&self) -> u64 {
        self.late_by_drive().count() as u64 + (self.drive.received - self.drive.answered)
    }

    /// Late answers that no standstill explains: how long they took, and for how much of it the machine
    /// stood still, in us.
    fn late_by_drive(&self) -> impl Iterator<Item = [i64; 2]> {
        let still = self.still.as_deref().unwrap_or_default();
        let period_us = 1000 * i64::from(self.cabinet.period_ms);
        self.cabinet.late_us.iter().filter_map(move |late| {
            let overlap = |[from, to]: &Section| late.answered.min(*to) - late.sent.max(*from);
            let stood: i64 = still.iter().map(|section| overlap(section).max(0)).sum();
            let took = late.answered - late.sent;
            (took - stood > period_us).then_some([took, stood])
        })
    }
}

/// Where the parts meet.
#[derive(Clone, Deserialize, Serialize)]
struct Sockets {
    fri: SocketAddr,
    instructions: String,
    stream: String,
    cabinet_instructions: String,
    cabinet_state: String,
}

impl Sockets {
    fn free() -> Self {
        let tcp = || format!("tcp://{}", free_address());
        Self {
            fri: free_address(),
            instructions: tcp(),
            stream: tcp(),
            cabinet_instructions: tcp(),
            cabinet_state: tcp(),
        }
    }
}

/// None if the drive cannot be kept from real-time priority.
fn measure(case: &Case) -> Result<Option<Measured>> {
    // As root has it without this capability: like anybody else.
    const ORDINARY: [&str; 2] = ["--bounding-set=-sys_nice", "--inh-caps=-sys_nice"];
    let sockets = Sockets::free();
    let text = serde_json::to_string(&sockets)?;
    let this = env::current_exe()?;
    let _busy = Part::start(Command::new(&this).args(["--part", "busy"]))?;
    let witnesses = witnesses(&this)?;
    let mut drive = if case.ordinary { Command::new("setpriv") } else { Command::new(&this) };
    if case.ordinary {
        drive.args(ORDINARY).arg(&this);
    }
    let drive = Part::start(drive.args(["--part", "drive", &text]));
    let mut drive = match drive {
        Err(_) if case.ordinary => return Ok(None),
        drive => drive?,
    };
    let mut subscribers = None;
    if case.subscribers {
        let mut command = Command::new(&this);
        subscribers = Some(Part::start(command.args(["--part", "subscribers", &sockets.stream]))?);
    }
    // The controller comes last: each of its messages counts, from the first one on.
    let period = case.period_ms.to_string();
    let mut cabinet = Part::start(Command::new(&this).args(["--part", "cabinet", &period, &text]))?;
    let runs = run_trajectories(&sockets, Duration::from_secs(case.seconds))?;
    let cabinet = cabinet.ask()?;
    let drive = drive.ask()?;
    let subscribers = subscribers.map(|mut part| part.ask()).transpose()?;
    let mut still = None;
    if let Some(mut witnesses) = witnesses {
        let sections: Vec<Vec<Section>> =
            witnesses.iter_mut().map(Part::ask).collect::<Result<_>>()?;
        still = Some(joined(sections.concat()));
    }
    Ok(Some(Measured { cabinet, drive, subscribers, runs, still }))
}

/// Sections without those that overlap.
fn joined(mut sections: Vec<Section>) -> Vec<Section> {
    sections.sort_unstable();
    let mut joined: Vec<Section> = Vec::new();
    for [from, to] in sections {
        match joined.last_mut() {
            Some(last) if last[1] >= from => last[1] = last[1].max(to),
            _ => joined.push([from, to]),
        }
    }
    joined
}

/// One on each core; none where that is not permitted.
fn witnesses(this: &FilePath) -> Result<Option<Vec<Part>>> {
    // Above the drive's and the cabinet's.
    const PRIORITY: &str = "60";
    let cores = thread::available_parallelism()?.get();
    let on = |core: usize| {
        let mut command = Command::new("chrt");
        command.args(["--fifo", PRIORITY, "taskset", "--cpu-list", &core.to_string()]);
        Part::start(command.arg(this).args(["--part", "witness"]).stderr(Stdio::null()))
    };
    Ok((0..cores).map(on).collect::<Result<Vec<_>>>().ok())
}

/// A process of this program.
struct Part {
    process: Child,
    /// Closed, it ends.
    input: Option<ChildStdin>,
    lines: Receiver<String>,
}

/// How long a part may take to say something.
const ANSWERED_WITHIN: Duration = Duration::from_secs(15);

impl Part {
    /// Runs until it is ready.
    fn start(command: &mut Command) -> Result<Self> {
        let mut process = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let input = process.stdin.take();
        let output = process.stdout.take().ok_or("no output")?;
        let (tell, lines) = mpsc::channel();
        thread::spawn(move || {
            let lines = BufReader::new(output).lines().map_while(io::Result::ok);
            lines.for_each(|line| drop(tell.send(line)));
        });
        let part = Self { process, input, lines };
        part.line()?;
        Ok(part)
    }

    fn line(&self) -> Result<String> {
        let line = self.lines.recv_timeout(ANSWERED_WITHIN);
        line.map_err(|_| "a part of the bench says nothing; see what it wrote above".into())
    }

    /// Its report.
    fn ask<T: DeserializeOwned>(&mut self) -> Result<T> {
        writeln!(self.input.as_mut().ok_or("no input")?)?;
        Ok(serde_json::from_str(&self.line()?)?)
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        self.input = None;
        let since = Instant::now();
        while since.elapsed() < Duration::from_secs(3) {
            if matches!(self.process.try_wait(), Ok(Some(_))) {
                return;
            }
            thread::sleep(Duration::from_millis(10));
        }
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Says that this part is ready, and what `report` gives to each line that comes in, until there are no more.
fn serve<T: Serialize>(mut report: impl FnMut() -> T) -> Result<()> {
    println!();
    for line in io::stdin().lines() {
        line?;
        println!("{}", serde_json::to_string(&report())?);
    }
    Ok(())
}

/// What the controller sees.
#[derive(Deserialize, Serialize)]
struct CabinetSide {
    period_ms: u32,
    cycles: u64,
    answered: u64,
    late_us: Vec<Answer>,
    held_up: u64,
    real_time: bool,
    /// Median, 99.9 % and longest.
    latency_us: [f64; 3],
}

/// A late answer, in us of the system's clock.
#[derive(Deserialize, Serialize)]
struct Answer {
    sent: i64,
    answered: i64,
}

/// The system's clock, which all processes share.
struct SystemClock {
    now: Instant,
    now_us: i64,
}

impl SystemClock {
    fn new() -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Self { now: Instant::now(), now_us: micros(since) }
    }

    fn us(&self, at: Instant) -> i64 {
        let ahead = at.saturating_duration_since(self.now);
        self.now_us + micros(ahead) - micros(self.now.saturating_duration_since(at))
    }
}

fn micros(time: Duration) -> i64 {
    i64::try_from(time.as_micros()).unwrap_or(i64::MAX)
}

fn be_cabinet(period_ms: u32, sockets: &Sockets) -> Result<()> {
    let config = CabinetConfig {
        period_ms,
        fri_client: sockets.fri,
        instructions: sockets.cabinet_instructions.clone(),
        state: sockets.cabinet_state.clone(),
        ..CabinetConfig::default()
    };
    let cabinet = Cabinet::start(config, &Server::open())?;
    serve(|| {
        let mut report = cabinet.report();
        // One answer may be on its way.
        for _ in 0..10 {
            if report.cycles == report.latency.count() as u64 {
                break;
            }
            thread::sleep(Duration::from_micros(300));
            report = cabinet.report();
        }
        let latency_us = [0.5, 0.999, 1.0].map(|share| {
            report.latency.quantile(share).map_or(f64::NAN, |time| 1e6 * time.as_secs_f64())
        });
        let clock = SystemClock::new();
        let late = report.late.iter();
        let late_us = late.map(|LateAnswer { sent, answered }| Answer {
            sent: clock.us(*sent),
            answered: clock.us(*answered),
        });
        let late_us = late_us.collect();
        CabinetSide {
            period_ms,
            cycles: report.cycles,
            answered: report.latency.count() as u64,
            late_us,
            held_up: report.delayed_cycles,
            real_time: report.real_time,
            latency_us,
        }
    })
}

/// What the drive says of itself.
#[derive(Deserialize, Serialize)]
struct DriveSide {
    received: u64,
    answered: u64,
    behind: u64,
    slowest_us: f64,
    real_time: bool,
    /// Once started, and at most.
    memory_mb: [f64; 2],
}

fn be_drive(sockets: &Sockets) -> Result<()> {
    let config = DriveConfig {
        instructions: sockets.instructions.clone(),
        stream: sockets.stream.clone(),
        fri: sockets.fri,
        cabinet_instructions: sockets.cabinet_instructions.clone(),
        cabinet_state: sockets.cabinet_state.clone(),
        ..DriveConfig::default()
    };
    let drive = Drive::start(config, &Server::open(), &Remote::open())?;
    let start_mb = machine::peak_memory_mb()?;
    serve(|| {
        let mut answer_latency = drive.answer_latency();
        // One message may be in its hands.
        for _ in 0..10 {
            if answer_latency.received == answer_latency.answered {
                break;
            }
            thread::sleep(Duration::from_micros(300));
            answer_latency = drive.answer_latency();
        }
        DriveSide {
            received: answer_latency.received,
            answered: answer_latency.answered,
            behind: answer_latency.behind,
            slowest_us: 1e6 * answer_latency.slowest.as_secs_f64(),
            real_time: answer_latency.real_time,
            memory_mb: [start_mb, machine::peak_memory_mb().unwrap_or(f64::NAN)],
        }
    })
}

/// What a subscriber got, and what it missed between the first message and the last.
#[derive(Clone, Copy, Default, Deserialize, Serialize)]
struct Followed {
    messages: u64,
    missed: u64,
    last_s: Option<f64>,
}

impl Followed {
    /// A message at 1 ms.
    fn take(&mut self, t_s: f64) {
        if let Some(last_s) = self.last_s {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "saturates"
            )]
            let steps = ((t_s - last_s) * 1e3).round() as u64;
            self.missed += steps.saturating_sub(1);
        }
        self.messages += 1;
        self.last_s = Some(t_s);
    }
}

#[derive(Deserialize, Serialize)]
struct Subscribers {
    live: [Followed; LIVE],
    asleep: Followed,
}

const LIVE: usize = 9;

fn be_subscribers(at: &str) -> Result<()> {
    let sleeper = Sleeper::new(at)?;
    let live = Arc::new(Mutex::new([Followed::default(); LIVE]));
    let remote = Remote::open();
    for i in 0..LIVE {
        let mut stream = Stream::new(&remote, at)?;
        let live = Arc::clone(&live);
        thread::spawn(move || {
            while let Ok(published) = stream.next(Duration::from_secs(1)) {
                if let Some(Published::Joints { t_s, .. }) = published {
                    live.lock().unwrap_or_else(PoisonError::into_inner)[i].take(t_s);
                }
            }
        });
    }
    // Connections take a moment.
    thread::sleep(Duration::from_millis(500));
    serve(|| {
        let asleep = sleeper.wake();
        Subscribers { live: *live.lock().unwrap_or_else(PoisonError::into_inner), asleep }
    })
}

/// A subscriber that takes nothing until it is woken.
struct Sleeper {
    socket: zmq::Socket,
}

impl Sleeper {
    fn new(at: &str) -> Result<Self> {
        let socket = zmq::Context::new().socket(zmq::SUB)?;
        // It keeps next to nothing by itself.
        socket.set_rcvhwm(1)?;
        socket.set_rcvbuf(4096)?;
        socket.set_subscribe(b"joints")?;
        socket.connect(at)?;
        Ok(Self { socket })
    }

    /// Takes what there is for a second: what has waited, and what is published now.
    fn wake(&self) -> Followed {
        #[derive(Deserialize)]
        struct Stamp {
            t_s: f64,
        }
        let mut followed = Followed::default();
        let since = Instant::now();
        while since.elapsed() < Duration::from_secs(1) {
            if matches!(self.socket.poll(zmq::POLLIN, 100), Ok(1..))
                && let Ok(frames) = self.socket.recv_multipart(zmq::DONTWAIT)
                && let Some(Ok(Stamp { t_s })) =
                    frames.get(1).map(|body| serde_json::from_slice(body))
            {
                followed.take(t_s);
            }
        }
        followed
    }
}

/// Keeps a core busy at ordinary priority.
fn be_busy() -> Result<()> {
    thread::spawn(|| {
        loop {
            std::hint::spin_loop();
        }
    });
    serve(|| ())
}

/// Wakes again and again, and tells when it could not, in us of the system's clock.
fn be_witness() -> Result<()> {
    const EVERY: Duration = Duration::from_micros(250);
    /// So late it does not wake for other reasons.
    const STILL: Duration = Duration::from_micros(100);
    let still = Arc::new(Mutex::new(Vec::new()));
    let seen = Arc::clone(&still);
    thread::spawn(move || {
        let mut due = Instant::now() + EVERY;
        loop {
            thread::sleep(due.saturating_duration_since(Instant::now()));
            let awake = Instant::now();
            if awake.duration_since(due) > STILL {
                let clock = SystemClock::new();
                let section: Section = [clock.us(due), clock.us(awake)];
                seen.lock().unwrap_or_else(PoisonError::into_inner).push(section);
                due = awake;
            }
            due += EVERY;
        }
    });
    serve(|| still.lock().unwrap_or_else(PoisonError::into_inner).clone())
}

/// Trajectories, set-point by set-point.
#[derive(Default)]
struct Runs {
    begun: u64,
    done: u64,
    /// Why the last one of those broke off that did.
    error: String,
}

/// Runs trajectories for so long, with a second between them.
fn run_trajectories(sockets: &Sockets, time: Duration) -> Result<Runs> {
    let end = Instant::now() + time;
    let pause = Duration::from_secs(1);
    let trajectory = there_and_back()?;
    let takes = Duration::from_secs_f64(trajectory.duration_s());
    let mut client = Client::new(&Remote::open(), &sockets.instructions)?;
    let mut runs = Runs::default();
    loop {
        let left = end.saturating_duration_since(Instant::now());
        // One that begins is to end in time.
        if left < pause + takes + pause {
            thread::sleep(left);
            return Ok(runs);
        }
        thread::sleep(pause);
        runs.begun += 1;
        match client.run_trajectory(trajectory.clone(), Some(takes + Duration::from_secs(10))) {
            Ok(_) => runs.done += 1,
            Err(error) => {
                runs.error = error.to_string();
                go_back(&mut client, end);
            }
        }
    }
}

/// To where trajectories begin, as soon as the robot can.
fn go_back(client: &mut Client, end: Instant) {
    while Instant::now() + Duration::from_secs(5) < end {
        let back = vec![Motion::Ptp(Ptp::to([0.0; 7]))];
        if client.run_motions(back, Some(Duration::from_secs(10))).is_ok() {
            return;
        }
        thread::sleep(Duration::from_millis(100));
    }
}

/// A trajectory that ends where it begins, in stamps 4 ms apart.
fn there_and_back() -> Result<TimedJoints> {
    const STEP_S: f64 = 0.004;
    let to = |deg: [f64; 7]| Ptp::to(deg.map(f64::to_radians));
    let motions = vec![
        Motion::Ptp(to([40.0, 30.0, 0.0, -60.0, 0.0, 40.0, 0.0]).blend(Blend::Fraction(0.25))),
        Motion::Ptp(to([-40.0, 20.0, 10.0, -80.0, 20.0, 50.0, 90.0])),
        Motion::Ptp(to([0.0; 7])),
    ];
    let program = Program { robot: None, start_rad: [0.0; 7], motions };
    let path = JointPath::new(&program, &Robot::default())?;
    let plan = Trajectory::plan(&path, Timing::default())?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some thousands")]
    let count = (plan.cycle_time_s() / STEP_S).ceil() as u32;
    let t_s: Vec<f64> =
        (0..=count).map(|i| (f64::from(i) * STEP_S).min(plan.cycle_time_s())).collect();
    let joints_rad = t_s.iter().map(|t_s| plan.at(*t_s).q).collect();
    Ok(TimedJoints { t_s, joints_rad })
}
