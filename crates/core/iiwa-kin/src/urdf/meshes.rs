//! Mesh files that a URDF names, placed in the model's link frames.

use std::collections::HashMap;

use iiwa_json::JsonPlace;
use nalgebra::Isometry3;
use quick_xml::{Reader, events::Event};

use super::{
    UrdfError,
    chain::Chain,
    read::{Description, offset},
    tag::{Tag, TextSpan},
};
use crate::{Pose, Robot};

/// Meshes of a link.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct UrdfLink {
    /// Visual meshes.
    pub visual: Vec<UrdfMesh>,
    /// Collision meshes.
    pub collision: Vec<UrdfMesh>,
}

/// A mesh file named in a URDF.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct UrdfMesh {
    /// File name as written: `package://NAME/...`, `file://...` or a path.
    pub file: String,
    /// Scale factor along each mesh axis.
    pub scale: [f64; 3],
    /// Pose of the mesh in the frame of the model's link.
    pub pose: Pose,
    /// Red, green, blue and opacity, from 0 to 1, if the URDF gives a colour.
    pub rgba: Option<[f64; 4]>,
    /// Place in the URDF.
    pub place: JsonPlace,
}

impl Robot {
    /// Meshes that a URDF of this robot names, for link 0 to link 7.
    ///
    /// The seven axes of the URDF must match the model's; its frames may be anywhere along them,
    /// and the links after its seventh joint need not be the flange. Links fixed to another link
    /// belong to that link. Boxes, cylinders and spheres are left out.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    ///
    /// let robot = Robot::lbr_iiwa_7_r800();
    /// // The exported URDF needs no mesh files.
    /// let links = robot.urdf_meshes(&robot.to_urdf())?;
    /// assert!(links.iter().all(|link| link.visual.is_empty()));
    /// # Ok::<(), iiwa_kin::UrdfError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the text is not a URDF, has no chain of seven revolute joints or several arms, or has an
    /// axis that is off by more than [`UrdfReport::TOLERANCE_M`](crate::UrdfReport::TOLERANCE_M) or
    /// [`UrdfReport::TOLERANCE_RAD`](crate::UrdfReport::TOLERANCE_RAD).
    pub fn urdf_meshes(&self, urdf: &str) -> Result<[UrdfLink; 8], UrdfError> {
        let description = Description::read(urdf)?;
        let chain = description.chain_of_arm()?;
        if let Some(error) = self.misplaced_axis(&chain, 1.0) {
            return Err(error);
        }
        let places = self.places(&description, &chain);
        let mut links: [UrdfLink; 8] = Default::default();
        for MeshReference { link, is_visual, origin, mut mesh } in references(urdf)? {
            let Some((number, frame)) = places.get(link.as_str()) else { continue };
            mesh.pose = pose(&(frame * origin));
            let UrdfLink { visual, collision } = &mut links[*number];
            if is_visual { visual.push(mesh) } else { collision.push(mesh) }
        }
        Ok(links)
    }

    /// Maps each URDF link of the arm to the number of the model's link and its pose in that link's
    /// frame.
    fn places<'a>(
        &self,
        description: &'a Description<'_>,
        chain: &Chain<'a>,
    ) -> HashMap<&'a str, (usize, Isometry3<f64>)> {
        let model = self.link_poses(&[0.0; 7]);
        let revolute = chain.revolute();
        let (axes, _) = chain.poses(&[0.0; 7]);
        let mut places = HashMap::from([(chain.base, (0, Isometry3::identity()))]);
        for (j, joint) in revolute.iter().enumerate() {
            // With all joints at zero, the frame of a joint's child link is the joint frame.
            let frame = model[j + 1].to_isometry().inverse() * axes[j];
            places.insert(&joint.child, (j + 1, frame));
        }
        let mut children: HashMap<&str, Vec<_>> = HashMap::new();
        for joint in description.joints.iter().filter(|joint| joint.is_fixed()) {
            children.entry(&joint.parent).or_default().push(joint);
        }
        let mut open: Vec<&str> = places.keys().copied().collect();
        while let Some(link) = open.pop() {
            let (number, frame) = places[link];
            for joint in children.get(link).into_iter().flatten() {
                places.entry(&joint.child).or_insert_with(|| {
                    open.push(&joint.child);
                    (number, frame * joint.origin)
                });
            }
        }
        places
    }
}

/// A mesh in the URDF link that it belongs to.
struct MeshReference {
    link: String,
    is_visual: bool,
    origin: Isometry3<f64>,
    /// The mesh, whose pose is not known yet.
    mesh: UrdfMesh,
}

/// A colour, or the name of a colour.
enum Colour {
    Of([f64; 4]),
    Named(String),
}

/// A visual or collision element that is being read.
struct MeshDraft {
    is_visual: bool,
    origin: Isometry3<f64>,
    colour: Option<Colour>,
    mesh: Option<UrdfMesh>,
}

/// Place of the previous mesh, from which lines are counted on. Counting from the start of the text
/// would take time per mesh in proportion to the file length.
struct LineCounter(JsonPlace);

