//! From a motion program to a Sunrise project.

mod awaited_motions;
mod cell;
mod class;
mod error;
mod expression;
mod identifier;
mod imports;
mod literal;
mod loads;
mod tools;

use iiwa_kin::{Joints, Mount, Robot};
use iiwa_program::{Motion, MotionIndex, OperatingMode, Program};

use crate::data_file::ProcessData;

use self::{
    cell::WorldTree,
    class::{ClassHeading, ExportedClass},
    identifier::{check_class, class_of},
    tools::ExportedTools,
};

pub use error::{ExportError, ExportNotice};

/// How a program is exported.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ExportOptions {
    /// What the program is called; the class is named after it.
    pub name: String,
    /// The name of the class, if it is to have another.
    pub class: Option<String>,
}

/// A motion program as a Sunrise project: an application, and its frames and tools.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_program::Program;
/// use iiwa_sunrise::{ExportOptions, ExportedProject};
///
/// let program = Program::from_deg([0.0; 7]).ptp_deg([0.0, 30.0, 0.0, -60.0, 0.0, 90.0, 0.0]).build();
/// let options = ExportOptions { name: "go home".to_owned(), ..ExportOptions::default() };
/// let project = ExportedProject::new(&program, &Robot::default(), &options)?;
/// assert_eq!(project.java_file(), "src/application/GoHome.java");
/// assert!(project.java.contains("lbr.move(ptp(0.0, Math.toRadians(30.0), "));
/// # Ok::<(), iiwa_sunrise::ExportError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ExportedProject {
    /// The name of the application's class.
    pub class: String,
    /// The class, in Java.
    pub java: String,
    /// The frames and the templates of tools, in XML.
    pub data_file: String,
    /// Where the joints are before the first motion, in rad.
    pub start_rad: Joints,
    /// The same in degrees, which are converted to the same bits where some are.
    pub start_deg: Joints,
    /// What Java says otherwise than the program, or not at all.
    pub notices: Vec<ExportNotice>,
}

impl ExportedProject {
    /// The path of [`data_file`](Self::data_file) in the project.
    pub const DATA_FILE: &str = "RoboticsAPI.data.xml";

    /// The process data that names the program's robot.
    pub const ROBOT_ID: &str = "iiwasim_robot";

    /// The process data with the length of the robot's flange, in mm.
    pub const FLANGE_ID: &str = "iiwasim_flange_mm";

    /// The process data with the joints before the first motion: seven numbers, in rad.
    pub const START_ID: &str = "iiwasim_start_rad";

    /// Exports a program. All of its motions are as they were: targets and limits to the last bit.
    ///
    /// # Errors
    ///
    /// [`ExportError`] if the program has a fault, or asks for what Sunrise has no call for; it names the motion and the key.
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

    /// The path of [`java`](Self::java) in the project.
    #[must_use]
    pub fn java_file(&self) -> String {
        format!("src/application/{}.java", self.class)
    }
}

/// The robot as stations of Sunrise usually call it.
fn device(robot: &Robot) -> String {
    let is_14 = robot.lengths().upper_arm_m == Robot::lbr_iiwa_14_r820().lengths().upper_arm_m;
    if is_14 { "LBR_iiwa_14_R820_1" } else { "LBR_iiwa_7_R800_1" }.to_owned()
}

/// What of the program as a whole Java does not say.
fn of_the_program(program: &Program) -> Vec<ExportNotice> {
    let workcell = &program.workcell;
    let mut notices = Vec::new();
    let mut note = |motion: Option<MotionIndex>, key: &'static str, what: &str| {
        notices.push(ExportNotice { motion, key, what: what.to_owned() });
    };
    if workcell.mode == OperatingMode::T1 {
        note(None, "mode", "the key switch of the smartPAD chooses T1");
    }
    if workcell.mount != Mount::default() {
        note(None, "mount", "the configuration of the station says how the robot stands");
    }
    if workcell.torque_limit_rel.is_some() {
        note(None, "torque_limit_percent", "Sunrise plans by its own model of torques");
    }
    if workcell.speed_override.is_some() {
        note(None, "override_percent", "the override is set on the smartPAD");
    }
    let stops = |motion: &Motion| match motion {
        Motion::Ptp(ptp) => ptp.blend.is_none() && !ptp.blocking,
        Motion::Cartesian(own) => own.blend.is_none() && !own.blocking,
        Motion::Wait { .. } | Motion::Load(_) => false,
    };
    if program.entries().filter(|(_, motion)| stops(motion)).count() > 1 {
        let what = "`move` waits for the end of a motion: the pause after it is longer than after one that is not \
                    `blocking`";
        note(None, "blocking", what);
    }
    if let Some(last) = program.blend_at_the_end() {
        note(Some(last), "blend", "nothing follows that it could blend into: the arm stops");
    }
    for (motion, entry) in program.entries() {
        if let Motion::Load(Some(load)) = entry
            && load.mass_kg <= 0.0
        {
            note(
                Some(motion),
                "load",
                "Sunrise takes a load without mass for one that was not determined",
            );
        }
    }
    notices
}
