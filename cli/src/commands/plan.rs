//! `iiwasim plan`.

use std::{
    fmt::Write as _,
    path::{Path as FilePath, PathBuf},
    time::{Duration, Instant},
};

use iiwa_log::{PlanConfig, PlanWriter};
use iiwa_path::{Path, PathOptions};
use iiwa_traj::{Planner, SweepOptions, Timing};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::{
    args::{self, Plan},
    failure::Failure,
    figures::Figures,
    input,
    output::{self, Output},
    picture::Picture,
    table,
};

/// Plans a program, writes its trajectory and prints its figures.
pub(crate) fn run(options: &Plan) -> Result<(), Failure> {
    let target = output_path(options);
    distinct(options, target.as_deref())?;
    let (text, program, robot) = input::program(&options.program, options.robot.as_deref())?;
    output::catch_interrupts();
    let path_options = PathOptions {
        blend_shape: options.blend_shape.into(),
        blend_search: options.blend_search.into(),
    };
    let path = Path::with_options(&program, &robot, path_options).map_err(|fault| {
        let place = fault.place_in(&text.text);
        Failure::in_text(&fault.to_string(), &place, &text.name, &text.text)
    })?;
    drop(program);

    let args::Timing::Acceleration = options.timing;
    let timing = Timing::Acceleration(SweepOptions { samples: options.samples as usize });
    let mut figures = Figures::new(timing.name(), &robot, options.samples);

    let output = target.as_deref().map(Output::new).transpose()?;
    let drawing = options.picture.as_deref().map(Output::new).transpose()?;
    let mut writer = match &output {
        None => None,
        Some(output) => {
            let mut config = PlanConfig { rate_hz: options.rate, ..PlanConfig::default() };
            if let Some(epoch) = options.epoch {
                config.file.epoch = epoch;
            }
            let writer = PlanWriter::new(output.stream()?, &robot, config);
            Some(writer.map_err(|error| output.failure(&error))?)
        }
    };
    let mut picture = drawing.as_ref().map(|_| Picture::new(&robot));

    let mut progress = Progress::new();
    let mut planner = Planner::new(&path, timing);
    while let Some(stretch) = planner.next() {
        output::check_interrupt()?;
        let stretch = stretch.map_err(|error| Failure::run("cannot plan the program", &error))?;
        figures.add(&stretch);
        if let (Some(writer), Some(output)) = (&mut writer, &output) {
            writer.stretch(&stretch).map_err(|error| output.failure(&error))?;
        }
        if let Some(picture) = &mut picture {
            picture.add(&stretch);
        }
        progress.show(planner.progress());
    }
    progress.clear();

    if let (Some(writer), Some(output)) = (writer, &output) {
        let program = ("program.json", "application/json", text.text.as_bytes());
        let stream = writer.finish(&figures.metadata(), &[program]);
        stream
            .map_err(|error| output.failure(&error))?
            .into_inner()
            .map_err(|error| output.failure(error.error()))?;
    }
    if let (Some(picture), Some(drawing)) = (picture, &drawing) {
        drawing.write(picture.draw()?.as_bytes())?;
    }
    for whole in output.into_iter().chain(drawing) {
        whole.complete()?;
    }
    report(options, &figures, target.as_deref())?;

    match options.max_cycle_time {
        Some(limit) if figures.cycle_time_s > limit => Err(Failure::Gate(format!(
            "the program takes {:.3} s, more than {limit} s",
            figures.cycle_time_s
        ))),
        _ => Ok(()),
    }
}

/// Where the MCAP file goes, if anywhere.
fn output_path(options: &Plan) -> Option<PathBuf> {
    if options.no_output {
        return None;
    }
    Some(options.output.clone().unwrap_or_else(|| {
        let stem = match options.program.file_stem() {
            Some(stem) if options.program != FilePath::new("-") => stem.to_owned(),
            _ => "program".into(),
        };
        let mut name = stem;
        name.push(".mcap");
        PathBuf::from(name)
    }))
}

/// Refuses to write over what is read, or one file twice.
fn distinct(options: &Plan, target: Option<&FilePath>) -> Result<(), Failure> {
    let same = |a: &FilePath, b: &FilePath| {
        a == b || a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
    };
    let robot = options.robot.as_deref().map(FilePath::new);
    let read = [("program", Some(options.program.as_path())), ("robot", robot)];
    let written = [("trajectory", target), ("picture", options.picture.as_deref())];
    for (what, path) in written {
        let others = read.iter().chain(written.iter().filter(|(other, _)| *other < what));
        for (other, its) in others {
            if let (Some(path), Some(its)) = (path, its)
                && same(path, its)
            {
                return Err(Failure::input(format!(
                    "the {what} would be written over the {other}, {}; name another file with {}",
                    path.display(),
                    if what == "picture" { "--picture" } else { "--output" }
                )));
            }
        }
    }
    Ok(())
}

/// The figures, and where the file is.
#[derive(serde::Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    figures: &'a Figures,
    output: Option<String>,
}

fn report(options: &Plan, figures: &Figures, file: Option<&FilePath>) -> Result<(), Failure> {
    if !options.json {
        let mut text = table::figures(figures);
        if let Some(file) = file {
            let _ = writeln!(text, "Trajectory in {}", file.display());
        }
        return output::print(&text);
    }
    let report = Report { figures, output: file.map(|file| file.display().to_string()) };
    let json = serde_json::to_string(&report)
        .map_err(|error| Failure::run("cannot write the figures", &error))?;
    output::print(&format!("{json}\n"))
}

/// A progress bar on standard error, if that is a terminal, once the work turns out to be long.
struct Progress {
    since: Instant,
    bar: Option<ProgressBar>,
}

impl Progress {
    const SHORT: Duration = Duration::from_millis(500);
    const STEPS: u64 = 1000;

    fn new() -> Self {
        Self { since: Instant::now(), bar: None }
    }

    fn show(&mut self, share: f64) {
        if self.bar.is_none() && self.since.elapsed() < Self::SHORT {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let style = ProgressStyle::with_template("planning {wide_bar} {percent} %, {eta} left");
            let bar =
                ProgressBar::with_draw_target(Some(Self::STEPS), ProgressDrawTarget::stderr());
            bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1000")]
        bar.set_position((share * Self::STEPS as f64) as u64);
    }

    fn clear(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}
