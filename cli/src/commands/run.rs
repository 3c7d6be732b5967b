//! `iiwasim run`.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    io::Cursor,
    path::{Path as FilePath, PathBuf},
    thread,
    time::Duration,
};

use iiwa_kin::{Joints, Robot};
use iiwa_link::{
    Client, ClientError, Published, START_TOLERANCE_RAD, Stream, TimedJoints,
    message::{DriveState, FriStatus, Run as Measured, Samples},
};
use iiwa_log::{Recorder, RecorderConfig};
use iiwa_path::{Motion, Path, Program, Ptp};
use iiwa_traj::{Timing, Trajectory};
use serde::Serialize;

use crate::{
    args::Run,
    connection,
    failure::{Failure, printable, tell},
    figures::Figures,
    input::{self, Text},
    output::{self, Output},
    progress::Progress,
    table,
};

/// Time from one point of a trajectory to the next, in s.
const STEP_S: f64 = 0.004;

/// How long the stream is waited for before the connection is looked at again.
const LOOK: Duration = Duration::from_millis(50);

/// Runs a program on the robot.
pub(crate) fn run(options: &Run) -> Result<(), Failure> {
    let (text, program, robot) = input::program(&options.program, options.robot.as_deref())?;
    let target = target(options);
    output::catch_interrupts();
    let (plan, figures) = plan(&text, &program, &robot)?;

    let remote = connection::remote(&options.drive.keys)?;
    let mut line = Line {
        client: connection::client(&options.drive)?,
        helper: connection::client(&options.drive)?,
        stream: Stream::new(&remote, &options.stream.to_string())
            .map_err(|error| connection::refused(&error))?,
    };
    if !options.json {
        output::print(&table::figures(&figures))?;
    }
    let output = target.as_deref().map(Output::new).transpose()?;
    go_to_start(&mut line, options, &program.start_rad)?;
    output::check_interrupt()?;

    let task = if options.as_trajectory {
        Task::Trajectory(sampled(&plan))
    } else {
        Task::Motions(program.motions)
    };
    let watched = watch(&mut line, task, Some(plan.cycle_time_s()));
    let (measured, failure) = match watched.result {
        Ok(measured) => (measured, None),
        Err(ClientError::Refused { refusal, run }) => {
            let run = run.map(|run| *run).unwrap_or_default();
            let what = match run.samples.t_s.as_slice() {
                [] => "the robot did not run the program",
                _ => "the robot did not finish the program",
            };
            let failed = ClientError::Refused { refusal, run: None };
            (run, Some(connection::failed(what, &failed)))
        }
        // What the stream has brought is all there is.
        Err(error) => {
            // A motion needs no drive to go on.
            let failure =
                connection::failed("the run broke off, the robot may still be moving", &error);
            (Measured { samples: watched.seen, ..Measured::default() }, Some(failure))
        }
    };
    let samples = since_start(&measured);
    let written = output.filter(|_| !samples.is_empty());
    let file = match written {
        Some(output) => {
            output.write(&recording(&samples, &measured, &robot, &text)?)?;
            output.complete_always()?;
            target.as_deref()
        }
        None => None,
    };
    let figures = Report::new(&plan, &measured, failure.is_none(), samples.len(), file);
    if options.json {
        output::print_json(&figures)?;
    } else {
        output::print(&figures.text())?;
    }
    failure.map_or(Ok(()), Err)
}

