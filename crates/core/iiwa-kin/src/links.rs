//! Robot links as rigid bodies.

use crate::{RigidBody, Robot, inertials::Links, shapes};

/// Distance of a media flange's centre behind the flange face, in m: half of the length by which
/// "Touch" exceeds the plain flange (152 mm and 126 mm from the wrist).
const FLANGE_CENTER_M: f64 = 0.013;

/// Display name of a part of the arm: `the tool` for link 8, `the workpiece` for link 9, otherwise
/// for example `link 5`.
///
/// ```
/// assert_eq!(iiwa_kin::part_name(8), "the tool");
/// ```
#[must_use]
pub fn part_name(link: usize) -> String {
    match link {
        8 => "the tool".to_owned(),
        9 => "the workpiece".to_owned(),
        link => format!("link {link}"),
    }
}

impl Robot {
    /// Links 1 to 7 in the frames of [`Robot::link_poses`], without the separate flange mass.
    ///
    /// ```
    /// let links = iiwa_kin::Robot::lbr_iiwa_14_r820().links();
    /// let sum: f64 = links.iter().map(|link| link.mass_kg).sum();
    /// // With its base, the arm weighs 29.9 kg.
    /// assert!((sum - 22.85).abs() < 0.005);
    /// ```
    #[must_use]
    pub fn links(&self) -> [RigidBody; 7] {
        match &self.links {
            Links::Known(links) => **links,
            Links::Masses(masses) => {
                let [_, shapes @ ..] = self.link_shapes();
                std::array::from_fn(|j| shapes::body(&shapes[j], masses[j]))
            }
        }
    }

    /// Links 1 to 7, with the flange mass added to link 7.
    pub(crate) fn carried_links(&self) -> [RigidBody; 7] {
        let mut links = self.links();
        let at_m = [0.0, 0.0, self.lengths.flange_m - FLANGE_CENTER_M];
        links[6] = links[6].with(&RigidBody::point(self.flange_mass_kg, at_m));
        links
    }

    /// Masses of link 0 (the base) to link 7, in kg, without the separate flange mass.
    #[must_use]
    pub fn link_mass_kg(&self) -> [f64; 8] {
        let masses = match &self.links {
            Links::Known(links) => links.each_ref().map(|link| link.mass_kg),
            Links::Masses(masses) => *masses,
        };
        std::array::from_fn(|link| link.checked_sub(1).map_or(self.base_mass_kg, |j| masses[j]))
    }
}
