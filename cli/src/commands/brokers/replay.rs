//! `iiwasim replay`.

use std::{
    error::Error,
    fs::File,
    ops::ControlFlow::{Break, Continue},
    path::Path,
    time::Duration,
};

use iiwa_bridge::{
    Content, Message,
    kafka::reader::OmittedMessages,
    message::CycleSample,
    replay::{Player, ReplayDrive},
};
use iiwa_files::interrupt;
use iiwa_kin::Robot;
use iiwa_link::Server;
use iiwa_log::{Config, Recorder, RecorderConfig, WriteError};

use crate::{
    args::Replay,
    broker_access::failure,
    commands::brokers::history::reader,
    connection,
    failure::{Failure, print_note},
    input::find_robot,
    output,
    output_kind::OutputKind,
    progress::Progress,
};

/// Plays back into a file, or live.
pub(crate) fn run(options: &Replay) -> Result<(), Failure> {
    output::catch_interrupts();
    match &options.output {
        Some(path) => record(options, path),
        None => serve(options),
    }
}

/// Writes a recording.
fn record(options: &Replay, path: &Path) -> Result<(), Failure> {
    let robot = find_robot(&options.robot)?;
    let (reader, selection) = reader(&options.stored, Some(options.name.clone()))?;
    output::keep_existing(OutputKind::Recording, path, options.overwrite)?;
    let mut recording: Option<ReplayRecording> = None;
    let mut failed = None;
    let mut progress = Progress::of_recording();
    let read = reader.replay(&selection, |message| {
        let Content::Joints(sample) = &message.content else { return Continue(()) };
        let recorded = match &mut recording {
            Some(recording) => recording.add(sample).map_err(|error| cannot_write(path, &error)),
            None => ReplayRecording::begin(options, path, &robot, &message, sample)
                .map(|begun| recording = Some(begun)),
        };
        progress.show(recording.as_ref().map_or(0, |recording| recording.samples));
        if let Err(error) = recorded {
            failed = Some(error);
        }
        if failed.is_some() || interrupt::has_come() { Break(()) } else { Continue(()) }
    });
    progress.clear();
    let left_out = read.map_err(|error| failure(&error))?;
    if let Some(error) = failed {
        return Err(error);
    }
    output::check_interrupt()?;
    let Some(recording) = recording else { return Err(nothing(options)) };
    let (samples, last) = (recording.samples, recording.last);
    let metadata = [("sample_count".to_owned(), samples.to_string())].into();
    recording.recorder.finish(&metadata, &[]).map_err(|error| cannot_write(path, &error))?;
    output::print(&format!(
        "{samples} samples over {:.3} s in {}{}\n",
        last.as_secs_f64(),
        path.display(),
        remarks(left_out)
    ))
}

fn cannot_write(path: &Path, error: &dyn Error) -> Failure {
    Failure::run(format!("cannot write {}", path.display()), error)
}

/// Recording under construction.
struct ReplayRecording {
    recorder: Recorder<File>,
    first_s: f64,
    last: Duration,
    samples: u64,
}

impl ReplayRecording {
    fn begin(
        options: &Replay,
        path: &Path,
        robot: &Robot,
        message: &Message,
        sample: &CycleSample,
    ) -> Result<Self, Failure> {
        let to_failure = |error: &dyn Error| cannot_write(path, error);
        let epoch = Duration::from_micros(message.at.micros());
        let file_config = Config { epoch, names: options.ros.names(), ..Config::default() };
        let config = RecorderConfig { file: file_config, ..RecorderConfig::default() };
        let mut recorder = Recorder::create(path, options.overwrite, robot, config)
            .map_err(|error| to_failure(&error))?;
        let torques = sample.measured_nm.as_ref();
        recorder
            .sample_with_torques(Duration::ZERO, &sample.joints_rad, torques)
            .map_err(|error| to_failure(&error))?;
        Ok(Self { recorder, first_s: sample.t_s, last: Duration::ZERO, samples: 1 })
    }

    fn add(&mut self, sample: &CycleSample) -> Result<(), WriteError> {
        let t = Duration::try_from_secs_f64(sample.t_s - self.first_s).unwrap_or_default();
        if t <= self.last {
            // The drive was restarted: its clock starts again, and the recording continues one
            // cycle later.
            const CYCLE_S: f64 = 0.005;
            self.first_s = sample.t_s - self.last.as_secs_f64() - CYCLE_S;
            return Ok(());
        }
        let torques = sample.measured_nm.as_ref();
        self.recorder.sample_with_torques(t, &sample.joints_rad, torques)?;
        self.last = t;
        self.samples += 1;
        Ok(())
    }
}

/// Plays back for clients of a drive.
fn serve(options: &Replay) -> Result<(), Failure> {
    let (reader, selection) = reader(&options.stored, Some(options.name.clone()))?;
    let (requests, stream) = (options.drive.to_string(), options.stream.to_string());
    let drive = ReplayDrive::start(&Server::open(), &requests, &stream)
        .map_err(|error| connection::not_started(&error, "--drive and --stream"))?;
    print_note(&format!(
        "Clients find the replay at {} and {}. Ctrl-C ends it.\n",
        drive.requests(),
        drive.stream()
    ));
    let mut player = Player::new(&drive, options.speed);
    let mut played: u64 = 0;
    let left_out = reader
        .replay(&selection, |message| {
            played += 1;
            player.play(message, interrupt::has_come)
        })
        .map_err(|error| failure(&error))?;
    output::check_interrupt()?;
    if played == 0 {
        return Err(nothing(options));
    }
    print_note(&format!("Played {played} messages{}\n", remarks(left_out)));
    Ok(())
}

fn nothing(options: &Replay) -> Failure {
    let message = format!(
        "no joints of `{}` in this time range; --name, --from and --until choose others",
        options.name
    );
    Failure::Run { message, cause: None }
}

fn remarks(OmittedMessages { missing, unreadable, .. }: OmittedMessages) -> String {
    let count_text = |count: u64, noun: &str| {
        if count > 0 { format!("; {count} {noun}") } else { String::new() }
    };
    count_text(missing, "messages are missing in between")
        + &count_text(unreadable, "records could not be read")
}
