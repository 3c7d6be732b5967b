//! Content of a data file.

use iiwa_kin::{Status, Turn};
use iiwa_program::{Frame, Load};

/// Content of the `RoboticsAPI.data.xml` of a Sunrise project: the frames of its world, and its
/// tool templates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DataFile {
    /// Frames in the world frame, which is the robot base.
    pub frames: Vec<WorldFrame>,
    /// Tool templates.
    pub tools: Vec<ToolTemplate>,
    /// Workpiece templates: tools that are attached to other tools.
    pub workpieces: Vec<ToolTemplate>,
    /// Values that the operator may change.
    pub process_data: Vec<ProcessData>,
    /// Skipped entries, by kind.
    pub not_taken: Vec<NotTaken>,
}

impl DataFile {
    /// Returns the value of process data: the operator's value, or else the default.
    #[must_use]
    pub fn setting(&self, id: &str) -> Option<&str> {
        let data = self.process_data.iter().find(|data| data.id == id)?;
        data.value.as_deref().or(data.default_value.as_deref())
    }
}

/// Frame of the world, with its child frames.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldFrame {
    /// Name.
    pub name: String,
    /// Pose relative to the parent frame.
    pub frame: Frame,
    /// Redundancy at the taught frame.
    pub redundancy: Option<TaughtRedundancy>,
    /// Robot and TCP at the time of teaching.
    pub teaching: Option<Teaching>,
    /// Child frames.
    pub children: Vec<Self>,
}

/// Redundancy at a taught frame: Sunrise's `LBRE1Redundancy`.
#[derive(Clone, Debug, PartialEq)]
pub struct TaughtRedundancy {
    /// Name of the robot.
    pub device: String,
    /// Position of joint A3 in rad.
    pub e1_rad: Option<f64>,
    /// Status.
    pub status: Option<Status>,
    /// Turn.
    pub turn: Option<Turn>,
}

/// Robot and TCP with which a frame was taught.
#[derive(Clone, Debug, PartialEq)]
pub struct Teaching {
    /// Name of the robot.
    pub device: String,
    /// TCP that was at the frame, as `TOOL/FRAME`.
    pub tcp_name: String,
    /// Pose of that TCP in the flange frame at the time of teaching.
    pub tcp: Frame,
}

/// Tool template.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolTemplate {
    /// Name.
    pub name: String,
    /// Java class with its package, if stated.
    pub class: Option<String>,
    /// Path of the default motion frame, as `/FRAME`.
    pub default_frame: Option<String>,
    /// Frames; the outermost ones are relative to the flange.
    pub frames: Vec<ToolFrame>,
    /// Load, if determined.
    pub load: Option<Load>,
}

/// Frame of a tool, with its child frames.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolFrame {
    /// Name.
    pub name: String,
    /// Pose relative to the parent frame.
    pub frame: Frame,
    /// Child frames.
    pub children: Vec<Self>,
}

/// Value that the operator may change and that applications query.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ProcessData {
    /// Id by which applications query the value.
    pub id: String,
    /// Java class: `java.lang.Double`, `Integer`, `Boolean` or `String`.
    pub data_type: String,
    /// Value until the operator changes it.
    pub default_value: Option<String>,
    /// Value that the operator has set.
    pub value: Option<String>,
    /// Lower bound.
    pub min: Option<String>,
    /// Upper bound.
    pub max: Option<String>,
}

/// Kind of entry that programs do not use, or that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotTaken {
    /// Kind of the entry.
    pub kind: String,
    /// Number of entries.
    pub count: usize,
    /// Reason for skipping.
    pub reason: String,
}
