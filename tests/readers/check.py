#!/usr/bin/env python3
"""Checks a recording with readers from other projects.

    check.py FILE.mcap [--figures FIGURES.json]
    check.py --recording FILE.mcap

Reads the whole file with `mcap`, `mcap-ros2-support`, `rosbags` and `rerun`, and checks the
specification of the file: of a plan, or with --recording of a recorded robot, finished or not.
FIGURES.json is the output of `iiwasim plan --json`. Exit code 1 when a check fails. Needs the
packages in requirements.txt, next to this file.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import mcap.reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

TYPES = {
    "/joint_states": "sensor_msgs/msg/JointState",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/robot_description": "std_msgs/msg/String",
    "/tcp_pose": "geometry_msgs/msg/PoseStamped",
    "/joint_trajectory": "trajectory_msgs/msg/JointTrajectory",
    "/motion": "iiwasim_msgs/msg/Motion",
    "/flange_pose": "geometry_msgs/msg/PoseStamped",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}
# Topics of plans only.
PLANNED = {"/joint_trajectory", "/motion"}
# Topics of plans with a tool only.
WITH_TOOL = {"/flange_pose"}
LATCHED = {"/robot_description", "/joint_trajectory"}
JOINTS = [f"iiwa_joint_{i}" for i in range(1, 8)]
NS = 1_000_000_000


class Tally:
    """Counts checks and keeps the failures."""

    def __init__(self) -> None:
        self.passed = 0
        self.failed = 0

    def check(self, what: str, holds: bool, found: object = None) -> bool:
        if holds:
            self.passed += 1
        else:
            self.failed += 1
            print(f"FAILED: {what}" + ("" if found is None else f" (found {found!r})"))
        return holds

    def equal(self, what: str, found: object, expected: object) -> bool:
        return self.check(f"{what}, expected {expected!r}", found == expected, found)


def nanoseconds(stamp: object) -> int:
    """Nanoseconds of a ROS 2 time or duration from any reader."""
    nanosec = stamp.nanosec if hasattr(stamp, "nanosec") else stamp.nanosecs
    return stamp.sec * NS + nanosec


def header_stamps(topic: str, message: object) -> set[int]:
    """The header stamps of a message; empty for a type without a header."""
    if topic == "/tf":
        return {nanoseconds(transform.header.stamp) for transform in message.transforms}
    if topic == "/robot_description":
        return set()
    return {nanoseconds(message.header.stamp)}


def read_mcap(tally: Tally, path: Path, expected: dict) -> dict:
    """Reads the container with all checksums: header, channels, metadata, attachments, messages."""
    with path.open("rb") as stream:
        reader = mcap.reader.make_reader(stream, validate_crcs=True)
        header = reader.get_header()
        tally.equal("profile", header.profile, "ros2")
        tally.check("library names the writer", bool(header.library))

        summary = reader.get_summary()
        channels = {channel.topic: channel for channel in summary.channels.values()}
        types = {
            topic: summary.schemas[channel.schema_id].name for topic, channel in channels.items()
        }
        tally.equal("topics and types", types, expected)
        tally.equal("one channel a topic", len(summary.channels), len(channels))
        for topic, channel in channels.items():
            schema = summary.schemas[channel.schema_id]
            tally.equal(f"{topic} message encoding", channel.message_encoding, "cdr")
            tally.equal(f"{topic} schema encoding", schema.encoding, "ros2msg")
            qos = channel.metadata.get("offered_qos_profiles")
            durability = f"durability: {1 if topic in LATCHED else 2}"
            tally.check(
                f"{topic} offers {durability}", durability in (qos or "").split("\n  "), qos
            )
        compressions = {index.compression for index in summary.chunk_indexes}
        tally.equal("chunk compression", compressions, {"lz4"})

        stamps = defaultdict(list)
        for _, channel, message in reader.iter_messages():
            stamps[channel.topic].append(message.log_time)
            if message.log_time != message.publish_time:
                tally.check(f"{channel.topic} publish time", False, message.publish_time)
        count = sum(map(len, stamps.values()))
        tally.equal("messages in the statistics", summary.statistics.message_count, count)

        metadata = {record.name: record.metadata for record in reader.iter_metadata()}
        attachments = list(reader.iter_attachments())
    for attachment in attachments:
        name = attachment.name
        tally.equal(f"attachment {name} log time", attachment.log_time, stamps["/joint_states"][0])
        tally.equal(f"attachment {name} create time", attachment.create_time, attachment.log_time)
    print(
        f"mcap: {count} messages, {len(attachments)} attachments, {len(metadata)} metadata records"
    )
    return {"stamps": stamps, "metadata": metadata, "attachments": attachments}


def decode_mcap_ros2(tally: Tally, path: Path) -> dict:
    """Decodes every message of every topic with the schema in the file."""
    messages = defaultdict(list)
    with path.open("rb") as stream:
        reader = mcap.reader.make_reader(
            stream, validate_crcs=True, decoder_factories=[DecoderFactory()]
        )
        for _, channel, message, decoded in reader.iter_decoded_messages():
            topic = channel.topic
            messages[topic].append((message.log_time, decoded))
            found = header_stamps(topic, decoded)
            if found - {message.log_time}:
                tally.check(f"{topic} log time = header stamp", False, (message.log_time, found))
    print(f"mcap-ros2-support: {sum(map(len, messages.values()))} messages")
    return messages


def decode_rosbags(tally: Tally, path: Path, expected: dict) -> dict:
    """Decodes every message with a reader that has its own types, schema parser and CDR decoder."""
    messages = defaultdict(list)
    with AnyReader([path]) as reader:
        types = {connection.topic: connection.msgtype for connection in reader.connections}
        tally.equal("types by rosbags", types, expected)
        for connection in reader.connections:
            durabilities = [qos.durability.name for qos in connection.ext.offered_qos_profiles]
            durability = "TRANSIENT_LOCAL" if connection.topic in LATCHED else "VOLATILE"
            tally.equal(f"{connection.topic} durability by rosbags", durabilities, [durability])
        for connection, log_time, raw in reader.messages():
            decoded = reader.deserialize(raw, connection.msgtype)
            messages[connection.topic].append((log_time, decoded))
    print(f"rosbags: {sum(map(len, messages.values()))} messages")
    return messages


def check_rerun(tally: Tally, path: Path, expected: dict) -> None:
    """Checks structure and timelines in the Rerun viewer's reader."""
    program = Path(sys.executable).parent / "rerun"
    result = subprocess.run(
        [str(program) if program.exists() else "rerun", "mcap", "check", "--full", str(path)],
        capture_output=True,
        check=False,
        text=True,
        env={**os.environ, "NO_COLOR": "1"},
    )
    if not tally.equal("exit code of rerun mcap check", result.returncode, 0):
        print(result.stdout + result.stderr)
    rows = [line.split() for line in result.stdout.splitlines() if " /" in line]
    status = {row[3]: row[0] for row in rows if len(row) > 3}
    tally.check("rerun knows every topic", status.keys() >= expected.keys(), sorted(status))
    tally.equal("status by rerun", set(status.values()), {"ok"})
    print(f"rerun: {len(rows)} channels")