impl LineCounter {
    /// The place `span`, which is not before the previous one.
    fn next(&mut self, span: TextSpan<'_>) -> JsonPlace {
        let from = self.0.span.start;
        let mut place = JsonPlace::of_span(&span.text[from..], span.start - from..span.end - from);
        if place.line == 1 {
            place.column += self.0.column - 1;
        }
        place.line += self.0.line - 1;
        place.span = place.span.start + from..place.span.end + from;
        self.0 = place.clone();
        place
    }
}

/// Nesting depth of a mesh: robot, link, visual and geometry. Deeper elements are skipped, so that
/// the time per element does not grow with the depth.
const MESH_DEPTH: usize = 4;

/// All meshes of a URDF, in file order. The text is well-formed, as it was read before.
fn references(text: &str) -> Result<Vec<MeshReference>, UrdfError> {
    let mut reader = Reader::from_str(text);
    // Names of the open elements, without the outermost, that can contain relevant elements.
    let mut open: Vec<Vec<u8>> = Vec::new();
    let mut depth = 0_usize;
    let mut quaternions = false;
    let mut link = String::new();
    let mut draft: Option<MeshDraft> = None;
    let mut material = None;
    let mut colours: HashMap<String, [f64; 4]> = HashMap::new();
    let mut lines = LineCounter(JsonPlace { line: 1, column: 1, span: 0..0 });
    let mut all: Vec<(MeshReference, Option<Colour>)> = Vec::new();
    loop {
        let start = offset(reader.buffer_position());
        let (element, is_open) = match reader.read_event() {
            Ok(Event::Start(element)) => (element, true),
            Ok(Event::Empty(element)) => (element, false),
            Ok(Event::End(_)) => {
                depth = depth.saturating_sub(1);
                open.truncate(depth.saturating_sub(1));
                if depth == 2
                    && let Some(MeshDraft { is_visual, origin, colour, mesh: Some(mesh) }) =
                        draft.take()
                {
                    all.push((
                        MeshReference { link: link.clone(), is_visual, origin, mesh },
                        colour,
                    ));
                }
                continue;
            }
            Ok(Event::Eof) | Err(_) => break,
            Ok(_) => continue,
        };
        if depth > MESH_DEPTH {
            depth += usize::from(is_open);
            continue;
        }
        let span = TextSpan { text, start, end: offset(reader.buffer_position()) };
        let tag = Tag { element: &element, span };
        let name = element.name().as_ref().to_vec();
        let path: Vec<&[u8]> = open.iter().map(Vec::as_slice).chain([name.as_slice()]).collect();
        match (path.as_slice(), &mut draft) {
            _ if depth == 0 => {
                quaternions = tag.attribute("version")?.is_some_and(|v| v.trim() != "1.0");
            }
            ([b"link"], _) => link = tag.required("name", "a link")?,
            ([b"link", kind @ (b"visual" | b"collision")], _) => {
                draft = Some(MeshDraft {
                    is_visual: *kind == b"visual",
                    origin: Isometry3::identity(),
                    colour: None,
                    mesh: None,
                });
            }
            ([b"link", _, b"origin"], Some(draft)) => draft.origin = tag.origin(quaternions)?,
            ([b"link", _, b"geometry", b"mesh"], Some(draft)) => {
                draft.mesh = Some(UrdfMesh {
                    file: tag.required("filename", &format!("a mesh of link {link:?}"))?,
                    scale: tag.numbers("scale")?.unwrap_or([1.0; 3]),
                    pose: Pose::IDENTITY,
                    rgba: None,
                    place: lines.next(span),
                });
            }
            ([b"link", _, b"material"], Some(draft)) => {
                draft.colour = tag.attribute("name")?.map(Colour::Named);
                material = tag.attribute("name")?;
            }
            ([b"material"], _) => material = tag.attribute("name")?,
            ([b"link", _, b"material", b"color"], Some(draft)) => {
                if let Some(rgba) = tag.numbers("rgba")? {
                    draft.colour = Some(Colour::Of(rgba));
                    material.take().map(|name| colours.insert(name, rgba));
                }
            }
            ([b"material", b"color"], _) => {
                if let (Some(name), Some(rgba)) = (material.take(), tag.numbers("rgba")?) {
                    colours.insert(name, rgba);
                }
            }
            _ => {}
        }
        if is_open {
            if depth > 0 {
                open.push(name);
            }
            depth += 1;
        }
    }
    // A colour may be defined after its use.
    Ok(all
        .into_iter()
        .map(|(mut reference, colour)| {
            reference.mesh.rgba = colour.and_then(|colour| match colour {
                Colour::Of(rgba) => Some(rgba),
                Colour::Named(name) => colours.get(&name).copied(),
            });
            reference
        })
        .collect())
}

fn pose(frame: &Isometry3<f64>) -> Pose {
    let rotation = frame.rotation.to_rotation_matrix();
    Pose {
        position_m: frame.translation.vector.into(),
        rotation: std::array::from_fn(|i| std::array::from_fn(|j| rotation[(i, j)])),
    }
}
