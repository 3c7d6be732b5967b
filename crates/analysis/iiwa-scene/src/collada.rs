//! Reader of Collada files (1.4 and 1.5): the triangles that the scene of a file shows.
//!
//! The reader walks through the nodes of the visual scene and applies their transformations in
//! order, through nested nodes and `<instance_node>`. Geometry that the scene does not show, and
//! positions that no triangle uses, do not count. Content that would move or deform a shape and is
//! not supported, such as `<skew>` and `<instance_controller>`, is refused with its place.
//!
//! `<up_axis>` is ignored: for meshes of a URDF, `RViz` and `MoveIt` take the coordinates of the
//! file as those of the link (<https://github.com/moveit/geometric_shapes/pull/52>).

mod document;
mod geometry;
mod material;
mod placement;
mod start_tag;

use std::{
    collections::{HashMap, hash_map::Entry},
    rc::Rc,
};

use iiwa_json::{UTF_16, is_utf16};
use roxmltree::{Document, NodeId};

pub use document::ColladaError;
use document::{ColladaDocument, XmlElement, elements, fault, title};
use geometry::{GeometryPart, GeometryReader, too_many};
use material::MaterialReader;
use placement::{Placement, not_applied};

use crate::patch::{MAX_TRIANGLES, Patch};

/// Maximum nesting depth of nodes, counted through `<instance_node>`.
const MAX_DEPTH: usize = 100;

/// Maximum number of elements to visit; a file that contains itself by turns needs more.
const MAX_VISITS: usize = 1_000_000;

/// Reads the contents of a file; lengths are in m.
pub(crate) fn read(bytes: &[u8]) -> Result<Vec<Patch>, ColladaError> {
    if is_utf16(bytes) {
        return Err(ColladaError { line: 1, column: 1, message: UTF_16.to_owned() });
    }
    // Only names can have other characters; names that become equal are refused where they are
    // used.
    let text = String::from_utf8_lossy(bytes);
    start_tag::check_all(&text)?;
    let xml = Document::parse(&text).map_err(|error| {
        let place = error.pos();
        ColladaError { line: place.row, column: place.col, message: error.to_string() }
    })?;
    let document = ColladaDocument::new(&xml)?;
    let scene = document.visual_scene()?;
    document.check_unit(scene)?;
    let mut walk = SceneWalk {
        document: &document,
        geometries: GeometryReader::new(MAX_TRIANGLES),
        materials: MaterialReader::default(),
        parts: HashMap::new(),
        open: Vec::new(),
        visits: 0,
        triangles: 0,
        patches: Vec::new(),
    };
    for part in elements(scene) {
        match part.tag_name().name() {
            "node" => walk.node(part, &Placement::IDENTITY)?,
            "asset" | "evaluate_scene" | "extra" => {}
            _ => return Err(not_applied(part)),
        }
    }
    let mut patches = walk.patches;
    for value in patches.iter_mut().flat_map(|patch| patch.points.as_flattened_mut()) {
        *value *= document.unit_m;
    }
    Ok(patches)
}

/// Part of a node.
#[derive(Clone, Copy)]
enum NodePart<'a> {
    Transformation(Placement),
    /// Nested node, or the target of an `<instance_node>`.
    Node(XmlElement<'a>),
    Geometry {
        instance: XmlElement<'a>,
        geometry: XmlElement<'a>,
    },
}

/// Walk through the nodes of a scene. Each node is read once, however many instances it has.
struct SceneWalk<'d, 'a> {
    document: &'d ColladaDocument<'a>,
    geometries: GeometryReader<'a>,
    materials: MaterialReader<'a>,
    /// Parts of the nodes that were visited.
    parts: HashMap<NodeId, Rc<[NodePart<'a>]>>,
    /// Nodes around the current one, through instances.
    open: Vec<NodeId>,
    visits: usize,
    triangles: usize,
    patches: Vec<Patch>,
}

impl<'a> SceneWalk<'_, 'a> {
    /// Adds what a node shows.
    fn node(&mut self, node: XmlElement<'a>, outer: &Placement) -> Result<(), ColladaError> {
        if self.open.contains(&node.id()) {
            return Err(fault(node, format!("{} contains itself", title(node))));
        }
        if self.open.len() == MAX_DEPTH {
            return Err(fault(node, format!("nodes are nested more than {MAX_DEPTH} deep")));
        }
        self.document.check_unit(node)?;
        let parts = self.parts(node)?;
        self.visits += parts.len();
        if self.visits > MAX_VISITS {
            return Err(fault(node, format!("it shows more than {MAX_VISITS} elements")));
        }
        let mut placement = *outer;
        for part in parts.iter() {
            if let NodePart::Transformation(inner) = part {
                placement = placement.after(inner);
            }
        }
        self.open.push(node.id());
        for part in parts.iter() {
            match *part {
                NodePart::Transformation(_) => {}
                NodePart::Node(inner) => self.node(inner, &placement)?,
                NodePart::Geometry { instance, geometry } => {
                    self.geometry(instance, geometry, &placement)?;
                }
            }
        }
        self.open.pop();
        Ok(())
    }

    /// Reads the parts of a node, in order.
    fn parts(&mut self, node: XmlElement<'a>) -> Result<Rc<[NodePart<'a>]>, ColladaError> {
        let vacant = match self.parts.entry(node.id()) {
            Entry::Occupied(known) => return Ok(Rc::clone(known.get())),
            Entry::Vacant(vacant) => vacant,
        };
        let mut parts = Vec::new();
        for part in elements(node) {
            if let Some(placement) = Placement::read(part)? {
                parts.push(NodePart::Transformation(placement));
                continue;
            }
            match part.tag_name().name() {
                "node" => parts.push(NodePart::Node(part)),
                "instance_node" => {
                    parts.push(NodePart::Node(self.document.target(part, "url", "node")?));
                }
                "instance_geometry" => {
                    let geometry = self.document.target(part, "url", "geometry")?;
                    parts.push(NodePart::Geometry { instance: part, geometry });
                }
                "asset" | "extra" | "instance_camera" | "instance_light" => {}
                // Such as a skin: `instance_controller`.
                _ => return Err(not_applied(part)),
            }
        }
        Ok(Rc::clone(vacant.insert(parts.into())))
    }

    /// Adds the triangles of an instance of a geometry.
    fn geometry(
        &mut self,
        instance: XmlElement<'a>,
        geometry: XmlElement<'a>,
        placement: &Placement,
    ) -> Result<(), ColladaError> {
        let parts = self.geometries.read(self.document, geometry)?;
        let is_mirrored = placement.is_mirrored();
        let colours = self.materials.colours(self.document, instance);
        for GeometryPart { material, points, triangles } in parts.iter() {
            self.triangles += triangles.len();
            if self.triangles > MAX_TRIANGLES {
                return Err(too_many(instance, MAX_TRIANGLES));
            }
            let rgb = material.and_then(|symbol| *colours.get(symbol)?);
            let points = points.iter().map(|point| placement.apply(*point)).collect();
            let mut triangles = triangles.clone();
            if is_mirrored {
                for corners in &mut triangles {
                    corners.swap(1, 2);
                }
            }
            self.patches.push(Patch { points, triangles, rgb });
        }
        Ok(())
    }
}
