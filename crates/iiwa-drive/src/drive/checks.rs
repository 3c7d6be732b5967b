//! Runs are read and checked by a thread of their own: however long that takes, a stop does not wait for
//! it.

use std::sync::mpsc::Receiver;

use bytes::Bytes;
use iiwa_kin::{Joints, Robot};
use iiwa_link::{
    TimedJoints,
    message::{
        Code, Id, MAX_MOTIONS, MAX_MOTIONS_BYTES, MAX_SHORT_REQUEST_BYTES, Refusal, Reply, Request,
    },
    transport::Permit,
};
use iiwa_path::{JointPath, Motion, Program};

use crate::robot_program::RunId;

/// What there is to do. `C` tells clients apart.
pub(super) enum Job<C> {
    /// To check a run.
    Check(Check),
    /// To refuse one that is long, with its id.
    Refuse { client: C, body: Bytes, permit: Option<Permit>, refusal: Refusal },
}

/// A run as it came in.
pub(super) struct Check {
    pub(super) run: RunId,
    pub(super) body: Bytes,
    /// Of a long one: the next one is not taken in before this is done.
    pub(super) permit: Option<Permit>,
    /// Where the arm is, in rad.
    pub(super) at_rad: Joints,
}

/// What comes of it.
pub(super) enum Done<C> {
    Checked(Checked),
    /// The reply to one that was refused.
    Refused(C, String),
}

/// A run that was checked.
pub(super) struct Checked {
    pub(super) run: RunId,
    pub(super) id: Option<Id>,
    pub(super) task: Result<Task, Refusal>,
}

/// What the robot is to do.
pub(super) enum Task {
    Motions(Vec<Motion>),
    Trajectory(Box<TimedJoints>),
}

/// Does what there is to do, until nobody asks any more.
pub(super) fn check<C>(robot: &Robot, jobs: &Receiver<Job<C>>, done: impl Fn(Done<C>)) {
    for job in jobs {
        done(carry_out(robot, job));
    }
}

pub(super) fn carry_out<C>(robot: &Robot, job: Job<C>) -> Done<C> {
    match job {
        Job::Check(Check { run, body, permit, at_rad }) => {
            let (id, task) = read(&body, robot, &at_rad);
            drop((body, permit));
            Done::Checked(Checked { run, id, task })
        }
        Job::Refuse { client, body, permit, refusal } => {
            let (id, _) = Request::head(&body);
            drop((body, permit));
            let reply = Reply { id: id.as_ref(), error: Some(&refusal), body: None };
            Done::Refused(client, reply.to_json())
        }
    }
}

fn read(body: &[u8], robot: &Robot, at_rad: &Joints) -> (Option<Id>, Result<Task, Refusal>) {
    if body.len() > MAX_MOTIONS_BYTES {
        let (id, name) = Request::head(body);
        if name.as_deref() != Some("run_trajectory") {
            let (found, most) = (body.len(), MAX_MOTIONS_BYTES);
            return (
                id,
                Err(Refusal::bad(format!(
                    "the request is {found} bytes long; {most} are the most for all but a trajectory"
                ))),
            );
        }
    }
    let (id, request) = Request::from_json(body);
    let task = request.and_then(|request| match request {
        Request::RunMotions { motions } => {
            check_motions(&motions, robot, at_rad).map(|()| Task::Motions(motions))
        }
        Request::RunTrajectory { trajectory } => {
            trajectory.check(robot.limits(), at_rad)?;
            Ok(Task::Trajectory(Box::new(trajectory)))
        }
        _ => Err(Refusal::bad(format!(
            "the request is too long: only motions and trajectories take more than \
             {MAX_SHORT_REQUEST_BYTES} bytes"
        ))),
    });
    (id, task)
}

fn check_motions(motions: &[Motion], robot: &Robot, at_rad: &Joints) -> Result<(), Refusal> {
    if motions.len() > MAX_MOTIONS {
        return Err(Refusal::bad(format!(
            "the request has {} motions, {MAX_MOTIONS} are the most; divide it where the arm stops",
            motions.len()
        )));
    }
    let range = robot.limits().position_rad;
    let start_rad = std::array::from_fn(|j| at_rad[j].clamp(-range[j], range[j]));
    let program = Program { robot: None, start_rad, motions: motions.to_vec() };
    JointPath::new(&program, robot)
        .map(drop)
        .map_err(|fault| Refusal::new(Code::Limit, fault.to_string()))
}
