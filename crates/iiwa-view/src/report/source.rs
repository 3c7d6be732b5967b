//! What a file has for the page.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, Cursor, Read},
    path::{Path, PathBuf},
};

use iiwa_kin::{Joints, Robot};
use iiwa_log::{Entry, JointLog, Loss, Reader, Source as Format, Topic};
use iiwa_path::Program;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::ViewError;

/// A file that was read.
#[derive(Debug)]
pub(crate) struct Source {
    /// As it was named.
    pub(crate) name: String,
    /// The same without its folder: pages are passed on.
    pub(crate) file: String,
    /// Where the joints were.
    pub(crate) log: JointLog,
    /// The trajectory's nodes; none of a recording.
    pub(crate) nodes: Vec<Node>,
    /// Lines, blends, settles and waits; none of a recording.
    pub(crate) pieces: Vec<Piece>,
    /// The figures of a plan, as `iiwasim plan --json` has them.
    pub(crate) figures: Map<String, Value>,
    content: Content,
}

/// Where a file's bytes are.
#[derive(Debug)]
enum Content {
    Stored(PathBuf),
    /// It was made for the page.
    Made(Vec<u8>),
}

/// What a file says of the arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Role {
    /// What it is to do.
    Plan,
    /// The same, without the end of the file: no trajectory, no figures.
    Part,
    /// What it did.
    Recording,
}

/// A node of a trajectory, in rad and s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) t_s: f64,
    pub(crate) q: Joints,
    pub(crate) dq: Joints,
    pub(crate) ddq: Joints,
}

/// A piece of a plan.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Piece {
    /// The motion, from 1.
    pub(crate) motion: u32,
    pub(crate) kind: String,
    pub(crate) start_s: f64,
    pub(crate) end_s: f64,
    /// From 1.
    pub(crate) joint: Option<u8>,
    pub(crate) limit: String,
}

impl Source {
    /// Reads a file, as far as it is whole.
    pub(crate) fn read(path: &Path) -> Result<Self, ViewError> {
        let name = path.display().to_string();
        let log = JointLog::read(open(path)?)
            .and_then(|log| log.check_rate().map(|()| log))
            .map_err(|source| ViewError::Recording { name: name.clone(), source })?;
        Self {
            name,
            log,
            file: path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(),
            nodes: Vec::new(),
            pieces: Vec::new(),
            figures: Map::new(),
            content: Content::Stored(path.to_owned()),
        }
        .with_plan()
    }

    /// Takes an MCAP file that was made for the page, under a name for people.
    pub(crate) fn made(name: &str, content: Vec<u8>) -> Result<Self, ViewError> {
        let log = JointLog::read(content.as_slice())
            .map_err(|source| ViewError::Recording { name: name.to_owned(), source })?;
        Self {
            name: name.to_owned(),
            file: name.to_owned(),
            log,
            nodes: Vec::new(),
            pieces: Vec::new(),
            figures: Map::new(),
            content: Content::Made(content),
        }
        .with_plan()
    }

