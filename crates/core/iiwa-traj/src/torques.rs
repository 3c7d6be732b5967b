//! Joint torques along a trajectory, and the work of the joints.

use iiwa_kin::{Dynamics, Joints};
use iiwa_program::MotionIndex;

use crate::{
    section::{Piece, Section},
    state::State,
    trajectory::Trajectory,
};

/// Joint torques at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointTorques {
    /// Total torques, including friction if the robot profile has any, in Nm.
    pub torque_nm: Joints,
    /// Gravity torques of the arm and its payload, in Nm.
    pub gravity_nm: Joints,
}

/// Torques of one entry of the program's list of motions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionTorques {
    /// Index in the program.
    pub motion: MotionIndex,
    /// Largest torque of each joint, with its sign, in Nm.
    pub peak_nm: Joints,
    /// Absolute peak torque as a share of the robot's limit.
    pub peak_rel: Joints,
    /// Time of the peak, in s from the start of the program.
    pub peak_at_s: Joints,
    /// Largest holding torque of each joint at any point of the motion, with its sign, in Nm.
    pub static_nm: Joints,
}

/// Torques of a whole trajectory, or of its sections so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TorqueFigures {
    /// Torques of the motions, in the order and number of [`Trajectory::motions`].
    pub motions: Vec<MotionTorques>,
    /// Work done by each joint, in J.
    pub positive_work_j: Joints,
    /// Work done on each joint, in J: 0 or less.
    pub negative_work_j: Joints,
    /// Largest total power output, in W; power that other joints absorb at the same time is not
    /// subtracted.
    pub peak_power_w: f64,
    /// Time of the peak power, in s from the start of the program.
    pub peak_power_at_s: f64,
}

/// Largest joint rotation between two instants at which torques are computed, in rad.
const MAX_RAD: f64 = 0.05;

impl Trajectory {
    /// Returns the torques at `t_s`, with the payload at that time and the installation of the
    /// robot.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::Program;
    /// use iiwa_traj::{Timing, Trajectory};
    ///
    /// let program = Program::from_deg([0.0, 90.0, 0.0, 0.0, 0.0, 0.0, 0.0]).wait_s(1.0).build();
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let torques = Trajectory::plan(&path, Timing::default())?.torques_at(0.5);
    /// assert!((torques.torque_nm[1] + 65.3).abs() < 0.05);
    /// let at_rest = |j: usize| (torques.torque_nm[j] - torques.gravity_nm[j]).abs() < 1e-12;
    /// assert!((0..7).all(at_rest));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn torques_at(&self, t_s: f64) -> JointTorques {
        self.torques_of(&self.at(t_s))
    }

    /// Returns the torques in a state of this trajectory, such as those of
    /// [`samples`](Self::samples) and [`states`](Self::states).
    #[must_use]
    pub fn torques_of(&self, state: &State) -> JointTorques {
        let dynamics = self.path().dynamics(state.motion);
        JointTorques {
            torque_nm: exerted(&dynamics, state),
            gravity_nm: dynamics.gravity_torques(&state.q),
        }
    }

    /// Returns the largest torques of all motions, and the work of the joints.
    ///
    /// Both are computed at all nodes and at instants between. The work equals the gain in energy
    /// of arm and payload plus, with friction, the energy dissipated.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::Program;
    /// use iiwa_traj::{Timing, Trajectory};
    ///
    /// let up = [0.0; 7];
    /// let program = Program::from_deg([0.0, 90.0, 0.0, 0.0, 0.0, 0.0, 0.0]).ptp_deg(up).build();
    /// let robot = Robot::default();
    /// let path = JointPath::new(&program, &robot)?;
    /// let figures = Trajectory::plan(&path, Timing::default())?.torques();
    /// let lifted: f64 = figures.positive_work_j.iter().chain(&figures.negative_work_j).sum();
    /// let height = |q| robot.dynamics().potential_energy_j(q);
    /// assert!((lifted - (height(&up) - height(path.start_rad()))).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn torques(&self) -> TorqueFigures {
        let mut figures = TorqueFigures::default();
        self.sections().iter().for_each(|section| figures.add(section));
        figures
    }
}

/// Joint torques in one state of a trajectory after the other. The equations of motion are kept
/// until the next motion.
#[derive(Clone, Debug, Default)]
pub struct MotionDynamics(Option<(MotionIndex, Dynamics)>);

