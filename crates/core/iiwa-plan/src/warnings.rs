//! Warnings about programs that can be planned.

use iiwa_path::{JointPath, Step, TurnContradiction};
use iiwa_program::{Program, Start};

/// Warnings about a program with this path, as messages for the user: a start frame without E1 or
/// status, targets whose turn contradicts the joint positions, splines with TCP stops, and blends
/// without a following motion or into one that does not move.
#[must_use]
pub fn warnings(program: &Program, path: &JointPath) -> Vec<String> {
    let turns = TurnContradiction::all(program, path.robot()).unwrap_or_default();
    let stops = path.stops_in_splines().into_iter().map(|(motion, count)| {
        let often = if count == 1 { "once".to_owned() } else { format!("{count} times") };
        format!(
            "motion {motion}: the TCP stops {often} within the spline: where it turns back, at a \
             repeated point, or where direction, curvature, turn or E1 rates of two lines or \
             circles differ (a segment `spl` between them avoids that)"
        )
    });
    let end = program.blend_at_the_end().map(|motion| {
        format!(
            "motion {motion} is the last one: its blend has nothing to blend into, and the arm \
             stops"
        )
    });
    let into_standstill = path.steps().iter().filter_map(|step| {
        let Step::Settle { motion, still: true, .. } = step else { return None };
        let blended = program.blend_into(*motion)?;
        Some(format!(
            "motion {motion} does not move: the blend of motion {blended} has nothing to blend into, and the arm stops"
        ))
    });
    let turns = turns.iter().map(ToString::to_string);
    open_start(program)
        .into_iter()
        .chain(turns)
        .chain(stops)
        .chain(into_standstill)
        .chain(end)
        .collect()
}

/// Warning about the redundancy parameters that a start frame leaves open.
fn open_start(program: &Program) -> Option<String> {
    let Start::Frame(target) = &program.start else { return None };
    let (target, _) = program.workcell.target(target, None).ok()?;
    let open = [("e1_deg", target.e1_rad.is_none()), ("status", target.status.is_none())];
    let open: Vec<_> =
        open.iter().filter(|(_, is_open)| *is_open).map(|(key, _)| format!("`{key}`")).collect();
    (!open.is_empty()).then(|| {
        format!(
            "the start is a frame without {}: E1 is taken as 0, the status as 2; the robot may be \
             in another configuration",
            open.join(" and ")
        )
    })
}
