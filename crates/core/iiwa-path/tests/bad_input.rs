//! Invalid programs: each is rejected with a message that includes the place.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::time::{Duration, Instant};

use iiwa_json::JsonPlace;
use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::{Motion, MotionIndex, Program, ProgramError, Ptp, Sources, Start, Workcell};

const GOOD: &str = r#"{
  "version": 1,
  "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
  "motions": [
    { "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0], "blend": { "cart_mm": 50 } },
    { "type": "ptp", "joints_rad": [1, 0.5, 0, -1, 0, 1.5, 0], "velocity_rel": 0.75 },
    { "type": "wait", "seconds": 0.5 },
    { "type": "ptp", "joints_deg": [40, 30, 0, -60, 0, 90, 0] }
  ]
}
"#;

/// Returns the error message of `text`, without the place, and the place.
fn refused(text: &str) -> (String, JsonPlace) {
    let (message, place, whole) = match Program::from_json(text) {
        Err(error) => (error.message(), error.place().clone(), error.to_string()),
        Ok(program) => {
            let fault = JointPath::new(&program, &Robot::lbr_iiwa_7_r800()).unwrap_err();
            let place = fault.place_in(text);
            (fault.to_string(), place.clone(), format!("{fault}, at {place}"))
        }
    };
    let JsonPlace { line, column, .. } = place;
    assert_eq!(whole, format!("{message}, at line {line}, column {column}"));
    (message, place)
}

/// Replaces `old` by `new` in the valid program and expects the error message `expected`, at a
/// place where the text starts with `found`.
fn check(old: &str, new: &str, (line, column): (usize, usize), excerpt: &str, expected: &str) {
    assert!(GOOD.contains(old), "{old}");
    let text = GOOD.replacen(old, new, 1);
    let (message, place) = refused(&text);
    assert_eq!(message, expected, "{new}");
    assert_eq!((place.line, place.column), (line, column), "{new}: {message}");
    assert!(text[place.span.clone()].starts_with(excerpt), "{new}: {}", &text[place.span]);
}

#[test]
fn the_good_program_is_good() {
    JointPath::new(&Program::from_json(GOOD).unwrap(), &Robot::lbr_iiwa_7_r800()).unwrap();
}

#[test]
fn not_json() {
    for (text, line, column, expected) in [
        ("", 1, 1, "the text ends too early"),
        ("\n\n", 1, 1, "the text ends too early"),
        ("plan.json", 1, 1, "this is not JSON: a value is expected"),
        ("\u{feff}{}", 1, 1, "the key `version` is missing"),
        ("<xml/>", 1, 1, "this is not JSON: a value is expected"),
        ("[]", 1, 1, "expected an object, found a list"),
        ("null", 1, 1, "expected an object, found null"),
        ("\"{}\"", 1, 1, "expected an object, found string \"{}\""),
        ("{}", 1, 1, "the key `version` is missing"),
    ] {
        let (message, place) = refused(text);
        assert_eq!(
            (message.as_str(), place.line, place.column),
            (expected, line, column),
            "{text}"
        );
    }
    let value = "this is not JSON: a value is expected";
    check("[0, 30,", "[NaN, 30,", (5, 37), "NaN", &format!("motion 1: {value}"));
    check("0.5 }", "NaN }", (7, 34), "NaN", &format!("motion 3: {value}"));
    check("0.5 }", "1e400 }", (7, 34), "1e400", "motion 3: the number is too large");
    check("0.5 }", "-Infinity }", (7, 34), "-Infinity", "motion 3: invalid number");
    check("[0, 30,", "[1e400, 30,", (5, 37), "1e400", "motion 1: the number is too large");
    check("[0, 30,", "[0, 30 30,", (5, 43), "30", "motion 1: expected `,` or `]`");
    check("90, 0] }\n", "90, 0] },\n", (9, 3), "]", "trailing comma");
    check("0.5 },", "0.5 }", (8, 5), "{", "motion 3: expected `,` or `]`");
    check("\"type\"", "type", (5, 7), "type", "motion 1: a key is expected, in double quotes");
    check("\n}\n", "\n}\n}", (11, 1), "}", "there is more text after the end");
}

