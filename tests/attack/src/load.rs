//! Stops under attack: the latency of replies once the arm is at rest, and the memory and logs of
//! the programs.

use std::{
    fs,
    io::Write,
    path::Path,
    thread,
    time::{Duration, Instant},
};

use fastrand::Rng;

use super::{
    attackers::{Attack, Kind, Size, trajectory},
    deadlines::scaled,
    output::print,
    process::Process,
    report::Row,
    rig::{Fault, Parts, Rig},
    tasks::there_and_back,
    usage::Usage,
    websocket::WebSocket,
};
use iiwasim_tests::zmtp::{HANDSHAKE_TIMEOUT, Peer, subscription};

/// Deadline of the reply to a stop after the arm is at rest.
const REPLY_DEADLINE: Duration = Duration::from_millis(300);

/// Time-out of a stop.
const STOP_TIMEOUT: Duration = Duration::from_secs(10);

/// Extent of the attacks.
pub(super) struct LoadExtent {
    pub(super) size: Size,
    /// Duration of each kind of attack.
    pub(super) time: Duration,
    /// Duration of all kinds together.
    pub(super) together: Duration,
    /// Single scenario to run, unless all are requested.
    pub(super) only: Option<Scenario>,
}

/// Scenario that can run alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scenario {
    /// Clients with many pending requests.
    Pipelines,
    /// A long request that arrives byte by byte.
    Trickle,
    /// Many handshakes per second.
    Handshakes,
    /// Many subscribers.
    Subscribers,
    /// Silent connections to programs with a low limit of open files.
    Descriptors,
}

impl Scenario {
    /// Returns the scenario of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "pipelines" => Self::Pipelines,
            "trickle" => Self::Trickle,
            "handshakes" => Self::Handshakes,
            "subscribers" => Self::Subscribers,
            "descriptors" => Self::Descriptors,
            _ => return None,
        })
    }

    fn flood(self, extent: &LoadExtent) -> Flood {
        let kind = match self {
            Self::Pipelines => Kind::Pipelines,
            Self::Trickle => Kind::Trickle,
            Self::Handshakes => Kind::Handshakes,
            Self::Subscribers => Kind::Subscribers,
            Self::Descriptors => Kind::SilentConnections,
        };
        let mut flood = Flood::of_kind(kind, extent);
        if self == Self::Descriptors {
            flood.name += " to programs with few files";
            flood.few_files = true;
        }
        flood
    }
}

/// Runs attacks of each kind, and all of them together.
pub(super) fn run(
    binary: &Path,
    seed: u64,
    keys: bool,
    extent: &LoadExtent,
) -> Result<Vec<Row>, Fault> {
    let mut random = Rng::with_seed(seed);
    let mut rows = Vec::new();
    for Flood { mut name, kinds, time, few_files } in Flood::all(extent) {
        if keys {
            name += ", with keys";
        }
        // Restarts the programs, so that attacks do not affect each other.
        let mut rig = Rig::start(binary, Parts { twin: true, keys, few_files })?;
        let mut phase = LoadPhase { rig: &mut rig, random: random.fork(), name: &name };
        rows.extend(phase.run(&kinds, &extent.size, time)?);
    }
    Ok(rows)
}

/// Attackers during which stops are tried.
struct Flood {
    name: String,
    kinds: Vec<Kind>,
    time: Duration,
    few_files: bool,
}

impl Flood {
    fn new(name: &str, kinds: &[Kind], time: Duration) -> Self {
        Self { name: name.to_owned(), kinds: kinds.to_vec(), time, few_files: false }
    }

    fn of_kind(kind: Kind, extent: &LoadExtent) -> Self {
        Self::new(&kind.name(&extent.size), &[kind], extent.time)
    }

    fn all(extent: &LoadExtent) -> Vec<Self> {
        if let Some(scenario) = extent.only {
            return vec![scenario.flood(extent)];
        }
        let nothing = Self::new("nothing", &[], extent.time);
        let each = Kind::ALL.map(|kind| Self::of_kind(kind, extent));
        let few_files = Scenario::Descriptors.flood(extent);
        let together = Self::new("all of them", &Kind::ALL, extent.together);
        [nothing].into_iter().chain(each).chain([few_files, together]).collect()
    }
}

