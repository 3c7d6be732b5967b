//! Files of meshes of tools: STL and OBJ.

use std::io;

use crate::{
    hull::{ConvexHull, NotSolid},
    mesh::{MAX_TRIANGLES, MeshFormat},
};

/// Longest extent of a mesh, in m; the arm is 1.3 m long.
const MAX_EXTENT_M: f64 = 2.0;

/// Shortest that the longest extent of a mesh may be, in m.
const MIN_EXTENT_M: f64 = 1e-3;

/// Why a file is no mesh of a tool.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The name has another ending.
    #[error("it has to be *.stl or *.obj: other formats are not read")]
    Format,
    /// It cannot be read as what its name says.
    #[error("it is no {format} file: {error}")]
    Unread {
        /// What it should be: `STL` or `OBJ`.
        format: &'static str,
        /// What was found, and where.
        error: io::Error,
    },
    /// It has too many triangles.
    #[error("it has {found} triangles; it may have {max}")]
    TooMany {
        /// How many there are.
        found: usize,
        /// How many there may be.
        max: usize,
    },
    /// It has no volume, or no numbers.
    #[error(transparent)]
    NotSolid(#[from] NotSolid),
    /// It is so large or so small that its unit is another one.
    #[error("{}", extent(*.longest_m, *.mm_per_unit))]
    Extent {
        /// Its longest extent, in m.
        longest_m: f64,
        /// What its numbers were taken for, in mm.
        mm_per_unit: f64,
    },
}

fn extent(longest_m: f64, mm_per_unit: f64) -> String {
    let bound = if longest_m > MAX_EXTENT_M {
        format!("more than {} mm", 1e3 * MAX_EXTENT_M)
    } else {
        format!("less than {} mm", 1e3 * MIN_EXTENT_M)
    };
    // A few digits are enough to see by how much.
    let rounded = format!("{:.2e}", 1e3 * longest_m).parse().unwrap_or(1e3 * longest_m);
    format!(
        "it is {rounded} mm long, {bound}: a number of the file was taken for {mm_per_unit} mm; \"scale\" says how many mm \
         it is"
    )
}

impl ConvexHull {
    /// The convex hull of a mesh, in the frame of the file: of `bytes`, the contents of a file whose name ends in `.stl`
    /// (binary or ASCII) or `.obj`. A number of the file is `mm_per_unit` mm: 1 as most CAD writes it, 1000 if it is in m.
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
    /// If it is no such file, has more than two million triangles or no volume, or is longer than 2 m or shorter than 1 mm.
    pub fn from_mesh(name: &str, bytes: &[u8], mm_per_unit: f64) -> Result<Self, MeshError> {
        let Some(format @ (MeshFormat::Stl | MeshFormat::Obj)) = MeshFormat::of(name) else {
            return Err(MeshError::Format);
        };
        // Materials have no shape.
        let read = format
            .read(bytes, |_| None)
            .map_err(|error| MeshError::Unread { format: format.name(), error })?;
        let found = read.meshes.iter().map(|mesh| mesh.faces.len()).sum();
        if found > MAX_TRIANGLES {
            return Err(MeshError::TooMany { found, max: MAX_TRIANGLES });
        }
        let points = read.meshes.iter().flat_map(|mesh| &mesh.vertices);
        // Divided last: 100 mm are 0.1 m and not 0.1 and a bit.
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

/// The longest extent along an axis; none if a number is none.
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
