//! Shapes that a program carries at the flange.

use std::{
    collections::{HashMap, hash_map::Entry},
    ops::Range,
};

use iiwa_json::{JsonPlace, JsonStep, excerpt, locate};
use iiwa_program::{LoadShape, Motion, MotionIndex, Program, ShapesFrom, motion_path};

use crate::{
    hull::ConvexHull,
    links::{TOOL, WORKPIECE},
    tool::ToolShape,
};

/// Shapes at the flange during each motion of a program: those of its tools and of the workpieces
/// that it carries, with their meshes.
///
/// ```
/// use iiwa_program::Program;
/// use iiwa_scene::CarriedBodies;
///
/// let program = Program::from_json(r#"{
///     "version": 1,
///     "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
///     "motions": [
///         { "type": "load", "load": { "mass_kg": 2, "shapes":
///             [{ "type": "sphere", "center_mm": [0, 0, 80], "radius_mm": 40 }] } },
///         { "type": "ptp", "joints_deg": [0, 50, 0, -60, 0, 90, 0] }
///     ]
/// }"#)?;
/// let carried = CarriedBodies::new(&program, |_| Err("unknown".to_owned()))?;
/// assert_eq!(carried.bodies().len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CarriedBodies {
    bodies: Vec<CarriedBody>,
    by_motion: Vec<BodiesOfMotion>,
    kinds: Vec<EntryKind>,
}

/// Kind of an entry of a program, as far as the shapes at the flange depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EntryKind {
    Moves,
    Load,
    Rests,
}

/// Body at the flange: a tool, or a workpiece.
#[derive(Clone, Debug, PartialEq)]
pub struct CarriedBody {
    /// Number of the part in clearances: 8 for a tool, 9 for a workpiece.
    pub part: usize,
    /// Shapes, in the flange frame.
    pub shapes: Vec<ToolShape>,
}

/// Indices of the tool and of the workpiece during a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct BodiesOfMotion {
    tool: Option<usize>,
    workpiece: Option<usize>,
}

impl BodiesOfMotion {
    /// Returns the bodies at the flange.
    pub(crate) fn present(self) -> [Option<usize>; 2] {
        [self.tool, self.workpiece]
    }
}

/// Error of a mesh that a program carries.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}{}", self.owner.motion_prefix(), self.message())]
pub struct CarriedMeshError {
    owner: ShapeOwner,
    shape: usize,
    file: String,
    reason: String,
}

#[derive(Clone, Debug, PartialEq)]
enum ShapeOwner {
    Tool(String),
    Motion(usize),
}

impl ShapeOwner {
    /// Prefix of errors: the motion, if any.
    fn motion_prefix(&self) -> String {
        match self {
            Self::Tool(_) => String::new(),
            Self::Motion(index) => format!("motion {}: ", MotionIndex::new(*index)),
        }
    }
}

impl CarriedMeshError {
    /// Returns the message without the motion.
    #[must_use]
    pub fn message(&self) -> String {
        let tool = match &self.owner {
            ShapeOwner::Tool(name) => format!("tool `{}`: ", excerpt(name)),
            ShapeOwner::Motion(_) => String::new(),
        };
        let (shape, file) = (self.shape + 1, excerpt(&self.file));
        format!("{tool}shape {shape} of the load: `{file}`: {}", self.reason)
    }

    /// Returns the place of the mesh in the program's JSON text.
    #[must_use]
    pub fn place_in(&self, text: &str) -> JsonPlace {
        use JsonStep::{Index, Key};
        let mut path = match &self.owner {
            ShapeOwner::Tool(name) => vec![Key("tools"), Key(name)],
            ShapeOwner::Motion(index) => motion_path(text, MotionIndex::new(*index)),
        };
        path.extend([Key("load"), Key("shapes"), Index(self.shape), Key("file")]);
        locate(text, &path)
    }

    /// Returns the motion that carries the mesh; none for a tool.
    #[must_use]
    pub fn motion(&self) -> Option<MotionIndex> {
        match self.owner {
            ShapeOwner::Tool(_) => None,
            ShapeOwner::Motion(index) => Some(MotionIndex::new(index)),
        }
    }
}

