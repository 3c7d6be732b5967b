//! Identification of a robot from recordings: joint limits, settle time, blend curve, payload and
//! friction.
//!
//! A recording is followed along the path of its program, from stop to stop. Results:
//!
//! | result | source | method |
//! |---|---|---|
//! | speed, acceleration, jerk | motions along a line from rest to rest | the seven phases of constant jerk are fitted to all samples of the motion (Larsen 2019, Appendix A differentiates) |
//! | ramps | the same motions | where constant jerk does not explain a motion, ramps as under Sunrise are fitted; see [`RampEstimates`] |
//! | settle time | stops between two such motions | from the end of one to the start of the next, both as fitted (Appendix C) |
//! | kappa(gamma) | blends | Eq. 39 is fitted to the path around each corner, regardless of time; then a polynomial to kappa over gamma (section 4.3) |
//! | equal distances | blends between motions of unequal lengths | start and end are fitted as well (Algorithm 3) |
//! | TCP blends | blends between two LINs | the same fits in the plane of both TCP lines, by forward kinematics |
//! | payload, friction | torques, of recordings that have them | least squares: torques are linear in the moments of a payload, see [`TorqueEstimates`] |
//! | assumptions about orientation, E1 and blends with joint space | TCP paths and the blends at their ends | deviation from the assumed path with the identified kappa |
//!
//! A limit is identified only where a recording shows it: a speed or an acceleration that was kept
//! for a time, by a joint that must have been the one that limited the motion.

mod blends;
mod courses;
mod error;
mod findings;
mod identified;
mod kappa;
mod limits;
mod observation;
mod observer;
mod ramp_estimates;
mod ramps;
mod recording;
mod soft_ramps;
mod soft_shape;
mod stops;
mod tcp_blends;
mod torque_estimates;
mod torque_windows;
mod torques;
mod watched;

use iiwa_kin::{Robot, vector::distance};
use iiwa_path::{JointPath, PathOptions};

use self::{
    courses::{Courses, RecordedSection},
    findings::Findings,
    observer::Observer,
    stops::FollowedStops,
    watched::Watched,
};
pub use self::{
    error::IdentifyError,
    identified::{Identified, Settle},
    kappa::Kappa,
    observation::{
        BlendObservation, CourseObservation, CoursePart, LeftOut, LineLaw, LineObservation,
        TcpBlendObservation, Why,
    },
    ramp_estimates::RampEstimates,
    recording::RecordedRun,
    torque_estimates::{LoadEstimate, TorqueEstimates},
};

/// Identifies the robot in the recordings. `model` is the robot that it is assumed to be: its
/// lengths and joint ranges are used.
///
/// An override stretches the motions of a program, so that speeds scale with the override,
/// accelerations with its square, jerks with its cube and snaps with its fourth power. Results are
/// for full override. Standstill is not scaled.
///
/// # Errors
///
/// If a program cannot be planned for `model`, or a recording shows nothing of its program.
pub fn identify(
    recordings: &[RecordedRun<'_>],
    model: &Robot,
) -> Result<Identified, IdentifyError> {
    let mut findings = Findings::default();
    let mut followed_courses = Vec::new();
    for (recording, RecordedRun { program, log }) in recordings.iter().enumerate() {
        let watched = Watched::new(recording, program, log, model)
            .map_err(|fault| IdentifyError::Program { recording, fault })?;
        let sections = observe(&watched, &mut findings)?;
        if program.has_frames() {
            followed_courses.push((watched, sections));
        }
    }
    let mut known = findings.conclude(model);
    // The identified kappa is required first: only then does a blend show other deviations from the
    // assumptions.
    let robot = known.robot(model);
    let mut courses = Courses::default();
    for (watched, sections) in &followed_courses {
        let path = JointPath::on_other_robot(watched.program, &robot, PathOptions::default());
        let path = path.as_ref().unwrap_or(&watched.path);
        for section in sections {
            courses.observe(watched, path, section);
        }
    }
    known.courses = courses.observed;
    known.left_out.extend(courses.left_out);
    (known.torques, known.unused_torques) = torques::find(recordings, model);
    Ok(known)
}

/// Evaluates one recording and returns the sections in which it follows its program.
fn observe(
    watched: &Watched<'_>,
    findings: &mut Findings,
) -> Result<Vec<RecordedSection>, IdentifyError> {
    let Watched { recording, log, path, .. } = watched;
    let recording = *recording;
    let Some(mut followed) = stops::follow(path, log, 0) else {
        let from_start = log.q_rad.iter().map(|q| distance(q, path.start_rad()));
        let nearest_rad = from_start.fold(f64::INFINITY, f64::min);
        return Err(IdentifyError::NotThere { recording, nearest_rad });
    };
    if followed.passages.is_empty() {
        return Err(IdentifyError::NoMotion { recording });
    }
    findings.period_s = findings.period_s.max(log.period_s().unwrap_or_default());
    let mut sections = Vec::new();
    // The program may have been run several times.
    loop {
        let FollowedStops { passages, lost_in } = &followed;
        Observer { watched, found: findings }.observe(passages);
        for passage in passages {
            tcp_blends::observe(watched, passage, findings);
            let (steps, samples) = (passage.steps.clone(), passage.samples.clone());
            sections.push(RecordedSection { steps, samples });
        }
        if let Some(motion) = *lost_in {
            let reason = Why::NotFollowed;
            findings.known.left_out.push(LeftOut { recording, motion, why: reason });
            break;
        }
        let from = passages.last().map_or(log.q_rad.len(), |last| last.arrives);
        match stops::follow(path, log, from) {
            Some(again) if !again.passages.is_empty() => followed = again,
            _ => break,
        }
    }
    Ok(sections)
}
