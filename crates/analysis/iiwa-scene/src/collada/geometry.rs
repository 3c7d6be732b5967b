//! Geometries: sources of positions, and primitives of corners.

use std::{
    collections::{HashMap, hash_map::Entry},
    rc::Rc,
};

use roxmltree::NodeId;

use super::document::{
    ColladaDocument, ColladaError, XmlElement, child, children, count, elements, fault, indices,
    numbers, title,
};

/// Largest offset of an input of a primitive, and largest stride of an accessor.
const MAX_STRIDE: usize = 1000;

/// Triangles of a geometry with one material, in the frame of the geometry.
#[derive(Debug, Default)]
pub(super) struct GeometryPart<'a> {
    /// Symbol of the material, if any.
    pub(super) material: Option<&'a str>,
    /// Corners of the triangles, and no other positions of the file.
    pub(super) points: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Reader of geometries. Each geometry, source and array is read once.
#[derive(Default)]
pub(super) struct GeometryReader<'a> {
    geometries: HashMap<NodeId, Rc<Vec<GeometryPart<'a>>>>,
    positions: HashMap<NodeId, Rc<Vec<[f64; 3]>>>,
    arrays: HashMap<NodeId, Rc<Vec<f64>>>,
    /// Number of positions that were read, and of triangles.
    position_count: usize,
    triangle_count: usize,
    max_triangles: usize,
}

impl<'a> GeometryReader<'a> {
    /// Creates a reader that refuses more than this number of triangles.
    pub(super) fn new(max_triangles: usize) -> Self {
        Self { max_triangles, ..Self::default() }
    }

    /// Reads a `<geometry>`.
    pub(super) fn read(
        &mut self,
        document: &ColladaDocument<'a>,
        geometry: XmlElement<'a>,
    ) -> Result<Rc<Vec<GeometryPart<'a>>>, ColladaError> {
        if let Some(known) = self.geometries.get(&geometry.id()) {
            return Ok(Rc::clone(known));
        }
        document.check_unit(geometry)?;
        let mut parts = Vec::new();
        for shape in elements(geometry) {
            match shape.tag_name().name() {
                "mesh" => self.add_mesh(document, shape, &mut parts)?,
                "convex_mesh" if shape.attribute("convex_hull_of").is_none() => {
                    self.add_mesh(document, shape, &mut parts)?;
                }
                // Curves have no surface.
                "asset" | "extra" | "spline" => {}
                _ => {
                    let owner = title(geometry);
                    let message =
                        format!("{} in {owner} cannot be read as triangles", title(shape));
                    return Err(fault(shape, message));
                }
            }
        }
        let parts = Rc::new(parts);
        self.geometries.insert(geometry.id(), Rc::clone(&parts));
        Ok(parts)
    }

    fn add_mesh(
        &mut self,
        document: &ColladaDocument<'a>,
        mesh: XmlElement<'a>,
        parts: &mut Vec<GeometryPart<'a>>,
    ) -> Result<(), ColladaError> {
        let vertices = child(mesh, "vertices");
        for primitive in elements(mesh) {
            let kind = match primitive.tag_name().name() {
                "triangles" => PrimitiveKind::Triangles,
                "polylist" => PrimitiveKind::Polylist,
                "polygons" => PrimitiveKind::Polygons,
                "trifans" => PrimitiveKind::Fans,
                "tristrips" => PrimitiveKind::Strips,
                // Lines have no surface.
                "source" | "vertices" | "extra" | "lines" | "linestrips" => continue,
                _ => {
                    let message = format!("{} cannot be read as triangles", title(primitive));
                    return Err(fault(primitive, message));
                }
            };
            let polygons = Polygons::read(document, primitive, kind, vertices)?;
            let Some(polygons) = polygons else { continue };
            let points = self.positions(document, polygons.vertices)?;
            let part = polygons.part(primitive, &points, self.max_triangles)?;
            self.triangle_count += part.triangles.len();
            if self.triangle_count > self.max_triangles {
                return Err(too_many(primitive, self.max_triangles));
            }
            if !part.triangles.is_empty() {
                parts.push(part);
            }
        }
        Ok(())
    }

    /// Returns the positions of a `<vertices>` element.
    fn positions(
        &mut self,
        document: &ColladaDocument<'a>,
        vertices: XmlElement<'a>,
    ) -> Result<Rc<Vec<[f64; 3]>>, ColladaError> {
        let mut inputs = children(vertices, "input")
            .filter(|input| input.attribute("semantic") == Some("POSITION"));
        let (Some(input), None) = (inputs.next(), inputs.next()) else {
            let message = format!("{} must have one <input> of POSITION", title(vertices));
            return Err(fault(vertices, message));
        };
        let source = document.target(input, "source", "source")?;
        if let Some(known) = self.positions.get(&source.id()) {
            return Ok(Rc::clone(known));
        }
        let accessor = child(source, "technique_common")
            .and_then(|technique| child(technique, "accessor"))
            .ok_or_else(|| fault(source, format!("{} has no <accessor>", title(source))))?;
        let axes = axes(accessor)?;
        let stride = count(accessor, "stride")?.unwrap_or(1);
        let offset = count(accessor, "offset")?.unwrap_or(0);
        let number = count(accessor, "count")?
            .ok_or_else(|| fault(accessor, "<accessor> has no attribute `count`"))?;
        if stride > MAX_STRIDE || axes.iter().any(|axis| *axis >= stride) {
            return Err(fault(accessor, format!("the stride of <accessor> is {stride}")));
        }
        let array = document.target(accessor, "source", "float_array")?;
        let values = match self.arrays.entry(array.id()) {
            Entry::Occupied(known) => Rc::clone(known.get()),
            Entry::Vacant(free) => Rc::clone(free.insert(Rc::new(numbers(array)?))),
        };
        let used = number.checked_mul(stride).and_then(|length| length.checked_add(offset));
        if used.is_none_or(|used| used > values.len()) {
            let message = format!(
                "<accessor> has {number} positions of {stride} numbers from number {offset} on, \
                 and {} has {} numbers",
                title(array),
                values.len()
            );
            return Err(fault(accessor, message));
        }
        self.position_count = self.position_count.saturating_add(number);
        if self.position_count > 3 * self.max_triangles {
            return Err(fault(
                accessor,
                format!("it has more than {} positions", 3 * self.max_triangles),
            ));
        }
        let values = values[offset..].chunks(stride.max(1)).take(number);
        let points = values.map(|tuple| axes.map(|axis| tuple[axis])).collect();
        let points = Rc::new(points);
        self.positions.insert(source.id(), Rc::clone(&points));
        Ok(points)
    }
}