def check_order(tally: Tally, stamps: dict) -> None:
    for topic, times in sorted(stamps.items()):
        increasing = all(a < b for a, b in zip(times, times[1:]))
        tally.check(f"{topic} stamps increase", increasing)
    tally.check(
        "no message after the last joint state",
        max(max(times) for times in stamps.values()) == stamps["/joint_states"][-1],
    )
    tally.equal("robot descriptions", len(stamps["/robot_description"]), 1)


def check_time(tally: Tally, stamps: dict, cycle_time_s: float) -> None:
    """Checks the stamps of a plan."""
    joint_states = stamps["/joint_states"]
    epoch = min(min(times) for times in stamps.values())
    tally.equal("first joint state at the epoch", joint_states[0], epoch)
    last = (joint_states[-1] - epoch) - round(cycle_time_s * NS)
    tally.check("last joint state at the cycle time to 1 ns", abs(last) <= 1, last)
    tally.check("/tf has the stamps of /joint_states", stamps["/tf"] == joint_states)
    tally.check("/tcp_pose has the stamps of /joint_states", stamps["/tcp_pose"] == joint_states)
    tally.equal("joint trajectories", len(stamps["/joint_trajectory"]), 1)
    tally.check("a motion at the start", stamps["/motion"][:1] == [epoch])


def check_poses(tally: Tally, stamps: dict) -> None:
    """Checks the stamps of a recording, which has poses for some of its joint states."""
    tally.check("/tf has the stamps of /tcp_pose", stamps["/tf"] == stamps["/tcp_pose"])
    tally.check(
        "/tf has stamps of /joint_states", set(stamps["/tf"]) <= set(stamps["/joint_states"])
    )
    tally.check("/tf begins with /joint_states", stamps["/tf"][:1] == stamps["/joint_states"][:1])


