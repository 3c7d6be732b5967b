#!/usr/bin/env python3
"""A viewer of a moving or resting robot that shares no code with the project.

    check.py ws://127.0.0.1:PORT [--messages N] [--seconds N] [--json]

Connects like Foxglove, reads N joint states and the related messages, decodes them with the schemas
of the server, and checks the specification of the topics: link frames match the URDF at the joint
positions, and the flange is at the end of the chain. A second viewer that connects later also has
to get the URDF. With --json, the last line has the read data. Exit code 1 when a check fails. Needs
the packages in requirements.txt, one folder up.
"""

from __future__ import annotations

import argparse
import json
import math
import struct
import sys
import time
from collections.abc import Iterable
from typing import Any
from xml.etree import ElementTree

import websocket
from mcap.records import Schema
from mcap_ros2.decoder import DecoderFactory

PROTOCOL = "foxglove.sdk.v1"
ROS_TYPES = {
    "/joint_states": "sensor_msgs/msg/JointState",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/tcp_pose": "geometry_msgs/msg/PoseStamped",
    "/robot_description": "std_msgs/msg/String",
}
JSON_TOPICS = ("/drive_state", "/sensors", "/inputs_outputs")
JOINTS = [f"iiwa_joint_{i}" for i in range(1, 8)]
MESSAGE_DATA = 1
# Maximum messages per second on a topic, with a margin at the ends of the interval.
RATE_HZ = 110

failures: list[str] = []


def check(what: str, holds: bool, found: object = None) -> None:
    if not holds:
        failures.append(what)
        print(f"FAILED: {what}" + ("" if found is None else f" (found {found!r})"))


class Viewer:
    """A connection to the server."""

    def __init__(self, url: str, seconds: float) -> None:
        self.end = time.monotonic() + seconds
        self.socket = websocket.create_connection(url, subprotocols=[PROTOCOL], timeout=seconds)
        self.subscribed: list[str] = []
        self.channels: dict[str, dict] = {}
        self.info = self.text("serverInfo")
        while not self.channels.keys() >= {*ROS_TYPES, *JSON_TOPICS}:
            for channel in self.text("advertise")["channels"]:
                self.channels[channel["topic"]] = channel

    def receive(self) -> str | bytes:
        left = self.end - time.monotonic()
        if left <= 0:
            sys.exit("FAILED: what was waited for did not come")
        self.socket.settimeout(left)
        return self.socket.recv()

    def text(self, kind: str) -> dict:
        """The next text message, which has to be of this kind."""
        message = json.loads(self.receive())
        if message["op"] != kind:
            sys.exit(f"FAILED: {message['op']} instead of {kind}")
        return message

    def subscribe(self, topics: Iterable[str]) -> None:
        subscriptions = []
        for topic in topics:
            subscriptions.append(
                {"id": len(self.subscribed), "channelId": self.channels[topic]["id"]}
            )
            self.subscribed.append(topic)
        self.socket.send(json.dumps({"op": "subscribe", "subscriptions": subscriptions}))

    def message(self) -> tuple[str, int, bytes]:
        """The next message: its topic, its time in ns, and its payload."""
        data = self.receive()
        if isinstance(data, str):
            sys.exit(f"FAILED: {data} instead of a message")
        kind, subscription, time_ns = struct.unpack_from("<BIQ", data)
        if kind != MESSAGE_DATA:
            sys.exit(f"FAILED: a binary message of kind {kind}")
        return self.subscribed[subscription], time_ns, data[13:]


def check_server(viewer: Viewer) -> dict:
    """Checks the server information and the topics; returns the decoders by topic."""
    check("subprotocol", viewer.socket.getsubprotocol() == PROTOCOL, viewer.socket.getsubprotocol())
    check("name", viewer.info["name"] == "iiwasim", viewer.info["name"])
    check("viewers only read", viewer.info["capabilities"] == [], viewer.info["capabilities"])
    decoders = {}
    for topic, name in ROS_TYPES.items():
        channel = viewer.channels[topic]
        found = tuple(channel.get(key) for key in ("encoding", "schemaEncoding", "schemaName"))
        check(f"{topic}: type and encodings", found == ("cdr", "ros2msg", name), found)
        schema = Schema(id=1, name=name, encoding="ros2msg", data=channel["schema"].encode())
        decoders[topic] = DecoderFactory().decoder_for("cdr", schema)
    for topic in JSON_TOPICS:
        channel = viewer.channels[topic]
        found = (channel["encoding"], channel.get("schemaEncoding"))
        check(f"{topic}: encodings", found == ("json", "jsonschema"), found)
        check(f"{topic}: schema", json.loads(channel["schema"])["type"] == "object")
        decoders[topic] = json.loads
    return decoders


Matrix = list[list[float]]


def product(a: Matrix, b: Matrix) -> Matrix:
    return [[sum(x * y for x, y in zip(row, column)) for column in zip(*b)] for row in a]


def rotation(axis: tuple[float, float, float], angle: float) -> Matrix:
    """A 4 by 4 rotation matrix, by Rodrigues' formula."""
    x, y, z = axis
    c, s, v = math.cos(angle), math.sin(angle), 1 - math.cos(angle)
    return [
        [c + x * x * v, x * y * v - z * s, x * z * v + y * s, 0],
        [y * x * v + z * s, c + y * y * v, y * z * v - x * s, 0],
        [z * x * v - y * s, z * y * v + x * s, c + z * z * v, 0],
        [0, 0, 0, 1],
    ]


