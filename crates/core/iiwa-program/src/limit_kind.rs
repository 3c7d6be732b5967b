//! The kinds of limits.

use std::fmt;

use enum_map::{Enum, EnumMap};

/// The least share of a limit: at a millionth of its speed the arm takes weeks for half a turn.
pub(crate) const MIN_SHARE: f64 = 1e-6;

/// Whether a number may be a share of a limit.
pub(crate) fn is_share(number: f64) -> bool {
    (MIN_SHARE..=1.0).contains(&number)
}

/// What a share is that was given in per cent.
pub(crate) fn percent(found: f64) -> String {
    if (2.0..=100.0).contains(&found) {
        format!(" ({found} % is {})", (1e4 * found).round() / 1e6)
    } else {
        String::new()
    }
}

/// A kind of limit of a joint, or of the TCP.
///
/// ```
/// use iiwa_program::LimitKind;
///
/// let jerk = LimitKind::ALL[2];
/// assert_eq!((jerk.name(), jerk.order()), ("jerk", 3));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Enum)]
#[non_exhaustive]
pub enum LimitKind {
    /// Speed.
    Velocity,
    /// Acceleration.
    Acceleration,
    /// Jerk.
    Jerk,
}

impl LimitKind {
    /// All kinds, by their order.
    pub const ALL: [Self; 3] = [Self::Velocity, Self::Acceleration, Self::Jerk];

    /// Its name in files: `velocity`, `acceleration` or `jerk`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
        }
    }

    /// The derivative of the position by time that it limits: 1 for velocity, 2, 3. Its unit is rad, or m, over s
    /// to this power.
    #[must_use]
    pub fn order(self) -> u8 {
        match self {
            Self::Velocity => 1,
            Self::Acceleration => 2,
            Self::Jerk => 3,
        }
    }

    /// The key of a motion's share of it in programs: `velocity_rel`, `acceleration_rel` or `jerk_rel`.
    pub(crate) fn share_key(self) -> &'static str {
        match self {
            Self::Velocity => "velocity_rel",
            Self::Acceleration => "acceleration_rel",
            Self::Jerk => "jerk_rel",
        }
    }
}

/// A value for each kind of limit.
pub type ByKind<T> = EnumMap<LimitKind, T>;

impl fmt::Display for LimitKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
