//! `iiwasim record`.

use std::{
    fs::File,
    time::{Duration, Instant},
};

use iiwa_files::interrupt;
use iiwa_link::{Published, Stream};
use iiwa_log::{Config, Recorder, RecorderConfig, WriteError};
use iiwa_twin::{
    diagnostics::{self, SensorPoll},
    runs::now,
};

use crate::{
    args::Record,
    connection,
    failure::{Failure, print_note},
    input::find_robot,
    output,
    output_kind::OutputKind,
    progress::Progress,
};

/// Timeout of the stream before the file is flushed.
const POLL: Duration = Duration::from_millis(200);

/// Wait for the first sample before a note is printed.
const NOTE_AFTER: Duration = Duration::from_secs(3);

/// Records until an interrupt.
pub(crate) fn run(options: &Record) -> Result<(), Failure> {
    let robot = find_robot(&options.robot)?;
    let remote = connection::remote(&options.drive.keys)?;
    let mut stream = Stream::with_torques(&remote, &options.stream.to_string())
        .map_err(|error| connection::link_failure(&error))?;
    let client = options.sensors.then(|| connection::client(&options.drive)).transpose()?;
    let mut sensors = client.map(SensorPoll::new);
    output::catch_interrupts();
    let path = &options.output;
    let to_failure =
        |error: WriteError| Failure::run(format!("cannot write {}", path.display()), &error);
    output::keep_existing(OutputKind::Recording, path, options.overwrite)?;
    // The file is created with the first sample: until then, a file to be overwritten is kept.
    let mut recorder: Option<Recorder<File>> = None;

    let since = Instant::now();
    let limit = options.seconds.map(Duration::from_secs_f64);
    let mut samples = 0_u64;
    let mut left_out = 0_u64;
    let mut first_s = None;
    let mut last = Duration::ZERO;
    let mut fresh = false;
    let mut torques = None;
    let hardware_id = robot.name().to_owned();
    let mut noted = false;
    let mut progress = Progress::of_recording();
    while !interrupt::has_come() && limit.is_none_or(|limit| since.elapsed() < limit) {
        let published = match stream.next(POLL) {
            Ok(published) => published,
            Err(error) if samples == 0 => return Err(connection::link_failure(&error)),
            // The samples so far are kept.
            Err(error) => {
                progress.aside(|| print_note(&format!("The stream broke off: {error}\n")));
                break;
            }
        };
        // The clock of the file starts with the first sample.
        let since_first =
            |t_s: f64| first_s.and_then(|first_s| Duration::try_from_secs_f64(t_s - first_s).ok());
        if let (Some(sensors), Some(recorder)) = (&mut sensors, &mut recorder)
            && let Some(parts) = sensors.read(&hardware_id)
        {
            reported(recorder.diagnostics(last, &parts)).map_err(to_failure)?;
        }
        match published {
            Some(Published::Torques { t_s, measured_nm, .. }) => torques = Some((t_s, measured_nm)),
            Some(Published::State { t_s, state }) => {
                if let (Some(t), Some(recorder)) = (since_first(t_s), &mut recorder) {
                    let parts = [diagnostics::drive(state, &hardware_id)];
                    reported(recorder.diagnostics(t, &parts)).map_err(to_failure)?;
                }
            }
            Some(Published::Joints { t_s, joints_rad }) => {
                let from_s = *first_s.get_or_insert(t_s);
                let t = Duration::try_from_secs_f64(t_s - from_s).unwrap_or_default();
                // A restarted drive counts from 0; the recording then continues at the current
                // time.
                if samples > 0 && t <= last {
                    let now = since.elapsed().max(last + Duration::from_millis(1));
                    first_s = Some(t_s - now.as_secs_f64());
                    left_out += 1;
                    continue;
                }
                let of_now = torques.take().filter(|(torques_s, _)| *torques_s == t_s);
                let torques_nm = of_now.as_ref().map(|(_, torques_nm)| torques_nm);
                let recorder = if let Some(recorder) = &mut recorder {
                    recorder
                } else {
                    // Another program may have created the file meanwhile.
                    let begun = Recorder::create(path, options.overwrite, &robot, config(options));
                    recorder.insert(begun.map_err(to_failure)?)
                };
                recorder.sample_with_torques(t, &joints_rad, torques_nm).map_err(to_failure)?;
                (last, fresh) = (t, true);
                samples += 1;
                progress.show(samples);
            }
            Some(_) => {}
            None => {
                if let (true, Some(recorder)) = (std::mem::take(&mut fresh), &mut recorder) {
                    recorder.flush().map_err(to_failure)?;
                }
                progress.alive();
                if samples == 0 && !noted && since.elapsed() > NOTE_AFTER {
                    noted = true;
                    let address = &options.stream;
                    progress.aside(|| {
                        print_note(&format!(
                            "Nothing received from {address} yet; is `iiwasim drive` running \
                             there?\n"
                        ));
                    });
                }
            }
        }
    }
    progress.clear();
    let Some(recorder) = recorder else { return Err(nothing_came(options)) };
    let metadata = [("sample_count".to_owned(), samples.to_string())].into();
    recorder.finish(&metadata, &[]).map_err(to_failure)?;
    let left_out = if left_out > 0 { format!(", {left_out} left out") } else { String::new() };
    output::print(&format!(
        "{samples} samples{left_out} over {:.3} s in {}\n",
        last.as_secs_f64(),
        path.display()
    ))
}

fn nothing_came(options: &Record) -> Failure {
    let address = &options.stream;
    let message = format!(
        "nothing was recorded: nothing came from {address}; is `iiwasim drive` running there?"
    );
    Failure::Run { message, cause: None }
}

/// Returns the recorder options with the start time.
fn config(options: &Record) -> RecorderConfig {
    let epoch = options.epoch.unwrap_or_else(now);
    let file = Config { epoch, names: options.ros.names(), ..Config::default() };
    RecorderConfig { file, ..RecorderConfig::default() }
}

/// Ignores a message that repeats the stamp of the previous one.
fn reported(written: Result<(), WriteError>) -> Result<(), WriteError> {
    written.or_else(|error| match error {
        WriteError::NotIncreasing { .. } => Ok(()),
        error => Err(error),
    })
}
