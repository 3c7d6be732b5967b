//! Parsing and checking of runs, in a separate thread so that stops are not delayed.

use std::sync::mpsc::Receiver;

use bytes::Bytes;
use iiwa_kin::{Joints, Robot};
use iiwa_link::{
    TimedJoints,
    message::{
        Code, Id, MAX_MOTIONS, MAX_MOTIONS_BYTES, MAX_SHORT_REQUEST_BYTES, Refusal, Reply, Request,
        RequestHead, RobotIdentity, RunLabel, to_json,
    },
    robot_program::RunId,
    transport::Permit,
};
use iiwa_path::JointPath;
use iiwa_program::{Course, Motion, MotionList};

/// A job of the checking thread. `C` identifies clients.
pub(super) enum CheckJob<C> {
    /// Check a run.
    Check(UncheckedRun),
    /// Refuse a long request, with its id in the reply.
    Refuse { client: C, body: Bytes, permit: Option<Permit>, refusal: Refusal },
}

/// A run as received.
pub(super) struct UncheckedRun {
    pub(super) run: RunId,
    pub(super) body: Bytes,
    /// The permit of a long request: the next long request is not received before this run is
    /// checked.
    pub(super) permit: Option<Permit>,
    /// Current joint positions, in rad.
    pub(super) at_rad: Joints,
}

/// The result of a job.
pub(super) enum CheckResult<C> {
    /// A checked run.
    Checked(CheckedRun),
    /// The reply to a refused request.
    Refused(C, String),
}

/// A checked run.
pub(super) struct CheckedRun {
    pub(super) run: RunId,
    pub(super) id: Option<Id>,
    pub(super) task: Result<(RunTask, RunLabel), Refusal>,
}

/// The motions or trajectory of a run.
pub(super) enum RunTask {
    Motions(Box<MotionList>),
    Trajectory(Box<TimedJoints>),
}

/// Carries out jobs until their sender is dropped.
pub(super) fn check<C>(robot: &Robot, jobs: &Receiver<CheckJob<C>>, done: impl Fn(CheckResult<C>)) {
    for job in jobs {
        done(carry_out(robot, job));
    }
}

pub(super) fn carry_out<C>(robot: &Robot, job: CheckJob<C>) -> CheckResult<C> {
    match job {
        CheckJob::Check(UncheckedRun { run, body, permit, at_rad }) => {
            let (id, task) = read(&body, robot, &at_rad);
            // In this order: the permit bounds the number of long bodies in memory.
            drop((body, permit));
            CheckResult::Checked(CheckedRun { run, id, task })
        }
        CheckJob::Refuse { client, body, permit, refusal } => {
            let (id, _) = Request::head(&body);
            drop((body, permit));
            let reply = Reply { id: id.as_ref(), error: Some(&refusal), body: None };
            CheckResult::Refused(client, reply.to_json())
        }
    }
}

fn read(
    body: &[u8],
    robot: &Robot,
    at_rad: &Joints,
) -> (Option<Id>, Result<(RunTask, RunLabel), Refusal>) {
    let (id, head) = Request::head(body);
    let is_trajectory = head.as_ref().is_ok_and(|head| head.name() == Some("run_trajectory"));
    if body.len() > MAX_MOTIONS_BYTES && !is_trajectory {
        let (found, max_bytes) = (body.len(), MAX_MOTIONS_BYTES);
        let refusal = Refusal::bad(format!(
            "the request has {found} bytes; at most {max_bytes} are allowed, except for a \
             trajectory"
        ));
        return (id, Err(refusal));
    }
    let check_robot = |label: &RunLabel| match &label.planned_for {
        Some(planned_for) => RobotIdentity::from(robot).check_run(planned_for),
        None => Ok(()),
    };
    let task = head.and_then(RequestHead::parse).and_then(|request| match request {
        Request::RunMotions { motions, label } => {
            check_robot(&label)?;
            check_motions(&motions, body, robot, at_rad)?;
            Ok((RunTask::Motions(Box::new(motions)), label))
        }
        Request::RunTrajectory { trajectory, label } => {
            check_robot(&label)?;
            trajectory.check(robot.limits(), at_rad)?;
            Ok((RunTask::Trajectory(Box::new(trajectory)), label))
        }
        _ => Err(Refusal::bad(format!(
            "the request is too long: only motions and trajectories may have more than \
             {MAX_SHORT_REQUEST_BYTES} bytes"
        ))),
    });
    (id, task)
}

/// Checks the motions in the request `body`.
fn check_motions(
    list: &MotionList,
    body: &[u8],
    robot: &Robot,
    at_rad: &Joints,
) -> Result<(), Refusal> {
    // Robot programs run motions, waits and payload changes; signals have other instructions.
    if let Some(index) = list.motions.iter().position(|motion| motion.io().is_some()) {
        let (number, kind) = (index + 1, list.motions[index].motion_type().name());
        return Err(Refusal::bad(format!(
            "motion {number} is `{kind}`, which does not run within a request; send the motions \
             before and after it as two requests, and `set_io` or `get_io` between them"
        )));
    }
    let count: usize = list.motions.iter().map(segments).sum();
    if count > MAX_MOTIONS {
        let motions = list.motions.len();
        let of_splines = if motions == count {
            String::new()
        } else {
            format!(" that make {count}, since each segment of a spline counts")
        };
        return Err(Refusal::bad(format!(
            "the request has {motions} motions{of_splines}; at most {MAX_MOTIONS} are allowed; \
             split it where the arm stops"
        )));
    }
    // The size as the robot program receives the list: with more digits, and with optional keys.
    let bytes = to_json(list).len();
    if bytes > MAX_MOTIONS_BYTES {
        return Err(Refusal::bad(format!(
            "written out in full, the request has {bytes} bytes; at most {MAX_MOTIONS_BYTES} are \
             allowed"
        )));
    }
    // A measured position may be slightly outside the joint range.
    let program = list.clone().starting_at(robot.limits().clamp(at_rad));
    JointPath::new(&program, robot).map(drop).map_err(|fault| {
        let mut refusal = Refusal::of_fault(&fault);
        if refusal.code == Code::BadRequest {
            let text = std::str::from_utf8(body).unwrap_or_default();
            refusal.message = format!("{fault}, at {}", fault.place_in(text));
        }
        refusal
    })
}

/// Number of motions that a motion counts as: the number of segments for a spline.
fn segments(motion: &Motion) -> usize {
    match motion {
        Motion::Cartesian(cartesian) => match &cartesian.course {
            Course::Spline(segments) => segments.len(),
            _ => 1,
        },
        Motion::Ptp(_) | Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => 1,
    }
}
