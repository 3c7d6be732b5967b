//! Identification of a robot that differs from the model, and prediction with the result.

use iiwa_eval::{
    PlannedTrajectory, compare,
    experiment::{CycleTimeCase, Trial},
    identify::{RecordedRun, identify},
};
use iiwa_traj::{SweepOptions, Timing, Trajectory};

use crate::ExperimentError;

use super::{
    bench::Bench, chapter::Chapter, evaluation::planned, kind::ExperimentKind,
    virtual_arm::VirtualArm,
};

/// Factors on the model's limits, joint by joint.
const VELOCITY: [f64; 7] = [0.92, 1.05, 0.97, 1.10, 0.90, 1.04, 0.95];
const ACCELERATION: [f64; 7] = [0.85, 1.12, 0.95, 0.90, 1.15, 0.88, 1.06];
const JERK: [f64; 7] = [0.75, 1.20, 1.10, 0.80, 0.70, 1.25, 0.85];

/// Coefficients of kappa for that robot, the constant first, and its settle time, in s.
const KAPPA: [f64; 3] = [-3.2, 0.004, 0.0002];
const SETTLE_S: f64 = 0.065;

/// Runs the experiments on a virtual robot whose limits, kappa and settle time differ from the
/// model's; identifies them from the recordings; and predicts programs that were not used for
/// identification.
///
/// # Errors
///
/// [`ExperimentError`] if the virtual robot cannot run a program, or if its recordings identify
/// nothing.
pub fn other_robot(bench: &Bench, arm: &VirtualArm) -> Result<Chapter, ExperimentError> {
    let mut limits = *bench.model.limits();
    for j in 0..7 {
        limits.velocity_rad_s[j] *= VELOCITY[j];
        limits.acceleration_rad_s2[j] *= ACCELERATION[j];
        limits.jerk_rad_s3[j] *= JERK[j];
    }
    let robot = bench
        .model
        .clone()
        .with_name("another robot")
        .with_limits(limits)
        .with_blend_kappa(KAPPA)
        .with_settle_time_s(SETTLE_S);
    let mut arm = VirtualArm { robot, ..arm.clone() };

    let mut runs = Vec::new();
    for kind in [ExperimentKind::Limits, ExperimentKind::Blends, ExperimentKind::Settle] {
        arm.rate_hz = kind.rate_hz();
        for trial in kind.trials(bench) {
            let log = arm.run(&trial)?;
            runs.push((trial, log));
        }
    }
    let recordings: Vec<_> =
        runs.iter().map(|(trial, log)| RecordedRun { program: &trial.program, log }).collect();
    let identified = identify(&recordings, &bench.model)
        .map_err(|source| ExperimentError::Identify { source })?;
    let identified = identified.robot(&bench.model);

    let mut chapter = Chapter::new("A robot that is not the model");
    chapter.paragraph(
        "In the chapters above, the virtual robot is the model itself. Here it is another one: its \
         limits are 0.70 to 1.25 times the model's, with a different factor for each joint, and \
         its kappa and time to settle differ, too. It runs the programs of Appendix A, section 4.2 \
         and Appendix C, a robot is identified from these recordings, and other programs are \
         predicted with the model and with the identified robot.",
    );
    let rows: Vec<_> = prediction_trials(bench)
        .into_iter()
        .map(|(name, trial)| {
            let log = arm.run(&trial)?;
            let by_identified = planned(&identified, &trial, Timing::jerk_limited())?;
            let compared = compare(&PlannedTrajectory::from_trajectory(&by_identified), &log)
                .map_err(|source| ExperimentError::Compare { name: trial.name.clone(), source })?;
            // From departure to arrival: a recording does not show the settle time at its end.
            let real_s = compared.arrival_s - compared.departure_s;
            let error = |plan: &Trajectory, settle_s: f64| {
                let moving_s = plan.cycle_time_s() - settle_s;
                format!("{:+.2}", 100.0 * (moving_s - real_s) / real_s)
            };
            let acceleration = Timing::Acceleration(SweepOptions::default());
            let model_s = bench.model.settle_time_s();
            Ok(vec![
                name,
                format!("{real_s:.3}"),
                error(&planned(&bench.model, &trial, acceleration)?, model_s),
                error(&planned(&bench.model, &trial, Timing::jerk_limited())?, model_s),
                error(&by_identified, identified.settle_time_s()),
                format!("{:.3}", compared.joints_rad.max.to_degrees()),
            ])
        })
        .collect::<Result<_, ExperimentError>>()?;
    chapter.table(
        &[
            "program",
            "measured s",
            "model, acceleration %",
            "model, jerk %",
            "identified, jerk %",
            "path off by at most, identified, deg",
        ],
        &rows,
    );
    let limits = |quantity: &dyn Fn(&iiwa_kin::Limits) -> [f64; 7]| {
        let (estimated, truth) = (quantity(identified.limits()), quantity(arm.robot.limits()));
        (0..7).map(|j| 100.0 * (estimated[j] / truth[j] - 1.0).abs()).fold(0.0, f64::max)
    };
    chapter.paragraph(format!(
        "Of its limits, those of velocity were found within {:.3} %, of acceleration within {:.3} \
         %, of jerk within {:.2} %; kappa at 90 deg is {:.3} and was found as {:.3}; it settles \
         for {SETTLE_S} s, found: {:.4} s.",
        limits(&|limits| limits.velocity_rad_s),
        limits(&|limits| limits.acceleration_rad_s2),
        limits(&|limits| limits.jerk_rad_s3),
        arm.robot.kappa(90.0),
        identified.kappa(90.0),
        identified.settle_time_s()
    ));
    Ok(chapter)
}

/// Returns programs that are not used for identification, with their labels in the table.
fn prediction_trials(bench: &Bench) -> Vec<(String, Trial)> {
    let mut trials: Vec<_> = ExperimentKind::ZoneVelocity
        .trials(bench)
        .into_iter()
        .map(|trial| ("Appendix B".to_owned(), trial))
        .collect();
    for (velocity_rel, blend, length_deg) in
        [(1.0, 0.25, 200.0), (1.0, 0.0, 100.0), (0.4, 0.25, 50.0)]
    {
        let case = CycleTimeCase { path: 0, velocity_rel, blend, length_deg };
        let name =
            format!("ten motions, velocity {velocity_rel}, blend {blend}, lambda {length_deg}");
        trials.push((name, case.trial(&bench.model, bench.seed)));
    }
    trials
}
