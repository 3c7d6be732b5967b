//! Single attempt to make the arm move after a stop.

use std::{
    fs, thread,
    time::{Duration, Instant},
};

use fastrand::Rng;

use super::{
    deadlines::scaled,
    process::Process,
    request::{PendingRequest, is_ok, request},
    rig::{Fault, Rig},
    tasks::{Task, program},
};

/// Time after a reply within which motion is due to a message in transit.
const IN_FLIGHT: Duration = Duration::from_millis(50);

/// Time after a stop request within which motion cannot be prevented, as `iiwasim stop` must start
/// first.
const STOP_LATENCY: Duration = Duration::from_millis(100);

/// Time after the loss of a client or drive within which motion cannot be prevented.
const LOSS_LATENCY: Duration = Duration::from_millis(250);

/// Deadline of the reply to a stop: half a second, and half a second to brake.
const REPLY_DEADLINE: Duration = Duration::from_secs(1);

/// Deadline of the reply to a stop without a cabinet, which may be an error.
const REPLY_DEADLINE_WITHOUT_CABINET: Duration = Duration::from_secs(6);

/// Time-out of a stop.
const STOP_TIMEOUT: Duration = Duration::from_secs(8);

/// Phase of a run in which an attempt is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Phase {
    Request,
    Planning,
    Start,
    Motion,
    End,
}

/// Attempt to make the arm move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Attempt {
    /// Raw stop request.
    StopRequest(Phase),
    /// `iiwasim stop`.
    StopCommand(Phase),
    /// SIGINT to `iiwasim run` before its request, while the cabinet plans its motions, or while
    /// the arm moves.
    Interrupt(Phase),
    /// Connection of a run closed before the arm moves.
    ConnectionClosed,
    /// `iiwasim run` killed before the arm moves.
    ClientKilled,
    /// Drive ended by a signal before the arm moves.
    DriveEnded(&'static str),
    /// Cabinet killed and restarted, with a stop meanwhile.
    CabinetKilled,
}

impl Attempt {
    /// All attempts.
    pub(super) const ALL: [Self; 18] = {
        use Attempt::{
            CabinetKilled, ClientKilled, ConnectionClosed, DriveEnded, Interrupt, StopCommand,
            StopRequest,
        };
        use Phase::{End, Motion, Planning, Request, Start};
        [
            StopRequest(Planning),
            StopCommand(Planning),
            StopRequest(Request),
            StopCommand(Request),
            Interrupt(Planning),
            ConnectionClosed,
            ClientKilled,
            DriveEnded("INT"),
            DriveEnded("KILL"),
            StopRequest(Start),
            StopCommand(Start),
            StopRequest(Motion),
            StopCommand(Motion),
            StopRequest(End),
            StopCommand(End),
            Interrupt(Request),
            Interrupt(Motion),
            CabinetKilled,
        ]
    };

    /// Name in the table.
    pub(super) fn name(self) -> String {
        let phase = |phase| match phase {
            Phase::Request => "the request is in transit",
            Phase::Planning => "motions are planned",
            Phase::Start => "the arm starts",
            Phase::Motion => "the arm moves",
            Phase::End => "the arm comes to its end",
        };
        match self {
            Self::StopRequest(instant) => format!("stop request while {}", phase(instant)),
            Self::StopCommand(instant) => format!("`iiwasim stop` while {}", phase(instant)),
            Self::Interrupt(Phase::Request) => "Ctrl-C as `run` starts".to_owned(),
            Self::Interrupt(instant) => format!("Ctrl-C to `run` while {}", phase(instant)),
            Self::ConnectionClosed => "client's connection lost before motion".to_owned(),
            Self::ClientKilled => "`iiwasim run` killed before motion".to_owned(),
            Self::DriveEnded(signal) => format!("drive ended by SIG{signal} before motion"),
            Self::CabinetKilled => "cabinet killed and restarted".to_owned(),
        }
    }
}

/// Outcome of an attempt.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Outcome {
    /// Latency of the reply.
    pub(super) reply: Option<Duration>,
    /// `true` if the reply was late, an error, or missing.
    pub(super) unanswered: bool,
    /// Time from the reply, or the loss, to the first motion.
    pub(super) moved_after: Option<Duration>,
    /// `true` if the arm moved before the attempt.
    pub(super) is_void: bool,
}

/// Time from a request to the motion, in s, with one and with [`MEASURED`] motions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planning {
    least_s: [f64; 2],
    most_s: [f64; 2],
}

/// Number of motions for measuring the planning time.
const MEASURED: u32 = 200;

