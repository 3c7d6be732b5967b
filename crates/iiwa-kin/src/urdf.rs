//! URDF, the robot description of ROS: a model written as one, and a user's held against a model.

use std::{
    collections::{HashMap, HashSet},
    f64::consts::{FRAC_PI_2, PI},
    fmt, io,
};

use nalgebra::{Isometry3, Matrix3, Quaternion, Translation3, Unit, UnitQuaternion, Vector3};
use quick_xml::{
    Reader, Writer,
    events::{BytesDecl, BytesStart, BytesText, Event},
};

use crate::{Joints, Robot, json::Place};

// ---- Out ----------------------------------------------------------------------------------------

impl Robot {
    /// The model as a URDF: links `iiwa_link_0` to `iiwa_link_7` and `iiwa_link_ee`, joints
    /// `iiwa_joint_1` to `iiwa_joint_7` and `iiwa_joint_ee`; m, rad, kg, Nm.
    ///
    /// The links' frames are those of [`Robot::link_poses`]. The shapes are cylinders and spheres,
    /// so that the text needs no mesh files. Each link has its mass; centre and inertia are
    /// estimates, those of its shapes at uniform density.
    ///
    /// Cross-validated: the crate `k` finds the same poses in it.
    #[must_use]
    pub fn to_urdf(&self) -> String {
        let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
        // Writing to memory does not fail.
        let _ = self.write_urdf(&mut xml);
        let mut text = String::from_utf8_lossy(&xml.into_inner()).into_owned();
        text.push('\n');
        text
    }

    fn write_urdf(&self, xml: &mut Xml) -> io::Result<()> {
        xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
        let robot = xml.create_element("robot").with_attribute(("name", self.name()));
        robot.write_inner_content(|xml| {
            let note = " Inertias are estimates: primitive shapes of uniform density. ";
            xml.write_event(Event::Comment(BytesText::from_escaped(note)))?;
            let shapes = self.shapes();
            for (link, (shapes, mass_kg)) in shapes.iter().zip(self.link_mass_kg()).enumerate() {
                let element = xml
                    .create_element("link")
                    .with_attribute(("name", format!("iiwa_link_{link}").as_str()));
                element.write_inner_content(|xml| {
                    write_inertial(xml, shapes, *mass_kg)?;
                    shapes.iter().try_for_each(|shape| shape.write(xml, "visual"))?;
                    shapes.iter().try_for_each(|shape| shape.write(xml, "collision"))
                })?;
            }
            empty(xml, "link", &[("name", "iiwa_link_ee")])?;
            let (mut shift_m, mut twist_rad) = (0.0, 0.0);
            for (joint, row) in self.dh().iter().enumerate() {
                self.write_joint(xml, joint, shift_m, twist_rad)?;
                (shift_m, twist_rad) = (row.d_m, row.alpha_rad);
            }
            let last = [("name", "iiwa_joint_ee"), ("type", "fixed")];
            let last = xml.create_element("joint").with_attributes(last);
            last.write_inner_content(|xml| {
                write_origin(xml, [0.0, 0.0, shift_m], twist_rad)?;
                empty(xml, "parent", &[("link", "iiwa_link_7")])?;
                empty(xml, "child", &[("link", "iiwa_link_ee")])
            })?;
            Ok(())
        })?;
        Ok(())
    }

    fn write_joint(
        &self,
        xml: &mut Xml,
        joint: usize,
        shift_m: f64,
        twist_rad: f64,
    ) -> io::Result<()> {
        let limits = self.limits();
        let name = format!("iiwa_joint_{}", joint + 1);
        let element = xml
            .create_element("joint")
            .with_attributes([("name", name.as_str()), ("type", "revolute")]);
        element.write_inner_content(|xml| {
            write_origin(xml, [0.0, 0.0, shift_m], twist_rad)?;
            empty(xml, "parent", &[("link", &format!("iiwa_link_{joint}"))])?;
            empty(xml, "child", &[("link", &format!("iiwa_link_{}", joint + 1))])?;
            empty(xml, "axis", &[("xyz", "0 0 1")])?;
            empty(
                xml,
                "limit",
                &[
                    ("lower", &(-limits.position_rad[joint]).to_string()),
                    ("upper", &limits.position_rad[joint].to_string()),
                    ("effort", &limits.torque_nm[joint].to_string()),
                    ("velocity", &limits.velocity_rad_s[joint].to_string()),
                ],
            )
        })?;
        Ok(())
    }

