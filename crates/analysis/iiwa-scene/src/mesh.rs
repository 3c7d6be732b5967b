//! Triangles of mesh files.

use std::{collections::HashSet, io, panic, path::Path};

/// Maximum number of triangles of a mesh: CAD of a tool or of an arm, but not a scan of a hall.
pub(crate) const MAX_TRIANGLES: usize = 2_000_000;

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

/// Error of reading a mesh file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TriangleMeshError {
    /// The file extension is not supported.
    #[error("meshes are read from *.stl, *.obj and *.dae")]
    Format,
    /// The contents do not match the file extension.
    #[error("not a valid {format} file: {error}")]
    Unread {
        /// Expected format: `STL`, `OBJ` or `Collada`.
        format: &'static str,
        /// Fault and its place.
        error: io::Error,
    },
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

impl TriangleMesh {
    /// Reads `bytes`, the contents of a file with the extension `.stl` (binary or ASCII), `.obj` or
    /// `.dae` (Collada). `materials` returns the material files of an OBJ file, without which it
    /// has no colours.
    ///
    /// # Errors
    ///
    /// If the file is invalid, or has no triangles or more than two million.
    pub fn read(
        name: &str,
        bytes: &[u8],
        materials: impl FnMut(&Path) -> Option<Vec<u8>>,
    ) -> Result<Self, TriangleMeshError> {
        let format = MeshFormat::of(name).ok_or(TriangleMeshError::Format)?;
        let unread = |error| TriangleMeshError::Unread { format: format.name(), error };
        let read = format.read(bytes, materials).map_err(unread)?;
        let found = read.meshes.iter().map(|mesh| mesh.faces.len()).sum();
        if found == 0 {
            return Err(TriangleMeshError::Empty);
        }
        if found > MAX_TRIANGLES {
            return Err(TriangleMeshError::TooMany { found, max: MAX_TRIANGLES });
        }
        let mut patches = Vec::new();
        for (number, mesh) in read.meshes.iter().enumerate() {
            if mesh.faces.is_empty() {
                continue;
            }
            let points = mesh.vertices.iter().map(|point| point.map(f64::from)).collect::<Vec<_>>();
            if points.iter().flatten().any(|value| !value.is_finite()) {
                return Err(TriangleMeshError::NotFinite);
            }
            let colour = read.materials.get(number).and_then(|material| material.color.diffuse);
            let triangles = mesh.faces.iter().copied();
            let exist = |corners: &[u32; 3]| corners.iter().all(|it| (*it as usize) < points.len());
            let triangles = triangles.filter(exist).collect();
            let rgb = colour.map(|[red, green, blue, _]| [red, green, blue].map(f64::from));
            patches.push(Patch { points, triangles, rgb });
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

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Stl => "STL",
            Self::Obj => "OBJ",
            Self::Collada => "Collada",
        }
    }

    /// Reads a file of this format.
    pub(crate) fn read(
        self,
        bytes: &[u8],
        mut materials: impl FnMut(&Path) -> Option<Vec<u8>>,
    ) -> io::Result<mesh_loader::Scene> {
        match self {
            Self::Stl => stl(bytes),
            Self::Obj => {
                mesh_loader::obj::from_slice(bytes, Some(Path::new("a.obj")), |path: &Path| {
                    materials(path).ok_or_else(|| io::ErrorKind::NotFound.into())
                })
            }
            Self::Collada => collada(bytes),
        }
    }
}

/// Reads Collada. Rejects contents that `mesh_loader` reads incorrectly: it keeps only one instance
/// of a part with several instances, and it combines the transformations of nested nodes in the
/// wrong order. It does not apply the unit to positions, which is done here.
fn collada(bytes: &[u8]) -> io::Result<mesh_loader::Scene> {
    const UNIT: &str = "<unit";
    let mut text = String::from_utf8_lossy(bytes).into_owned();
    let mut shown = HashSet::new();
    let mut depth = 0_i32;
    for tag in text.split('<').skip(1) {
        let tag = tag.split('>').next().unwrap_or_default();
        if tag.starts_with("instance_geometry") && !shown.insert(quoted(tag, "url")) {
            let part = quoted(tag, "url").unwrap_or_default();
            return invalid(format!(
                "it shows its part {part:?} at several places, which cannot be read: write the \
                 mesh as STL or OBJ"
            ));
        }
        let is_node = tag == "node" || tag.starts_with("node ");
        depth += i32::from(is_node && !tag.ends_with('/')) - i32::from(tag.starts_with("/node"));
        if is_node && depth > 1 {
            return invalid(
                "it has nodes within nodes, which cannot be read: write the mesh as STL or OBJ",
            );
        }
    }
    let mut unit_m = 1.0;
    if let Some(start) = text.find(UNIT)
        && let Some(length) = text[start..].find('>')
    {
        let tag = &text[start..start + length];
        if let Some(meter) = quoted(tag, "meter") {
            let Some(unit) = meter.trim().parse().ok().filter(|unit: &f32| *unit > 0.0) else {
                return invalid(format!("its unit is {meter:?} m"));
            };
            unit_m = unit;
        }
        let end = if tag.ends_with('/') { "/" } else { "" };
        text.replace_range(start..start + length, &format!("{UNIT}{end}"));
    }
    // `mesh_loader` panics on indices that are out of range.
    let mut scene = panic::catch_unwind(|| mesh_loader::collada::from_str(&text))
        .unwrap_or_else(|_| invalid("its numbers lead to corners that it does not have"))?;
    for value in scene.meshes.iter_mut().flat_map(|mesh| mesh.vertices.as_flattened_mut()) {
        *value *= unit_m;
    }
    Ok(scene)
}

/// Returns the value of a tag's attribute.
fn quoted<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = tag.split_once(&format!("{name}="))?;
    rest.split(['"', '\'']).nth(1)
}

fn invalid<T>(message: impl Into<String>) -> io::Result<T> {
    Err(io::Error::new(io::ErrorKind::InvalidData, message.into()))
}

/// Reads ASCII or binary STL. The length of a binary file has to match its number of triangles:
/// otherwise the file is truncated, and a part of the tool would be missing.
fn stl(bytes: &[u8]) -> io::Result<mesh_loader::Scene> {
    const HEADER: usize = 84;
    const TRIANGLE: usize = 50;
    if bytes.is_empty() {
        return invalid("it is empty");
    }
    let count = bytes.get(80..HEADER).and_then(|count| count.try_into().ok());
    let triangles = count.map(u32::from_le_bytes);
    let is_whole = triangles
        .is_some_and(|count| (bytes.len() - HEADER) as u64 == u64::from(count) * TRIANGLE as u64);
    let is_text =
        bytes.starts_with(b"solid") && !bytes.contains(&0) && str::from_utf8(bytes).is_ok();
    if !is_whole && !is_text {
        return invalid(match triangles {
            Some(count) => format!(
                "it is not text that begins with `solid`, and as a binary file of {count} \
                 triangles it would have another length"
            ),
            None => "it is not text that begins with `solid`, and too short for a binary file"
                .to_owned(),
        });
    }
    let read = mesh_loader::stl::from_slice(bytes)?;
    let found: usize = read.meshes.iter().map(|mesh| mesh.faces.len()).sum();
    match triangles.filter(|_| is_whole) {
        Some(count) if found != count as usize => {
            invalid(format!("{found} of its {count} triangles could be read"))
        }
        _ => Ok(read),
    }
}
