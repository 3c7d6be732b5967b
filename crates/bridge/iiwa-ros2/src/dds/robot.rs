//! The node of a robot, and its threads.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{SyncSender, sync_channel},
    },
    thread,
    time::{Duration, SystemTime},
};

use iiwa_link::{message::DriveState, threads::ThreadGroup};
use iiwa_log::Arm;
use ros2_client::{Context, Node, NodeOptions, ParameterValue};
use tokio::sync::mpsc::unbounded_channel;

use super::{
    action::FollowAction,
    error::Ros2Error,
    execution::Execution,
    latest::Latest,
    messages::Time,
    names::NodeNames,
    options::{Ros2Options, Ros2Robot},
    publisher::{MeasuredSample, RobotPublisher},
    retiming::{RetimeGoals, Retiming},
    timing_service::TimingService,
};
use crate::retime::{DEFAULT_TOLERANCE_RAD, MIN_TOLERANCE_RAD};
use iiwa_bridge::message::{CycleSample, Timestamp};

/// Maximum number of samples that wait to be published; newer ones are dropped.
const SAMPLES: usize = 64;

/// Poll interval for requests. `ros2-client` cannot wait for several requests of an action server
/// at once.
const TURN: Duration = Duration::from_millis(4);

/// Node parameters: condition for retiming, and tolerance of the path.
const RETIME: &str = "retime";
const TOLERANCE: &str = "path_tolerance";

/// Node of a robot.
pub(super) struct RobotNode {
    samples: SyncSender<MeasuredSample>,
    latest: Arc<Latest>,
    _threads: ThreadGroup,
}

/// Servers of a node. The node is dropped last.
struct Servers {
    action: Option<FollowAction>,
    timing: TimingService,
    node: Node,
    retime: RetimeGoals,
}

impl RobotNode {
    pub(super) fn start(
        context: &Context,
        robot: &Ros2Robot,
        options: &Ros2Options,
    ) -> Result<Self, Ros2Error> {
        let names = NodeNames::new(&robot.namespace)?;
        let joints = robot.names.joints();
        let parameters = NodeOptions::new()
            .declare_parameter(RETIME, ParameterValue::String(options.retime.name().to_owned()))
            .declare_parameter(TOLERANCE, ParameterValue::Double(DEFAULT_TOLERANCE_RAD))
            .parameter_validator(Box::new(check_parameter));
        let mut node = context.new_node(names.node()?, parameters)?;
        let arm = Arc::new(Arm::with_names(&robot.robot, &robot.names));
        let tf_every_s = 1.0 / options.tf_rate_hz;
        let publisher = RobotPublisher::new(&mut node, &names, arm, joints.clone(), tf_every_s)?;
        let latest = Arc::new(Latest::default());
        let action = if options.allow_commands {
            let (progress, progress_in) = unbounded_channel();
            let [run, stop] = [robot.bridged.client()?, robot.bridged.client()?];
            let execution =
                Execution::start(robot.robot.clone(), joints.clone(), run, stop, progress)?;
            let execution = (execution, progress_in);
            let latest = Arc::clone(&latest);
            Some(FollowAction::new(&mut node, &names, joints.clone(), latest, execution)?)
        } else {
            None
        };
        let timing = TimingService::new(&mut node, &names, robot.robot.clone(), joints)?;
        let spinner = node.spinner()?;
        let runtime = tokio::runtime::Builder::new_current_thread()
            .build()
            .map_err(|source| Ros2Error::Runtime { source })?;
        let mut threads = ThreadGroup::default();
        let (samples, samples_in) = sync_channel(SAMPLES);
        threads.spawn("ros2 publish", move |shutdown| publisher.run(&samples_in, shutdown))?;
        // This thread ends with the node.
        threads.spawn("ros2 graph", move |_| {
            if let Err(error) = runtime.block_on(spinner.spin()) {
                tracing::warn!("the node's discovery ended: {error}");
            }
        })?;
        let mut servers = Servers { action, timing, node, retime: options.retime };
        threads.spawn("ros2 serve", move |shutdown| servers.run(shutdown))?;
        Ok(Self { samples, latest, _threads: threads })
    }

    /// Publishes a sample that was received at time `time`.
    pub(super) fn sample(&self, time: Timestamp, sample: &CycleSample) {
        let stamp = Time::from(SystemTime::from(time));
        let torques_nm = sample.measured_nm;
        let sample = self.latest.sample(sample.t_s, sample.joints_rad);
        // Samples that do not fit into the queue would be late: they are dropped.
        let _ = self.samples.try_send(MeasuredSample { stamp, sample, torques_nm });
    }

    pub(super) fn state(&self, t_s: f64, state: DriveState) {
        self.latest.state(t_s, state);
    }
}

impl Servers {
    fn run(&mut self, shutdown: &AtomicBool) {
        while !shutdown.load(Ordering::Relaxed) {
            let retiming = self.retiming();
            if let Some(action) = &mut self.action {
                action.turn(retiming);
            }
            self.timing.turn();
            thread::sleep(TURN);
        }
        self.node.stop_spinner();
    }

    /// Returns the retiming settings of the node parameters.
    fn retiming(&self) -> Retiming {
        let when = match self.node.get_parameter(RETIME) {
            Some(ParameterValue::String(when)) => when.parse().unwrap_or(self.retime),
            _ => self.retime,
        };
        let tolerance_rad = match self.node.get_parameter(TOLERANCE) {
            Some(ParameterValue::Double(tolerance_rad)) => tolerance_rad,
            _ => DEFAULT_TOLERANCE_RAD,
        };
        Retiming { when, tolerance_rad }
    }
}

fn check_parameter(name: &str, value: &ParameterValue) -> Result<(), String> {
    match (name, value) {
        (RETIME, ParameterValue::String(when)) if when.parse::<RetimeGoals>().is_err() => {
            Err("`retime` is `needed`, `always` or `never`".to_owned())
        }
        (TOLERANCE, ParameterValue::Double(rad)) if !(MIN_TOLERANCE_RAD..=1.0).contains(rad) => {
            Err(format!("`path_tolerance` is from {MIN_TOLERANCE_RAD} to 1 rad"))
        }
        _ => Ok(()),
    }
}
