//! The arm as a user's URDF has it: meshes of its links.

use std::path::Path;

use iiwa_json::Place;
use iiwa_kin::{Pose, Robot, UrdfError, UrdfMesh};

use crate::{
    hull::{ConvexHull, NotSolid},
    mesh::{Patch, TriangleMesh, TriangleMeshError},
};

/// Longest extent of a link's mesh, in m; the arm is 1.3 m long.
const MAX_EXTENT_M: f64 = 2.0;

/// Meshes of the arm's links, from a URDF.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ArmMeshes {
    /// What link 0 to link 7 look like, each in its link's frame, in m.
    pub visual: [Vec<Patch>; 8],
    /// What they are for clearances: the convex hulls of their meshes for collisions; of a link that has none, of those that it
    /// looks like.
    pub hulls: [Vec<ConvexHull>; 8],
}

/// Why a URDF gives no meshes of the arm.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ArmMeshError {
    /// It is no URDF of this robot.
    #[error(transparent)]
    Urdf(#[from] UrdfError),
    /// It names no mesh that is a part of the arm.
    #[error(
        "it names no meshes: none of the links of its seven joints has a <mesh> among its visuals"
    )]
    None,
    /// A file cannot be had.
    #[error("the mesh {file:?}: {reason}, at {at}")]
    File {
        /// Where the URDF names it.
        at: Place,
        /// Its name there.
        file: String,
        /// Why.
        reason: String,
    },
    /// A file is no mesh.
    #[error("the mesh {file:?}: {error}, at {at}")]
    Mesh {
        /// Where the URDF names it.
        at: Place,
        /// Its name there.
        file: String,
        /// What it is instead.
        error: TriangleMeshError,
    },
    /// A mesh is so long that its unit is another one.
    #[error(
        "the mesh {file:?} is {longest_m:.3} m long: its numbers are taken for m, and scale=\"0.001 0.001 0.001\" makes them mm, at {at}"
    )]
    Extent {
        /// Where the URDF names it.
        at: Place,
        /// Its name there.
        file: String,
        /// Its longest extent, in m.
        longest_m: f64,
    },
    /// A mesh has no convex hull.
    #[error("the mesh {file:?}: {error}, at {at}")]
    NotSolid {
        /// Where the URDF names it.
        at: Place,
        /// Its name there.
        file: String,
        /// Why.
        error: NotSolid,
    },
}

impl ArmMeshError {
    /// Where in the URDF, if it is a place there.
    #[must_use]
    pub fn place(&self) -> Option<&Place> {
        match self {
            Self::None => None,
            Self::Urdf(error) => Some(error.place()),
            Self::File { at, .. }
            | Self::Mesh { at, .. }
            | Self::Extent { at, .. }
            | Self::NotSolid { at, .. } => Some(at),
        }
    }

    /// What is wrong, without the place.
    #[must_use]
    pub fn what(&self) -> String {
        let text = self.to_string();
        self.place().map_or_else(|| text.clone(), |place| place.cut_from(&text))
    }
}

impl ArmMeshes {
    /// Reads the meshes that a URDF of `robot` names. `read` takes the name of a file, as the URDF has it, and gives its
    /// contents, or says why it cannot; of an OBJ file, it is asked for the file of its materials, too, by a name beside it,
    /// and need not have it.
    ///
    /// # Errors
    ///
    /// If it is no URDF of this robot (see [`Robot::urdf_meshes`]), names no meshes, or one of them is no mesh in m.
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
        let UrdfMesh { at, file, .. } = mesh.clone();
        ArmMeshError::NotSolid { at, file, error }
    })
}

/// The triangles of a mesh, in the frame of its link, in m.
fn patches(
    mesh: &UrdfMesh,
    read: &mut impl FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<Vec<Patch>, ArmMeshError> {
    let UrdfMesh { at, file, scale, pose, rgba, .. } = mesh;
    let (at, file) = (|| at.clone(), || file.clone());
    let bytes =
        read(&mesh.file).map_err(|reason| ArmMeshError::File { at: at(), file: file(), reason })?;
    let beside = |name: &Path| {
        let folder = mesh.file.rsplit_once('/').map_or("", |(folder, _)| folder);
        let name = name.to_str()?;
        read(&if folder.is_empty() { name.to_owned() } else { format!("{folder}/{name}") }).ok()
    };
    let found = TriangleMesh::read(&mesh.file, &bytes, beside)
        .map_err(|error| ArmMeshError::Mesh { at: at(), file: file(), error })?;
    let mut patches = found.patches;
    // A mirrored mesh has its triangles the other way round.
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
        return Err(ArmMeshError::Extent { at: at(), file: file(), longest_m });
    }
    Ok(patches)
}

/// How far the patches go along an axis.
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
