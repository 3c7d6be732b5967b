//! Publications of a robot: `joint_states`, `/tf` and `robot_description`.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, RecvTimeoutError},
    },
    time::Duration,
};

use iiwa_kin::Joints;
use iiwa_log::Arm;
use ros2_client::{Node, Publisher};

use super::{
    error::Ros2Error,
    latest::StreamSample,
    messages::{Header, JointState, Text, TfMessage, Time, Transform, TransformStamped},
    names::NodeNames,
    qos,
};

/// Time-out of waiting for a sample, after which the shutdown flag is checked.
const POLL: Duration = Duration::from_millis(100);

/// A sample to be published.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeasuredSample {
    pub(super) stamp: Time,
    pub(super) sample: StreamSample,
    /// Measured torques, if the controller measures them.
    pub(super) torques_nm: Option<Joints>,
}

/// Publishers of a robot.
pub(super) struct RobotPublisher {
    states: Publisher<JointState>,
    tf: Publisher<TfMessage>,
    /// Kept alive, so that the description is available to late subscribers.
    _description: Publisher<Text>,
    arm: Arc<Arm>,
    joints: [String; 7],
    /// Interval of `/tf` messages, in s.
    tf_every_s: f64,
}

impl RobotPublisher {
    /// Creates the publishers, and publishes the description immediately.
    pub(super) fn new(
        node: &mut Node,
        names: &NodeNames,
        arm: Arc<Arm>,
        joints: [String; 7],
        tf_every_s: f64,
    ) -> Result<Self, Ros2Error> {
        let topic = node.create_topic(
            &names.topic("joint_states")?,
            NodeNames::joint_state_type(),
            &qos::states(),
        )?;
        let states = node.create_publisher(&topic, None)?;
        // Global, like the topic of tf2's own broadcaster.
        let topic = node.create_topic(
            &ros2_client::Name::new("/", "tf")?,
            NodeNames::tf_type(),
            &qos::transforms(),
        )?;
        let tf = node.create_publisher(&topic, None)?;
        let topic = node.create_topic(
            &names.topic("robot_description")?,
            NodeNames::text_type(),
            &qos::latched(),
        )?;
        let description = node.create_publisher(&topic, None)?;
        if description.publish(Text { data: arm.urdf().to_owned() }).is_err() {
            tracing::warn!(
                "the description of the robot in {} was not published",
                names.namespace()
            );
        }
        Ok(Self { states, tf, _description: description, arm, joints, tf_every_s })
    }

    /// Publishes samples until the shutdown.
    pub(super) fn run(&self, samples: &Receiver<MeasuredSample>, shutdown: &AtomicBool) {
        let mut tf_at_s: Option<f64> = None;
        while !shutdown.load(Ordering::Relaxed) {
            let measured = match samples.recv_timeout(POLL) {
                Ok(measured) => measured,
                Err(RecvTimeoutError::Timeout) => continue,
                Err(RecvTimeoutError::Disconnected) => return,
            };
            // Publish errors are ignored: the next sample follows soon.
            drop(self.states.publish(self.joint_state(&measured)));
            let t_s = measured.sample.t_s;
            // Half an FRI cycle early is on time; a restarted clock begins a new interval.
            let is_due =
                tf_at_s.is_none_or(|at_s| t_s < at_s || t_s - at_s > self.tf_every_s - 0.0005);
            if is_due {
                tf_at_s = Some(t_s);
                drop(self.tf.publish(self.transforms(&measured)));
            }
        }
    }

    fn joint_state(&self, measured: &MeasuredSample) -> JointState {
        let MeasuredSample { stamp, sample, torques_nm } = measured;
        JointState {
            header: Header { stamp: *stamp, frame_id: String::new() },
            name: self.joints.to_vec(),
            position: sample.q.to_vec(),
            velocity: sample.dq.to_vec(),
            effort: torques_nm.map_or_else(Vec::new, |torques_nm| torques_nm.to_vec()),
        }
    }

    fn transforms(&self, measured: &MeasuredSample) -> TfMessage {
        let stamped = |frame: iiwa_log::FramePose<'_>| TransformStamped {
            header: Header { stamp: measured.stamp, frame_id: frame.parent.to_owned() },
            child_frame_id: frame.child.to_owned(),
            transform: Transform {
                translation: frame.translation_m,
                rotation: frame.rotation_xyzw,
            },
        };
        TfMessage { transforms: self.arm.links(&measured.sample.q).map(stamped).into() }
    }
}
