//! Samples of a plan as arrays.

use iiwa_kin::{Joints, Pose};
use iiwa_traj::{State, Trajectory};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::{prelude::*, sync::PyOnceLock};

use crate::{
    Pickled,
    arrays::{array, joint_array, room, shared},
    frames::matrix,
    plan::Plan,
};

/// Samples of a plan, in the order of time. Each getter always returns the same read-only array.
///
/// A pickle contains the plan and the rate; unpickling plans and samples again.
///
/// >>> import iiwasim as iw
/// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
/// >>> plan = iw.plan(program)
/// >>> plan.sample(rate_hz=100)
/// <iiwasim.Samples 121 at 100 Hz, 1.196 s>
#[pyclass(frozen, module = "iiwasim")]
pub(crate) struct Samples {
    plan: Py<Plan>,
    rate_hz: f64,
    t: Py<PyArray1<f64>>,
    q: Py<PyArrayDyn<f64>>,
    dq: Py<PyArrayDyn<f64>>,
    ddq: Py<PyArrayDyn<f64>>,
    motion: Py<PyArray1<u32>>,
    /// Computed on first access.
    tcp: PyOnceLock<Py<PyArrayDyn<f64>>>,
    pose: PyOnceLock<Py<PyArrayDyn<f64>>>,
    velocity: PyOnceLock<Py<PyArrayDyn<f64>>>,
    torque: PyOnceLock<Py<PyArrayDyn<f64>>>,
}

impl Samples {
    pub(crate) fn of(plan: &Bound<'_, Plan>, rate_hz: f64) -> PyResult<Self> {
        let (py, trajectory) = (plan.py(), plan.get().trajectory());
        let (t, q, dq, ddq, motion) = py.detach(|| -> PyResult<_> {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a capacity: more than that is allocated on the way"
            )]
            let count = (trajectory.cycle_time_s() * rate_hz) as usize + 2;
            let rows = || room::<Joints>(count);
            let (mut t, mut q, mut dq, mut ddq) = (room(count)?, rows()?, rows()?, rows()?);
            let mut motion = room(count)?;
            for state in trajectory.samples(rate_hz) {
                t.push(state.t_s);
                q.push(state.q);
                dq.push(state.dq);
                ddq.push(state.ddq);
                motion.push(u32::try_from(state.motion.number()).unwrap_or(u32::MAX));
            }
            Ok((t, q, dq, ddq, motion))
        })?;
        py.check_signals()?;
        Ok(Self {
            plan: plan.clone().unbind(),
            rate_hz,
            t: shared(PyArray1::from_vec(py, t)),
            q: shared(joint_array(py, q)?.into_bound(py)),
            dq: shared(joint_array(py, dq)?.into_bound(py)),
            ddq: shared(joint_array(py, ddq)?.into_bound(py)),
            motion: shared(PyArray1::from_vec(py, motion)),
            tcp: PyOnceLock::new(),
            pose: PyOnceLock::new(),
            velocity: PyOnceLock::new(),
            torque: PyOnceLock::new(),
        })
    }
}

impl Samples {
    /// Lengths of three columns of the velocities, from `first` on.
    fn speeds<'py>(&self, py: Python<'py>, first: usize) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let velocities = self.tcp_velocity(py)?;
        let velocities = velocities.readonly();
        let rows = velocities.as_array();
        let speeds =
            rows.outer_iter().map(|row| row[first].hypot(row[first + 1]).hypot(row[first + 2]));
        let speeds = PyArray1::from_vec(py, speeds.collect());
        Ok(shared(speeds).into_bound(py))
    }
}

/// The samples with their TCP poses in the robot base.
fn tcp_poses(trajectory: &Trajectory, rate_hz: f64) -> Vec<(State, Pose)> {
    let path = trajectory.path();
    let states: Vec<_> = trajectory.samples(rate_hz).collect();
    let joints: Vec<Joints> = states.iter().map(|state| state.q).collect();
    let mut poses = vec![Pose::IDENTITY; joints.len()];
    path.robot().flange_pose_batch(&joints, &mut poses);
    if path.has_tools() {
        for (state, pose) in states.iter().zip(&mut poses) {
            *pose = pose.then(path.tcp(state.motion));
        }
    }
    states.into_iter().zip(poses).collect()
}

/// Linear and angular TCP velocity at `pose`, in robot base axes.
fn velocity(trajectory: &Trajectory, state: &State, pose: &Pose) -> [f64; 6] {
    let robot = trajectory.path().robot();
    let jacobian = robot.jacobian(&state.q);
    let [vx, vy, vz, wx, wy, wz]: [f64; 6] =
        std::array::from_fn(|i| (0..7).map(|j| jacobian[(i, j)] * state.dq[j]).sum());
    if !trajectory.path().has_tools() {
        return [vx, vy, vz, wx, wy, wz];
    }
    let flange_m = robot.flange_pose(&state.q).position_m;
    let [x, y, z]: [f64; 3] = std::array::from_fn(|i| pose.position_m[i] - flange_m[i]);
    // The flange velocity, and the cross product of the angular velocity and the lever arm.
    [vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x, wx, wy, wz]
}

