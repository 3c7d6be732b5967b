//! Robot models: lengths, limits, masses.

use std::f64::consts::FRAC_PI_2;

use crate::{
    DhRow, Friction, Joints, Limits, RampLaw, RigidBody,
    inertials::{IIWA_7, IIWA_7_BASE_KG, IIWA_14, IIWA_14_BASE_KG, Links},
};

/// Twists `alpha_1` to `alpha_7` of the LBR iiwa, in quarter turns (Larsen 2019, Table 1).
pub(crate) const TWIST_QUARTERS: [i8; 7] = [-1, 1, 1, -1, -1, 1, 0];

/// The four lengths that distinguish one LBR iiwa from another, in m.
///
/// All other Denavit-Hartenberg lengths are zero: the axes of shoulder, elbow and wrist meet.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Lengths {
    /// d1: base to shoulder.
    pub base_m: f64,
    /// d3: shoulder to elbow.
    pub upper_arm_m: f64,
    /// d5: elbow to wrist.
    pub forearm_m: f64,
    /// d7: wrist to flange face. 126 mm for the plain flange (35 mm), 152 mm for the "Touch" media
    /// flange (61 mm) of Larsen 2019, Table 1.
    pub flange_m: f64,
}

/// An assumed quantity of a model, for which no source gives a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assumption {
    /// Name of the assumed quantity: `acceleration`, `jerk`, `masses`, `ramps`.
    pub quantity: String,
    /// Basis of the assumption.
    pub basis: String,
}

/// A model of the KUKA LBR iiwa.
///
/// ```
/// use iiwa_kin::Robot;
///
/// let robot = Robot::lbr_iiwa_7_r800();
/// let tcp = robot.flange_pose(&[0.0, 0.5, 0.0, -1.0, 0.0, 0.7, 0.0]);
/// assert!((tcp.position_m[0] - 0.713_659_663).abs() < 1e-9);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    pub(crate) name: String,
    pub(crate) lengths: Lengths,
    pub(crate) limits: Limits,
    pub(crate) base_mass_kg: f64,
    pub(crate) links: Links,
    pub(crate) flange_mass_kg: f64,
    pub(crate) friction: Friction,
    pub(crate) blend_kappa: [f64; 3],
    /// `None` if equal to `blend_kappa`.
    tcp_blend_kappa: Option<[f64; 3]>,
    pub(crate) settle_time_s: f64,
    pub(crate) blocking_pause_s: f64,
    pub(crate) t1_speed_m_s: f64,
    pub(crate) ramp_law: RampLaw,
    pub(crate) assumptions: Vec<Assumption>,
}

/// Largest accepted length of a model, in m.
pub(crate) const MAX_LENGTH_M: f64 = 10.0;

/// Error: a length outside the accepted range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("a length of {found_m} m; it must be above 0 and at most {MAX_LENGTH_M} m")]
pub struct BadLength {
    /// Length found, in m.
    pub found_m: f64,
}

impl Default for Robot {
    /// The LBR iiwa 7 R800.
    fn default() -> Self {
        Self::lbr_iiwa_7_r800()
    }
}