    /// Shapes of link 0 to link 7, each in its link's frame.
    ///
    /// A limb is cut in two where the iiwa's joint 1, 3, 5 or 7 cuts it. The frames lie at both
    /// ends of the base (links 0 and 1: foot; 2 and 3: shoulder; 4 and 5: elbow; 6 and 7: wrist);
    /// the z axis of an odd link runs up its limb, that of an even link across it.
    fn shapes(&self) -> [Vec<Shape>; 8] {
        let [base, upper_arm, forearm, flange] = self.offsets();
        let (base_cut, upper_cut) = (0.45 * base, 0.5 * upper_arm);
        let (fore_cut, flange_cut) = (0.5 * forearm, 0.55 * flange);
        let limb = |radius, from, to| Shape::cylinder(Along::Z, radius, from, to, SILVER);
        let half_limb = |radius, to| Shape::cylinder(Along::Y, radius, 0.0, to, SILVER);
        let ring = |radius, at: f64, width| {
            Shape::cylinder(Along::Z, radius, at - width / 2.0, at + width / 2.0, ORANGE)
        };
        let hub = |radius, half_width: f64| {
            Shape::cylinder(Along::Z, radius, -half_width, half_width, ORANGE)
        };
        let ball = |radius, at| Shape::sphere(radius, at, SILVER);
        [
            vec![
                Shape::cylinder(Along::Z, 0.115, 0.0, 0.2 * base, GRAPHITE),
                limb(0.09, 0.2 * base, base_cut),
            ],
            vec![ring(0.087, base_cut, 0.02), limb(0.08, base_cut, base), ball(0.082, base)],
            // The upper arm runs along -y.
            vec![hub(0.074, 0.096), half_limb(0.076, -upper_cut)],
            vec![
                ring(0.081, upper_cut, 0.02),
                limb(0.072, upper_cut, upper_arm),
                ball(0.077, upper_arm),
            ],
            // The forearm runs along +y.
            vec![hub(0.07, 0.09), half_limb(0.07, fore_cut)],
            vec![ring(0.075, fore_cut, 0.02), limb(0.058, fore_cut, forearm), ball(0.064, forearm)],
            // The flange lies along -y.
            vec![hub(0.058, 0.075), half_limb(0.054, -flange_cut)],
            vec![
                ring(0.051, flange_cut, 0.01),
                Shape::cylinder(Along::Z, 0.045, flange_cut, flange, GRAPHITE),
            ],
        ]
    }
}

type Xml = Writer<Vec<u8>>;

/// A primitive shape in its link's frame, in m.
struct Shape {
    solid: Solid,
    center: [f64; 3],
    paint: Paint,
}

enum Solid {
    Cylinder { along: Along, radius: f64, length: f64 },
    Sphere { radius: f64 },
}

#[derive(Clone, Copy, PartialEq)]
enum Along {
    Y,
    Z,
}

/// A colour and its name.
#[derive(Clone, Copy)]
struct Paint {
    name: &'static str,
    rgba: &'static str,
}

const SILVER: Paint = Paint { name: "iiwa_silver", rgba: "0.78 0.79 0.8 1" };
const ORANGE: Paint = Paint { name: "iiwa_orange", rgba: "0.95 0.42 0.08 1" };
const GRAPHITE: Paint = Paint { name: "iiwa_graphite", rgba: "0.3 0.31 0.33 1" };

impl Shape {
    fn cylinder(along: Along, radius: f64, from: f64, to: f64, paint: Paint) -> Self {
        let middle = f64::midpoint(from, to);
        let center = match along {
            Along::Y => [0.0, middle, 0.0],
            Along::Z => [0.0, 0.0, middle],
        };
        Self { solid: Solid::Cylinder { along, radius, length: (to - from).abs() }, center, paint }
    }

    fn sphere(radius: f64, height: f64, paint: Paint) -> Self {
        Self { solid: Solid::Sphere { radius }, center: [0.0, 0.0, height], paint }
    }

    /// Volume in m^3.
    fn volume(&self) -> f64 {
        match self.solid {
            Solid::Cylinder { radius, length, .. } => PI * radius * radius * length,
            Solid::Sphere { radius } => 4.0 / 3.0 * PI * radius.powi(3),
        }
    }

    /// Moments of inertia about its own centre, divided by the mass, in m^2.
    fn inertia_per_kg(&self) -> [f64; 3] {
        match self.solid {
            Solid::Cylinder { along, radius, length } => {
                let spin = radius * radius / 2.0;
                let tilt = (3.0 * radius * radius + length * length) / 12.0;
                match along {
                    Along::Y => [tilt, spin, tilt],
                    Along::Z => [tilt, tilt, spin],
                }
            }
            Solid::Sphere { radius } => [0.4 * radius * radius; 3],
        }
    }

    fn write(&self, xml: &mut Xml, role: &str) -> io::Result<()> {
        let element = xml.create_element(role);
        element.write_inner_content(|xml| {
            let quarters = match self.solid {
                Solid::Cylinder { along: Along::Y, .. } => 1.0,
                _ => 0.0,
            };
            write_origin(xml, self.center, quarters * FRAC_PI_2)?;
            xml.create_element("geometry").write_inner_content(|xml| match self.solid {
                Solid::Cylinder { radius, length, .. } => empty(
                    xml,
                    "cylinder",
                    &[("radius", &radius.to_string()), ("length", &length.to_string())],
                ),
                Solid::Sphere { radius } => {
                    empty(xml, "sphere", &[("radius", &radius.to_string())])
                }
            })?;
            if role == "visual" {
                let material =
                    xml.create_element("material").with_attribute(("name", self.paint.name));
                material
                    .write_inner_content(|xml| empty(xml, "color", &[("rgba", self.paint.rgba)]))?;
            }
            Ok(())
        })?;
        Ok(())
    }
}

