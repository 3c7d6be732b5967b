//! Differences of the programs of two folders, as a table and as Markdown.

use std::fmt::Write as _;

use comfy_table::{Table, presets};
use iiwa_eval::PlanVersion;
use iiwa_json::printable;
use serde::Serialize;

use crate::{
    DifferenceReport, ProgramErrors,
    markdown::{escaped, html_escaped},
    signed::signed,
    table::{fitted, table},
};

/// Differences of the programs of two folders.
#[derive(Clone, Debug, Default)]
pub struct DifferenceSummary {
    programs: Vec<ProgramDifference>,
}

/// Difference of a program, with its name. As JSON, this is a line of `iiwasim diff --json` for
/// folders.
#[derive(Clone, Debug, Serialize)]
pub struct ProgramDifference {
    program: String,
    /// `compared`, `added`, `removed` or `failed`. A program whose old version could not be planned
    /// counts as added.
    result: &'static str,
    #[serde(flatten)]
    difference: ProgramChange,
}

/// Difference, the cycle time in the only folder that has the program, or the errors of the new
/// version.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
enum ProgramChange {
    Compared(Box<DifferenceReport>),
    Alone { cycle_time_s: OnlyTime },
    Failed(ProgramErrors),
}

/// Cycle time of a program that one of the folders lacks, in s.
#[derive(Clone, Copy, Debug, Serialize)]
struct OnlyTime {
    old: Option<f64>,
    new: Option<f64>,
}

impl DifferenceSummary {
    /// Adds a program; one of the folders may lack it.
    pub fn add(&mut self, program: String, old: Option<&PlanVersion>, new: Option<&PlanVersion>) {
        let time_s = |plan: Option<&PlanVersion>| plan.map(|plan| plan.figures().cycle_time_s);
        let (result, difference) = if let (Some(old), Some(new)) = (old, new) {
            let difference = Box::new(DifferenceReport::new(old, new));
            ("compared", ProgramChange::Compared(difference))
        } else {
            let cycle_time_s = OnlyTime { old: time_s(old), new: time_s(new) };
            let result = if old.is_some() { "removed" } else { "added" };
            (result, ProgramChange::Alone { cycle_time_s })
        };
        self.programs.push(ProgramDifference { program, result, difference });
    }

    /// Adds a program whose new version could not be planned.
    pub fn add_failed(&mut self, program: String, errors: ProgramErrors) {
        let difference = ProgramChange::Failed(errors);
        self.programs.push(ProgramDifference { program, result: "failed", difference });
    }

    /// Programs, in order.
    pub fn programs(&self) -> impl Iterator<Item = &ProgramDifference> {
        self.programs.iter()
    }

    /// Returns the reason why the comparison is not a success: programs that failed, and gates that
    /// are not met.
    #[must_use]
    pub fn complaint(&self, max_growth_percent: Option<f64>) -> Option<String> {
        let failed = self.programs.iter().filter(|program| program.result == "failed").count();
        let failed = match failed {
            0 => None,
            1 => Some("one program failed".to_owned()),
            more => Some(format!("{more} programs failed")),
        };
        let unmet = self.programs.iter().filter_map(|program| {
            let unmet = program.compared()?.complaint(max_growth_percent)?;
            Some(format!("{}: {unmet}", printable(&program.program)))
        });
        let all: Vec<_> = unmet.chain(failed).collect();
        (!all.is_empty()).then(|| all.join("; "))
    }

    /// Formats all differences as tables and sentences. Cells of tables are wrapped to lines of at
    /// most `width` characters; see [`fitted`].
    #[must_use]
    pub fn text(&self, width: Option<u16>) -> String {
        let mut text = String::new();
        for (program, difference) in self.changed() {
            let _ = writeln!(text, "{}\n\n{}", printable(program), difference.text(width));
        }
        let table = self.table(str::to_owned);
        let _ = writeln!(text, "{}\n\n{}", fitted(table, width), self.counts());
        text
    }

    /// Formats all differences as Markdown: the table of programs, and the motions of each program
    /// that differs, folded.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut table = self.table(escaped);
        table.load_style(presets::ASCII_MARKDOWN);
        let mut text = format!("{}\n\n{table}\n", self.counts());
        for (program, difference) in self.changed() {
            let program = html_escaped(&printable(program));
            let _ = writeln!(
                text,
                "\n<details><summary>{program}</summary>\n\n{}\n</details>",
                difference.markdown()
            );
        }
        text
    }

    /// Returns the programs that differ.
    fn changed(&self) -> impl Iterator<Item = (&str, &DifferenceReport)> {
        let differ = |difference: &&DifferenceReport| !difference.is_empty();
        self.programs.iter().filter_map(move |program| {
            Some((program.program.as_str(), program.compared().filter(differ)?))
        })
    }

    /// Returns the number of programs with each result.
    fn counts(&self) -> String {
        let differ = self.changed().count();
        let count = |result| self.programs.iter().filter(|one| one.result == result).count();
        let counts = [
            (differ, "changed"),
            (count("added"), "added"),
            (count("removed"), "removed"),
            (count("failed"), "failed"),
        ];
        let counts = counts.into_iter().filter(|(count, _)| *count > 0);
        let counts: Vec<_> = counts
            .map(|(count, result)| format!("{count} {result}"))
            .chain([format!("{} unchanged", count("compared") - differ)])
            .collect();
        format!("Programs: {}", counts.join(", "))
    }

    /// Returns the table of all programs; `name` formats their names.
    fn table(&self, name: impl Fn(&str) -> String) -> Table {
        let mut table = table(&["program", "s before", "s after", "change s", "change %"]);
        for ProgramDifference { program, result, difference } in &self.programs {
            let program = name(&printable(program));
            let time =
                |time_s: Option<f64>| time_s.map(|it| format!("{it:.3}")).unwrap_or_default();
            table.add_row(match difference {
                ProgramChange::Compared(difference) => {
                    let [old_s, new_s] = difference.cycle_times_s();
                    let growth = difference.growth_percent();
                    let percent =
                        if growth.is_finite() { signed(growth, 1) } else { String::new() };
                    let [old, new] = [old_s, new_s].map(|time_s| time(Some(time_s)));
                    [program, old, new, signed(new_s - old_s, 3), percent]
                }
                ProgramChange::Alone { cycle_time_s: OnlyTime { old, new } } => {
                    [program, time(*old), time(*new), (*result).to_owned(), String::new()]
                }
                ProgramChange::Failed(_) => {
                    let empty = String::new;
                    [program, empty(), empty(), (*result).to_owned(), empty()]
                }
            });
        }
        table
    }
}

impl ProgramDifference {
    /// Returns the difference of a program in both folders.
    fn compared(&self) -> Option<&DifferenceReport> {
        match &self.difference {
            ProgramChange::Compared(difference) => Some(difference),
            ProgramChange::Alone { .. } | ProgramChange::Failed(_) => None,
        }
    }
}