impl Robot {
    /// Names of the built-in models.
    pub const BUILT_IN: [&'static str; 2] = ["lbr_iiwa_7_r800", "lbr_iiwa_14_r820"];

    /// LBR iiwa 7 R800 with the media flange "Touch".
    ///
    /// Sources: lengths and speeds: Larsen 2019, Tables 1 and 2; accelerations: Table 2; jerks: the
    /// means of Table 5; positions and torques: KUKA data sheet; links: the CAD model of
    /// `lbr_description`.
    #[must_use]
    pub fn lbr_iiwa_7_r800() -> Self {
        Self {
            name: Self::BUILT_IN[0].to_owned(),
            lengths: Lengths {
                base_m: 0.340,
                upper_arm_m: 0.400,
                forearm_m: 0.400,
                flange_m: 0.152,
            },
            limits: Limits {
                lower_rad: rad(POSITION_DEG).map(|limit| -limit),
                upper_rad: rad(POSITION_DEG),
                velocity_rad_s: rad([98.0, 98.0, 100.0, 130.0, 140.0, 180.0, 180.0]),
                acceleration_rad_s2: rad([490.0, 490.0, 500.0, 650.0, 700.0, 900.0, 900.0]),
                jerk_rad_s3: rad(IIWA_7_JERK_DEG_S3),
                torque_nm: IIWA_7_TORQUE_NM,
            },
            base_mass_kg: IIWA_7_BASE_KG,
            links: Links::Known(Box::new(IIWA_7)),
            flange_mass_kg: 0.0,
            friction: Friction::default(),
            blend_kappa: KAPPA,
            tcp_blend_kappa: None,
            settle_time_s: SETTLE_TIME_S,
            blocking_pause_s: BLOCKING_PAUSE_S,
            t1_speed_m_s: T1_SPEED_M_S,
            ramp_law: RampLaw::iiwa_7(&IIWA_7_TORQUE_NM),
            assumptions: vec![Assumption {
                quantity: "masses".to_owned(),
                basis: MASSES_BASIS.to_owned(),
            }],
        }
    }

    /// LBR iiwa 14 R820 with the media flange "Touch".
    ///
    /// Sources: lengths, positions, speeds and torques: KUKA data sheet; links: the CAD model of
    /// `lbr_description`. Accelerations, jerks, masses and ramps are assumptions, see
    /// [`Robot::assumptions`].
    #[must_use]
    pub fn lbr_iiwa_14_r820() -> Self {
        let velocity_deg_s = [85.0, 85.0, 100.0, 75.0, 130.0, 135.0, 135.0];
        let acceleration_deg_s2 = velocity_deg_s.map(|v| ACCELERATION_PER_SPEED * v);
        let small = Self::lbr_iiwa_7_r800();
        let torque_nm = [320.0, 320.0, 176.0, 176.0, 110.0, 40.0, 40.0];
        let mut jerk_rad_s3 = rad(acceleration_deg_s2);
        for (j, jerk) in jerk_rad_s3.iter_mut().enumerate() {
            *jerk *= small.limits.jerk_rad_s3[j] / small.limits.acceleration_rad_s2[j];
        }
        Self {
            name: Self::BUILT_IN[1].to_owned(),
            lengths: Lengths { base_m: 0.360, upper_arm_m: 0.420, ..small.lengths },
            limits: Limits {
                velocity_rad_s: rad(velocity_deg_s),
                acceleration_rad_s2: rad(acceleration_deg_s2),
                jerk_rad_s3,
                torque_nm,
                ..small.limits
            },
            base_mass_kg: IIWA_14_BASE_KG,
            links: Links::Known(Box::new(IIWA_14)),
            flange_mass_kg: small.flange_mass_kg,
            friction: small.friction,
            blend_kappa: small.blend_kappa,
            tcp_blend_kappa: small.tcp_blend_kappa,
            settle_time_s: small.settle_time_s,
            blocking_pause_s: small.blocking_pause_s,
            t1_speed_m_s: small.t1_speed_m_s,
            ramp_law: small.ramp_law.scaled(&IIWA_7_TORQUE_NM, &torque_nm),
            assumptions: vec![
                Assumption {
                    quantity: "acceleration".to_owned(),
                    basis: "5/s times the speed limit, as measured on the LBR iiwa 7".to_owned(),
                },
                Assumption {
                    quantity: "jerk".to_owned(),
                    basis: "the LBR iiwa 7's ratio of jerk to acceleration".to_owned(),
                },
                Assumption { quantity: "masses".to_owned(), basis: MASSES_BASIS.to_owned() },
                Assumption {
                    quantity: "ramps".to_owned(),
                    basis: "the LBR iiwa 7's, as measured, by the ratio of the torque limits"
                        .to_owned(),
                },
            ],
        }
    }

    /// Built-in model with this name, one of [`Robot::BUILT_IN`].
    #[must_use]
    pub fn built_in(name: &str) -> Option<Self> {
        match Self::BUILT_IN.iter().position(|known| *known == name)? {
            0 => Some(Self::lbr_iiwa_7_r800()),
            _ => Some(Self::lbr_iiwa_14_r820()),
        }
    }

    /// Rated payload of the KUKA data sheet, in kg: 7 for the LBR iiwa 7 R800, 14 for the LBR iiwa
    /// 14 R820, which their link lengths identify; `None` for a robot of other lengths.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    ///
    /// let renamed = Robot::lbr_iiwa_14_r820().with_name("left arm");
    /// assert_eq!(renamed.rated_payload_kg(), Some(14.0));
    /// ```
    #[must_use]
    pub fn rated_payload_kg(&self) -> Option<f64> {
        let arm = |robot: &Self| [robot.lengths.base_m, robot.lengths.upper_arm_m];
        [(Self::lbr_iiwa_7_r800(), 7.0), (Self::lbr_iiwa_14_r820(), 14.0)]
            .into_iter()
            .find_map(|(model, payload_kg)| (arm(&model) == arm(self)).then_some(payload_kg))
    }

    /// Sets the flange length d7, from the wrist to the flange face, in m.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    ///
    /// let plain = Robot::lbr_iiwa_7_r800().with_flange_m(0.126)?;
    /// assert!((plain.flange_pose(&[0.0; 7]).position_m[2] - 1.266).abs() < 1e-12);
    /// # Ok::<(), iiwa_kin::BadLength>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the length is not a number, not above 0 or above 10 m.
    pub fn with_flange_m(mut self, flange_m: f64) -> Result<Self, BadLength> {
        if !(flange_m.is_normal() && flange_m > 0.0 && flange_m <= MAX_LENGTH_M) {
            return Err(BadLength { found_m: flange_m });
        }
        self.lengths.flange_m = flange_m;
        Ok(self)
    }

    /// Sets the name.
    #[must_use]
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Sets the limits, which must be above 0. Acceleration and jerk limits that change are no
    /// longer assumptions.
    #[must_use]
    pub fn with_limits(mut self, limits: Limits) -> Self {
        if limits.acceleration_rad_s2 != self.limits.acceleration_rad_s2 {
            self.drop_assumption("acceleration");
        }
        if limits.jerk_rad_s3 != self.limits.jerk_rad_s3 {
            self.drop_assumption("jerk");
        }
        self.limits = limits;
        self
    }

    /// Sets the coefficients of [`kappa`](Self::blend_kappa).
    #[must_use]
    pub fn with_blend_kappa(mut self, blend_kappa: [f64; 3]) -> Self {
        self.blend_kappa = blend_kappa;
        self
    }

    /// Sets the coefficients of [`tcp_kappa`](Self::tcp_kappa).
    #[must_use]
    pub fn with_tcp_blend_kappa(mut self, tcp_blend_kappa: [f64; 3]) -> Self {
        self.tcp_blend_kappa = (tcp_blend_kappa != self.blend_kappa).then_some(tcp_blend_kappa);
        self
    }

    /// Sets the settling time, in s, above 0.
    #[must_use]
    pub fn with_settle_time_s(mut self, settle_time_s: f64) -> Self {
        self.settle_time_s = settle_time_s;
        self
    }

    /// Replaces the ramp law and removes it from the assumptions.
    #[must_use]
    pub fn with_ramp_law(mut self, ramp_law: RampLaw) -> Self {
        self.ramp_law = ramp_law;
        self.drop_assumption("ramps");
        self
    }

    /// Sets links 1 to 7, given in the frames of [`Robot::link_poses`]; their masses are no longer
    /// an assumption.
    #[must_use]
    pub fn with_links(mut self, links: [RigidBody; 7]) -> Self {
        self.links = Links::Known(Box::new(links));
        self.drop_assumption("masses");
        self
    }

    /// Sets the masses of link 0 (the base) to link 7, in kg, above 0, with the inertias of simple
    /// shapes. The masses are no longer an assumption.
    #[must_use]
    pub fn with_link_mass_kg(mut self, link_mass_kg: [f64; 8]) -> Self {
        let [foot, links @ ..] = link_mass_kg;
        self.base_mass_kg = foot;
        self.links = Links::Masses(links);
        self.drop_assumption("masses");
        self
    }

    /// Sets the [flange mass](Self::flange_mass_kg), in kg.
    #[must_use]
    pub fn with_flange_mass_kg(mut self, flange_mass_kg: f64) -> Self {
        self.flange_mass_kg = flange_mass_kg;
        self
    }

    /// Sets the joint friction.
    #[must_use]
    pub fn with_friction(mut self, friction: Friction) -> Self {
        self.friction = friction;
        self
    }

    /// Model name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Link lengths.
    #[must_use]
    pub fn lengths(&self) -> &Lengths {
        &self.lengths
    }

    /// Joint limits.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Flange mass in addition to link 7, in kg, for example of a media flange; 0 unless a profile
    /// gives one. It is modelled as a point mass on axis 7, 13 mm behind the flange face.
    #[must_use]
    pub fn flange_mass_kg(&self) -> f64 {
        self.flange_mass_kg
    }

    /// Joint friction; zero unless a profile gives it.
    #[must_use]
    pub fn friction(&self) -> &Friction {
        &self.friction
    }

    /// Blend coefficient kappa (Larsen 2019, Eq. 39) at the angle gamma between the two directions,
    /// in degrees: 0 straight on, 180 reversed.
    ///
    /// ```
    /// let robot = iiwa_kin::Robot::lbr_iiwa_7_r800();
    /// assert!((robot.kappa(0.0) + 3.974).abs() < 1e-3);
    /// ```
    #[must_use]
    pub fn kappa(&self, gamma_deg: f64) -> f64 {
        parabola(&self.blend_kappa, gamma_deg)
    }

    /// Coefficients of [`kappa`](Self::kappa) as a polynomial of gamma in degrees, lowest power
    /// first.
    #[must_use]
    pub fn blend_kappa(&self) -> &[f64; 3] {
        &self.blend_kappa
    }

    /// Blend coefficient kappa of blends between two Cartesian TCP paths, at the angle gamma
    /// between the TCP directions, in degrees. No measurement exists: [`kappa`](Self::kappa) is
    /// used unless the robot has a separate value.
    ///
    /// ```
    /// let robot = iiwa_kin::Robot::lbr_iiwa_7_r800();
    /// assert_eq!(robot.tcp_kappa(90.0), robot.kappa(90.0));
    /// let measured = robot.with_tcp_blend_kappa([-3.0, 0.01, 0.0]);
    /// assert!((measured.tcp_kappa(90.0) + 2.1).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn tcp_kappa(&self, gamma_deg: f64) -> f64 {
        parabola(self.tcp_blend_kappa(), gamma_deg)
    }

