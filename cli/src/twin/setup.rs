//! What a twin is started with.

use std::{
    env,
    fs::File,
    io::{self, ErrorKind},
    path::{Path, PathBuf},
};

use iiwa_kin::{Joints, Robot, RosNames};
use iiwa_link::{Client, Remote, Stream};
use iiwa_log::PlanOptions;
use iiwa_program::Program;
use iiwa_scene::{ArmInScene, ArmMeshes, PlannedClearance};
use iiwa_traj::Trajectory;
use iiwa_view::{
    ArmSource, Extent, Nearest, NearestPlaces, Page, PageOptions, TwinRobot, TwinSetup,
};
use tempfile::TempDir;

use crate::{
    args, arm_files::ArmFiles, connection, failure::Failure, input, leftovers::Name, output,
    runner::DriveConnection,
};

use super::positions::default_file;

/// The robot, its obstacles, and the connection to its drive.
pub(crate) struct Setup {
    pub(crate) robot: Robot,
    /// Of its joints and links, in files and for viewers.
    pub(crate) names: RosNames,
    /// The robot's name, or its profile's.
    pub(super) robot_name: String,
    arm: Option<ArmInScene>,
    /// What the arm looks like, if not as we draw it.
    meshes: Option<ArmMeshes>,
    pub(super) min_clearance_mm: f64,
    pub(super) io: Vec<String>,
    remote: Remote,
    drive: String,
    stream: String,
    /// The file of saved positions.
    pub(super) positions: PathBuf,
    folder: PathBuf,
    /// Removed at the end, unless a folder was given.
    temporary: Option<Temporary>,
}

/// A folder that is removed at the end.
struct Temporary {
    folder: TempDir,
    /// While it is open, no other twin removes the folder as a leftover.
    _lock: Option<File>,
}

impl Temporary {
    fn new() -> io::Result<Self> {
        let name = Name { prefix: "iiwasim-twin-", suffix: "", is_folder: true };
        let make = |name: &mut tempfile::Builder<'_, '_>| name.tempdir();
        let (folder, lock) = name.make(&env::temp_dir(), make, TempDir::path)?;
        Ok(Self { folder, _lock: lock })
    }
}

