//! Comparison of a recording with a plan, as JSON and as text.

use std::{fmt::Write as _, path::Path};

use comfy_table::{Cell, Table};
use iiwa_eval::{Comparison, Deviation, MotionTime, PlannedTrajectory, StopTime, TorqueDifference};
use iiwa_json::printable;
use iiwa_log::{CycleClock, JointLog, Loss};
use iiwa_plan::is_above;
use iiwa_program::IoValue;
use serde::Serialize;

use crate::{
    signed::{rounded, signed},
    stated_time::stated_time,
    table::{fitted, shortened, table},
    validation_report::UNKNOWN,
};

/// Comparison of a recording with a plan. As JSON, this is the object of `iiwasim compare --json`.
#[derive(Clone, Debug, Serialize)]
pub struct ComparisonReport {
    plan: String,
    measured: String,
    robot: String,
    /// Cycle time error (Larsen 2019, Eq. 40).
    cycle_time: CycleTimeRow,
    /// Times at which the arm departs and arrives, in s, on the recording's clock.
    departure_s: f64,
    arrival_s: f64,
    motions: Vec<MotionTimeRow>,
    stops: Vec<StopTimeRow>,
    joint_deviation: JointRow,
    tcp_deviation: TcpRow,
    /// Recorded minus planned torques at the same path point; null if the recording has no torques.
    torque_difference: Option<TorqueErrors>,
    /// Number of samples in motion, their rate and noise.
    samples: usize,
    rate_hz: f64,
    noise_rad: f64,
    /// Start of a repetition of the program within the recording.
    again_s: Option<f64>,
    /// Missing data and assumptions behind the figures.
    losses: Vec<String>,
    picture: Option<String>,
}

#[derive(Clone, Debug, Serialize)]
struct CycleTimeRow {
    simulated_s: f64,
    real_s: f64,
    error_s: f64,
    error_percent: f64,
    /// Standstill of the plan at start and end, included in both times.
    standing_s: f64,
    /// Standard deviation of the real time due to noise.
    deviation_s: f64,
    /// Cycle time in the metadata of the recording.
    stated_s: Option<f64>,
    /// Clock of the stated time, if not that of the robot program.
    #[serde(skip_serializing_if = "Option::is_none")]
    timed_by: Option<&'static str>,
}

#[derive(Clone, Debug, Serialize)]
struct MotionTimeRow {
    index: usize,
    r#type: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    io: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<IoValue>,
    planned_start_s: f64,
    planned_s: f64,
    real_start_s: Option<f64>,
    real_s: Option<f64>,
    error_s: Option<f64>,
    error_percent: Option<f64>,
}

#[derive(Clone, Debug, Serialize)]
struct StopTimeRow {
    after_motion: usize,
    planned_s: f64,
    real_s: Option<f64>,
}

#[derive(Clone, Debug, Serialize)]
struct JointRow {
    mean_rad: f64,
    max_rad: f64,
    /// Motion with the largest deviation.
    motion: usize,
    plan_s: f64,
    recording_s: f64,
    planned_rad: [f64; 7],
    measured_rad: [f64; 7],
}

#[derive(Clone, Debug, Serialize)]
struct TcpRow {
    mean_mm: f64,
    max_mm: f64,
    /// Motion with the largest deviation.
    motion: usize,
    plan_s: f64,
    recording_s: f64,
    planned_m: [f64; 3],
    measured_m: [f64; 3],
}

#[derive(Clone, Debug, Serialize)]
struct TorqueErrors {
    rms_nm: [f64; 7],
    max_nm: [f64; 7],
    /// Times of the largest differences.
    recording_s: [f64; 7],
    /// Largest torques in the plan.
    planned_peak_nm: [f64; 7],
    samples: usize,
    /// `true` if the sign of the recorded torques is not that of their format, and was inverted.
    turned: bool,
}

impl From<&TorqueDifference> for TorqueErrors {
    fn from(difference: &TorqueDifference) -> Self {
        Self {
            rms_nm: difference.rms_nm,
            max_nm: difference.largest_nm,
            recording_s: difference.largest_at_s,
            planned_peak_nm: difference.planned_peak_nm,
            samples: difference.samples,
            turned: difference.turned,
        }
    }
}

impl MotionTimeRow {
    fn new(motion: &MotionTime, plan: &PlannedTrajectory) -> Self {
        Self {
            index: motion.motion.number(),
            r#type: motion.motion_type.name(),
            name: plan.name_of(motion.motion).map(str::to_owned),
            io: plan.io_of(motion.motion).map(|(io, _)| io.to_owned()),
            value: plan.io_of(motion.motion).map(|(_, value)| value),
            planned_start_s: motion.planned_start_s,
            planned_s: motion.planned_s,
            real_start_s: motion.real_start_s,
            real_s: motion.real_s,
            error_s: motion.error_s,
            error_percent: motion.error_percent,
        }
    }
}

