//! URDF that gives the arm its shape.

use std::path::PathBuf;

use clap::Args;

/// URDF of the user, and the folders of its meshes.
#[derive(Args, Clone, Debug)]
pub(crate) struct Urdf {
    /// URDF whose meshes (STL, OBJ or Collada) replace the simple shapes of the arm on the page
    /// and, as convex hulls, in clearances. Its joints must match the robot's
    #[arg(long, value_name = "FILE.urdf")]
    pub(crate) urdf: Option<PathBuf>,

    /// Folder for `package://NAME/...` in that URDF: NAME itself or its parent; may be given more
    /// than once
    #[arg(long, value_name = "FOLDER", requires = "urdf")]
    pub(crate) package_path: Vec<PathBuf>,
}
