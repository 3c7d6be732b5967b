//! Which URDF the arm looks like.

use std::path::PathBuf;

use clap::Args;

/// A user's URDF, and where its meshes are.
#[derive(Args, Clone, Debug)]
pub(crate) struct Urdf {
    /// URDF of the arm: its meshes (STL, OBJ or Collada) in place of simple shapes, in pictures and, as convex hulls, in
    /// clearances. Its joints must be the robot's
    #[arg(long, value_name = "FILE.urdf")]
    pub(crate) urdf: Option<PathBuf>,

    /// Folder for `package://NAME/...` in that URDF: NAME is in it, or is it; may be given more than once
    #[arg(long, value_name = "FOLDER", requires = "urdf")]
    pub(crate) package_path: Vec<PathBuf>,
}
