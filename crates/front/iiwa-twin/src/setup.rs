//! Setup of a twin.

use std::{
    env,
    fs::File,
    io::{self, ErrorKind},
    path::{Path, PathBuf},
};

use iiwa_files::{interrupt, leftovers::TemporaryName};
use iiwa_kin::{Joints, Robot, RosNames};
use iiwa_link::{Client, Remote, Stream};
use iiwa_page::{
    ArmSource, Extent, Nearest, NearestPlaces, Page, PageOptions, TwinRobot, TwinSetup,
};
use iiwa_plan::PlanOptions;
use iiwa_program::Program;
use iiwa_scene::{ArmInScene, ArmMeshes, CarriedBodies, PlannedClearance, Scene};
use iiwa_traj::Trajectory;
use tempfile::TempDir;

use crate::{TwinError, Wording, positions::default_file, runs::DriveConnection};

/// Options of a twin.
pub struct TwinOptions {
    /// Robot model.
    pub robot: Robot,
    /// Name of the robot as given by the user: a program may refer to it.
    pub robot_name: String,
    /// Names of the robot's joints and links, in files and for viewers.
    pub names: RosNames,
    /// Obstacles, if any.
    pub scene: Option<Scene>,
    /// Meshes of the arm in place of the built-in shells.
    pub meshes: Option<ArmMeshes>,
    /// Minimum clearance of programs that may be run, in mm.
    pub min_clearance_mm: f64,
    /// Inputs and outputs to show; if empty, those of the media flange.
    pub io: Vec<String>,
    /// Keys of the drive, for requests and for its stream.
    pub remote: Remote,
    /// Address for requests, such as `127.0.0.1:5560`.
    pub drive: String,
    /// Address of the stream, such as `127.0.0.1:5561`.
    pub stream: String,
    /// File of saved positions; by default, a file per robot in the user's data folder.
    pub positions: Option<PathBuf>,
    /// Folder of programs, plans and recordings, which is created if it is missing; by default, a
    /// folder that is removed at the end.
    pub folder: Option<PathBuf>,
    /// Texts on pages.
    pub wording: Wording,
}

/// Robot, its obstacles, and the connection to its drive.
pub struct Setup {
    pub(crate) robot: Robot,
    pub(crate) names: RosNames,
    /// Name of the robot, or of its profile.
    pub(crate) robot_name: String,
    arm: Option<ArmInScene>,
    meshes: Option<ArmMeshes>,
    pub(crate) min_clearance_mm: f64,
    pub(crate) io: Vec<String>,
    remote: Remote,
    drive: String,
    stream: String,
    /// File of saved positions.
    pub(crate) positions: PathBuf,
    folder: PathBuf,
    /// Temporary folder that is removed at the end, unless a folder was given.
    temporary: Option<Temporary>,
    pub(crate) wording: Wording,
}

/// Folder that is removed at the end.
struct Temporary {
    folder: TempDir,
    /// While the lock is open, no other twin removes the folder as a leftover.
    _lock: Option<File>,
}

impl Temporary {
    fn new() -> io::Result<Self> {
        let name = TemporaryName { prefix: "iiwasim-twin-", suffix: "", is_folder: true };
        let make = |name: &mut tempfile::Builder<'_, '_>| name.tempdir();
        let (folder, lock) = name.make(&env::temp_dir(), make, TempDir::path)?;
        Ok(Self { folder, _lock: lock })
    }
}

/// Inputs and outputs of the media flange, as in the simulated cabinet.
const MEDIA_FLANGE: [&str; 7] = [
    "MediaFlange.UserButton",
    "MediaFlange.LEDBlue",
    "MediaFlange.InputX3Pin3",
    "MediaFlange.InputX3Pin4",
    "MediaFlange.OutputX3Pin1",
    "MediaFlange.OutputX3Pin2",
    "MediaFlange.SwitchOffX3Voltage",
];