fn target(options: &Run) -> Option<PathBuf> {
    if options.no_output {
        return None;
    }
    let stem = match options.program.file_stem() {
        Some(stem) if options.program != FilePath::new("-") => stem.to_string_lossy().into_owned(),
        _ => "program".to_owned(),
    };
    Some(options.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.measured.mcap"))))
}

fn plan(text: &Text, program: &Program, robot: &Robot) -> Result<(Trajectory, Figures), Failure> {
    let path = Path::new(program, robot).map_err(|fault| {
        let place = fault.place_in(&text.text);
        Failure::in_text(&fault.to_string(), &place, &text.name, &text.text)
    })?;
    let timing = Timing::default();
    let plan = Trajectory::plan(&path, timing)
        .map_err(|error| Failure::run("cannot plan the program", &error))?;
    let mut figures = Figures::new(timing, robot, 0);
    plan.stretches().iter().for_each(|stretch| figures.add(stretch));
    Ok((plan, figures))
}

/// The trajectory as it is sent: at even steps, and at its end.
fn sampled(plan: &Trajectory) -> TimedJoints {
    let end_s = plan.cycle_time_s();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
    let steps = (end_s / STEP_S).ceil() as u32;
    let t_s: Vec<f64> = (0..steps)
        .map(|i| f64::from(i) * STEP_S)
        // No step next to nothing before the end.
        .filter(|t_s| end_s - t_s > 1e-3 * STEP_S)
        .chain([end_s])
        .collect();
    let joints_rad = t_s.iter().map(|t_s| plan.at(*t_s).q).collect();
    TimedJoints { t_s, joints_rad }
}

/// The robot has to be where the program starts.
fn go_to_start(line: &mut Line, options: &Run, start_rad: &Joints) -> Result<(), Failure> {
    let ask = |error: ClientError| connection::failed("cannot ask where the robot is", &error);
    let status = line.client.state().map_err(ask)?;
    let Some(joints_rad) = status.joints_rad.filter(|_| status.fri.session != FriStatus::SILENT)
    else {
        return Err(Failure::Run {
            what: "it is not known where the robot is: the drive does not hear the controller"
                .to_owned(),
            cause: None,
        });
    };
    let off = |j: &usize| (joints_rad[*j] - start_rad[*j]).abs();
    let worst = (0..7).max_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
    if off(&worst) <= START_TOLERANCE_RAD && (options.move_to_start.is_none() || off(&worst) < 1e-6)
    {
        return Ok(());
    }
    let Some(percent) = options.move_to_start else {
        return Err(Failure::Run {
            what: format!(
                "the robot is not at the program's start: joint {} is at {:.3} deg, the program starts at \
                 {:.3} deg; --move-to-start moves it there first",
                worst + 1,
                joints_rad[worst].to_degrees(),
                start_rad[worst].to_degrees()
            ),
            cause: None,
        });
    };
    tell("Moving to the start\n");
    let there = vec![Motion::Ptp(Ptp::to(*start_rad).velocity(percent / 100.0))];
    watch(line, Task::Motions(there), None)
        .result
        .map(drop)
        .map_err(|error| connection::failed("the robot did not move to the start", &error))
}

/// The connections to a drive.
struct Line {
    client: Client,
    /// Stops the run that the client waits for.
    helper: Client,
    stream: Stream,
}

/// What the drive is to do.
enum Task {
    Motions(Vec<Motion>),
    Trajectory(TimedJoints),
}

/// How a run went.
struct Watched {
    result: Result<Measured, ClientError>,
    /// What the stream brought meanwhile.
    seen: Samples,
}

/// Lets the drive run a task, shows how far it is, and stops it when it is interrupted.
fn watch(line: &mut Line, task: Task, planned_s: Option<f64>) -> Watched {
    let Line { client, helper, stream } = line;
    thread::scope(|scope| {
        let running = scope.spawn(move || match task {
            Task::Motions(motions) => client.run_motions(motions, None),
            Task::Trajectory(trajectory) => client.run_trajectory(trajectory, None),
        });
        let seen = follow(helper, stream, planned_s, || running.is_finished());
        let result = running.join().unwrap_or_else(|_| {
            let what = "this program has failed; please report it".to_owned();
            Err(ClientError::Answer { what })
        });
        Watched { result, seen }
    })
}

/// Follows a run until it has ended.
fn follow(
    helper: &mut Client,
    stream: &mut Stream,
    planned_s: Option<f64>,
    has_ended: impl Fn() -> bool,
) -> Samples {
    let mut progress = Progress::of_run();
    let mut seen = Samples::default();
    let mut runs = false;
    let mut stops = 0;
    while !has_ended() {
        if output::interrupted() {
            // Again until it has ended: the first one may have come before it began.
            let stopped = helper.stop();
            progress.aside(|| match stopped {
                _ if stops > 0 => {}
                Ok(()) => tell("Interrupted: the robot is stopped on its path\n"),
                Err(error) => tell(&format!(
                    "The robot could not be told to stop: {}\n",
                    printable(&error.to_string())
                )),
            });
            stops += 1;
        }
        match stream.next(LOOK) {
            Ok(Some(Published::Joints { t_s, joints_rad })) if runs => {
                seen.t_s.push(t_s);
                seen.joints_rad.push(joints_rad);
                if let Some(planned_s) = planned_s {
                    progress.show_share(((t_s - seen.t_s[0]) / planned_s).min(1.0));
                }
            }
            Ok(Some(Published::State { state, .. })) => runs = state != DriveState::Idle,
            Ok(_) => {}
            Err(error) => {
                progress.aside(|| tell(&format!("The stream broke off: {error}\n")));
                thread::sleep(LOOK);
            }
        }
    }
    progress.clear();
    seen
}

/// The samples from the start of a run on, each with its time since then.
fn since_start(measured: &Measured) -> Vec<(Duration, &Joints)> {
    let Samples { t_s, joints_rad } = &measured.samples;
    let from_s = measured.start_s.or(t_s.first().copied()).unwrap_or_default();
    // Stamps are sums: the first sample may come out next to nothing before the start.
    let since = |t_s: f64| (t_s - from_s > -1e-6).then(|| (t_s - from_s).max(0.0));
    let time = |t_s: &f64| Duration::try_from_secs_f64(since(*t_s)?).ok();
    t_s.iter().zip(joints_rad).filter_map(|(t_s, q)| Some((time(t_s)?, q))).collect()
}

/// What the robot did, as MCAP, from the start of the run on.
fn recording(
    samples: &[(Duration, &Joints)],
    measured: &Measured,
    robot: &Robot,
    text: &Text,
) -> Result<Vec<u8>, Failure> {
    let refuse = |error: iiwa_log::WriteError| Failure::run("cannot write the recording", &error);
    let storage = Cursor::new(Vec::new());
    let mut recorder = Recorder::new(storage, robot, RecorderConfig::default()).map_err(refuse)?;
    for (t, q) in samples {
        recorder.sample(*t, q).map_err(refuse)?;
    }
    let mut metadata = BTreeMap::from([("samples".to_owned(), samples.len().to_string())]);
    if let Some(cycle_time_s) = measured.cycle_time_s {
        metadata.insert("cycle_time_s".to_owned(), cycle_time_s.to_string());
    }
    let program = ("program.json", "application/json", text.text.as_bytes());
    let storage = recorder.finish(&metadata, &[program]).map_err(refuse)?;
    Ok(storage.into_inner())
}

/// The `--json` object.
#[derive(Serialize)]
struct Report {
    planned_cycle_time_s: f64,
    measured_cycle_time_s: Option<f64>,
    error_s: Option<f64>,
    error_percent: Option<f64>,
    /// When a run that broke off did so.
    ended_after_s: Option<f64>,
    samples: usize,
    output: Option<String>,
}

impl Report {
    fn new(
        plan: &Trajectory,
        measured: &Measured,
        complete: bool,
        samples: usize,
        file: Option<&FilePath>,
    ) -> Self {
        let planned_s = plan.cycle_time_s();
        let measured_s = measured.cycle_time_s.filter(|_| complete);
        // As Eq. 40 of the thesis has it: of the measured time.
        let error_s = measured_s.map(|measured_s| planned_s - measured_s);
        Self {
            planned_cycle_time_s: planned_s,
            measured_cycle_time_s: measured_s,
            error_s,
            error_percent: error_s
                .zip(measured_s)
                .map(|(error, measured)| 100.0 * error / measured),
            ended_after_s: measured.cycle_time_s.filter(|_| !complete),
            samples,
            output: file.map(|file| file.display().to_string()),
        }
    }

    fn text(&self) -> String {
        let mut text = String::new();
        let planned_s = self.planned_cycle_time_s;
        if let (Some(measured_s), Some(error_s), Some(percent)) =
            (self.measured_cycle_time_s, self.error_s, self.error_percent)
        {
            let _ = writeln!(
                text,
                "Measured   {measured_s:.3} s, planned {planned_s:.3} s: the plan is off by \
                 {error_s:+.3} s, {percent:+.2} %"
            );
        }
        if let Some(after_s) = self.ended_after_s {
            let _ = writeln!(text, "Ended after {after_s:.3} s of {planned_s:.3} s");
        }
        if let Some(file) = &self.output {
            let _ = writeln!(text, "{} samples of what the robot did in {file}", self.samples);
        }
        text
    }
}
