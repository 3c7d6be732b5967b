//! Swings with and without a payload, which show its effect on a controller's planner.

use iiwa_kin::{Joint, Joints, Load};
use iiwa_program::{Motion, Ptp};

use super::trial::{Trial, program};

/// Joints A2 and A4 at the centre of the swings, in degrees, and the joint that swings: upright and
/// to the side, stretched and bent. The share of gravity in the joint torque varies by an order of
/// magnitude.
const POSES: [([f64; 2], Joint); 8] = [
    ([0.0, 0.0], Joint::A2),
    ([40.0, 0.0], Joint::A2),
    ([65.0, 0.0], Joint::A2),
    ([0.0, -90.0], Joint::A2),
    ([50.0, -60.0], Joint::A2),
    ([0.0, 0.0], Joint::A4),
    ([0.0, -85.0], Joint::A4),
    ([60.0, -30.0], Joint::A4),
];

/// Swing to either side of the centre, in degrees.
const SWING_DEG: f64 = 20.0;

/// Repetitions of each swing.
const TIMES: usize = 2;

/// Speed between poses, as a share of full speed.
const TRANSFER_REL: f64 = 0.25;

/// Swings of a joint about one pose of the experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadSwing {
    /// Joint that swings.
    pub joint: Joint,
    /// A2 and A4 at the centre, in degrees.
    pub middle_deg: [f64; 2],
    /// End positions, in rad.
    pub ends_rad: [Joints; 2],
    /// Indices of its motions in the program.
    pub(crate) motions: std::ops::Range<usize>,
}

/// Returns the swings, in the order of the programs.
#[must_use]
pub fn load_swings() -> Vec<LoadSwing> {
    let per_swing = 1 + 2 * TIMES;
    let swing = |(i, (middle_deg, joint)): (usize, &([f64; 2], Joint))| {
        let end = |deg: f64| {
            let mut at_deg = [0.0; 7];
            (at_deg[1], at_deg[3]) = (middle_deg[0], middle_deg[1]);
            at_deg[joint.index()] += deg;
            at_deg.map(f64::to_radians)
        };
        // The first entry sets the load, and the first motion of each swing moves to its start.
        let first = 1 + i * per_swing + 1;
        LoadSwing {
            joint: *joint,
            middle_deg: *middle_deg,
            ends_rad: [end(-SWING_DEG), end(SWING_DEG)],
            motions: first..first + 2 * TIMES,
        }
    };
    POSES.iter().enumerate().map(swing).collect()
}

/// Creates two programs, of the swings of A2 and A4 without and with a payload: each joint
/// separately, by 20 deg to either side of eight poses, at full speed. Motions between poses are
/// slow.
#[must_use]
pub fn load(load: &Load) -> [Trial; 2] {
    [None, Some(*load)].map(|load| {
        let swings = load_swings();
        let start_rad = swings[0].ends_rad[0];
        let motions = swings.iter().flat_map(|swing| {
            let [low, high] = swing.ends_rad;
            let transfer = Ptp::to(low).velocity(TRANSFER_REL);
            let swings = (0..TIMES).flat_map(move |_| [Ptp::to(high), Ptp::to(low)]);
            std::iter::once(transfer).chain(swings)
        });
        let mut program = program(start_rad, motions);
        program.motions.insert(0, Motion::Load(load.map(Into::into)));
        let mass_kg = load.map_or(0.0, |load| load.mass_kg);
        Trial { name: format!("load-{mass_kg}-kg"), program }
    })
}