impl CarriedBodies {
    /// Creates the shapes that `program` carries. `read` receives the name of a mesh file, or its
    /// data URI, and returns the bytes, or the reason why it cannot be read.
    ///
    /// # Errors
    ///
    /// If a mesh cannot be read, or is not solid.
    pub fn new<'a>(
        program: &'a Program,
        mut read: impl FnMut(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Self, CarriedMeshError> {
        let mut bodies = Vec::new();
        // All rounds of a repeat block have the same shapes, and share one body.
        let mut known: HashMap<_, Vec<(&[LoadShape], usize)>> = HashMap::new();
        let mut hulls = HashMap::new();
        let mut body = |of: &ShapesFrom<'a>, part: usize| {
            if of.shapes.is_empty() {
                return Ok(None);
            }
            let similar = known.entry((part, numbers(of.shapes))).or_default();
            if let Some((_, index)) = similar.iter().find(|(shapes, _)| *shapes == of.shapes) {
                return Ok(Some(*index));
            }
            let shapes = of.shapes.iter().enumerate().map(|(index, shape)| {
                let shape = tool_shape(shape, &mut hulls, &mut read);
                shape.map_err(|(file, reason)| CarriedMeshError {
                    owner: match (of.tool, of.motion) {
                        (Some(name), _) => ShapeOwner::Tool(name.to_owned()),
                        (None, motion) => ShapeOwner::Motion(motion.unwrap_or_default()),
                    },
                    shape: index,
                    file,
                    reason,
                })
            });
            bodies.push(CarriedBody { part, shapes: shapes.collect::<Result<_, _>>()? });
            similar.push((of.shapes, bodies.len() - 1));
            Ok(Some(bodies.len() - 1))
        };
        let by_motion = program.carried_shapes().into_iter().map(|shapes| {
            Ok(BodiesOfMotion {
                tool: body(&shapes.tool, TOOL)?,
                workpiece: body(&shapes.workpiece, WORKPIECE)?,
            })
        });
        let by_motion = by_motion.collect::<Result<_, _>>()?;
        let kinds = program.motions.iter().map(|entry| match entry {
            Motion::Load(_) => EntryKind::Load,
            entry if entry.moves() => EntryKind::Moves,
            _ => EntryKind::Rests,
        });
        Ok(Self { bodies, by_motion, kinds: kinds.collect() })
    }

    /// Returns all bodies.
    #[must_use]
    pub fn bodies(&self) -> &[CarriedBody] {
        &self.bodies
    }

    /// Returns the motions from which other bodies are at the flange than before, in order, the
    /// first motion of the program included.
    pub fn changes(&self) -> impl Iterator<Item = MotionIndex> {
        let is_change = |index: &usize| {
            let before = index.checked_sub(1).map(|before| self.by_motion[before]);
            before != Some(self.by_motion[*index])
        };
        (0..self.by_motion.len()).filter(is_change).map(MotionIndex::new)
    }

    /// Returns the load changes at the rest before a motion whose bodies the motion lacks.
    pub(crate) fn loads_before(&self, motion: MotionIndex) -> impl Iterator<Item = MotionIndex> {
        let end = motion.index().min(self.kinds.len());
        let rests = self.kinds[..end].iter().rev().take_while(|kind| **kind != EntryKind::Moves);
        self.loads(end - rests.count()..end)
    }

    /// Returns the load changes at the rest after a motion whose bodies the next motion lacks.
    pub(crate) fn loads_after(&self, motion: MotionIndex) -> impl Iterator<Item = MotionIndex> {
        let start = (motion.index() + 1).min(self.kinds.len());
        let rests = self.kinds[start..].iter().take_while(|kind| **kind != EntryKind::Moves);
        self.loads(start..start + rests.count())
    }