    /// Coefficients of [`tcp_kappa`](Self::tcp_kappa) as a polynomial of gamma in degrees, lowest
    /// power first.
    #[must_use]
    pub fn tcp_blend_kappa(&self) -> &[f64; 3] {
        self.tcp_blend_kappa.as_ref().unwrap_or(&self.blend_kappa)
    }

    /// Settling time at rest after a motion without a blend, if the next motion is known by then,
    /// in s.
    #[must_use]
    pub fn settle_time_s(&self) -> f64 {
        self.settle_time_s
    }

    /// Mean standstill after a blocking motion, whose end the program waits for, in s. Motions
    /// start on a 12 ms clock, at the first tick at least 87.2 ms after that end: between 87 and 99
    /// ms.
    #[must_use]
    pub fn blocking_pause_s(&self) -> f64 {
        self.blocking_pause_s
    }

    /// Speed limit of TCP and flange in operating mode T1, in m/s.
    #[must_use]
    pub fn t1_speed_m_s(&self) -> f64 {
        self.t1_speed_m_s
    }

    /// Law of the acceleration ramps at the start and end of PTP motions.
    #[must_use]
    pub fn ramp_law(&self) -> &RampLaw {
        &self.ramp_law
    }

    /// Assumed quantities of this model, for which no source gives a value.
    ///
    /// ```
    /// let robot = iiwa_kin::Robot::lbr_iiwa_14_r820();
    /// let assumed: Vec<_> = robot.assumptions().iter().map(|a| a.quantity.as_str()).collect();
    /// assert_eq!(assumed, ["acceleration", "jerk", "masses", "ramps"]);
    /// ```
    #[must_use]
    pub fn assumptions(&self) -> &[Assumption] {
        &self.assumptions
    }

