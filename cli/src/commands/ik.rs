//! `iiwasim ik`.

use std::fmt::Write as _;

use iiwa_kin::{Joints, Singularity, Status, Turn};
use iiwa_program::{Target, TargetRef};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::{
    args::Ik,
    failure::{Failure, print_note},
    frame::{ReachedFrame, Workplace},
    lines::{frame_columns, quoted, records, rounded},
    output,
};

#[derive(Serialize)]
struct JointsAnswer<'a> {
    joints_deg: [f64; 7],
    joints_rad: [f64; 7],
    frame: ReachedFrame,
    /// Ranges of E1 with which all joints are within their limits.
    allowed_e1_deg: Vec<[f64; 2]>,
    singularity: SingularityAnswer,
    robot: &'a str,
}

#[derive(Serialize)]
struct SingularityAnswer {
    least: f64,
    axis: String,
    shoulder: f64,
    elbow: f64,
    wrist: f64,
}

/// Prints the joint positions that reach a frame, or those for all frames on standard input.
pub(crate) fn run(options: &Ik) -> Result<(), Failure> {
    let place = Workplace::new(options.robot.as_deref(), &options.place)?;
    if options.stdin {
        return solve_all(&place, options);
    }
    let IkSolution { joints_rad, allowed_rad, turn } =
        solve(&place, options, &place.frame_named(&options.frame)?)?;
    check_turn(turn, &joints_rad);
    print(&place, &joints_rad, &allowed_rad, options.json)
}

/// Joint positions that reach a frame.
struct IkSolution {
    joints_rad: Joints,
    /// Ranges of E1 with which all joints are within their limits.
    allowed_rad: Vec<[f64; 2]>,
    /// Turn stated by the frame.
    turn: Option<Turn>,
}

fn solve(place: &Workplace, options: &Ik, frame: &TargetRef) -> Result<IkSolution, Failure> {
    let robot = &place.robot;
    let (target, flange) = place.target(frame)?;
    let near = options.near.map(|joints_deg| joints_deg.map(f64::to_radians));
    let near = near.map(|joints_rad| robot.redundancy(&joints_rad));
    let e1_rad = options.e1_deg.map(f64::to_radians).or(target.e1_rad);
    let e1_rad = e1_rad.or(near.map(|near| near.e1_rad)).ok_or_else(|| {
        missing("E1, the position of joint A3,", "--e1-deg, by `e1_deg` in the frame")
    })?;
    let status = options.status.and_then(Status::new).or(target.status);
    let status = status
        .or(near.map(|near| near.status))
        .ok_or_else(|| missing("the status, 0 to 7,", "--status, by `status` in the frame"))?;

    let allowed_rad = robot.allowed_e1(&flange, status).map_err(|error| to_failure(&error))?;
    let unless = |reason: &dyn std::error::Error| {
        Failure::input(format!("{reason}; {}", with_other_e1(&allowed_rad, status)))
    };
    let joints_rad = robot.inverse(&flange, e1_rad, status).map_err(|error| unless(&error))?;
    robot.limits().check(&joints_rad).map_err(|error| unless(&error))?;
    Ok(IkSolution { joints_rad, allowed_rad, turn: target.turn.and_then(Turn::new) })
}

