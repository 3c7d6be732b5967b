//! Parts of a mesh.

/// Maximum number of triangles of a mesh: CAD of a tool or of an arm, but not a scan of a hall.
pub(crate) const MAX_TRIANGLES: usize = 2_000_000;

/// Triangles of one colour.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Patch {
    /// Corners.
    pub points: Vec<[f64; 3]>,
    /// Indices of three corners per triangle, counterclockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Red, green and blue, from 0 to 1, if the file contains a colour.
    pub rgb: Option<[f64; 3]>,
}
