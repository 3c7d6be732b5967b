//! `iiwasim experiment`.

mod arm;
mod folder;

use std::{
    env,
    fmt::Write as _,
    path::{Path, PathBuf},
};

use iiwa_eval::experiment::Trial;
use iiwa_path::Motion;
use iiwa_view::{Bench, ExperimentKind, TrialRun, VirtualArm, other_robot, wrapped};

use crate::{
    args::{DriveAddress, Experiment, ExperimentName},
    failure::{Failure, tell},
    input, output,
    progress::Progress,
    runner::Line,
};

use self::{
    arm::Arm,
    folder::{Folder, write},
};

/// Does experiments and writes their report.
pub(crate) fn run(options: &Experiment) -> Result<(), Failure> {
    let model = input::find_robot(&options.robot, Path::new("."))?;
    let kinds = match options.name {
        ExperimentName::Limits => vec![ExperimentKind::Limits],
        ExperimentName::Blends => vec![ExperimentKind::Blends],
        ExperimentName::ZoneVelocity => vec![ExperimentKind::ZoneVelocity],
        ExperimentName::Settle => vec![ExperimentKind::Settle],
        ExperimentName::CycleTime => vec![ExperimentKind::CycleTime],
        ExperimentName::All => ExperimentKind::ALL.to_vec(),
    };
    let path = match &options.output {
        Some(path) => path.clone(),
        None => PathBuf::from(format!("experiment-{}", options.name.name())),
    };
    let (report, link) = report_path(options, &path)?;
    let virtual_robot = match &options.virtual_robot {
        Some(name) => input::find_robot(name, Path::new("."))?,
        None => model.clone(),
    };
    let folder = Folder::new(&path, !options.no_recordings, options.drive.is_some())?;
    let bench = Bench {
        model,
        seed: options.seed,
        count: options.count.map(usize::from),
        on: match &options.drive {
            Some(address) => format!("on the robot at {address}"),
            None => "on a virtual robot".to_owned(),
        },
        link,
    };
    output::catch_interrupts();

    let programs: Vec<_> = kinds.iter().map(|kind| (*kind, kind.trials(&bench))).collect();
    let count = programs.iter().map(|(_, trials)| trials.len()).sum();
    let mut arm = match (&options.drive, options.move_to_start) {
        (Some(drive), Some(to_start)) => {
            let keys = options.keys.clone();
            let address = DriveAddress { drive: drive.clone(), keys };
            let line = Box::new(Line::new(&address, &options.stream)?);
            tell(&warning(programs.iter().flat_map(|(_, trials)| trials), count));
            Arm::Real { line, to_start }
        }
        _ => Arm::Virtual(Box::new(VirtualArm {
            robot: virtual_robot,
            noise_rad: options.noise,
            rate_hz: 0.0,
            seed: options.seed,
        })),
    };

    let mut text = heading(options, &bench, &arm);
    let mut progress = Progress::of_experiment(count);
    let mut done = 0;
    for (kind, trials) in programs {
        if let Arm::Virtual(arm) = &mut arm {
            arm.rate_hz = options.rate.unwrap_or(kind.rate_hz());
        }
        let mut runs = Vec::with_capacity(trials.len());
        for trial in trials {
            let log = arm.run(&trial)?;
            folder.run(&trial, &log, &bench.model)?;
            runs.push(TrialRun { trial, log });
            done += 1;
            // On a robot each run has its own bar.
            if options.simulate {
                progress.show(done);
            }
        }
        let chapter = kind.chapter(&bench, &runs)?;
        for (name, svg) in &chapter.figures {
            folder.write(name, svg.as_bytes())?;
        }
        text.push('\n');
        text.push_str(&chapter.text);
    }
    if let (Arm::Virtual(arm), ExperimentName::All, None) =
        (&arm, options.name, &options.virtual_robot)
    {
        text.push('\n');
        text.push_str(&other_robot(&bench, arm)?.text);
    }
    progress.clear();
    write(&report, text.as_bytes())?;
    let programs = if count == 1 { "program" } else { "programs" };
    output::print(&format!("{count} {programs} {}; report in {}\n", bench.on, report.display()))
}