/// Mass, centre and inertia tensor of `shapes` at uniform density; where two of them overlap, both
/// count.
fn write_inertial(xml: &mut Xml, shapes: &[Shape], mass_kg: f64) -> io::Result<()> {
    let volume: f64 = shapes.iter().map(Shape::volume).sum();
    let share = |shape: &Shape| shape.volume() / volume;
    let center = shapes
        .iter()
        .fold(Vector3::zeros(), |sum, shape| sum + Vector3::from(shape.center) * share(shape));
    let mut inertia = Matrix3::zeros();
    for shape in shapes {
        let arm = Vector3::from(shape.center) - center;
        let steiner = Matrix3::from_diagonal_element(arm.norm_squared()) - arm * arm.transpose();
        let own = Matrix3::from_diagonal(&Vector3::from(shape.inertia_per_kg()));
        inertia += (own + steiner) * (share(shape) * mass_kg);
    }
    xml.create_element("inertial").write_inner_content(|xml| {
        write_origin(xml, center.into(), 0.0)?;
        empty(xml, "mass", &[("value", &mass_kg.to_string())])?;
        empty(
            xml,
            "inertia",
            &[
                ("ixx", &inertia[(0, 0)].to_string()),
                ("ixy", &inertia[(0, 1)].to_string()),
                ("ixz", &inertia[(0, 2)].to_string()),
                ("iyy", &inertia[(1, 1)].to_string()),
                ("iyz", &inertia[(1, 2)].to_string()),
                ("izz", &inertia[(2, 2)].to_string()),
            ],
        )
    })?;
    Ok(())
}

/// An origin that is turned about x by `twist_rad` only.
fn write_origin(xml: &mut Xml, xyz_m: [f64; 3], twist_rad: f64) -> io::Result<()> {
    let [x, y, z] = xyz_m.map(|v| v + 0.0);
    empty(xml, "origin", &[("xyz", &format!("{x} {y} {z}")), ("rpy", &format!("{twist_rad} 0 0"))])
}

fn empty(xml: &mut Xml, name: &str, attributes: &[(&str, &str)]) -> io::Result<()> {
    xml.create_element(name).with_attributes(attributes.iter().copied()).write_empty()?;
    Ok(())
}

// ---- In -----------------------------------------------------------------------------------------

/// How a URDF compares with a model: what [`Robot::check_urdf`] found.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct UrdfReport {
    /// The link that joint 1 stands on; it is taken as the model's base.
    pub base: String,
    /// The link that is taken as the model's flange.
    pub tip: String,
    /// Names of the seven joints, from the base on.
    pub joints: [String; 7],
    /// On how many poses the two were compared.
    pub poses: usize,
    /// The largest distance between the two flanges, in m.
    pub position_deviation_m: f64,
    /// The largest angle between the two flanges, in rad.
    pub rotation_deviation_rad: f64,
    /// Limits that differ by more than a thousandth.
    pub limits: Vec<LimitDifference>,
}

impl UrdfReport {
    /// How far the flanges may be apart, in m: the iiwa's repeatability (KUKA data sheet). A URDF
    /// that has its quarter turns as 1.5708 stays below it.
    pub const TOLERANCE_M: f64 = 1e-4;

    /// How far the flanges may be turned, in rad.
    pub const TOLERANCE_RAD: f64 = 1e-4;
}

/// A joint's limit that a URDF has another figure for.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LimitDifference {
    /// The joint, from 1.
    pub joint: usize,
    /// Which limit, as the URDF calls it: `lower` (rad), `upper` (rad), `effort` (Nm) or
    /// `velocity` (rad/s).
    pub limit: &'static str,
    /// The URDF's figure, if it has one.
    pub urdf: Option<f64>,
    /// The model's figure.
    pub model: f64,
}