    /// Adds an assumption, or replaces the assumption of the same quantity.
    ///
    /// ```
    /// let robot = iiwa_kin::Robot::lbr_iiwa_7_r800()
    ///     .with_assumption("velocity of A2", "not shown by the recordings");
    /// assert!(robot.assumes("velocity of A2"));
    /// ```
    #[must_use]
    pub fn with_assumption(
        mut self,
        quantity: impl Into<String>,
        basis: impl Into<String>,
    ) -> Self {
        let (quantity, basis) = (quantity.into(), basis.into());
        self.drop_assumption(&quantity);
        self.assumptions.push(Assumption { quantity, basis });
        self
    }

    /// Removes an assumption, once the quantity has a source.
    pub(crate) fn drop_assumption(&mut self, quantity: &str) {
        self.assumptions.retain(|assumption| assumption.quantity != quantity);
    }

    /// Returns true if the quantity `quantity` (for example `acceleration`) is an assumption.
    #[must_use]
    pub fn assumes(&self, quantity: &str) -> bool {
        self.assumptions.iter().any(|a| a.quantity == quantity)
    }

    /// Denavit-Hartenberg table (Larsen 2019, Table 1).
    #[must_use]
    pub fn dh(&self) -> [DhRow; 7] {
        let l = &self.lengths;
        let d = [l.base_m, 0.0, l.upper_arm_m, 0.0, l.forearm_m, 0.0, l.flange_m];
        std::array::from_fn(|j| DhRow {
            a_m: 0.0,
            alpha_rad: f64::from(TWIST_QUARTERS[j]) * FRAC_PI_2,
            d_m: d[j],
        })
    }

