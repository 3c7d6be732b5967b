//! KUKA Sunrise projects: reads the frames and tool templates of a `RoboticsAPI.data.xml` as tools,
//! bases and frames of motion programs, imports applications, and exports programs.
//!
//! ```
//! use iiwa_kin::Robot;
//! use iiwa_sunrise::{DataFile, ImportedCell};
//!
//! let file = DataFile::from_xml(r#"<RoboticsAPIData version="3"><world>
//!     <frame name="Bench">
//!         <transformation x="400" y="-200" z="50" a="0" b="0" c="0"/>
//!         <frame name="Pick">
//!             <transformation x="100" y="150" z="250" a="0" b="3.141592653589793" c="0"/>
//!         </frame>
//!     </frame>
//! </world></RoboticsAPIData>"#)?;
//! let cell = ImportedCell::new(&file);
//! assert_eq!(cell.workcell.frames["Bench/Pick"].base.as_deref(), Some("Bench"));
//! println!("{}", cell.workcell.to_json());
//! for frame in &cell.frames {
//!     println!("{}: {}", frame.name, frame.check(&Robot::default()).verdict);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`DataFile`] holds the content of the file; [`ImportedCell`] the tools, bases and frames for
//! programs, with their names.
//!
//! [`import`] evaluates an [`Application`] of a [`Project`] without a robot, and records its
//! motions as a program with the source line of each motion.
//!
//! [`ExportedProject`] is the reverse: it writes a motion program as a Java application with its
//! frames and tools.

mod answers;
mod application;
mod cell;
mod check;
mod data_file;
mod element;
mod error;
mod export;
mod label_comment;
mod names;
mod project;
mod project_folder;
mod question;
mod read;
mod robot_statement;
mod write;

pub use answers::{AnswerValue, Answers, AnswersError};
pub use application::{
    Application, Import, ImportError, ImportNote, ImportOptions, Missing, RefusedImport,
    Unanswered, import,
};
pub use cell::{ImportedCell, ImportedFrame, ImportedTool, TcpChange};
pub use check::{FrameCheck, Verdict};
pub use data_file::{
    DataFile, NotTaken, ProcessData, TaughtRedundancy, Teaching, ToolFrame, ToolTemplate,
    WorldFrame,
};
pub use error::DataFileError;
pub use export::{ExportError, ExportNotice, ExportOptions, ExportedProject};
pub use iiwa_java::{SourceError, SourceFault};
pub use names::Renamed;
pub use project::{Project, ProjectData, ProjectError, SourceFile, StationFault};
pub use question::{Question, QuestionKind};
pub use robot_statement::{
    OTHER_FLANGE_M, RobotStatement, Stated, StatedBy, StatedModel, TOUCH_FLANGE_M,
};
