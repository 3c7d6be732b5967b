//! URDF export of a model.

use std::{
    f64::consts::FRAC_PI_2,
    fmt::Display,
    io::{self, Write as _},
};

use quick_xml::{
    ElementWriter, Writer,
    events::{BytesDecl, BytesText, Event},
};

use super::{LIMITS, RosNames};
use crate::{Along, RigidBody, Robot, Shape, Solid, inertials::Links, shapes};

/// XML writer to memory, whose writes do not fail.
type Xml = Writer<Vec<u8>>;

impl Robot {
    /// Writes the model as a URDF: links `iiwa_link_0` to `iiwa_link_7` and `iiwa_link_ee`, joints
    /// `iiwa_joint_1` to `iiwa_joint_7` and `iiwa_joint_ee`; m, rad, kg, Nm.
    ///
    /// Link frames are those of [`Robot::link_poses`]. Shapes are cylinders and spheres, so that no
    /// mesh files are needed. Inertias are those of [`Robot::links`], with the flange mass added to
    /// link 7; the base inertia is an estimate from its shapes at uniform density.
    ///
    /// Cross-validated: the crate `k` computes the same poses from the URDF.
    #[must_use]
    pub fn to_urdf(&self) -> String {
        self.to_urdf_with_names(&RosNames::default())
    }

    /// Writes the URDF with other joint and link names. The fixed joint of the flange is
    /// `iiwa_joint_ee` with the prefix of the names, such as `lbr_joint_ee`.
    #[must_use]
    pub fn to_urdf_with_names(&self, names: &RosNames) -> String {
        let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
        let _ = self.write_urdf(&mut xml, names);
        String::from_utf8_lossy(&xml.into_inner()).into_owned()
    }

    fn write_urdf(&self, xml: &mut Xml, names: &RosNames) -> io::Result<()> {
        xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
        element(xml, "robot", &[("name", &self.name())], |xml| {
            xml.write_event(Event::Comment(BytesText::from_escaped(self.inertias_note())))?;
            let (links, joints) = (names.links(), names.joints());
            let shapes = self.link_shapes();
            let foot = shapes::body(&shapes[0], self.base_mass_kg);
            let bodies = [foot].into_iter().chain(self.carried_links());
            for ((shapes, name), body) in shapes.iter().zip(&links).zip(bodies) {
                element(xml, "link", &[("name", name)], |xml| {
                    write_inertial(xml, &body)?;
                    shapes.iter().try_for_each(|shape| write_shape(xml, "visual", shape))?;
                    shapes.iter().try_for_each(|shape| write_shape(xml, "collision", shape))
                })?;
            }
            empty(xml, "link", &[("name", &links[8])])?;
            let joints = joints.into_iter().chain([names.flange_joint()]);
            joints.zip(links.windows(2)).enumerate().try_for_each(|(j, (name, links))| {
                self.write_joint(xml, j, &name, [&links[0], &links[1]])
            })
        })?;
        writeln!(xml.get_mut())
    }

    fn inertias_note(&self) -> &'static str {
        match self.links {
            Links::Known(_) => {
                " The foot's inertia is an estimate: primitive shapes of uniform density. "
            }
            Links::Masses(_) => " Inertias are estimates: primitive shapes of uniform density. ",
        }
    }

    /// Writes joint `j` (from 0) between two links: the seven joints, then the fixed joint of the
    /// flange.
    fn write_joint(
        &self,
        xml: &mut Xml,
        j: usize,
        name: &str,
        [parent, child]: [&str; 2],
    ) -> io::Result<()> {
        let dh = self.dh();
        let moves = j < 7;
        let kind = if moves { "revolute" } else { "fixed" };
        // Offset from the preceding joint: that joint's row of the table.
        let (shift_m, twist_rad) =
            j.checked_sub(1).map_or((0.0, 0.0), |before| (dh[before].d_m, dh[before].alpha_rad));
        element(xml, "joint", &[("name", &name), ("type", &kind)], |xml| {
            write_origin(xml, [0.0, 0.0, shift_m], twist_rad)?;
            empty(xml, "parent", &[("link", &parent)])?;
            empty(xml, "child", &[("link", &child)])?;
            if !moves {
                return Ok(());
            }
            empty(xml, "axis", &[("xyz", &"0 0 1")])?;
            let limits = self.limits().of_urdf(j);
            let limits: [_; 4] = std::array::from_fn(|i| (LIMITS[i], &limits[i] as &dyn Display));
            empty(xml, "limit", &limits)
        })
    }
}

fn write_shape(xml: &mut Xml, role: &str, shape: &Shape) -> io::Result<()> {
    element(xml, role, &[], |xml| {
        let twist_rad = match shape.solid {
            Solid::Cylinder { along: Along::Y, .. } => FRAC_PI_2,
            _ => 0.0,
        };
        write_origin(xml, shape.center_m, twist_rad)?;
        element(xml, "geometry", &[], |xml| match shape.solid {
            Solid::Cylinder { radius_m, length_m, .. } => {
                empty(xml, "cylinder", &[("radius", &radius_m), ("length", &length_m)])
            }
            Solid::Sphere { radius_m } => empty(xml, "sphere", &[("radius", &radius_m)]),
        })?;
        if role != "visual" {
            return Ok(());
        }
        element(xml, "material", &[("name", &shape.paint.name)], |xml| {
            empty(xml, "color", &[("rgba", &shape.paint.rgba)])
        })
    })
}

/// Attributes of an inertia, in the order of [`RigidBody`].
const INERTIA: [&str; 6] = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];

fn write_inertial(xml: &mut Xml, body: &RigidBody) -> io::Result<()> {
    element(xml, "inertial", &[], |xml| {
        write_origin(xml, body.center_m, 0.0)?;
        empty(xml, "mass", &[("value", &body.mass_kg)])?;
        let tensor: [_; 6] =
            std::array::from_fn(|i| (INERTIA[i], &body.inertia_kg_m2[i] as &dyn Display));
        empty(xml, "inertia", &tensor)
    })
}

/// Writes an origin with a rotation about x by `twist_rad`.
fn write_origin(xml: &mut Xml, xyz_m: [f64; 3], twist_rad: f64) -> io::Result<()> {
    // Adding 0 turns -0 into 0.
    let [x, y, z] = xyz_m.map(|v| v + 0.0);
    let (xyz, rpy) = (format_args!("{x} {y} {z}"), format_args!("{twist_rad} 0 0"));
    empty(xml, "origin", &[("xyz", &xyz), ("rpy", &rpy)])
}

type Attributes<'a> = &'a [(&'a str, &'a dyn Display)];

fn element(
    xml: &mut Xml,
    name: &str,
    attributes: Attributes<'_>,
    content: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    start(xml, name, attributes).write_inner_content(content).map(|_| ())
}

fn empty(xml: &mut Xml, name: &str, attributes: Attributes<'_>) -> io::Result<()> {
    start(xml, name, attributes).write_empty().map(|_| ())
}

fn start<'a>(
    xml: &'a mut Xml,
    name: &'a str,
    attributes: Attributes<'_>,
) -> ElementWriter<'a, Vec<u8>> {
    attributes.iter().fold(xml.create_element(name), |element, (key, value)| {
        element.with_attribute((*key, value.to_string().as_str()))
    })
}
