//! Mesh files of tools and obstacles: STL and OBJ.

use crate::{
    hull::{ConvexHull, NotSolid},
    mesh::MeshFormat,
    mesh_error::TriangleMeshError,
};

/// Largest allowed extent of a hull, in m; the arm is 1.3 m long.
const MAX_EXTENT_M: f64 = 2.0;

/// Smallest allowed value of a mesh's largest extent, in m.
const MIN_EXTENT_M: f64 = 1e-3;

/// Error of reading a mesh of a tool.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The file extension is not supported, the contents do not match the extension, or the mesh
    /// has too many triangles.
    #[error(transparent)]
    Mesh(#[from] TriangleMeshError),
    /// The mesh has no volume, or invalid coordinates.
    #[error(transparent)]
    NotSolid(#[from] NotSolid),
    /// The mesh is so large or so small that its unit must be wrong.
    #[error(transparent)]
    Extent(#[from] ExtentFault),
}

/// Extent of a mesh for which its unit must be wrong.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{}", extent(*.longest_m, *.max_m, *.mm_per_unit))]
pub struct ExtentFault {
    /// Largest extent, in m.
    pub longest_m: f64,
    /// Maximum extent, in m.
    pub max_m: f64,
    /// Assumed unit of the numbers, in mm.
    pub mm_per_unit: f64,
}

fn extent(longest_m: f64, max_m: f64, mm_per_unit: f64) -> String {
    let bound = if longest_m > max_m {
        format!("more than {} mm", 1e3 * max_m)
    } else {
        format!("less than {} mm", 1e3 * MIN_EXTENT_M)
    };
    // Rounded to three digits, which show by how much.
    let rounded = format!("{:.2e}", 1e3 * longest_m).parse().unwrap_or(1e3 * longest_m);
    format!(
        "it is {rounded} mm long, {bound}: one unit of the file was taken as {mm_per_unit} mm; \
         \"scale\" states the length of a unit in mm"
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
        let (points, _) = mesh_points(name, bytes, mm_per_unit, MAX_EXTENT_M)??;
        Ok(Self::new(points)?)
    }
}

/// Points of a mesh, in m, and triangles of point indices.
type PointsAndTriangles = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// Reads the points and triangles of a mesh in STL or OBJ whose unit is `mm_per_unit` mm, and
/// refuses a mesh longer than `max_m`.
pub(crate) fn mesh_points(
    name: &str,
    bytes: &[u8],
    mm_per_unit: f64,
    max_m: f64,
) -> Result<Result<PointsAndTriangles, ExtentFault>, TriangleMeshError> {
    let Some(format @ (MeshFormat::Stl | MeshFormat::Obj)) = MeshFormat::of(name) else {
        return Err(TriangleMeshError::NoStlOrObj);
    };
    // Materials do not affect the shape.
    let patches = format.read(bytes, |_| None)?;
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for patch in &patches {
        let first = points.len();
        let corner = |corner: u32| u32::try_from(first + corner as usize).unwrap_or(u32::MAX);
        let exist = |triangle: &&[u32; 3]| {
            triangle.iter().all(|corner| (*corner as usize) < patch.points.len())
        };
        let of_patch = patch.triangles.iter().filter(exist);
        triangles.extend(of_patch.map(|triangle| triangle.map(corner)));
        // Division last avoids rounding: 100 mm are exactly the number 0.1 m.
        points.extend(patch.points.iter().map(|point| point.map(|v| v * mm_per_unit / 1e3)));
    }
    Ok(match longest(&points) {
        Some(longest_m) if !(MIN_EXTENT_M..=max_m).contains(&longest_m) => {
            Err(ExtentFault { longest_m, max_m, mm_per_unit })
        }
        _ => Ok((points, triangles)),
    })
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
