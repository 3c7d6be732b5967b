"""A ROS 2 node that communicates with the bridge."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import rclpy
from control_msgs.action import FollowJointTrajectory
from iiwasim_msgs.srv import TimeJointPath
from rclpy.action import ActionClient
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

ACTION = "joint_trajectory_controller/follow_joint_trajectory"
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def stamp_s(stamp: Any) -> float:
    return stamp.sec + 1e-9 * stamp.nanosec


class Robot:
    """Received messages of one robot, and its action and service."""

    def __init__(self, node: Any, prefix: str = "iiwa", namespace: str = "") -> None:
        self.node = node
        self.joints = [f"{prefix}_joint_{i}" for i in range(1, 8)]
        self.states: list[JointState] = []
        self.late_s: list[float] = []
        self.transforms: list[TFMessage] = []
        self.descriptions: list[str] = []
        self.timed: list[JointTrajectory] = []
        self.feedback: list[Any] = []
        at = f"{namespace}/{{}}".format if namespace else "{}".format
        node.create_subscription(JointState, at("joint_states"), self.take_state, 10)
        node.create_subscription(TFMessage, "/tf", self.transforms.append, 100)
        heard = lambda text: self.descriptions.append(text.data)
        node.create_subscription(String, at("robot_description"), heard, LATCHED)
        node.create_subscription(
            JointTrajectory, at("timed_joint_path"), self.timed.append, LATCHED
        )
        self.path = node.create_publisher(JointTrajectory, at("joint_path"), 10)
        self.action = ActionClient(node, FollowJointTrajectory, at(ACTION))
        self.times = node.create_client(TimeJointPath, at("time_joint_path"))

    def take_state(self, state: JointState) -> None:
        self.late_s.append(time.time() - stamp_s(state.header.stamp))
        self.states.append(state)

    @property
    def position(self) -> list[float]:
        return list(self.states[-1].position)

    def wait(self, what: str, holds: Callable[[], bool], seconds: float = 20) -> None:
        until = time.monotonic() + seconds
        while not holds():
            if time.monotonic() > until:
                raise AssertionError(f"no {what} within {seconds} s")
            rclpy.spin_once(self.node, timeout_sec=0.05)

    def spin(self, seconds: float) -> None:
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            rclpy.spin_once(self.node, timeout_sec=0.02)

    def result(self, future: Any, seconds: float = 30) -> Any:
        self.wait("answer", future.done, seconds)
        return future.result()

    def trajectory(
        self, points: Sequence[tuple[float, Sequence[float]]], joints: Sequence[str] | None = None
    ) -> JointTrajectory:
        trajectory = JointTrajectory(joint_names=list(joints or self.joints))
        for t_s, positions in points:
            point = JointTrajectoryPoint(positions=[float(q) for q in positions])
            point.time_from_start = Duration(seconds=t_s).to_msg()
            trajectory.points.append(point)
        return trajectory

    def send(self, trajectory: JointTrajectory) -> Any:
        """Sends a goal and returns its handle."""
        self.feedback.clear()
        goal = FollowJointTrajectory.Goal(trajectory=trajectory)
        heard = lambda message: self.feedback.append(message.feedback)
        return self.result(self.action.send_goal_async(goal, feedback_callback=heard))

    def follow(self, trajectory: JointTrajectory) -> Any:
        """Sends a goal, which has to be accepted, and returns its status and result."""
        handle = self.send(trajectory)
        if not handle.accepted:
            raise AssertionError("a goal was rejected")
        return self.result(handle.get_result_async(), 60)

    def time(self, path: JointTrajectory, **options: float) -> Any:
        return self.result(self.times.call_async(TimeJointPath.Request(path=path, **options)))