impl From<&StopTime> for StopTimeRow {
    fn from(stop: &StopTime) -> Self {
        let StopTime { after_motion, planned_s, real_s } = *stop;
        Self { after_motion: after_motion.number(), planned_s, real_s }
    }
}

impl From<&Deviation> for JointRow {
    fn from(deviation: &Deviation) -> Self {
        let place = &deviation.at;
        Self {
            mean_rad: deviation.mean,
            max_rad: deviation.max,
            motion: place.motion.number(),
            plan_s: place.plan_s,
            recording_s: place.recording_s,
            planned_rad: place.planned_rad,
            measured_rad: place.measured_rad,
        }
    }
}

impl From<&Deviation> for TcpRow {
    fn from(deviation: &Deviation) -> Self {
        let place = &deviation.at;
        Self {
            mean_mm: 1e3 * deviation.mean,
            max_mm: 1e3 * deviation.max,
            motion: place.motion.number(),
            plan_s: place.plan_s,
            recording_s: place.recording_s,
            planned_m: place.planned_flange_m,
            measured_m: place.measured_flange_m,
        }
    }
}

impl ComparisonReport {
    /// Creates the report on a plan and a recording, each with its file, and a picture of both.
    #[must_use]
    pub fn new(
        [plan_file, measured_file]: [&Path; 2],
        picture: Option<&Path>,
        plan: &PlannedTrajectory,
        measured: &JointLog,
        comparison: &Comparison,
    ) -> Self {
        let name = |path: &Path| path.display().to_string();
        let cycle = &comparison.cycle_time;
        // The comparison reports gaps within the motion.
        let read = measured.losses.iter().filter(|loss| !matches!(loss, Loss::Gap { .. }));
        Self {
            plan: name(plan_file),
            measured: name(measured_file),
            robot: plan.robot().name().to_owned(),
            cycle_time: CycleTimeRow {
                simulated_s: cycle.simulated_s,
                real_s: cycle.real_s,
                error_s: cycle.error_s,
                error_percent: cycle.error_percent,
                standing_s: cycle.standing_s,
                deviation_s: cycle.deviation_s,
                stated_s: measured.cycle_time_s,
                timed_by: (measured.timed_by != CycleClock::RobotProgram)
                    .then(|| measured.timed_by.name()),
            },
            departure_s: comparison.departure_s,
            arrival_s: comparison.arrival_s,
            motions: comparison
                .motions
                .iter()
                .map(|motion| MotionTimeRow::new(motion, plan))
                .collect(),
            stops: comparison.stops.iter().map(StopTimeRow::from).collect(),
            joint_deviation: (&comparison.joints_rad).into(),
            tcp_deviation: (&comparison.flange_m).into(),
            torque_difference: comparison.torques.as_ref().map(TorqueErrors::from),
            samples: comparison.samples,
            rate_hz: 1.0 / comparison.step_s,
            noise_rad: comparison.noise_rad,
            again_s: comparison.again_s,
            losses: read.map(Loss::to_string).chain(comparison.losses.clone()).collect(),
            picture: picture.map(name),
        }
    }

    /// Measured cycle time, in s.
    #[must_use]
    pub fn measured_cycle_time_s(&self) -> f64 {
        self.cycle_time.real_s
    }

    /// Error of the simulated cycle time, in per cent of the measured one (Larsen 2019, Eq. 40).
    #[must_use]
    pub fn error_percent(&self) -> f64 {
        self.cycle_time.error_percent
    }

    /// Largest distance of the flange from its planned path, in mm.
    #[must_use]
    pub fn max_deviation_mm(&self) -> f64 {
        self.tcp_deviation.max_mm
    }

    /// Describes the violated gates, if any: absolute error of the cycle time, in per cent of the
    /// measured one, and deviation of the flange, in mm. Both are compared as they are printed, to
    /// three decimals.
    #[must_use]
    pub fn complaint(
        &self,
        max_error_percent: Option<f64>,
        max_deviation_mm: Option<f64>,
    ) -> Option<String> {
        let (percent, off_mm) = (self.error_percent(), self.max_deviation_mm());
        let time = max_error_percent
            .filter(|limit| is_above(percent.abs(), *limit, 3))
            .map(|limit| format!("the cycle time is off by {percent:+.3} %, more than {limit} %"));
        let path = max_deviation_mm.filter(|limit| is_above(off_mm, *limit, 3)).map(|limit| {
            format!("the flange is off its path by {off_mm:.3} mm, more than {limit} mm")
        });
        let missed: Vec<_> = time.into_iter().chain(path).collect();
        (!missed.is_empty()).then(|| missed.join("; "))
    }

