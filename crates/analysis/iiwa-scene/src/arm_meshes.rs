//! Link meshes of the arm from a user's URDF.

use std::path::Path;

use iiwa_json::JsonPlace;
use iiwa_kin::{Pose, Robot, UrdfError, UrdfMesh};

use crate::{
    hull::{ConvexHull, NotSolid},
    mesh::TriangleMesh,
    mesh_error::TriangleMeshError,
    patch::Patch,
};

/// Largest extent of a link mesh, in m; the arm is 1.3 m long.
const MAX_EXTENT_M: f64 = 2.0;

/// Link meshes of the arm, from a URDF.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ArmMeshes {
    /// Visual meshes of links 0 to 7, each in its link frame, in m.
    pub visual: [Vec<Patch>; 8],
    /// Convex hulls for clearances: of the collision meshes, or of the visual meshes for links
    /// without collision meshes.
    pub hulls: [Vec<ConvexHull>; 8],
}

/// Error of reading the link meshes of a URDF.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ArmMeshError {
    /// The text is not a URDF of this robot.
    #[error(transparent)]
    Urdf(#[from] UrdfError),
    /// The URDF contains no meshes of the arm.
    #[error(
        "it names no meshes: none of the links of its seven joints has a <mesh> among its visuals"
    )]
    None,
    /// A file is not available.
    #[error("the mesh {file:?}: {reason}, at {place}")]
    File {
        /// Place in the URDF.
        place: JsonPlace,
        /// File name in the URDF.
        file: String,
        /// Reason.
        reason: String,
    },
    /// A file is not a valid mesh.
    #[error("the mesh {file:?}: {error}, at {place}")]
    Mesh {
        /// Place in the URDF.
        place: JsonPlace,
        /// File name in the URDF.
        file: String,
        /// Error of reading the mesh.
        error: TriangleMeshError,
    },
    /// A mesh is so long that its unit must be wrong.
    #[error(
        "the mesh {file:?} is {longest_m:.3} m long: its numbers are taken for m, and \
         scale=\"0.001 0.001 0.001\" makes them mm, at {place}"
    )]
    Extent {
        /// Place in the URDF.
        place: JsonPlace,
        /// File name in the URDF.
        file: String,
        /// Largest extent, in m.
        longest_m: f64,
    },
    /// A mesh has no convex hull.
    #[error("the mesh {file:?}: {error}, at {place}")]
    NotSolid {
        /// Place in the URDF.
        place: JsonPlace,
        /// File name in the URDF.
        file: String,
        /// Reason.
        error: NotSolid,
    },
}

impl ArmMeshError {
    /// Returns the place in the URDF, if there is one.
    #[must_use]
    pub fn place(&self) -> Option<&JsonPlace> {
        match self {
            Self::None => None,
            Self::Urdf(error) => Some(error.place()),
            Self::File { place, .. }
            | Self::Mesh { place, .. }
            | Self::Extent { place, .. }
            | Self::NotSolid { place, .. } => Some(place),
        }
    }

    /// Returns the message without the place.
    #[must_use]
    pub fn message(&self) -> String {
        let text = self.to_string();
        self.place().map_or_else(|| text.clone(), |place| place.cut_from(&text))
    }
}

impl ArmMeshes {
    /// Reads the meshes of a URDF of `robot`. `read` receives a file name as in the URDF, and
    /// returns the contents or the reason why they are not available. For an OBJ file, `read` also
    /// receives the name of its material file in the same folder, which is optional.
    ///
    /// # Errors
    ///
    /// If the text is not a URDF of this robot (see [`Robot::urdf_meshes`]), contains no meshes, or
    /// one of them is not a valid mesh in m.
    pub fn from_urdf(
        robot: &Robot,
        urdf: &str,
        mut read: impl FnMut(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Self, ArmMeshError> {
        let links = robot.urdf_meshes(urdf)?;
        if links.iter().all(|link| link.visual.is_empty()) {
            return Err(ArmMeshError::None);
        }
        let mut visual: [Vec<Patch>; 8] = Default::default();
        let mut hulls: [Vec<ConvexHull>; 8] = Default::default();
        for (number, link) in links.iter().enumerate() {
            for mesh in &link.visual {
                let patches = patches(mesh, &mut read)?;
                if link.collision.is_empty() {
                    hulls[number].push(hull(mesh, &patches)?);
                }
                visual[number].extend(patches);
            }
            for mesh in &link.collision {
                hulls[number].push(hull(mesh, &patches(mesh, &mut read)?)?);
            }
        }
        Ok(Self { visual, hulls })
    }
}

fn hull(mesh: &UrdfMesh, patches: &[Patch]) -> Result<ConvexHull, ArmMeshError> {
    let points = patches.iter().flat_map(|patch| patch.points.iter().copied());
    ConvexHull::new(points).map_err(|error| {
        let UrdfMesh { place, file, .. } = mesh.clone();
        ArmMeshError::NotSolid { place, file, error }
    })
}

/// Returns the triangles of a mesh, in the link frame, in m.
fn patches(
    mesh: &UrdfMesh,
    read: &mut impl FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<Vec<Patch>, ArmMeshError> {
    let UrdfMesh { place, file, scale, pose, rgba, .. } = mesh;
    let (place, file) = (|| place.clone(), || file.clone());
    let bytes = read(&mesh.file).map_err(|reason| ArmMeshError::File {
        place: place(),
        file: file(),
        reason,
    })?;
    let beside = |name: &Path| {
        let folder = mesh.file.rsplit_once('/').map_or("", |(folder, _)| folder);
        let name = name.to_str()?;
        read(&if folder.is_empty() { name.to_owned() } else { format!("{folder}/{name}") }).ok()
    };
    let mesh_data = TriangleMesh::read(&mesh.file, &bytes, beside)
        .map_err(|error| ArmMeshError::Mesh { place: place(), file: file(), error })?;
    let mut patches = mesh_data.patches;
    // Mirroring inverts the orientation of triangles.
    let is_mirrored = scale.iter().product::<f64>() < 0.0;
    for patch in &mut patches {
        for point in &mut patch.points {
            *point = placed(pose, std::array::from_fn(|i| scale[i] * point[i]));
        }
        if is_mirrored {
            patch.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        if let Some([red, green, blue, _]) = rgba {
            patch.rgb = Some([*red, *green, *blue]);
        }
    }
    let is_finite =
        patches.iter().flat_map(|patch| patch.points.as_flattened()).all(|v| v.is_finite());
    let longest_m = (0..3).map(|i| extent(&patches, i)).fold(0.0, f64::max);
    let longest_m = if is_finite { longest_m } else { f64::INFINITY };
    if longest_m > MAX_EXTENT_M {
        return Err(ArmMeshError::Extent { place: place(), file: file(), longest_m });
    }
    Ok(patches)
}

/// Returns the extent of the patches along an axis.
fn extent(patches: &[Patch], axis: usize) -> f64 {
    let along = patches.iter().flat_map(|patch| &patch.points).map(|point| point[axis]);
    let (low, high) =
        along.fold((f64::MAX, f64::MIN), |(low, high): (f64, f64), v| (low.min(v), high.max(v)));
    high - low
}

fn placed(pose: &Pose, point: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| {
        let row = pose.rotation[i];
        pose.position_m[i] + row[0] * point[0] + row[1] * point[1] + row[2] * point[2]
    })
}
