//! From recordings to the robot: limits of its joints, the time to settle, the curve of its blends.
//!
//! A recording is followed along the path of its program, from stop to stop. What is found:
//!
//! | figure | from | how |
//! |---|---|---|
//! | speed, acceleration, jerk | motions along a line from rest to rest | the seven phases of constant jerk are fitted to all samples of the motion (Larsen 2019, Appendix A differentiates) |
//! | ramps | the same | where constant jerk does not explain a motion, ramps as under Sunrise are fitted; see [`FoundRamps`] |
//! | time to settle | stops between two such motions | from the end of one to the start of the next, both as fitted (Appendix C) |
//! | kappa(gamma) | blends | Eq. 39 is fitted to the path about each corner, whatever the time; then a polynomial to kappa over gamma (section 4.3) |
//! | equal distances | blends between motions of unequal lengths | start and end are fitted too (Algorithm 3) |
//! | the same of blends of the TCP | blends between two LINs | the same in the plane of the TCP's ways, the joints taken forward |
//! | load, friction | torques, of recordings that have them | least squares: torques are linear in the moments of a load, see [`FoundTorques`] |
//! | what is assumed of orientation, E1 and blends with joint space | paths of the TCP and the blends at their ends | how far they are from the assumed path with kappa as found |
//!
//! A limit is found only where a recording shows it: a speed that was kept for a time, an acceleration that
//! was, and by a joint that must have been the one that limited the motion.

mod blends;
mod courses;
mod error;
mod findings;
mod found_ramps;
mod found_torques;
mod identified;
mod kappa;
mod limits;
mod observation;
mod observer;
mod ramps;
mod recording;
mod soft_ramps;
mod soft_shape;
mod stops;
mod tcp_blends;
mod torque_windows;
mod torques;
mod watched;

use iiwa_kin::{Robot, vector::distance};
use iiwa_path::{JointPath, PathOptions};

use self::{
    courses::{Courses, Section},
    findings::Findings,
    observer::Observer,
    stops::FollowedStops,
    watched::Watched,
};
pub use self::{
    error::IdentifyError,
    found_ramps::FoundRamps,
    found_torques::{FoundLoad, FoundTorques},
    identified::{Identified, Settle},
    kappa::Kappa,
    observation::{
        BlendObservation, CourseObservation, CoursePart, LeftOut, LineLaw, LineObservation,
        TcpBlendObservation, Why,
    },
    recording::Recording,
};

/// Identifies the robot that did what the recordings show. `model` is the robot that it is taken for: its
/// lengths and joint ranges hold.
///
/// At the override of a program, its motions took so much longer, which scales speeds by that share, accelerations by its square,
/// jerks by its cube and snaps by its fourth power. What is found is at full override. Pauses are not scaled.
///
/// # Errors
///
/// If a program cannot be planned for `model`, or a recording shows nothing of its program.
pub fn identify(recordings: &[Recording<'_>], model: &Robot) -> Result<Identified, IdentifyError> {
    let mut found = Findings::default();
    let mut followed_courses = Vec::new();
    for (recording, Recording { program, log }) in recordings.iter().enumerate() {
        let watched = Watched::new(recording, program, log, model)
            .map_err(|fault| IdentifyError::Program { recording, fault })?;
        let sections = observe(&watched, &mut found)?;
        if program.has_frames() {
            followed_courses.push((watched, sections));
        }
    }
    let mut known = found.conclude(model);
    // Only with the kappa that was found does a blend show what else is not as assumed.
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

/// Looks at one recording, and gives the sections in which it follows its program.
fn observe(watched: &Watched<'_>, found: &mut Findings) -> Result<Vec<Section>, IdentifyError> {
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
    found.period_s = found.period_s.max(log.period_s().unwrap_or_default());
    let mut sections = Vec::new();
    // The program may have been run again and again.
    loop {
        let FollowedStops { passages, lost_in } = &followed;
        Observer { watched, found }.observe(passages);
        for passage in passages {
            tcp_blends::observe(watched, passage, found);
            let (steps, samples) = (passage.steps.clone(), passage.samples.clone());
            sections.push(Section { steps, samples });
        }
        if let Some(motion) = *lost_in {
            let why = Why::NotFollowed;
            found.known.left_out.push(LeftOut { recording, motion, why });
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