    /// Formats the table of motions. Unknown times are shown as `?`.
    fn motion_table(&self) -> Table {
        let has_name = self.motions.iter().any(|row| row.name.is_some());
        let has_io = self.motions.iter().any(|row| row.io.is_some());
        let mut head = vec!["motion", "type"];
        head.extend(has_name.then_some("name"));
        head.extend(has_io.then_some("I/O"));
        head.extend(["planned s", "measured s", "error s", "error %"]);
        let mut motions = table(&head);
        shortened(&mut motions, &self.motions, |table, row| {
            // A zero time has no relative error.
            let (real_s, error_s, percent) = match (row.real_s, row.error_s) {
                (Some(real_s), Some(error_s)) => (
                    format!("{:.3}", rounded(real_s, 3)),
                    signed(error_s, 4),
                    row.error_percent.map_or_else(String::new, |percent| signed(percent, 2)),
                ),
                _ => ("?".to_owned(), "?".to_owned(), "?".to_owned()),
            };
            let mut cells = vec![Cell::new(row.index), Cell::new(row.r#type)];
            let name = row.name.as_deref().map(printable).unwrap_or_default();
            cells.extend(has_name.then(|| Cell::new(name)));
            let io = row.io.as_deref().zip(row.value).map(|(io, value)| format!("{io} = {value}"));
            cells.extend(
                has_io.then(|| Cell::new(io.as_deref().map(printable).unwrap_or_default())),
            );
            cells.extend([
                Cell::new(format!("{:.3}", row.planned_s)),
                Cell::new(real_s),
                Cell::new(error_s),
                Cell::new(percent),
            ]);
            table.add_row(cells);
        });
        motions
    }

    /// Formats the report as a table and sentences. Cells of the table are wrapped to lines of at
    /// most `width` characters; see [`fitted`].
    #[must_use]
    pub fn text(&self, width: Option<u16>) -> String {
        let mut text = format!("{}\n\n", fitted(self.motion_table(), width));
        if self.motions.iter().any(|row| row.real_s.is_none() || row.error_s.is_none()) {
            text.push_str(UNKNOWN);
        }
        let cycle = &self.cycle_time;
        let _ = writeln!(
            text,
            "Cycle time  {:.3} s planned, {:.3} s measured: off by {} s, {} %",
            cycle.simulated_s,
            cycle.real_s,
            signed(cycle.error_s, 4),
            signed(cycle.error_percent, 2)
        );
        let _ = writeln!(
            text,
            "            Both include the plan's standstill at the start and the end, {:.3} s",
            cycle.standing_s
        );
        if let Some(stated_s) = cycle.stated_s {
            let timed_by = cycle.timed_by.and_then(CycleClock::from_name).unwrap_or_default();
            let plan_s = [cycle.simulated_s, cycle.standing_s];
            let stated = stated_time(stated_s, timed_by, Some(1.0 / self.rate_hz), plan_s);
            let _ = writeln!(text, "            {stated}");
        }
        let (joints, tcp) = (&self.joint_deviation, &self.tcp_deviation);
        let _ = writeln!(
            text,
            "Joints      {} off the path on average, {} at most: motion {}, {:.3} s in \
             the plan",
            shown(1e3 * joints.mean_rad, "mrad"),
            shown(1e3 * joints.max_rad, "mrad"),
            joints.motion,
            joints.plan_s
        );
        let _ = writeln!(
            text,
            "Flange      {} off the path on average, {} at most: motion {}, {:.3} s in the \
             plan, at ({:.1}, {:.1}, {:.1}) mm",
            shown(tcp.mean_mm, "mm"),
            shown(tcp.max_mm, "mm"),
            tcp.motion,
            tcp.plan_s,
            1e3 * tcp.measured_m[0],
            1e3 * tcp.measured_m[1],
            1e3 * tcp.measured_m[2],
        );
        if let Some(torques) = &self.torque_difference {
            let list = |nm: &[f64; 7]| nm.map(|nm| format!("{:.2}", rounded(nm, 2))).join(" ");
            let turned = if torques.turned {
                ", inverted: by the arm's weight, their sign is not that of their format"
            } else {
                ""
            };
            let _ = writeln!(
                text,
                "Torques     A1 to A7 off the plan's by {} Nm rms, at most {} Nm, of {} Nm at \
                 most, in {} samples{turned}",
                list(&torques.rms_nm),
                list(&torques.max_nm),
                list(&torques.planned_peak_nm),
                torques.samples
            );
        }
        let _ = writeln!(
            text,
            "Recording   {} samples in motion from {:.3} s to {:.3} s, {:.0} Hz, noise {:.1e} rad",
            self.samples,
            rounded(self.departure_s, 3),
            self.arrival_s,
            self.rate_hz,
            self.noise_rad
        );
        if let Some(again_s) = self.again_s {
            let _ = writeln!(
                text,
                "The program is in the recording again, from {again_s:.3} s on: the first time \
                 counts"
            );
        }
        for loss in &self.losses {
            let _ = writeln!(text, "Note: {}", printable(loss));
        }
        if let Some(picture) = &self.picture {
            let _ = writeln!(text, "Picture in {}", printable(picture));
        }
        text
    }
}

/// Formats a deviation with three decimals; smaller values are reported as below 0.001.
fn shown(value: f64, unit: &str) -> String {
    if value < 0.001 { format!("below 0.001 {unit}") } else { format!("{value:.3} {unit}") }
}