/// Error for a file with more than `max` triangles.
pub(super) fn too_many(element: XmlElement<'_>, max: usize) -> ColladaError {
    fault(element, format!("it shows more than {max} triangles"))
}

fn no_vertices(primitive: XmlElement<'_>) -> ColladaError {
    let message = format!("{} has no <input> of its mesh's <vertices>", title(primitive));
    fault(primitive, message)
}

/// Returns the indices of X, Y and Z in the tuples of an accessor.
fn axes(accessor: XmlElement<'_>) -> Result<[usize; 3], ColladaError> {
    let names: Vec<_> =
        children(accessor, "param").map(|param| param.attribute("name").unwrap_or("")).collect();
    if names.is_empty() && accessor.attribute("stride").map(str::trim) == Some("3") {
        return Ok([0, 1, 2]);
    }
    let at = |axis: &str| {
        names.iter().position(|name| *name == axis).ok_or_else(|| {
            let message = format!("<accessor> of positions has no <param> with the name {axis}");
            fault(accessor, message)
        })
    };
    Ok([at("X")?, at("Y")?, at("Z")?])
}

#[derive(Clone, Copy, PartialEq)]
enum PrimitiveKind {
    Triangles,
    Polylist,
    Polygons,
    Fans,
    Strips,
}

/// Corners of a primitive, as indices of its positions.
struct Polygons<'a> {
    vertices: XmlElement<'a>,
    corners: Vec<usize>,
    /// Number of corners of each polygon, fan or strip.
    lengths: Vec<usize>,
    are_strips: bool,
}

