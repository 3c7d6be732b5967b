//! `iiwasim experiment`.

mod arm;
mod folder;

use std::{
    env, io,
    path::{Path, PathBuf},
};

use iiwa_report::{
    Bench, ExperimentKind, TrialRun, VirtualArm, motion_warning, other_robot, preface,
};

use crate::{
    args::{DriveAddress, Experiment, ExperimentName},
    failure::{Failure, print_note},
    input, output,
    progress::Progress,
    runner::connect,
};

use self::{
    arm::ExperimentArm,
    folder::{Folder, write},
};

/// Runs experiments and writes their report.
pub(crate) fn run(options: &Experiment) -> Result<(), Failure> {
    let model = input::find_robot(&options.robot)?;
    let kinds = match options.name {
        ExperimentName::Limits => vec![ExperimentKind::Limits],
        ExperimentName::Blends => vec![ExperimentKind::Blends],
        ExperimentName::ZoneVelocity => vec![ExperimentKind::ZoneVelocity],
        ExperimentName::Settle => vec![ExperimentKind::Settle],
        ExperimentName::CycleTime => vec![ExperimentKind::CycleTime],
        ExperimentName::TcpBlends => vec![ExperimentKind::TcpBlends],
        ExperimentName::Load => vec![ExperimentKind::Load],
        ExperimentName::All => ExperimentKind::ALL.to_vec(),
    };
    let default_folder = || PathBuf::from(format!("experiment-{}", options.name.name()));
    let path = options.output.clone().unwrap_or_else(default_folder);
    let (report, link) = report_path(options, &path)?;
    let virtual_robot = match &options.virtual_robot {
        Some(name) => input::find_robot(name)?,
        None => model.clone(),
    };
    let folder = Folder::new(&path, options)?;
    let bench = Bench {
        model,
        seed: options.seed,
        load: options.load,
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
            folder.check(&bench.model)?;
            let keys = options.keys.clone();
            let address = DriveAddress { drive: drive.clone(), keys };
            let line = Box::new(connect(&address, &options.stream)?);
            let trials = programs.iter().flat_map(|(_, trials)| trials);
            let warning = motion_warning(&bench.model, trials, count);
            print_note(&warning.map_err(|fault| Failure::input(fault.to_string()))?);
            ExperimentArm::Real { line, to_start }
        }
        _ => ExperimentArm::Virtual(Box::new(VirtualArm {
            robot: virtual_robot,
            noise_rad: options.noise,
            rate_hz: 0.0,
            seed: options.seed,
            load_planning: options.load_planner,
        })),
    };

    let command: Vec<_> = env::args().skip(1).collect();
    let virtual_arm = match &arm {
        ExperimentArm::Virtual(arm) => Some((&**arm, options.virtual_robot.as_deref())),
        ExperimentArm::Real { .. } => None,
    };
    let mut text = preface(&format!("iiwasim {}", command.join(" ")), &kinds, &bench, virtual_arm);
    let mut progress = Progress::of_experiment(count);
    let mut done = 0;
    for (kind, trials) in programs {
        if let ExperimentArm::Virtual(arm) = &mut arm {
            arm.rate_hz = options.rate.unwrap_or(kind.rate_hz());
        }
        let mut runs = Vec::with_capacity(trials.len());
        for trial in trials {
            if let (ExperimentArm::Real { .. }, Some(mounted)) = (&arm, kind.to_mount(&trial)) {
                wait_for_enter(&mounted)?;
            }
            let log = arm.run(&trial, &bench.model)?;
            folder.run(&trial, &log, &bench.model)?;
            runs.push(TrialRun { trial, log });
            done += 1;
            // On a robot, each run has its own bar.
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
    if let (ExperimentArm::Virtual(arm), ExperimentName::All, None) =
        (&arm, options.name, &options.virtual_robot)
    {
        text.push('\n');
        text.push_str(&other_robot(&bench, arm)?.text);
    }
    progress.clear();
    write(&report, text.as_bytes())?;
    if let Some(size) = folder.size() {
        print_note(&format!("{size}\n"));
    }
    let programs = if count == 1 { "program" } else { "programs" };
    output::print(&format!("{count} {programs} {}; report in {}\n", bench.on, report.display()))
}

/// Asks for manual work, and waits for its confirmation.
fn wait_for_enter(prompt: &str) -> Result<(), Failure> {
    print_note(&format!("{prompt}; then press Enter\n"));
    let confirmed = matches!(io::stdin().read_line(&mut String::new()), Ok(1..));
    let unconfirmed = || Failure::input(format!("{prompt}: that has to be confirmed by Enter"));
    confirmed.then_some(()).ok_or_else(unconfirmed)
}

/// Path of the report, and the prefix of links from it to the files of the folder.
fn report_path(options: &Experiment, folder: &Path) -> Result<(PathBuf, String), Failure> {
    let Some(report) = &options.report else {
        return Ok((folder.join("report.md"), String::new()));
    };
    let above = report.parent().unwrap_or(Path::new(""));
    let Ok(between) = folder.strip_prefix(above) else {
        return Err(Failure::input(format!(
            "{} is neither in the folder {} nor above it, so that it cannot link to the figures",
            report.display(),
            folder.display()
        )));
    };
    let link =
        between.iter().fold(String::new(), |link, part| link + &part.to_string_lossy() + "/");
    Ok((report.clone(), link))
}