/// Where the report goes, and how it is linked from there to the folder's files.
fn report_path(options: &Experiment, folder: &Path) -> Result<(PathBuf, String), Failure> {
    let Some(report) = &options.report else {
        return Ok((folder.join("report.md"), String::new()));
    };
    let above = report.parent().unwrap_or(Path::new(""));
    let Ok(between) = folder.strip_prefix(above) else {
        return Err(Failure::input(format!(
            "{} is neither in the folder {} nor above it: it could not show the figures",
            report.display(),
            folder.display()
        )));
    };
    let parts: Vec<_> = between.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    let link = parts.iter().fold(String::new(), |link, part| format!("{link}{part}/"));
    Ok((report.clone(), link))
}

/// How far the arm will move.
fn warning<'a>(trials: impl Iterator<Item = &'a Trial>, count: usize) -> String {
    let mut range = [(f64::INFINITY, f64::NEG_INFINITY); 7];
    for trial in trials {
        let targets = trial.program.motions.iter().filter_map(|motion| match motion {
            Motion::Ptp(ptp) => Some(ptp.target_rad),
            _ => None,
        });
        for target in targets.chain([trial.program.start_rad]) {
            for (range, q) in range.iter_mut().zip(target) {
                *range = (range.0.min(q), range.1.max(q));
            }
        }
    }
    let mut text =
        format!("The arm will run programs: {count}. Joints will move between, in deg:\n");
    for (j, (low, high)) in range.iter().enumerate() {
        let _ =
            writeln!(text, "  A{} {:7.1} and {:6.1}", j + 1, low.to_degrees(), high.to_degrees());
    }
    text.push_str(
        "All that its links can reach there has to be free. Ctrl-C stops it on its path.\n",
    );
    text
}

/// What stands above all chapters.
fn heading(options: &Experiment, bench: &Bench, arm: &Arm) -> String {
    let mut text = String::from("# The thesis's experiments, done again\n\n");
    let command: Vec<_> = env::args().skip(1).collect();
    let _ = writeln!(text, "Made by\n\n```sh\niiwasim {}\n```", command.join(" "));
    let mut paragraph = |words: &str| {
        let _ = writeln!(text, "\n{}", wrapped(words));
    };
    let model = bench.model.name();
    match arm {
        Arm::Virtual(arm) => {
            let robot = match &options.virtual_robot {
                None => format!("the model itself, {model}"),
                Some(name) => format!("`{name}`, while the model is {model}"),
            };
            paragraph(&format!(
                "**Everything measured here was measured on a virtual robot, not on a real one.** It is a \
                 simulation inside the program that plans under limits of velocity, acceleration and jerk, \
                 and is sampled with noise of {:e} rad. It is {robot}. What agrees with the model shows \
                 that the methods find what is there; whether a real robot is like that, only a real one \
                 can show: the same command with `--drive` runs the same programs there.",
                arm.noise_rad
            ));
        }
        Arm::Real { .. } => paragraph(&format!(
            "Measured {}; the model is {model}. Whether that was a real robot or a simulated cabinet, the \
             drive does not tell.",
            bench.on
        )),
    }
    paragraph(
        "\"The thesis\" is C. Larsen, *Including a Collaborative Robot in Digital Twin Manufacturing \
         Systems* (Chalmers 2019); numbers of figures, tables and equations are its own. Its figures are \
         not shown here: what it reports is told in words or numbers. In pictures, what is calculated is \
         blue, what was measured is red.",
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_warning_tells_the_joints_ranges() {
        let trial = iiwa_eval::experiment::zone_velocity();
        let text = warning([&trial].into_iter(), 1);
        assert!(text.contains("A2   -27.2 and   63.6"), "{text}");
        assert!(text.contains("A1     0.0 and    0.0"), "{text}");
    }
}
