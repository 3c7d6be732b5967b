//! Output folder of an experiment.

use std::{
    cell::Cell,
    fs,
    path::{Path, PathBuf},
    time::Duration,
};

use bytesize::ByteSize;
use iiwa_eval::experiment::Trial;
use iiwa_kin::Robot;
use iiwa_log::{Config, DEFAULT_EPOCH, JointLog};
use iiwa_twin::runs::{began, longest_log, now};

use crate::{args::Experiment, failure::Failure, output, runner};

/// Folder for programs, recordings and figures. Each file is written atomically.
pub(crate) struct Folder {
    path: PathBuf,
    recordings: bool,
    /// `true` for measurements on a robot, `false` for a virtual one.
    of_robot: bool,
    /// Start of the time of all recordings, since 1970.
    epoch: Option<Duration>,
    /// Number of bytes written so far.
    bytes: Cell<u64>,
}

impl Folder {
    /// Returns the folder of the options, which is created with its first file. The folder for a
    /// robot must be empty or missing, since its recordings cannot be repeated.
    pub(crate) fn new(path: &Path, options: &Experiment) -> Result<Self, Failure> {
        let of_robot = options.drive.is_some();
        let full = fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_some());
        if of_robot && full {
            return Err(Failure::input(format!(
                "{} is not empty; recordings of a robot are not written over other files: name \
                 another folder with --output",
                path.display()
            )));
        }
        if path.is_file() {
            return Err(Failure::input(format!("{} is a file, not a folder", path.display())));
        }
        let (recordings, epoch) = (!options.no_recordings, options.epoch);
        Ok(Self { path: path.to_owned(), recordings, of_robot, epoch, bytes: Cell::new(0) })
    }

    /// Fails if recordings that begin now could not be written.
    pub(crate) fn check(&self, robot: &Robot) -> Result<(), Failure> {
        let file = Config { epoch: self.epoch.unwrap_or_else(now), ..Config::default() };
        runner::recording(&longest_log(0.0), file, robot, "").map(drop)
    }

    /// Writes a program and its recording.
    pub(crate) fn run(&self, trial: &Trial, log: &JointLog, robot: &Robot) -> Result<(), Failure> {
        if !self.recordings {
            return Ok(());
        }
        let name = &trial.name;
        let program = trial.program.to_json();
        self.write(&format!("programs/{name}.json"), format!("{program}\n").as_bytes())?;
        let epoch =
            self.epoch.unwrap_or_else(|| if self.of_robot { began(log) } else { DEFAULT_EPOCH });
        let file = Config { epoch, ..Config::default() };
        let mcap = runner::recording(log, file, robot, &program)?;
        self.write(&format!("recordings/{name}.mcap"), &mcap)?;
        let mut csv = Vec::new();
        log.write_csv(&mut csv)
            .map_err(|error| Failure::run("cannot write the recording", &error))?;
        self.write(&format!("recordings/{name}.csv"), &csv)
    }

    /// Writes a file of the folder.
    pub(crate) fn write(&self, name: &str, content: &[u8]) -> Result<(), Failure> {
        self.bytes.set(self.bytes.get() + content.len() as u64);
        write(&self.path.join(name), content)
    }

    /// Describes the size of the folder; `None` without recordings, since it is then small.
    pub(crate) fn size(&self) -> Option<String> {
        let size = ByteSize::b(self.bytes.get()).display().si();
        let path = self.path.display();
        self.recordings.then(|| format!("{size} in {path}; --no-recordings leaves most of it out"))
    }
}

/// Writes a file, and creates its folder if it is missing.
pub(crate) fn write(path: &Path, content: &[u8]) -> Result<(), Failure> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)
            .map_err(|error| Failure::run(format!("cannot make {}", folder.display()), &error))?;
    }
    output::write(path, content)
}
