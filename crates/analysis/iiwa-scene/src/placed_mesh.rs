//! Surface of a mesh in the base frame, in a tree of bounding boxes.
//!
//! A surface is a union of triangles, which are convex: distances and the bounds of motions apply
//! to each of them. The tree excludes most triangles at once, because a box around some of them is
//! convex as well, and nearer than all of them.

use glam::DVec3 as Vector;

use crate::{placed_box::PlacedBox, polyhedron::Face, surface::TriangleSurface};

/// Surface of a mesh in the base frame.
#[derive(Debug)]
pub(crate) struct PlacedMesh {
    /// Nodes of the tree; the first one is the root.
    nodes: Vec<BoundingNode>,
    faces: Vec<Face>,
}

/// Box around triangles.
#[derive(Clone, Copy, Debug)]
struct BoundingNode {
    low: Vector,
    high: Vector,
    content: NodeContent,
}

/// Content of a node of the tree.
#[derive(Clone, Copy, Debug)]
pub(crate) enum NodeContent {
    /// Index of the first one of two adjacent nodes.
    Nodes(usize),
    /// Index of a triangle.
    Face(usize),
}

/// Part of a surface: a triangle, or the box around several triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SurfacePart<'a> {
    Face(&'a Face),
    /// Box, and the index of the first one of its two nodes.
    Box(PlacedBox, usize),
}

impl PlacedMesh {
    /// Places a surface, whose frame has this origin and this rotation, as rows, in the base frame.
    pub(crate) fn new(
        surface: &TriangleSurface,
        origin_m: [f64; 3],
        rotation: [[f64; 3]; 3],
    ) -> Self {
        let rows = rotation.map(Vector::from);
        let turn = |direction: Vector| Vector::from(rows.map(|row| row.dot(direction)));
        let place = |point: Vector| Vector::from(origin_m) + turn(point);
        let points = surface.points_m();
        let corners = |triangle: &[u32; 3]| triangle.map(|it| Vector::from(points[it as usize]));
        // In its own frame, each triangle of a surface is a face. In the base frame, rounding may
        // make it too narrow, so that the face is made first.
        let faces = surface.triangles().iter().filter_map(|triangle| Face::new(corners(triangle)));
        let faces = faces.map(|face| face.moved(place, turn)).collect::<Vec<_>>();
        let mut order = (0..faces.len()).collect::<Vec<_>>();
        let nothing = BoundingNode {
            low: Vector::MAX,
            high: Vector::MIN,
            content: NodeContent::Nodes(usize::MAX),
        };
        let mut mesh = Self { nodes: vec![nothing], faces };
        if !mesh.faces.is_empty() {
            mesh.divide(0, &mut order);
        }
        mesh
    }

    /// Fills a node, which is at `index`, with these triangles.
    fn divide(&mut self, index: usize, order: &mut [usize]) {
        let corners = |face: &usize| self.faces[*face].corners;
        let low = order.iter().flat_map(corners).fold(Vector::MAX, Vector::min);
        let high = order.iter().flat_map(corners).fold(Vector::MIN, Vector::max);
        let content = if let [face] = order {
            NodeContent::Face(*face)
        } else {
            // Half of the triangles on either side, along the longest edge of the box: the depth of
            // the tree is the logarithm of their number, whatever their shape.
            let size = high - low;
            let axis =
                (0..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
            let center = |face: &usize| corners(face).iter().map(|it| it[axis]).sum::<f64>();
            let middle = order.len() / 2;
            order.select_nth_unstable_by(middle, |a, b| {
                center(a).total_cmp(&center(b)).then_with(|| a.cmp(b))
            });
            let first = self.nodes.len();
            let node = self.nodes[index];
            self.nodes.extend([node, node]);
            let (left, right) = order.split_at_mut(middle);
            self.divide(first, left);
            self.divide(first + 1, right);
            NodeContent::Nodes(first)
        };
        self.nodes[index] = BoundingNode { low, high, content };
    }

    /// Returns the part of the surface at a node; the root is node 0.
    pub(crate) fn part(&self, node: usize) -> SurfacePart<'_> {
        let BoundingNode { low, high, content } = self.nodes[node];
        match content {
            NodeContent::Face(face) => SurfacePart::Face(&self.faces[face]),
            NodeContent::Nodes(first) => SurfacePart::Box(PlacedBox::between(low, high), first),
        }
    }

    /// Returns a lower bound of the distance of `point` from the surface.
    pub(crate) fn lower_bound(&self, point: Vector) -> f64 {
        self.lower_bound_of(0, point)
    }

    /// Returns a lower bound of the distance of `point` from the part at a node.
    pub(crate) fn lower_bound_of(&self, node: usize, point: Vector) -> f64 {
        let BoundingNode { low, high, .. } = self.nodes[node];
        (point - point.clamp(low, high)).length()
    }

    /// Returns the largest `direction . x` of the points at a node: of a triangle, or of a box.
    pub(crate) fn farthest_along(&self, node: usize, direction: Vector) -> f64 {
        match self.part(node) {
            SurfacePart::Face(face) => face.farthest_along(direction),
            SurfacePart::Box(cuboid, _) => cuboid.farthest_along(direction),
        }
    }
}
