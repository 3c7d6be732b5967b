//! One attempt to make the arm move after it was stopped.

use std::{
    fs, thread,
    time::{Duration, Instant},
};

use fastrand::Rng;

use super::{
    ask::{Asked, ask, is_ok},
    patience::within,
    process::Process,
    rig::{Fault, Rig},
    work::{Work, program},
};

/// Motion so soon after a reply is a message that was on its way.
const IN_FLIGHT: Duration = Duration::from_millis(50);

/// Motion that begins so soon after a stop was asked for could not be prevented: `iiwasim stop` has to
/// start first.
const HEARD_WITHIN: Duration = Duration::from_millis(100);

/// Motion that begins so soon after a client or drive was lost could not be prevented.
const NOTICED_WITHIN: Duration = Duration::from_millis(250);

/// A stop is answered within so long: half a second, and half a second to brake.
pub(super) const ANSWERED_WITHIN: Duration = Duration::from_secs(1);

/// A stop is answered within so long, be it by an error, when the cabinet is gone.
const ANSWERED_WITHOUT_CABINET: Duration = Duration::from_secs(6);

/// How long a stop may take before it counts as not answered.
const GIVEN_UP_AFTER: Duration = Duration::from_secs(8);

/// When, within a run, something happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Phase {
    Request,
    Planning,
    Start,
    Motion,
    End,
}

/// What happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Attempt {
    /// A raw request.
    StopRequest(Phase),
    /// `iiwasim stop`.
    StopCommand(Phase),
    /// SIGINT to `iiwasim run` before it has asked for anything, while its motions are planned by the
    /// cabinet, or while the arm moves.
    Interrupt(Phase),
    /// The connection that has asked for a run is closed before the arm moves.
    ConnectionClosed,
    /// `iiwasim run` is killed before the arm moves.
    ClientKilled,
    /// The drive gets a signal before the arm moves.
    DriveEnded(&'static str),
    /// The cabinet is killed and started again, and a stop is asked for meanwhile.
    CabinetKilled,
}

impl Attempt {
    /// All of them.
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

    /// What it is called in the table.
    pub(super) fn name(self) -> String {
        let phase = |phase| match phase {
            Phase::Request => "the request is on its way",
            Phase::Planning => "motions are planned",
            Phase::Start => "the arm starts",
            Phase::Motion => "the arm moves",
            Phase::End => "the arm comes to its end",
        };
        match self {
            Self::StopRequest(at) => format!("stop request while {}", phase(at)),
            Self::StopCommand(at) => format!("`iiwasim stop` while {}", phase(at)),
            Self::Interrupt(Phase::Request) => "Ctrl-C as `run` starts".to_owned(),
            Self::Interrupt(at) => format!("Ctrl-C to `run` while {}", phase(at)),
            Self::ConnectionClosed => "client's connection lost before motion".to_owned(),
            Self::ClientKilled => "`iiwasim run` killed before motion".to_owned(),
            Self::DriveEnded(signal) => format!("drive ended by SIG{signal} before motion"),
            Self::CabinetKilled => "cabinet killed and restarted".to_owned(),
        }
    }
}

/// How an attempt went.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Outcome {
    /// How long the reply took.
    pub(super) reply: Option<Duration>,
    /// The reply came too late, was an error, or never came.
    pub(super) unanswered: bool,
    /// How long after the reply, or the loss, the arm was first commanded to move.
    pub(super) moved_after: Option<Duration>,
    /// The arm moved before it could be attempted.
    pub(super) is_void: bool,
}

/// How long it takes from a request to the motion, in s, and from a request with [`MEASURED`] motions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planning {
    least_s: [f64; 2],
    most_s: [f64; 2],
}

/// Motions by which planning is measured.
const MEASURED: u32 = 200;