/// Why a URDF is not a description of a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UrdfError {
    /// The text is not well-formed XML.
    #[error("this is not XML: {problem}, at {at}")]
    Xml {
        /// Where.
        at: Place,
        /// What the parser says.
        problem: String,
    },
    /// The text is XML, but not a URDF.
    #[error("the outermost element is <{found}>; a URDF has <robot>, at {at}")]
    NotUrdf {
        /// Where.
        at: Place,
        /// The element found.
        found: String,
    },
    /// An element or an attribute is missing.
    #[error("{owner} has no {missing}, at {at}")]
    Missing {
        /// Where.
        at: Place,
        /// The link or joint.
        owner: String,
        /// What it should have.
        missing: &'static str,
    },
    /// Something that there may be one of is there again.
    #[error("{owner} is here for the second time; remove one, at {at}")]
    Duplicate {
        /// Where the second one is.
        at: Place,
        /// What there are two of.
        owner: String,
    },
    /// An attribute is not made of as many numbers as it must be.
    #[error("{attribute} is {found:?}; it must be {} finite number{}{}, at {at}",
        expected, if *expected == 1 { "" } else { "s" },
        if found.contains("${") { " (expand the xacro file first)" } else { "" })]
    Numbers {
        /// Where.
        at: Place,
        /// The attribute.
        attribute: String,
        /// Its text.
        found: String,
        /// How many numbers it must have.
        expected: usize,
    },
    /// A joint's axis has no direction.
    #[error("joint {joint:?} turns about the axis 0 0 0; give it a direction, at {at}")]
    ZeroAxis {
        /// Where.
        at: Place,
        /// The joint.
        joint: String,
    },
    /// A joint names a link that the file does not have.
    #[error("joint {joint:?} names the link {link:?}, which the file does not have, at {at}")]
    UnknownLink {
        /// Where.
        at: Place,
        /// The joint.
        joint: String,
        /// The link.
        link: String,
    },
    /// Two joints carry the same link.
    #[error("joint {joint:?} carries link {link:?}, as another joint does already, at {at}")]
    SecondParent {
        /// Where.
        at: Place,
        /// The second joint.
        joint: String,
        /// The link.
        link: String,
    },
    /// A link is, over some joints, its own parent.
    #[error("the joints above link {link:?} run in a circle, at {at}")]
    Cycle {
        /// Where.
        at: Place,
        /// A link of the circle, or below it.
        link: String,
    },
    /// The tip asked for is not a link of the file.
    #[error("no link is called {tip:?}; choose one of {links}, at {at}")]
    UnknownTip {
        /// Where.
        at: Place,
        /// The tip asked for.
        tip: String,
        /// The links there are.
        links: Listed,
    },
    /// No tip was asked for and several links could be it.
    #[error("these links all end a chain of seven joints: {links}; name one as the tip, at {at}")]
    AmbiguousTip {
        /// Where.
        at: Place,
        /// The links.
        links: Listed,
    },
    /// The chain does not have seven revolute joints.
    #[error("the chain up to link {tip:?} has {found} revolute joints; the iiwa has 7, at {at}")]
    JointCount {
        /// Where.
        at: Place,
        /// The end of the chain.
        tip: String,
        /// How many revolute joints it has.
        found: usize,
    },
    /// A joint of the chain is neither revolute nor fixed, or mimics another.
    #[error("joint {joint:?} is {found}; the iiwa's joints are revolute or fixed, at {at}")]
    JointKind {
        /// Where.
        at: Place,
        /// The joint.
        joint: String,
        /// Its type, or `mimic`.
        found: String,
    },
    /// An axis is not where the model has it.
    #[error(
        "with all joints at zero, the axis of joint {number} ({joint:?}) is {:.3} mm and {:.4} deg \
         off the model's; compare its origin and the one before it with the model's lengths, at \
         {at}",
        position_m * 1e3, rotation_rad.to_degrees()
    )]
    Axis {
        /// Where: the joint.
        at: Place,
        /// The first joint whose axis is off, from 1.
        number: usize,
        /// Its name.
        joint: String,
        /// Distance of the two axes, in m.
        position_m: f64,
        /// Angle between the two axes, in rad.
        rotation_rad: f64,
    },
    /// The axes are where the model has them, the tip is not.
    #[error(
        "the seven axes are the model's, but link {tip:?} is {:.3} mm and {:.4} deg off the \
         flange; name another tip or set the model's flange length, at {at}",
        position_m * 1e3, rotation_rad.to_degrees()
    )]
    Tip {
        /// Where: the last joint of the chain.
        at: Place,
        /// The tip.
        tip: String,
        /// The largest distance from the model's flange, in m.
        position_m: f64,
        /// The largest angle to the model's flange, in rad.
        rotation_rad: f64,
    },
}

impl UrdfError {
    /// Where in the text.
    #[must_use]
    pub fn place(&self) -> &Place {
        match self {
            Self::Xml { at, .. }
            | Self::NotUrdf { at, .. }
            | Self::Missing { at, .. }
            | Self::Duplicate { at, .. }
            | Self::Numbers { at, .. }
            | Self::ZeroAxis { at, .. }
            | Self::UnknownLink { at, .. }
            | Self::SecondParent { at, .. }
            | Self::Cycle { at, .. }
            | Self::UnknownTip { at, .. }
            | Self::AmbiguousTip { at, .. }
            | Self::JointCount { at, .. }
            | Self::JointKind { at, .. }
            | Self::Axis { at, .. }
            | Self::Tip { at, .. } => at,
        }
    }

    /// What is wrong, without the place.
    #[must_use]
    pub fn what(&self) -> String {
        let message = self.to_string();
        let place = format!(", at {}", self.place());
        message.strip_suffix(&place).unwrap_or(&message).to_owned()
    }
}

/// Names in a message; the first dozen are shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listed(pub Vec<String>);

impl fmt::Display for Listed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHOWN: usize = 12;
        let shown = self.0.len().min(SHOWN);
        f.write_str(&self.0[..shown].join(", "))?;
        if self.0.len() > SHOWN {
            write!(f, " and {} more", self.0.len() - SHOWN)?;
        }
        Ok(())
    }
}

impl Robot {
    /// Holds a URDF against this model: same axes, same flange, same limits.
    ///
    /// The chain runs from the link that joint 1 stands on (what is below it is the mounting) to
    /// `tip`, or without one to the end of the fixed joints behind joint 7. Its frames may lie
    /// anywhere along their axes. Base and tip must be the model's base and flange.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    ///
    /// let robot = Robot::lbr_iiwa_7_r800();
    /// let report = robot.check_urdf(&robot.to_urdf(), None)?;
    /// assert_eq!(report.tip, "iiwa_link_ee");
    /// assert!(report.position_deviation_m < 1e-12);
    /// # Ok::<(), iiwa_kin::UrdfError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the text is no URDF, has no such chain of seven revolute joints, or if the two flanges
    /// are apart by more than [`UrdfReport::TOLERANCE_M`] or [`UrdfReport::TOLERANCE_RAD`]; the
    /// error then names the first joint that is off. Limits that differ are not an error.
    pub fn check_urdf(&self, urdf: &str, tip: Option<&str>) -> Result<UrdfReport, UrdfError> {
        let description = Description::read(urdf)?;
        let chain = description.chain(tip)?;
        let zero = [0.0; 7];
        let mut largest = self.deviation(&chain, &zero);
        for pose in 1..POSES {
            let found = self.deviation(&chain, &self.test_pose(pose));
            largest = (largest.0.max(found.0), largest.1.max(found.1));
        }
        let (position_m, rotation_rad) = largest;
        if position_m > UrdfReport::TOLERANCE_M || rotation_rad > UrdfReport::TOLERANCE_RAD {
            return Err(self.culprit(&description, &chain, position_m, rotation_rad));
        }
        Ok(UrdfReport {
            base: chain.base.to_owned(),
            tip: chain.tip.to_owned(),
            joints: chain.revolute().map(|joint| joint.name.clone()),
            poses: POSES,
            position_deviation_m: position_m,
            rotation_deviation_rad: rotation_rad,
            limits: self.limit_differences(&chain),
        })
    }

