//! Arbitrary numbers, JSON and bytes cause no panic.

use iiwa_kin::Robot;
use iiwa_link::{
    TimedJoints,
    message::{Refusal, Request},
};
use proptest::prelude::*;

/// Returns numbers of all kinds, including unusual ones.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -3.0..3.0_f64,
        2 => prop::num::f64::ANY,
        1 => prop::sample::select(vec![
            0.0, -0.0, 1e-300, 5e-324, 1e300, f64::MAX, f64::MIN, f64::NAN, f64::INFINITY,
        ]),
    ]
}

fn json() -> impl Strategy<Value = serde_json::Value> {
    use serde_json::Value;
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        number().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        ".{0,8}".prop_map(Value::from),
        prop::sample::select(Request::TYPES.to_vec()).prop_map(Value::from),
    ];
    let key = prop::sample::select(vec![
        "type",
        "id",
        "motions",
        "trajectory",
        "t_s",
        "joints_rad",
        "joints_deg",
        "name",
        "value",
        "seconds",
        "blend",
        "x\u{7}",
    ]);
    leaf.prop_recursive(4, 40, 8, move |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..8).prop_map(Value::from),
            prop::collection::vec((key.clone(), inner), 0..6).prop_map(|pairs| {
                pairs.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
            }),
        ]
    })
}

/// Asserts that the message is short and printable on one line.
fn assert_readable(refusal: &Refusal) {
    let Refusal { message, .. } = refusal;
    assert!(!message.is_empty() && message.len() <= 600, "{message}");
    assert!(!message.contains(char::is_control), "{message:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_numbers_cause_no_panic(
        mut t_s in prop::collection::vec(number(), 0..20),
        joints_rad in prop::collection::vec(prop::array::uniform7(number()), 0..20),
        form in 0..3,
        time_s in number(),
        start in prop::array::uniform7(number()),
    ) {
        if form > 0 {
            // Sorted, so that the check proceeds further.
            t_s.sort_by(f64::total_cmp);
            t_s.resize(joints_rad.len(), 1e9);
        }
        let trajectory = TimedJoints { t_s, joints_rad };
        let _ = (trajectory.at(time_s), trajectory.at(0.0), trajectory.duration_s());
        for start in [start, trajectory.joints_rad.first().copied().unwrap_or_default()] {
            if let Err(refusal) = trajectory.check(Robot::default().limits(), &start) {
                assert_readable(&refusal);
            }
        }
    }

    #[test]
    fn arbitrary_json_causes_no_panic(
        value in json(),
        name in prop::sample::select(Request::TYPES.to_vec()),
    ) {
        for with_type in [false, true] {
            let mut value = value.clone();
            if with_type && let Some(object) = value.as_object_mut() {
                object.insert("type".to_owned(), name.into());
            }
            let (_, request) = Request::from_json(value.to_string().as_bytes());
            match request {
                Err(refusal) => assert_readable(&refusal),
                Ok(request) => {
                    let (_, again) = Request::from_json(request.to_json().as_bytes());
                    prop_assert_eq!(again.as_ref(), Ok(&request));
                }
            }
        }
    }

    #[test]
    fn arbitrary_bytes_cause_no_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        if let (_, Err(refusal)) = Request::from_json(&bytes) {
            assert_readable(&refusal);
        }
    }
}
