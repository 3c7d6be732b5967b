//! Families of random programs, each difficult for a planner in its own way. A program is
//! determined by its family, a seed and its number, so that it can be reproduced.

mod dense;
pub(crate) mod dice;
mod extreme;
mod fine;
mod mixed;
mod plain;
mod sliver;

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Program;

use dice::Dice;

/// Family of random programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Any valid program, with unusual elements more frequent than in practice.
    Plain,
    /// Independent relative velocity, acceleration and jerk of each joint and each motion, from
    /// 0.01 to 1.
    Mixed,
    /// Exact and near reversals; lines almost consumed by blends, between neighbours of very
    /// unequal lengths.
    Sliver,
    /// Motions of 1e-6 to 1e-3 rad.
    Fine,
    /// Relative velocities from 1e-6 to 1, motions of 1e-9 to 5 rad.
    Extreme,
    /// About a hundred points along a smooth curve, all blended.
    Dense,
}

/// Program, and the number of infeasible draws before it.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// Program that [`JointPath::new`] accepts.
    pub program: Program,
    /// Number of earlier draws that were not valid.
    pub redraws: usize,
}

impl Family {
    /// All families.
    pub const ALL: [Self; 6] =
        [Self::Plain, Self::Mixed, Self::Sliver, Self::Fine, Self::Extreme, Self::Dense];

    /// Name of the family.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Mixed => "mixed",
            Self::Sliver => "sliver",
            Self::Fine => "fine",
            Self::Extreme => "extreme",
            Self::Dense => "dense",
        }
    }

    /// Returns the family with this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|family| family.name() == name)
    }

    /// Returns program number `index` of the family.
    #[must_use]
    pub fn program(self, seed: u64, index: u64) -> Drawn {
        if self == Self::Plain {
            return valid(plain::programs(seed, index));
        }
        let mut dice = Dice::new(seed, self.name(), index);
        let draw = match self {
            Self::Plain | Self::Mixed => mixed::program,
            Self::Sliver => sliver::program,
            Self::Fine => fine::program,
            Self::Extreme => extreme::program,
            Self::Dense => dense::program,
        };
        valid(std::iter::repeat_with(|| draw(&mut dice)))
    }
}

/// Returns the first feasible program of an infinite sequence.
fn valid(programs: impl Iterator<Item = Program>) -> Drawn {
    let robot = Robot::default();
    for (redraws, program) in programs.enumerate() {
        if JointPath::new(&program, &robot).is_ok() {
            return Drawn { program, redraws };
        }
    }
    unreachable!("programs are drawn until one is valid")
}

#[cfg(test)]
mod tests {
    use iiwa_program::Motion;

    use super::*;

    #[test]
    fn a_number_is_a_program() {
        for family in Family::ALL {
            assert_eq!(Family::named(family.name()), Some(family));
            let [first, again, other, seeded] = [(3, 5), (3, 5), (3, 6), (4, 5)]
                .map(|(seed, index)| family.program(seed, index).program);
            assert_eq!(first, again);
            assert!(first != other && first != seeded);
        }
    }

    #[test]
    fn programs_can_be_written_and_read() {
        for family in Family::ALL {
            for index in 0..20 {
                let Drawn { program, redraws } = family.program(1, index);
                assert_eq!(Program::from_json(&program.to_json()).unwrap(), program);
                assert!(redraws < 1000, "{redraws} redraws of {} {index}", family.name());
            }
        }
    }

    /// Checks that each family has its defining property.
    #[test]
    fn families_have_their_stated_properties() {
        let ptps = |family: Family| {
            let programs = (0..50).map(move |index| family.program(1, index).program);
            programs.flat_map(|program| {
                let mut position = *program.start.joints_rad().unwrap();
                let moves = program.motions.into_iter().filter_map(move |motion| match motion {
                    Motion::Ptp(ptp) => {
                        let way = iiwa_kin::vector::sub(&ptp.target_rad, &position);
                        position = ptp.target_rad;
                        Some((iiwa_kin::vector::norm(&way), ptp))
                    }
                    _ => None,
                });
                moves.collect::<Vec<_>>()
            })
        };
        let low = ptps(Family::Mixed).flat_map(|(_, ptp)| ptp.jerk_rel).fold(1.0, f64::min);
        assert!((0.01..0.011).contains(&low), "{low}");
        assert!(ptps(Family::Fine).all(|(way, _)| (0.99e-6..1.01e-3).contains(&way)));
        let slow = ptps(Family::Extreme).map(|(_, ptp)| ptp.velocity_rel[0]).fold(1.0, f64::min);
        assert!((1e-6..1e-5).contains(&slow), "{slow}");
        let short = ptps(Family::Extreme).map(|(way, _)| way).fold(1.0, f64::min);
        assert!(short < 1e-8, "{short}");
        let dense = Family::Dense.program(1, 0).program.motions.len();
        assert!((50..=200).contains(&dense), "{dense}");
    }
}