#[test]
fn cut_off_anywhere() {
    let whole = GOOD.trim_end().len();
    for end in 0..whole {
        let text = &GOOD[..end];
        let error = Program::from_json(text).unwrap_err();
        let place = error.place();
        assert!(place.span.end <= text.len());
        assert_eq!(place.line, text.trim_end().split('\n').count(), "{text}: {error}");
        if text.ends_with(['-', '.']) {
            assert_eq!(place.span.end, text.len(), "{text}: {error}");
            assert!(error.message().ends_with("invalid number"), "{text}: {error}");
            continue;
        }
        assert_eq!(place.span.start, text.trim_end().len(), "{text}: {error}");
        assert!(error.message().ends_with("the text ends too early"), "{text}: {error}");
    }
    let error = Program::from_json(&GOOD[..GOOD.find("0.75").unwrap()]).unwrap_err();
    assert_eq!(error.to_string(), "motion 2: the text ends too early, at line 6, column 79");
}

/// A single typing error causes no panic, and each error has a place.
#[test]
fn a_byte_too_many_or_too_few() {
    let text = GOOD.replace("wait", "wäit");
    for offset in (0..text.len()).filter(|&offset| text.is_char_boundary(offset)) {
        let next = offset + text[offset..].chars().next().unwrap().len_utf8();
        let less = [&text[..offset], &text[next..]].concat();
        for text in ["\"", "{", "]", ",", "\\", "-", "9", "é"]
            .map(|more| [&text[..offset], more, &text[offset..]].concat())
            .into_iter()
            .chain([less])
        {
            let (_, place) = refused(&text);
            assert!(place.span.end <= text.len() && place.line > 0 && place.column > 0, "{text}");
            assert!(text.is_char_boundary(place.span.start), "{text}");
        }
    }
}

#[test]
fn unknown_names() {
    let ptp = "one of `type`, `joints_rad`, `joints_deg`, `frame`, `tool`, `base`, `velocity_rel`, \
               `acceleration_rel`, `jerk_rel`, `blend`, `blocking`, `name`, `comment`, `group`, \
               `source`";
    let message = format!("motion 2: unknown key `speed`, expected {ptp}");
    check("\"velocity_rel\"", "\"speed\"", (6, 64), "\"speed\"", &message);
    let message = "motion 2: unknown key `velocity`; did you mean `velocity_rel`?";
    check("\"velocity_rel\"", "\"velocity\"", (6, 64), "\"velocity\"", message);
    let message = "unknown key `robots`; did you mean `robot`?";
    check("\"start\"", "\"robots\": [], \"start\"", (3, 3), "\"robots\"", message);
    let message = "expected a string, found `1`";
    check("\"version\"", "\"$schema\": 1, \"version\"", (2, 14), "1", message);
    let message = "unknown key `joints`; did you mean `joints_deg`?";
    check("\"joints_deg\"", "\"joints\"", (3, 14), "\"joints\"", message);
    let message = "motion 3: unknown key `second`; did you mean `seconds`?";
    check("\"seconds\"", "\"second\"", (7, 23), "\"second\"", message);
    let message = "motion 1: unknown key `radius`, expected one of `fraction`, `sunrise_rel`, \
                `cart_mm`";
    check("\"cart_mm\"", "\"radius\"", (5, 74), "\"radius\"", message);

    let message = "motion 3: unknown type `Wait`; did you mean `wait`?";
    check("\"wait\"", "\"Wait\"", (7, 15), "\"Wait\"", message);
    let types = "`ptp`, `lin`, `lin_rel`, `circ`, `spline`, `spl`, `wait`, `load`, `set`, \
                 `wait_for` and `repeat` are known";
    let message = format!("motion 3: unknown type `fly`; {types}");
    check("\"wait\"", "\"fly\"", (7, 15), "\"fly\"", &message);
    let message = format!("motion 3: it has no `type`; {types}");
    check("\"type\": \"wait\", ", "", (7, 5), "{", &message);
    let message = "motion 3: expected a string, found `3`";
    check("\"wait\"", "3", (7, 15), "3", message);
    let message = "motion 3: the key `type` appears twice, first at line 7, column 7";
    check("\"wait\"", "\"wait\", \"type\": \"ptp\"", (7, 23), "\"type\"", message);
}

#[test]
fn another_version() {
    let message = "this is a program of version 2; version 1 is understood";
    check("1,", "2,", (2, 14), "2", message);
    check("1,", "2, \"cell\": {},", (2, 14), "2", message);
    check("1,", "0,", (2, 14), "0", "this is a program of version 0; version 1 is understood");
    check(
        "1,",
        "\"1\",",
        (2, 14),
        "\"1\"",
        "expected a whole number, 0 or more, found string \"1\"",
    );
    check("1,", "1.0,", (2, 14), "1.0", "expected a whole number, 0 or more, found `1.0`");
    check("1,", "-1,", (2, 14), "-1", "expected a whole number, 0 or more, found `-1`");
    check("\"version\": 1,", "", (1, 1), "{", "the key `version` is missing");
}

