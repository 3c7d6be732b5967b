//! Files of a URDF: its text, and the meshes that it names.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use iiwa_kin::Robot;
use iiwa_page::ArmSource;
use iiwa_scene::{ArmMeshError, ArmMeshes};

use crate::{args::Urdf, failure::Failure, input::FileText};

/// URDF of the arm, with its package folders.
#[derive(Clone, Debug)]
pub(crate) struct ArmFiles(Arc<Files>);

#[derive(Debug)]
struct Files {
    path: PathBuf,
    text: FileText,
    packages: Vec<PathBuf>,
}

impl ArmFiles {
    /// Reads the URDF of the options, if given.
    pub(crate) fn new(options: &Urdf) -> Result<Option<Self>, Failure> {
        let Some(path) = options.urdf.clone() else { return Ok(None) };
        let text = FileText::read(&path)?;
        let packages = options.package_path.clone();
        if let Some(missing) = packages.iter().find(|folder| !folder.is_dir()) {
            return Err(Failure::input(format!(
                "--package-path: no such folder: {}",
                missing.display()
            )));
        }
        Ok(Some(Self(Arc::new(Files { path, text, packages }))))
    }

    /// Reads the meshes of a robot.
    pub(crate) fn meshes(&self, robot: &Robot) -> Result<ArmMeshes, Failure> {
        self.0.meshes(robot).map_err(|error| self.failure(&error))
    }

    /// Returns the meshes as a source for a page.
    pub(crate) fn source(&self) -> ArmSource {
        let files = Arc::clone(&self.0);
        ArmSource::new(move |robot| files.meshes(robot))
    }

    /// Converts an error of the URDF to a failure, with its place in the text if known.
    pub(crate) fn failure(&self, error: &ArmMeshError) -> Failure {
        let FileText { name, text } = &self.0.text;
        match error.place() {
            Some(place) => Failure::in_text(&error.message(), place, name, text),
            None => Failure::input(format!("{name}: {error}")),
        }
    }
}

impl Files {
    fn meshes(&self, robot: &Robot) -> Result<ArmMeshes, ArmMeshError> {
        ArmMeshes::from_urdf(robot, &self.text.text, |name| self.read(name))
    }

    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        let path = self.path_of(name)?;
        iiwa_files::read(&path).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => format!("no such file: {}", path.display()),
            _ => format!("cannot read {}: {error}", path.display()),
        })
    }

    /// Returns the path of a file that the URDF names.
    fn path_of(&self, name: &str) -> Result<PathBuf, String> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let Some(rest) = name.strip_prefix("package://") else {
            return Ok(folder.join(name.strip_prefix("file://").unwrap_or(name)));
        };
        let (package, file) = rest.split_once('/').unwrap_or((rest, ""));
        // A further slash must not make the path absolute.
        let file = file.trim_start_matches('/');
        let folders = self.packages(package);
        match folders.iter().map(|folder| folder.join(file)).find(|path| path.is_file()) {
            Some(path) => Ok(path),
            None if folders.is_empty() => Err(format!(
                "unknown package {package}: --package-path names the folder that it is in, or its \
                 own"
            )),
            None => Err(format!("the package {package} has no file {file}")),
        }
    }

    /// Returns candidate folders of a package: below or among the folders of the options, or around
    /// the URDF.
    fn packages(&self, name: &str) -> Vec<PathBuf> {
        let is_called = |folder: &Path| folder.file_name().is_some_and(|last| last == name);
        let real = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let inside = self.packages.iter().map(|folder| folder.join(name));
        let matches = self.packages.iter().map(|folder| real(folder)).filter(|it| is_called(it));
        let urdf = real(&self.path);
        let around = urdf.ancestors().filter(|folder| is_called(folder)).map(Path::to_owned);
        inside.chain(matches).chain(around).filter(|folder| folder.is_dir()).collect()
    }
}
