//! Mesh files of tools: STL and OBJ.

use std::io;

use crate::{
    hull::{ConvexHull, NotSolid},
    mesh::{MAX_TRIANGLES, MeshFormat},
};

/// Largest allowed extent of a mesh, in m; the arm is 1.3 m long.
const MAX_EXTENT_M: f64 = 2.0;

/// Smallest allowed value of a mesh's largest extent, in m.
const MIN_EXTENT_M: f64 = 1e-3;

/// Error of reading a mesh of a tool.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The file extension is not supported.
    #[error("it has to be *.stl or *.obj: other formats are not read")]
    Format,
    /// The contents do not match the file extension.
    #[error("not a valid {format} file: {error}")]
    Unread {
        /// Expected format: `STL` or `OBJ`.
        format: &'static str,
        /// Fault and its place.
        error: io::Error,
    },
    /// The mesh has too many triangles.
    #[error("it has {found} triangles; it may have {max}")]
    TooMany {
        /// Number of triangles.
        found: usize,
        /// Maximum number.
        max: usize,
    },
    /// The mesh has no volume, or invalid coordinates.
    #[error(transparent)]
    NotSolid(#[from] NotSolid),
    /// The mesh is so large or so small that its unit must be wrong.
    #[error("{}", extent(*.longest_m, *.mm_per_unit))]
    Extent {
        /// Largest extent, in m.
        longest_m: f64,
        /// Assumed unit of the numbers, in mm.
        mm_per_unit: f64,
    },
}

fn extent(longest_m: f64, mm_per_unit: f64) -> String {
    let bound = if longest_m > MAX_EXTENT_M {
        format!("more than {} mm", 1e3 * MAX_EXTENT_M)
    } else {
        format!("less than {} mm", 1e3 * MIN_EXTENT_M)
    };
    // Rounded to three digits, which show by how much.
    let rounded = format!("{:.2e}", 1e3 * longest_m).parse().unwrap_or(1e3 * longest_m);
    format!(
        "it is {rounded} mm long, {bound}: a number of the file was taken for {mm_per_unit} mm; \
         \"scale\" says how many mm it is"
    )
}

impl ConvexHull {
    /// Creates the convex hull of a mesh, in the frame of the file, from `bytes`, the contents of a
    /// file with the extension `.stl` (binary or ASCII) or `.obj`. The unit of the file is
    /// `mm_per_unit` mm: 1 for most CAD, 1000 for m.
    ///
    /// ```
    /// use iiwa_scene::ConvexHull;
    ///
    /// let wedge = "v 0 0 0\nv 60 0 0\nv 0 40 0\nv 0 0 20\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    /// let hull = ConvexHull::from_mesh("wedge.obj", wedge.as_bytes(), 1.0)?;
    /// assert!(hull.corners_m().contains(&[0.06, 0.0, 0.0]));
    /// # Ok::<(), iiwa_scene::MeshError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the file is invalid, has more than two million triangles or no volume, or is longer than
    /// 2 m or shorter than 1 mm.
    pub fn from_mesh(name: &str, bytes: &[u8], mm_per_unit: f64) -> Result<Self, MeshError> {
        let Some(format @ (MeshFormat::Stl | MeshFormat::Obj)) = MeshFormat::of(name) else {
            return Err(MeshError::Format);
        };
        // Materials do not affect the shape.
        let read = format
            .read(bytes, |_| None)
            .map_err(|error| MeshError::Unread { format: format.name(), error })?;
        let found = read.meshes.iter().map(|mesh| mesh.faces.len()).sum();
        if found > MAX_TRIANGLES {
            return Err(MeshError::TooMany { found, max: MAX_TRIANGLES });
        }
        let points = read.meshes.iter().flat_map(|mesh| &mesh.vertices);
        // Division last avoids rounding: 100 mm are exactly the number 0.1 m.
        let points = points.map(|point| point.map(|v| f64::from(v) * mm_per_unit / 1e3));
        let points = points.collect::<Vec<_>>();
        if let Some(longest_m) = longest(&points)
            && !(MIN_EXTENT_M..=MAX_EXTENT_M).contains(&longest_m)
        {
            return Err(MeshError::Extent { longest_m, mm_per_unit });
        }
        Ok(Self::new(points)?)
    }
}

/// Returns the largest extent along an axis; none if a coordinate is not finite.
fn longest(points: &[[f64; 3]]) -> Option<f64> {
    let along = |axis: usize| {
        let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(low, high), point| {
            (low.min(point[axis]), high.max(point[axis]))
        });
        high - low
    };
    let is_finite = !points.is_empty() && points.iter().flatten().all(|value| value.is_finite());
    is_finite.then(|| (0..3).map(along).fold(0.0, f64::max))
}
