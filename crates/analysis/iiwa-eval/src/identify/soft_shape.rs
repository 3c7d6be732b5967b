//! Way over time of a motion along a line from rest to rest as planned by Sunrise: ramps with
//! constant snap at their start, plateaus and a cruise. [`RampLaw`](iiwa_kin::RampLaw) has the law;
//! the values here are those of one motion.

use iiwa_traj::{RampPhase, RampStart};

/// Parameters of a motion; lengths in rad along the line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SoftLine {
    pub(super) way: f64,
    /// Top speed, in rad/s.
    pub(super) speed: f64,
    /// Largest acceleration, in rad/s^2.
    pub(super) acceleration: f64,
    /// Ramps at the start and at the end.
    pub(super) ends: [RampStart; 2],
    /// Width of a phase in speed, in rad/s.
    pub(super) width: f64,
}

/// State at the start of a phase: time, way, speed, acceleration; and the phase's jerk and snap.
#[derive(Clone, Copy, Debug)]
struct PhaseStart {
    t_s: f64,
    way: f64,
    speed: f64,
    acceleration: f64,
    jerk: f64,
    snap: f64,
}

/// Way over time.
#[derive(Clone, Debug)]
pub(super) struct SoftShape {
    instants: Vec<PhaseStart>,
    way: f64,
    /// Duration, in s.
    pub(super) duration_s: f64,
    /// Durations of the acceleration plateaus and of the cruise, in s; below 0 if there is no room
    /// for them.
    pub(super) plateau_s: [f64; 2],
    pub(super) cruise_s: f64,
}

impl PhaseStart {
    /// Returns way, speed and acceleration after a time.
    fn after(&self, t: f64) -> [f64; 3] {
        let Self { way, speed, acceleration: a, jerk, snap, .. } = *self;
        [
            way + t * (speed + t * (a / 2.0 + t * (jerk / 6.0 + t * snap / 24.0))),
            speed + t * (a + t * (jerk / 2.0 + t * snap / 6.0)),
            a + t * (jerk + t * snap / 2.0),
        ]
    }
}

/// Returns the state after some phases; each phase is added to `instants`.
fn run(
    phases: impl Iterator<Item = RampPhase>,
    from: [f64; 4],
    instants: &mut Vec<PhaseStart>,
) -> [f64; 4] {
    phases.fold(from, |[t_s, way, speed, acceleration], RampPhase { seconds, jerk, snap }| {
        let instant = PhaseStart { t_s, way, speed, acceleration, jerk, snap };
        instants.push(instant);
        let [way, speed, acceleration] = instant.after(seconds);
        [t_s + seconds, way, speed, acceleration]
    })
}

/// Returns a phase without jerk; of zero duration for negative `seconds`.
fn constant(seconds: f64) -> RampPhase {
    RampPhase { seconds: seconds.max(0.0), ..RampPhase::default() }
}

impl SoftShape {
    pub(super) fn new(line: &SoftLine) -> Self {
        let halves = line.ends.map(|end| {
            let up = end.phases(line.acceleration, line.width);
            let plateau_s =
                line.speed / line.acceleration - up.iter().map(|phase| phase.seconds).sum::<f64>();
            let down = up.map(|phase| RampPhase { jerk: -phase.jerk, snap: -phase.snap, ..phase });
            let [a, b, c] = up;
            let [d, e, f] = down;
            ([a, b, c, constant(plateau_s), d, e, f], plateau_s)
        });
        let mut instants = Vec::with_capacity(16);
        let ways = halves.map(|(phases, _)| {
            instants.clear();
            run(phases.into_iter(), [0.0; 4], &mut instants)[1]
        });
        let cruise_s = (line.way - ways[0] - ways[1]) / line.speed;
        let [(start, start_plateau_s), (stop, stop_plateau_s)] = halves;
        // In reverse, jerk starts with its former end value, and acceleration and snap have the
        // opposite sign.
        let backwards = stop.into_iter().rev().map(|phase| RampPhase {
            jerk: phase.jerk + phase.snap * phase.seconds,
            snap: -phase.snap,
            ..phase
        });
        let phases = start.into_iter().chain([constant(cruise_s)]).chain(backwards);
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

    /// Returns way and speed at a time since the start.
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

    /// Lines as planned by the planner, with two and with three phases in their ramps.
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
            let max_along = |limits: &iiwa_kin::Joints| {
                (0..7).map(|j| limits[j] / unit[j].abs().max(1e-9)).fold(f64::MAX, f64::min)
            };
            let acceleration = max_along(&robot.limits().acceleration_rad_s2);
            let law = robot.ramp_law();
            let end = |q, sign: f64, end| {
                let away = unit.map(|u| sign * u);
                let torques = robot.dynamics().path_torques(q, &away, &[0.0; 7]).acceleration;
                let limits = law.limits(&away, &torques, &[1.0; 7], end);
                let guess = RampStart::by(&limits, acceleration, law.width_rad_s);
                assert!(guess.jerk > 0.0);
                guess
            };
            let line = SoftLine {
                way,
                speed: max_along(&robot.limits().velocity_rad_s),
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
