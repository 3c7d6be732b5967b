//! Exports a motion program as a Sunrise project.

mod awaited_motions;
mod cell;
mod class;
mod error;
mod expression;
mod identifier;
mod imports;
mod literal;
mod loads;
mod loops;
mod signals;
mod tools;

use std::collections::BTreeSet;

use iiwa_kin::{Joints, Mount, Robot};
use iiwa_program::{IoEntry, IoKind, Motion, MotionIndex, OperatingMode, Program};

use crate::data_file::ProcessData;

use self::{
    cell::WorldTree,
    class::{ClassHeading, ExportedClass},
    identifier::{check_class, class_of},
    tools::ExportedTools,
};

pub use error::{ExportError, ExportNotice};

/// Options of an export.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ExportOptions {
    /// Name of the program; the class name is derived from it.
    pub name: String,
    /// Class name, if it differs from the derived one.
    pub class: Option<String>,
}

/// Motion program as a Sunrise project: an application with its frames and tools.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_program::Program;
/// use iiwa_sunrise::{ExportOptions, ExportedProject};
///
/// let program = Program::from_deg([0.0; 7])
///     .ptp_deg([0.0, 30.0, 0.0, -60.0, 0.0, 90.0, 0.0])
///     .build();
/// let options = ExportOptions { name: "go home".to_owned(), ..ExportOptions::default() };
/// let project = ExportedProject::new(&program, &Robot::default(), &options)?;
/// assert_eq!(project.java_file(), "src/application/GoHome.java");
/// assert!(project.java.contains("lbr.move(ptp(0.0, Math.toRadians(30.0), "));
/// # Ok::<(), iiwa_sunrise::ExportError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ExportedProject {
    /// Class name of the application.
    pub class: String,
    /// Java source of the class.
    pub java: String,
    /// Frames and tool templates, in XML.
    pub data_file: String,
    /// Joint positions before the first motion, in rad.
    pub start_rad: Joints,
    /// Joint positions before the first motion in degrees, which convert to the same bits where
    /// possible.
    pub start_deg: Joints,
    /// Differences between the Java code and the program.
    pub notices: Vec<ExportNotice>,
}

impl ExportedProject {
    /// Path of [`data_file`](Self::data_file) in the project.
    pub const DATA_FILE: &str = "RoboticsAPI.data.xml";

    /// Id of the process data with the program's robot.
    pub const ROBOT_ID: &str = "iiwasim_robot";

    /// Id of the process data with the flange length in mm.
    pub const FLANGE_ID: &str = "iiwasim_flange_mm";

    /// Id of the process data with the joint positions before the first motion: seven numbers, in
    /// rad.
    pub const START_ID: &str = "iiwasim_start_rad";

    /// Exports a program. All motions keep their targets and limits bit for bit.
    ///
    /// # Errors
    ///
    /// [`ExportError`] if the program has a fault, or uses features without an equivalent call in
    /// Sunrise; the error names all such motions, each with the first such key.
    pub fn new(
        program: &Program,
        robot: &Robot,
        options: &ExportOptions,
    ) -> Result<Self, ExportError> {
        program.check_numbers()?;
        if let Some(class) = &options.class {
            check_class(class)?;
        }
        let class = options.class.clone().unwrap_or_else(|| class_of(&options.name));
        let start_rad = program.start_rad(robot)?;
        let workcell = &program.workcell;
        let mut tree = WorldTree::new(workcell, device(robot))
            .map_err(|fault| ExportError::Name { motion: None, key: "frames", fault })?;
        let mut notices = of_the_program(program);
        let mut tools = ExportedTools::new(program);
        let start_deg = start_rad.map(literal::degrees);
        let heading = ClassHeading { class: &class, program: &options.name, start_deg: &start_deg };
        let java = ExportedClass::new(program, &mut tree, &mut tools, &mut notices)?.text(&heading);
        let start = start_rad.map(literal::number).join(" ");
        let named = program.robot.clone().unwrap_or_else(|| robot.name().to_owned());
        let flange = literal::number(1e3 * robot.lengths().flange_m);
        let setting = |id: &str, value: String| ProcessData {
            id: id.to_owned(),
            data_type: "java.lang.String".to_owned(),
            default_value: Some(value.clone()),
            value: Some(value),
            ..ProcessData::default()
        };
        let mut file = tree.finish(tools.templates());
        file.process_data = vec![
            setting(Self::ROBOT_ID, named),
            setting(Self::FLANGE_ID, flange),
            setting(Self::START_ID, start),
        ];
        let data_file = file.to_xml();
        Ok(Self { class, java, data_file, start_rad, start_deg, notices })
    }