    /// Distance (m) and angle (rad) between the flanges of model and URDF.
    fn deviation(&self, chain: &Chain<'_>, joints_rad: &Joints) -> (f64, f64) {
        let model = self.tcp(joints_rad);
        let (_, tip) = chain.poses(joints_rad);
        let distance = (tip.translation.vector - Vector3::from(model.position_m)).norm();
        let apart = tip.rotation.to_rotation_matrix().into_inner() - model.rotation_matrix();
        // Unlike the arc cosine of a trace, exact for small angles.
        let angle = 2.0 * (apart.norm() / 8.0_f64.sqrt()).min(1.0).asin();
        (finite(distance), finite(angle))
    }

    /// Pose `index` of a fixed sequence that fills the joints' range evenly.
    fn test_pose(&self, index: usize) -> Joints {
        // Multiples of the square roots of primes, each wrapped around.
        const PRIMES: Joints = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0];
        std::array::from_fn(|j| {
            let share = (index as f64 * PRIMES[j].sqrt()).fract();
            (2.0 * share - 1.0) * self.limits().position_rad[j]
        })
    }

    /// The first axis that is off, or the tip.
    ///
    /// A chain is given by its axes at the zero pose and its tip there (the product of
    /// exponentials), wherever its frames lie.
    fn culprit(
        &self,
        description: &Description<'_>,
        chain: &Chain<'_>,
        position_m: f64,
        rotation_rad: f64,
    ) -> UrdfError {
        // Small deviations add up: the first joint's share is below the whole.
        const SHARE: f64 = 0.1;
        let model = self.link_poses(&[0.0; 7]);
        let (axes, _) = chain.poses(&[0.0; 7]);
        for (j, joint) in chain.revolute().into_iter().enumerate() {
            let rotation = model[j + 1].rotation_matrix();
            let expected = rotation.column(2).into_owned();
            let found = axes[j].rotation * joint.axis;
            let shift = axes[j].translation.vector - Vector3::from(model[j + 1].position_m);
            let distance = finite((shift - expected * shift.dot(&expected)).norm());
            let angle = finite(found.cross(&expected).norm().atan2(found.dot(&expected)));
            if distance > SHARE * UrdfReport::TOLERANCE_M
                || angle > SHARE * UrdfReport::TOLERANCE_RAD
            {
                return UrdfError::Axis {
                    at: joint.at.place(),
                    number: j + 1,
                    joint: joint.name.clone(),
                    position_m: distance,
                    rotation_rad: angle,
                };
            }
        }
        UrdfError::Tip {
            at: chain.joints.last().map_or(description.at, |last| last.at).place(),
            tip: chain.tip.to_owned(),
            position_m,
            rotation_rad,
        }
    }

    fn limit_differences(&self, chain: &Chain<'_>) -> Vec<LimitDifference> {
        let limits = self.limits();
        let mut differences = Vec::new();
        for (j, joint) in chain.revolute().into_iter().enumerate() {
            let model = [
                -limits.position_rad[j],
                limits.position_rad[j],
                limits.torque_nm[j],
                limits.velocity_rad_s[j],
            ];
            for ((limit, urdf), model) in LIMITS.into_iter().zip(joint.limits).zip(model) {
                let same = urdf.is_some_and(|urdf| (urdf - model).abs() <= 1e-3 * model.abs());
                if !same {
                    differences.push(LimitDifference { joint: j + 1, limit, urdf, model });
                }
            }
        }
        differences
    }
}

/// Poses that two chains are compared on.
const POSES: usize = 128;

/// Attributes of a joint's limit.
const LIMITS: [&str; 4] = ["lower", "upper", "effort", "velocity"];

/// Sizes that overflow are infinitely far off.
fn finite(deviation: f64) -> f64 {
    if deviation.is_nan() { f64::INFINITY } else { deviation }
}

/// Bytes of a text: a place that is not counted out in lines before it is needed.
#[derive(Clone, Copy)]
struct At<'t> {
    text: &'t str,
    start: usize,
    end: usize,
}

impl At<'_> {
    fn place(self) -> Place {
        Place::of_span(self.text, self.start..self.end)
    }
}

/// The links and joints of a URDF.
struct Description<'t> {
    /// Where the root element is.
    at: At<'t>,
    links: Vec<String>,
    joints: Vec<Joint<'t>>,
}

/// A joint of a URDF.
struct Joint<'t> {
    name: String,
    at: At<'t>,
    kind: String,
    mimics: bool,
    parent: String,
    child: String,
    origin: Isometry3<f64>,
    axis: Unit<Vector3<f64>>,
    /// In the order of [`LIMITS`].
    limits: [Option<f64>; 4],
}

