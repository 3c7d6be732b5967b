//! Source of arm meshes.

use std::{fmt, sync::Arc};

use iiwa_kin::Robot;
use iiwa_scene::{ArmMeshError, ArmMeshes};

/// Meshes of a user in place of the built-in shells, for a robot that is known only after reading a
/// file.
#[derive(Clone)]
pub struct ArmSource(Arc<Read>);

type Read = dyn Fn(&Robot) -> Result<ArmMeshes, ArmMeshError> + Send + Sync;

impl ArmSource {
    /// Creates a source that calls `read` for a robot.
    pub fn new(
        read: impl Fn(&Robot) -> Result<ArmMeshes, ArmMeshError> + Send + Sync + 'static,
    ) -> Self {
        Self(Arc::new(read))
    }

    /// Returns the meshes of a robot.
    ///
    /// # Errors
    ///
    /// Errors of the function that reads the meshes.
    pub fn of(&self, robot: &Robot) -> Result<ArmMeshes, ArmMeshError> {
        (self.0)(robot)
    }
}

impl fmt::Debug for ArmSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ArmSource").finish_non_exhaustive()
    }
}
