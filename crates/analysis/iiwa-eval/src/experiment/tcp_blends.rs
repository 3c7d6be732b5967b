//! Corners of TCP paths, designed to identify how a robot blends them.

use iiwa_kin::Status;
use iiwa_program::{
    AuxOrientation, CartesianMotion, Circ, Course, Frame, LimitKind, Motion, PathBlend, Program,
    Sources, Start, Target, TargetRef, Workcell,
};

use super::trial::Trial;

/// Series of corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TcpSeries {
    /// Two LINs of unequal lengths, at angles every 10 deg from 0 to 170: kappa over gamma, and the
    /// reach of blends.
    Angles,
    /// Blends longer than half of the shorter of two LINs: they show if both sides are made equally
    /// long.
    Shares,
    /// LINs with changes of orientation and E1.
    Turns,
    /// LIN into CIRC, and CIRC into LIN.
    Circles,
    /// PTP into LIN, and LIN into PTP.
    Joints,
}

impl TcpSeries {
    /// All series.
    pub const ALL: [Self; 5] =
        [Self::Angles, Self::Shares, Self::Turns, Self::Circles, Self::Joints];
}

/// Position of the corners, in mm: in front of the robot, with the flange pointing downwards. Both
/// robot models reach all points around it with the elbow bent, far from singular poses and joint
/// limits.
const CORNER_MM: [f64; 3] = [520.0, 0.0, 350.0];

/// TCP speed, in m/s: that of the operating mode T1. The path is assumed to be independent of the
/// speed.
const SPEED_M_S: f64 = 0.25;

/// Share of full speed in point-to-point motions.
const PTP_SPEED_REL: f64 = 0.3;

/// Frame with its E1.
#[derive(Clone, Copy)]
struct Waypoint {
    xyz_mm: [f64; 3],
    /// Rotation from the orientation straight downwards: a, b, c in degrees.
    turn_deg: [f64; 3],
    e1_deg: f64,
}

impl Waypoint {
    /// Creates a waypoint at a distance in mm from the corner, in the direction rotated by
    /// `angle_deg` from y towards x.
    fn about(mm: f64, angle_deg: f64) -> Self {
        Self::beside([mm, 0.0], angle_deg)
    }

    /// Creates a waypoint at a distance along that direction and at another one to its right.
    fn beside([along_mm, right_mm]: [f64; 2], angle_deg: f64) -> Self {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let [x, y, z] = CORNER_MM;
        let xyz_mm = [x + along_mm * sin + right_mm * cos, y + along_mm * cos - right_mm * sin, z];
        Self { xyz_mm, turn_deg: [0.0; 3], e1_deg: 0.0 }
    }

    fn turned(self, turn_deg: [f64; 3], e1_deg: f64) -> Self {
        Self { turn_deg, e1_deg, ..self }
    }

    fn target(&self) -> Target {
        let [a, b, c] = self.turn_deg;
        let frame = Frame { xyz_mm: self.xyz_mm, abc_rad: [a, 180.0 + b, c].map(f64::to_radians) };
        Target { e1_rad: Some(self.e1_deg.to_radians()), ..Target::at(frame) }
    }

    fn lin(&self) -> CartesianMotion {
        motion(Course::Lin { to: TargetRef::Given(self.target()) })
    }

    fn ptp(&self) -> CartesianMotion {
        // Elbow up, and the wrist configuration of the downward flange.
        let target = Target { status: Status::new(ELBOW_UP), ..self.target() };
        let mut ptp = CartesianMotion::new(Course::Ptp { to: TargetRef::Given(target) });
        ptp.shares[LimitKind::Velocity] = [PTP_SPEED_REL; 7];
        ptp
    }

    fn circ(&self, by_way_of: &Self) -> CartesianMotion {
        motion(Course::Circ(Circ {
            aux: TargetRef::Given(by_way_of.target()),
            to: TargetRef::Given(self.target()),
            angle_rad: None,
            turns_with_path: false,
            aux_orientation: AuxOrientation::Ignore,
            extrapolates: false,
        }))
    }
}

/// Status bits: A4 is negative, A6 is not.
const ELBOW_UP: u8 = 0b010;

