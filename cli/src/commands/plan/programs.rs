//! Programs to plan, and the files of their trajectories.

use std::{
    collections::{BTreeMap, HashMap},
    ffi::OsStr,
    fs, io,
    path::{Path, PathBuf},
};

use iiwa_files::{destination, read_text};
use iiwa_json::printable;

use crate::{
    args::Plan,
    failure::{Failure, print_note},
    file_kind::JsonKind,
    input::is_stdin,
};

use super::work::file_name;

/// Program, and the file of its trajectory, if one is written.
pub(super) struct PlanJob {
    pub(super) program: PathBuf,
    pub(super) target: Option<PathBuf>,
}

/// Returns all given programs in order, with folders expanded to their programs. Rejects
/// duplicates, programs with the same output file, and outputs that overwrite an input.
pub(super) fn jobs(options: &Plan, given: &[PathBuf]) -> Result<Vec<PlanJob>, Failure> {
    let mut programs = Vec::new();
    for path in given {
        if is_stdin(path) {
            return Err(Failure::input("standard input (-) can only be planned alone"));
        }
        if path.is_dir() {
            programs.append(&mut programs_in(path)?);
        } else {
            programs.push(path.clone());
        }
    }
    each_once(&programs)?;
    let target = |program: &Path| {
        let folder = options.output.clone().unwrap_or_default();
        (!options.no_output).then(|| folder.join(file_name(program)))
    };
    let jobs: Vec<_> =
        programs.into_iter().map(|program| PlanJob { target: target(&program), program }).collect();
    let robot = options.robot.as_deref().map(Path::new);
    distinct(&jobs, robot.into_iter().chain(options.scene.as_deref()))?;
    Ok(jobs)
}

/// Lists the programs directly in a folder, sorted by name: its files `*.json`, as a shell lists
/// them, except robot profiles and included files, which are beside the programs that name them,
/// scenes and JSON Schemas. A note names the files that are left out.
pub(in crate::commands) fn programs_in(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let to_failure = |error: io::Error| {
        Failure::input(format!("cannot read the folder {}: {error}", folder.display()))
    };
    let mut names = Vec::new();
    let mut left_out = BTreeMap::new();
    for entry in fs::read_dir(folder).map_err(to_failure)? {
        let name = entry.map_err(to_failure)?.file_name();
        let hidden = name.as_encoded_bytes().starts_with(b".");
        let path = folder.join(&name);
        // A broken link is kept, so that it is reported as a program that cannot be read.
        let is_file = path.metadata().map_or(true, |kind| kind.is_file());
        if hidden || path.extension() != Some(OsStr::new("json")) || !is_file {
            continue;
        }
        match other_kind(&path) {
            Some(kind) => drop(left_out.insert(name, kind)),
            None => names.push(name),
        }
    }
    #[cfg(feature = "sunrise")]
    if names.is_empty() && iiwa_sunrise::Project::has_sources(folder) {
        return Err(Failure::input(format!(
            "the folder {} has no programs, but Java: for an application of a Sunrise project, \
             name it with --application",
            folder.display()
        )));
    }
    if names.is_empty() {
        return Err(Failure::input(format!(
            "the folder {} has no programs: files *.json other than robot profiles, scenes, JSON \
             Schemas and files to include",
            folder.display()
        )));
    }
    for (name, (kind, fault)) in left_out {
        let path = folder.join(name);
        let fault = fault.map(|fault| format!(", with a fault: {fault}")).unwrap_or_default();
        let note = format!("{} is a {}, and is not planned{fault}", path.display(), kind.name());
        print_note(&format!("Note: {}\n", printable(&note)));
    }
    names.sort();
    Ok(names.into_iter().map(|name| folder.join(name)).collect())
}

/// Returns the kind of a file that is not a program, with its fault, if it has one.
fn other_kind(path: &Path) -> Option<(JsonKind, Option<String>)> {
    let text = read_text(path).ok()?;
    let kind = JsonKind::of(&text).filter(|kind| *kind != JsonKind::Program)?;
    Some((kind, kind.fault(&text)))
}

/// Rejects duplicate programs.
fn each_once(programs: &[PathBuf]) -> Result<(), Failure> {
    let mut seen = HashMap::new();
    for program in programs {
        let Some(other) = seen.insert(place(program), program) else { continue };
        return Err(Failure::input(if other == program {
            format!("{} is given twice", program.display())
        } else {
            format!("{} and {} are the same file", other.display(), program.display())
        }));
    }
    Ok(())
}

/// Resolves the folder of a path, so that equal files compare equal. A symbolic link to a file is
/// not resolved, and counts as a separate file.
fn place(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    match (folder.unwrap_or(Path::new(".")).canonicalize(), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path.to_owned(),
    }
}

/// Rejects outputs that would overwrite an input or each other.
fn distinct<'a>(
    jobs: &'a [PlanJob],
    others: impl Iterator<Item = &'a Path>,
) -> Result<(), Failure> {
    let programs = jobs.iter().map(|job| job.program.as_path());
    let read: HashMap<_, _> =
        programs.chain(others).filter_map(|path| Some((path.canonicalize().ok()?, path))).collect();
    let mut written = HashMap::new();
    for PlanJob { program, target } in jobs {
        let Some(target) = target else { continue };
        // Writing to a link replaces its target.
        let file = destination(target).unwrap_or_else(|_| target.clone());
        if let Some(read) = read.get(&file) {
            return Err(Failure::input(format!(
                "the trajectory of {} would be written over {}; name another folder with --output",
                program.display(),
                read.display()
            )));
        }
        if let Some(other) = written.insert(file, program) {
            return Err(Failure::input(format!(
                "the trajectories of {} and {} would both be written to {}; rename one of them, \
                 or plan them one after the other",
                other.display(),
                program.display(),
                target.display()
            )));
        }
    }
    Ok(())
}