    /// Returns the load changes among `entries`, a rest, with other bodies than the motion after
    /// them.
    fn loads(&self, entries: Range<usize>) -> impl Iterator<Item = MotionIndex> {
        let next = self.at(MotionIndex::new(entries.end));
        let loads = entries.filter(|index| self.kinds[*index] == EntryKind::Load);
        let none = BodiesOfMotion::default();
        loads.map(MotionIndex::new).filter(move |load| ![next, none].contains(&self.at(*load)))
    }

    /// Returns the indices of the bodies at the flange during a motion, the tool first.
    pub fn during(&self, motion: MotionIndex) -> impl Iterator<Item = usize> {
        let BodiesOfMotion { tool, workpiece } = self.at(motion);
        tool.into_iter().chain(workpiece)
    }

    pub(crate) fn at(&self, motion: MotionIndex) -> BodiesOfMotion {
        self.by_motion.get(motion.index()).copied().unwrap_or_default()
    }
}

/// Hulls of meshes, by their files and the bits of their scales.
type Hulls<'a> = HashMap<(&'a str, u64), ConvexHull>;

/// Returns the bits of all numbers of shapes: different ones if any number differs. Names of meshes
/// may be long data URIs, and are left to the comparison of the shapes.
fn numbers(shapes: &[LoadShape]) -> Vec<u64> {
    let of_shape = |shape: &LoadShape| match shape {
        LoadShape::Box { center_mm, size_mm, rpy_deg } => {
            [&center_mm[..], size_mm, rpy_deg].concat()
        }
        LoadShape::Cylinder { center_mm, radius_mm, length_mm, rpy_deg } => {
            [&center_mm[..], &[*radius_mm, *length_mm], rpy_deg].concat()
        }
        LoadShape::Sphere { center_mm, radius_mm } => [&center_mm[..], &[*radius_mm]].concat(),
        LoadShape::Mesh { origin_mm, rpy_deg, scale, .. } => {
            [&origin_mm[..], rpy_deg, &[*scale]].concat()
        }
        _ => Vec::new(),
    };
    shapes.iter().flat_map(of_shape).map(f64::to_bits).collect()
}

/// Converts a shape; the error is the mesh file and the reason.
fn tool_shape<'a>(
    shape: &'a LoadShape,
    hulls: &mut Hulls<'a>,
    read: &mut impl FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<ToolShape, (String, String)> {
    let in_m = |mm: &[f64; 3]| mm.map(|mm| mm / 1e3);
    let in_rad = |deg: &[f64; 3]| deg.map(f64::to_radians);
    Ok(match shape {
        LoadShape::Box { center_mm, size_mm, rpy_deg } => ToolShape::Box {
            center_m: in_m(center_mm),
            size_m: in_m(size_mm),
            rpy_rad: in_rad(rpy_deg),
        },
        LoadShape::Cylinder { center_mm, radius_mm, length_mm, rpy_deg } => ToolShape::Cylinder {
            center_m: in_m(center_mm),
            radius_m: radius_mm / 1e3,
            length_m: length_mm / 1e3,
            rpy_rad: in_rad(rpy_deg),
        },
        LoadShape::Sphere { center_mm, radius_mm } => {
            ToolShape::Sphere { center_m: in_m(center_mm), radius_m: radius_mm / 1e3 }
        }
        LoadShape::Mesh { file, origin_mm, rpy_deg, scale } => {
            let wrong = |reason: String| (file.as_ref().to_owned(), reason);
            let name = format!("mesh.{}", LoadShape::mesh_format(file).unwrap_or_default());
            let hull = match hulls.entry((file, scale.to_bits())) {
                Entry::Occupied(known) => known.get().clone(),
                Entry::Vacant(vacant) => {
                    let bytes = read(file).map_err(wrong)?;
                    let hull = ConvexHull::from_mesh(&name, &bytes, *scale)
                        .map_err(|error| wrong(error.to_string()))?;
                    vacant.insert(hull).clone()
                }
            };
            ToolShape::Mesh { hull, origin_m: in_m(origin_mm), rpy_rad: in_rad(rpy_deg) }
        }
        other => {
            let reason = format!("shapes of the type {} are not known", other.type_name());
            return Err((other.type_name().to_owned(), reason));
        }
    })
}
