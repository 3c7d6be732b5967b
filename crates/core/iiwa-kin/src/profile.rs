//! Robot profile: a JSON file that overrides parts of a built-in model.

mod bounds;
mod error;
mod links;
mod ramps;
mod units;

use iiwa_json::{
    JsonObject, JsonPlace,
    JsonStep::{Index, Key},
    Unread, locate, problem, read_version, without_mark,
};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use self::bounds::{
    ACCELERATIONS, BLOCKING_PAUSE, JERKS, KAPPA, KAPPA_RANGE, MASSES, MAX_BYTES, MAX_NAME,
    MAX_NUMBER, MAX_POSITION_DEG, MIN_RANGE_DEG, POSITIONS, RANGES, SETTLE, SETTLE_RANGE_S,
    T1_SPEED, T1_SPEED_RANGE_MM_S, TCP_KAPPA, TORQUES, VELOCITIES, VERSION,
};
pub use self::error::ProfileError;
use self::{
    links::{FrictionWire, LinkWire, bodies, check_flange_mass, check_masses, written},
    ramps::RampsWire,
    units::{DEG, SAME, checked, differ, from_mm, kappa, list, unconvert, within},
};
use crate::{Joint, Joints, Lengths, Limits, Robot, robot::MAX_LENGTH_M};

/// A robot model for iiwasim: a built-in model and the differences from it.
#[derive(Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "iiwasim robot profile", rename = "RobotProfile")]
struct Wire {
    /// URL or path of the JSON Schema of this format, for editors; otherwise unused.
    #[serde(default, rename = "$schema", deserialize_with = "given", skip_serializing)]
    #[schemars(with = "String")]
    #[expect(dead_code, reason = "it is for editors")]
    schema: Option<String>,
    /// Version of this format.
    #[schemars(extend("const" = VERSION))]
    version: u64,
    /// The built-in model to start from.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(
        with = "String",
        extend("enum" = Robot::BUILT_IN, "default" = Robot::BUILT_IN[0])
    )]
    base: Option<String>,
    /// Robot name; the built-in model's name by default.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String", length(min = 1, max = MAX_NAME))]
    name: Option<String>,
    /// Lengths of the Denavit-Hartenberg table, in mm.
    #[serde(default, deserialize_with = "given_object", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "LengthsWire")]
    lengths_mm: Option<LengthsWire>,
    /// Position limits of joints A1 to A7, symmetric about zero, in degrees.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<f64>", length(equal = 7), extend("items" = positive(MAX_POSITION_DEG)))]
    position_limit_deg: Option<Vec<f64>>,
    /// Lower and upper position limits of joints A1 to A7, in degrees. Replaces
    /// `position_limit_deg` if the limits are not symmetric.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<[f64; 2]>", length(equal = 7), extend("items" = position_range()))]
    position_range_deg: Option<Vec<[f64; 2]>>,
    /// Speed limits, in degrees/s.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<f64>", length(equal = 7), extend("items" = positive(MAX_NUMBER)))]
    velocity_limit_deg_s: Option<Vec<f64>>,
    /// Acceleration limits, in degrees/s^2.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<f64>", length(equal = 7), extend("items" = positive(MAX_NUMBER)))]
    acceleration_limit_deg_s2: Option<Vec<f64>>,
    /// Jerk limits, in degrees/s^3.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<f64>", length(equal = 7), extend("items" = positive(MAX_NUMBER)))]
    jerk_limit_deg_s3: Option<Vec<f64>>,
    /// Torque limits, in Nm.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<f64>", length(equal = 7), extend("items" = positive(MAX_NUMBER)))]
    torque_limit_nm: Option<Vec<f64>>,
    /// Masses of link 0 (the base) to link 7, in kg. Without `links`, the links are simple shapes
    /// with these masses.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<f64>", length(equal = 8), extend("items" = positive(MAX_NUMBER)))]
    link_mass_kg: Option<Vec<f64>>,
    /// Links 1 to 7 as rigid bodies, each in its URDF frame: z is the joint axis; the origins are
    /// in the base, twice in the shoulder, twice in the elbow and twice in the wrist.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<LinkWire>", length(equal = 7))]
    links: Option<Vec<JsonObject<LinkWire>>>,
    /// Flange mass in addition to link 7, in kg, for example of a media flange: a point mass on
    /// axis 7, 13 mm behind the flange face.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("minimum" = 0, "maximum" = MAX_NUMBER))]
    flange_mass_kg: Option<f64>,
    /// Joint friction on the output side of the gears; zero by default.
    #[serde(default, deserialize_with = "given_object", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "FrictionWire")]
    friction: Option<FrictionWire>,
    /// Blend coefficient kappa as a polynomial of the angle gamma in degrees: the constant, then
    /// the factors of gamma and gamma^2.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<f64>", length(equal = 3), extend("items" = range(KAPPA_RANGE)))]
    blend_kappa: Option<Vec<f64>>,
    /// Polynomial as in `blend_kappa`, for blends between two Cartesian TCP paths; equal to
    /// `blend_kappa` by default.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<f64>", length(equal = 3), extend("items" = range(KAPPA_RANGE)))]
    tcp_blend_kappa: Option<Vec<f64>>,
    /// Settling time at rest after a motion without a blend, in s.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("minimum" = SETTLE_RANGE_S[0], "maximum" = SETTLE_RANGE_S[1]))]
    settle_time_s: Option<f64>,
    /// Standstill after a blocking motion, whose end the program waits for, in s.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("minimum" = SETTLE_RANGE_S[0], "maximum" = SETTLE_RANGE_S[1]))]
    blocking_pause_s: Option<f64>,
    /// Speed limit of TCP and flange in operating mode T1, in mm/s.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(
        with = "f64",
        extend("minimum" = T1_SPEED_RANGE_MM_S[0], "maximum" = T1_SPEED_RANGE_MM_S[1])
    )]
    t1_speed_mm_s: Option<f64>,
    /// Ramps at the start and end of PTP motions, and speed along splines, for the timing
    /// `sunrise`.
    #[serde(default, deserialize_with = "given_object", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "RampsWire")]
    ramps: Option<RampsWire>,
}

