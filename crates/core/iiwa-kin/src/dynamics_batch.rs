//! Torques at many joint positions at once.

#![expect(
    clippy::inline_always,
    reason = "kernels must be inlined into the function that enables vector instructions"
)]

use std::array::from_fn;

use crate::{
    Dynamics, Joints, PathTorques,
    forward::sin_cos_of_joints,
    newton_euler::{Linkage, holding, inverse_dynamics},
    trig::{reduced, reducible},
};

/// Number of joint positions computed side by side: two vector registers of four numbers.
const LANES: usize = 8;

/// One number per joint and lane.
type JointLanes = [[f64; LANES]; 7];

impl Dynamics {
    /// Computes the torques for each of `joints_rad` with its velocity and acceleration into
    /// `torques_nm`: bit-identical to [`Dynamics::torques`], in a fraction of its time. Uses
    /// AVX-512 or AVX2 where available.
    ///
    /// ```
    /// let dynamics = iiwa_kin::Robot::default().dynamics();
    /// let joints: Vec<_> = (0..20).map(|i| [0.05 * f64::from(i); 7]).collect();
    /// let mut torques = vec![[0.0; 7]; 20];
    /// dynamics.torques_batch(&joints, &joints, &joints, &mut torques);
    /// assert_eq!(torques[11], dynamics.torques(&joints[11], &joints[11], &joints[11]));
    /// ```
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn torques_batch(
        &self,
        joints_rad: &[Joints],
        velocity_rad_s: &[Joints],
        acceleration_rad_s2: &[Joints],
        torques_nm: &mut [Joints],
    ) {
        let count = joints_rad.len();
        let lengths = [velocity_rad_s.len(), acceleration_rad_s2.len(), torques_nm.len()];
        assert_eq!(lengths, [count; 3], "one place for each set of joints");
        let places = JointDerivatives {
            joints: joints_rad,
            first: velocity_rad_s,
            second: acceleration_rad_s2,
        };
        pulp::Arch::new().dispatch(BatchTorques { arm: &self.arm, places, out: torques_nm });
    }

    /// Computes [`Dynamics::torques`] and [`Dynamics::gravity_torques`] for each of `joints_rad`
    /// with its velocity and acceleration, bit-identically.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn torques_with_gravity_batch(
        &self,
        joints_rad: &[Joints],
        velocity_rad_s: &[Joints],
        acceleration_rad_s2: &[Joints],
        torques_nm: &mut [Joints],
        gravity_nm: &mut [Joints],
    ) {
        let count = joints_rad.len();
        let lengths =
            [velocity_rad_s.len(), acceleration_rad_s2.len(), torques_nm.len(), gravity_nm.len()];
        assert_eq!(lengths, [count; 4], "one place for each set of joints");
        let places = JointDerivatives {
            joints: joints_rad,
            first: velocity_rad_s,
            second: acceleration_rad_s2,
        };
        let batch =
            BatchWithGravity { arm: &self.arm, places, torques: torques_nm, gravity: gravity_nm };
        pulp::Arch::new().dispatch(batch);
    }

    /// Computes [`Dynamics::path_torques`] for each of `joints_rad` with its derivatives into
    /// `parts`, bit-identically.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn path_torques_batch(
        &self,
        joints_rad: &[Joints],
        derivative: &[Joints],
        second_derivative: &[Joints],
        parts: &mut [PathTorques],
    ) {
        let count = joints_rad.len();
        let lengths = [derivative.len(), second_derivative.len(), parts.len()];
        assert_eq!(lengths, [count; 3], "one place for each set of joints");
        let places =
            JointDerivatives { joints: joints_rad, first: derivative, second: second_derivative };
        pulp::Arch::new().dispatch(BatchParts { arm: &self.arm, places, out: parts });
    }
}

/// Joint positions and two derivatives: velocities and accelerations, or derivatives with respect
/// to the path parameter.
#[derive(Clone, Copy)]
struct JointDerivatives<'a> {
    joints: &'a [Joints],
    first: &'a [Joints],
    second: &'a [Joints],
}

/// Joint positions and derivatives of one block, lane by lane.
struct Block {
    sin: JointLanes,
    cos: JointLanes,
    first: JointLanes,
    second: JointLanes,
}

impl Block {
    const EMPTY: Self = {
        let zeros = [[0.0; LANES]; 7];
        Self { sin: zeros, cos: zeros, first: zeros, second: zeros }
    };

    /// Loads a block from `start`. Returns false if an angle is outside the range of the vectorised
    /// sine and cosine.
    #[inline(always)]
    fn read(&mut self, places: &JointDerivatives<'_>, start: usize) -> bool {
        let range = start..start + LANES;
        let (q, first, second) =
            (&places.joints[range.clone()], &places.first[range.clone()], &places.second[range]);
        if !reducible(q.as_flattened()) {
            return false;
        }
        for j in 0..7 {
            for l in 0..LANES {
                (self.sin[j][l], self.cos[j][l]) = reduced(q[l][j]);
                self.first[j][l] = first[l][j];
                self.second[j][l] = second[l][j];
            }
        }
        true
    }