impl Joint<'_> {
    fn is_revolute(&self) -> bool {
        self.kind == "revolute" && !self.mimics
    }

    fn is_fixed(&self) -> bool {
        self.kind == "fixed" && !self.mimics
    }
}

/// Seven revolute joints and the fixed ones between and behind them.
struct Chain<'a> {
    base: &'a str,
    tip: &'a str,
    joints: Vec<&'a Joint<'a>>,
    /// Which of the joints are revolute.
    moving: [usize; 7],
}

impl<'a> Chain<'a> {
    fn revolute(&self) -> [&'a Joint<'a>; 7] {
        self.moving.map(|index| self.joints[index])
    }

    /// Poses, in the base, of the seven joints (before they turn) and of the tip.
    fn poses(&self, joints_rad: &Joints) -> ([Isometry3<f64>; 7], Isometry3<f64>) {
        let mut pose = Isometry3::identity();
        let mut poses = [pose; 7];
        let mut number = 0;
        for joint in &self.joints {
            pose *= joint.origin;
            if joint.is_revolute() {
                poses[number] = pose;
                pose *= UnitQuaternion::from_axis_angle(&joint.axis, joints_rad[number]);
                number += 1;
            }
        }
        (poses, pose)
    }
}

impl<'t> Description<'t> {
    /// The chain of seven revolute joints that ends at `tip`, or at the one link that it can.
    fn chain(&self, tip: Option<&str>) -> Result<Chain<'_>, UrdfError> {
        let index_of: HashMap<&str, usize> =
            self.links.iter().enumerate().map(|(i, name)| (name.as_str(), i)).collect();
        let find = |joint: &Joint<'_>, link: &str| {
            index_of.get(link).copied().ok_or_else(|| UrdfError::UnknownLink {
                at: joint.at.place(),
                joint: joint.name.clone(),
                link: link.to_owned(),
            })
        };
        let mut above: Vec<Option<(&Joint<'_>, usize)>> = vec![None; self.links.len()];
        let mut below: Vec<Vec<usize>> = vec![Vec::new(); self.links.len()];
        for joint in &self.joints {
            let (parent, child) = (find(joint, &joint.parent)?, find(joint, &joint.child)?);
            if above[child].is_some() {
                return Err(UrdfError::SecondParent {
                    at: joint.at.place(),
                    joint: joint.name.clone(),
                    link: joint.child.clone(),
                });
            }
            above[child] = Some((joint, parent));
            below[parent].push(child);
        }
        let tip = match tip {
            Some(tip) => *index_of.get(tip).ok_or_else(|| UrdfError::UnknownTip {
                at: self.at.place(),
                tip: tip.to_owned(),
                links: Listed(self.links.clone()),
            })?,
            None => self.default_tip(&above, &below)?,
        };
        let mut joints = Vec::new();
        let mut link = tip;
        while let Some((joint, parent)) = above[link] {
            joints.push(joint);
            if joints.len() > self.joints.len() {
                return Err(UrdfError::Cycle {
                    at: joint.at.place(),
                    link: self.links[tip].clone(),
                });
            }
            link = parent;
        }
        joints.reverse();
        self.seven(joints, &self.links[tip])
    }

    /// The chain without its mounting, if it has seven revolute joints and fixed ones.
    fn seven<'a>(
        &'a self,
        mut joints: Vec<&'a Joint<'t>>,
        tip: &'a str,
    ) -> Result<Chain<'a>, UrdfError> {
        if let Some(joint) = joints.iter().find(|joint| !joint.is_revolute() && !joint.is_fixed()) {
            let kind = if joint.mimics { "mimic" } else { &joint.kind };
            return Err(UrdfError::JointKind {
                at: joint.at.place(),
                joint: joint.name.clone(),
                found: kind.to_owned(),
            });
        }
        let mounting = joints.iter().take_while(|joint| joint.is_fixed()).count();
        joints.drain(..mounting);
        let moving: Vec<usize> = (0..joints.len()).filter(|&i| joints[i].is_revolute()).collect();
        match <[usize; 7]>::try_from(moving) {
            Ok(moving) => Ok(Chain { base: &joints[0].parent, tip, moving, joints }),
            Err(moving) => Err(UrdfError::JointCount {
                at: joints.last().map_or(self.at, |joint| joint.at).place(),
                tip: tip.to_owned(),
                found: moving.len(),
            }),
        }
    }

    /// The link at the end of the longest chain with exactly seven revolute joints and otherwise
    /// fixed ones; if there is none, the link at the end of the longest chain.
    fn default_tip(
        &self,
        above: &[Option<(&Joint<'_>, usize)>],
        below: &[Vec<usize>],
    ) -> Result<usize, UrdfError> {
        // Per link, from the roots down: joints above it, and how many of them are revolute, if
        // all others are fixed.
        let mut queue: Vec<(usize, usize, Option<usize>)> = (0..self.links.len())
            .filter(|&i| above[i].is_none())
            .map(|i| (i, 0, Some(0)))
            .collect();
        let (mut longest, mut tips, mut tip_depth) = ((0, 0), Vec::new(), 0);
        let mut next = 0;
        while let Some(&(link, depth, revolute)) = queue.get(next) {
            next += 1;
            if depth > longest.1 {
                longest = (link, depth);
            }
            if revolute == Some(7) {
                if depth > tip_depth {
                    tips.clear();
                    tip_depth = depth;
                }
                // Links come in the order of their depth.
                tips.push(link);
            }
            queue.extend(below[link].iter().map(|&child| {
                let revolute = match above[child] {
                    Some((joint, _)) if joint.is_revolute() => revolute.map(|n| n + 1),
                    Some((joint, _)) if joint.is_fixed() => revolute,
                    _ => None,
                };
                (child, depth + 1, revolute)
            }));
        }
        match *tips {
            [] if self.links.is_empty() => Err(UrdfError::Missing {
                at: self.at.place(),
                owner: "the robot".to_owned(),
                missing: "<link>",
            }),
            [] => Ok(longest.0),
            [tip] => Ok(tip),
            _ => Err(UrdfError::AmbiguousTip {
                at: self.at.place(),
                links: Listed(tips.into_iter().map(|tip| self.links[tip].clone()).collect()),
            }),
        }
    }

    /// Reads the links and joints; what else a URDF has is skipped.
    ///
    /// One pass over the text without recursion, however deep it is nested.
    fn read(text: &'t str) -> Result<Self, UrdfError> {
        let mut reader = Reader::from_str(text);
        let mut depth = 0_usize;
        let mut description: Option<Self> = None;
        let mut quaternions = false;
        let mut draft: Option<Draft<'t>> = None;
        let mut names = Names::default();
        loop {
            let start = offset(reader.buffer_position());
            let event = reader.read_event();
            let (element, is_open) = match event {
                Err(error) => {
                    let byte = offset(reader.error_position());
                    return Err(UrdfError::Xml {
                        at: Place::of_span(text, byte..byte + 1),
                        problem: error.to_string(),
                    });
                }
                Ok(Event::Start(element)) => (element, true),
                Ok(Event::Empty(element)) => (element, false),
                Ok(Event::End(_)) => {
                    depth = depth.saturating_sub(1);
                    if depth == 1
                        && let (Some(done), Some(description)) = (draft.take(), &mut description)
                    {
                        description.joints.push(done.finish()?);
                    }
                    continue;
                }
                Ok(Event::Eof) => {
                    let problem = match description {
                        _ if depth > 0 => format!("it ends inside {depth} open elements"),
                        None => "it has no element".to_owned(),
                        Some(description) => return Ok(description),
                    };
                    let at = Place::of_span(text, text.len()..text.len());
                    return Err(UrdfError::Xml { at, problem });
                }
                Ok(_) => continue,
            };
            let at = At { text, start, end: offset(reader.buffer_position()) };
            let tag = Tag { element: &element, at };
            match (depth, element.name().as_ref(), &mut description, &mut draft) {
                (0, _, Some(_), _) => {
                    let problem = "it has a second outermost element".to_owned();
                    return Err(UrdfError::Xml { at: at.place(), problem });
                }
                (0, b"robot", None, _) => {
                    quaternions = tag.attribute("version")?.is_some_and(|v| v.trim() != "1.0");
                    description = Some(Self { at, links: Vec::new(), joints: Vec::new() });
                }
                (0, name, None, _) => {
                    let found = String::from_utf8_lossy(name).into_owned();
                    return Err(UrdfError::NotUrdf { at: at.place(), found });
                }
                (1, b"link", Some(description), _) => {
                    let name = tag.required("name", "a link")?;
                    names.link(&name, at)?;
                    description.links.push(name);
                }
                (1, b"joint", Some(description), _) => {
                    let new = Draft::new(&tag)?;
                    names.joint(&new.name, at)?;
                    if is_open {
                        draft = Some(new);
                    } else {
                        description.joints.push(new.finish()?);
                    }
                }
                (2, name, _, Some(draft)) => draft.part(name, &tag, quaternions)?,
                _ => {}
            }
            depth += usize::from(is_open);
        }
    }
}

/// The names that were there already.
#[derive(Default)]
struct Names {
    links: HashSet<String>,
    joints: HashSet<String>,
}

impl Names {
    fn link(&mut self, name: &str, at: At<'_>) -> Result<(), UrdfError> {
        Self::add(&mut self.links, "link", name, at)
    }

    fn joint(&mut self, name: &str, at: At<'_>) -> Result<(), UrdfError> {
        Self::add(&mut self.joints, "joint", name, at)
    }

    fn add(
        known: &mut HashSet<String>,
        what: &str,
        name: &str,
        at: At<'_>,
    ) -> Result<(), UrdfError> {
        if known.insert(name.to_owned()) {
            Ok(())
        } else {
            Err(UrdfError::Duplicate { at: at.place(), owner: format!("{what} {name:?}") })
        }
    }
}

fn offset(byte: u64) -> usize {
    usize::try_from(byte).unwrap_or(usize::MAX)
}

/// A joint while its parts are read.
struct Draft<'t> {
    name: String,
    at: At<'t>,
    kind: String,
    mimics: bool,
    parent: Option<String>,
    child: Option<String>,
    origin: Option<Isometry3<f64>>,
    axis: Option<Unit<Vector3<f64>>>,
    limits: Option<[Option<f64>; 4]>,
}

