//! Built-in shells of the arm, computed from the lengths of a model.
//!
//! Each limb is cut in two where an odd joint turns it, and each even joint is between two housings
//! side by side: a limb leans to one side, curves over the axis, and ends in a circle around the
//! axis, where the next limb begins. The thickness is about that of the cylinders and spheres in
//! clearance computations.

use std::array;

use iiwa_kin::{Pose, Robot};

use super::{
    skin::{Skin, SurfaceColour},
    surface::{OutlineCorner, Surface, dot},
};

/// Default colour.
pub(super) const SHELL: SurfaceColour = SurfaceColour([208, 211, 215]);
const BAND: SurfaceColour = SurfaceColour([245, 105, 15]);
const DARK: SurfaceColour = SurfaceColour([58, 61, 66]);
const STEEL: SurfaceColour = SurfaceColour([150, 154, 160]);

/// Half of the gap between two shells that turn relative to each other, in m.
const GAP: f64 = 0.001;

/// Returns the skins of link 0 to link 7, each in its link frame.
pub(super) fn shells(robot: &Robot) -> [Vec<Skin>; 8] {
    let lengths = robot.lengths();
    let heights = [lengths.base_m, lengths.upper_arm_m, lengths.forearm_m];
    let axes = [heights[0], heights[0] + heights[1], heights.iter().sum()];
    let cuts = [
        0.45 * heights[0],
        axes[0] + 0.5 * heights[1],
        axes[1] + 0.5 * heights[2],
        axes[2] + 0.55 * lengths.flange_m,
    ];
    let face = axes[2] + lengths.flange_m;
    // Limbs at their cuts, and housings at their axes: radius, and lateral extent.
    let limbs = [0.08, 0.076, 0.07, 0.05];
    let hubs: [(f64, f64); 3] = [(0.079, 0.097), (0.074, 0.092), (0.06, 0.077)];
    let mut links: [Vec<Skin>; 8] = array::from_fn(|_| Vec::new());
    links[0] = foot(cuts[0], limbs[0]);
    for (i, (radius, width)) in hubs.into_iter().enumerate() {
        let side = if i == 1 { -1.0 } else { 1.0 };
        let axis = axes[i];
        let (below, above) = (axis - cuts[i], cuts[i + 1] - axis);
        let radius = radius.min(0.8 * below).min(0.8 * above);
        let (lower, upper) = (2 * i + 1, 2 * i + 2);
        for (link, limb_m, limb, up) in
            [(lower, below, limbs[i], 1.0), (upper, above, limbs[i + 1], -1.0)]
        {
            let side = side * up;
            let elbow = Elbow { limb_m: limb_m - GAP, limb, radius, width };
            let place = |[x, y, z]: [f64; 3]| [x, side * y, axis + up * (z - elbow.limb_m)];
            let turn = |[x, y, z]: [f64; 3]| [x, side * y, up * z];
            links[link].push(Skin { paint: SHELL, surface: elbow.shell().moved(place, turn) });
            links[link].push(Skin { paint: DARK, surface: elbow.cap().moved(place, turn) });
        }
        let about = |[x, y, z]: [f64; 3]| [x, z, -y];
        let seam = band(radius).moved(|p| raised(about(p), axis), about);
        links[lower].push(Skin { paint: BAND, surface: seam });
    }
    for (i, radius) in limbs.into_iter().enumerate() {
        let seam = band(radius).moved(|p| raised(p, cuts[i]), |normal| normal);
        links[2 * i + 1].push(Skin { paint: BAND, surface: seam });
    }
    links[7].extend(flange(cuts[3], face, limbs[3]));
    // The shells were built for the upright arm; transform them into the link frames.
    let poses = robot.link_poses(&[0.0; 7]);
    for (skins, pose) in links.iter_mut().zip(&poses) {
        let inverse = pose.inverse();
        for skin in skins {
            let surface = std::mem::take(&mut skin.surface);
            skin.surface = surface.moved(|p| at(&inverse, p), |normal| turned(&inverse, normal));
        }
    }
    links
}

/// Returns a plate, and the part that tapers from the plate to the first joint.
fn foot(cut: f64, limb: f64) -> Vec<Skin> {
    let plate = 0.07 * cut;
    let wide = 1.4 * limb;
    let outline = [
        (0.0, plate, 0.0),
        (wide - 0.006, plate, 0.002),
        (wide - 0.007, 0.3 * cut, 0.03),
        (limb + 0.008, 0.56 * cut, 0.06),
        (limb, cut - GAP, 0.003),
        (0.0, cut - GAP, 0.0),
    ];
    let plate = [(0.0, 0.0, 0.0), (wide, 0.0, 0.001), (wide, plate, 0.004), (0.0, plate, 0.0)];
    vec![
        Skin { paint: SHELL, surface: Surface::turned(&outline) },
        Skin { paint: STEEL, surface: Surface::turned(&plate) },
    ]
}

