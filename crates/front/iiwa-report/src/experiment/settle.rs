//! Settle time (Larsen 2019, Appendix C, Table 6).

use crate::ExperimentError;

use super::{
    bench::{Bench, TrialRun},
    chapter::Chapter,
    evaluation::{identified, left_out},
};

/// Mean and standard deviation, in s (Table 6).
const THESIS_S: [f64; 2] = [0.049_608, 0.009_818];

pub(super) fn chapter(bench: &Bench, runs: &[TrialRun]) -> Result<Chapter, ExperimentError> {
    let identified = identified(bench, runs)?;
    let mut chapter = Chapter::new("The time to settle: Appendix C, Table 6");
    let points: usize = runs.iter().map(|run| run.trial.program.motions.len()).sum();
    chapter.paragraph(format!(
        "{points} random points at random speeds without blends, {}. The time to settle is that \
         from the end of a motion to the start of the next, both found by fitting the seven phases \
         of constant jerk to all samples of a motion.",
        bench.on
    ));
    let Some(settle) = identified.settle else {
        chapter.paragraph("No stop between two motions was found.");
        return Ok(chapter);
    };
    let row = |label: &str, mean: String, deviation: f64, stops: String| {
        vec![label.to_owned(), mean, format!("{deviation:.6}"), stops]
    };
    chapter.table(
        &["Table 6", "mean s", "standard deviation s", "stops"],
        &[
            row(
                &bench.on,
                format!("{} (95 %)", settle.mean_s),
                settle.deviation_s,
                settle.mean_s.count.to_string(),
            ),
            row("the thesis", format!("{:.6}", THESIS_S[0]), THESIS_S[1], "200".to_owned()),
        ],
    );
    chapter.paragraph(format!(
        "The model settles for {} s at each stop. The thesis does not explain its standard \
         deviation, a fifth of the mean. For an arm that always settles for the same time, the \
         deviation here is the error of the ends of motions as found in the samples. (Table 6 and \
         section 2.4.2 agree on 0.05 s; the 0.005 s in the text of Appendix C is a slip.)",
        bench.model.settle_time_s()
    ));
    chapter.paragraph(left_out(runs, &identified.left_out));
    Ok(chapter)
}