/// Lengths in mm; the built-in model's lengths by default.
#[derive(Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Lengths")]
struct LengthsWire {
    /// d1: base to shoulder.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0, "maximum" = MAX_LENGTH_M * 1e3))]
    base: Option<f64>,
    /// d3: shoulder to elbow.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0, "maximum" = MAX_LENGTH_M * 1e3))]
    upper_arm: Option<f64>,
    /// d5: elbow to wrist.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0, "maximum" = MAX_LENGTH_M * 1e3))]
    forearm: Option<f64>,
    /// d7: wrist to the flange's face.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0, "maximum" = MAX_LENGTH_M * 1e3))]
    flange: Option<f64>,
}

/// Reads the value of a key that is present; null is an error.
fn given<'de, T: Deserialize<'de>, D: Deserializer<'de>>(reader: D) -> Result<Option<T>, D::Error> {
    T::deserialize(reader).map(Some)
}

fn given_object<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    reader: D,
) -> Result<Option<T>, D::Error> {
    JsonObject::deserialize(reader).map(|object| Some(object.0))
}

/// JSON Schema of a number above 0.
fn positive(max: f64) -> serde_json::Value {
    serde_json::json!({ "type": "number", "exclusiveMinimum": 0, "maximum": max })
}

/// JSON Schema of a joint's lower and upper limit, in degrees.
fn position_range() -> serde_json::Value {
    let limit = range([-MAX_POSITION_DEG, MAX_POSITION_DEG]);
    serde_json::json!({ "type": "array", "items": limit, "minItems": 2, "maxItems": 2 })
}

/// JSON Schema of a number within a range.
fn range([min, max]: [f64; 2]) -> serde_json::Value {
    serde_json::json!({ "type": "number", "minimum": min, "maximum": max })
}

/// Quantities that a built-in model may assume.
const ASSUMABLE: [&str; 4] = ["acceleration", "jerk", "masses", "ramps"];

impl Robot {
    /// Reads a robot profile (version 1): a built-in model and the differences from it.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    ///
    /// let robot = Robot::from_profile(r#"{ "version": 1, "lengths_mm": { "flange": 126 } }"#)?;
    /// assert_eq!(robot.lengths().flange_m, 0.126);
    /// # Ok::<(), iiwa_kin::ProfileError>(())
    /// ```
    ///
    /// A quantity that the profile gives is no longer an [assumption](Robot::assumptions).
    ///
    /// # Errors
    ///
    /// If the text is not a profile, or has a number that no robot can have; the error gives the
    /// place in the text.
    pub fn from_profile(text: &str) -> Result<Self, ProfileError> {
        let text = without_mark(text);
        if text.len() > MAX_BYTES {
            let place = JsonPlace::of_span(text, 0..0);
            return Err(ProfileError::TooLong { place, found: text.len() });
        }
        let wire =
            read_version(text, VERSION, |wire: &Wire| wire.version).map_err(
                |error| match error {
                    Unread::Version { found, place } => ProfileError::Version { place, found },
                    Unread::Json(error) => {
                        let place = JsonPlace::of_error(text, text, &error);
                        ProfileError::Json { place, problem: problem(&error) }
                    }
                },
            )?;
        wire.robot(text)
    }

