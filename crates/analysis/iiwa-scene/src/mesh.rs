//! Triangles of mesh files.

use std::{io, path::Path};

use iiwa_json::bytes_without_mark;

use crate::{collada, mesh_error::TriangleMeshError, patch::Patch, stl};

/// Triangles of a file, in its own unit and frame.
///
/// ```
/// use iiwa_scene::TriangleMesh;
///
/// let wedge = "v 0 0 0\nv 60 0 0\nv 0 40 0\nv 0 0 20\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
/// let mesh = TriangleMesh::read("wedge.obj", wedge.as_bytes(), |_| None)?;
/// assert_eq!(mesh.patches[0].triangles.len(), 4);
/// # Ok::<(), iiwa_scene::TriangleMeshError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct TriangleMesh {
    /// Non-empty parts, each of one colour.
    pub patches: Vec<Patch>,
}

impl TriangleMesh {
    /// Reads `bytes`, the contents of a file with the extension `.stl` (binary or ASCII), `.obj` or
    /// `.dae` (Collada). `materials` returns the material files of an OBJ file, without which it
    /// has no colours.
    ///
    /// Coordinates of a Collada file are in m, according to its unit. They are those of the visual
    /// scene of the file; `<up_axis>` is ignored, as in `RViz` and `MoveIt`.
    ///
    /// # Errors
    ///
    /// If the file is invalid, has contents that cannot be applied, or has no triangles or more
    /// than two million.
    pub fn read(
        name: &str,
        bytes: &[u8],
        materials: impl FnMut(&Path) -> Option<Vec<u8>>,
    ) -> Result<Self, TriangleMeshError> {
        let format = MeshFormat::of(name).ok_or(TriangleMeshError::Format)?;
        let mut patches = format.read(bytes, materials)?;
        patches.retain(|patch| !patch.triangles.is_empty());
        if patches.is_empty() {
            return Err(TriangleMeshError::Empty);
        }
        let mut values = patches.iter().flat_map(|patch| patch.points.as_flattened());
        if !values.all(|value| value.is_finite()) {
            return Err(TriangleMeshError::NotFinite);
        }
        for Patch { points, triangles, .. } in &mut patches {
            let exist = |corners: &[u32; 3]| corners.iter().all(|it| (*it as usize) < points.len());
            triangles.retain(exist);
        }
        Ok(Self { patches })
    }
}

/// Mesh format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MeshFormat {
    Stl,
    Obj,
    Collada,
}

impl MeshFormat {
    /// Returns the format of a file, by its extension.
    pub(crate) fn of(name: &str) -> Option<Self> {
        match name.rsplit_once('.')?.1.to_ascii_lowercase().as_str() {
            "stl" => Some(Self::Stl),
            "obj" => Some(Self::Obj),
            "dae" => Some(Self::Collada),
            _ => None,
        }
    }

    /// Reads a file of this format. Patches may be empty, and coordinates not finite.
    pub(crate) fn read(
        self,
        bytes: &[u8],
        materials: impl FnMut(&Path) -> Option<Vec<u8>>,
    ) -> Result<Vec<Patch>, TriangleMeshError> {
        match self {
            Self::Stl => stl::read(bytes),
            Self::Obj => obj(bytes, materials),
            Self::Collada => Ok(collada::read(bytes)?),
        }
    }
}

fn obj(
    bytes: &[u8],
    mut materials: impl FnMut(&Path) -> Option<Vec<u8>>,
) -> Result<Vec<Patch>, TriangleMeshError> {
    let beside = |path: &Path| {
        let file = materials(path).ok_or(io::ErrorKind::NotFound)?;
        Ok(bytes_without_mark(&file).to_vec())
    };
    let read =
        mesh_loader::obj::from_slice(bytes_without_mark(bytes), Some(Path::new("a.obj")), beside)
            .map_err(|error| TriangleMeshError::Unread { format: "OBJ", error })?;
    TriangleMeshError::check_count(read.meshes.iter().map(|mesh| mesh.faces.len()).sum())?;
    let patches = read.meshes.into_iter().enumerate().map(|(number, mesh)| {
        let colour = read.materials.get(number).and_then(|material| material.color.diffuse);
        Patch {
            points: mesh.vertices.iter().map(|point| point.map(f64::from)).collect(),
            triangles: mesh.faces,
            rgb: colour.map(|[red, green, blue, _]| [red, green, blue].map(f64::from)),
        }
    });
    Ok(patches.collect())
}