    /// Returns the path of [`java`](Self::java) in the project.
    #[must_use]
    pub fn java_file(&self) -> String {
        format!("src/application/{}.java", self.class)
    }
}

/// Returns the usual device name of the robot in Sunrise stations.
fn device(robot: &Robot) -> String {
    let is_14 = robot.lengths().upper_arm_m == Robot::lbr_iiwa_14_r820().lengths().upper_arm_m;
    if is_14 { "LBR_iiwa_14_R820_1" } else { "LBR_iiwa_7_R800_1" }.to_owned()
}

/// Notice on the shapes of a load.
const SHAPES: &str = "Sunrise loads have no shapes: they are left out";

/// Reports the settings of the whole program that the Java code does not contain.
fn of_the_program(program: &Program) -> Vec<ExportNotice> {
    let workcell = &program.workcell;
    let mut notices = Vec::new();
    let mut note = |motion: Option<MotionIndex>, key: &'static str, message: &str| {
        notices.push(ExportNotice { motion, key, message: message.to_owned() });
    };
    if workcell.mode == OperatingMode::T1 {
        note(None, "mode", "the key switch of the smartPAD chooses T1");
    }
    if workcell.mount != Mount::default() {
        note(None, "mount", "the configuration of the station states the mounting of the robot");
    }
    if workcell.torque_limit_rel.is_some() {
        note(
            None,
            "limit_torque_percent",
            "no public source says whether Sunrise limits torques: motions may be faster than \
             planned",
        );
    }
    if workcell.speed_override.is_some() {
        note(None, "override_percent", "the override is set on the smartPAD");
    }
    let stops = |motion: &Motion| match motion {
        Motion::Ptp(ptp) => ptp.blend.is_none() && !ptp.blocking,
        Motion::Cartesian(cartesian) => cartesian.blend.is_none() && !cartesian.blocking,
        Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => false,
    };
    if program.entries().filter(|(_, motion)| stops(motion)).count() > 1 {
        let message = "`move` waits for the end of a motion: the standstill after it is longer \
            than after a motion that is not `blocking`";
        note(None, "blocking", message);
    }
    if let Some(last) = program.blend_at_the_end() {
        note(Some(last), "blend", "nothing follows that it could blend into: the arm stops");
    }
    for (name, tool) in &workcell.tools {
        if tool.load.as_ref().is_some_and(|load| !load.shapes.is_empty()) {
            note(None, "shapes", &format!("{SHAPES} (tool `{name}`)"));
        }
    }
    let mut outputs = BTreeSet::new();
    for (motion, entry) in program.entries() {
        match entry {
            Motion::Load(Some(load)) => {
                if load.load.mass_kg <= 0.0 {
                    let message = "Sunrise treats a load without mass as not determined";
                    note(Some(motion), "load", message);
                }
                if !load.shapes.is_empty() {
                    note(Some(motion), "shapes", SHAPES);
                }
            }
            Motion::Io(IoEntry { kind: IoKind::Set, io, .. }) => {
                outputs.insert(io);
            }
            Motion::Io(IoEntry { io, .. }) if outputs.contains(io) => {
                let message = format!(
                    "the program sets `{io}` before it waits for this signal: an import of the \
                     project knows the value, and may reject the loop as endless"
                );
                note(Some(motion), "io", &message);
            }
            _ => {}
        }
    }
    notices
}
