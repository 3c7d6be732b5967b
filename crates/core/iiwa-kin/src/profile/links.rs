//! Links and friction in profiles.

use iiwa_json::{
    JsonObject,
    JsonStep::{Index, Key},
    locate, numbers,
};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use super::{
    bounds::{COULOMB, FLANGE_MASS, FRICTION, LINKS, MASSES, MAX_NUMBER, SAME_MASS, VISCOUS},
    error::ProfileError,
    units::{from_mm, unconvert, within},
};
use crate::{Friction, Joints, RigidBody, Robot, inertials::Links, robot::MAX_LENGTH_M};

/// A link as a rigid body.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Link")]
pub(super) struct LinkWire {
    /// Mass, in kg.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = MAX_NUMBER))]
    mass_kg: f64,
    /// Centre of mass in the link frame, in mm.
    #[serde(deserialize_with = "three")]
    center_mm: [f64; 3],
    /// Inertia tensor about the centre of mass, in kg m^2: xx, xy, xz, yy, yz and zz in the link
    /// frame.
    #[serde(deserialize_with = "six")]
    inertia_kg_m2: [f64; 6],
}

fn three<'de, D: Deserializer<'de>>(reader: D) -> Result<[f64; 3], D::Error> {
    numbers(reader, "three numbers")
}

fn six<'de, D: Deserializer<'de>>(reader: D) -> Result<[f64; 6], D::Error> {
    numbers(reader, "six numbers, xx, xy, xz, yy, yz and zz")
}

/// Friction of joints A1 to A7; absent values are 0.
#[derive(Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Friction")]
pub(super) struct FrictionWire {
    /// Viscous friction coefficients, in Nm s/rad.
    #[serde(default, deserialize_with = "seven")]
    #[schemars(extend("items" = { "type": "number", "minimum": 0, "maximum": MAX_NUMBER }))]
    viscous_nm_s_rad: Joints,
    /// Coulomb friction, independent of the speed, in Nm.
    #[serde(default, deserialize_with = "seven")]
    #[schemars(extend("items" = { "type": "number", "minimum": 0, "maximum": MAX_NUMBER }))]
    coulomb_nm: Joints,
}

fn seven<'de, D: Deserializer<'de>>(reader: D) -> Result<Joints, D::Error> {
    numbers(reader, "seven numbers, for joints A1 to A7")
}

impl LinkWire {
    /// Checked body of link `number` (from 1).
    fn body(&self, text: &str, number: usize) -> Result<RigidBody, ProfileError> {
        let path = [Key(LINKS), Index(number - 1)];
        let path_to = |key| [path[0], path[1], Key(key)];
        let (key, quantity) = ("mass_kg", format!("{LINKS}: mass_kg of link {number}"));
        if !(self.mass_kg.is_normal() && self.mass_kg > 0.0 && self.mass_kg <= MAX_NUMBER) {
            let (place, found) = (locate(text, &path_to(key)), self.mass_kg);
            return Err(ProfileError::Number { place, quantity, found, max: MAX_NUMBER });
        }
        for (key, list, limit) in [
            ("center_mm", &self.center_mm[..], MAX_LENGTH_M * 1e3),
            ("inertia_kg_m2", &self.inertia_kg_m2, MAX_NUMBER),
        ] {
            for (index, &found) in list.iter().enumerate() {
                let quantity =
                    || format!("{LINKS}: number {} of {key} of link {number}", index + 1);
                let place = [path[0], path[1], Key(key), Index(index)];
                within(text, &place, found, [-limit, limit], quantity)?;
            }
        }
        let body = RigidBody {
            mass_kg: self.mass_kg,
            center_m: self.center_mm.map(from_mm),
            inertia_kg_m2: self.inertia_kg_m2,
        };
        if body.is_possible() {
            Ok(body)
        } else {
            Err(ProfileError::Inertia {
                place: locate(text, &path_to("inertia_kg_m2")),
                link: number,
            })
        }
    }
}

impl From<&RigidBody> for LinkWire {
    fn from(body: &RigidBody) -> Self {
        Self {
            mass_kg: body.mass_kg,
            center_mm: body.center_m.map(|m| unconvert(m, from_mm)),
            inertia_kg_m2: body.inertia_kg_m2,
        }
    }
}