#[test]
fn joints_that_are_not_seven_numbers() {
    let seven = "expected seven joint angles, A1 to A7, found";
    let place = (5, 36);
    check("[0, 30, 0,", "[30, 0,", place, "[", &format!("motion 1: {seven} 6"));
    check("[0, 30, 0,", "[0, 30, 0, 0,", place, "[", &format!("motion 1: {seven} 8"));
    check("[0, 30, 0, -60, 0, 90, 0]", "[]", place, "[", &format!("motion 1: {seven} 0"));
    check("[0, 30, 0, -60, 0, 90, 0]", "3", place, "3", &format!("motion 1: {seven} `3`"));
    check("[0, 30, 0, -60, 0, 90, 0]", "null", place, "null", &format!("motion 1: {seven} null"));
    check("[0, 0, 0, 0, 0, 0, 0]", "[0, 0]", (3, 28), "[", &format!("{seven} 2"));
    let number = "motion 1: expected a number, found";
    check("[0, 30,", "[0, \"30\",", (5, 40), "\"30\"", &format!("{number} string \"30\""));
    check("[0, 30,", "[0, [30],", (5, 40), "[", &format!("{number} a list"));
    check("[0, 30,", "[0, null,", (5, 40), "null", &format!("{number} null"));

    let none = "the target is missing: give `joints_deg`, `joints_rad` or `frame`";
    let both = "give either `joints_deg` or `joints_rad`, not both";
    check(
        "{ \"joints_deg\": [0, 0, 0, 0, 0, 0, 0] }",
        "{}",
        (3, 12),
        "{}",
        &format!("the start pose: {none}"),
    );
    let two = "\"joints_rad\": [0, 0, 0, 0, 0, 0, 0], \"joints_deg\": [0, 30,";
    check("\"joints_deg\": [0, 30,", two, (5, 5), "{", &format!("motion 1: {both}"));
    let two = "\"joints_rad\": [0, 0, 0, 0, 0, 0, 0], \"joints_deg\": [0, 0,";
    check("\"joints_deg\": [0, 0,", two, (3, 12), "{", &format!("the start pose: {both}"));
    let joints = "\"joints_deg\": [40, 30, 0, -60, 0, 90, 0]";
    check(&format!(", {joints}"), "", (8, 5), "{", &format!("motion 4: {none}"));
    check(
        joints,
        &format!("{joints}, {joints}"),
        (8, 64),
        "\"joints_deg\"",
        "motion 4: the key `joints_deg` appears twice, first at line 8, column 22",
    );
}

/// The serde derive would also accept a list of the values of an object.
#[test]
fn lists_for_objects() {
    let message = "expected an object, found a list";
    let wait = "{ \"type\": \"wait\", \"seconds\": 0.5 }";
    check(wait, "[\"wait\", 0.5]", (7, 5), "[", &format!("motion 3: {message}"));
    check(wait, "7", (7, 5), "7", "motion 3: expected an object, found `7`");
    check(wait, "null", (7, 5), "null", "motion 3: expected an object, found null");
    let start = "{ \"joints_deg\": [0, 0, 0, 0, 0, 0, 0] }";
    check(start, "[[0, 0, 0, 0, 0, 0, 0]]", (3, 12), "[", message);
    let blend =
        "expected an object such as { \"fraction\": 0.25 } or { \"cart_mm\": 30 }, found a list";
    check("{ \"cart_mm\": 50 }", "[50]", (5, 72), "[", &format!("motion 1: {blend}"));
    let text = "[1, null, { \"joints_deg\": [0, 0, 0, 0, 0, 0, 0] }, [{ \"type\": \"wait\", \
                \"seconds\": 1 }]]";
    assert_eq!(refused(text).0, message);
    let text = "{ \"version\": 1, \"start\": { \"joints_deg\": [0, 0, 0, 0, 0, 0, 0] }, \
                \"motions\": { \"type\": \"wait\" } }";
    let (message, place) = refused(text);
    assert_eq!(message, "expected a list, found an object");
    assert_eq!(place.span.start, text.rfind('{').unwrap());
}