impl<'t> Draft<'t> {
    fn new(tag: &Tag<'_, 't>) -> Result<Self, UrdfError> {
        let name = tag.required("name", "a joint")?;
        let kind = tag.required("type", &format!("joint {name:?}"))?;
        Ok(Self {
            name,
            at: tag.at,
            kind,
            mimics: false,
            parent: None,
            child: None,
            origin: None,
            axis: None,
            limits: None,
        })
    }

    /// Takes in one child element of the joint.
    fn part(
        &mut self,
        element: &[u8],
        tag: &Tag<'_, 't>,
        quaternions: bool,
    ) -> Result<(), UrdfError> {
        let owner = |part: &str| format!("the {part} of joint {:?}", self.name);
        let second = match element {
            b"parent" => self.parent.replace(tag.required("link", &owner("parent"))?).is_some(),
            b"child" => self.child.replace(tag.required("link", &owner("child"))?).is_some(),
            b"origin" => self.origin.replace(tag.origin(quaternions)?).is_some(),
            b"axis" => {
                let axis: Vector3<f64> = tag.numbers("xyz")?.unwrap_or([1.0, 0.0, 0.0]).into();
                // Scaled first, so that its square neither overflows nor vanishes.
                let axis = Unit::try_new(axis / axis.amax(), 0.0).ok_or_else(|| {
                    UrdfError::ZeroAxis { at: tag.at.place(), joint: self.name.clone() }
                })?;
                self.axis.replace(axis).is_some()
            }
            b"limit" => {
                let mut limits = [None; 4];
                for (limit, key) in limits.iter_mut().zip(LIMITS) {
                    *limit = tag.numbers::<1>(key)?.map(|[number]| number);
                }
                self.limits.replace(limits).is_some()
            }
            b"mimic" => std::mem::replace(&mut self.mimics, true),
            _ => false,
        };
        if second {
            let part = String::from_utf8_lossy(element);
            return Err(UrdfError::Duplicate {
                at: tag.at.place(),
                owner: format!("the {part} of joint {:?}", self.name),
            });
        }
        Ok(())
    }

