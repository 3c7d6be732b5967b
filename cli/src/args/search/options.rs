//! Options of a search for changes that make a program faster.

use std::path::PathBuf;

use clap::Args;

use crate::args::{Answering, Timing, values::at_least_0};

/// Program that a search plans, and how.
#[derive(Args, Debug)]
pub(crate) struct SearchInput {
    /// Motion program in JSON, `-` for standard input, or the folder of a Sunrise project
    #[arg(value_name = "PROGRAM|PROJECT")]
    pub(crate) program: PathBuf,

    /// Timing method, as for `iiwasim plan`
    #[arg(long, value_enum, default_value_t = Timing::Sunrise)]
    pub(crate) timing: Timing,

    /// Built-in model or robot profile, instead of the program's
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    #[command(flatten)]
    pub(crate) answering: Box<Answering>,
}

/// Program, limits of the changes, and the scene that is checked for collisions.
#[derive(Args, Debug)]
pub(crate) struct SearchOptions {
    #[command(flatten)]
    pub(crate) input: SearchInput,

    /// Largest blend radius to try, in mm
    #[arg(long, value_name = "MM", default_value_t = 50.0, value_parser = at_least_0)]
    pub(crate) max_blend_mm: f64,

    #[command(flatten)]
    pub(crate) around: SceneOptions,
}

/// Output of a search that need not write the program that it finds.
#[derive(Args, Debug)]
pub(crate) struct SearchOutput {
    /// Path of the fastest program, in JSON
    #[arg(short, long, value_name = "FILE.json")]
    pub(crate) output: Option<PathBuf>,

    /// Replace an existing program, which may have been edited by hand
    #[arg(long, requires = "output")]
    pub(crate) overwrite: bool,

    /// Print a JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// Scene in which changes are checked for collisions.
#[derive(Args, Debug)]
pub(crate) struct SceneOptions {
    /// Scene with obstacles in JSON (`iiwasim schema scene`)
    #[arg(long, value_name = "SCENE.json", env = "IIWASIM_SCENE", hide_env = true)]
    pub(crate) scene: Option<PathBuf>,

    /// Smallest allowed distance of the arm to obstacles of --scene and to itself, in mm; for a
    /// motion that has less in the unchanged program, that distance
    #[arg(long, value_name = "MM", default_value_t = 10.0, value_parser = at_least_0)]
    pub(crate) min_clearance: f64,
}