impl FrictionWire {
    /// Checked friction: no coefficient may be negative.
    pub(super) fn friction(&self, text: &str) -> Result<Friction, ProfileError> {
        for (key, list) in [(VISCOUS, &self.viscous_nm_s_rad), (COULOMB, &self.coulomb_nm)] {
            for (index, &value) in list.iter().enumerate() {
                let quantity = || format!("{FRICTION}: {key} of joint A{}", index + 1);
                let place = [Key(FRICTION), Key(key), Index(index)];
                within(text, &place, value, [0.0, MAX_NUMBER], quantity)?;
            }
        }
        let Self { viscous_nm_s_rad, coulomb_nm } = *self;
        Ok(Friction { viscous_nm_s_rad, coulomb_nm })
    }

    /// The friction, if it differs from that of `base`.
    pub(super) fn of(
        friction: &Friction,
        base: &Friction,
        differ: fn(&[f64], &[f64]) -> bool,
    ) -> Option<Self> {
        let Friction { viscous_nm_s_rad, coulomb_nm } = *friction;
        let differs = differ(&viscous_nm_s_rad, &base.viscous_nm_s_rad)
            || differ(&coulomb_nm, &base.coulomb_nm);
        differs.then_some(Self { viscous_nm_s_rad, coulomb_nm })
    }
}

/// Reads the seven links of a profile.
pub(super) fn bodies(
    text: &str,
    links: &[JsonObject<LinkWire>],
) -> Result<[RigidBody; 7], ProfileError> {
    let links = (1..).zip(links).map(|(number, JsonObject(link))| link.body(text, number));
    let links = links.collect::<Result<Vec<_>, _>>()?;
    let found = links.len();
    links.try_into().map_err(|_| {
        let place = locate(text, &[Key(LINKS)]);
        ProfileError::Count { place, key: LINKS, found, expected: 7 }
    })
}

/// Checks that masses given in both keys agree.
pub(super) fn check_masses(
    text: &str,
    masses: &[f64; 8],
    links: &[RigidBody; 7],
) -> Result<(), ProfileError> {
    for (number, (&found, link)) in (1..).zip(masses[1..].iter().zip(links)) {
        if (found - link.mass_kg).abs() > SAME_MASS * link.mass_kg {
            let place = locate(text, &[Key(MASSES), Index(number)]);
            let of_links = link.mass_kg;
            return Err(ProfileError::Masses { place, link: number, found, of_links });
        }
    }
    Ok(())
}

/// Checks the flange mass.
pub(super) fn check_flange_mass(text: &str, mass_kg: f64) -> Result<f64, ProfileError> {
    within(text, &[Key(FLANGE_MASS)], mass_kg, [0.0, MAX_NUMBER], || FLANGE_MASS.to_owned())?;
    Ok(mass_kg)
}

/// Values of `link_mass_kg` and `links` in the profile of `robot` on top of `base`.
pub(super) fn written(
    robot: &Robot,
    base: &Robot,
    differ: fn(&[f64], &[f64]) -> bool,
) -> (Option<Vec<f64>>, Option<Vec<JsonObject<LinkWire>>>) {
    let masses = || robot.link_mass_kg().to_vec();
    if matches!(robot.links, Links::Masses(_)) {
        return (Some(masses()), None);
    }
    let numbers = |robot: &Robot| -> Vec<f64> {
        let wire_of = |link: RigidBody| {
            let RigidBody { mass_kg, center_m, inertia_kg_m2 } = link;
            [&[mass_kg], &center_m[..], &inertia_kg_m2].concat()
        };
        robot.links().into_iter().flat_map(wire_of).collect()
    };
    let becomes_known = base.assumes("masses") && !robot.assumes("masses");
    let foot_differs = differ(&[robot.base_mass_kg], &[base.base_mass_kg]);
    if becomes_known || foot_differs || differ(&numbers(robot), &numbers(base)) {
        // Masses without `links` would be read as masses of simple shapes.
        let links = robot.links().iter().map(|link| JsonObject(link.into())).collect();
        (foot_differs.then(masses), Some(links))
    } else {
        (None, None)
    }
}
