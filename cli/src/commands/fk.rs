//! `iiwasim fk`.

use std::fmt::Write as _;

use iiwa_kin::Pose;
use serde::Serialize;

use crate::{
    args::Fk,
    failure::{Failure, print_note},
    frame::{ReachedFrame, Workplace},
    lines::{joint_columns, joints_rad, quoted, records, rounded},
    output,
};

#[derive(Serialize)]
struct PoseAnswer<'a> {
    position_m: [f64; 3],
    rotation: [[f64; 3]; 3],
    frame: ReachedFrame,
    robot: &'a str,
}

/// Output for one of many poses.
#[derive(Serialize)]
#[serde(untagged)]
enum PoseLine {
    Pose { position_m: [f64; 3], rotation: [[f64; 3]; 3], frame: ReachedFrame },
    Error { error: String },
}

/// Prints the poses for all joint positions on standard input; continues after invalid ones.
fn print_all(place: &Workplace, json: bool) -> Result<(), Failure> {
    if !json {
        output::print("x_mm,y_mm,z_mm,a_deg,b_deg,c_deg,e1_deg,status,turn,error\n")?;
    }
    let (mut lines, mut failed) = (0_usize, 0_usize);
    for object in records(joint_columns) {
        let (number, object) = object?;
        lines += 1;
        let joints = object.and_then(|object| joints_rad(&object)).and_then(|joints| {
            let limits = place.robot.limits();
            limits.check(&joints).map(|()| joints).map_err(|outside| outside.to_string())
        });
        let answer = match joints {
            Ok(joints) => {
                let (Pose { position_m, rotation }, frame) =
                    (place.pose(&joints), place.frame(&joints));
                PoseLine::Pose { position_m, rotation, frame }
            }
            Err(error) => {
                failed += 1;
                let note = Failure::input(format!("standard input, line {number}: {error}"));
                print_note(&format!("{}\n", note.message()));
                PoseLine::Error { error }
            }
        };
        let line = if json { output::json_line(&answer)? } else { csv_line(&answer) };
        if !output::print_if_read(&line)? {
            break;
        }
    }
    match failed {
        0 => Ok(()),
        failed => Err(Failure::Gate(format!("{failed} of {lines} lines have no pose"))),
    }
}

fn csv_line(answer: &PoseLine) -> String {
    match answer {
        PoseLine::Pose { frame, .. } => {
            let ReachedFrame { x_mm, y_mm, z_mm, a_deg, b_deg, c_deg, e1_deg, status, turn } =
                *frame;
            let numbers = [x_mm, y_mm, z_mm, a_deg, b_deg, c_deg, e1_deg];
            let numbers = numbers.map(|number| rounded(number).to_string()).join(",");
            format!("{numbers},{status},{turn},\n")
        }
        PoseLine::Error { error } => format!("{}{}\n", ",".repeat(9), quoted(error)),
    }
}

/// Prints the pose of the flange, or of a TCP.
pub(crate) fn run(options: &Fk) -> Result<(), Failure> {
    let place = Workplace::new(options.robot.as_deref(), &options.place)?;
    if options.joints.stdin {
        return print_all(&place, options.json);
    }
    let robot = &place.robot;
    let joints = options.joints.rad();
    robot.limits().check(&joints).map_err(|outside| Failure::input(outside.to_string()))?;
    let (pose, frame) = (place.pose(&joints), place.frame(&joints));
    if options.json {
        let robot = robot.name();
        let answer =
            PoseAnswer { position_m: pose.position_m, rotation: pose.rotation, frame, robot };
        return output::print_json(&answer);
    }
    let [x, y, z] = pose.position_m.map(|v| v * 1e3);
    let mut text = format!("position   {x:10.3} {y:10.3} {z:10.3}  mm\n");
    for (name, row) in ["rotation", "", ""].iter().zip(pose.rotation) {
        // Avoids a negative zero.
        let [a, b, c] = row.map(|v| (v * 1e6).round() / 1e6 + 0.0);
        let _ = writeln!(text, "{name:<10} {a:10.6} {b:10.6} {c:10.6}");
    }
    // A turns about z, then B about the new y, then C about the new x, as on KUKA robots.
    let ReachedFrame { a_deg: a, b_deg: b, c_deg: c, e1_deg, status, turn, .. } = frame;
    let _ = writeln!(text, "A, B, C    {a:10.3} {b:10.3} {c:10.3}  deg");
    let _ = writeln!(text, "E1         {e1_deg:10.3}  deg, status {status}, turn {turn}");
    output::print(&text)
}
