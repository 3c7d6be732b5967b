//! Where the meshes of the arm come from.

use std::{fmt, sync::Arc};

use iiwa_kin::Robot;
use iiwa_scene::{ArmMeshError, ArmMeshes};

/// Meshes of a user in place of our shells: for a robot that is known once a file is read.
#[derive(Clone)]
pub struct ArmSource(Arc<Read>);

type Read = dyn Fn(&Robot) -> Result<ArmMeshes, ArmMeshError> + Send + Sync;

impl ArmSource {
    /// What `read` gives for a robot.
    pub fn new(
        read: impl Fn(&Robot) -> Result<ArmMeshes, ArmMeshError> + Send + Sync + 'static,
    ) -> Self {
        Self(Arc::new(read))
    }

    /// The meshes of a robot.
    ///
    /// # Errors
    ///
    /// Those of what reads them.
    pub fn of(&self, robot: &Robot) -> Result<ArmMeshes, ArmMeshError> {
        (self.0)(robot)
    }
}

impl fmt::Debug for ArmSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ArmSource").finish_non_exhaustive()
    }
}
