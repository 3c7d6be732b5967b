//! Robot profiles: accepted input, rejected input with its error places, and output.

// Numbers are compared to the last bit on purpose; test helpers may panic.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

use iiwa_kin::{BadLength, Joint, ProfileError, Robot};
use proptest::prelude::*;

fn refused(text: &str) -> ProfileError {
    Robot::from_profile(text).unwrap_err()
}

#[test]
fn an_empty_profile_is_the_default() {
    assert_eq!(Robot::from_profile("{\"version\": 1}").unwrap(), Robot::default());
    let big = r#"{ "version": 1, "base": "lbr_iiwa_14_r820" }"#;
    assert_eq!(Robot::from_profile(big).unwrap(), Robot::lbr_iiwa_14_r820());
    let marked = format!("\u{feff}{big}");
    assert_eq!(Robot::from_profile(&marked).unwrap(), Robot::lbr_iiwa_14_r820());
}

#[test]
fn every_part_can_be_overridden() {
    let robot = Robot::from_profile(
        r#"{
            "version": 1,
            "base": "lbr_iiwa_14_r820",
            "name": "cell 3",
            "lengths_mm": { "base": 361, "upper_arm": 419.5, "forearm": 402, "flange": 126 },
            "position_limit_deg": [160, 110, 160, 110, 160, 110, 360],
            "velocity_limit_deg_s": [1, 2, 3, 4, 5, 6, 7],
            "acceleration_limit_deg_s2": [10, 20, 30, 40, 50, 60, 70],
            "jerk_limit_deg_s3": [100, 200, 300, 400, 500, 600, 700],
            "torque_limit_nm": [11, 12, 13, 14, 15, 16, 17],
            "link_mass_kg": [8, 7, 6, 5, 4, 3, 2, 1],
            "blend_kappa": [-3, 0.01, 0.0002],
            "tcp_blend_kappa": [-2, 0.02, 0.0003],
            "settle_time_s": 0.04,
            "ramps": { "torque_snap_nm_s2": [1, 2, 3, 4, 5, 6, 7], "width_rad_s": 0.25,
                       "spline_build_up_s": 0.2 }
        }"#,
    )
    .unwrap();
    assert_eq!(robot.name(), "cell 3");
    let l = robot.lengths();
    assert_eq!([l.base_m, l.upper_arm_m, l.forearm_m, l.flange_m], [0.361, 0.4195, 0.402, 0.126]);
    let limits = robot.limits();
    assert_eq!(limits.upper_rad[0], 160_f64.to_radians());
    assert_eq!(limits.upper_rad[6], std::f64::consts::TAU);
    assert_eq!(limits.velocity_rad_s[6], 7_f64.to_radians());
    assert_eq!(limits.acceleration_rad_s2[0], 10_f64.to_radians());
    assert_eq!(limits.jerk_rad_s3[3], 400_f64.to_radians());
    assert_eq!(limits.torque_nm[1], 12.0);
    assert_eq!(robot.link_mass_kg()[7], 1.0);
    assert_eq!(robot.kappa(100.0), -3.0 + 1.0 + 2.0);
    assert_eq!(robot.tcp_kappa(100.0), -2.0 + 2.0 + 3.0);
    assert_eq!(robot.settle_time_s(), 0.04);
    let mut law = *Robot::lbr_iiwa_14_r820().ramp_law();
    law.torque_snap_nm_s2 = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
    law.width_rad_s = 0.25;
    law.spline.build_up_s = 0.2;
    assert_eq!(*robot.ramp_law(), law);
    assert!(robot.assumptions().is_empty());
    assert_eq!(Robot::from_profile(&robot.to_profile()).unwrap(), robot);
}

/// kappa of TCP blends equals kappa of joint blends unless given.
#[test]
fn tcp_blends_may_have_a_separate_kappa() {
    let read = |keys: &str| {
        let text = format!("{{ \"version\": 1, \"blend_kappa\": [-3, 0.01, 0.0002]{keys} }}");
        Robot::from_profile(&text).unwrap()
    };
    let plain = read("");
    assert_eq!(plain.tcp_blend_kappa(), plain.blend_kappa());
    let same = read(", \"tcp_blend_kappa\": [-3, 0.01, 0.0002]");
    assert_eq!(same, plain);
    assert!(!same.to_profile().contains("tcp_blend_kappa"));
    let changed = read(", \"tcp_blend_kappa\": [-1, 0, 0]");
    assert_eq!((changed.kappa(0.0), changed.tcp_kappa(0.0)), (-3.0, -1.0));
    assert!(changed.to_profile().contains("tcp_blend_kappa"));
    // Changing kappa of joint blends does not change the measured kappa of TCP blends.
    let again = changed.with_blend_kappa([1.0, 0.0, 0.0]);
    assert_eq!((again.kappa(0.0), again.tcp_kappa(0.0)), (1.0, -1.0));
}