#[test]
fn a_joint_outside_its_limits() {
    let limits = [170, 120, 170, 120, 170, 120, 175];
    for (joint, limit) in (1..).zip(limits) {
        for sign in [-1, 1] {
            let text = |by: &str| {
                let mut joints = ["0"; 7].map(str::to_owned);
                joints[joint - 1] = format!("{}{by}", sign * limit);
                GOOD.replace("[40, 30, 0, -60, 0, 90, 0]", &format!("[{}]", joints.join(", ")))
            };
            let at_the_limit = Program::from_json(&text("")).unwrap();
            JointPath::new(&at_the_limit, &Robot::lbr_iiwa_7_r800()).unwrap();

            let text = text(".001");
            let (message, place) = refused(&text);
            let degrees = format!("{}.001", sign * limit);
            assert_eq!(
                message,
                format!(
                    "motion 4: joint A{joint} is at {degrees} deg; its range is -{limit} to \
                     {limit} deg"
                )
            );
            assert_eq!((place.line, place.column), (8, 37 + 3 * (joint - 1)));
            assert_eq!(&text[place.span], degrees);
        }
    }
    let message = "the start pose: joint A2 is at -120.001 deg; its range is -120 to 120 deg";
    check("[0, 0,", "[0, -120.001,", (3, 32), "-120.001", message);
    let message = "motion 2: joint A4 is at -171.8873385 deg; its range is -120 to 120 deg";
    check("0.5, 0, -1,", "0.5, 0, -3,", (6, 48), "-3", message);
    // A message prints a large number correctly as well.
    let message =
        "motion 1: joint A1 is at 100000000000000000000 deg; its range is -170 to 170 deg";
    check("[0, 30,", "[1e20, 30,", (5, 37), "1e20", message);
}

#[test]
fn a_limit_typed_in_rad() {
    let text = |rad: f64| GOOD.replace("[1, 0.5,", &format!("[{rad}, 0.5,"));
    let limit = 170_f64.to_radians();
    for rad in [limit, limit.next_up(), 2.967_059_73] {
        let program = Program::from_json(&text(rad)).unwrap();
        JointPath::new(&program, &Robot::lbr_iiwa_7_r800()).unwrap();
    }
    // The message for a joint barely outside its range does not round to the limit.
    let (message, _) = refused(&text(limit + 6e-9));
    assert_eq!(message, "motion 2: joint A1 is at 170.0000003 deg; its range is -170 to 170 deg");
}

#[test]
fn not_a_number_in_a_program_made_in_code() {
    let mut target = [0.0; 7];
    for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        target[2] = wrong;
        let motions = vec![Motion::Ptp(Ptp::to([0.0; 7])), Motion::Ptp(Ptp::to(target))];
        let program = Program {
            robot: None,
            start: Start::Joints([0.0; 7]),
            motions,
            workcell: Workcell::default(),
            sources: Sources::default(),
        };
        let fault = JointPath::new(&program, &Robot::lbr_iiwa_7_r800()).unwrap_err();
        let expected =
            format!("motion 2: joint A3 is at {wrong} deg; its range is -170 to 170 deg");
        assert_eq!(fault.to_string(), expected);
        let program = Program { start: Start::Joints(target), ..program };
        let fault = JointPath::new(&program, &Robot::lbr_iiwa_7_r800()).unwrap_err();
        assert!(fault.to_string().starts_with("the start pose: joint A3 is at "), "{fault}");
    }
}

/// Joint 1 moves with joint 2 at its limit: at small angles, the blends of the LBR iiwa swing out
/// before they turn in (kappa of Larsen 2019, Eq. 38 is negative there).
#[test]
fn a_blend_that_swings_out_of_the_limits() {
    let text = r#"{
  "version": 1,
  "start": { "joints_deg": [0, 120, 0, 0, 0, 0, 0] },
  "motions": [
    { "type": "wait", "seconds": 0 },
    { "type": "ptp", "joints_deg": [60, 120, 0, 0, 0, 0, 0], "blend": { "fraction": 0.5 } },
    { "type": "ptp", "joints_deg": [120, 100, 0, 0, 0, 0, 0] }
  ]
}"#;
    let (message, place) = refused(text);
    let start = "motion 2: on its blend, joint A2 is at ";
    let end = " deg; its range is -120 to 120 deg; choose a smaller blend or move the target";
    let number = message.strip_prefix(start).and_then(|message| message.strip_suffix(end));
    let number: f64 = number.unwrap_or_else(|| panic!("{message}")).parse().unwrap();
    assert!(number > 120.001 && number < 121.0, "{message}");
    assert_eq!((place.line, place.column, &text[place.span]), (6, 71, "{ \"fraction\": 0.5 }"));

    // A blend inside the limits is accepted, although the overshoot bound leaves them.
    let inside = text.replace("120, 0, 0, 0, 0, 0]", "119, 0, 0, 0, 0, 0]");
    JointPath::new(&Program::from_json(&inside).unwrap(), &Robot::lbr_iiwa_7_r800()).unwrap();
}

