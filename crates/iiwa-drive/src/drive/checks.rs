//! Parsing and checking of runs. A thread of its own does it, so that it does not delay stops.

use std::sync::mpsc::Receiver;

use bytes::Bytes;
use iiwa_kin::{Joints, Robot};
use iiwa_link::{
    TimedJoints,
    message::{
        Code, Id, MAX_MOTIONS, MAX_MOTIONS_BYTES, MAX_SHORT_REQUEST_BYTES, Refusal, Reply, Request,
        RequestHead,
    },
    robot_program::RunId,
    transport::Permit,
};
use iiwa_path::JointPath;
use iiwa_program::{Motion, MotionIndex, Program, Start, Workcell};

/// A job of the thread. `C` identifies clients.
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
    /// The permit of a long request: the next one is not received before this one is checked.
    pub(super) permit: Option<Permit>,
    /// Where the arm is, in rad.
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
    pub(super) task: Result<RunTask, Refusal>,
}

/// The motions or trajectory of a run.
pub(super) enum RunTask {
    Motions(Vec<Motion>),
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

fn read(body: &[u8], robot: &Robot, at_rad: &Joints) -> (Option<Id>, Result<RunTask, Refusal>) {
    let (id, head) = Request::head(body);
    let is_trajectory = head.as_ref().is_ok_and(|head| head.name() == Some("run_trajectory"));
    if body.len() > MAX_MOTIONS_BYTES && !is_trajectory {
        let (found, most) = (body.len(), MAX_MOTIONS_BYTES);
        let refusal = Refusal::bad(format!(
            "the request has {found} bytes; at most {most} are allowed, except for a trajectory"
        ));
        return (id, Err(refusal));
    }
    let task = head.and_then(RequestHead::parse).and_then(|request| match request {
        Request::RunMotions { motions } => {
            check_motions(&motions, robot, at_rad).map(|()| RunTask::Motions(motions))
        }
        Request::RunTrajectory { trajectory } => {
            trajectory.check(robot.limits(), at_rad)?;
            Ok(RunTask::Trajectory(Box::new(trajectory)))
        }
        _ => Err(Refusal::bad(format!(
            "the request is too long: only motions and trajectories may have more than \
             {MAX_SHORT_REQUEST_BYTES} bytes"
        ))),
    });
    (id, task)
}

fn check_motions(motions: &[Motion], robot: &Robot, at_rad: &Joints) -> Result<(), Refusal> {
    if motions.len() > MAX_MOTIONS {
        return Err(Refusal::bad(format!(
            "the request has {} motions, at most {MAX_MOTIONS} are allowed; split it where the arm stops",
            motions.len()
        )));
    }
    // Tools and bases are the program's, which a request does not have: the flange would go where a TCP is meant to.
    let to_frame = |motion: &Motion| matches!(motion, Motion::Cartesian(_));
    if let Some(index) = motions.iter().position(to_frame) {
        return Err(Refusal::bad(format!(
            "motion {} goes to a frame, which the robot program does not know; send a trajectory",
            MotionIndex::new(index)
        )));
    }
    let start_rad = robot.limits().clamp(at_rad);
    let program = Program {
        robot: None,
        start: Start::Joints(start_rad),
        motions: motions.to_vec(),
        workcell: Workcell::default(),
    };
    JointPath::new(&program, robot)
        .map(drop)
        .map_err(|fault| Refusal::new(Code::Limit, fault.to_string()))
}
