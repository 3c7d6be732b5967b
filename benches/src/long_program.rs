//! Programs of any length.

use std::fmt::Write;

use iiwa_kin::Robot;

use super::joints::Numbers;

/// Kind of transition between the motions of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// All motions blended by a quarter of their segments, without a stop.
    Blended,
    /// All motions blended by a quarter of their segments, with a stop after every tenth motion.
    Stops,
    /// All motions blended within 100 mm, without a stop.
    Radius,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Blended, Self::Stops, Self::Radius];

    /// Name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Blended => "fraction 0.25, no stop",
            Self::Stops => "fraction 0.25, a stop every 10",
            Self::Radius => "100 mm, no stop",
        }
    }
}

/// Returns the text of a program of `motions` motions between points over half of the robot's joint
/// ranges.
#[must_use]
pub fn text(kind: Kind, motions: usize) -> String {
    seeded(kind, motions, 7)
}

/// Returns the text of a program with other points; each `seed` gives its own.
#[must_use]
pub fn seeded(kind: Kind, motions: usize, seed: u64) -> String {
    let robot = Robot::lbr_iiwa_7_r800();
    let mut numbers = Numbers::new(seed);
    let mut joints = || {
        let values = numbers.joints(&robot, 0.5).map(|q| format!("{q:.6}"));
        format!("\"joints_rad\": [{}]", values.join(", "))
    };
    let mut text = format!("{{\n  \"version\": 1,\n  \"start\": {{ {} }},\n", joints());
    text.push_str("  \"motions\": [\n");
    for i in 1..=motions {
        let blend = match kind {
            _ if i == motions => "",
            Kind::Stops if i % 10 == 0 => "",
            Kind::Blended | Kind::Stops => ", \"blend\": { \"fraction\": 0.25 }",
            Kind::Radius => ", \"blend\": { \"cart_mm\": 100 }",
        };
        let comma = if i == motions { "" } else { "," };
        // Writing to a string does not fail.
        let _ = writeln!(text, "    {{ \"type\": \"ptp\", {}{blend} }}{comma}", joints());
    }
    text.push_str("  ]\n}\n");
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use iiwa_path::JointPath;
    use iiwa_program::Program;

    #[test]
    fn can_be_planned() {
        for kind in Kind::ALL {
            let program = Program::from_json(&text(kind, 25)).unwrap();
            assert_eq!(program.motions.len(), 25);
            let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800()).unwrap();
            let stops = if kind == Kind::Stops { 2 } else { 0 };
            assert_eq!(path.blends().count(), 24 - stops);
        }
    }
}