    /// Computes the inverse dynamics of the block, lane by lane; with gravity if `RISES`.
    #[inline(always)]
    fn torques<const RISES: bool>(&self, arm: &Linkage, lanes: &mut JointLanes) {
        for l in 0..LANES {
            let lane = |values: &JointLanes| -> Joints { from_fn(|j| values[j][l]) };
            let (s, c) = (lane(&self.sin), lane(&self.cos));
            let torques =
                inverse_dynamics::<RISES>(arm, [&s, &c], &lane(&self.first), &lane(&self.second));
            for j in 0..7 {
                lanes[j][l] = torques[j];
            }
        }
    }
}

impl Block {
    /// Computes the gravity torques of the block, lane by lane.
    #[inline(always)]
    fn gravity(&self, arm: &Linkage, lanes: &mut JointLanes) {
        for l in 0..LANES {
            let lane = |values: &JointLanes| -> Joints { from_fn(|j| values[j][l]) };
            let torques = holding(arm, [&lane(&self.sin), &lane(&self.cos)]);
            for j in 0..7 {
                lanes[j][l] = torques[j];
            }
        }
    }
}

struct BatchTorques<'a> {
    arm: &'a Linkage,
    places: JointDerivatives<'a>,
    out: &'a mut [Joints],
}

impl pulp::NullaryFnOnce for BatchTorques<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { arm, places, out } = self;
        let mut block = Block::EMPTY;
        let mut lanes = [[0.0; LANES]; 7];
        for (k, torques) in out.chunks_mut(LANES).enumerate() {
            let start = k * LANES;
            if torques.len() < LANES || !block.read(&places, start) {
                for (i, torques) in (start..).zip(torques) {
                    *torques = one(arm, &places, i);
                }
                continue;
            }
            block.torques::<true>(arm, &mut lanes);
            for (l, torques) in torques.iter_mut().enumerate() {
                *torques = from_fn(|j| lanes[j][l]);
            }
        }
    }
}

struct BatchWithGravity<'a> {
    arm: &'a Linkage,
    places: JointDerivatives<'a>,
    torques: &'a mut [Joints],
    gravity: &'a mut [Joints],
}

impl pulp::NullaryFnOnce for BatchWithGravity<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { arm, places, torques, gravity } = self;
        let mut block = Block::EMPTY;
        let mut lanes = [[[0.0; LANES]; 7]; 2];
        let blocks = torques.chunks_mut(LANES).zip(gravity.chunks_mut(LANES));
        for (k, (torques, gravity)) in blocks.enumerate() {
            let start = k * LANES;
            if torques.len() < LANES || !block.read(&places, start) {
                for (i, (torques, gravity)) in (start..).zip(torques.iter_mut().zip(gravity)) {
                    *torques = one(arm, &places, i);
                    *gravity = one_gravity(arm, &places.joints[i]);
                }
                continue;
            }
            block.torques::<true>(arm, &mut lanes[0]);
            block.gravity(arm, &mut lanes[1]);
            for (l, (torques, gravity)) in torques.iter_mut().zip(gravity).enumerate() {
                *torques = from_fn(|j| lanes[0][j][l]);
                *gravity = from_fn(|j| lanes[1][j][l]);
            }
        }
    }
}

#[inline(never)]
fn one_gravity(arm: &Linkage, joints: &Joints) -> Joints {
    let (s, c) = sin_cos_of_joints(joints);
    holding(arm, [&s, &c])
}

#[inline(never)]
fn one(arm: &Linkage, places: &JointDerivatives<'_>, i: usize) -> Joints {
    let (s, c) = sin_cos_of_joints(&places.joints[i]);
    inverse_dynamics::<true>(arm, [&s, &c], &places.first[i], &places.second[i])
}

struct BatchParts<'a> {
    arm: &'a Linkage,
    places: JointDerivatives<'a>,
    out: &'a mut [PathTorques],
}

impl pulp::NullaryFnOnce for BatchParts<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { arm, places, out } = self;
        let mut block = Block::EMPTY;
        let zeros = [[0.0; LANES]; 7];
        let (mut acceleration, mut speed, mut gravity) = (zeros, zeros, zeros);
        for (k, parts) in out.chunks_mut(LANES).enumerate() {
            let start = k * LANES;
            if parts.len() < LANES || !block.read(&places, start) {
                for (i, parts) in (start..).zip(parts) {
                    *parts = one_place(arm, &places, i);
                }
                continue;
            }
            block.torques::<false>(arm, &mut speed);
            block.gravity(arm, &mut gravity);
            block.second = std::mem::replace(&mut block.first, zeros);
            block.torques::<false>(arm, &mut acceleration);
            for (l, parts) in parts.iter_mut().enumerate() {
                let lane = |values: &JointLanes| -> Joints { from_fn(|j| values[j][l]) };
                *parts = PathTorques {
                    acceleration: lane(&acceleration),
                    speed: lane(&speed),
                    gravity: lane(&gravity),
                };
            }
        }
    }
}

#[inline(never)]
fn one_place(arm: &Linkage, places: &JointDerivatives<'_>, i: usize) -> PathTorques {
    let (s, c) = sin_cos_of_joints(&places.joints[i]);
    crate::dynamics::path_torques(arm, [&s, &c], &places.first[i], &places.second[i])
}
