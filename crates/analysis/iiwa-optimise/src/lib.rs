//! Changes that make a motion program faster, each with the time that it saves.
//!
//! [`Optimiser::advise`] tries changes of a program: another elbow angle (E1) for a group of
//! motions, other blend radii, blends in place of stops, point-to-point motions at full speed, and
//! motions that the program need not wait for. Each change is planned exactly, with all limits of a
//! plan, and kept if it saves time. Targets, speeds of TCP paths, inputs, outputs and the order of
//! motions stay as they are, and so do waits unless they are [freed](Freedom::ALL); with a blend,
//! the TCP passes its target within the radius. [`Optimiser::optimise`] makes such changes until
//! none saves more time. [`Optimiser::place`] searches for the best robot base position,
//! [`Optimiser::order`] for the best order of tasks.
//!
//! ```
//! use iiwa_kin::Robot;
//! use iiwa_optimise::{ChangeKind, Optimiser};
//! use iiwa_plan::PlanOptions;
//! use iiwa_program::Program;
//!
//! let program = Program::from_deg([0.0, 20.0, 0.0, -70.0, 0.0, 60.0, 0.0])
//!     .ptp_deg([40.0, 20.0, 0.0, -70.0, 0.0, 60.0, 0.0])
//!     .velocity(0.4)
//!     .ptp_deg([40.0, 40.0, 0.0, -50.0, 0.0, 60.0, 0.0])
//!     .build();
//! let optimiser = Optimiser::new(Robot::default(), PlanOptions::default());
//! let advice = optimiser.advise(&program)?;
//! let fastest = &advice.rows[0];
//! assert!(matches!(fastest.change.kind, ChangeKind::FullSpeed { .. }));
//!
//! // The plan of the changed program confirms the saving.
//! let changed = fastest.change.apply(&program).ok_or("no such motion")?;
//! let changed_s = optimiser.plan(&changed)?.cycle_time_s();
//! assert!((advice.cycle_time_s - changed_s - fastest.saved_s).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod blends;
mod change;
mod change_search;
mod cycle_time;
mod elbow_runs;
mod elbows;
mod freedom;
mod gap_bound;
mod ladder;
mod optimiser;
mod order;
mod part;
mod place;
mod results;
mod search_settings;
mod sequence;
mod speeds;
mod stages;
mod waits;

pub use change::{Change, ChangeKind};
pub use freedom::Freedom;
pub use optimiser::Optimiser;
pub use order::{OrderRule, OrderedTasks};
pub use place::{Place, PlaceGrid, PlaceMap, PlaceRule, TimedPlace};
pub use results::{Advice, AdviceRow, LowerBound, Optimum};
pub use sequence::SequenceTimes;