#[pymethods]
impl Samples {
    /// Times (n,), in s.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.sample(rate_hz=100).t[1]
    /// np.float64(0.01)
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.t.bind(py).clone()
    }

    /// Positions (n, 7), in rad.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.sample().q.flags.c_contiguous
    /// True
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArrayDyn<f64>> {
        self.q.bind(py).clone()
    }

    /// Velocities (n, 7), in rad/s.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> bool((plan.sample().dq <= plan.robot.velocity_limits_rad_s * 1.001).all())
    /// True
    #[getter]
    fn dq<'py>(&self, py: Python<'py>) -> Bound<'py, PyArrayDyn<f64>> {
        self.dq.bind(py).clone()
    }

    /// Accelerations (n, 7), in rad/s^2.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.sample().ddq.dtype
    /// dtype('float64')
    #[getter]
    fn ddq<'py>(&self, py: Python<'py>) -> Bound<'py, PyArrayDyn<f64>> {
        self.ddq.bind(py).clone()
    }

    /// Motion numbers in the program (n,), from 1.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> int(plan.sample().motion[-1])
    /// 2
    #[getter]
    fn motion<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        self.motion.bind(py).clone()
    }

    /// TCP positions (n, 3), in m.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.sample(rate_hz=100).tcp.shape
    /// (121, 3)
    #[getter]
    fn tcp<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let made = self.tcp.get_or_try_init(py, || {
            let (trajectory, rate_hz) = (self.plan.get().trajectory(), self.rate_hz);
            let positions: Vec<[f64; 3]> = py.detach(|| {
                let poses = tcp_poses(trajectory, rate_hz);
                poses.into_iter().map(|(_, pose)| pose.position_m).collect()
            });
            array(py, positions, &[3], false).map(shared)
        })?;
        Ok(made.bind(py).clone())
    }

    /// TCP poses (n, 4, 4) in the robot base: rotations and, in m, positions.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.sample(rate_hz=100).tcp_pose.shape
    /// (121, 4, 4)
    #[getter]
    fn tcp_pose<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let made = self.pose.get_or_try_init(py, || {
            let (trajectory, rate_hz) = (self.plan.get().trajectory(), self.rate_hz);
            let matrices = py.detach(|| {
                let poses = tcp_poses(trajectory, rate_hz);
                poses.iter().map(|(_, pose)| matrix(pose)).collect()
            });
            array(py, matrices, &[4, 4], false).map(shared)
        })?;
        Ok(made.bind(py).clone())
    }

    /// TCP velocities (n, 6) in robot base axes: linear velocity in m/s, and angular velocity in
    /// rad/s.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.sample(rate_hz=100).tcp_velocity.shape
    /// (121, 6)
    #[getter]
    fn tcp_velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let made = self.velocity.get_or_try_init(py, || {
            let (trajectory, rate_hz) = (self.plan.get().trajectory(), self.rate_hz);
            let velocities = py.detach(|| {
                let poses = tcp_poses(trajectory, rate_hz);
                poses.iter().map(|(state, pose)| velocity(trajectory, state, pose)).collect()
            });
            array(py, velocities, &[6], false).map(shared)
        })?;
        Ok(made.bind(py).clone())
    }

    /// TCP speeds (n,), in m/s.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> float(plan.sample(rate_hz=100).tcp_speed[0])
    /// 0.0
    #[getter]
    fn tcp_speed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.speeds(py, 0)
    }

    /// Angular TCP speeds (n,), in rad/s.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> samples = iw.plan(program).sample(rate_hz=100)
    /// >>> bool(abs(samples.tcp_angular_speed - samples.dq[:, 0]).max() < 1e-12)
    /// True
    #[getter]
    fn tcp_angular_speed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.speeds(py, 3)
    }

    /// Joint torques (n, 7), in Nm, with the load at the flange at that time.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.sample(rate_hz=100).torque.shape
    /// (121, 7)
    #[getter]
    fn torque<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let made = self.torque.get_or_try_init(py, || {
            let (trajectory, rate_hz) = (self.plan.get().trajectory(), self.rate_hz);
            let torques = py.detach(|| {
                let torque = |state| trajectory.torques_of(&state).torque_nm;
                trajectory.samples(rate_hz).map(torque).collect()
            });
            array(py, torques, &[7], false).map(shared)
        })?;
        Ok(made.bind(py).clone())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py>> {
        let restore = py.import("iiwasim._figures")?.getattr("sampled")?;
        Ok((restore, (self.plan.clone_ref(py), self.rate_hz).into_pyobject(py)?))
    }

    fn __len__(&self, py: Python<'_>) -> usize {
        self.t.bind(py).len().unwrap_or_default()
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        format!(
            "<iiwasim.Samples {} at {} Hz, {:.3} s>",
            self.__len__(py),
            self.rate_hz,
            self.plan.get().cycle_time_s()
        )
    }
}