#[test]
fn shares_out_of_range() {
    for (share, number_text) in
        [("0", "0"), ("-0.5", "-0.5"), ("1.001", "1.001"), ("1e308", "1e308")]
    {
        let number = share.parse::<f64>().unwrap();
        for key in ["velocity_rel", "acceleration_rel", "jerk_rel"] {
            let message = format!("motion 2: {key} is {number}; it must be above 0 and at most 1");
            let column = 66 + key.len();
            check(
                "\"velocity_rel\": 0.75",
                &format!("\"{key}\": {share}"),
                (6, column + 2),
                number_text,
                &message,
            );
        }
    }
    let message =
        "motion 2: velocity_rel of joint A7 is 2; it must be above 0 and at most 1 (2 % is 0.02)";
    check("0.75", "[1, 1, 1, 1, 1, 1, 2]", (6, 99), "2", message);
    let message = "motion 2: velocity_rel is 50; it must be above 0 and at most 1 (50 % is 0.5)";
    check("0.75", "50", (6, 80), "50", message);
    let message = "motion 2: velocity_rel is 0.0000005; it must be at least 0.000001 and at most 1";
    check("0.75", "5e-7", (6, 80), "5e-7", message);
    let seven = "motion 2: expected seven shares, for joints A1 to A7, found 3";
    check("0.75", "[1, 1, 1]", (6, 80), "[", seven);
    let share = "motion 2: expected a number above 0 and at most 1, or seven of them, found";
    check("0.75", "\"fast\"", (6, 80), "\"fast\"", &format!("{share} string \"fast\""));
    check("0.75", "{}", (6, 80), "{", &format!("{share} an object"));
    check("0.75", "null", (6, 80), "null", &format!("{share} null"));
    check("0.75", "1e400", (6, 80), "1e400", "motion 2: the number is too large");
}

#[test]
fn waits_out_of_range() {
    for (seconds, shown) in [("-0.001", "-0.001"), ("1e9", "1000000000")] {
        let message = format!("motion 3: a wait of {shown} s; it must be from 0 to 86400 s");
        check("0.5 }", &format!("{seconds} }}"), (7, 34), seconds, &message);
    }
    check(
        "0.5 }",
        "\"1 s\" }",
        (7, 34),
        "\"1 s\"",
        "motion 3: expected a number, found string \"1 s\"",
    );
    check(", \"seconds\": 0.5", "", (7, 5), "{", "motion 3: the key `seconds` is missing");
}

#[test]
fn blends_out_of_range() {
    let place = (5, 72);
    for (blend, message) in [
        ("\"fraction\": 0.5001", "fraction is 0.5001; it must be from 0 to 0.5"),
        ("\"fraction\": -0.1", "fraction is -0.1; it must be from 0 to 0.5"),
        ("\"sunrise_rel\": 1.01", "sunrise_rel is 1.01; it must be from 0 to 1"),
        ("\"sunrise_rel\": -1", "sunrise_rel is -1; it must be from 0 to 1"),
        ("\"cart_mm\": -50", "cart_mm is -50; it must be 0 or more"),
    ] {
        check("\"cart_mm\": 50", blend, place, "{", &format!("motion 1: the blend's {message}"));
    }
    let one = "motion 1: a blend has exactly one of `fraction`, `sunrise_rel` and `cart_mm`";
    check("{ \"cart_mm\": 50 }", "{}", place, "{", one);
    check("\"cart_mm\": 50", "\"cart_mm\": 50, \"fraction\": 0.1", place, "{", one);
    let null = "motion 1: expected a number, found null";
    check("\"cart_mm\": 50", "\"cart_mm\": null", (place.0, place.1 + 13), "null", null);
    let object =
        "motion 1: expected an object such as { \"fraction\": 0.25 } or { \"cart_mm\": 30 }, found";
    check("{ \"cart_mm\": 50 }", "50", place, "50", &format!("{object} `50`"));
    check(
        "{ \"cart_mm\": 50 }",
        "\"fraction\"",
        place,
        "\"",
        &format!("{object} string \"fraction\""),
    );
    check(
        "50 }",
        "\"50\" }",
        (5, 85),
        "\"50\"",
        "motion 1: expected a number, found string \"50\"",
    );
}