impl Planning {
    /// Measured on this machine, some times: it may be busy with other things.
    pub(super) fn measure(rig: &mut Rig, random: &mut Rng) -> Result<Self, Fault> {
        let mut planning = Self { least_s: [f64::INFINITY; 2], most_s: [0.0; 2] };
        for _ in 0..3 {
            for (kind, count) in [1, MEASURED].into_iter().enumerate() {
                rig.await_idle()?;
                let work = Work::motions(random, count as usize);
                let since = Instant::now();
                let _run = Asked::send(rig.at.requests, &work.request())?;
                let start = rig
                    .witness
                    .await_move(since, Duration::from_secs(30))
                    .ok_or("the arm does not start, with nothing in its way")?;
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

    /// For so many motions, on a machine with nothing else to do.
    fn expected_s(self, count: usize) -> f64 {
        self.least_s[0] + Self::each_s(self.least_s) * count as f64
    }

    /// The same on one that is as busy as it was, with a margin.
    fn at_most(self, count: usize) -> Duration {
        let time_s = self.most_s[0] + Self::each_s(self.most_s) * count as f64;
        Duration::from_secs_f64(1.5 * time_s + 0.2)
    }

    /// How many motions are planned in so long, in s.
    fn count(self, time_s: f64) -> usize {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        let count = ((time_s - self.least_s[0]) / Self::each_s(self.least_s)).max(1.0) as usize;
        count.min(MOST_MOTIONS)
    }
}

/// More motions than these no request has.
const MOST_MOTIONS: usize = 3000;

/// Attempts one after the other.
pub(super) struct Rounds<'a> {
    pub(super) rig: &'a mut Rig,
    pub(super) random: Rng,
    pub(super) planning: Planning,
    /// How long planning is to take at most.
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
        let work = match phase {
            Phase::Planning | Phase::Request => self.long_work(),
            _ => self.short_work(duration_s)?,
        };
        let since = Instant::now();
        let run = Asked::send(self.rig.at.requests, &work.request())?;
        let sent = Instant::now();
        match phase {
            Phase::Request => self.sleep(0.0..0.005),
            Phase::Planning => self.sleep(0.005..self.planning.expected_s(work.count())),
            Phase::Start if self.random.bool() => {
                self.sleep(0.0..2.0 * self.planning.expected_s(1));
            }
            phase => {
                if self.rig.witness.await_move(since, Duration::from_secs(5)).is_none() {
                    let answer = run.answer(Duration::from_millis(100));
                    return Err(format!("no motion begins: {answer:?}").into());
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
        let reply = replied.map(|at| at - begin);
        let at_least = sent + self.planning.at_most(work.count());
        let moved_after = replied.and_then(|at| self.moves_after(at, within(IN_FLIGHT), at_least));
        // What had not begun must not begin while the reply is waited for, either.
        let began = self.rig.witness.first_move_after(since);
        let began_after =
            began.and_then(|at| at.checked_duration_since(begin + within(HEARD_WITHIN)));
        let moved_after = began_after.map(|after| after + within(HEARD_WITHIN)).or(moved_after);
        Ok(Outcome {
            reply,
            unanswered: reply.is_none_or(|reply| reply > within(ANSWERED_WITHIN)),
            moved_after,
            is_void: false,
        })
    }

    fn interrupt(&mut self, phase: Phase) -> Result<Outcome, Fault> {
        let work = match phase {
            Phase::Planning => self.long_motions(),
            _ => Work::motions(&mut self.random, 3),
        };
        let since = Instant::now();
        let mut run = self.start_run(&work)?;
        if phase == Phase::Request {
            self.sleep(0.0..0.15);
        } else {
            // It shows its plan before it asks for the run.
            await_plan(&run)?;
            if phase == Phase::Planning {
                self.sleep(0.0..self.planning.expected_s(work.count()));
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
        let ended = run.wait(GIVEN_UP_AFTER).map(|ended| ended.at);
        let reply = ended.map(|at| at - begin);
        let late = reply.is_none_or(|reply| reply > within(ANSWERED_WITHIN));
        // However late it ends: the arm stands when the time for it is over.
        let from = ended
            .map_or(begin + within(ANSWERED_WITHIN), |at| at.min(begin + within(ANSWERED_WITHIN)));
        let at_least = begin + self.planning.at_most(work.count());
        let moved_after = self.moves_after(from, within(IN_FLIGHT), at_least);
        Ok(Outcome { reply, unanswered: late, moved_after, is_void: false })
    }

    fn close_connection(&mut self) -> Result<Outcome, Fault> {
        let work = self.long_motions();
        let sent = Instant::now();
        let run = Asked::send(self.rig.at.requests, &work.request())?;
        self.sleep_before_motion(&work);
        let lost = Instant::now();
        drop(run);
        Ok(self.judge_loss(sent, lost, work.count()))
    }

    fn kill_client(&mut self) -> Result<Outcome, Fault> {
        let work = self.long_motions();
        let since = Instant::now();
        let mut run = self.start_run(&work)?;
        await_plan(&run)?;
        self.sleep_before_motion(&work);
        let lost = Instant::now();
        run.kill();
        Ok(self.judge_loss(since, lost, work.count()))
    }

    fn end_drive(&mut self, signal: &str) -> Result<Outcome, Fault> {
        let work = self.long_motions();
        let sent = Instant::now();
        let run = Asked::send(self.rig.at.requests, &work.request())?;
        self.sleep_before_motion(&work);
        let lost = Instant::now();
        if let Some(drive) = &self.rig.drive {
            drive.signal(signal);
        }
        let outcome = self.judge_loss(sent, lost, work.count());
        drop(run);
        let ended = self.rig.drive.as_mut().and_then(|drive| drive.wait(GIVEN_UP_AFTER));
        self.rig.drive = None;
        Ok(Outcome { unanswered: ended.is_none(), ..outcome })
    }

    fn kill_cabinet(&mut self) -> Result<Outcome, Fault> {
        let work = self.long_work();
        let sent = Instant::now();
        let _run = Asked::send(self.rig.at.requests, &work.request())?;
        self.sleep(0.0..self.planning.expected_s(work.count()) + 0.5);
        // The stop comes just before, or just after.
        let [stop_after, kill_after] =
            [(); 2].map(|()| Duration::from_secs_f64(0.05 * self.random.f64()));
        let down = Duration::from_secs_f64(0.3 * self.random.f64());
        let requests = self.rig.at.requests;
        let stop = thread::spawn(move || {
            thread::sleep(stop_after);
            let begin = Instant::now();
            let answer = ask(requests, r#"{"type": "stop"}"#, GIVEN_UP_AFTER);
            answer.is_ok().then(|| begin.elapsed())
        });
        thread::sleep(kill_after);
        self.rig.cabinet = None;
        thread::sleep(down);
        let restarted = Instant::now();
        self.rig.start_cabinet()?;
        let reply = stop.join().unwrap_or_default();
        let at_least = (sent + self.planning.at_most(work.count()))
            .max(restarted + Duration::from_millis(1500));
        let moved_after = self.moves_after(restarted, Duration::ZERO, at_least);
        let late = reply.is_none_or(|reply| reply > within(ANSWERED_WITHOUT_CABINET));
        // What was lost with the cabinet must not hold up what comes next.
        self.rig.await_ready()?;
        let motion = Work::one_motion(&self.position()?, 1.0);
        let _run = Asked::send(self.rig.at.requests, &motion.request())?;
        self.sleep(0.0..0.3);
        let begin = Instant::now();
        let next = request_stop(self.rig).map(|at| at - begin);
        let next_late = next.is_none_or(|next| next > within(ANSWERED_WITHIN));
        Ok(Outcome {
            reply: reply.max(next),
            unanswered: late || next_late,
            moved_after,
            is_void: false,
        })
    }

    /// A loss before the motion; `lost` is when.
    fn judge_loss(&self, sent: Instant, lost: Instant, count: usize) -> Outcome {
        let noticed = lost + within(NOTICED_WITHIN);
        let at_least = sent.max(lost) + self.planning.at_most(count);
        let moved_after = self.moves_after(lost, within(NOTICED_WITHIN), at_least);
        let first = self.rig.witness.first_move_after(sent);
        let is_void = first.is_some_and(|at| at <= noticed);
        Outcome { moved_after: moved_after.filter(|_| !is_void), is_void, ..Outcome::default() }
    }

    /// Whether the arm moves once a grace is over: how long after `from`. It is looked at until
    /// `at_least`, and for a moment in any case.
    fn moves_after(&self, from: Instant, grace: Duration, at_least: Instant) -> Option<Duration> {
        let until = at_least.max(from + grace + Duration::from_millis(250));
        let left = until.saturating_duration_since(Instant::now());
        self.rig.witness.await_move(from + grace, left).map(|at| at - from)
    }

    fn start_run(&mut self, work: &Work) -> Result<Process, Fault> {
        let Work::Motions(motions) = work else { return Err("a file holds motions".into()) };
        let file = self.rig.folder.path().join("program.json");
        fs::write(&file, program(&self.position()?, motions))?;
        let file = file.display().to_string();
        self.rig.client(&["run", file.as_str(), "--no-output"], true)
    }

    fn position(&self) -> Result<[f64; 7], Fault> {
        self.rig.witness.position().ok_or_else(|| "the witness has not seen the arm".into())
    }

    /// Motions whose planning takes its time.
    fn long_motions(&mut self) -> Work {
        let share = 0.4 + 0.6 * self.random.f64();
        let count = self.planning.count(share * self.longest_planning.as_secs_f64());
        Work::motions(&mut self.random, count)
    }

    /// The same, and now and then few motions.
    fn long_work(&mut self) -> Work {
        if self.random.f64() < 0.2 {
            let count = self.random.usize(1..=10);
            return Work::motions(&mut self.random, count);
        }
        self.long_motions()
    }

    fn short_work(&mut self, duration_s: f64) -> Result<Work, Fault> {
        let from = self.position()?;
        Ok(if self.random.bool() {
            Work::one_motion(&from, duration_s)
        } else {
            Work::trajectory(&from, duration_s)
        })
    }

    /// For a part of the time that it takes to begin.
    fn sleep_before_motion(&mut self, work: &Work) {
        self.sleep(0.0..0.5 * self.planning.expected_s(work.count()));
    }

    fn sleep(&mut self, range_s: std::ops::Range<f64>) {
        let time_s = range_s.start + (range_s.end - range_s.start) * self.random.f64();
        thread::sleep(Duration::from_secs_f64(time_s.max(0.0)));
    }
}

/// When a raw stop was answered by `ok`.
fn request_stop(rig: &Rig) -> Option<Instant> {
    let answer = ask(rig.at.requests, r#"{"type": "stop"}"#, GIVEN_UP_AFTER);
    let at = Instant::now();
    answer.is_ok_and(|answer| is_ok(&answer)).then_some(at)
}

/// When `iiwasim stop` has ended well.
fn command_stop(rig: &Rig) -> Result<Option<Instant>, Fault> {
    let mut stop = rig.client(&["stop"], false)?;
    Ok(stop.wait(GIVEN_UP_AFTER).filter(|ended| ended.well).map(|ended| ended.at))
}

/// Waits until `iiwasim run` shows its plan.
fn await_plan(run: &Process) -> Result<(), Fault> {
    run.lines
        .recv_timeout(Duration::from_secs(30))
        .map(drop)
        .map_err(|_| format!("`iiwasim run` shows no plan: {}", run.said()).into())
}
