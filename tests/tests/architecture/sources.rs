//! Files and crates of the workspace.

use std::fs;
use std::path::{Path, PathBuf};

/// Folders without project sources.
const SKIPPED: [&str; 5] = ["target", ".git", "node_modules", "corpus", "artifacts"];

/// Returns the folder of the workspace.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("this crate is in a folder of the workspace")
        .to_path_buf()
}

/// Returns all files below a folder with one of these extensions, in order; empty if the folder is
/// missing.
pub(crate) fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut sources = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = fs::read_dir(&folder) else { continue };
        for path in entries.map(|entry| entry.unwrap().path()) {
            let name = path.file_name().unwrap().to_string_lossy();
            if path.is_dir() {
                if !SKIPPED.contains(&&*name) {
                    folders.push(path);
                }
            } else if path.extension().is_some_and(|end| extensions.iter().any(|e| end == *e)) {
                sources.push(path);
            }
        }
    }
    sources.sort();
    sources
}

/// Formats a path for messages: relative to the workspace, with `/`.
pub(crate) fn shown(path: &Path) -> String {
    let path = path.strip_prefix(root()).unwrap_or(path);
    path.components()
        .map(|part| part.as_os_str().to_string_lossy().into_owned())
        .collect::<Vec<_>>()
        .join("/")
}

pub(crate) fn text(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", shown(path)))
}

/// Member of the workspace.
pub(crate) struct Member {
    /// Name of the package.
    pub(crate) name: String,
    pub(crate) folder: PathBuf,
    /// Packages under `[dependencies]`, of any target.
    pub(crate) dependencies: Vec<String>,
}

impl Member {
    /// Returns true for libraries, which are below `crates/`.
    pub(crate) fn is_library(&self) -> bool {
        self.folder.ancestors().nth(2).is_some_and(|crates| crates.ends_with("crates"))
    }

    /// Returns the roots of its module trees: `lib.rs`, `main.rs` and further binaries.
    pub(crate) fn roots(&self) -> Vec<PathBuf> {
        let src = self.folder.join("src");
        let mut roots: Vec<PathBuf> = ["lib.rs", "main.rs"]
            .iter()
            .map(|name| src.join(name))
            .filter(|path| path.exists())
            .collect();
        roots.extend(files(&src.join("bin"), &["rs"]).into_iter().filter(|path| {
            let is_in =
                |folder: &Path| folder.parent().is_some_and(|parent| parent.ends_with("bin"));
            is_in(path) || path.ends_with("main.rs") && path.parent().is_some_and(is_in)
        }));
        roots
    }
}

/// Returns the members of the workspace, in order of their folders.
pub(crate) fn members() -> Vec<Member> {
    let within = |folder: PathBuf| fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut folders: Vec<PathBuf> = within(root().join("crates"))
        .filter(|path| path.is_dir())
        .flat_map(within)
        .filter(|path| path.join("Cargo.toml").exists())
        .collect();
    folders.sort();
    folders.extend(["cli", "benches", "tests"].map(|name| root().join(name)));
    folders.into_iter().map(member).collect()
}

fn member(folder: PathBuf) -> Member {
    let manifest = text(&folder.join("Cargo.toml"));
    let (mut name, mut dependencies) = (None, Vec::new());
    let mut table = "";
    for line in manifest.lines().map(str::trim).filter(|line| !line.starts_with('#')) {
        if let Some(header) = line.strip_prefix('[') {
            table = header.trim_matches(['[', ']']);
            // For example `[dependencies.serde]`.
            if let Some((_, package)) = table.split_once("dependencies.")
                && !table.starts_with("dev-")
                && !table.contains(".dev-")
            {
                dependencies.push(package.to_owned());
            }
            continue;
        }
        let Some((key, value)) = line.split_once('=') else { continue };
        let key = key.trim().split('.').next().unwrap_or_default();
        if table == "package" && key == "name" {
            name = Some(value.trim().trim_matches('"').to_owned());
        }
        if table == "dependencies" || table.ends_with(".dependencies") {
            dependencies.push(key.to_owned());
        }
    }
    let name = name.unwrap_or_else(|| panic!("{}: no name", shown(&folder)));
    Member { name, folder, dependencies }
}