impl Planning {
    /// Measures the planning time repeatedly on this machine, which may have other load.
    pub(super) fn measure(rig: &mut Rig, random: &mut Rng) -> Result<Self, Fault> {
        let mut planning = Self { least_s: [f64::INFINITY; 2], most_s: [0.0; 2] };
        for _ in 0..3 {
            for (kind, count) in [1, MEASURED].into_iter().enumerate() {
                rig.await_idle()?;
                let task = Task::motions(random, count as usize);
                let since = Instant::now();
                let _run = PendingRequest::send(rig.addresses.requests, &task.request())?;
                let start = rig
                    .witness
                    .await_move(since, Duration::from_secs(30))
                    .ok_or("the arm does not start")?;
                let time_s = (start - since).as_secs_f64();
                planning.least_s[kind] = planning.least_s[kind].min(time_s);
                planning.most_s[kind] = planning.most_s[kind].max(time_s);
            }
        }
        Ok(planning)
    }

    fn each_s([one_s, long_s]: [f64; 2]) -> f64 {
        ((long_s - one_s) / f64::from(MEASURED)).max(1e-5)
    }

    /// Expected time for a number of motions, in s, on a machine without other load.
    fn expected_s(self, count: usize) -> f64 {
        self.least_s[0] + Self::each_s(self.least_s) * count as f64
    }

    /// Maximum time for a number of motions on a machine with other load.
    fn at_most(self, count: usize) -> Duration {
        let time_s = self.most_s[0] + Self::each_s(self.most_s) * count as f64;
        Duration::from_secs_f64(1.5 * time_s + 0.2)
    }

    /// Returns the number of motions that are planned in a time, in s.
    fn count(self, time_s: f64) -> usize {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        let count = ((time_s - self.least_s[0]) / Self::each_s(self.least_s)).max(1.0) as usize;
        count.min(MAX_MOTIONS)
    }
}

/// Largest number of motions per request.
const MAX_MOTIONS: usize = 3000;

/// Sequence of attempts.
pub(super) struct Rounds<'a> {
    pub(super) rig: &'a mut Rig,
    pub(super) random: Rng,
    pub(super) planning: Planning,
    /// Longest planning time.
    pub(super) longest_planning: Duration,
}