impl MotionDynamics {
    /// Returns the joint torques in a state of a section, including friction if the robot profile
    /// has any, in Nm. All sections must belong to one path.
    pub fn torque_nm(&mut self, section: &Section, state: &State) -> Joints {
        let kept = self.0.take().filter(|(motion, _)| *motion == state.motion);
        let new = || (state.motion, section.path().dynamics(state.motion));
        let (_, dynamics) = self.0.insert(kept.unwrap_or_else(new));
        exerted(dynamics, state)
    }
}

/// Returns the joint torques in a state, including friction, in Nm.
fn exerted(dynamics: &Dynamics, state: &State) -> Joints {
    let rigid = dynamics.torques(&state.q, &state.dq, &state.ddq);
    let friction = dynamics.friction().torques_nm(&state.dq);
    std::array::from_fn(|j| rigid[j] + friction[j])
}

/// Instants of a motion with their weights in an integral over time, in s.
#[derive(Default)]
struct WeightedInstants {
    t_s: Vec<f64>,
    weight_s: Vec<f64>,
    velocity: Vec<Joints>,
    torque: Vec<Joints>,
    /// Gravity torques at the same poses.
    gravity: Vec<Joints>,
}

impl WeightedInstants {
    fn of(section: &Section, pieces: &[Piece], dynamics: &Dynamics) -> Self {
        let (mut samples, mut q, mut ddq) = (Self::default(), Vec::new(), Vec::new());
        let mut add = |state: &State, weight_s: f64| {
            samples.t_s.push(state.t_s);
            samples.weight_s.push(weight_s);
            samples.velocity.push(state.dq);
            q.push(state.q);
            ddq.push(state.ddq);
        };
        for piece in pieces {
            section.integrate(piece, MAX_RAD, &mut add);
            if !piece.kind.moves() {
                add(&section.resting_in(piece), 0.0);
            }
        }
        samples.torque = vec![[0.0; 7]; q.len()];
        samples.gravity.clone_from(&samples.torque);
        dynamics.torques_with_gravity_batch(
            &q,
            &samples.velocity,
            &ddq,
            &mut samples.torque,
            &mut samples.gravity,
        );
        for (torque, velocity) in samples.torque.iter_mut().zip(&samples.velocity) {
            let friction = dynamics.friction().torques_nm(velocity);
            *torque = std::array::from_fn(|j| torque[j] + friction[j]);
        }
        samples
    }

    fn largest(&self, motion: MotionIndex, limits_nm: &Joints) -> MotionTorques {
        let zero = [0.0_f64; 7];
        let (mut peak_nm, mut peak_at_s, mut static_nm) = (zero, zero, zero);
        for (torque, t_s) in self.torque.iter().zip(&self.t_s) {
            for j in 0..7 {
                if torque[j].abs() > peak_nm[j].abs() {
                    (peak_nm[j], peak_at_s[j]) = (torque[j], *t_s);
                }
            }
        }
        for gravity in &self.gravity {
            for j in 0..7 {
                if gravity[j].abs() > static_nm[j].abs() {
                    static_nm[j] = gravity[j];
                }
            }
        }
        let peak_rel = std::array::from_fn(|j| peak_nm[j].abs() / limits_nm[j]);
        MotionTorques { motion, peak_nm, peak_rel, peak_at_s, static_nm }
    }
}

impl TorqueFigures {
    /// Adds the next section of the trajectory. A motion with a stop on its way has figures in each
    /// of its sections.
    pub fn add(&mut self, section: &Section) {
        let limits = &section.path().robot().limits().torque_nm;
        for pieces in section.pieces().chunk_by(|a, b| a.motion == b.motion) {
            let motion = pieces[0].motion;
            let samples = WeightedInstants::of(section, pieces, &section.path().dynamics(motion));
            self.add_work(&samples);
            self.motions.push(samples.largest(motion, limits));
        }
    }

    fn add_work(&mut self, samples: &WeightedInstants) {
        let moving = samples.torque.iter().zip(&samples.velocity);
        for ((torque, velocity), (t_s, weight_s)) in
            moving.zip(samples.t_s.iter().zip(&samples.weight_s))
        {
            let mut all_w = 0.0;
            for j in 0..7 {
                let power_w = torque[j] * velocity[j];
                self.positive_work_j[j] += weight_s * power_w.max(0.0);
                self.negative_work_j[j] += weight_s * power_w.min(0.0);
                all_w += power_w.max(0.0);
            }
            if all_w > self.peak_power_w {
                (self.peak_power_w, self.peak_power_at_s) = (all_w, *t_s);
            }
        }
    }
}