    /// Largest distance of the flange from each joint axis, in m.
    ///
    /// This bounds the contribution of each joint to the flange speed:
    /// `|dp/dq_j| <= axis_reach_m()[j]`. The axes of joints 1 and 2 meet in the shoulder, those of
    /// 3 and 4 in the elbow (through which axis 3 passes), those of 5 and 6 in the wrist; the axis
    /// of joint 7 passes through the flange centre.
    ///
    /// ```
    /// let reach_m = iiwa_kin::Robot::lbr_iiwa_7_r800().axis_reach_m();
    /// assert!((reach_m[0] - 0.952).abs() < 1e-12 && reach_m[6] == 0.0);
    /// ```
    #[must_use]
    pub fn axis_reach_m(&self) -> Joints {
        let l = &self.lengths;
        let wrist = l.flange_m;
        let elbow = l.forearm_m + wrist;
        let shoulder = l.upper_arm_m + elbow;
        [shoulder, shoulder, elbow, elbow, wrist, wrist, 0.0]
    }
}

/// Coefficients of Larsen 2019, Eq. 38, for gamma in degrees.
const KAPPA: [f64; 3] = [-3.974_264_71, 0.006_260_16, 0.000_284_72];

/// Settling time of Larsen 2019, section 2.4.2; Table 6 of Appendix C has a mean of 0.0496 s.
const SETTLE_TIME_S: f64 = 0.05;

/// Minimum of 87.2 ms plus half a tick of 12 ms, rounded: 73 of 75 standstills recorded on an LBR
/// iiwa 7 (source: see [`RampLaw`]) are within that tick.
const BLOCKING_PAUSE_S: f64 = 0.093;