/// Stops under attacks of certain kinds.
struct LoadPhase<'a> {
    rig: &'a mut Rig,
    random: Rng,
    name: &'a str,
}

/// Statistics of one kind of stop.
#[derive(Default)]
struct Stops {
    count: usize,
    failed: usize,
    worst: Duration,
}

impl LoadPhase<'_> {
    fn run(&mut self, kinds: &[Kind], size: &Size, time: Duration) -> Result<Vec<Row>, Fault> {
        let name = self.name;
        let mut rows = Vec::new();
        let page = self.rig.open_page();
        let usage = Usage::begin(self.rig);
        // Attacks that exhaust quotas start last.
        let attacks: Vec<Attack> =
            kinds.iter().rev().map(|kind| kind.start(&self.rig.addresses, size)).collect();
        // Waits until the attack has full effect.
        thread::sleep(Duration::from_secs(1));
        if kinds.iter().all(|kind| kind.is_subscriber()) {
            let attempts = self.attempt_trajectory()?;
            rows.push(Row {
                quantity: format!("a trajectory beside {name}"),
                required: "complete".to_owned(),
                measured: match attempts {
                    Some(1) => "complete".to_owned(),
                    Some(attempts) => format!("complete at attempt {attempts}"),
                    None => "aborted".to_owned(),
                },
                met: attempts.is_some(),
            });
        }
        if kinds == [Kind::Trickle] {
            rows.push(self.long_request()?);
        }
        if kinds == [Kind::Subscribers] && !self.rig.has_keys() {
            rows.push(self.stream()?);
        }
        let mut stops = [Stops::default(), Stops::default()];
        let mut page = page.inspect_err(|error| print(&format!("beside {name}: {error}"))).ok();
        let mut begun = 0;
        while usage.elapsed() < time || stops[1].count == 0 {
            let mut run = self.start_run()?;
            let since = Instant::now();
            if self.rig.witness.await_move(since, Duration::from_secs(2)).is_some() {
                begun += 1;
                thread::sleep(Duration::from_secs_f64(0.1 + 0.3 * self.random.f64()));
            }
            let by_page = stops[0].count > stops[1].count;
            let begin = Instant::now();
            let result = if by_page { press(page.as_mut()) } else { self.command_stop()? };
            let end = Instant::now();
            let (end, well) = match result {
                Ok(end) => (end, true),
                Err(why) => {
                    let by = if by_page { "the twin's button" } else { "`iiwasim stop`" };
                    let after = (end - begin).as_secs_f64();
                    print(&format!("beside {name}: {by} failed after {after:.2} s: {why}"));
                    (end, false)
                }
            };
            let rest = self.rig.witness.last_move_before(end).map_or(begin, |rest| rest.max(begin));
            let stop = &mut stops[usize::from(by_page)];
            stop.count += 1;
            stop.failed += usize::from(!well);
            stop.worst = stop.worst.max(end - rest);
            if run.wait(Duration::from_secs(2)).is_none() {
                run.kill();
            }
            self.rig.witness.await_rest(Duration::from_secs(10));
        }
        rows.push(stops_row(name, &stops, begun));
        rows.push(usage.row(name, self.rig));
        drop(attacks);
        Ok(rows)
    }

    /// Measures a long request beside others: a trajectory that is rejected because it starts
    /// elsewhere.
    fn long_request(&self) -> Result<Row, Fault> {
        const DEADLINE: Duration = Duration::from_secs(5);
        let begin = Instant::now();
        let body = String::from_utf8(trajectory(1_000_000))?;
        // Without keys, a direct request is simplest.
        let reply = if self.rig.has_keys() { None } else { Some(self.rig.request(&body)) };
        let took = begin.elapsed();
        Ok(Row {
            quantity: format!("a request of 1 MB beside {}", self.name),
            required: format!("answered within {} s", scaled(DEADLINE).as_secs()),
            measured: match &reply {
                None => "not tried with keys".to_owned(),
                Some(Ok(_)) => format!("{:.2} s", took.as_secs_f64()),
                Some(Err(error)) => error.to_string(),
            },
            met: reply.is_none_or(|reply| reply.is_ok()) && took <= scaled(DEADLINE),
        })
    }

    /// Counts the messages that a new subscriber receives.
    fn stream(&self) -> Result<Row, Fault> {
        const TIME: Duration = Duration::from_secs(1);
        let mut peer = Peer::connect(self.rig.addresses.stream, "SUB", HANDSHAKE_TIMEOUT)?;
        peer.stream.write_all(&subscription(b"joints"))?;
        let begin = Instant::now();
        let mut count = 0;
        while begin.elapsed() < TIME && peer.receive(scaled(TIME)).is_ok() {
            count += 1;
        }
        Ok(Row {
            quantity: format!("stream beside {}", self.name),
            required: "10 messages within 1 s".to_owned(),
            measured: format!("{count} messages"),
            met: count >= 10,
        })
    }

    /// Returns the time at which `iiwasim stop` succeeded, or the reason for its failure.
    fn command_stop(&self) -> Result<Result<Instant, String>, Fault> {
        let mut stop = self.rig.client(&["stop"], false)?;
        Ok(match stop.wait(STOP_TIMEOUT) {
            Some(ended) if ended.success => Ok(ended.instant),
            Some(_) => Err(stop.stderr().trim().to_owned()),
            None => Err("it has not ended in time".to_owned()),
        })
    }

    fn start_run(&self) -> Result<Process, Fault> {
        let file = self.write_program()?;
        self.rig.client(&["run", file.as_str(), "--no-output"], true)
    }

    /// Returns the number of attempts until a trajectory succeeds. The machine may delay the
    /// controller's clock or the drive once; an attack that aborts a trajectory aborts all
    /// attempts.
    fn attempt_trajectory(&mut self) -> Result<Option<u32>, Fault> {
        for attempt in 1..=3 {
            if self.run_trajectory()? {
                return Ok(Some(attempt));
            }
        }
        Ok(None)
    }

    /// Returns true if a trajectory succeeds.
    fn run_trajectory(&mut self) -> Result<bool, Fault> {
        // FRI may have been disturbed briefly.
        if let Err(fault) = self.rig.await_ready() {
            print(&format!("beside {}: {fault}", self.name));
            return Ok(false);
        }
        let file = self.write_program()?;
        let mut run =
            self.rig.client(&["run", file.as_str(), "--no-output", "--as-trajectory"], true)?;
        let well = run.wait(Duration::from_secs(15)).is_some_and(|ended| ended.success);
        if !well {
            print(run.stderr().trim());
        }
        Ok(well)
    }

    fn write_program(&self) -> Result<String, Fault> {
        let from = self.rig.witness.position().ok_or("the witness has not seen the arm")?;
        let file = self.rig.folder.path().join("program.json");
        fs::write(&file, there_and_back(&from, Duration::from_secs(3)))?;
        Ok(file.display().to_string())
    }
}

/// Returns the time at which the twin reported the stop, or the reason for its failure.
fn press(page: Option<&mut WebSocket>) -> Result<Instant, String> {
    let page = page.ok_or("the page is not open")?;
    match page.stop(STOP_TIMEOUT) {
        Ok((end, None)) => Ok(end),
        Ok((_, Some(why))) => Err(why),
        Err(error) => Err(error.to_string()),
    }
}

fn stops_row(name: &str, stops: &[Stops; 2], begun: usize) -> Row {
    let text = |Stops { count, failed, worst }: &Stops| {
        format!("{:.2} s at worst of {count}, {failed} failed", worst.as_secs_f64())
    };
    let [command, button] = stops;
    Row {
        quantity: format!("stop beside {name}"),
        required: format!("answered within {:.1} s of rest", scaled(REPLY_DEADLINE).as_secs_f64()),
        measured: format!(
            "command: {}; twin's button: {}; {begun} motions begun",
            text(command),
            text(button)
        ),
        met: stops.iter().all(|stops| stops.failed == 0 && stops.worst <= scaled(REPLY_DEADLINE)),
    }
}
