//! What a data file says.

use iiwa_kin::{Status, Turn};
use iiwa_program::{Frame, Load};

/// The file `RoboticsAPI.data.xml` of a Sunrise project: the frames of its world, and the templates of its tools.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DataFile {
    /// The frames in the world, which is the robot's foot.
    pub frames: Vec<WorldFrame>,
    /// The templates of tools.
    pub tools: Vec<ToolTemplate>,
    /// The templates of workpieces: tools that are attached to others.
    pub workpieces: Vec<ToolTemplate>,
    /// The values that the operator may change.
    pub process_data: Vec<ProcessData>,
    /// What was passed over, by kinds.
    pub not_taken: Vec<NotTaken>,
}

impl DataFile {
    /// The value of process data: what the operator has made of it, or else its default.
    #[must_use]
    pub fn setting(&self, id: &str) -> Option<&str> {
        let own = self.process_data.iter().find(|own| own.id == id)?;
        own.value.as_deref().or(own.default_value.as_deref())
    }
}

/// A frame of the world, and those that are given in it.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldFrame {
    /// Its name.
    pub name: String,
    /// Where it is in the one that it is in.
    pub frame: Frame,
    /// How the arm reached it.
    pub redundancy: Option<TaughtRedundancy>,
    /// What it was taught with.
    pub teaching: Option<Teaching>,
    /// Those that are given in it.
    pub children: Vec<Self>,
}

/// How the arm reached a frame: Sunrise's `LBRE1Redundancy`.
#[derive(Clone, Debug, PartialEq)]
pub struct TaughtRedundancy {
    /// The robot.
    pub device: String,
    /// The position of joint A3, in rad.
    pub e1_rad: Option<f64>,
    /// The status.
    pub status: Option<Status>,
    /// The turn.
    pub turn: Option<Turn>,
}

/// What a frame was taught with.
#[derive(Clone, Debug, PartialEq)]
pub struct Teaching {
    /// The robot.
    pub device: String,
    /// The TCP that stood there, as `TOOL/FRAME`.
    pub tcp_name: String,
    /// That TCP in the flange's frame, as it was then.
    pub tcp: Frame,
}

/// The template of a tool.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolTemplate {
    /// Its name.
    pub name: String,
    /// Its class in Java, with the package, if that is stated.
    pub class: Option<String>,
    /// The path of the frame that moves unless another is named, as `/FRAME`.
    pub default_frame: Option<String>,
    /// Its frames, the outermost ones in the flange's.
    pub frames: Vec<ToolFrame>,
    /// What it weighs, if that was determined.
    pub load: Option<Load>,
}

/// A frame of a tool, and those that are given in it.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolFrame {
    /// Its name.
    pub name: String,
    /// Where it is in the one that it is in.
    pub frame: Frame,
    /// Those that are given in it.
    pub children: Vec<Self>,
}

/// A value that the operator may change, and for which applications ask.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ProcessData {
    /// By which applications ask for it.
    pub id: String,
    /// Its class in Java: `java.lang.Double`, `Integer`, `Boolean` or `String`.
    pub data_type: String,
    /// What it is until the operator changes it.
    pub default_value: Option<String>,
    /// What the operator has made of it.
    pub value: Option<String>,
    /// The least that it may be.
    pub min: Option<String>,
    /// The most that it may be.
    pub max: Option<String>,
}

/// A kind of entry that programs have no use for, or that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotTaken {
    /// What it is.
    pub what: String,
    /// How many there are.
    pub count: usize,
    /// Why it was passed over.
    pub why: String,
}
