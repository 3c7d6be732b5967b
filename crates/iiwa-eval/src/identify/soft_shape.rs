//! The way of a motion along a line from rest to rest, as Sunrise plans it: ramps that begin with constant snap, plateaus, a
//! cruise. [`RampLaw`](iiwa_kin::RampLaw) has the law; here, its figures are those of one motion.

use iiwa_kin::RampLimits;

/// The figures of a motion; lengths in rad along the line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SoftLine {
    pub(super) way: f64,
    /// Top speed, in rad/s.
    pub(super) speed: f64,
    /// Largest acceleration, in rad/s^2.
    pub(super) acceleration: f64,
    /// The ramps at the start and at the end.
    pub(super) ends: [SoftRamp; 2],
    /// Width of a phase in speed, in rad/s.
    pub(super) width: f64,
}

/// The first phase of a ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SoftRamp {
    /// The speed at its end, in rad/s.
    pub(super) speed: f64,
    /// The jerk at its end, in rad/s^3.
    pub(super) jerk: f64,
}

impl SoftRamp {
    /// The one that a law with these limits leads to.
    pub(super) fn by(limits: &RampLimits, acceleration: f64, width: f64) -> Self {
        let a = acceleration;
        let first = |speed: f64| {
            let b = limits.damping_per_s * (1.5 * speed).sqrt();
            let root = 2.0 * limits.jerk / (b + (b * b + 4.0 * limits.jerk).sqrt());
            Self { speed, jerk: (root * root).min(a * a / (1.5 * speed)) }
        };
        let found = first((2.0_f64.sqrt() / 3.0 * a.powf(1.5) / limits.snap.sqrt()).max(width));
        let gain = (a * a - found.acceleration().powi(2)) / (2.0 * found.jerk);
        if found.speed > width && gain >= width { first(width) } else { found }
    }

    /// The acceleration at its end, in rad/s^2.
    pub(super) fn acceleration(self) -> f64 {
        (1.5 * self.jerk * self.speed).sqrt()
    }
}

/// A time of constant snap: its duration, and jerk and snap at its start.
type Phase = [f64; 3];

/// The state at the start of a phase: time, way, speed, acceleration; and the phase's jerk and snap.
#[derive(Clone, Copy, Debug)]
struct PhaseStart {
    t_s: f64,
    way: f64,
    speed: f64,
    acceleration: f64,
    jerk: f64,
    snap: f64,
}

/// The way over time.
#[derive(Clone, Debug)]
pub(super) struct SoftShape {
    instants: Vec<PhaseStart>,
    way: f64,
    /// From start to end, in s.
    pub(super) duration_s: f64,
    /// The plateaus of acceleration, and the cruise, in s; below 0 if there is no room for them.
    pub(super) plateau_s: [f64; 2],
    pub(super) cruise_s: f64,
}

/// The share of the phase of constant jerk in what the square of the acceleration gains after the first phase.
const CONSTANT_SHARE: f64 = 0.61;

/// The phases of a ramp up to an acceleration.
fn ramp(acceleration: f64, first: SoftRamp, width: f64) -> [Phase; 3] {
    let a = acceleration;
    let jerk = first.jerk.min(a * a / (1.5 * first.speed));
    let from = SoftRamp { jerk, ..first }.acceleration();
    let seconds = 3.0 * first.speed / from;
    let mut phases = [[seconds, 0.0, jerk / seconds], [0.0; 3], [0.0; 3]];
    let (mut from, mut from_jerk, mut width) = (from, jerk, width);
    if from >= a * (1.0 - 1e-12) {
        return phases;
    }
    let gain = (a * a - from * from) / (2.0 * jerk);
    if gain >= width {
        let a2 = (from * from + CONSTANT_SHARE * (a * a - from * from)).sqrt();
        from_jerk = (a2 * a2 - from * from) / (2.0 * gain);
        phases[1] = [(a2 - from) / from_jerk, from_jerk, 0.0];
        width = width.max((a * a - a2 * a2) / (2.0 * from_jerk));
        from = a2;
    }
    let mean = (2.0 * from + a) / 3.0;
    let seconds = 2.0 * width / (mean + (mean * mean + 2.0 / 3.0 * from_jerk * width).sqrt());
    let snap = 2.0 * (a - from - from_jerk * seconds) / (seconds * seconds);
    phases[2] = if from_jerk + snap * seconds >= 0.0 {
        [seconds, from_jerk, snap]
    } else {
        let seconds = 2.0 * width / (from + a);
        [seconds, (a - from) / seconds, 0.0]
    };
    phases
}

impl PhaseStart {
    /// Way, speed and acceleration after a time.
    fn after(&self, t: f64) -> [f64; 3] {
        let Self { way, speed, acceleration: a, jerk, snap, .. } = *self;
        [
            way + t * (speed + t * (a / 2.0 + t * (jerk / 6.0 + t * snap / 24.0))),
            speed + t * (a + t * (jerk / 2.0 + t * snap / 6.0)),
            a + t * (jerk + t * snap / 2.0),
        ]
    }
}

