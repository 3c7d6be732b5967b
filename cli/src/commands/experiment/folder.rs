//! The output folder of an experiment.

use std::{
    fs,
    path::{Path, PathBuf},
};

use iiwa_eval::experiment::Trial;
use iiwa_kin::Robot;
use iiwa_log::JointLog;

use crate::{failure::Failure, output, runner};

/// A folder for programs, recordings and figures. Each file in it appears whole or not at all.
pub(crate) struct Folder {
    path: PathBuf,
    recordings: bool,
}

impl Folder {
    /// A folder that is made with its first file. With `new`, it has to be empty or missing: recordings of a robot
    /// cannot be made again.
    pub(crate) fn new(path: &Path, recordings: bool, new: bool) -> Result<Self, Failure> {
        let full = fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_some());
        if new && full {
            return Err(Failure::input(format!(
                "{} is not empty; recordings of a robot are not written over other files: name another \
                 folder with --output",
                path.display()
            )));
        }
        if path.is_file() {
            return Err(Failure::input(format!("{} is a file, not a folder", path.display())));
        }
        Ok(Self { path: path.to_owned(), recordings })
    }

    /// Writes a program and its recording.
    pub(crate) fn run(&self, trial: &Trial, log: &JointLog, robot: &Robot) -> Result<(), Failure> {
        if !self.recordings {
            return Ok(());
        }
        let name = &trial.name;
        let program = trial.program.to_json();
        self.write(&format!("programs/{name}.json"), format!("{program}\n").as_bytes())?;
        let from_s = log.t_s.first().copied().unwrap_or_default();
        let time = |t_s: &f64| std::time::Duration::try_from_secs_f64(t_s - from_s).ok();
        let samples: Vec<_> =
            log.t_s.iter().zip(&log.q_rad).filter_map(|(t_s, q)| Some((time(t_s)?, q))).collect();
        let mcap = runner::recording(&samples, None, robot, &program)?;
        self.write(&format!("recordings/{name}.mcap"), &mcap)?;
        let mut csv = Vec::new();
        log.write_csv(&mut csv)
            .map_err(|error| Failure::run("cannot write the recording", &error))?;
        self.write(&format!("recordings/{name}.csv"), &csv)
    }

    /// Writes a file of the folder.
    pub(crate) fn write(&self, name: &str, content: &[u8]) -> Result<(), Failure> {
        write(&self.path.join(name), content)
    }
}

/// Writes a file, in a folder that is made if there is none.
pub(crate) fn write(path: &Path, content: &[u8]) -> Result<(), Failure> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)
            .map_err(|error| Failure::run(format!("cannot make {}", folder.display()), &error))?;
    }
    output::write(path, content)
}