impl Rounds<'_> {
    /// Makes an attempt, with the arm at rest before; it may move afterwards.
    pub(super) fn make(&mut self, attempt: Attempt) -> Result<Outcome, Fault> {
        match attempt {
            Attempt::StopRequest(phase) => self.stop(phase, |rig| Ok(request_stop(rig))),
            Attempt::StopCommand(phase) => self.stop(phase, command_stop),
            Attempt::Interrupt(phase) => self.interrupt(phase),
            Attempt::ConnectionClosed => self.close_connection(),
            Attempt::ClientKilled => self.kill_client(),
            Attempt::DriveEnded(signal) => self.end_drive(signal),
            Attempt::CabinetKilled => self.kill_cabinet(),
        }
    }

    fn stop(
        &mut self,
        phase: Phase,
        stop: fn(&Rig) -> Result<Option<Instant>, Fault>,
    ) -> Result<Outcome, Fault> {
        let duration_s = 0.2 + 0.5 * self.random.f64();
        let task = match phase {
            Phase::Planning | Phase::Request => self.long_work(),
            _ => self.short_work(duration_s)?,
        };
        let since = Instant::now();
        let run = PendingRequest::send(self.rig.addresses.requests, &task.request())?;
        let sent = Instant::now();
        match phase {
            Phase::Request => self.sleep(0.0..0.005),
            Phase::Planning => self.sleep(0.005..self.planning.expected_s(task.count())),
            Phase::Start if self.random.bool() => {
                self.sleep(0.0..2.0 * self.planning.expected_s(1));
            }
            phase => {
                if self.rig.witness.await_move(since, Duration::from_secs(5)).is_none() {
                    let reply = run.reply(Duration::from_millis(100));
                    return Err(format!("no motion begins: {reply:?}").into());
                }
                self.sleep(match phase {
                    Phase::Start => 0.0..0.03,
                    Phase::Motion => 0.03..0.6 * duration_s,
                    _ => 0.7 * duration_s..1.2 * duration_s,
                });
            }
        }
        let begin = Instant::now();
        let replied = stop(self.rig)?;
        let reply = replied.map(|replied| replied - begin);
        let at_least = sent + self.planning.at_most(task.count());
        let moved_after =
            replied.and_then(|replied| self.moves_after(replied, scaled(IN_FLIGHT), at_least));
        // Nor may a pending run begin before the reply.
        let began = self.rig.witness.first_move_after(since);
        let began_after =
            began.and_then(|began| began.checked_duration_since(begin + scaled(STOP_LATENCY)));
        let moved_after = began_after.map(|after| after + scaled(STOP_LATENCY)).or(moved_after);
        Ok(Outcome {
            reply,
            unanswered: reply.is_none_or(|reply| reply > scaled(REPLY_DEADLINE)),
            moved_after,
            is_void: false,
        })
    }

    fn interrupt(&mut self, phase: Phase) -> Result<Outcome, Fault> {
        let task = match phase {
            Phase::Planning => self.long_motions(),
            _ => Task::motions(&mut self.random, 3),
        };
        let since = Instant::now();
        let mut run = self.start_run(&task)?;
        if phase == Phase::Request {
            self.sleep(0.0..0.15);
        } else {
            // The plan is printed before the request is sent.
            await_plan(&run)?;
            if phase == Phase::Planning {
                self.sleep(0.0..self.planning.expected_s(task.count()));
            } else {
                self.rig
                    .witness
                    .await_move(since, Duration::from_secs(5))
                    .ok_or("no motion begins")?;
                self.sleep(0.0..0.3);
            }
        }
        let begin = Instant::now();
        run.signal("INT");
        let ended = run.wait(STOP_TIMEOUT).map(|ended| ended.instant);
        let reply = ended.map(|ended| ended - begin);
        let late = reply.is_none_or(|reply| reply > scaled(REPLY_DEADLINE));
        // The arm must be at rest at the deadline, even if the process ends later.
        let from = ended.map_or(begin + scaled(REPLY_DEADLINE), |ended| {
            ended.min(begin + scaled(REPLY_DEADLINE))
        });
        let at_least = begin + self.planning.at_most(task.count());
        let moved_after = self.moves_after(from, scaled(IN_FLIGHT), at_least);
        Ok(Outcome { reply, unanswered: late, moved_after, is_void: false })
    }

    fn close_connection(&mut self) -> Result<Outcome, Fault> {
        let task = self.long_motions();
        let sent = Instant::now();
        let run = PendingRequest::send(self.rig.addresses.requests, &task.request())?;
        self.sleep_before_motion(&task);
        let lost = Instant::now();
        drop(run);
        Ok(self.judge_loss(sent, lost, task.count()))
    }

    fn kill_client(&mut self) -> Result<Outcome, Fault> {
        let task = self.long_motions();
        let since = Instant::now();
        let mut run = self.start_run(&task)?;
        await_plan(&run)?;
        self.sleep_before_motion(&task);
        let lost = Instant::now();
        run.kill();
        Ok(self.judge_loss(since, lost, task.count()))
    }

    fn end_drive(&mut self, signal: &str) -> Result<Outcome, Fault> {
        let task = self.long_motions();
        let sent = Instant::now();
        let run = PendingRequest::send(self.rig.addresses.requests, &task.request())?;
        self.sleep_before_motion(&task);
        let lost = Instant::now();
        if let Some(drive) = &self.rig.drive {
            drive.signal(signal);
        }
        let outcome = self.judge_loss(sent, lost, task.count());
        drop(run);
        let ended = self.rig.drive.as_mut().and_then(|drive| drive.wait(STOP_TIMEOUT));
        self.rig.drive = None;
        Ok(Outcome { unanswered: ended.is_none(), ..outcome })
    }

    fn kill_cabinet(&mut self) -> Result<Outcome, Fault> {
        let task = self.long_work();
        let sent = Instant::now();
        let _run = PendingRequest::send(self.rig.addresses.requests, &task.request())?;
        self.sleep(0.0..self.planning.expected_s(task.count()) + 0.5);
        // The stop is sent shortly before or after.
        let [stop_after, kill_after] =
            [(); 2].map(|()| Duration::from_secs_f64(0.05 * self.random.f64()));
        let down = Duration::from_secs_f64(0.3 * self.random.f64());
        let requests = self.rig.addresses.requests;
        let stop = thread::spawn(move || {
            thread::sleep(stop_after);
            let begin = Instant::now();
            let reply = request(requests, r#"{"type": "stop"}"#, STOP_TIMEOUT);
            reply.is_ok().then(|| begin.elapsed())
        });
        thread::sleep(kill_after);
        self.rig.cabinet = None;
        thread::sleep(down);
        let restarted = Instant::now();
        self.rig.start_cabinet()?;
        let reply = stop.join().unwrap_or_default();
        let at_least = (sent + self.planning.at_most(task.count()))
            .max(restarted + Duration::from_millis(1500));
        let moved_after = self.moves_after(restarted, Duration::ZERO, at_least);
        let late = reply.is_none_or(|reply| reply > scaled(REPLY_DEADLINE_WITHOUT_CABINET));
        // Losses with the cabinet must not delay the next stop.
        self.rig.await_ready()?;
        let motion = Task::one_motion(&self.position()?, 1.0);
        let _run = PendingRequest::send(self.rig.addresses.requests, &motion.request())?;
        self.sleep(0.0..0.3);
        let begin = Instant::now();
        let next = request_stop(self.rig).map(|instant| instant - begin);
        let next_late = next.is_none_or(|next| next > scaled(REPLY_DEADLINE));
        Ok(Outcome {
            reply: reply.max(next),
            unanswered: late || next_late,
            moved_after,
            is_void: false,
        })
    }

    /// Returns the outcome of a loss before the motion, at `lost`.
    fn judge_loss(&self, sent: Instant, lost: Instant, count: usize) -> Outcome {
        let noticed = lost + scaled(LOSS_LATENCY);
        let at_least = sent.max(lost) + self.planning.at_most(count);
        let moved_after = self.moves_after(lost, scaled(LOSS_LATENCY), at_least);
        let first = self.rig.witness.first_move_after(sent);
        let is_void = first.is_some_and(|first| first <= noticed);
        Outcome { moved_after: moved_after.filter(|_| !is_void), is_void, ..Outcome::default() }
    }

    /// Returns the time after `from` at which the arm moves, if it does so after a grace period.
    /// The arm is observed until `at_least`, and for a minimum time.
    fn moves_after(&self, from: Instant, grace: Duration, at_least: Instant) -> Option<Duration> {
        let until = at_least.max(from + grace + Duration::from_millis(250));
        let left = until.saturating_duration_since(Instant::now());
        self.rig.witness.await_move(from + grace, left).map(|instant| instant - from)
    }

    fn start_run(&mut self, task: &Task) -> Result<Process, Fault> {
        let Task::Motions(motions) = task else { return Err("a file holds motions".into()) };
        let file = self.rig.folder.path().join("program.json");
        fs::write(&file, program(&self.position()?, motions))?;
        let file = file.display().to_string();
        self.rig.client(&["run", file.as_str(), "--no-output"], true)
    }

    fn position(&self) -> Result<[f64; 7], Fault> {
        self.rig.witness.position().ok_or_else(|| "the witness has not seen the arm".into())
    }

    /// Returns motions with a long planning time.
    fn long_motions(&mut self) -> Task {
        let share = 0.4 + 0.6 * self.random.f64();
        let count = self.planning.count(share * self.longest_planning.as_secs_f64());
        Task::motions(&mut self.random, count)
    }

    /// Returns motions with a long planning time, and sometimes few motions.
    fn long_work(&mut self) -> Task {
        if self.random.f64() < 0.2 {
            let count = self.random.usize(1..=10);
            return Task::motions(&mut self.random, count);
        }
        self.long_motions()
    }

    fn short_work(&mut self, duration_s: f64) -> Result<Task, Fault> {
        let from = self.position()?;
        Ok(if self.random.bool() {
            Task::one_motion(&from, duration_s)
        } else {
            Task::trajectory(&from, duration_s)
        })
    }

    /// Sleeps for a part of the time before the motion begins.
    fn sleep_before_motion(&mut self, task: &Task) {
        self.sleep(0.0..0.5 * self.planning.expected_s(task.count()));
    }

    fn sleep(&mut self, range_s: std::ops::Range<f64>) {
        let time_s = range_s.start + (range_s.end - range_s.start) * self.random.f64();
        thread::sleep(Duration::from_secs_f64(time_s.max(0.0)));
    }
}

/// Returns the time at which a raw stop got the reply `ok`.
fn request_stop(rig: &Rig) -> Option<Instant> {
    let reply = request(rig.addresses.requests, r#"{"type": "stop"}"#, STOP_TIMEOUT);
    let start = Instant::now();
    reply.is_ok_and(|reply| is_ok(&reply)).then_some(start)
}

/// Returns the time at which `iiwasim stop` succeeded.
fn command_stop(rig: &Rig) -> Result<Option<Instant>, Fault> {
    let mut stop = rig.client(&["stop"], false)?;
    Ok(stop.wait(STOP_TIMEOUT).filter(|ended| ended.success).map(|ended| ended.instant))
}

/// Waits until `iiwasim run` prints its plan.
fn await_plan(run: &Process) -> Result<(), Fault> {
    run.lines
        .recv_timeout(Duration::from_secs(30))
        .map(drop)
        .map_err(|_| format!("`iiwasim run` prints no plan: {}", run.stderr()).into())
}