    /// The file from its start.
    pub(crate) fn open(&self) -> Result<Box<dyn Read + '_>, ViewError> {
        Ok(match &self.content {
            Content::Stored(path) => Box::new(open(path)?),
            Content::Made(bytes) => Box::new(Cursor::new(bytes)),
        })
    }

    pub(crate) fn role(&self) -> Role {
        match (self.nodes.len(), self.pieces.is_empty()) {
            (2.., false) => Role::Plan,
            (_, false) => Role::Part,
            (_, true) => Role::Recording,
        }
    }

    /// The program that the file holds, if it can be read.
    pub(crate) fn program(&self) -> Option<Program> {
        self.log.program.as_deref().and_then(|text| Program::from_json(text).ok())
    }

    /// What a plan has beside joint states, up to where the file breaks off: the joint states have
    /// told that it does.
    fn with_plan(self) -> Result<Self, ViewError> {
        if self.log.source != Some(Format::Mcap) {
            return Ok(self);
        }
        let topics = [Topic::JointTrajectory, Topic::Motion];
        let (mut nodes, mut pieces) = (Vec::<Node>::new(), Vec::<Piece>::new());
        let mut metadata = BTreeMap::new();
        for entry in Reader::new(self.open()?).only(&topics) {
            let entry = match entry {
                Ok(entry) => entry,
                Err(_) if self.broken_off() => break,
                Err(source) => {
                    return Err(ViewError::Plan { name: self.name.clone(), source });
                }
            };
            match entry {
                Entry::Trajectory { t_s, points } => {
                    // A part of a long trajectory begins with the last point of the part before.
                    let last_s = nodes.last().map_or(f64::NEG_INFINITY, |last| last.t_s);
                    let more = points.iter().map(|point| Node {
                        t_s: t_s + point.time_from_start.as_secs_f64(),
                        q: point.positions,
                        dq: point.velocities,
                        ddq: point.accelerations,
                    });
                    nodes.extend(more.filter(|node| node.t_s > last_s + 1e-10));
                }
                Entry::Motion(sample) => {
                    if let Some(before) = pieces.last_mut() {
                        before.end_s = sample.t_s;
                    }
                    pieces.push(Piece {
                        motion: sample.motion.index,
                        kind: sample.motion.kind.into_owned(),
                        start_s: sample.t_s,
                        end_s: sample.t_s,
                        joint: sample.motion.limiting_joint,
                        limit: sample.motion.limiting_kind.into_owned(),
                    });
                }
                Entry::Metadata { name, entries } if name == "iiwasim" => metadata.extend(entries),
                _ => {}
            }
        }
        if let (Some(last), Some(end_s)) = (pieces.last_mut(), self.log.t_s.last()) {
            last.end_s = last.start_s.max(*end_s);
        }
        // A number or a list is JSON in the record, a text is as it is.
        let value = |text: String| serde_json::from_str(&text).unwrap_or(Value::String(text));
        let figures = metadata.into_iter().map(|(key, text)| (key, value(text))).collect();
        Ok(Self { nodes, pieces, figures, ..self })
    }

    /// Whether the file is cut off or damaged.
    fn broken_off(&self) -> bool {
        self.log.losses.iter().any(|loss| matches!(loss, Loss::BrokenOff { .. }))
    }

    /// The robot that was asked for, or the file's, or the default one; and what is assumed.
    pub(crate) fn robot(
        &self,
        asked: Option<&Robot>,
    ) -> Result<(Robot, Option<String>), ViewError> {
        if let Some(robot) = asked {
            return Ok((robot.clone(), None));
        }
        let Some(name) = &self.log.robot else {
            let robot = Robot::default();
            let note = format!("{} names no robot: taken for {}", self.name, robot.name());
            return Ok((robot, Some(note)));
        };
        let robot = Robot::built_in(name).ok_or_else(|| ViewError::UnknownRobot {
            name: self.name.clone(),
            robot: name.clone(),
        })?;
        Ok((robot, None))
    }

    /// Refuses positions that the robot does not have.
    pub(crate) fn check(&self, robot: &Robot) -> Result<(), ViewError> {
        self.log
            .check_robot(robot)
            .map_err(|source| ViewError::Recording { name: self.name.clone(), source })
    }

    /// What the file does not have, for people.
    pub(crate) fn losses(&self) -> Vec<String> {
        const SHOWN: usize = 5;
        let losses = &self.log.losses;
        let mut told: Vec<String> =
            losses.iter().take(SHOWN).map(|loss| format!("{}: {loss}", self.name)).collect();
        if losses.len() > SHOWN {
            told.push(format!("{}: and {} more losses", self.name, losses.len() - SHOWN));
            // Where it ends is what people ask first.
            if let Some(end @ Loss::BrokenOff { .. }) = losses.last() {
                told.push(format!("{}: {end}", self.name));
            }
        }
        told
    }
}

/// Opens a file.
fn open(path: &Path) -> Result<File, ViewError> {
    let refuse = |source| ViewError::Open { name: path.display().to_string(), source };
    let file = File::open(path).map_err(refuse)?;
    if file.metadata().is_ok_and(|kind| kind.is_dir()) {
        return Err(refuse(io::Error::from(io::ErrorKind::IsADirectory)));
    }
    Ok(file)
}
