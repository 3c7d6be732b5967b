//! Prints the time of importing large Sunrise projects, and the peak memory: an application of
//! about a thousand motions, which is planned as well, and a project of 100 files of 30 kB, all of
//! which the application uses.

mod large;

use std::{fmt::Write as _, fs, path::Path, process::ExitCode, time::Instant};

use super::no_arguments::no_arguments;
use iiwa_sunrise::Project;
use iiwa_sunrise::{ImportOptions, import};
use iiwasim_benches::{Result, machine};
use tempfile::TempDir;

const FILES: usize = 100;
/// Size of each file.
const BYTES: usize = 30_000;

pub(crate) fn run(arguments: &[&str]) -> Result<ExitCode> {
    no_arguments(arguments)?;
    // Runs first, since the reported memory is the peak of the process.
    large::run()?;
    let folder = TempDir::new()?;
    write_project(folder.path())?;
    let before_mb = machine::peak_memory_mb()?;
    let begin = Instant::now();
    let project = Project::open(folder.path())?;
    let opened = begin.elapsed();
    let import = import(&project, None, &ImportOptions::default())?;
    let imported = begin.elapsed();
    println!(
        "import: {FILES} Java files of {} kB each: read in {:.0} ms, {} motions after {:.0} ms, \
         {:.0} MB at most, {before_mb:.0} MB before",
        BYTES / 1000,
        1e3 * opened.as_secs_f64(),
        import.program.motions.len(),
        1e3 * imported.as_secs_f64(),
        machine::peak_memory_mb()?,
    );
    Ok(ExitCode::SUCCESS)
}

/// Writes an application that moves through a method of each of the other classes.
fn write_project(folder: &Path) -> Result<()> {
    let sources = folder.join("src/application");
    fs::create_dir_all(&sources)?;
    let mut run = String::new();
    for number in 1..FILES {
        let name = format!("Station{number}");
        let mut text =
            format!("package application;\n\n/** One of many. */\npublic class {name} {{\n");
        let mut method = 0;
        while text.len() < BYTES {
            let _ = write!(
                text,
                "    /** The angle of place {method}, in rad. */\n    public double \
                 angle{method}(int turn) {{\n        double sum = {method} * 0.5;\n        for \
                 (int i = 0; i < turn; i++) {{\n            sum = Math.toRadians(sum + i) * (turn \
                 > 3 ? 0.5 : 1.0);\n        }}\n        return sum;\n    }}\n\n"
            );
            method += 1;
        }
        text.push_str("}\n");
        fs::write(sources.join(format!("{name}.java")), text)?;
        let _ = writeln!(
            run,
            "        lbr.move(ptp(new {name}().angle1(3), 0.5, 0, -1.2, 0, 1.0, \
             0).setJointVelocityRel(0.5));"
        );
    }
    let main = format!(
        "package application;\n\nimport static \
         com.kuka.roboticsAPI.motionModel.BasicMotions.ptp;\n\n\
         public class Main extends RoboticsAPIApplication {{\n    @Inject\n    private LBR \
         lbr;\n\n    @Override\n    public void run() {{\n{run}    }}\n}}\n"
    );
    fs::write(sources.join("Main.java"), main)?;
    Ok(())
}