/// Returns the part between the last joint and the flange face, and the face.
fn flange(cut: f64, face: f64, limb: f64) -> Vec<Skin> {
    let length = face - cut;
    let neck = cut + 0.62 * length;
    let outline = [
        (0.0, cut + GAP, 0.0),
        (limb, cut + GAP, 0.003),
        (limb - 0.001, neck, 0.005),
        (0.0, neck, 0.0),
    ];
    let mount = [
        (0.0, neck - 0.001, 0.0),
        (0.045, neck - 0.001, 0.0),
        (0.045, face, 0.002),
        (0.02, face, 0.0008),
        (0.0195, face - 0.004, 0.0),
        (0.0, face - 0.004, 0.0),
    ];
    vec![
        Skin { paint: SHELL, surface: Surface::turned(&outline) },
        Skin { paint: STEEL, surface: Surface::turned(&mount) },
    ]
}

/// Returns a ring about z that covers the joint between two shells.
fn band(radius: f64) -> Surface {
    let (out, half) = (radius + 0.0012, 0.0055);
    Surface::turned(&[(0.0, -half, 0.0), (out, -half, 0.002), (out, half, 0.002), (0.0, half, 0.0)])
}

/// Limb from its cut at z = 0 upwards to a housing at the -y side of an axis along y.
struct Elbow {
    /// Distance from the cut to the axis, in m.
    limb_m: f64,
    /// Radius of the limb at its cut.
    limb: f64,
    /// Radius of the housing about the axis.
    radius: f64,
    /// Lateral extent of the housing.
    width: f64,
}

impl Elbow {
    /// Outer contour of the limb, as y and z.
    fn outer(&self, along: f64) -> [f64; 2] {
        let Self { limb_m: axis, limb, radius, width } = *self;
        let wide = 1.13 * width;
        bezier(
            [
                [-limb, 0.0],
                [-limb, 0.4 * axis],
                [-wide, axis - 0.7 * radius],
                [-wide, axis + 0.9 * radius],
                [-0.72 * wide, axis + radius],
                [-GAP, axis + radius],
            ],
            along,
        )
    }

    /// Contour on the inside of the bend.
    fn inner(&self, along: f64) -> [f64; 2] {
        let Self { limb_m: axis, limb, radius, .. } = *self;
        let top = axis - radius;
        bezier(
            [
                [limb, 0.0],
                [limb, 0.45 * top],
                [limb, 0.85 * top],
                [0.85 * limb, 0.99 * top],
                [0.4 * limb, top],
                [-GAP, top],
            ],
            along,
        )
    }

    fn shell(&self) -> Surface {
        Surface::tube(16, |along, angle| {
            let (outer, inner) = (self.outer(along), self.inner(along));
            let share = along * along * (3.0 - 2.0 * along);
            let wide = self.limb + share * (self.radius - self.limb);
            let (sin, cos) = angle.sin_cos();
            let [y, z] = array::from_fn(|i| {
                f64::midpoint(outer[i], inner[i]) - cos * (inner[i] - outer[i]) / 2.0
            });
            [wide * sin, y, z]
        })
    }

    /// Round cover on the housing, about the axis.
    fn cap(&self) -> Surface {
        // On the outermost point.
        let back = (0..=100).map(|i| -self.outer(f64::from(i) / 100.0)[0]).fold(0.0, f64::max);
        let wide = 0.6 * self.radius;
        let outline: [OutlineCorner; 5] = [
            (0.0, back - 0.03, 0.0),
            (wide, back - 0.03, 0.0),
            (wide, back + 0.001, 0.003),
            (0.8 * wide, back + 0.004, 0.02),
            (0.0, back + 0.004, 0.0),
        ];
        Surface::turned(&outline)
            .moved(|[x, y, z]| [x, -z, y + self.limb_m], |[x, y, z]| [x, -z, y])
    }
}

/// Returns a point of a Bézier curve with these control points.
fn bezier<const N: usize>(mut points: [[f64; 2]; N], along: f64) -> [f64; 2] {
    for left in (1..N).rev() {
        for i in 0..left {
            points[i] = array::from_fn(|k| {
                let (from, to) = (points[i][k], points[i + 1][k]);
                from + along * (to - from)
            });
        }
    }
    points[0]
}

fn raised([x, y, z]: [f64; 3], height: f64) -> [f64; 3] {
    [x, y, z + height]
}

pub(super) fn turned(pose: &Pose, vector: [f64; 3]) -> [f64; 3] {
    pose.rotation.map(|row| dot(row, vector))
}

pub(super) fn at(pose: &Pose, point: [f64; 3]) -> [f64; 3] {
    let vector = turned(pose, point);
    array::from_fn(|i| vector[i] + pose.position_m[i])
}
