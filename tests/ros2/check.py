#!/usr/bin/env python3
"""Checks the ROS 2 bridge with rclpy and Fast DDS, which share no code with the project.

    check.py PROGRAM [--json]

Starts a simulated robot, its drive and `PROGRAM bridge --ros2`, built with the feature `ros2`, in a
separate DDS domain, and checks each topic, FollowJointTrajectory goals, and the time
parameterisation service. With --json, the last line has the latencies. Exit code 1 when a check
fails. Needs the packages in requirements.txt, and a previous run of message_types.py.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "browser"))
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["RMW_IMPLEMENTATION"] = "rmw_fastrtps_cpp"

import rclpy
from action_msgs.msg import GoalStatus
from action_msgs.srv import CancelGoal
from control_msgs.action import FollowJointTrajectory
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters

from rig import Rig, cpu_s
from robot import Robot, stamp_s

ZERO = [0.0] * 7
NEAR = [0.5, 0.3, 0.0, -1.0, 0.0, 0.7, 0.0]
FAR = [1.0, 0.3, 0.2, -1.0, 0.0, 0.7, 0.5]
RESULT = FollowJointTrajectory.Result

failures: list[str] = []


def check(what: str, holds: bool, found: object = None) -> None:
    if not holds:
        failures.append(what)
        print(f"FAILED: {what}" + ("" if found is None else f" (found {found!r})"))


def free_domain() -> int:
    """A DDS domain whose first ports are unused."""
    for domain in range(20, 100):
        with socket.socket(type=socket.SOCK_DGRAM) as udp:
            try:
                udp.bind(("0.0.0.0", 7410 + 250 * domain))
            except OSError:
                continue
            return domain
    sys.exit("FAILED: all DDS domains are in use")


def far(a: list[float], b: list[float]) -> float:
    return max(abs(x - y) for x, y in zip(a, b, strict=True))


def check_topics(robot: Robot) -> None:
    robot.wait("joint states", lambda: len(robot.states) > 100)
    robot.wait("transforms", lambda: len(robot.transforms) > 20)
    robot.wait("description", lambda: len(robot.descriptions) > 0)
    state = robot.states[-1]
    check("names of joints", list(state.name) == robot.joints, state.name)
    check("positions", far(robot.position, ZERO) < 1e-3, robot.position)
    check("velocities at rest", far(list(state.velocity), ZERO) < 1e-3, state.velocity)
    check("torques", len(state.effort) == 7, state.effort)
    stamps = [stamp_s(state.header.stamp) for state in robot.states]
    check("stamps rise", all(a < b for a, b in pairwise(stamps)))
    tree = ElementTree.fromstring(robot.descriptions[0])
    joints = [joint.get("name") for joint in tree.iter("joint") if joint.get("type") == "revolute"]
    check("joints of the description", joints == robot.joints, joints)
    frames = {
        (each.header.frame_id, each.child_frame_id)
        for message in robot.transforms
        for each in message.transforms
    }
    links = {
        (joint.find("parent").get("link"), joint.find("child").get("link"))
        for joint in tree.iter("joint")
    }
    check("frames are those of the description", frames <= links and len(frames) == 8, frames)


def check_goals(robot: Robot) -> None:
    check("the action is there", robot.action.wait_for_server(10))
    done = robot.follow(robot.trajectory([(0, ZERO), (1, NEAR), (2, FAR)]))
    check("a goal is reached", done.status == GoalStatus.STATUS_SUCCEEDED, done)
    check("its result", done.result.error_code == RESULT.SUCCESSFUL, done.result)
    check(
        "why it got new times",
        "jerk" in done.result.error_string or "acceleration" in done.result.error_string,
        done.result,
    )
    robot.spin(0.1)
    check("the arm is there", far(robot.position, FAR) < 1e-3, robot.position)
    check("feedback", len(robot.feedback) > 10, len(robot.feedback))
    off = [far(list(each.error.positions), ZERO) for each in robot.feedback]
    check("feedback is near", max(off, default=1) < 0.1, max(off, default=None))
    # A first point after the start time is reached from the current position.
    done = robot.follow(robot.trajectory([(2.5, ZERO)]))
    check("a single point is reached", done.status == GoalStatus.STATUS_SUCCEEDED, done)


def check_cancel(robot: Robot) -> None:
    handle = robot.send(robot.trajectory([(0, ZERO), (6, NEAR)]))
    robot.spin(2)
    asked = robot.result(handle.cancel_goal_async())
    check("cancelling is accepted", asked.return_code == CancelGoal.Response.ERROR_NONE, asked)
    done = robot.result(handle.get_result_async())
    check("the goal is cancelled", done.status == GoalStatus.STATUS_CANCELED, done)
    robot.spin(0.2)
    at = robot.position
    share = at[3] / NEAR[3]
    check("the arm stands on the way", 0.05 < share < 0.9, share)
    check("it stands on the path", far(at, [share * q for q in NEAR]) < 1e-3, at)
    robot.spin(0.3)
    check("it stands still", far(robot.position, at) < 1e-4, robot.position)
    again = robot.result(handle.cancel_goal_async())
    check(
        "it is cancelled once",
        again.return_code == CancelGoal.Response.ERROR_GOAL_TERMINATED,
        again,
    )
    # Immediately after the goal, perhaps before it runs.
    handle = robot.send(robot.trajectory([(2, ZERO)]))
    robot.result(handle.cancel_goal_async())
    done = robot.result(handle.get_result_async())
    check("an early cancel", done.status == GoalStatus.STATUS_CANCELED, done)
    done = robot.follow(robot.trajectory([(2, ZERO)]))
    check("the next goal runs", done.status == GoalStatus.STATUS_SUCCEEDED, done)


def check_bad_goals(robot: Robot) -> None:
    nan = [math.nan] * 7
    trajectory = robot.trajectory
    rejected = {
        "another joint": trajectory([(0, ZERO), (1, NEAR)], [*robot.joints[:6], "elbow"]),
        "a missing joint": trajectory([(0, ZERO[:6]), (1, NEAR[:6])], robot.joints[:6]),
        "not a number": trajectory([(0, ZERO), (1, nan)]),
        "no points": trajectory([]),
        "times that fall": trajectory([(1, ZERO), (0.5, NEAR)]),
        "a point without positions": trajectory([(0, ZERO), (1, [])]),
    }
    for what, bad in rejected.items():
        check(f"rejected: {what}", not robot.send(bad).accepted)
    refused = {
        "a start elsewhere": (trajectory([(0, NEAR), (2, FAR)]), "the robot is at"),
        "out of range": (trajectory([(0, ZERO), (2, [0, 0, 0, 0, 0, 0, 3.2])]), "range"),
    }
    for what, (bad, why) in refused.items():
        done = robot.follow(bad)
        check(f"aborted: {what}", done.status == GoalStatus.STATUS_ABORTED, done)
        check(f"code: {what}", done.result.error_code == RESULT.INVALID_GOAL, done.result)
        check(f"reason: {what}", why in done.result.error_string, done.result)
    set_retime(robot, "never")
    done = robot.follow(trajectory([(0, ZERO), (0.2, NEAR)]))
    check("aborted: too fast", done.status == GoalStatus.STATUS_ABORTED, done)
    check("reason: too fast", "limit" in done.result.error_string, done.result)
    set_retime(robot, "needed")
    first = robot.send(trajectory([(0, ZERO), (3, NEAR)]))
    second = robot.send(trajectory([(0, ZERO), (3, FAR)]))
    check("one goal at a time", first.accepted and not second.accepted)
    done = robot.result(first.get_result_async())
    check("the first goal goes on", done.status == GoalStatus.STATUS_SUCCEEDED, done)
    robot.follow(trajectory([(2, ZERO)]))
    check("nothing else moved the arm", far(robot.position, ZERO) < 1e-3, robot.position)


def set_retime(robot: Robot, when: str) -> None:
    client = robot.node.create_client(SetParameters, "iiwasim_bridge/set_parameters")
    check("parameters are there", client.wait_for_service(10))
    value = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=when)
    request = SetParameters.Request(parameters=[Parameter(name="retime", value=value)])
    done = robot.result(client.call_async(request))
    check("a parameter is set", done.results[0].successful, done)


def check_times(robot: Robot) -> None:
    check("the service is there", robot.times.wait_for_service(10))
    path = robot.trajectory([(0, ZERO), (0, NEAR), (0, FAR)])
    path.header.frame_id = "from the service"
    done = robot.time(path)
    check("a path is timed", done.success and 0 < done.deviation <= 0.01, done)
    robot.wait("timed path", lambda: len(robot.timed) > 0)
    timed = robot.timed[-1]
    check("whose it is", timed.header.frame_id == path.header.frame_id, timed.header)
    last = timed.points[-1]
    check("its end", far(list(last.positions), FAR) < 1e-9, last)
    check("at rest", far(list(last.velocities), ZERO) < 1e-6, last)
    check("its duration", abs(stamp_s(last.time_from_start) - done.duration) < 1e-6, done)
    slow = robot.time(path, velocity_scaling=0.1, tolerance=0.05)
    check("shares make it slower", slow.success and slow.duration > 2 * done.duration, slow)
    there = robot.time(robot.trajectory([(0, ZERO), (0, NEAR), (0, ZERO)]))
    check("it stops where it turns back", there.success and there.stops == 1, there)
    bad = robot.time(robot.trajectory([(0, ZERO), (0, [9.0] * 7)]))
    check("out of range", not bad.success and "point 2" in bad.message, bad)
    # The timed path is a goal that does not need new times; a long path is a message of many
    # fragments.
    done = robot.follow(timed)
    check("a timed path is run", done.status == GoalStatus.STATUS_SUCCEEDED, done)
    check("with its own times", not done.result.error_string, done.result)
    robot.timed.clear()
    back = robot.trajectory([(0, FAR), (0, ZERO)])
    back.header.frame_id = "from the topic"
    robot.path.publish(back)
    robot.wait("path that was timed by topic", lambda: len(robot.timed) > 0)
    check("timed by topic", robot.timed[-1].header.frame_id == back.header.frame_id)
    done = robot.follow(robot.timed[-1])
    check("a path of the topic is run", done.status == GoalStatus.STATUS_SUCCEEDED, done)


def latencies_ms(robot: Robot) -> dict[str, float]:
    """Latencies from reception by the bridge to the callback over 5 s: without a bound, as they
    also depend on the machine.
    """
    robot.late_s.clear()
    robot.spin(5)
    late = sorted(robot.late_s)
    check("samples come", len(late) > 1, len(late))
    median = 1e3 * statistics.median(late)
    return {"median": round(median, 3), "p99": round(1e3 * late[int(0.99 * len(late))], 3)}


def bridge(rig: Rig, domain: int, *options: str) -> subprocess.Popen:
    return rig.start(
        "bridge", "--ros2", "--ros2-domain", str(domain), *options, *rig.drive_at, *rig.stream_at
    )


def check_end(rig: Rig, robot: Robot, process: subprocess.Popen) -> None:
    """A bridge that ends stops its goal, which nobody could cancel any more."""
    check("a last goal", robot.send(robot.trajectory([(6, NEAR)])).accepted)
    robot.spin(2)
    process.send_signal(signal.SIGINT)
    check("the bridge ends", process.wait(10) == 0, process.returncode)
    status = [rig.program, "status", "--json", *rig.drive_at]
    done = subprocess.run(status, check=True, capture_output=True, text=True)
    status = json.loads(done.stdout)
    share = status["joints_rad"][3] / NEAR[3]
    check("the arm rests on the way", status["state"] == "idle" and 0.01 < share < 0.9, status)


def check_other_robot(rig: Rig, domain: int) -> None:
    """A bridge for another robot than the robot of the drive does not move it."""
    process = bridge(rig, domain, "--allow-commands", "--robot", "lbr_iiwa_14_r820")
    node = rclpy.create_node("other")
    robot = Robot(node)
    robot.wait("joint states", lambda: len(robot.states) > 10)
    check("the action of another robot is there", robot.action.wait_for_server(10))
    at = list(robot.position)
    done = robot.follow(robot.trajectory([(0, at), (3, ZERO)]))
    check("aborted: another robot", done.status == GoalStatus.STATUS_ABORTED, done)
    for named in (
        "lbr_iiwa_14_r820 with a flange of 152 mm",
        "lbr_iiwa_7_r800 with a flange of 152 mm",
    ):
        check("both robots are named", named in done.result.error_string, done.result)
    robot.spin(0.2)
    check("another robot's goal moved nothing", far(robot.position, at) < 1e-4, robot.position)
    node.destroy_node()
    process.send_signal(signal.SIGINT)
    check("the bridge of another robot ends", process.wait(10) == 0, process.returncode)


def check_several(rig: Rig, domain: int) -> None:
    """Two robots, here the same drive twice."""
    (drive,), (stream,) = rig.drive_at[1:], rig.stream_at[1:]
    two = ["--name", "left-1", "--add", f"right={drive},{stream}"]
    process = bridge(rig, domain, *two)
    node = rclpy.create_node("several")
    robots = [Robot(node, name, f"/{name}") for name in ("left_1", "right")]
    for robot in robots:
        robot.wait("joint states", lambda robot=robot: len(robot.states) > 10)
        robot.wait("description", lambda robot=robot: len(robot.descriptions) > 0)
        check(
            "names in a namespace",
            list(robot.states[-1].name) == robot.joints,
            robot.states[-1].name,
        )
        check("no action without --allow-commands", not robot.action.wait_for_server(0.5))
    frames = {
        each.child_frame_id for message in robots[0].transforms for each in message.transforms
    }
    check("frames of both", {"left_1_link_7", "right_link_7"} <= frames, frames)
    node.destroy_node()
    process.send_signal(signal.SIGINT)
    check("the bridge ends", process.wait(10) == 0, process.returncode)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    domain = free_domain()
    with tempfile.TemporaryDirectory() as folder, Rig(options.program, Path(folder)) as rig:
        process = bridge(rig, domain, "--allow-commands")
        rclpy.init(domain_id=domain)
        robot = Robot(rclpy.create_node("check"))
        check_topics(robot)
        used_s = cpu_s(process.pid)
        figures = latencies_ms(robot)
        figures["cpu_percent"] = round((cpu_s(process.pid) - used_s) / 5 * 100, 1)
        check_goals(robot)
        check_cancel(robot)
        check_bad_goals(robot)
        check_times(robot)
        check_end(rig, robot, process)
        check_other_robot(rig, domain)
        check_several(rig, domain)
    if options.json:
        print(json.dumps(figures))
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
