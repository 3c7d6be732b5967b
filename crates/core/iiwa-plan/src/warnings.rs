//! Warnings about programs that can be planned.

use iiwa_kin::{Load, Robot};
use iiwa_path::{JointPath, ShortenedBlend, SplineStop, Step, TurnContradiction};
use iiwa_program::{MotionIndex, Program, Start};

/// Warnings about a program with this path, as messages for the user: a start frame without E1 or
/// status, a payload above the rated payload, targets whose turn contradicts the joint positions,
/// splines with TCP stops, blends that are shortened to half of a motion, and blends without a
/// following motion or into one that does not move. Motions are reported with their names and
/// sources.
#[must_use]
pub fn warnings(program: &Program, path: &JointPath) -> Vec<String> {
    let turns = TurnContradiction::all(program, path.robot()).unwrap_or_default();
    let stops = path.stops_in_splines().into_iter().map(|(motion, places)| {
        let count = places.len();
        let often = if count == 1 { "once".to_owned() } else { format!("{count} times") };
        format!(
            "motion {motion}: the TCP stops {often} within the spline ({}): where it turns back, \
             at a repeated point, or where direction, curvature, turn or E1 rates of two lines or \
             circles differ (a segment `spl` between them avoids that)",
            listed(&places)
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
            "motion {motion} does not move: the blend of motion {blended} has nothing to blend \
             into, and the arm stops"
        ))
    });
    let turns = turns.iter().map(ToString::to_string);
    open_start(program)
        .into_iter()
        .chain(overload(program, path.robot()))
        .chain(turns)
        .chain(stops)
        .chain(shortened_blends(path))
        .chain(into_standstill)
        .chain(end)
        .map(|warning| program.sources.in_message(&warning))
        .collect()
}

/// Lists the first places at which the TCP stops within a spline.
fn listed(places: &[SplineStop]) -> String {
    /// Largest number of places that are named.
    const NAMED: usize = 5;
    let mut texts: Vec<_> = places.iter().take(NAMED).map(ToString::to_string).collect();
    if places.len() > NAMED {
        texts.push(format!("and {} more", places.len() - NAMED));
    }
    texts.join(", ")
}

/// Warnings about blends that would exceed half of a motion.
fn shortened_blends(path: &JointPath) -> Vec<String> {
    /// Largest number of blends that are named.
    const NAMED: usize = 10;
    let mut all = path.blends().filter_map(|(corner, _)| Some((corner.motion, corner.shortened?)));
    let warning = |(motion, blend): (MotionIndex, ShortenedBlend)| {
        let ShortenedBlend { half_of, asked_mm, used_mm } = blend;
        let asked_mm = (1e3 * asked_mm).round() / 1e3;
        format!(
            "motion {motion}: its blend of {asked_mm} mm is shortened to {used_mm:.1} mm: a blend \
             takes at most half of a motion or of a spline segment, and motion {half_of} is \
             too short"
        )
    };
    let mut warnings: Vec<_> = all.by_ref().take(NAMED).map(warning).collect();
    let more = all.count();
    if more > 0 {
        warnings.push(format!("and {more} more blends are shortened"));
    }
    warnings
}

/// Warning about the first motion with the largest payload, if it is above the rated payload.
fn overload(program: &Program, robot: &Robot) -> Option<String> {
    let rated_kg = robot.rated_payload_kg()?;
    let mut largest = None;
    for ((motion, entry), load) in program.entries().zip(program.loads()) {
        let Some(Load { mass_kg, .. }) = load.filter(|_| entry.moves()) else { continue };
        if mass_kg > largest.map_or(rated_kg, |(_, mass_kg)| mass_kg) {
            largest = Some((motion, mass_kg));
        }
    }
    largest.map(|(motion, mass_kg)| {
        format!(
            "motion {motion}: the payload of {mass_kg} kg is above the robot's rated payload of \
             {rated_kg} kg; the real robot may refuse it or be slower"
        )
    })
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

#[cfg(test)]
mod tests {
    use super::*;

    fn warnings_of(robot: &Robot, masses_kg: [f64; 2]) -> Vec<String> {
        let [tool_kg, lifted_kg] = masses_kg;
        let text = format!(
            r#"{{ "version": 1, "tool": "gripper",
                "tools": {{ "gripper": {{ "tcp": {{}}, "load": {{ "mass_kg": {tool_kg} }} }} }},
                "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }},
                "motions": [
                    {{ "type": "ptp", "joints_deg": [5, 0, 0, 0, 0, 0, 0] }},
                    {{ "type": "load", "load": {{ "mass_kg": {lifted_kg} }} }},
                    {{ "type": "ptp", "joints_deg": [9, 0, 0, 0, 0, 0, 0] }},
                    {{ "type": "ptp", "joints_deg": [5, 0, 0, 0, 0, 0, 0] }} ] }}"#
        );
        let program = Program::from_json(&text).unwrap();
        warnings(&program, &JointPath::new(&program, robot).unwrap())
    }

    #[test]
    fn a_payload_above_the_rated_payload_is_reported_once() {
        let [small, large] = [Robot::lbr_iiwa_7_r800(), Robot::lbr_iiwa_14_r820()];
        assert_eq!(warnings_of(&small, [7.0, 7.0]), [""; 0]);
        assert_eq!(warnings_of(&large, [7.5, 14.0]), [""; 0]);
        let [warning] = &warnings_of(&small, [7.5, 9.0])[..] else { panic!("one warning") };
        assert!(warning.starts_with("motion 3: the payload of 9 kg is above"), "{warning}");
        assert!(warning.contains("rated payload of 7 kg"), "{warning}");
        let [warning] = &warnings_of(&large, [15.0, 14.5])[..] else { panic!("one warning") };
        assert!(warning.starts_with("motion 1: the payload of 15 kg"), "{warning}");
    }
}