#[test]
fn a_blend_into_nothing() {
    let remove = "has nothing to blend into; remove its blend";
    let blend = "0.75, \"blend\": { \"fraction\": 0.25 }";
    let message = format!("motion 2 is followed by a wait and {remove}");
    check("0.75", blend, (6, 95), "{", &message);
    // A program may be continued, so a blend at its last target is accepted.
    for blend in ["\"sunrise_rel\": 0.05", "\"cart_mm\": 4", "\"fraction\": 0.5"] {
        let text = GOOD.replace("90, 0] }\n", &format!("90, 0], \"blend\": {{ {blend} }} }}\n"));
        let [with, without] = [&*text, GOOD].map(|text| Program::from_json(text).unwrap());
        assert_eq!(with.blend_at_the_end().map(MotionIndex::number), Some(4));
        assert_eq!(without.blend_at_the_end(), None);
        let blends = |program: &Program| {
            JointPath::new(program, &Robot::lbr_iiwa_7_r800()).unwrap().blends().count()
        };
        assert_eq!(blends(&with), blends(&without));
    }
    // A blend of negligible size is a stop and needs no next motion.
    for stop in ["\"sunrise_rel\": 0.049", "\"cart_mm\": 3.9", "\"fraction\": 0"] {
        let text = GOOD.replace("0.75", &format!("0.75, \"blend\": {{ {stop} }}"));
        JointPath::new(&Program::from_json(&text).unwrap(), &Robot::lbr_iiwa_7_r800()).unwrap();
    }
}

#[test]
fn nothing_to_start_from_and_nothing_to_do() {
    let start = "  \"start\": { \"joints_deg\": [0, 0, 0, 0, 0, 0, 0] },\n";
    check(start, "", (1, 1), "{", "the key `start` is missing");
    check(start, "  \"start\": null,\n", (3, 12), "null", "expected an object, found null");
    let motions = &GOOD[GOOD.find("[\n").unwrap()..=GOOD.rfind(']').unwrap()];
    let message = "the program has no motions; add at least one";
    check(motions, "[]", (4, 14), "[]", message);
    check(&format!(",\n  \"motions\": {motions}"), "", (1, 1), "{", "the key `motions` is missing");
}

#[test]
fn brackets_without_end() {
    const N: usize = 20_000_000;
    let start = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] }, "motions": "#;
    let far = "the text ends too early";
    for (before, bracket, message) in [
        ("", "[", "expected an object, found a list"),
        ("", "{", "a key is expected, in double quotes"),
        ("{\"motions\":", "[", far),
        ("{\"motions\":", "{\"a\":", "expected a list, found an object"),
        ("{\"version\":", "[", "expected a whole number, 0 or more, found a list"),
        ("{\"robot\":", "[", "expected a string, found a list"),
        ("{\"start\":", "[", "expected an object, found a list"),
        (start, "[", far),
        (&format!("{start}["), "[", far),
        (&format!("{start}["), "{\"type\":", far),
    ] {
        let text = format!("{before}{}", bracket.repeat(N / bracket.len()));
        let clock = Instant::now();
        let error = Program::from_json(&text).unwrap_err();
        let duration = clock.elapsed();
        assert!(duration < Duration::from_secs(10), "{before}{bracket}: {duration:?}");
        assert!(error.message().ends_with(message), "{before}{bracket}: {error}");
        assert!(error.to_string().len() < 200, "{before}{bracket}");
    }
    // Balanced brackets.
    for (open, close) in [("[", "]"), ("{\"type\":", "}")] {
        let deep = open.repeat(N / 20) + "1" + &close.repeat(N / 20);
        let text = format!("{start}[{deep}] }}");
        let error = Program::from_json(&text).unwrap_err();
        assert!(error.message().starts_with("motion 1: expected "), "{error}");
    }
}

#[test]
fn errors_can_be_matched_on() {
    let error = Program::from_json(&GOOD.replace("1,", "3,")).unwrap_err();
    assert!(matches!(error, ProgramError::Version { found: 3, .. }), "{error:?}");
}
