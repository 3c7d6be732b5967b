//! Influence of a load on the controller's planner: not measured in the thesis, which only makes an
//! assumption.

use iiwa_eval::experiment::{LoadEffect, LoadVerdict};

use crate::ExperimentError;

use super::{
    bench::{Bench, TrialRun},
    chapter::Chapter,
    evaluation::{identified, left_out},
};

pub(super) fn chapter(bench: &Bench, runs: &[TrialRun]) -> Result<Chapter, ExperimentError> {
    let identified = identified(bench, runs)?;
    let effect = LoadEffect::new(&identified, &bench.load, &bench.model).map_err(|source| {
        let name = runs.last().map_or_else(String::new, |run| run.trial.name.clone());
        ExperimentError::Planning { name, source }
    })?;
    let load = &bench.load;
    let mut chapter = Chapter::new("What the planner makes of a load");
    chapter.paragraph(format!(
        "A2 and A4 swing alone by 20 deg to either side of eight poses, at full speed, without a \
         load and with {} kg, whose centre is at {:?} mm of the flange, {}. The thesis (chapter 6) \
         expects that a load lowers acceleration, and did not measure it. Accelerations are found \
         by fitting the seven phases of constant jerk to the positions.",
        load.mass_kg, load.center_mm, bench.on
    ));
    let rows: Vec<_> = effect
        .swings
        .iter()
        .map(|it| {
            let deg = |k: usize| it.acceleration_rad_s2[k].scaled(1_f64.to_degrees());
            let [a2, a4] = it.swing.middle_deg;
            vec![
                format!("{} about A2 {a2:.0}, A4 {a4:.0}", it.swing.joint),
                format!("{:.1}", deg(0).value),
                format!("{:.1}", deg(1).value),
                format!("{:.4} +- {:.4}", it.ratio, 2.0 * it.deviation),
                format!("{:.0}", 100.0 * it.needs_rel),
                format!("{:.4}", it.share_at(1.0)),
            ]
        })
        .collect();
    let head = [
        "swing, deg",
        "without deg/s^2",
        "with the load",
        "ratio",
        "torque needed %",
        "ratio by torque",
    ];
    chapter.table(&head, &rows);
    chapter.paragraph(
        "Torque needed is the largest share of a joint's limit that the swing takes with the load \
         at the acceleration without it, by the model; the ratio by torque is that of a planner \
         that keeps every joint within its limit.",
    );
    let verdict = match effect.verdict {
        LoadVerdict::Ignored => "the planner does not take the load into account".to_owned(),
        LoadVerdict::TooLight => {
            "no effect, and with this load planning with torques would show none either: take a \
             heavier one"
                .to_owned()
        }
        LoadVerdict::FactorPerKg(share) => {
            format!(
                "accelerations fall alike in all poses, by {} % for \
                each kg",
                share.scaled(100.0)
            )
        }
        LoadVerdict::Torque(share) => format!(
            "the planner keeps torques within {} % of the limits, which depends on the pose",
            share.scaled(100.0)
        ),
        _ => "not decided: neither no effect, nor one factor, nor a torque limit explains the \
            accelerations"
            .to_owned(),
    };
    chapter.paragraph(format!("**Result: {verdict}.**"));
    let [none, factor, torque] = effect.left_over.map(|rms| format!("{:.2} %", 100.0 * rms));
    chapter.paragraph(format!(
        "Root mean square of what is left of the ratios: {none} if the load has no effect, \
         {factor} with the factor that fits best, {torque} with the torque limit that fits best."
    ));
    chapter.paragraph(left_out(runs, &identified.left_out));
    Ok(chapter)
}
