//! Peer: time parameterisation with velocity and acceleration limits by the `topp2_ra` of the crate
//! `copp`, a TOPP-RA (Pham and Pham 2018) with the limits kept at both ends of each interval.

use copp::{diag::CoppError, robot::Robot, solver::topp2_ra as ra};
use iiwa_kin::Joints;
use iiwa_path::{JointPath, Step};
use nalgebra::DMatrix;

use super::Result;

/// Path from its start to its first stop, sampled: derivatives by the distance in joint space, and
/// limits.
#[derive(Debug, Default)]
pub struct AccelerationSamples {
    /// Distance from the start, measured by the tangent lengths of the pieces, in rad.
    distance: Vec<f64>,
    first: Vec<Joints>,
    second: Vec<Joints>,
    velocity: Vec<Joints>,
    acceleration: Vec<Joints>,
}

impl AccelerationSamples {
    /// Samples `path` at `intervals` equal intervals per segment.
    ///
    /// # Errors
    ///
    /// An error if the arm stops before the path's last segment, since the peer does not support
    /// stops.
    pub fn new(path: &JointPath, intervals: usize) -> Result<Self> {
        let moves =
            path.steps().iter().take_while(|step| matches!(step, Step::Move { .. })).count();
        let (moves, rest) = path.steps().split_at(moves);
        if rest.iter().any(|step| matches!(step, Step::Move { .. })) {
            return Err("the program stops in between".into());
        }
        let mut samples = Self::default();
        let mut start = 0.0;
        for step in moves {
            let Step::Move { motion, segment, .. } = step else { continue };
            let limits = &path.limits()[motion.index()];
            let length = segment.tangent_lengths_rad()[0];
            for i in 0..=intervals {
                let s = i as f64 / intervals as f64;
                let point = segment.at(s);
                if i == 0
                    && let Some(last) = samples.velocity.len().checked_sub(1)
                {
                    // The limits of both neighbours apply at their join.
                    lower_to(&mut samples.velocity[last], limits.velocity_rad_s());
                    lower_to(&mut samples.acceleration[last], limits.acceleration_rad_s2());
                    continue;
                }
                samples.distance.push(start + s * length);
                samples.first.push(point.dq.map(|v| v / length));
                samples.second.push(point.ddq.map(|v| v / (length * length)));
                samples.velocity.push(*limits.velocity_rad_s());
                samples.acceleration.push(*limits.acceleration_rad_s2());
            }
            start += length;
        }
        Ok(samples)
    }

    /// Number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.distance.len()
    }

    /// Returns the problem of the solver, with its own copy of the samples.
    ///
    /// # Errors
    ///
    /// An error if the solver rejects the samples.
    pub fn problem(&self) -> std::result::Result<Problem, CoppError> {
        let n = self.nodes();
        let matrix = |rows: &[Joints]| DMatrix::from_column_slice(7, n, rows.as_flattened());
        let (first, second) = (matrix(&self.first), matrix(&self.second));
        let (velocity, acceleration) = (matrix(&self.velocity), matrix(&self.acceleration));
        // Only torque limits depend on positions.
        let position = DMatrix::zeros(7, n);
        let mut robot = Robot::with_capacity(7, n);
        robot
            .with_s(&self.distance)?
            .with_q(&position.as_view(), &first.as_view(), &second.as_view(), None, 0)?
            .with_axial_velocity(&velocity.as_view(), &(-&velocity).as_view(), 0)?
            .with_axial_acceleration(&acceleration.as_view(), &(-&acceleration).as_view(), 0)?;
        Ok(Problem { robot, distance: self.distance.clone() })
    }
}

fn lower_to(values: &mut Joints, others: &Joints) {
    for (value, other) in values.iter_mut().zip(others) {
        *value = value.min(*other);
    }
}

/// Problem of the solver.
pub struct Problem {
    robot: Robot<usize>,
    distance: Vec<f64>,
}

impl Problem {
    /// Solves the problem, and returns the time in motion in s.
    ///
    /// # Errors
    ///
    /// An error if the solver finds no solution.
    pub fn solve(&self) -> std::result::Result<f64, CoppError> {
        let last = self.distance.len() - 1;
        let problem = ra::Topp2ProblemBuilder::new(&self.robot, (0, last), (0.0, 0.0)).build()?;
        let squared_speed = ra::topp2_ra(&problem, &ra::ReachSet2OptionsBuilder::new().build()?)?;
        Ok(ra::s_to_t_topp2(&self.distance, &squared_speed, 0.0)?.0)
    }
}