    fn finish(self) -> Result<Joint<'t>, UrdfError> {
        let missing = |missing| UrdfError::Missing {
            at: self.at.place(),
            owner: format!("joint {:?}", self.name),
            missing,
        };
        let parent = self.parent.clone().ok_or_else(|| missing("<parent>"))?;
        let child = self.child.clone().ok_or_else(|| missing("<child>"))?;
        Ok(Joint {
            name: self.name,
            at: self.at,
            kind: self.kind,
            mimics: self.mimics,
            parent,
            child,
            origin: self.origin.unwrap_or_else(Isometry3::identity),
            axis: self.axis.unwrap_or_else(Vector3::x_axis),
            limits: self.limits.unwrap_or_default(),
        })
    }
}

/// The start tag of an element.
struct Tag<'a, 't> {
    element: &'a BytesStart<'a>,
    at: At<'t>,
}

impl Tag<'_, '_> {
    fn attribute(&self, name: &str) -> Result<Option<String>, UrdfError> {
        let xml = |problem: String| UrdfError::Xml { at: self.at.place(), problem };
        let mut found = None;
        // The library's own search for duplicates takes a time that grows with their square.
        for attribute in self.element.attributes().with_checks(false) {
            let attribute = attribute.map_err(|error| xml(error.to_string()))?;
            if attribute.key.as_ref() == name.as_bytes() {
                let value = attribute
                    .decode_and_unescape_value(self.element.decoder())
                    .map_err(|error| xml(error.to_string()))?;
                if found.replace(value.into_owned()).is_some() {
                    return Err(xml(format!("the attribute {name} is there twice")));
                }
            }
        }
        Ok(found)
    }

    fn required(&self, name: &'static str, owner: &str) -> Result<String, UrdfError> {
        self.attribute(name)?.ok_or_else(|| UrdfError::Missing {
            at: self.at.place(),
            owner: owner.to_owned(),
            missing: name,
        })
    }

    /// The attribute's `N` numbers, if it is there.
    fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, UrdfError> {
        let Some(found) = self.attribute(name)? else { return Ok(None) };
        let numbers: Option<Vec<f64>> = found
            .split_whitespace()
            .take(N + 1)
            .map(|number| number.parse().ok().filter(|number: &f64| number.is_finite()))
            .collect();
        match numbers.and_then(|numbers| <[f64; N]>::try_from(numbers).ok()) {
            Some(numbers) => Ok(Some(numbers)),
            None => Err(UrdfError::Numbers {
                at: self.at.place(),
                attribute: name.to_owned(),
                found: found.chars().take(80).collect(),
                expected: N,
            }),
        }
    }

    /// An origin. Versions after 1.0 may have a quaternion; readers of 1.0 skip it.
    fn origin(&self, quaternions: bool) -> Result<Isometry3<f64>, UrdfError> {
        let xyz = self.numbers("xyz")?.unwrap_or([0.0; 3]);
        let rotation = match self.numbers("rpy")? {
            Some([roll, pitch, yaw]) => UnitQuaternion::from_euler_angles(roll, pitch, yaw),
            None if quaternions => {
                let [x, y, z, w] = self.numbers("quat_xyzw")?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
                let quaternion = Quaternion::new(w, x, y, z);
                Unit::try_new(quaternion, 1e-9).unwrap_or_else(UnitQuaternion::identity)
            }
            None => UnitQuaternion::identity(),
        };
        Ok(Isometry3::from_parts(Translation3::from(xyz), rotation))
    }
}