impl<'a> Polygons<'a> {
    /// Reads a primitive; `None` if it has no corners.
    fn read(
        document: &ColladaDocument<'a>,
        primitive: XmlElement<'a>,
        kind: PrimitiveKind,
        vertices: Option<XmlElement<'a>>,
    ) -> Result<Option<Self>, ColladaError> {
        if let Some(hole) = child(primitive, "ph") {
            return Err(fault(hole, "a polygon with holes, <ph>, cannot be read as triangles"));
        }
        let (mut stride, mut offset, mut source) = (0, None, None);
        for input in children(primitive, "input") {
            let at = count(input, "offset")?
                .filter(|at| *at < MAX_STRIDE)
                .ok_or_else(|| fault(input, "<input> has no valid `offset`"))?;
            stride = stride.max(at + 1);
            if input.attribute("semantic") == Some("VERTEX") {
                if offset.replace(at).is_some() {
                    return Err(fault(input, "a primitive has two <input> of VERTEX"));
                }
                source = Some(document.target(input, "source", "vertices")?);
            }
        }
        let mut corners = Vec::new();
        let mut lengths = Vec::new();
        for list in children(primitive, "p") {
            let indices = indices(list)?;
            if stride == 0 || indices.len() % stride != 0 {
                let message =
                    format!("<p> has {} indices, and each corner has {stride}", indices.len());
                return Err(fault(list, message));
            }
            lengths.push(indices.len() / stride);
            let Some(offset) = offset else { return Err(no_vertices(primitive)) };
            corners.extend(indices.chunks(stride).map(|corner| corner[offset]));
        }
        match kind {
            PrimitiveKind::Triangles => {
                if corners.len() % 3 != 0 {
                    let message = format!("<triangles> has {} corners", corners.len());
                    return Err(fault(primitive, message));
                }
                lengths = vec![3; corners.len() / 3];
            }
            PrimitiveKind::Polylist => {
                lengths = child(primitive, "vcount").map(indices).transpose()?.unwrap_or_default();
                let sum = lengths.iter().try_fold(0_usize, |sum, length| sum.checked_add(*length));
                if sum != Some(corners.len()) {
                    let message = format!("<vcount> does not sum up to {} corners", corners.len());
                    return Err(fault(primitive, message));
                }
            }
            PrimitiveKind::Polygons | PrimitiveKind::Fans | PrimitiveKind::Strips => {}
        }
        if let Some(stated) = count(primitive, "count")?
            && stated != lengths.len()
        {
            let message =
                format!("{} states {stated}, and has {}", title(primitive), lengths.len());
            return Err(fault(primitive, message));
        }
        if lengths.iter().all(|length| *length == 0) {
            return Ok(None);
        }
        let source = source.filter(|source| Some(*source) == vertices);
        let source = source.ok_or_else(|| no_vertices(primitive))?;
        let are_strips = kind == PrimitiveKind::Strips;
        Ok(Some(Self { vertices: source, corners, lengths, are_strips }))
    }

    /// Divides the polygons into triangles: a strip by its definition, others as fans, which covers
    /// convex polygons exactly and has the same convex hull for all others.
    fn part(
        &self,
        primitive: XmlElement<'a>,
        points: &[[f64; 3]],
        max_triangles: usize,
    ) -> Result<GeometryPart<'a>, ColladaError> {
        let material = primitive.attribute("material");
        let mut part = GeometryPart { material, ..GeometryPart::default() };
        let mut numbers = HashMap::new();
        let mut rest = self.corners.as_slice();
        for length in &self.lengths {
            let (polygon, behind) = rest.split_at((*length).min(rest.len()));
            rest = behind;
            for last in 2..polygon.len() {
                let corners = match (self.are_strips, last % 2) {
                    (false, _) => [0, last - 1, last],
                    (true, 0) => [last - 2, last - 1, last],
                    (true, _) => [last - 1, last - 2, last],
                };
                if part.triangles.len() == max_triangles {
                    return Err(too_many(primitive, max_triangles));
                }
                let mut triangle = [0; 3];
                for (number, corner) in triangle.iter_mut().zip(corners) {
                    let index = polygon[corner];
                    let point = points.get(index).ok_or_else(|| {
                        let message = format!(
                            "{} has a corner with the index {index}, and its mesh has {} positions",
                            title(primitive),
                            points.len()
                        );
                        fault(primitive, message)
                    })?;
                    *number = *numbers.entry(index).or_insert_with(|| {
                        part.points.push(*point);
                        // At most three for each of `max_triangles`.
                        u32::try_from(part.points.len() - 1).unwrap_or(u32::MAX)
                    });
                }
                part.triangles.push(triangle);
            }
        }
        Ok(part)
    }
}
