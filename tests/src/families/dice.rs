//! Random numbers and random parts of programs.

use std::f64::consts::TAU;

use fastrand::Rng;
use iiwa_kin::{Joints, Robot, vector};
use iiwa_program::{Blend, Motion, Program, Ptp, Sources, Start, Workcell};

/// Source of random numbers.
#[derive(Debug)]
pub(crate) struct Dice(Rng);

impl Dice {
    /// Creates the source for program `index` of `family`.
    pub(crate) fn new(seed: u64, family: &str, index: u64) -> Self {
        let mut rng = Rng::with_seed(seed);
        for word in family.bytes().map(u64::from).chain([index]) {
            rng = Rng::with_seed(rng.u64(..) ^ word);
        }
        Self(rng)
    }

    pub(crate) fn between(&mut self, lower: f64, upper: f64) -> f64 {
        lower + (upper - lower) * self.0.f64()
    }

    /// Returns a number with a log-uniform distribution.
    pub(crate) fn log(&mut self, lower: f64, upper: f64) -> f64 {
        self.between(lower.ln(), upper.ln()).exp().max(lower).min(upper)
    }

    pub(crate) fn count(&mut self, min: usize, max: usize) -> usize {
        self.0.usize(min..=max)
    }

    /// Returns true with this probability in percent.
    pub(crate) fn percent(&mut self, percent: u8) -> bool {
        self.0.u8(0..100) < percent
    }

    pub(crate) fn joints(&mut self, mut one: impl FnMut(&mut Self) -> f64) -> Joints {
        std::array::from_fn(|_| one(self))
    }

    /// Returns a pose in the middle of the joint ranges.
    pub(crate) fn pose(&mut self) -> Joints {
        self.joints(|dice| dice.between(-1.2, 1.2))
    }

    /// Returns a unit vector: with all joints, or sometimes with several or one.
    pub(crate) fn direction(&mut self) -> Joints {
        let some = self.percent(20);
        let only = self.percent(10).then(|| self.count(0, 6));
        loop {
            let way: Joints = std::array::from_fn(|j| {
                let v = self.normal();
                let left_out = some && self.percent(50) || only.is_some_and(|only| only != j);
                if left_out { 0.0 } else { v }
            });
            let length = vector::norm(&way);
            if length > 1e-3 {
                return vector::scale(1.0 / length, &way);
            }
        }
    }

    /// Returns a unit vector at `angle_rad` to `direction`, in a random direction.
    pub(crate) fn turned(&mut self, direction: &Joints, angle_rad: f64) -> Joints {
        loop {
            let side = self.joints(Self::normal);
            let along: f64 = side.iter().zip(direction).map(|(a, b)| a * b).sum();
            let across = vector::add_scaled(&side, -along, direction);
            let length = vector::norm(&across);
            if length > 1e-3 {
                let straight = vector::scale(angle_rad.cos(), direction);
                return vector::add_scaled(&straight, angle_rad.sin() / length, &across);
            }
        }
    }

    fn normal(&mut self) -> f64 {
        let [radius, angle] = [self.0.f64(), self.0.f64()];
        (-2.0 * (1.0 - radius).ln()).sqrt() * (TAU * angle).cos()
    }

    /// Returns a blend fraction: a random one, a half, or none.
    pub(crate) fn blend(&mut self) -> Option<Blend> {
        match self.count(0, 9) {
            0 => None,
            1 | 2 => Some(Blend::Fraction(0.5)),
            3 => Some(Blend::Fraction(self.log(1e-4, 0.5))),
            _ => Some(Blend::Fraction(self.between(0.0, 0.5))),
        }
    }

    /// Returns a displacement of `length` from `start` that stays within the joint ranges, if a few
    /// draws find one.
    pub(crate) fn leg(&mut self, start: &Joints, length: f64) -> Joints {
        let limits = Robot::default().limits().upper_rad;
        let throws = std::iter::repeat_with(|| vector::scale(length, &self.direction()));
        let is_inside = |way: &Joints| (0..7).all(|j| (start[j] + way[j]).abs() < limits[j]);
        let mut last = [0.0; 7];
        for way in throws.take(50) {
            last = way;
            if is_inside(&way) {
                break;
            }
        }
        last
    }
}

/// Returns a motion with equal relative limits for all joints.
pub(crate) fn ptp(target_rad: Joints, [v, a, j]: [f64; 3], blend: Option<Blend>) -> Ptp {
    Ptp {
        velocity_rel: [v; 7],
        acceleration_rel: [a; 7],
        jerk_rel: [j; 7],
        blend,
        ..Ptp::to(target_rad)
    }
}

/// Returns the program of these motions, without the last blend, which would lead nowhere.
pub(crate) fn program(start_rad: Joints, mut motions: Vec<Ptp>) -> Program {
    if let Some(last) = motions.last_mut() {
        last.blend = None;
    }
    Program {
        robot: None,
        start: Start::Joints(start_rad),
        motions: motions.into_iter().map(Motion::Ptp).collect(),
        workcell: Workcell::default(),
        sources: Sources::default(),
    }
}