    /// Writes the robot as a profile (version 1, pretty-printed JSON) for [`Robot::from_profile`].
    ///
    /// Contains the differences from the most similar built-in model. Numbers read back exactly,
    /// except for the last bit of a number that no decimal number of degrees (or mm) represents; a
    /// robot that was read from a profile reads back exactly.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    ///
    /// let text = Robot::lbr_iiwa_14_r820().with_name("cell 3").to_profile();
    /// assert_eq!(Robot::from_profile(&text)?.name(), "cell 3");
    /// # Ok::<(), iiwa_kin::ProfileError>(())
    /// ```
    #[must_use]
    pub fn to_profile(&self) -> String {
        let wire = Self::BUILT_IN
            .iter()
            .filter_map(|name| Self::built_in(name))
            .map(|base| Wire::of(self, &base, differ))
            // Prefer a model that preserves the assumptions, even if the profile then has more
            // keys.
            .min_by_key(|wire| {
                let read_back = wire.robot("");
                // A profile does not contain the assumptions of [`Robot::with_assumption`].
                let same = read_back.is_ok_and(|robot| {
                    ASSUMABLE.iter().all(|name| robot.assumes(name) == self.assumes(name))
                });
                (!same, wire.overrides())
            })
            .unwrap_or_default();
        // Serialisation can only fail for a map whose keys are not strings.
        serde_json::to_string_pretty(&wire).unwrap_or_default()
    }

    /// Writes the robot as a profile with all its quantities, including those of the built-in
    /// model.
    ///
    /// A robot read back from this profile has no [assumptions](Robot::assumptions), because
    /// quantities given in a profile count as known.
    #[must_use]
    pub fn to_full_profile(&self) -> String {
        let wire = Wire::of(self, &Self::default(), |_, _| true);
        serde_json::to_string_pretty(&wire).unwrap_or_default()
    }

    /// JSON Schema of a robot profile (draft 2020-12).
    #[must_use]
    pub fn profile_schema() -> serde_json::Value {
        schemars::schema_for!(Wire).to_value()
    }
}

