//! Surfaces of triangles, as obstacles.

use std::{collections::HashMap, sync::Arc};

use crate::{
    extent::MAX_M,
    mesh_error::TriangleMeshError,
    mesh_file::{ExtentFault, mesh_points},
};

/// Surface of triangles, in its own frame.
///
/// The surface has no inside: the space within a closed surface is free, so that a cell around the
/// robot can be one mesh.
///
/// ```
/// use iiwa_scene::TriangleSurface;
///
/// let wedge = "v 0 0 0\nv 60 0 0\nv 0 40 0\nv 0 0 20\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
/// let surface = TriangleSurface::from_mesh("wedge.obj", wedge.as_bytes(), 1.0)?;
/// assert_eq!((surface.points_m().len(), surface.triangles().len()), (4, 4));
/// # Ok::<(), iiwa_scene::SurfaceError>(())
/// ```
///
/// Clones share the data.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleSurface(Arc<SurfaceData>);

#[derive(Debug, PartialEq)]
struct SurfaceData {
    points_m: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

/// Maximum number of triangles of a surface, and of all surfaces of a scene: pages draw all of
/// them, and a page of a million triangles is slow.
pub(crate) const MAX_SURFACE_TRIANGLES: usize = 200_000;

/// Largest allowed extent of a surface, in m: a hall.
const MAX_EXTENT_M: f64 = 100.0;

/// Error of triangles that are not a usable surface.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// The file is invalid, or its format is not supported.
    #[error(transparent)]
    Mesh(#[from] TriangleMeshError),
    /// The mesh is so large or so small that its unit must be wrong.
    #[error(transparent)]
    Extent(#[from] ExtentFault),
    /// A coordinate is not finite, or out of range.
    #[error("a point has a coordinate that is not a number, or farther than {} m away", MAX_M)]
    Range,
    /// A triangle has a corner that does not exist.
    #[error("triangle {} has corner {corner}, but there are {points} points", .triangle + 1)]
    Corner {
        /// Index of the triangle.
        triangle: usize,
        /// Index of the corner.
        corner: u32,
        /// Number of points.
        points: usize,
    },
    /// All triangles are so narrow that they have no area.
    #[error("it has no triangle with an area")]
    NoArea,
    /// There are too many triangles.
    #[error("it has {found} triangles; an obstacle may have {max}: make it coarser")]
    TooMany {
        /// Number of triangles.
        found: usize,
        /// Maximum number.
        max: usize,
    },
}

impl TriangleSurface {
    /// Creates a surface from points, in m, and triangles of point indices. Triangles narrower than
    /// 1 nm are left out.
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite or beyond a kilometre, if a triangle refers to a missing
    /// point, if no triangle has an area, and if there are more than 200 000.
    pub fn new(
        points_m: impl IntoIterator<Item = [f64; 3]>,
        triangles: impl IntoIterator<Item = [u32; 3]>,
    ) -> Result<Self, SurfaceError> {
        let given = points_m.into_iter().collect::<Vec<_>>();
        if given.iter().flatten().any(|value| !(-MAX_M..=MAX_M).contains(value)) {
            return Err(SurfaceError::Range);
        }
        let mut triangles = triangles.into_iter().collect::<Vec<_>>();
        let max = MAX_SURFACE_TRIANGLES;
        if triangles.len() > max {
            return Err(SurfaceError::TooMany { found: triangles.len(), max });
        }
        for (index, triangle) in triangles.iter().enumerate() {
            let missing = triangle.iter().find(|corner| **corner as usize >= given.len());
            if let Some(&corner) = missing {
                return Err(SurfaceError::Corner { triangle: index, corner, points: given.len() });
            }
        }
        triangles.retain(|triangle| !is_sliver(triangle.map(|corner| given[corner as usize])));
        if triangles.is_empty() {
            return Err(SurfaceError::NoArea);
        }
        // STL files repeat a corner for each of its triangles. Adding 0 removes the sign of zeros,
        // so that equal points have equal bits.
        let mut points_m = Vec::new();
        let mut places = HashMap::new();
        for corner in triangles.iter_mut().flatten() {
            let point = given[*corner as usize].map(|value| value + 0.0);
            *corner = *places.entry(point.map(f64::to_bits)).or_insert_with(|| {
                points_m.push(point);
                u32::try_from(points_m.len() - 1).unwrap_or(u32::MAX)
            });
        }
        Ok(Self(Arc::new(SurfaceData { points_m, triangles })))
    }

    /// Creates the surface of a mesh, in the frame of the file, from `bytes`, the contents of a
    /// file with the extension `.stl` (binary or ASCII) or `.obj`. The unit of the file is
    /// `mm_per_unit` mm: 1 for most CAD, 1000 for m.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new); if the file is invalid, or the mesh is longer than 100 m or shorter
    /// than 1 mm.
    pub fn from_mesh(name: &str, bytes: &[u8], mm_per_unit: f64) -> Result<Self, SurfaceError> {
        let (points, triangles) = mesh_points(name, bytes, mm_per_unit, MAX_EXTENT_M)??;
        Self::new(points, triangles)
    }

    /// Returns the corners, in m.
    #[must_use]
    pub fn points_m(&self) -> &[[f64; 3]] {
        &self.0.points_m
    }

    /// Returns triangles of corner indices.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.0.triangles
    }
}

/// Returns true for a triangle without an area.
fn is_sliver(corners: [[f64; 3]; 3]) -> bool {
    crate::polyhedron::Face::new(corners.map(Into::into)).is_none()
}
