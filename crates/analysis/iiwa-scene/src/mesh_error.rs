//! Errors of reading mesh files.

use std::io;

use crate::{collada::ColladaError, patch::MAX_TRIANGLES};

/// Error of reading a mesh file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TriangleMeshError {
    /// The file extension is not supported.
    #[error("meshes are read from *.stl, *.obj and *.dae")]
    Format,
    /// The file extension is not supported for tools and obstacles.
    #[error("it has to be *.stl or *.obj: other formats are not read")]
    NoStlOrObj,
    /// The contents do not match the file extension.
    #[error("not a valid {format} file: {error}")]
    Unread {
        /// Expected format: `STL` or `OBJ`.
        format: &'static str,
        /// Fault and its place.
        error: io::Error,
    },
    /// A Collada file is invalid, or has contents that cannot be applied.
    #[error("it cannot be read as Collada: {0}")]
    Collada(#[from] ColladaError),
    /// The mesh has no triangles.
    #[error("it has no triangles")]
    Empty,
    /// The mesh has too many triangles.
    #[error("it has {found} triangles; it may have {max}")]
    TooMany {
        /// Number of triangles.
        found: usize,
        /// Maximum number.
        max: usize,
    },
    /// A coordinate is not finite.
    #[error("a corner has a coordinate that is not a number")]
    NotFinite,
}

impl TriangleMeshError {
    /// Error for contents that do not match the format.
    pub(crate) fn unread(format: &'static str, message: impl Into<String>) -> Self {
        let error = io::Error::new(io::ErrorKind::InvalidData, message.into());
        Self::Unread { format, error }
    }

    /// Refuses more triangles than a mesh may have.
    pub(crate) fn check_count(found: usize) -> Result<(), Self> {
        if found > MAX_TRIANGLES {
            return Err(Self::TooMany { found, max: MAX_TRIANGLES });
        }
        Ok(())
    }
}
