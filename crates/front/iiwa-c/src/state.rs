//! What the arm does at one instant, as C has it.

use iiwa_traj::State;

use crate::planned::Planned;

/// What the arm does at one instant.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IiwasimState {
    /// When, in s.
    pub t_s: f64,
    /// Positions of A1 to A7, in rad.
    pub q: [f64; 7],
    /// Velocities, in rad/s.
    pub dq: [f64; 7],
    /// Accelerations, in rad/s^2. Where they jump, the value after the jump.
    pub ddq: [f64; 7],
    /// Position of the TCP in the robot's base frame, in m. The TCP is that of the motion's tool, or the flange.
    pub tcp_m: [f64; 3],
    /// Its orientation there, a unit quaternion x, y, z, w with w >= 0.
    pub tcp_xyzw: [f64; 4],
    /// The motion of the program, from 1.
    pub motion: u32,
}

impl IiwasimState {
    pub(crate) fn of(planned: &Planned, state: &State) -> Self {
        let tcp = planned.tcp(state);
        Self {
            t_s: state.t_s,
            q: state.q,
            dq: state.dq,
            ddq: state.ddq,
            tcp_m: tcp.position_m,
            tcp_xyzw: tcp.quaternion_xyzw(),
            motion: u32::try_from(state.motion.number()).unwrap_or(u32::MAX),
        }
    }
}
