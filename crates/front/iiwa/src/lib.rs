//! KUKA LBR iiwa in Rust: the path of the arm through a program, and its cycle time.
//!
//! One dependency for planning, files, reports, web pages, the link and the bridge. Each library is
//! a module here, most behind a feature with the same name.
//!
//! ```
//! use iiwa::prelude::*;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let text = r#"{ "version": 1, "start": { "joints_deg": [-20, 0, 0, 0, 0, 0, 0] },
//! #     "motions": [{ "type": "ptp", "joints_deg": [20, 0, 0, 0, 0, 0, 0] }] }"#;
//! let trajectory = PlanRequest::default().plan(&ProgramSource::from_json(text)?)?.trajectory;
//!
//! println!("{:.3} s", trajectory.cycle_time_s());
//! assert!((trajectory.cycle_time_s() - 0.798).abs() < 1e-3);
//! # Ok(())
//! # }
//! ```
//!
//! | feature | modules | for |
//! |---|---|---|
//! | none | [`kin`] | robot models, forward kinematics, Jacobian |
//! | `profile`, `urdf` (default) | in [`kin`] | robot profiles in JSON; robots as URDF |
//! | `plan` (default) | `json`, `program`, `path`, `solver`, `traj`, `plan` | motion programs, paths, time-optimal trajectories |
//! | `scene` | `scene` | obstacles and clearances |
//! | `sunrise` | `sunrise` | Sunrise projects: frames and tools, applications as programs, programs as projects |
//! | `log` | `log` | trajectories and recordings as MCAP files, trajectories also as CSV tables, recordings from other formats |
//! | `parquet` | in `log` | trajectories as Parquet tables, recordings from Parquet |
//! | `eval` | `eval` | plans compared with recordings, robots identified from recordings |
//! | `experiments` | in `eval`, `report` | experiments that identify a robot, a virtual robot, reports |
//! | `optimise` | `optimise`, in `report` and `page` | searches for faster programs, reports and pages of them |
//! | `fri` | `fri` | KUKA's Fast Robot Interface |
//! | `link` | `link` | the client of a drive |
//! | `drive` | `drive` | the drive |
//! | `cabinet` | `cabinet` | a simulated controller for the drive |
//! | `report` | `report` | tables, reports and pictures as text |
//! | `page` | `page` | HTML pages |
//! | `foxglove` | `foxglove` | live robot state in Foxglove and Lichtblick |
//! | `bridge` | `bridge` | robot state to Kafka and MQTT, and requests back |
//! | `full` | all | |
//!
//! Units are SI and radians unless a name states another unit.

#[cfg(feature = "bridge")]
pub use iiwa_bridge as bridge;
#[cfg(feature = "cabinet")]
pub use iiwa_cabinet as cabinet;
#[cfg(feature = "drive")]
pub use iiwa_drive as drive;
#[cfg(feature = "eval")]
pub use iiwa_eval as eval;
#[cfg(feature = "foxglove")]
pub use iiwa_foxglove as foxglove;
#[cfg(feature = "fri")]
pub use iiwa_fri as fri;
#[cfg(feature = "plan")]
pub use iiwa_json as json;
pub use iiwa_kin as kin;
#[cfg(feature = "link")]
pub use iiwa_link as link;
#[cfg(feature = "log")]
pub use iiwa_log as log;
#[cfg(feature = "optimise")]
pub use iiwa_optimise as optimise;
#[cfg(feature = "page")]
pub use iiwa_page as page;
#[cfg(feature = "plan")]
pub use iiwa_path as path;
#[cfg(feature = "plan")]
pub use iiwa_plan as plan;
#[cfg(feature = "plan")]
pub use iiwa_program as program;
#[cfg(feature = "report")]
pub use iiwa_report as report;
#[cfg(feature = "scene")]
pub use iiwa_scene as scene;
#[cfg(feature = "plan")]
pub use iiwa_solver as solver;
#[cfg(feature = "sunrise")]
pub use iiwa_sunrise as sunrise;
#[cfg(feature = "plan")]
pub use iiwa_traj as traj;

pub mod prelude;

/// Compiles the Rust code of the README.
#[cfg(all(doctest, feature = "plan"))]
#[doc = include_str!("../../../../README.md")]
pub struct Readme;

/// Compiles the Rust code of the library guide.
#[cfg(all(doctest, feature = "plan"))]
#[doc = include_str!("../../../../docs/guide/library.md")]
pub struct Guide;