/// The state after some phases, from rest; each phase is added to `instants`.
fn run(
    phases: impl Iterator<Item = Phase>,
    from: [f64; 4],
    instants: &mut Vec<PhaseStart>,
) -> [f64; 4] {
    phases.fold(from, |[t_s, way, speed, acceleration], [seconds, jerk, snap]| {
        let instant = PhaseStart { t_s, way, speed, acceleration, jerk, snap };
        instants.push(instant);
        let [way, speed, acceleration] = instant.after(seconds);
        [t_s + seconds, way, speed, acceleration]
    })
}

impl SoftShape {
    pub(super) fn new(line: &SoftLine) -> Self {
        let halves = line.ends.map(|end| {
            let up = ramp(line.acceleration, end, line.width);
            let plateau_s =
                line.speed / line.acceleration - up.iter().map(|phase| phase[0]).sum::<f64>();
            let down = up.map(|[seconds, jerk, snap]| [seconds, -jerk, -snap]);
            let [a, b, c] = up;
            let [d, e, f] = down;
            ([a, b, c, [plateau_s.max(0.0), 0.0, 0.0], d, e, f], plateau_s)
        });
        let mut instants = Vec::with_capacity(16);
        let ways = halves.map(|(phases, _)| {
            instants.clear();
            run(phases.into_iter(), [0.0; 4], &mut instants)[1]
        });
        let cruise_s = (line.way - ways[0] - ways[1]) / line.speed;
        let [(start, start_plateau_s), (stop, stop_plateau_s)] = halves;
        // Backwards in time, jerk begins with what it ended with, and acceleration and snap have the other sign.
        let backwards = stop
            .into_iter()
            .rev()
            .map(|[seconds, jerk, snap]| [seconds, jerk + snap * seconds, -snap]);
        let phases = start.into_iter().chain([[cruise_s.max(0.0), 0.0, 0.0]]).chain(backwards);
        instants.clear();
        let [duration_s, ..] = run(phases, [0.0; 4], &mut instants);
        Self {
            instants,
            way: line.way,
            duration_s,
            plateau_s: [start_plateau_s, stop_plateau_s],
            cruise_s,
        }
    }

    /// Way and speed at a time since the start.
    pub(super) fn at(&self, t_s: f64) -> [f64; 2] {
        if t_s <= 0.0 {
            return [0.0; 2];
        }
        if t_s >= self.duration_s {
            return [self.way, 0.0];
        }
        let next = self.instants.partition_point(|instant| instant.t_s <= t_s);
        let instant = &self.instants[next.saturating_sub(1)];
        let [way, speed, _] = instant.after(t_s - instant.t_s);
        [way, speed]
    }
}

#[cfg(test)]
mod tests {
    use iiwa_kin::{RampEnd, Robot};
    use iiwa_path::JointPath;
    use iiwa_program::Program;
    use iiwa_traj::{JerkOptions, Timing, Trajectory};

    use super::*;

    /// Lines as the planner plans them, with two and with three phases in their ramps.
    #[test]
    fn lines_are_those_of_the_planner() {
        for target in
            ["[99.92, 59, -77.68, 39.1, -148.45, 118.74, 35.97]", "[20, 40, -40, 110, -20, 0, 0]"]
        {
            let program = format!(
                r#"{{ "version": 1, "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }},
                "motions": [{{ "type": "ptp", "joints_deg": {target} }}] }}"#
            );
            let robot = Robot::lbr_iiwa_7_r800();
            let path = JointPath::new(&Program::from_json(&program).unwrap(), &robot).unwrap();
            let plan = Trajectory::plan(&path, Timing::Sunrise(JerkOptions::default())).unwrap();
            let end_s = plan.motions()[0].end_s;
            let [from, to] = [plan.at(0.0).q, plan.at(end_s).q];
            let way: f64 = to.iter().map(|q| q * q).sum::<f64>().sqrt();
            let unit = to.map(|q| q / way);
            let least = |limits: &iiwa_kin::Joints| {
                (0..7).map(|j| limits[j] / unit[j].abs().max(1e-9)).fold(f64::MAX, f64::min)
            };
            let acceleration = least(&robot.limits().acceleration_rad_s2);
            let law = robot.ramp_law();
            let end = |q, sign: f64, end| {
                let away = unit.map(|u| sign * u);
                let torques = robot.dynamics().path_torques(q, &away, &[0.0; 7]).acceleration;
                let limits = law.limits(&away, &torques, &[1.0; 7], end);
                let guess = SoftRamp::by(&limits, acceleration, law.width_rad_s);
                assert!(guess.jerk > 0.0);
                guess
            };
            let line = SoftLine {
                way,
                speed: least(&robot.limits().velocity_rad_s),
                acceleration,
                ends: [end(&from, 1.0, RampEnd::Start), end(&to, -1.0, RampEnd::Stop)],
                width: law.width_rad_s,
            };
            let shape = SoftShape::new(&line);
            assert!((shape.duration_s - end_s).abs() < 1e-9, "{} {end_s}", shape.duration_s);
            for i in 0..=1000 {
                let t_s = end_s * f64::from(i) / 1000.0;
                let planned: f64 = plan.at(t_s).q.iter().zip(unit).map(|(q, u)| q * u).sum();
                assert!((shape.at(t_s)[0] - planned).abs() < 1e-9, "{target} {t_s}");
            }
        }
    }
}
