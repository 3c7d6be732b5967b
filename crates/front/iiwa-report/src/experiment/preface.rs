//! Introduction of a report on experiments, and a warning before they run.

use std::fmt::Write as _;

use iiwa_eval::experiment::Trial;
use iiwa_kin::Robot;
use iiwa_path::{JointPath, Step};
use iiwa_program::{Fault, Motion};

use super::{bench::Bench, chapter::wrapped, kind::ExperimentKind, virtual_arm::VirtualArm};

/// Describes the range of each joint of `robot` in `count` programs, for people near the arm.
///
/// # Errors
///
/// [`Fault`] if the robot cannot perform a program.
pub fn motion_warning<'a>(
    robot: &Robot,
    trials: impl Iterator<Item = &'a Trial>,
    count: usize,
) -> Result<String, Fault> {
    const PLACES: u32 = 16;
    let mut range = [(f64::INFINITY, f64::NEG_INFINITY); 7];
    for trial in trials {
        let path = JointPath::new(&trial.program, robot)?;
        let targets = trial.program.motions.iter().filter_map(|motion| match motion {
            Motion::Ptp(ptp) => Some(ptp.target_rad),
            _ => None,
        });
        let on_the_way = path.steps().iter().filter_map(|step| match step {
            Step::Move { segment, .. } => Some(segment),
            _ => None,
        });
        let on_the_way = on_the_way.flat_map(|segment| {
            (0..=PLACES).map(|i| segment.at(f64::from(i) / f64::from(PLACES)).q)
        });
        for joints in on_the_way.chain(targets).chain([*path.start_rad()]) {
            for (range, q) in range.iter_mut().zip(joints) {
                *range = (range.0.min(q), range.1.max(q));
            }
        }
    }
    let mut text =
        format!("The arm will run programs: {count}. Joints will move between, in deg:\n");
    for (j, (low, high)) in range.iter().enumerate() {
        let _ =
            writeln!(text, "  A{} {:7.1} and {:6.1}", j + 1, low.to_degrees(), high.to_degrees());
    }
    text.push_str(
        "All that its links can reach there has to be free. Ctrl-C stops it on its path.\n",
    );
    Ok(text)
}

/// Returns the text before the chapters of `kinds` in a report that `command` created. For a
/// virtual arm, with the name of its robot unless that is the model.
#[must_use]
pub fn preface(
    command: &str,
    kinds: &[ExperimentKind],
    bench: &Bench,
    virtual_arm: Option<(&VirtualArm, Option<&str>)>,
) -> String {
    let thesis_only = kinds.iter().all(|kind| kind.is_of_thesis());
    let has_thesis = kinds.iter().any(|kind| kind.is_of_thesis());
    let title = if has_thesis {
        "The experiments of the thesis, repeated"
    } else if kinds.contains(&ExperimentKind::Load) {
        "An experiment with a load"
    } else {
        "An experiment with TCP paths"
    };
    let mut text = format!("# {title}\n\n");
    let _ = writeln!(text, "Made by\n\n```sh\n{command}\n```");
    let mut paragraph = |words: &str| {
        let _ = writeln!(text, "\n{}", wrapped(words));
    };
    let model = bench.model.name();
    match virtual_arm {
        Some((arm, name)) => {
            let robot = match name {
                None => format!("the model itself, {model}"),
                Some(name) => format!("`{name}`, while the model is {model}"),
            };
            paragraph(&format!(
                "**Everything measured here was measured on a virtual robot, not on a real one.** \
                 It is a simulation in the same process, which plans with velocity, acceleration \
                 and jerk limits and is sampled with noise of {:e} rad. It is {robot}. Agreement \
                 with the model shows that the methods work. It does not show that a real robot \
                 behaves like the model: for that, the same programs have to be run on one.",
                arm.noise_rad
            ));
        }
        None => paragraph(&format!(
            "Measured {}; the model is {model}. The drive does not report whether that was a real \
             robot or a simulated cabinet.",
            bench.on
        )),
    }
    paragraph(
        "\"The thesis\" is C. Larsen, *Including a Collaborative Robot in Digital Twin \
         Manufacturing Systems* (Chalmers 2019); figures, tables and equations have its numbers. \
         Its figures are not reproduced here; its results are quoted in words or numbers. In the \
         figures, calculated values are blue and measured ones red.",
    );
    if has_thesis && !thesis_only {
        paragraph("The chapter on blends of TCP paths is not in the thesis.");
    }
    text
}

#[cfg(test)]
mod tests {
    use iiwa_eval::experiment;

    use super::*;

    #[test]
    fn the_warning_tells_the_joints_ranges() {
        let trial = experiment::zone_velocity();
        let text = motion_warning(&Robot::default(), [&trial].into_iter(), 1).unwrap();
        assert!(text.contains("A2   -27.2 and   63.6"), "{text}");
        assert!(text.contains("A1     0.0 and    0.0"), "{text}");
        // TCP paths, with a frame as start.
        let trial = experiment::tcp_blends(&[experiment::TcpSeries::Angles]);
        let text = motion_warning(&Robot::default(), [&trial].into_iter(), 1).unwrap();
        assert!(!text.contains("inf") && !text.contains("A2     0.0"), "{text}");
    }
}
