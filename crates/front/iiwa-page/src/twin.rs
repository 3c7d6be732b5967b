//! Page that follows a robot: its markup, its style and its scripts, but not its server.

use crate::arm_look::Look;
use iiwa_kin::{Joints, Robot};
use iiwa_scene::{ArmMeshes, Scene};
use serde::Serialize;

use crate::{
    PageError,
    page::{self, PagePart},
};

/// Parts of this page only.
const PARTS: [PagePart; 11] = [
    ("/*twin.css*/", include_str!("twin/twin.css")),
    ("/*plot.js*/", include_str!("page/plot.js")),
    ("/*link.js*/", include_str!("twin/link.js")),
    ("/*reasons.js*/", include_str!("twin/reasons.js")),
    ("/*live.js*/", include_str!("twin/live.js")),
    ("/*positions.js*/", include_str!("twin/positions.js")),
    ("/*programs.js*/", include_str!("twin/programs.js")),
    ("/*torque.js*/", include_str!("twin/torque.js")),
    ("/*history.js*/", include_str!("twin/history.js")),
    ("/*stop.js*/", include_str!("twin/stop.js")),
    ("/*main.js*/", include_str!("twin/main.js")),
];

/// Initial data of a twin's page. All other data arrive over its connection.
#[derive(Clone, Debug, Serialize)]
pub struct TwinSetup<'a> {
    /// Robot data.
    pub robot: TwinRobot<'a>,
    /// Obstacles, if any.
    pub scene: Option<&'a Scene>,
    /// Minimum clearance of programs that may be sent, in mm.
    pub min_clearance_mm: f64,
    /// Address of the drive.
    pub drive: &'a str,
    /// File of saved positions.
    pub positions: String,
    /// Folder of the twin's files, if they are kept.
    pub folder: Option<String>,
}

/// Robot data of the page.
#[derive(Clone, Debug, Serialize)]
pub struct TwinRobot<'a> {
    name: &'a str,
    urdf: String,
    look: Look,
    lower_rad: Joints,
    upper_rad: Joints,
    torque_nm: Joints,
}

impl<'a> TwinRobot<'a> {
    /// Creates the robot data, with these meshes if given.
    #[must_use]
    pub fn new(robot: &'a Robot, meshes: Option<&ArmMeshes>) -> Self {
        Self {
            name: robot.name(),
            urdf: robot.to_urdf(),
            look: meshes.map_or_else(|| Look::built_in(robot), Look::of_meshes),
            lower_rad: robot.limits().lower_rad,
            upper_rad: robot.limits().upper_rad,
            torque_nm: robot.limits().torque_nm,
        }
    }
}

/// Assembles the page of a twin as HTML, with its style, its scripts and its initial data.
///
/// # Errors
///
/// [`PageError::Json`].
pub fn twin_page(setup: &TwinSetup<'_>) -> Result<String, PageError> {
    let title = format!("{} - iiwasim twin", setup.robot.name);
    page::assemble(include_str!("twin/page.html"), &PARTS, &title, setup)
}