#[test]
fn ranges_need_not_be_symmetric() {
    let ranges =
        "[-170, 100], [-10, 90], [-170, 170], [-120, 0], [10, 20], [-120, 120], [-360, 360]";
    let text = |keys: &str| format!(r#"{{ "version": 1, {keys} }}"#);
    let range = |ranges: &str| format!(r#""position_range_deg": [{ranges}]"#);
    let robot = Robot::from_profile(&text(&range(ranges))).unwrap();
    let limits = robot.limits();
    assert_eq!(limits.range_rad(Joint::A2), [-10.0, 90.0].map(f64::to_radians));
    assert_eq!(limits.range_rad(Joint::A5), [10.0, 20.0].map(f64::to_radians));
    assert_eq!(Robot::from_profile(&robot.to_profile()).unwrap(), robot);
    let outside = limits.check(&[0.0; 7]).unwrap_err();
    assert_eq!(outside.to_string(), "joint A5 is at 0 deg; its range is 10 to 20 deg");
    assert!(limits.check(&limits.clamp(&[0.0; 7])).is_ok());
    for (share, expected) in [(-1.0, limits.lower_rad), (1.0, limits.upper_rad)] {
        let actual = limits.at_shares(&[share; 7]);
        assert!((0..7).all(|j| (actual[j] - expected[j]).abs() < 1e-15), "{actual:?}");
    }
    // The URDF has the limits, too.
    assert!(robot.to_urdf().contains(&format!("lower=\"{}\"", 10_f64.to_radians())));

    let symmetric = ranges.replace("[-170, 170]", "[170, -170]");
    for (keys, message) in [
        (
            range(&symmetric),
            "position_range_deg: upper limit of joint A3 is -170.0; it must be at least 170.001 \
             and at most 360.0",
        ),
        (range("[-1, 1]"), "position_range_deg has 1 numbers; write 7, one pair for each joint"),
        (
            range(&ranges.replace("[-360", "[-361")),
            "position_range_deg: lower limit of joint A7 is -361.0; it must be at least -360.0 and \
             at most 359.999",
        ),
        (
            format!(r#"{}, "position_limit_deg": [1, 1, 1, 1, 1, 1, 1]"#, range(ranges)),
            "both position_limit_deg and position_range_deg are given; keep one of them",
        ),
    ] {
        assert_eq!(refused(&text(&keys)).message(), message);
    }
}

/// Seven links of a profile: those of the built-in model, with other numbers for the first.
fn links(first: &str) -> String {
    let body = |mass: f64| {
        format!(
            r#"{{ "mass_kg": {mass}, "center_mm": [0, -30.5, 270],
                  "inertia_kg_m2": [0.02, 0, 0, 0.02, 0.004, 0.01] }}"#
        )
    };
    let rest = (2..8).map(|number| body(f64::from(number))).collect::<Vec<_>>().join(", ");
    let first = if first.is_empty() { body(1.0) } else { first.to_owned() };
    format!("[{first}, {rest}]")
}

#[test]
fn links_are_bodies() {
    let text = |keys: &str| format!(r#"{{ "version": 1, {keys} }}"#);
    let complete = links("");
    let robot = Robot::from_profile(&text(&format!(r#""links": {complete}"#))).unwrap();
    assert_eq!(robot.links()[0].center_m, [0.0, -0.0305, 0.27]);
    assert_eq!(robot.links()[6].inertia_kg_m2, [0.02, 0.0, 0.0, 0.02, 0.004, 0.01]);
    assert_eq!(robot.link_mass_kg(), [4.856, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    assert!(!robot.assumes("masses"));
    assert!(!robot.to_profile().contains("link_mass_kg"));
    assert_eq!(Robot::from_profile(&robot.to_profile()).unwrap(), robot);
    assert_eq!(Robot::from_profile(&robot.to_full_profile()).unwrap(), robot);

    // With the mass of the base.
    let both = format!(r#""link_mass_kg": [9, 1, 2.001, 3, 4, 5, 6, 7], "links": {complete}"#);
    let heavy = Robot::from_profile(&text(&both)).unwrap();
    assert_eq!(heavy.link_mass_kg(), [9.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    assert_eq!(heavy.links(), robot.links());
    assert_eq!(Robot::from_profile(&heavy.to_profile()).unwrap(), heavy);

    for (keys, message) in [
        (
            both.replace("2.001", "2.01"),
            "link_mass_kg: link 2 is 2.01, and 2.0 in links; keep one of the keys".to_owned(),
        ),
        (r#""links": []"#.to_owned(), "links has 0 entries; write 7, links 1 to 7".to_owned()),
        (
            format!(r#""links": {}"#, complete.replacen("0.02,", "-0.02,", 1)),
            "links: the inertia tensor of link 1 is not physically possible: the moment of inertia \
             about some axis is negative"
                .to_owned(),
        ),
        (
            format!(r#""links": {}"#, complete.replacen(": 1,", ": 0,", 1)),
            "links: mass_kg of link 1 is 0.0; it must be above 0 and at most 1000000000.0"
                .to_owned(),
        ),
        (
            format!(r#""links": {}"#, complete.replacen("270", "27000", 1)),
            "links: number 3 of center_mm of link 1 is 27000.0; it must be at least -10000.0 and \
             at most 10000.0"
                .to_owned(),
        ),
        (
            r#""flange_mass_kg": -1"#.to_owned(),
            "flange_mass_kg is -1.0; it must be at least 0.0 and at most 1000000000.0".to_owned(),
        ),
        (
            r#""friction": { "coulomb_nm": [0, 0, -0.1, 0, 0, 0, 0] }"#.to_owned(),
            "friction: coulomb_nm of joint A3 is -0.1; it must be at least 0.0 and at most \
             1000000000.0"
                .to_owned(),
        ),
        (
            r#""ramps": { "stop_nm_s": [1, 0, 1, 1, 1, 1, 1] }"#.to_owned(),
            "ramps: stop_nm_s of joint A2 is 0.0; it must be above 0 and at most 1000000000.0"
                .to_owned(),
        ),
        (
            r#""ramps": { "width_rad_s": -1 }"#.to_owned(),
            "ramps: width_rad_s is -1.0; it must be above 0 and at most 1000000000.0".to_owned(),
        ),
        (
            r#""ramps": { "spline_bend_rel": 0 }"#.to_owned(),
            "ramps: spline_bend_rel is 0.0; it must be above 0 and at most 1000000000.0".to_owned(),
        ),
    ] {
        assert_eq!(refused(&text(&keys)).message(), message);
    }
}

/// Profiles that predate `links` keep their meaning.
#[test]
fn masses_alone_are_those_of_shapes() {
    let masses = r#"{
        "version": 1,
        "link_mass_kg": [4.856, 3.394, 4.032, 3.394, 4.032, 1.529, 2.404, 0.259]
    }"#;
    let robot = Robot::from_profile(masses).unwrap();
    let [first, ..] = robot.links();
    assert!((first.center_m[2] - 0.272_699_876).abs() < 1e-9);
    assert!((first.inertia_kg_m2[0] - 0.022_793_768_053).abs() < 1e-12);
    // The shapes follow the lengths.
    let short = robot.clone().with_flange_m(0.126).unwrap();
    assert_ne!(short.links()[6], robot.links()[6]);
    assert_eq!(Robot::from_profile(&robot.to_profile()).unwrap(), robot);
    assert_eq!(Robot::from_profile(&robot.to_full_profile()).unwrap(), robot);
}

#[test]
fn given_values_are_not_assumptions() {
    let read = |key: &str, numbers: &str| {
        let text =
            format!(r#"{{ "version": 1, "base": "lbr_iiwa_14_r820", "{key}": [{numbers}] }}"#);
        Robot::from_profile(&text).unwrap()
    };
    for (quantity, key, numbers) in [
        ("acceleration", "acceleration_limit_deg_s2", "1, 2, 3, 4, 5, 6, 7"),
        ("jerk", "jerk_limit_deg_s3", "1, 2, 3, 4, 5, 6, 7"),
        ("masses", "link_mass_kg", "1, 2, 3, 4, 5, 6, 7, 8"),
        // Giving the assumed values makes them known.
        ("acceleration", "acceleration_limit_deg_s2", "425, 425, 500, 375, 650, 675, 675"),
    ] {
        let robot = read(key, numbers);
        assert!(!robot.assumes(quantity), "{quantity}");
        assert_eq!(robot.assumptions().len(), 3);
        assert_eq!(Robot::from_profile(&robot.to_profile()).unwrap(), robot);
    }
    assert_eq!(read("torque_limit_nm", "1, 2, 3, 4, 5, 6, 7").assumptions().len(), 4);
}

/// A rejected text; line, column and text of the error; part of the message.
type Refused = (&'static str, usize, usize, &'static str, &'static str);

fn assert_refused(cases: &[Refused]) {
    for &(text, line, column, span, message) in cases {
        let error = refused(text);
        let place = error.place();
        assert_eq!((place.line, place.column), (line, column), "{text}: {error}");
        assert_eq!(&text[place.span.clone()], span, "{text}: {error}");
        assert!(error.message().contains(message), "{text}: {error}");
        assert_eq!(
            error.to_string(),
            format!("{}, at line {line}, column {column}", error.message())
        );
    }
}

#[test]
fn invalid_blends_are_reported_with_their_place() {
    assert_refused(&[
        ("{ \"version\": 1, \"settle_time_s\": 0 }", 1, 34, "0", "at least 0.001"),
        ("{ \"version\": 1, \"blend_kappa\": [1, 2] }", 1, 32, "[1, 2]", "has 2 numbers; write 3"),
        (
            "{ \"version\": 1, \"tcp_blend_kappa\": [1, 0, 101] }",
            1,
            43,
            "101",
            "tcp_blend_kappa: number 3 is 101",
        ),
        (
            "{ \"version\": 1, \"blend_kappa\": [1, -101, 0] }",
            1,
            36,
            "-101",
            "blend_kappa: number 2 is -101.0",
        ),
    ]);
}

#[test]
fn invalid_profiles_are_reported_with_their_place() {
    assert_refused(&[
        ("", 1, 1, "", "ends too early"),
        ("plan", 1, 1, "plan", "not JSON"),
        ("[1]", 1, 1, "[", "expected an object, found a list"),
        ("{ \"version\": 1, \"lengths_mm\": [340] }", 1, 31, "[", "expected an object"),
        ("{\n  \"version\": 1", 2, 15, "", "ends too early"),
        ("{}", 1, 1, "{", "the key `version` is missing"),
        ("{ \"version\": \"1\" }", 1, 14, "\"1\"", "expected a whole number"),
        ("{\n \"version\": 2,\n \"new\": 1 }", 2, 13, "2", "profile of version 2; write version 1"),
        (
            "{ \"version\": 1,\n  \"speed\": 3 }",
            2,
            3,
            "\"speed\"",
            "unknown key `speed`, expected one of",
        ),
        (
            "{ \"version\": 1,\n  \"lengths_mm\": { \"flnge\": 3 } }",
            2,
            19,
            "\"flnge\"",
            "unknown key `flnge`; did you mean `flange`?",
        ),
        ("{ \"version\": 1, \"version\": 1 }", 1, 17, "\"version\"", "appears twice"),
        (
            "{ \"version\": 1,\n  \"base\": \"kr_16\" }",
            2,
            11,
            "\"kr_16\"",
            "\"kr_16\"; choose one of lbr_iiwa_7_r800, lbr_iiwa_14_r820",
        ),
        ("{ \"version\": 1, \"name\": \"\" }", 1, 25, "\"\"", "1 to 100 characters"),
        ("{ \"version\": 1, \"name\": \"a\\u0007\" }", 1, 25, "\"a\\u0007\"", "control character"),
        ("{ \"version\": 1, \"name\": null }", 1, 25, "null", "expected a string"),
        (
            "{ \"version\": 1,\n  \"lengths_mm\": { \"base\": 340, \"flange\": -1 } }",
            2,
            42,
            "-1",
            "lengths_mm: flange is -1.0; it must be above 0 and at most 10000.0",
        ),
        ("{ \"version\": 1, \"lengths_mm\": { \"base\": 1e-320 } }", 1, 41, "1e-320", "above 0"),
        (
            "{ \"version\": 1,\n  \"velocity_limit_deg_s\":\n    [1, 2, 3, 4, 5, 6] }",
            3,
            5,
            "[1, 2, 3, 4, 5, 6]",
            "velocity_limit_deg_s has 6 numbers; write 7, one for each joint",
        ),
        (
            "{ \"version\": 1, \"jerk_limit_deg_s3\": [1, 2, 3, 4, 5, 6, 7, 8] }",
            1,
            38,
            "[1, 2, 3, 4, 5, 6, 7, 8]",
            "has 8 numbers",
        ),
        ("{ \"version\": 1, \"torque_limit_nm\": [] }", 1, 36, "[]", "has 0 numbers"),
        (
            "{ \"version\": 1, \"link_mass_kg\": [1, 2, 3, 4, 5, 6, 7] }",
            1,
            33,
            "[1, 2, 3, 4, 5, 6, 7]",
            "has 7 numbers; write 8, one for each link",
        ),
        (
            "{ \"version\": 1, \"link_mass_kg\": [1, 2, 3, 4, 5, 6, 7, 0] }",
            1,
            55,
            "0",
            "link_mass_kg: link 7 is 0.0",
        ),
        (
            "{ \"version\": 1, \"name\": \"ü\",\n \
             \"position_limit_deg\": [1, 2, 3, 4, 5, 361, 7] }",
            2,
            40,
            "361",
            "position_limit_deg: joint A6 is 361.0; it must be above 0 and at most 360.0",
        ),
        (
            "{ \"version\": 1, \"name\": \"ü\", \"torque_limit_nm\": [1, 2, 3, -4, 5, 6, 7] }",
            1,
            59,
            "-4",
            "torque_limit_nm: joint A4 is -4.0",
        ),
        ("{ \"version\": 1, \"torque_limit_nm\": [NaN] }", 1, 37, "NaN", "not JSON"),
        ("{ \"version\": 1, \"torque_limit_nm\": [1e400] }", 1, 37, "1e400", "number is too large"),
        ("{ \"version\": 1, \"torque_limit_nm\": [null] }", 1, 37, "null", "expected a number"),
        ("{ \"version\": 1, \"torque_limit_nm\": [1e10] }", 1, 36, "[1e10]", "has 1 numbers"),
        ("{ \"version\": 1, \"torque_limit_nm\": 5 }", 1, 36, "5", "expected a list"),
    ]);
}

/// If the time were quadratic in the text length, this test would take hours.
#[test]
fn long_and_deep_texts_are_refused() {
    let deep = "[".repeat(200_000_000);
    assert!(matches!(refused(&deep), ProfileError::TooLong { found: 200_000_000, .. }));
    for open in ["[", "{\"a\":", "{\"version\":", "{\"version\":1,\"torque_limit_nm\":["] {
        let error = refused(&open.repeat(30_000));
        assert!(matches!(error, ProfileError::Json { .. }), "{error}");
    }
}

#[test]
fn every_end_of_a_profile_is_refused() {
    let text = "{ \"version\": 1, \"name\": \"ü\", \"link_mass_kg\": [1, 2, 3, 4, 5, 6, 7, 8] }";
    for end in (0..text.len()).filter(|&end| text.is_char_boundary(end)) {
        assert!(refused(&text[..end]).place().span.end <= end);
    }
    Robot::from_profile(text).unwrap();
}

#[test]
fn built_in_models_read_back_exactly() {
    for name in Robot::BUILT_IN {
        let robot = Robot::built_in(name).unwrap();
        let text = robot.to_profile();
        assert_eq!(text, format!("{{\n  \"version\": 1,\n  \"base\": \"{name}\"\n}}"));
        assert_eq!(Robot::from_profile(&text).unwrap(), robot);
    }
    let short = Robot::default().with_flange_m(0.126).unwrap();
    assert!(short.to_profile().contains("\"flange\": 126.0\n"));
    assert_eq!(Robot::from_profile(&short.to_profile()).unwrap(), short);
}

#[test]
fn a_flange_has_a_length() {
    for found_m in [0.0, -0.1, 1e-320, 10.1, f64::INFINITY] {
        let error = Robot::default().with_flange_m(found_m).unwrap_err();
        assert_eq!(error, BadLength { found_m });
    }
    assert!(Robot::default().with_flange_m(f64::NAN).is_err());
}

#[test]
fn the_schema_has_every_key() {
    let schema = Robot::profile_schema();
    let keys = schema["properties"].as_object().unwrap();
    assert_eq!(keys.len(), 21);
    let named = r#"{ "$schema": "profile.schema.json", "version": 1 }"#;
    assert_eq!(Robot::from_profile(named).unwrap(), Robot::default());
    assert_eq!(schema["additionalProperties"], false);
    assert_eq!(schema["required"], serde_json::json!(["version"]));
    assert_eq!(keys["version"]["const"], 1);
    assert_eq!(keys["base"]["enum"], serde_json::json!(Robot::BUILT_IN));
    assert_eq!(keys["base"]["type"], "string");
    let positions = &keys["position_limit_deg"];
    assert_eq!((&positions["minItems"], &positions["maxItems"]), (&7.into(), &7.into()));
    assert_eq!(positions["items"]["maximum"], 360.0);
    assert_eq!(keys["link_mass_kg"]["minItems"], 8);
}

fn numbers<const N: usize>(max: f64) -> impl Strategy<Value = Option<Vec<f64>>> {
    let number = prop_oneof![
        (1..=1_000_000_u32).prop_map(move |n| f64::from(n) * 1e-6 * max),
        (1e-6..1.0_f64).prop_map(move |share| share * max),
    ];
    prop::option::of(prop::collection::vec(number, N))
}

prop_compose! {
    fn any_profile()(
        big in any::<bool>(),
        name in prop::option::of("[a-z ü\"\\\\<&]{1,20}"),
        lengths in numbers::<4>(10_000.0),
        position in numbers::<7>(360.0),
        velocity in numbers::<7>(1e3),
        acceleration in numbers::<7>(1e4),
        jerk in numbers::<7>(1e9),
        torque in numbers::<7>(500.0),
        mass in numbers::<8>(50.0),
        kappa in numbers::<3>(100.0),
        tcp_kappa in numbers::<3>(100.0),
        settle in prop::option::of(0.001..=10.0_f64),
        links in numbers::<70>(1.0),
        flange_mass in prop::option::of(0.0..3.0_f64),
        friction in numbers::<14>(5.0),
    ) -> serde_json::Value {
        let mut profile = serde_json::json!({
            "version": 1,
            "base": Robot::BUILT_IN[usize::from(big)],
            "name": name,
            "lengths_mm": lengths.map(|l| serde_json::json!({
                "base": l[0], "upper_arm": l[1], "forearm": l[2], "flange": l[3],
            })),
            "position_limit_deg": position,
            "velocity_limit_deg_s": velocity,
            "acceleration_limit_deg_s2": acceleration,
            "jerk_limit_deg_s3": jerk,
            "torque_limit_nm": torque,
            "link_mass_kg": mass.filter(|_| links.is_none()),
            "links": links.map(|links| links.chunks(10).map(|l| serde_json::json!({
                "mass_kg": l[0],
                "center_mm": [l[1] * 1e3, l[2] * -1e3, l[3] * 1e2],
                // Off-diagonal moments are at most a third of the diagonal ones.
                "inertia_kg_m2": [
                    1.0 + l[4], 0.3 * l[5], -0.3 * l[6], 1.0 + l[7], 0.3 * l[8], 1.0 + l[9]
                ],
            })).collect::<Vec<_>>()),
            "flange_mass_kg": flange_mass,
            "friction": friction.map(|f| serde_json::json!({
                "viscous_nm_s_rad": f[..7], "coulomb_nm": f[7..],
            })),
            "blend_kappa": kappa,
            "tcp_blend_kappa": tcp_kappa,
            "settle_time_s": settle,
        });
        profile.as_object_mut().unwrap().retain(|_, value| !value.is_null());
        profile
    }
}

proptest! {
    #[test]
    fn a_profile_reads_back_exactly(profile in any_profile()) {
        let robot = Robot::from_profile(&profile.to_string()).unwrap();
        let text = robot.to_profile();
        let again = Robot::from_profile(&text).unwrap();
        prop_assert_eq!(&again, &robot);
        prop_assert_eq!(again.to_profile(), text);
    }

    /// A length that no decimal number of mm represents exactly.
    #[test]
    fn any_length_reads_back_to_the_last_bit(flange_m in 1e-3..10.0_f64) {
        let robot = Robot::default().with_flange_m(flange_m).unwrap();
        let again = Robot::from_profile(&robot.to_profile()).unwrap().lengths().flange_m;
        prop_assert!(again >= flange_m.next_down() && again <= flange_m.next_up());
    }

    #[test]
    fn any_text_is_refused_with_a_place(text in "[{}\\[\\]:,\"a-z0-9ü .\\\\\n-]{0,60}") {
        if let Err(error) = Robot::from_profile(&text) {
            prop_assert!(error.place().span.end <= text.len());
        }
    }
}