def checks(tally: Tally, reader: str, messages: dict) -> tuple[Callable, Callable]:
    """Check functions for all messages of a topic, and for seven finite numbers."""

    def every(what: str, topic: str, holds: Callable[[object], bool]) -> None:
        bad = [t for t, message in messages[topic] if not holds(message)]
        tally.check(f"{reader}: {topic}: {what}", not bad, bad[:3])

    def finite(values: object, count: int) -> bool:
        return len(values) == count and all(math.isfinite(value) for value in values)

    return every, finite


def check_messages(tally: Tally, reader: str, messages: dict) -> None:
    """Checks the content of decoded messages of any reader."""
    every, finite = checks(tally, reader, messages)

    def unit(q: object) -> bool:
        return abs(math.hypot(q.x, q.y, q.z, q.w) - 1) < 1e-9

    every("names", "/joint_states", lambda m: list(m.name) == JOINTS)
    every("positions", "/joint_states", lambda m: finite(m.position, 7))
    every("velocities", "/joint_states", lambda m: finite(m.velocity, 7))
    # Torques are always in a plan, and in a recording if they were measured.
    is_plan = "/joint_trajectory" in messages
    every(
        "effort",
        "/joint_states",
        lambda m: finite(m.effort, 7) or (not is_plan and len(m.effort) == 0),
    )

    every(
        "unit quaternions", "/tf", lambda m: all(unit(t.transform.rotation) for t in m.transforms)
    )
    trees = {
        tuple((t.header.frame_id, t.child_frame_id) for t in message.transforms)
        for _, message in messages["/tf"]
    }
    if tally.equal(f"{reader}: /tf trees", len(trees), 1):
        tree = trees.pop()
        children = [child for _, child in tree]
        tally.check(
            f"{reader}: /tf: every link once", len(set(children)) == len(children), children
        )
        roots = {parent for parent, _ in tree} - set(children)
        tally.equal(f"{reader}: /tf roots", len(roots), 1)

    every("frame", "/tcp_pose", lambda m: m.header.frame_id == "iiwa_link_0")
    every("unit quaternion", "/tcp_pose", lambda m: unit(m.pose.orientation))
    every(
        "position",
        "/tcp_pose",
        lambda m: finite([m.pose.position.x, m.pose.position.y, m.pose.position.z], 3),
    )

    if "/flange_pose" in messages:
        every("frame", "/flange_pose", lambda m: m.header.frame_id == "iiwa_link_0")
        every("unit quaternion", "/flange_pose", lambda m: unit(m.pose.orientation))
        stamps = [[t for t, _ in messages[topic]] for topic in ("/flange_pose", "/tcp_pose")]
        tally.check(f"{reader}: /flange_pose has the stamps of /tcp_pose", stamps[0] == stamps[1])

    (_, description) = messages["/robot_description"][0]
    try:
        root = ElementTree.fromstring(description.data)
        tally.equal(f"{reader}: /robot_description root", root.tag, "robot")
    except ElementTree.ParseError as error:
        tally.check(f"{reader}: /robot_description is XML", False, str(error))


def check_plan(tally: Tally, reader: str, messages: dict, cycle_time_s: float) -> None:
    """Checks the content of messages that only plans have."""
    every, finite = checks(tally, reader, messages)

    indices = [message.index for _, message in messages["/motion"]]
    tally.check(
        f"{reader}: /motion: indices from 1, never back",
        bool(indices) and indices[0] >= 1 and indices == sorted(indices),
        indices,
    )
    every(
        "kind",
        "/motion",
        lambda m: m.kind in ("line", "lin", "circ", "spline", "blend", "settle", "wait"),
    )
    every(
        "a limiting joint has a kind of limit, and so has the TCP",
        "/motion",
        lambda m: (
            0 <= m.limiting_joint <= 7
            and (m.limiting_joint > 0 or "_" in m.limiting_kind) == bool(m.limiting_kind)
        ),
    )

    (start, trajectory) = messages["/joint_trajectory"][0]
    points = trajectory.points
    tally.check(f"{reader}: /joint_trajectory: names", list(trajectory.joint_names) == JOINTS)
    tally.check(
        f"{reader}: /joint_trajectory: seven values each",
        all(
            finite(point.positions, 7)
            and finite(point.velocities, 7)
            and finite(point.accelerations, 7)
            for point in points
        ),
    )
    times = [nanoseconds(point.time_from_start) for point in points]
    tally.check(
        f"{reader}: /joint_trajectory: times increase from 0",
        times[:1] == [0] and all(a < b for a, b in zip(times, times[1:])),
    )
    tally.check(
        f"{reader}: /joint_trajectory: within the cycle time",
        times[-1] <= round(cycle_time_s * NS) + 1,
        times[-1],
    )
    # Both ends are samples as well as nodes, and need no interpolation.
    states = messages["/joint_states"]
    tally.equal(f"{reader}: joint states and trajectory start together", states[0][0], start)
    for state, point, place in ((states[0], points[0], "first"), (states[-1], points[-1], "last")):
        gap = max(abs(a - b) for a, b in zip(state[1].position, point.positions))
        tally.check(f"{reader}: {place} joint state at the {place} node", gap < 1e-9, gap)