def placed(matrix: Matrix, x: float, y: float, z: float) -> Matrix:
    """A matrix after a translation."""
    return [[*row[:3], shift] for row, shift in zip(matrix, (x, y, z))] + [[0, 0, 0, 1]]


def pose(translation: Any, q: Any) -> Matrix:
    """The pose of a message as a matrix."""
    sine = math.hypot(q.x, q.y, q.z)
    axis = (q.x / sine, q.y / sine, q.z / sine) if sine > 0 else (0.0, 0.0, 1.0)
    return placed(
        rotation(axis, 2 * math.atan2(sine, q.w)), translation.x, translation.y, translation.z
    )


def difference(a: Matrix, b: Matrix) -> float:
    return max(abs(x - y) for row, other in zip(a, b) for x, y in zip(row, other))


def numbers(text: str | None) -> list[float]:
    return [float(number) for number in (text or "0 0 0").split()]


def urdf_frames(urdf: str, positions: dict[str, float]) -> dict[tuple[str, str], Matrix]:
    """The frames of links in their parents, by the URDF."""
    frames = {}
    for joint in ElementTree.fromstring(urdf).iter("joint"):
        origin = joint.find("origin")
        attributes = {} if origin is None else origin.attrib
        roll, pitch, yaw = numbers(attributes.get("rpy"))
        frame = rotation((0, 0, 1), yaw)
        frame = product(frame, rotation((0, 1, 0), pitch))
        frame = product(frame, rotation((1, 0, 0), roll))
        frame = placed(frame, *numbers(attributes.get("xyz")))
        if joint.get("type") != "fixed":
            axis = joint.find("axis")
            about = (1.0, 0.0, 0.0) if axis is None else tuple(numbers(axis.get("xyz")))
            frame = product(frame, rotation(about, positions[joint.get("name")]))
        frames[joint.find("parent").get("link"), joint.find("child").get("link")] = frame
    return frames


def check_arm(urdf: str, states: dict, transforms: dict, flanges: dict) -> None:
    """Compares the messages of each time with the URDF."""
    worst_link = worst_flange = 0.0
    together = states.keys() & transforms.keys() & flanges.keys()
    for time_ns in together:
        state = states[time_ns]
        frames = urdf_frames(urdf, dict(zip(state.name, state.position)))
        chain = rotation((0, 0, 1), 0)
        for entry in transforms[time_ns].transforms:
            frame = pose(entry.transform.translation, entry.transform.rotation)
            link = (entry.header.frame_id, entry.child_frame_id)
            if link not in frames:
                check("/tf has the links of the URDF", False, link)
                return
            worst_link = max(worst_link, difference(frame, frames[link]))
            chain = product(chain, frame)
        flange = flanges[time_ns]
        check("/tcp_pose is in the base", flange.header.frame_id == "iiwa_link_0")
        place = pose(flange.pose.position, flange.pose.orientation)
        worst_flange = max(worst_flange, difference(place, chain))
    check("joint states with links and a flange", bool(together))
    check("/tf is where the URDF has the links", worst_link < 1e-9, worst_link)
    check("/tcp_pose is at the end of /tf", worst_flange < 1e-9, worst_flange)


def check_states(states: dict) -> None:
    for time_ns, state in states.items():
        stamp = state.header.stamp.sec * 1_000_000_000 + state.header.stamp.nanosec
        check("time of a message = its stamp", stamp == time_ns, (stamp, time_ns))
        check("joint names", list(state.name) == JOINTS, state.name)
        values = [*state.position, *state.velocity]
        check("positions and velocities", len(values) == 14 and all(map(math.isfinite, values)))
    times = list(states)
    check("times increase", times == sorted(times))
    check("times are of now", abs(times[-1] / 1e9 - time.time()) < 60, times[-1])
    span_s = (times[-1] - times[0]) / 1e9
    check(f"at most {RATE_HZ} a second", len(times) <= 2 + RATE_HZ * span_s, (len(times), span_s))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("url")
    parser.add_argument("--messages", type=int, default=30, help="joint states to read")
    parser.add_argument("--seconds", type=float, default=20.0, help="for all of it, at most")
    parser.add_argument("--json", action="store_true", help="print what was read")
    arguments = parser.parse_args()

    viewer = Viewer(arguments.url, arguments.seconds)
    decoders = check_server(viewer)
    viewer.subscribe(["/joint_states", "/tf", "/tcp_pose", "/robot_description", *JSON_TOPICS])
    messages: dict[str, dict[int, Any]] = {topic: {} for topic in viewer.subscribed}
    while len(messages["/joint_states"]) < arguments.messages or not messages["/robot_description"]:
        topic, time_ns, data = viewer.message()
        messages[topic][time_ns] = decoders[topic](data)

    later = Viewer(arguments.url, arguments.seconds)
    later.subscribe(["/robot_description"])
    topic, _, data = later.message()
    [description] = messages["/robot_description"].values()
    again = decoders[topic](data)
    check("a later viewer gets the same URDF", again.data == description.data)

    states = messages["/joint_states"]
    check_states(states)
    check_arm(description.data, states, messages["/tf"], messages["/tcp_pose"])

    counts = {topic: len(found) for topic, found in messages.items()}
    print(", ".join(f"{count} on {topic}" for topic, count in counts.items()))
    print("everything holds" if not failures else f"{len(failures)} failed")
    if arguments.json:
        read: dict[str, Any] = {
            "joint_states": [
                {"t_ns": t, "position": list(state.position), "velocity": list(state.velocity)}
                for t, state in states.items()
            ]
        }
        for topic in JSON_TOPICS:
            read[topic[1:]] = list(messages[topic].values())[-1] if messages[topic] else None
        print(json.dumps(read))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