/// Output for one of many frames.
#[derive(Default, Serialize)]
struct JointsLine {
    #[serde(skip_serializing_if = "Option::is_none")]
    joints_deg: Option<[f64; 7]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

/// Prints the joint positions for all frames on standard input; continues after unreachable ones.
fn solve_all(place: &Workplace, options: &Ik) -> Result<(), Failure> {
    if !options.json {
        let names: Vec<_> = (1..=7).map(|joint| format!("joint_{joint}_deg")).collect();
        output::print(&format!("{},error\n", names.join(",")))?;
    }
    let (mut frames, mut failed) = (0_usize, 0_usize);
    for object in records(frame_columns) {
        let (number, object) = object?;
        frames += 1;
        let inverse = object
            .map_err(Failure::input)
            .and_then(|object| solve(place, options, &frame_of(object)?));
        let answer = match inverse {
            Ok(IkSolution { joints_rad, .. }) => {
                JointsLine { joints_deg: Some(joints_rad.map(f64::to_degrees)), error: None }
            }
            Err(failure) => {
                failed += 1;
                let error = failure.message();
                print_note(&format!("standard input, line {number}: {error}\n"));
                JointsLine { error: Some(error), ..JointsLine::default() }
            }
        };
        let line = if options.json { output::json_line(&answer)? } else { csv_line(&answer) };
        if !output::print_if_read(&line)? {
            break;
        }
    }
    match failed {
        0 => Ok(()),
        failed => Err(Failure::Gate(format!("{failed} of {frames} frames are not reached"))),
    }
}

/// Returns the frame of an object: the object itself, or its key `frame`, as in the output of `fk`.
fn frame_of(mut object: Map<String, Value>) -> Result<TargetRef, Failure> {
    // Output of `fk` in place of a pose.
    if let Some(Value::String(error)) = object.get("error") {
        return Err(Failure::input(error));
    }
    let frame = object.remove("frame").filter(Value::is_object);
    let text = frame.unwrap_or(Value::Object(object)).to_string();
    // The line is the only place information.
    let frame = Target::from_json(&text).map_err(|error| Failure::input(error.message()))?;
    Ok(TargetRef::Given(frame))
}

fn csv_line(answer: &JointsLine) -> String {
    let joints = answer.joints_deg.map_or_else(
        || ",".repeat(6),
        |joints_deg| joints_deg.map(|joint| rounded(joint).to_string()).join(","),
    );
    format!("{joints},{}\n", answer.error.as_deref().map(quoted).unwrap_or_default())
}

fn missing(missing_value: &str, how: &str) -> Failure {
    Failure::input(format!("{missing_value} is not given: by {how}, or by --near"))
}

fn to_failure(error: &dyn std::error::Error) -> Failure {
    Failure::input(error.to_string())
}

/// Suggests ranges of E1.
fn with_other_e1(allowed_rad: &[[f64; 2]], status: Status) -> String {
    if allowed_rad.is_empty() {
        return format!("with status {status} no E1 keeps all joints within their limits");
    }
    format!("with status {status} all joints are within their limits at E1 {}", ranges(allowed_rad))
}

fn ranges(of_rad: &[[f64; 2]]) -> String {
    let ranges: Vec<_> = of_rad
        .iter()
        .map(|range| {
            let [from, to] = range.map(f64::to_degrees);
            format!("{from:.3} to {to:.3}")
        })
        .collect();
    format!("{} deg", ranges.join(", "))
}

/// Warns about a different turn. The turn does not select joint positions, but a difference may
/// show that the frame is from another arm.
fn check_turn(stated: Option<Turn>, joints_rad: &Joints) {
    let actual = Turn::of(joints_rad);
    if let Some(stated) = stated.filter(|stated| !stated.agrees_with(joints_rad)) {
        print_note(&format!(
            "Warning: the frame states turn {stated}, and these joints have turn {actual}\n"
        ));
    }
}

fn print(
    place: &Workplace,
    joints_rad: &[f64; 7],
    allowed_rad: &[[f64; 2]],
    json: bool,
) -> Result<(), Failure> {
    let joints_deg = joints_rad.map(f64::to_degrees);
    let robot = &place.robot;
    let singularity = robot.singularity(joints_rad);
    let (sigma, part) = singularity.nearest();
    let frame = place.frame(joints_rad);
    if json {
        let Singularity { shoulder, elbow, wrist } = singularity;
        return output::print_json(&JointsAnswer {
            joints_deg,
            joints_rad: *joints_rad,
            frame,
            allowed_e1_deg: allowed_rad.iter().map(|range| range.map(f64::to_degrees)).collect(),
            singularity: SingularityAnswer {
                least: sigma,
                axis: part.to_string(),
                shoulder,
                elbow,
                wrist,
            },
            robot: robot.name(),
        });
    }
    let mut text = "joints    ".to_owned();
    for joint in joints_deg {
        // Avoids a negative zero.
        let _ = write!(text, " {:9.3}", (joint * 1e3).round() / 1e3 + 0.0);
    }
    let _ = writeln!(text, "  deg");
    let _ = writeln!(text, "status     {}, turn {}", frame.status, frame.turn);
    let _ = writeln!(text, "E1         {} within limits", ranges(allowed_rad));
    let _ = writeln!(text, "singular   {sigma:.4} ({part}; 0 in the singularity)");
    output::print(&text)
}
