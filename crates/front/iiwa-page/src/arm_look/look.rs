//! Appearance of the arm on pages: packed triangles of each link.

use iiwa_kin::Robot;
use iiwa_scene::{ArmMeshes, Patch};
use serde::Serialize;

use super::{
    packed::Packed,
    shells,
    skin::{Skin, SurfaceColour},
    surface,
    thinned::Soup,
};

/// Appearance of the arm, link by link, each in its link frame.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Look {
    links: Vec<Vec<PackedSurface>>,
    /// `true` if the inside of the surfaces is invisible.
    is_closed: bool,
}

/// Maximum number of triangles of an arm: more are not visible, and slow to draw.
const TRIANGLES: usize = 30_000;

/// Surface in page format: the resolution of corners is a 65535th of its extent, that of normals
/// finer than visible.
#[derive(Clone, Debug, Serialize)]
struct PackedSurface {
    paint: SurfaceColour,
    /// Corner of the bounding box with the smallest coordinates.
    low_m: [f64; 3],
    /// Size of the bounding box.
    size_m: [f64; 3],
    /// Three 16-bit numbers per corner: relative position in the box.
    positions: Packed,
    /// Normals on an unfolded octahedron: two 16-bit numbers per corner.
    normals: Packed,
    /// Three corner indices per triangle, of 32 bits if 16 bits are too few.
    triangles: Packed,
    is_large: bool,
}

impl Look {
    /// Uses the built-in shells.
    #[must_use]
    pub(crate) fn built_in(robot: &Robot) -> Self {
        Self::packed(&shells::shells(robot), true)
    }

    /// Uses the meshes of a user.
    #[must_use]
    pub(crate) fn of_meshes(meshes: &ArmMeshes) -> Self {
        let links = meshes.visual.iter().map(|patches| painted(patches));
        let (places, soups): (Vec<_>, Vec<_>) = links
            .enumerate()
            .flat_map(|(link, painted)| {
                painted.into_iter().map(move |(paint, soup)| ((link, paint), soup.welded()))
            })
            .unzip();
        let mut skins: [Vec<Skin>; 8] = Default::default();
        for ((link, paint), soup) in std::iter::zip(places, Soup::thinned(soups, TRIANGLES)) {
            skins[link].push(Skin { paint, surface: soup.surface() });
        }
        Self::packed(&skins, false)
    }

    fn packed(links: &[Vec<Skin>; 8], is_closed: bool) -> Self {
        let seen = |skin: &&Skin| !skin.surface.triangles.is_empty();
        let link = |skins: &Vec<Skin>| skins.iter().filter(seen).map(PackedSurface::from).collect();
        Self { links: links.iter().map(link).collect(), is_closed }
    }
}

/// Groups the triangles by colour.
fn painted(patches: &[Patch]) -> Vec<(SurfaceColour, Soup)> {
    let mut all: Vec<(SurfaceColour, Soup)> = Vec::new();
    for patch in patches {
        let paint = patch.rgb.map_or(shells::SHELL, SurfaceColour::of);
        let number = all.iter().position(|(known, _)| *known == paint).unwrap_or_else(|| {
            all.push((paint, Soup::default()));
            all.len() - 1
        });
        let soup = &mut all[number].1;
        let first = u32::try_from(soup.points.len()).unwrap_or(u32::MAX);
        soup.points.extend(&patch.points);
        soup.triangles.extend(patch.triangles.iter().map(|corners| corners.map(|it| first + it)));
    }
    all
}

impl From<&Skin> for PackedSurface {
    fn from(Skin { paint, surface }: &Skin) -> Self {
        let mut low_m = [f64::MAX; 3];
        let mut high_m = [f64::MIN; 3];
        for position in &surface.positions {
            for i in 0..3 {
                low_m[i] = low_m[i].min(position[i]);
                high_m[i] = high_m[i].max(position[i]);
            }
        }
        let size_m = surface::difference(high_m, low_m);
        let share = |value: f64, i: usize| {
            if size_m[i] > 0.0 { (value - low_m[i]) / size_m[i] } else { 0.0 }
        };
        let positions = surface.positions.iter();
        let shares = positions.flat_map(|point| [0, 1, 2].map(|i| share(point[i], i)));
        let normals = surface.normals.iter().flat_map(|normal| {
            let [u, v] = unfolded(*normal);
            [u, v].map(|value| f64::midpoint(value, 1.0))
        });
        let is_large = surface.positions.len() > usize::from(u16::MAX);
        let corners = surface.triangles.iter().flatten().copied();
        Self {
            paint: *paint,
            low_m,
            size_m,
            positions: Packed::shares(shares),
            normals: Packed::shares(normals),
            triangles: if is_large { Packed::words(corners) } else { Packed::halves(corners) },
            is_large,
        }
    }
}

/// Maps a direction to a point of the square from -1 to 1: on an octahedron whose lower half is
/// folded outwards (Meyer et al. 2010).
fn unfolded([x, y, z]: [f64; 3]) -> [f64; 2] {
    let sum = x.abs() + y.abs() + z.abs();
    let [u, v] = [x / sum, y / sum];
    if z >= 0.0 { [u, v] } else { [(1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v)] }
}