/// Measured on an LBR iiwa 7, at an override of 50 % (source: see [`RampLaw`]). KUKA specifies 250
/// mm/s as the maximum.
const T1_SPEED_M_S: f64 = 0.225;

/// Position limits of both models, in either direction, in degrees.
const POSITION_DEG: Joints = [170.0, 120.0, 170.0, 120.0, 170.0, 120.0, 175.0];

/// Torque limits of the KUKA data sheet.
const IIWA_7_TORQUE_NM: Joints = [176.0, 176.0, 110.0, 110.0, 110.0, 40.0, 40.0];

/// Jerks: means of Larsen 2019, Table 5.
const IIWA_7_JERK_DEG_S3: Joints =
    [10_384.86, 7_757.85, 9_986.65, 9_700.18, 19_406.08, 32_260.39, 33_028.15];

/// Basis of the masses.
const MASSES_BASIS: &str = "a CAD estimate; published models differ by tens of percent";

/// Ratio of measured acceleration to catalogue speed on every joint of the LBR iiwa 7, in 1/s
/// (Larsen 2019, Tables 2 and 4).
const ACCELERATION_PER_SPEED: f64 = 5.0;

fn parabola([c0, c1, c2]: &[f64; 3], x: f64) -> f64 {
    (c2 * x + c1) * x + c0
}

fn rad(deg: Joints) -> Joints {
    deg.map(f64::to_radians)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kappa_matches_the_stated_values() {
        let robot = Robot::default();
        assert!((robot.kappa(0.0) + 3.974).abs() < 5e-4);
        assert!(robot.kappa(107.7).abs() < 5e-3);
        assert!((robot.kappa(180.0) - 6.378).abs() < 1e-3);
    }

    #[test]
    fn limits_that_change_are_no_longer_assumptions() {
        let robot = Robot::lbr_iiwa_14_r820();
        let are_assumed = |change: fn(&mut Limits)| {
            let mut limits = *robot.limits();
            change(&mut limits);
            let robot = robot.clone().with_limits(limits);
            ["acceleration", "jerk"].map(|quantity| robot.assumes(quantity))
        };
        assert_eq!(are_assumed(|_| {}), [true, true]);
        assert_eq!(are_assumed(|limits| limits.velocity_rad_s[2] *= 0.5), [true, true]);
        assert_eq!(are_assumed(|limits| limits.acceleration_rad_s2[2] *= 0.5), [false, true]);
        assert_eq!(are_assumed(|limits| limits.jerk_rad_s3[6] *= 2.0), [true, false]);
    }

    /// KUKA data sheets: speeds in deg/s, torques in Nm.
    #[test]
    fn built_in_robots_have_the_limits_of_their_data_sheets() {
        let cases = [
            (
                Robot::lbr_iiwa_7_r800(),
                [98.0, 98.0, 100.0, 130.0, 140.0, 180.0, 180.0],
                [176.0, 176.0, 110.0, 110.0, 110.0, 40.0, 40.0],
            ),
            (
                Robot::lbr_iiwa_14_r820(),
                [85.0, 85.0, 100.0, 75.0, 130.0, 135.0, 135.0],
                [320.0, 320.0, 176.0, 176.0, 110.0, 40.0, 40.0],
            ),
        ];
        for (robot, velocity_deg_s, torque_nm) in cases {
            let limits = robot.limits();
            for j in 0..7 {
                let actual = limits.velocity_rad_s[j].to_degrees();
                assert!(
                    (actual - velocity_deg_s[j]).abs() < 1e-9,
                    "{} {j}: {actual}",
                    robot.name()
                );
                let range = [170.0, 120.0, 170.0, 120.0, 170.0, 120.0, 175.0][j];
                let actual = [limits.lower_rad[j], limits.upper_rad[j]].map(f64::to_degrees);
                assert!((actual[0] + range).abs() + (actual[1] - range).abs() < 1e-9, "{actual:?}");
            }
            assert_eq!(limits.torque_nm, torque_nm, "{}", robot.name());
        }
    }
}