impl Setup {
    /// Creates the folder, and prepares the clearance computation.
    ///
    /// # Errors
    ///
    /// [`TwinError::File`] if the folder cannot be created.
    pub fn new(options: TwinOptions) -> Result<Self, TwinError> {
        let TwinOptions { robot, meshes, io, .. } = options;
        let arm = options.scene.map(|scene| match &meshes {
            Some(meshes) => ArmInScene::with_meshes(&robot, &scene, meshes),
            None => ArmInScene::new(&robot, &scene),
        });
        let (folder, temporary) = if let Some(folder) = options.folder {
            std::fs::create_dir_all(&folder).map_err(|error| {
                TwinError::file(format!("make the folder {}", folder.display()), error)
            })?;
            (folder, None)
        } else {
            let made = Temporary::new().map_err(|error| TwinError::file("make a folder", error))?;
            (made.folder.path().to_owned(), Some(made))
        };
        let io = if io.is_empty() { MEDIA_FLANGE.map(str::to_owned).into() } else { io };
        let positions = options.positions.or_else(|| default_file(&robot));
        Ok(Self {
            positions: positions.unwrap_or_else(|| folder.join("positions.json")),
            robot,
            names: options.names,
            meshes,
            robot_name: options.robot_name,
            arm,
            min_clearance_mm: options.min_clearance_mm,
            io,
            remote: options.remote,
            drive: options.drive,
            stream: options.stream,
            folder,
            temporary,
            wording: options.wording,
        })
    }

    /// Formats a failure for pages.
    pub(crate) fn words(&self, error: &TwinError) -> String {
        (self.wording.error)(error)
    }

    /// Connects a client to the drive.
    pub(crate) fn client(&self) -> Result<Client, TwinError> {
        Ok(Client::new(&self.remote, &self.drive)?)
    }

    /// Opens the stream of the drive, with torques.
    pub(crate) fn stream(&self) -> Result<Stream, TwinError> {
        Ok(Stream::with_torques(&self.remote, &self.stream)?)
    }

    /// Opens the connections for a run.
    pub(crate) fn connection(&self) -> Result<DriveConnection, TwinError> {
        Ok(DriveConnection::of([self.client()?, self.client()?], self.stream()?))
    }

    /// Clearances of the arm at these joint positions, in rad; empty without a scene.
    pub(crate) fn nearest(&self, joints_rad: &Joints) -> NearestPlaces {
        let Some(arm) = &self.arm else { return NearestPlaces::default() };
        let nearest = |clearance| Nearest::new(arm, &clearance, None);
        NearestPlaces {
            to_scene: arm.clearance(joints_rad).map(nearest),
            to_itself: arm.self_clearance(joints_rad).map(nearest),
        }
    }

    /// Returns true if clearances are checked.
    pub(crate) fn has_scene(&self) -> bool {
        self.arm.is_some()
    }

    /// Smallest clearances of a planned motion; empty without a scene.
    /// The arm carries the shapes of the plan's program.
    pub(crate) fn nearest_of(&self, plan: &Trajectory, carried: &CarriedBodies) -> NearestPlaces {
        let Some(arm) = &self.arm else { return NearestPlaces::default() };
        let arm = &arm.carrying(carried);
        let nearest = |it: PlannedClearance| Nearest::new(arm, &it.clearance, Some(it.at_s));
        NearestPlaces {
            to_scene: arm.clearance_of(plan).map(nearest),
            to_itself: arm.self_clearance_of(plan).map(nearest),
        }
    }

    /// Plans a program for this robot. Errors are shown on the page.
    pub(crate) fn plan(&self, program: &Program) -> Result<Trajectory, String> {
        PlanOptions::default().plan(program, &self.robot).map_err(|error| error.to_string())
    }

