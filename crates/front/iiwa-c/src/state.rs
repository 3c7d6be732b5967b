//! State of the arm at one instant, for C.

use iiwa_traj::State;

use crate::planned::PlannedProgram;

/// State of the arm at one instant.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IiwasimState {
    /// Time, in s.
    pub t_s: f64,
    /// Positions of A1 to A7, in rad.
    pub q: [f64; 7],
    /// Velocities, in rad/s.
    pub dq: [f64; 7],
    /// Accelerations, in rad/s^2. At jumps, the value after the jump.
    pub ddq: [f64; 7],
    /// TCP position in the robot's base frame, in m. The TCP is that of the motion's tool, or the
    /// flange.
    pub tcp_m: [f64; 3],
    /// TCP orientation in the robot's base frame, a unit quaternion x, y, z, w with w >= 0.
    pub tcp_xyzw: [f64; 4],
    /// Motion of the program, from 1.
    pub motion: u32,
}

impl IiwasimState {
    pub(crate) fn of(planned: &PlannedProgram, state: &State) -> Self {
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
