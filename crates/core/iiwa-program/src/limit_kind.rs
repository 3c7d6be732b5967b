//! Limit kinds.

use std::fmt;

use enum_map::{Enum, EnumMap};

/// Smallest share of a limit: at a millionth of its speed the robot takes weeks for half a turn.
pub(crate) const MIN_SHARE: f64 = 1e-6;

/// Returns true if a number is a valid share of a limit.
pub(crate) fn is_share(number: f64) -> bool {
    (MIN_SHARE..=1.0).contains(&number)
}

/// Hint for a share that was probably given in per cent.
pub(crate) fn percent(share: f64) -> String {
    if (2.0..=100.0).contains(&share) {
        format!(" ({share} % is {})", (1e4 * share).round() / 1e6)
    } else {
        String::new()
    }
}

/// Kind of a joint limit or a TCP limit.
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
    /// All kinds, by order of derivative.
    pub const ALL: [Self; 3] = [Self::Velocity, Self::Acceleration, Self::Jerk];

    /// Name in files: `velocity`, `acceleration` or `jerk`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
        }
    }

    /// Order of the limited time derivative of the position: 1 for velocity, 2, 3. The unit is rad,
    /// or m, over s to this power.
    #[must_use]
    pub fn order(self) -> u8 {
        match self {
            Self::Velocity => 1,
            Self::Acceleration => 2,
            Self::Jerk => 3,
        }
    }

    /// Key of a motion's share of this limit in programs: `velocity_rel`, `acceleration_rel` or
    /// `jerk_rel`.
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
