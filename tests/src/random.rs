//! Random programs: any valid element, with unusual ones more frequent than in practice.

use iiwa_kin::{Joints, Robot};
use iiwa_path::JointPath;
use iiwa_program::{Blend, Motion, Program, Ptp, Sources, Start, Workcell};
use proptest::prelude::*;

/// Displacement of a motion: large, short, tiny, and zero.
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

/// Relative limits of a motion.
#[derive(Clone, Copy, Debug)]
struct Shares {
    velocity: Joints,
    acceleration: Joints,
    jerk: Joints,
}

const FULL: Shares = Shares { velocity: [1.0; 7], acceleration: [1.0; 7], jerk: [1.0; 7] };

/// Relative limits, mostly equal for all joints, as in practice, and mostly full jerk.
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
    /// Returns to the start of the previous motion: an exact reversal.
    Back {
        velocity: f64,
        blend: Option<Blend>,
    },
    /// Continues in the same direction.
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

/// Programs of up to `max_motions` motions for the LBR iiwa 7 that [`JointPath::new`] accepts.
pub fn programs(max_motions: usize) -> impl Strategy<Value = Program> {
    drafts(max_motions).prop_filter("a blend swings out of the limits", |program| {
        JointPath::new(program, &Robot::default()).is_ok()
    })
}

/// Programs of up to `max_motions` motions, including those whose blends leave the joint ranges.
pub fn drafts(max_motions: usize) -> impl Strategy<Value = Program> {
    (prop::array::uniform7(-1.2..1.2_f64), prop::collection::vec(draft(), 1..=max_motions))
        .prop_map(|(start_rad, drafts)| program(start_rad, &drafts))
}

fn program(start_rad: Joints, drafts: &[Draft]) -> Program {
    let limits = Robot::default().limits().upper_rad;
    let inside = |q: Joints| std::array::from_fn(|j| q[j].clamp(-limits[j], limits[j]));
    let (mut before, mut position) = (start_rad, start_rad);
    let mut motions: Vec<_> = drafts
        .iter()
        .map(|draft| {
            let (target, shares, blend) = match *draft {
                Draft::Wait(seconds) => return Motion::Wait { seconds, overlap: 0 },
                Draft::Go { step, shares, blend } => {
                    (std::array::from_fn(|j| position[j] + step[j]), shares, blend)
                }
                Draft::Back { velocity, blend } => {
                    (before, Shares { velocity: [velocity; 7], ..FULL }, blend)
                }
                Draft::On { by, blend } => (
                    std::array::from_fn(|j| position[j] + by * (position[j] - before[j])),
                    FULL,
                    blend,
                ),
            };
            before = position;
            position = inside(target);
            Motion::Ptp(Ptp {
                velocity_rel: shares.velocity,
                acceleration_rel: shares.acceleration,
                jerk_rel: shares.jerk,
                blend,
                ..Ptp::to(position)
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
