//! Robots exported as URDF, also for the readers in `tests/peers`.

#![expect(clippy::unwrap_used, reason = "a failed test panics")]

use iiwa_kin::{Robot, RosNames, RosStack};

/// Every model and flange exported as a URDF here.
pub(crate) fn robots() -> Vec<Robot> {
    [Robot::lbr_iiwa_7_r800(), Robot::lbr_iiwa_14_r820()]
        .into_iter()
        .flat_map(|robot| [robot.clone().with_flange_m(0.126).unwrap(), robot])
        .collect()
}

/// Naming conventions of ROS packages, with their default prefix and with another.
pub(crate) fn namings() -> [(RosNames, [&'static str; 4]); 4] {
    let of = |stack, prefix: &str| RosNames::new(stack, Some(prefix.parse().unwrap()));
    [
        (RosNames::default(), ["iiwa_joint_1", "iiwa_link_0", "iiwa_joint_ee", "iiwa_link_ee"]),
        (
            RosNames::new(RosStack::LbrFriRos2Stack, None),
            ["lbr_A1", "lbr_link_0", "lbr_joint_ee", "lbr_link_ee"],
        ),
        (
            of(RosStack::LbrFriRos2Stack, "left"),
            ["left_A1", "left_link_0", "left_joint_ee", "left_link_ee"],
        ),
        (of(RosStack::IiwaStack, "R2"), ["R2_joint_1", "R2_link_0", "R2_joint_ee", "R2_link_ee"]),
    ]
}

/// A robot whose name contains all characters that XML reserves.
pub(crate) fn odd_name() -> Robot {
    Robot::from_profile(r#"{ "version": 1, "name": "a \"<b>\" & 'c' ü" }"#).unwrap()
}