    /// Creates the page of a plan and its recording, for this robot.
    pub(crate) fn page(
        &self,
        plan: &Path,
        measured: Option<&Path>,
        extent: Extent,
    ) -> Result<Page, TwinError> {
        let robot = Some(self.robot.clone());
        let scene = self.arm.as_ref().map(|arm| arm.scene().clone());
        let arm = self.meshes.clone().map(|meshes| ArmSource::new(move |_| Ok(meshes.clone())));
        let interrupted = interrupt::has_come;
        let how = PageOptions { robot, arm, scene, extent, interrupted, ..PageOptions::default() };
        Ok(Page::read(plan, measured, &how)?)
    }

    /// Describes the violation if a motion with these clearances must not run. A collision is
    /// always a violation.
    pub(crate) fn too_near(&self, nearest: &NearestPlaces) -> Option<String> {
        nearest.too_near(self.min_clearance_mm)
    }

    /// Returns paths of new files in the folder that share a stem. The first file is created empty,
    /// which reserves the stem among all processes; the other files do not exist yet.
    pub(crate) fn new_files<const N: usize>(
        &self,
        stem: &str,
        endings: [&str; N],
    ) -> Result<[PathBuf; N], TwinError> {
        for number in 1.. {
            let paths = endings.map(|ending| {
                // For example `a.measured-2.mcap`.
                let (kind, extension) = ending.rsplit_once('.').unwrap_or((ending, ""));
                let number = if number == 1 { String::new() } else { format!("-{number}") };
                self.folder.join(format!("{stem}{kind}{number}.{extension}"))
            });
            if paths.iter().any(|path| path.symlink_metadata().is_ok()) {
                continue;
            }
            let Some(first) = paths.first() else { return Ok(paths) };
            match File::create_new(first) {
                Ok(_) => return Ok(paths),
                // Another process has reserved the stem.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => {
                    return Err(TwinError::file(format!("write {}", first.display()), error));
                }
            }
        }
        Err(TwinError::NoNameLeft)
    }

    /// Initial data of the page.
    pub(crate) fn for_page(&self) -> TwinSetup<'_> {
        TwinSetup {
            robot: TwinRobot::new(&self.robot, self.meshes.as_ref()),
            scene: self.arm.as_ref().map(ArmInScene::scene),
            min_clearance_mm: self.min_clearance_mm,
            drive: &self.drive,
            positions: self.positions.display().to_string(),
            folder: self.temporary.is_none().then(|| self.folder.display().to_string()),
        }
    }
}

#[cfg(test)]
impl Setup {
    /// Returns a setup for tests: files in this folder, and no drive.
    pub(crate) fn without_drive(folder: &Path) -> Self {
        let robot = Robot::lbr_iiwa_7_r800();
        let options = TwinOptions {
            robot_name: robot.name().to_owned(),
            robot,
            names: RosNames::default(),
            scene: None,
            meshes: None,
            min_clearance_mm: 0.0,
            io: Vec::new(),
            remote: Remote::open(),
            drive: "127.0.0.1:1".to_owned(),
            stream: "127.0.0.1:1".to_owned(),
            positions: Some(folder.join("positions.json")),
            folder: Some(folder.to_owned()),
            wording: Wording {
                error: |error| iiwa_report::with_causes(error),
                request: |error| error.to_string(),
                refusal: |_| "",
                unknown_position: |_| String::new(),
                address: "that the program has printed",
            },
        };
        Self::new(options).unwrap()
    }
}

/// Returns the stem of a program's files: its name without folders, and without characters that
/// file systems do not allow.
pub(crate) fn file_stem(name: &str) -> String {
    /// Maximum length, in bytes: with a number and an extension it is short enough for any file
    /// system.
    const MAX_BYTES: usize = 100;
    let stem = Path::new(name).file_stem().unwrap_or_default().to_string_lossy();
    let plain = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    let mut stem: String = stem.trim_start_matches('.').chars().map(plain).collect();
    stem.truncate(stem.floor_char_boundary(MAX_BYTES));
    if stem.is_empty() { "program".to_owned() } else { stem }
}
