//! The arm's own shells, made from the lengths of a model.
//!
//! Each limb is cut in two where an odd joint turns it, and each even joint sits between two housings that lie side
//! by side: a limb leans to one side, rounds over the axis, and ends in a circle about it, at which the next one begins.
//! All is about as thick as the cylinders and balls that clearances are taken from.

use std::array;

use iiwa_kin::{Pose, Robot};

use super::{
    skin::{Paint, Skin},
    surface::{Bend, Surface, dot},
};

/// The colour of what has none.
pub(super) const SHELL: Paint = Paint([208, 211, 215]);
const BAND: Paint = Paint([245, 105, 15]);
const DARK: Paint = Paint([58, 61, 66]);
const STEEL: Paint = Paint([150, 154, 160]);

/// Half of the gap between two shells that turn against each other, in m.
const GAP: f64 = 0.001;

/// Skins of link 0 to link 7, each in its link's frame.
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
    // Limbs at their cuts, and housings at their axes: radius, and how far they go to their side.
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
    // All was made where the arm stands upright; links have it in their frames.
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

/// A plate, and what tapers from it to the first joint.
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

/// What is between the last joint and the flange's face, and the face.
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

/// A ring about z that covers where two shells meet.
fn band(radius: f64) -> Surface {
    let (out, half) = (radius + 0.0012, 0.0055);
    Surface::turned(&[(0.0, -half, 0.0), (out, -half, 0.002), (out, half, 0.002), (0.0, half, 0.0)])
}

/// A limb that goes up from its cut at z = 0 to a housing on the side of -y of an axis along y.
struct Elbow {
    /// From the cut to the axis, in m.
    limb_m: f64,
    /// The limb's radius at its cut.
    limb: f64,
    /// The housing's radius about the axis.
    radius: f64,
    /// How far the housing goes to its side.
    width: f64,
}

impl Elbow {
    /// The limb's outer line, as y and z.
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

    /// Its line on the inside of the bend.
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

    /// A round cover on the housing, about the axis.
    fn cap(&self) -> Surface {
        // On what stands out furthest.
        let back = (0..=100).map(|i| -self.outer(f64::from(i) / 100.0)[0]).fold(0.0, f64::max);
        let wide = 0.6 * self.radius;
        let outline: [Bend; 5] = [
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

/// A point of a curve that begins at the first point and ends at the last.
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
