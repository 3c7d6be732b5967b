//! Motion types.

use crate::{
    cartesian_motion::Course,
    io_entry::{IoEntry, IoKind},
    program::Motion,
};

/// Type of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MotionType {
    /// Point to point, to joint positions.
    #[default]
    Ptp,
    /// Point to point, to a frame.
    PtpToFrame,
    /// Straight TCP line to a frame.
    Lin,
    /// Straight TCP line by an offset.
    LinRel,
    /// TCP circle.
    Circ,
    /// TCP spline of several segments.
    Spline,
    /// TCP spline of one segment.
    Spl,
    /// Wait.
    Wait,
    /// Payload change.
    Load,
    /// Setting of an output.
    Set,
    /// Wait for an input.
    WaitFor,
}

impl MotionType {
    /// All types; of the two point-to-point types, the one to joint positions.
    const ALL: [Self; 10] = [
        Self::Ptp,
        Self::Lin,
        Self::LinRel,
        Self::Circ,
        Self::Spline,
        Self::Spl,
        Self::Wait,
        Self::Load,
        Self::Set,
        Self::WaitFor,
    ];

    /// Names of all types in programs.
    pub(crate) const NAMES: [&'static str; 10] = {
        let mut names = [""; 10];
        let mut i = 0;
        while i < names.len() {
            names[i] = Self::ALL[i].name();
            i += 1;
        }
        names
    };

    /// Name in programs: `ptp`, `lin`, `lin_rel`, `circ`, `spline`, `spl`, `wait`, `load`, `set` or
    /// `wait_for`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ptp | Self::PtpToFrame => "ptp",
            Self::Lin => "lin",
            Self::LinRel => "lin_rel",
            Self::Circ => "circ",
            Self::Spline => "spline",
            Self::Spl => "spl",
            Self::Wait => "wait",
            Self::Load => "load",
            Self::Set => "set",
            Self::WaitFor => "wait_for",
        }
    }

    /// Motion type with a name; `ptp` gives the type to joint positions.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|motion_type| motion_type.name() == name)
    }

    /// Motion type that other robot languages call `name`.
    pub(crate) fn of_other_language(name: &str) -> Option<Self> {
        let letters = name.chars().filter(char::is_ascii_alphanumeric);
        match letters.collect::<String>().to_ascii_lowercase().as_str() {
            "movej" | "moveabsj" | "movejoint" | "joint" | "pointtopoint" => Some(Self::Ptp),
            "movel" | "moveline" | "linear" | "line" => Some(Self::Lin),
            "linrel" | "linearrelative" => Some(Self::LinRel),
            "movec" | "circular" | "circle" | "arc" => Some(Self::Circ),
            "delay" | "dwell" | "pause" | "sleep" | "waitsec" => Some(Self::Wait),
            "payload" | "setpayload" => Some(Self::Load),
            "setdo" | "setio" | "setoutput" | "setdigitalout" | "setdigitaloutput" | "output" => {
                Some(Self::Set)
            }
            "waitdi" | "waitinput" | "waitio" | "waituntil" | "waitforinput" | "input" => {
                Some(Self::WaitFor)
            }
            _ => None,
        }
    }

    /// Returns true if the target is a TCP frame.
    #[must_use]
    pub fn is_cartesian(self) -> bool {
        self.moves() && self != Self::Ptp
    }

    /// Returns true if the robot moves.
    #[must_use]
    pub fn moves(self) -> bool {
        !matches!(self, Self::Wait | Self::Load | Self::Set | Self::WaitFor)
    }

    /// Returns true if the program may wait: a wait of a given time, or for an input.
    #[must_use]
    pub fn waits(self) -> bool {
        matches!(self, Self::Wait | Self::WaitFor)
    }
}

impl IoEntry {
    /// Type of the entry in programs.
    #[must_use]
    pub fn motion_type(&self) -> MotionType {
        match self.kind {
            IoKind::Set => MotionType::Set,
            IoKind::WaitFor { .. } => MotionType::WaitFor,
        }
    }
}

impl Motion {
    /// Type of the motion.
    #[must_use]
    pub fn motion_type(&self) -> MotionType {
        match self {
            Self::Ptp(_) => MotionType::Ptp,
            Self::Wait { .. } => MotionType::Wait,
            Self::Load(_) => MotionType::Load,
            Self::Io(entry) => entry.motion_type(),
            Self::Cartesian(cartesian) => match cartesian.course {
                Course::Ptp { .. } => MotionType::PtpToFrame,
                Course::Lin { .. } => MotionType::Lin,
                Course::LinRel { .. } => MotionType::LinRel,
                Course::Circ(_) => MotionType::Circ,
                Course::Spline(_) if cartesian.is_single_spl() => MotionType::Spl,
                Course::Spline(_) => MotionType::Spline,
            },
        }
    }
}
