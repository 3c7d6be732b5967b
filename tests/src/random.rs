//! Random programs: everything that a program may hold, the odd things more often than in life.

use iiwa_kin::{Joints, Robot};
use iiwa_path::JointPath;
use iiwa_program::{Blend, Motion, Program, Ptp, Sources, Start, Workcell};
use proptest::prelude::*;

/// How far a motion goes: whole sweeps of the arm, short moves, tiny ones, and none.
fn step() -> impl Strategy<Value = Joints> {
    let size = prop_oneof![
        6 => Just(1.5),
        4 => Just(0.3),
        1 => Just(1e-3),
        1 => Just(1e-6),
        1 => Just(0.0),
    ];
    let some_joints = prop_oneof![
        4 => Just([true; 7]),
        1 => prop::array::uniform7(any::<bool>()),
        1 => (0..7_usize).prop_map(|j| std::array::from_fn(|k| k == j)),
    ];
    (size, some_joints, prop::array::uniform7(-1.0..1.0_f64)).prop_map(|(size, some, step)| {
        std::array::from_fn(|j| if some[j] { size * step[j] } else { 0.0 })
    })
}

fn share() -> impl Strategy<Value = f64> {
    prop_oneof![3 => Just(1.0), 3 => 0.05..1.0_f64, 1 => Just(0.01)]
}

/// Shares of the limits of a motion.
#[derive(Clone, Copy, Debug)]
struct Shares {
    velocity: Joints,
    acceleration: Joints,
    jerk: Joints,
}

const FULL: Shares = Shares { velocity: [1.0; 7], acceleration: [1.0; 7], jerk: [1.0; 7] };

/// Mostly the same share for all joints, as in life, and mostly all of the jerk.
fn shares() -> impl Strategy<Value = Shares> {
    let jerk = prop_oneof![4 => Just(1.0), 1 => share()];
    let same = (share(), share(), jerk).prop_map(|(velocity, acceleration, jerk)| Shares {
        velocity: [velocity; 7],
        acceleration: [acceleration; 7],
        jerk: [jerk; 7],
    });
    let each = || prop::array::uniform7(prop_oneof![Just(1.0), 0.2..1.0_f64]);
    let apart = (each(), each(), each()).prop_map(|(velocity, acceleration, jerk)| Shares {
        velocity,
        acceleration,
        jerk,
    });
    prop_oneof![5 => same, 1 => apart]
}

fn blend() -> impl Strategy<Value = Option<Blend>> {
    prop_oneof![
        2 => Just(None),
        3 => (0.0..0.5_f64).prop_map(|b| Some(Blend::Fraction(b))),
        2 => Just(Some(Blend::Fraction(0.5))),
        1 => (0.0..1.0_f64).prop_map(|x| Some(Blend::SunriseRel(x))),
        3 => (1.0..300.0_f64).prop_map(|r| Some(Blend::CartMm(r))),
    ]
}

#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "nearly all drafts are of the large kind")]
enum Draft {
    Go {
        step: Joints,
        shares: Shares,
        blend: Option<Blend>,
    },
    /// Back to where the motion before came from: an exact turn-back.
    Back {
        velocity: f64,
        blend: Option<Blend>,
    },
    /// On in the same direction.
    On {
        by: f64,
        blend: Option<Blend>,
    },
    Wait(f64),
}

fn draft() -> impl Strategy<Value = Draft> {
    prop_oneof![
        12 => (step(), shares(), blend())
            .prop_map(|(step, shares, blend)| Draft::Go { step, shares, blend }),
        1 => (share(), blend()).prop_map(|(velocity, blend)| Draft::Back { velocity, blend }),
        1 => (0.1..1.0_f64, blend()).prop_map(|(by, blend)| Draft::On { by, blend }),
        1 => (0.0..2.0_f64).prop_map(Draft::Wait),
    ]
}

/// Programs of up to `most` motions for the LBR iiwa 7 that [`JointPath::new`] takes.
pub fn programs(most: usize) -> impl Strategy<Value = Program> {
    drafts(most).prop_filter("a blend swings out of the limits", |program| {
        JointPath::new(program, &Robot::default()).is_ok()
    })
}

/// The same, those among them whose blends swing out of the joints' ranges.
pub fn drafts(most: usize) -> impl Strategy<Value = Program> {
    (prop::array::uniform7(-1.2..1.2_f64), prop::collection::vec(draft(), 1..=most))
        .prop_map(|(start_rad, drafts)| program(start_rad, &drafts))
}

fn program(start_rad: Joints, drafts: &[Draft]) -> Program {
    let limits = Robot::default().limits().upper_rad;
    let inside = |q: Joints| std::array::from_fn(|j| q[j].clamp(-limits[j], limits[j]));
    let (mut before, mut at) = (start_rad, start_rad);
    let mut motions: Vec<_> = drafts
        .iter()
        .map(|draft| {
            let (target, shares, blend) = match *draft {
                Draft::Wait(seconds) => return Motion::Wait { seconds, overlap: 0 },
                Draft::Go { step, shares, blend } => {
                    (std::array::from_fn(|j| at[j] + step[j]), shares, blend)
                }
                Draft::Back { velocity, blend } => {
                    (before, Shares { velocity: [velocity; 7], ..FULL }, blend)
                }
                Draft::On { by, blend } => {
                    (std::array::from_fn(|j| at[j] + by * (at[j] - before[j])), FULL, blend)
                }
            };
            before = at;
            at = inside(target);
            Motion::Ptp(Ptp {
                velocity_rel: shares.velocity,
                acceleration_rel: shares.acceleration,
                jerk_rel: shares.jerk,
                blend,
                ..Ptp::to(at)
            })
        })
        .collect();
    for i in 0..motions.len() {
        if !matches!(motions.get(i + 1), Some(Motion::Ptp(_)))
            && let Motion::Ptp(ptp) = &mut motions[i]
        {
            ptp.blend = None;
        }
    }
    Program {
        robot: None,
        start: Start::Joints(start_rad),
        motions,
        workcell: Workcell::default(),
        sources: Sources::default(),
    }
}