impl Wire {
    /// Builds the robot that this profile describes; `text` is the text of the profile, for error
    /// places.
    fn robot(&self, text: &str) -> Result<Robot, ProfileError> {
        let mut robot = match &self.base {
            None => Robot::default(),
            Some(name) => Robot::built_in(name).ok_or_else(|| ProfileError::UnknownBase {
                place: locate(text, &[Key("base")]),
                found: name.clone(),
            })?,
        };
        if let Some(name) = &self.name {
            // Names are also written to XML, which cannot represent control characters.
            let printable = |c: char| !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}');
            if name.is_empty() || name.chars().count() > MAX_NAME || !name.chars().all(printable) {
                let place = locate(text, &[Key("name")]);
                return Err(ProfileError::Name { place, found: name.clone() });
            }
            robot.name.clone_from(name);
        }
        if let Some(lengths) = &self.lengths_mm {
            for ((key, length_mm), length) in lengths.entries().into_iter().zip(robot.lengths.all())
            {
                if let Some(mm) = length_mm {
                    let path = [Key("lengths_mm"), Key(key)];
                    let quantity = || format!("lengths_mm: {key}");
                    *length = checked(text, &path, mm, MAX_LENGTH_M * 1e3, quantity, from_mm)?;
                }
            }
        }
        let limits = &mut robot.limits;
        for (key, numbers, max, unit, field) in [
            (POSITIONS, &self.position_limit_deg, MAX_POSITION_DEG, DEG, &mut limits.upper_rad),
            (VELOCITIES, &self.velocity_limit_deg_s, MAX_NUMBER, DEG, &mut limits.velocity_rad_s),
            (
                ACCELERATIONS,
                &self.acceleration_limit_deg_s2,
                MAX_NUMBER,
                DEG,
                &mut limits.acceleration_rad_s2,
            ),
            (JERKS, &self.jerk_limit_deg_s3, MAX_NUMBER, DEG, &mut limits.jerk_rad_s3),
            (TORQUES, &self.torque_limit_nm, MAX_NUMBER, SAME, &mut limits.torque_nm),
        ] {
            if let Some(numbers) = numbers {
                *field = list(text, key, numbers, max, unit)?;
            }
        }
        if self.position_limit_deg.is_some() {
            limits.lower_rad = limits.upper_rad.map(|upper| -upper);
        }
        if let Some(ranges) = &self.position_range_deg {
            self.set_ranges(text, ranges, limits)?;
        }
        robot = self.set_links(text, robot)?;
        if let Some(numbers) = &self.blend_kappa {
            robot.blend_kappa = kappa(text, KAPPA, numbers)?;
        }
        if let Some(numbers) = &self.tcp_blend_kappa {
            robot = robot.with_tcp_blend_kappa(kappa(text, TCP_KAPPA, numbers)?);
        }
        if let Some(length_mm) = self.settle_time_s {
            within(text, &[Key(SETTLE)], length_mm, SETTLE_RANGE_S, || SETTLE.to_owned())?;
            robot.settle_time_s = length_mm;
        }
        if let Some(length_mm) = self.blocking_pause_s {
            let name = || BLOCKING_PAUSE.to_owned();
            within(text, &[Key(BLOCKING_PAUSE)], length_mm, SETTLE_RANGE_S, name)?;
            robot.blocking_pause_s = length_mm;
        }
        if let Some(length_mm) = self.t1_speed_mm_s {
            let name = || T1_SPEED.to_owned();
            within(text, &[Key(T1_SPEED)], length_mm, T1_SPEED_RANGE_MM_S, name)?;
            robot.t1_speed_m_s = 1e-3 * length_mm;
        }
        if let Some(ramps) = &self.ramps {
            let law = ramps.law(text, &robot.ramp_law)?;
            robot = robot.with_ramp_law(law);
        }
        if self.acceleration_limit_deg_s2.is_some() {
            robot.drop_assumption("acceleration");
        }
        if self.jerk_limit_deg_s3.is_some() {
            robot.drop_assumption("jerk");
        }
        Ok(robot)
    }

    /// Applies the given links, flange mass and friction.
    fn set_links(&self, text: &str, mut robot: Robot) -> Result<Robot, ProfileError> {
        let masses = self.link_mass_kg.as_deref();
        let masses = masses.map(|masses| list(text, MASSES, masses, MAX_NUMBER, SAME));
        let masses = masses.transpose()?;
        if let Some(masses) = masses {
            robot = robot.with_link_mass_kg(masses);
        }
        if let Some(links) = &self.links {
            let links = bodies(text, links)?;
            masses.map_or(Ok(()), |masses| check_masses(text, &masses, &links))?;
            robot = robot.with_links(links);
        }
        if let Some(mass_kg) = self.flange_mass_kg {
            robot.flange_mass_kg = check_flange_mass(text, mass_kg)?;
        }
        if let Some(friction) = &self.friction {
            robot.friction = friction.friction(text)?;
        }
        Ok(robot)
    }

    /// Applies the given position ranges.
    fn set_ranges(
        &self,
        text: &str,
        ranges: &[[f64; 2]],
        limits: &mut Limits,
    ) -> Result<(), ProfileError> {
        let place = || locate(text, &[Key(RANGES)]);
        if self.position_limit_deg.is_some() {
            return Err(ProfileError::Both { place: place(), keys: [POSITIONS, RANGES] });
        }
        if ranges.len() != 7 {
            return Err(ProfileError::Count {
                place: place(),
                key: RANGES,
                found: ranges.len(),
                expected: 7,
            });
        }
        for (joint, &[lower, upper]) in Joint::ALL.into_iter().zip(ranges) {
            let path = |side| [Key(RANGES), Index(joint.index()), Index(side)];
            let quantity = |side| move || format!("{RANGES}: {side} limit of joint {joint}");
            let greatest = MAX_POSITION_DEG - MIN_RANGE_DEG;
            within(text, &path(0), lower, [-MAX_POSITION_DEG, greatest], quantity("lower"))?;
            let min_upper = lower + MIN_RANGE_DEG;
            within(text, &path(1), upper, [min_upper, MAX_POSITION_DEG], quantity("upper"))?;
            limits.lower_rad[joint.index()] = lower.to_radians();
            limits.upper_rad[joint.index()] = upper.to_radians();
        }
        Ok(())
    }

    /// Differences of `robot` from `base`, where `differ` reports them for two lists of numbers.
    fn of(robot: &Robot, base: &Robot, differ: fn(&[f64], &[f64]) -> bool) -> Self {
        let deg = |values: &Joints, of_base: &Joints, quantity: &str| {
            let becomes_known = base.assumes(quantity) && !robot.assumes(quantity);
            (becomes_known || differ(values, of_base))
                .then(|| values.map(|v| unconvert(v, DEG)).to_vec())
        };
        let (limits, of_base) = (robot.limits(), base.limits());
        let is_symmetric = !units::differ(&limits.lower_rad.map(|lower| -lower), &limits.upper_rad);
        let mm = |value: f64, of_base: f64| {
            differ(&[value], &[of_base]).then(|| unconvert(value, from_mm))
        };
        let (l, b) = (robot.lengths(), base.lengths());
        let (link_mass_kg, links) = written(robot, base, differ);
        Self {
            schema: None,
            version: VERSION,
            base: Some(base.name.clone()),
            name: (robot.name != base.name).then(|| robot.name.clone()),
            lengths_mm: differ(&l.in_order(), &b.in_order()).then(|| LengthsWire {
                base: mm(l.base_m, b.base_m),
                upper_arm: mm(l.upper_arm_m, b.upper_arm_m),
                forearm: mm(l.forearm_m, b.forearm_m),
                flange: mm(l.flange_m, b.flange_m),
            }),
            position_limit_deg: is_symmetric
                .then(|| deg(&limits.upper_rad, &of_base.upper_rad, ""))
                .flatten(),
            position_range_deg: (!is_symmetric).then(|| {
                let side = |values: &Joints, j: usize| unconvert(values[j], DEG);
                (0..7).map(|j| [side(&limits.lower_rad, j), side(&limits.upper_rad, j)]).collect()
            }),
            velocity_limit_deg_s: deg(&limits.velocity_rad_s, &of_base.velocity_rad_s, ""),
            acceleration_limit_deg_s2: deg(
                &limits.acceleration_rad_s2,
                &of_base.acceleration_rad_s2,
                "acceleration",
            ),
            jerk_limit_deg_s3: deg(&limits.jerk_rad_s3, &of_base.jerk_rad_s3, "jerk"),
            torque_limit_nm: differ(&limits.torque_nm, &of_base.torque_nm)
                .then(|| limits.torque_nm.to_vec()),
            link_mass_kg,
            links,
            flange_mass_kg: differ(&[robot.flange_mass_kg], &[base.flange_mass_kg])
                .then_some(robot.flange_mass_kg),
            friction: FrictionWire::of(&robot.friction, &base.friction, differ),
            blend_kappa: differ(&robot.blend_kappa, &base.blend_kappa)
                .then(|| robot.blend_kappa.to_vec()),
            tcp_blend_kappa: differ(robot.tcp_blend_kappa(), &robot.blend_kappa)
                .then(|| robot.tcp_blend_kappa().to_vec()),
            settle_time_s: differ(&[robot.settle_time_s], &[base.settle_time_s])
                .then_some(robot.settle_time_s),
            blocking_pause_s: differ(&[robot.blocking_pause_s], &[base.blocking_pause_s])
                .then_some(robot.blocking_pause_s),
            t1_speed_mm_s: differ(&[robot.t1_speed_m_s], &[base.t1_speed_m_s])
                .then_some(1e3 * robot.t1_speed_m_s),
            ramps: RampsWire::of(robot, base, differ),
        }
    }

    /// Number of keys that override the built-in model.
    fn overrides(&self) -> usize {
        let lengths = self.lengths_mm.as_ref().map_or(0, |lengths| {
            lengths.entries().into_iter().filter(|(_, length)| length.is_some()).count()
        });
        lengths
            + [
                self.name.is_some(),
                self.position_limit_deg.is_some(),
                self.position_range_deg.is_some(),
                self.velocity_limit_deg_s.is_some(),
                self.acceleration_limit_deg_s2.is_some(),
                self.jerk_limit_deg_s3.is_some(),
                self.torque_limit_nm.is_some(),
                self.link_mass_kg.is_some(),
                self.links.is_some(),
                self.flange_mass_kg.is_some(),
                self.friction.is_some(),
                self.blend_kappa.is_some(),
                self.tcp_blend_kappa.is_some(),
                self.settle_time_s.is_some(),
                self.blocking_pause_s.is_some(),
                self.t1_speed_mm_s.is_some(),
                self.ramps.is_some(),
            ]
            .into_iter()
            .filter(|&is_given| is_given)
            .count()
    }
}

impl LengthsWire {
    /// Keys and values, in the order of [`Lengths::all`].
    fn entries(&self) -> [(&'static str, Option<f64>); 4] {
        [
            ("base", self.base),
            ("upper_arm", self.upper_arm),
            ("forearm", self.forearm),
            ("flange", self.flange),
        ]
    }
}

impl Lengths {
    fn in_order(&self) -> [f64; 4] {
        [self.base_m, self.upper_arm_m, self.forearm_m, self.flange_m]
    }

    fn all(&mut self) -> [&mut f64; 4] {
        [&mut self.base_m, &mut self.upper_arm_m, &mut self.forearm_m, &mut self.flange_m]
    }
}
