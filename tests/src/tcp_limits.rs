//! TCP limits as an observer measures them: from the motion of the flange.

use iiwa_kin::{Pose, Robot, Taylor};
use iiwa_program::{LimitKind, Motion, MotionLimits, Program, ToolLimits};
use iiwa_traj::{State, Trajectory};
use nalgebra::{Isometry3, Vector3};

/// Speed, in m/s or rad/s, below which the direction of a rate, and so the change of its length, is
/// rounding.
const SLOW: f64 = 5e-3;

/// Returns the TCP of the motion at an instant, in the flange frame.
fn tcp(program: &Program, state: &State) -> Pose {
    match &program.motions[state.motion.index()] {
        Motion::Cartesian(cartesian) => program.workcell.tcp(cartesian.tool.as_deref()),
        _ => program.workcell.tcp(None),
    }
    .unwrap_or(Pose::IDENTITY)
}

/// Returns the length of a rate and its first two time derivatives.
fn length(rate: [Vector3<f64>; 3]) -> Option<[f64; 3]> {
    let [v, a, j] = rate;
    let speed = v.norm();
    let along = v.dot(&a) / speed;
    (speed > SLOW).then(|| [speed, along, (a.norm_squared() + v.dot(&j) - along * along) / speed])
}

/// Largest ratios of TCP translation and rotation, in order, to their limits of each kind, from the
/// joint derivatives at `rate_hz`.
#[must_use]
pub fn tcp_ratios(
    robot: &Robot,
    program: &Program,
    trajectory: &Trajectory,
    rate_hz: f64,
) -> [[f64; 3]; 2] {
    let mut worst = [[0.0_f64; 3]; 2];
    for state in trajectory.samples(rate_hz) {
        let ratios = ratios_at(robot, program, trajectory, &state);
        for (worst, ratio) in worst.as_flattened_mut().iter_mut().zip(ratios.as_flattened()) {
            *worst = worst.max(*ratio);
        }
    }
    worst
}

/// Returns true if a motion has limits of both translation and rotation. Where either of them
/// changes its rate, one sum represents both: speeds are kept, but the smaller of both rates may
/// change faster than its own limit ([`ToolCoordinate`](iiwa_path::ToolCoordinate)).
fn limits_both(limits: &ToolLimits) -> bool {
    [&limits.way, &limits.turn].iter().all(|limits| limits.values().any(|limit| limit.is_finite()))
}

/// Ratios at one instant.
#[must_use]
pub fn ratios_at(
    robot: &Robot,
    program: &Program,
    trajectory: &Trajectory,
    state: &State,
) -> [[f64; 3]; 2] {
    let limits = trajectory.path().limits_of(state.step).tool();
    let joints = std::array::from_fn(|j| {
        Taylor([state.q[j], state.dq[j], state.ddq[j] / 2.0, state.dddq[j] / 6.0])
    });
    let pose = robot.flange_moving(&joints).then_fixed(&tcp(program, state));
    let position = pose.position_m.map(Taylor::derivatives);
    let way = [1, 2, 3].map(|k| Vector3::from_fn(|i, _| position[i][k]));
    // The axes r of the TCP move by omega x r, so omega is half the sum of r x r'.
    let axes: [[Vector3<f64>; 4]; 3] = std::array::from_fn(|column| {
        std::array::from_fn(|k| {
            Vector3::from_fn(|row, _| pose.rotation[row][column].derivatives()[k])
        })
    });
    let sum = |term: &dyn Fn(&[Vector3<f64>; 4]) -> Vector3<f64>| {
        0.5 * axes.iter().map(term).sum::<Vector3<f64>>()
    };
    let turn = [
        sum(&|r| r[0].cross(&r[1])),
        sum(&|r| r[0].cross(&r[2])),
        sum(&|r| r[1].cross(&r[2]) + r[0].cross(&r[3])),
    ];
    let kinds = if limits_both(limits) { 1 } else { 3 };
    [(way, &limits.way), (turn, &limits.turn)].map(|(rates, limits)| {
        let limits = limits.into_array();
        length(rates).map_or([0.0; 3], |rates| {
            std::array::from_fn(|k| if k < kinds { rates[k].abs() / limits[k] } else { 0.0 })
        })
    })
}

/// Largest ratios of TCP translation and rotation to their velocity and acceleration limits, by
/// differences of TCP poses at `rate_hz`. If a difference spans several motions, the larger limit
/// applies.
#[must_use]
pub fn tcp_difference_ratios(
    robot: &Robot,
    program: &Program,
    trajectory: &Trajectory,
    rate_hz: f64,
) -> [[f64; 2]; 2] {
    // The last sample is at a shorter distance.
    let mut all: Vec<State> = trajectory.samples(rate_hz).collect();
    all.pop();
    let pose = |state: &State, tcp: &Pose| -> Isometry3<f64> {
        robot.flange_pose(&state.q).then(tcp).to_isometry()
    };
    let limits = |states: &[State], which: fn(&MotionLimits, LimitKind) -> f64, kind| {
        let steps = states[0].step..=states[states.len() - 1].step;
        let path = trajectory.path();
        steps.map(|step| which(path.limits_of(step), kind)).fold(0.0, f64::max)
    };
    let mut worst = [[0.0_f64; 2]; 2];
    for states in all.windows(3) {
        // Adjacent motions may have other TCPs: such differences are skipped.
        let start_tcp = tcp(program, &states[0]);
        if states.iter().any(|state| tcp(program, state) != start_tcp) {
            continue;
        }
        let poses = [0, 1, 2].map(|i| pose(&states[i], &start_tcp));
        let steps = [0, 1].map(|i| {
            let [a, b] = [&poses[i], &poses[i + 1]];
            [
                (b.translation.vector - a.translation.vector).norm() * rate_hz,
                a.rotation.rotation_to(&b.rotation).angle() * rate_hz,
            ]
        });
        let whiches: [fn(&MotionLimits, LimitKind) -> f64; 2] =
            [|limits, kind| limits.tool().way[kind], |limits, kind| limits.tool().turn[kind]];
        for (k, which) in whiches.into_iter().enumerate() {
            let speed = steps[0][k];
            let velocity = speed / limits(&states[..2], which, LimitKind::Velocity);
            worst[k][0] = worst[k][0].max(velocity);
            let limits_both = states
                .iter()
                .any(|state| limits_both(trajectory.path().limits_of(state.step).tool()));
            if steps[0][k].min(steps[1][k]) > SLOW && !limits_both {
                let change = (steps[1][k] - steps[0][k]).abs() * rate_hz;
                let ratio = change / limits(states, which, LimitKind::Acceleration);
                worst[k][1] = worst[k][1].max(ratio);
            }
        }
    }
    worst
}