/// Inputs and outputs of the media flange, as the simulated cabinet has them.
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
    /// Reads the files that the options name.
    pub(crate) fn new(options: &args::Twin) -> Result<Self, Failure> {
        let robot = input::find_robot(&options.robot)?;
        let scene = options.scene.as_deref().map(input::scene).transpose()?;
        let files = ArmFiles::new(&options.arm)?;
        let meshes = files.map(|files| files.meshes(&robot)).transpose()?;
        let arm = scene.map(|scene| match &meshes {
            Some(meshes) => ArmInScene::with_meshes(&robot, &scene, meshes),
            None => ArmInScene::new(&robot, &scene),
        });
        let (folder, temporary) = if let Some(folder) = &options.output {
            std::fs::create_dir_all(folder).map_err(|error| {
                Failure::run(format!("cannot make the folder {}", folder.display()), &error)
            })?;
            (folder.clone(), None)
        } else {
            let made =
                Temporary::new().map_err(|error| Failure::run("cannot make a folder", &error))?;
            (made.folder.path().to_owned(), Some(made))
        };
        let io = match options.io.as_slice() {
            [] => MEDIA_FLANGE.map(str::to_owned).into(),
            named => named.to_vec(),
        };
        let positions = options.positions.clone().or_else(|| default_file(&robot));
        Ok(Self {
            positions: positions.unwrap_or_else(|| folder.join("positions.json")),
            robot,
            names: options.ros.names(),
            meshes,
            robot_name: options.robot.clone(),
            arm,
            min_clearance_mm: options.min_clearance,
            io,
            remote: connection::remote(&options.drive.keys)?,
            drive: options.drive.drive.to_string(),
            stream: options.stream.to_string(),
            folder,
            temporary,
        })
    }

    /// A client of the drive.
    pub(super) fn client(&self) -> Result<Client, Failure> {
        Client::new(&self.remote, &self.drive).map_err(|error| connection::refused(&error))
    }

    /// The stream of the drive.
    pub(crate) fn stream(&self) -> Result<Stream, Failure> {
        Stream::new(&self.remote, &self.stream).map_err(|error| connection::refused(&error))
    }

    /// The connections for a run.
    pub(super) fn connection(&self) -> Result<DriveConnection, Failure> {
        let stream = Stream::with_torques(&self.remote, &self.stream)
            .map_err(|error| connection::refused(&error))?;
        Ok(DriveConnection::of([self.client()?, self.client()?], stream))
    }

    /// Clearances of the arm at these joint positions, in rad; none without a scene.
    pub(super) fn nearest(&self, joints_rad: &Joints) -> NearestPlaces {
        let Some(arm) = &self.arm else { return NearestPlaces::default() };
        let nearest = |clearance| Nearest::new(arm, &clearance, None);
        NearestPlaces {
            to_scene: arm.clearance(joints_rad).map(nearest),
            to_itself: arm.self_clearance(joints_rad).map(nearest),
        }
    }

    /// Least clearances of a planned motion; none without a scene.
    pub(super) fn nearest_of(&self, plan: &Trajectory) -> NearestPlaces {
        let Some(arm) = &self.arm else { return NearestPlaces::default() };
        let nearest = |it: PlannedClearance| Nearest::new(arm, &it.clearance, Some(it.at_s));
        NearestPlaces {
            to_scene: arm.clearance_of(plan).map(nearest),
            to_itself: arm.self_clearance_of(plan).map(nearest),
        }
    }

    /// Plans a program for this robot. Errors are shown on the page.
    pub(super) fn plan(&self, program: &Program) -> Result<Trajectory, String> {
        PlanOptions::default().plan(program, &self.robot).map_err(|error| error.to_string())
    }

    /// The page of a plan and of its recording, for this robot.
    pub(super) fn page(
        &self,
        plan: &Path,
        measured: Option<&Path>,
        extent: Extent,
    ) -> Result<Page, Failure> {
        let robot = Some(self.robot.clone());
        let scene = self.arm.as_ref().map(|arm| arm.scene().clone());
        let arm = self.meshes.clone().map(|meshes| ArmSource::new(move |_| Ok(meshes.clone())));
        let how = PageOptions { robot, arm, scene, extent, interrupted: output::interrupted };
        Ok(Page::read(plan, measured, &how)?)
    }

    /// Why a motion with these clearances is not run, if so. A collision is always a reason.
    pub(super) fn too_near(&self, nearest: &NearestPlaces) -> Option<String> {
        nearest.too_near(self.min_clearance_mm)
    }

    /// Paths of new files in the folder that share a stem. The first one is created empty, which reserves the
    /// stem among all processes; none of the others exists.
    pub(super) fn new_files<const N: usize>(
        &self,
        stem: &str,
        endings: [&str; N],
    ) -> Result<[PathBuf; N], Failure> {
        for number in 1.. {
            let paths = endings.map(|ending| {
                // As in `a.measured-2.mcap`.
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
                // Another process has taken it.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => {
                    return Err(Failure::run(format!("cannot write {}", first.display()), &error));
                }
            }
        }
        Err(Failure::Run { what: "there is no file name left".to_owned(), cause: None })
    }

    /// What the page contains from the start.
    pub(super) fn for_page(&self) -> TwinSetup<'_> {
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

/// Stem of a program's files: its name without folders, and without characters that file systems do not allow.
pub(super) fn file_stem(name: &str) -> String {
    /// In bytes: with a number and an extension it is short enough for any file system.
    const MAX_BYTES: usize = 100;
    let stem = Path::new(name).file_stem().unwrap_or_default().to_string_lossy();
    let plain = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    let mut stem: String = stem.trim_start_matches('.').chars().map(plain).collect();
    stem.truncate(stem.floor_char_boundary(MAX_BYTES));
    if stem.is_empty() { "program".to_owned() } else { stem }
}
