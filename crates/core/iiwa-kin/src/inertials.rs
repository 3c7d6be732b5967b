//! Masses, centres of mass and inertias of the built-in robots' links.

use crate::RigidBody;

/// Known inertial properties of links 1 to 7.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Links {
    /// Mass, centre of mass and inertia of each link.
    Known(Box<[RigidBody; 7]>),
    /// Masses only, in kg; centres and inertias follow from
    /// [`link_shapes`](crate::Robot::link_shapes) at uniform density.
    Masses([f64; 7]),
}

const fn link(mass_kg: f64, center_m: [f64; 3], inertia_kg_m2: [f64; 6]) -> RigidBody {
    RigidBody { mass_kg, center_m, inertia_kg_m2 }
}

/// Mass of link 0, in kg, from the CAD model of the public `lbr_description` (`lbr_fri_ros2_stack`,
/// Apache-2.0): 23.9 kg with [`IIWA_7`].
pub(crate) const IIWA_7_BASE_KG: f64 = 4.856;

/// Links of the LBR iiwa 7 R800 from the same model (`iiwa7_description.xacro` at 218d723),
/// converted to the frames of [`link_poses`](crate::Robot::link_poses).
#[rustfmt::skip]
pub(crate) const IIWA_7: [RigidBody; 7] = [
    link(3.394_011, [0.0, -0.034_819, 0.270_799],
         [0.021_383, 0.0, 0.0, 0.020_403, 0.003_797, 0.007_563]),
    link(4.031_991, [0.0, -0.086_944, 0.029_293],
         [0.031_697, 0.0, 0.0, 0.009_666, -0.005_889, 0.030_08]),
    link(3.394_011, [0.0, 0.034_819, 0.330_799],
         [0.021_383, 0.0, 0.0, 0.020_403, -0.003_797, 0.007_563]),
    link(4.031_989, [0.0, 0.086_944, 0.029_293],
         [0.031_695, 0.0, 0.0, 0.009_665, 0.005_889, 0.030_079]),
    link(1.529_239, [0.0, -0.029_824, 0.283_767],
         [0.008_485, 0.0, 0.0, 0.007_136, 0.002_806, 0.003_848]),
    link(2.403_626, [0.0, -0.004_95, 0.000_32],
         [0.007_067, 0.0, 0.0, 0.004_629, -0.000_311, 0.006_804]),
    link(0.259_474, [0.000_003, -0.000_002, 0.104_782],
         [0.000_171, 0.0, 0.0, 0.000_171, 0.0, 0.000_299]),
];

/// Mass of link 0, in kg, from the same description: 29.9 kg with [`IIWA_14`].
pub(crate) const IIWA_14_BASE_KG: f64 = 7.05;

/// Links of the LBR iiwa 14 R820, from a separate CAD model (`iiwa14_description.xacro` at
/// 218d723).
#[rustfmt::skip]
pub(crate) const IIWA_14: [RigidBody; 7] = [
    link(5.289_529, [0.0, -0.033_795, 0.279_904],
         [0.042_462, 0.0, 0.0, 0.042_838, 0.006_341, 0.015_87]),
    link(5.688_888, [0.000_136, -0.076_322, 0.037_548],
         [0.055_182, -0.000_056, -0.000_033, 0.016_523, -0.010_034, 0.053_983]),
    link(3.461_245, [0.0, 0.034_913, 0.351_108],
         [0.021_72, 0.0, 0.0, 0.020_73, -0.003_845, 0.007_701]),
    link(4.122_995, [0.0, 0.086_944, 0.029_293],
         [0.032_41, 0.0, 0.0, 0.009_883, 0.006_022, 0.030_758]),
    link(1.563_756, [0.0, -0.029_824, 0.283_767],
         [0.008_677, 0.0, 0.0, 0.007_297, 0.002_869, 0.003_935]),
    link(2.457_878, [0.0, -0.004_95, 0.000_32],
         [0.007_227, 0.0, 0.0, 0.004_734, -0.000_318, 0.006_958]),
    link(0.265_331, [0.000_003, -0.000_002, 0.104_782],
         [0.000_175, 0.0, 0.0, 0.000_175, 0.0, 0.000_306]),
];
