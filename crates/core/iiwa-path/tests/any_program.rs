//! Random programs, also used to test the JSON Schema in `tests/peers`.

use iiwa_kin::Joints;
use iiwa_program::{Blend, Motion, Program, Ptp, Sources, Start, Workcell};
use proptest::prelude::*;

fn any_share() -> impl Strategy<Value = Joints> {
    let one = || prop_oneof![Just(1.0), 1e-3..1.0_f64, Just(1e-6)];
    prop_oneof![one().prop_map(|share| [share; 7]), prop::array::uniform7(one())]
}

fn any_joints() -> impl Strategy<Value = Joints> {
    use prop::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    prop_oneof![
        prop::array::uniform7(-3.0..3.0_f64),
        prop::array::uniform7(POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO),
    ]
}

fn any_blend() -> impl Strategy<Value = Option<Blend>> {
    prop_oneof![
        Just(None),
        (0.0..=0.5_f64).prop_map(|b| Some(Blend::Fraction(b))),
        (0.0..=1.0_f64).prop_map(|x| Some(Blend::SunriseRel(x))),
        (0.0..1e6_f64).prop_map(|r| Some(Blend::CartMm(r))),
    ]
}

fn any_motion() -> impl Strategy<Value = Motion> {
    prop_oneof![
        1 => (0.0..86_400.0_f64).prop_map(|seconds| Motion::Wait { seconds, overlap: 0 }),
        4 => (
            any_joints(), any_share(), any_share(), any_share(), any_blend(), any::<bool>()
        ).prop_map(
            |(target_rad, velocity_rel, acceleration_rel, jerk_rel, blend, blocking)| {
                let blocking = blocking && blend.is_none();
                Motion::Ptp(Ptp {
                    target_rad,
                    velocity_rel,
                    acceleration_rel,
                    jerk_rel,
                    blend,
                    blocking,
                })
            }
        ),
    ]
}

/// Programs of joint motions and waits.
pub(crate) fn any_program() -> impl Strategy<Value = Program> {
    let motions = prop::collection::vec(any_motion(), 1..10);
    (prop::option::of(".{0,20}"), any_joints(), motions).prop_map(
        |(robot, start_rad, mut motions)| {
            for i in 0..motions.len() {
                if !matches!(motions.get(i + 1), Some(Motion::Ptp(_)))
                    && let Motion::Ptp(ptp) = &mut motions[i]
                {
                    ptp.blend = None;
                }
            }
            Program {
                robot,
                start: Start::Joints(start_rad),
                motions,
                workcell: Workcell::default(),
                sources: Sources::default(),
            }
        },
    )
}