def values(messages: dict) -> list:
    """Numbers of the joint states and the trajectory, for a comparison of two decoders."""
    states = [
        (t, nanoseconds(m.header.stamp), *m.position, *m.velocity)
        for t, m in messages["/joint_states"]
    ]
    points = [
        (nanoseconds(p.time_from_start), *p.positions, *p.velocities, *p.accelerations)
        for _, m in messages["/joint_trajectory"]
        for p in m.points
    ]
    return states + points


def check_figures(tally: Tally, record: dict, figures: dict) -> None:
    # The names of files and the limits of the command are not part of the content.
    figures = {
        key: value for key, value in figures.items() if key not in ("program", "output", "gates")
    }
    tally.equal("keys of the metadata record", sorted(record), sorted(figures))
    for key, expected in figures.items():
        if key not in record:
            continue
        if isinstance(expected, str):
            tally.equal(f"figure {key}", record[key], expected)
        else:
            try:
                tally.equal(f"figure {key}", json.loads(record[key]), expected)
            except json.JSONDecodeError:
                tally.check(f"figure {key} is JSON", False, record[key])


def has_topic(path: Path, topic: str) -> bool:
    with path.open("rb") as stream:
        summary = mcap.reader.make_reader(stream).get_summary()
    return summary is not None and any(
        channel.topic == topic for channel in summary.channels.values()
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", type=Path)
    parser.add_argument("--recording", action="store_true", help="not of a plan but of a robot")
    parser.add_argument("--figures", type=Path, help="the figures that belong to the file")
    arguments = parser.parse_args()

    tally = Tally()
    left_out = PLANNED if arguments.recording else set()
    if not has_topic(arguments.file, "/flange_pose"):
        left_out = left_out | WITH_TOOL
    # Recorded diagnostics of the drive, if they changed.
    if not arguments.recording or not has_topic(arguments.file, "/diagnostics"):
        left_out = left_out | {"/diagnostics"}
    expected = {topic: name for topic, name in TYPES.items() if topic not in left_out}
    contents = read_mcap(tally, arguments.file, expected)
    record = contents["metadata"].get("iiwasim", {})
    check_order(tally, contents["stamps"])
    if arguments.recording:
        check_poses(tally, contents["stamps"])
    else:
        if not tally.check("metadata record iiwasim with a cycle time", "cycle_time_s" in record):
            print(f"{tally.passed} passed, {tally.failed} failed")
            return 1
        cycle_time_s = float(record["cycle_time_s"])
        tally.check("attachments: a program and a URDF", len(contents["attachments"]) >= 2)
        check_time(tally, contents["stamps"], cycle_time_s)

    decoded = {
        "mcap-ros2-support": decode_mcap_ros2(tally, arguments.file),
        "rosbags": decode_rosbags(tally, arguments.file, expected),
    }
    for reader, messages in decoded.items():
        found = {topic: [t for t, _ in entries] for topic, entries in messages.items()}
        tally.check(f"{reader} reads every message", found == contents["stamps"])
        check_messages(tally, reader, messages)
        if not arguments.recording:
            check_plan(tally, reader, messages, cycle_time_s)
    one, other = (values(messages) for messages in decoded.values())
    tally.check("both decoders read the same numbers", one == other)

    check_rerun(tally, arguments.file, expected)
    if arguments.figures:
        check_figures(tally, record, json.loads(arguments.figures.read_text()))

    print(f"{tally.passed} passed, {tally.failed} failed")
    return 1 if tally.failed else 0


if __name__ == "__main__":
    sys.exit(main())
