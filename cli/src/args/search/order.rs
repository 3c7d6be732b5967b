//! `iiwasim order`.

use clap::Args;

use super::{SceneOptions, SearchInput, SearchOutput};

/// Find the order of tasks in which a program is fastest.
///
/// A program lists its tasks by the key `tasks`: groups of motions that may be executed in another
/// order, each with the tasks that have to be executed before it (`after`). They follow each other,
/// and each begins with a point-to-point motion to joints, or to a frame with E1 and status. Paths
/// within tasks stay as they are, except in blends between tasks. The last task stays the last one
/// unless such a point-to-point motion follows it directly. A task has to set the outputs that it
/// relies on.
///
/// The time of each task after each other one is planned. Up to 16 tasks, all orders are then
/// compared; with more tasks, the order is improved step by step, and a faster one may exist. The
/// fastest order is planned exactly, and again from its text before it is written.
///
/// Orders are checked for collisions only with --scene.
#[derive(Args, Debug)]
pub(crate) struct OrderTasks {
    #[command(flatten)]
    pub(crate) input: SearchInput,

    #[command(flatten)]
    pub(crate) around: SceneOptions,

    #[command(flatten)]
    pub(crate) found: SearchOutput,
}