fn motion(course: Course) -> CartesianMotion {
    let mut motion = CartesianMotion::new(course);
    motion.tool_limits.way[LimitKind::Velocity] = SPEED_M_S;
    motion
}

fn blended(mut motion: CartesianMotion, mm: f64) -> CartesianMotion {
    motion.blend = Some(PathBlend::cart_mm(mm));
    motion
}

/// Creates one program with the corners of all `series`, for a single recording. There is no tool:
/// the TCP is the flange centre.
#[must_use]
pub fn tcp_blends(series: &[TcpSeries]) -> Trial {
    let home = Waypoint::about(INTO_MM, 180.0);
    let motions = series.iter().flat_map(|series| match series {
        TcpSeries::Angles => angles(),
        TcpSeries::Shares => shares(),
        TcpSeries::Turns => turns(),
        TcpSeries::Circles => circles(),
        TcpSeries::Joints => joints(),
    });
    let start = Target { status: Status::new(ELBOW_UP), ..home.target() };
    let program = Program {
        robot: None,
        start: Start::Frame(TargetRef::Given(start)),
        motions: motions.map(|motion| Motion::Cartesian(Box::new(motion))).collect(),
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    Trial { name: "tcp-blends".to_owned(), program }
}

/// Lengths of the lines into and out of a corner, and the blend distance, in mm.
const INTO_MM: f64 = 120.0;
const OUT_MM: f64 = 90.0;
const BLEND_MM: f64 = 40.0;

fn angles() -> Vec<CartesianMotion> {
    let start = Waypoint::about(INTO_MM, 180.0);
    let corner = |i: u32| {
        let end = Waypoint::about(OUT_MM, 10.0 * f64::from(i));
        [blended(Waypoint::about(0.0, 0.0).lin(), BLEND_MM), end.lin(), start.lin()]
    };
    (0..=17).flat_map(corner).collect()
}

fn shares() -> Vec<CartesianMotion> {
    /// Lengths such that the blend is longer than half of the shorter line, but not of the longer
    /// one.
    const WAYS_MM: [f64; 2] = [160.0, 70.0];
    const ASKED_MM: f64 = 60.0;
    let [long, short] = WAYS_MM;
    let corner = |i: u32, [into_mm, out_mm]: [f64; 2]| {
        let end = Waypoint::about(out_mm, 30.0 * f64::from(i));
        let to_corner = blended(Waypoint::about(0.0, 0.0).lin(), ASKED_MM);
        [Waypoint::about(into_mm, 180.0).lin(), to_corner, end.lin()]
    };
    let both = |i| [corner(i, [long, short]), corner(i, [short, long])];
    (1..=5).flat_map(both).flatten().collect()
}

fn turns() -> Vec<CartesianMotion> {
    /// Angle of the corner; rotation and E1 at the corner; rotation and E1 after it. All in
    /// degrees.
    type CornerTurn = (f64, [f64; 3], f64, [f64; 3], f64);
    const TURNS: [CornerTurn; 7] = [
        (90.0, [15.0, 0.0, 0.0], 0.0, [15.0, 20.0, 0.0], 0.0),
        (60.0, [0.0, 0.0, 20.0], 0.0, [0.0, 0.0, -20.0], 0.0),
        (120.0, [25.0, 0.0, 0.0], 0.0, [-25.0, 0.0, 0.0], 0.0),
        (90.0, [0.0; 3], 10.0, [0.0; 3], 20.0),
        (60.0, [0.0; 3], 15.0, [0.0; 3], -15.0),
        (0.0, [0.0; 3], 15.0, [0.0; 3], 0.0),
        (120.0, [10.0, 15.0, 0.0], 10.0, [-10.0, 0.0, 15.0], -10.0),
    ];
    let corner = |(angle_deg, turn, e1_deg, turn_behind, e1_behind_deg): CornerTurn| {
        let corner = Waypoint::about(0.0, 0.0).turned(turn, e1_deg);
        let end = Waypoint::about(INTO_MM, angle_deg).turned(turn_behind, e1_behind_deg);
        [Waypoint::about(INTO_MM, 180.0).lin(), blended(corner.lin(), BLEND_MM), end.lin()]
    };
    TURNS.into_iter().flat_map(corner).collect()
}

fn circles() -> Vec<CartesianMotion> {
    const RADIUS_MM: f64 = 90.0;
    let start = Waypoint::about(INTO_MM, 180.0);
    let there_and_back = |angle_deg: f64| {
        let on_circle = |by_deg: f64| {
            let (sin, cos) = by_deg.to_radians().sin_cos();
            Waypoint::beside([RADIUS_MM * sin, RADIUS_MM * (1.0 - cos)], angle_deg)
        };
        let (corner, end) = (Waypoint::about(0.0, 0.0), on_circle(90.0));
        [
            start.lin(),
            blended(corner.lin(), BLEND_MM),
            end.circ(&on_circle(45.0)),
            blended(corner.circ(&on_circle(45.0)), BLEND_MM),
            start.lin(),
        ]
    };
    [0.0, 45.0, 90.0].into_iter().flat_map(there_and_back).collect()
}

fn joints() -> Vec<CartesianMotion> {
    /// Ends of the point-to-point motions, in mm.
    const AWAY_MM: [[f64; 3]; 2] = [[400.0, -250.0, 450.0], [600.0, -200.0, 300.0]];
    let there_and_back = |xyz_mm: [f64; 3], angle_deg: f64| {
        let (corner, end) = (Waypoint::about(0.0, 0.0), Waypoint::about(INTO_MM, angle_deg));
        let away = Waypoint { xyz_mm, ..corner };
        [
            away.ptp(),
            blended(corner.ptp(), BLEND_MM),
            end.lin(),
            blended(corner.lin(), BLEND_MM),
            away.ptp(),
        ]
    };
    AWAY_MM
        .into_iter()
        .flat_map(|away| [0.0, 90.0].map(|angle_deg| there_and_back(away, angle_deg)))
        .flatten()
        .collect()
}

#[cfg(test)]
mod tests {
    use iiwa_kin::Robot;
    use iiwa_path::{JointPath, Step};

    use super::*;

    /// With either flange, no pose is near a singularity, and no joint near its limit.
    #[test]
    fn both_models_reach_it_easily() {
        let trial = tcp_blends(&TcpSeries::ALL);
        for name in Robot::BUILT_IN {
            for flange_m in [0.126, 0.152] {
                let robot = Robot::built_in(name).unwrap().with_flange_m(flange_m).unwrap();
                let path = JointPath::new(&trial.program, &robot).unwrap();
                let (mut min_singularity, mut spare_rad) = (f64::MAX, f64::MAX);
                for step in path.steps() {
                    let Step::Move { segment, .. } = step else { continue };
                    for i in 0..=20 {
                        let q = segment.at(f64::from(i) / 20.0).q;
                        min_singularity = min_singularity.min(robot.singularity(&q).nearest().0);
                        let upper = &robot.limits().upper_rad;
                        let spare = |j: usize| upper[j] - q[j].abs();
                        spare_rad = (0..7).map(spare).fold(spare_rad, f64::min);
                    }
                }
                assert!(min_singularity > 0.3, "{name}, {flange_m}: {min_singularity}");
                assert!(spare_rad > 0.25, "{name}, {flange_m}: {spare_rad}");
            }
        }
    }

    /// Every corner is blended, except where a LIN returns.
    #[test]
    fn corners_are_as_documented() {
        let trial = tcp_blends(&TcpSeries::ALL);
        let path = JointPath::new(&trial.program, &Robot::default()).unwrap();
        let gammas: Vec<_> = path.blends().map(|(corner, _)| corner.gamma_deg).collect();
        assert_eq!(gammas.len(), 18 + 10 + 7 + 6 + 8);
        for (i, gamma) in gammas[..18].iter().enumerate() {
            assert!((gamma - 10.0 * i as f64).abs() < 1e-6, "{i}: {gamma}");
        }
        for (i, gamma) in gammas[18..28].iter().enumerate() {
            assert!((gamma - 30.0 * (1 + i / 2) as f64).abs() < 1e-6, "{i}: {gamma}");
        }
        for (gamma, expected) in gammas[35..41].iter().zip([0.0, 0.0, 45.0, 45.0, 90.0, 90.0]) {
            assert!((gamma - expected).abs() < 1e-6, "{gamma}");
        }
    }
}
