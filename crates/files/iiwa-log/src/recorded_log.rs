//! Conversion of a joint log to a recording.

use std::{collections::BTreeMap, io::Cursor, iter, time::Duration};

use iiwa_kin::Robot;

use crate::{Config, CycleClock, JointLog, Recorder, RecorderConfig, WriteError};

impl JointLog {
    /// Encodes the log as an MCAP file, with the text of the program that was run.
    ///
    /// # Errors
    ///
    /// [`WriteError`] for a sample that cannot be written.
    pub fn to_mcap(
        &self,
        file: Config,
        robot: &Robot,
        program: &str,
    ) -> Result<Vec<u8>, WriteError> {
        let config = RecorderConfig { file, ..RecorderConfig::default() };
        let mut recorder = Recorder::new(Cursor::new(Vec::new()), robot, config)?;
        let torques_nm = self.torques_nm.iter().map(Option::as_ref).chain(iter::repeat(None));
        for ((t_s, q), torques_nm) in self.t_s.iter().zip(&self.q_rad).zip(torques_nm) {
            let Ok(t) = Duration::try_from_secs_f64(*t_s) else { continue };
            recorder.sample_with_torques(t, q, torques_nm)?;
        }
        let mut metadata =
            BTreeMap::from([("sample_count".to_owned(), self.t_s.len().to_string())]);
        if let Some(cycle_time_s) = self.cycle_time_s {
            metadata.insert("cycle_time_s".to_owned(), cycle_time_s.to_string());
            if self.timed_by != CycleClock::RobotProgram {
                metadata.insert("timed_by".to_owned(), self.timed_by.name().to_owned());
            }
        }
        let program = ("program.json", "application/json", program.as_bytes());
        Ok(recorder.finish(&metadata, &[program])?.into_inner())
    }
}
