"""Commands from brokers run only if allowed, and never twice, late or malformed."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from confluent_kafka.admin import AdminClient, NewTopic

from bridges import Bridge, Schema
from messages import command, refused_commands
from processes import until
from readers import KafkaWriter
from robots import LONG, SHORT, VERY_LONG, Robot
from ways import KafkaWay, Way, of, read_until

Start = Callable[..., Bridge]


def send(way: Way, type: str, **request: Any) -> str:
    """Sends a command, and returns its id."""
    body = command(way.robot, type, **request)
    way.send(json.dumps(body).encode())
    return body["id"]


def reply_to(way: Way, identity: str) -> dict[str, Any]:
    """The reply of the drive to a command."""
    read_until(
        way, lambda: [it for it in way.replies if it.get("id") == identity], "the reply comes"
    )
    (reply,) = (it for it in way.replies if it.get("id") == identity)
    assert reply["robot"] == way.robot
    return reply["reply"]


@pytest.fixture
def allowed(way: Way, bridge: Start, simulated_robot: Robot, name: str) -> Bridge:
    """A bridge that accepts commands, and is ready for them."""
    started = bridge(simulated_robot, *way.options, "--allow-commands")
    read_until(way, lambda: of(way, "joints"), "joints are passed on")
    take_commands(way)
    return started


def take_commands(way: Way) -> None:
    """Sends a command until it is answered, as a bridge that follows a topic from its end misses
    earlier commands.
    """

    def answered() -> bool:
        sent = send(way, "state")
        end = time.monotonic() + 1
        while time.monotonic() < end:
            way.take()
            if any(it.get("id") == sent for it in way.replies):
                return True
        return False

    until(answered, "commands are taken")


def test_not_allowed(way: Way, bridge: Start, simulated_robot: Robot, name: str) -> None:
    passing = bridge(simulated_robot, *way.options)
    read_until(way, lambda: of(way, "joints"), "joints are passed on")
    before = simulated_robot.joints()
    for kind in ("run_motions", "stop", "set_io"):
        request = {"motions": LONG["motions"]} if kind == "run_motions" else {}
        send(way, kind, **request)
    time.sleep(3)
    way.take()
    assert simulated_robot.joints() == before
    assert not [message for message in of(way, "run")]
    assert not [reply for reply in way.replies if reply["reply"]["ok"]]
    assert passing.runs()


def test_run_and_stop(way: Way, allowed: Bridge, simulated_robot: Robot, schema: Schema) -> None:
    robot = simulated_robot
    assert reply_to(way, send(way, "state"))["state"] == "idle"
    run = reply_to(way, send(way, "run_motions", motions=SHORT["motions"]))
    assert run["ok"], run
    assert run["cycle_time_s"] > 0
    assert "samples" not in run
    identity = send(way, "run_motions", motions=LONG["motions"])
    until(lambda: not robot.is_idle(), "the robot moves")
    # A second run is refused, and does not wait for the first.
    second = reply_to(way, send(way, "run_motions", motions=SHORT["motions"]))
    assert second["error"]["code"] == "not_idle"
    began = time.monotonic()
    stop = reply_to(way, send(way, "stop"))
    print(
        f"{way.label}: the robot stands {time.monotonic() - began:.2f} s after the command to stop"
    )
    assert stop["ok"], stop
    assert robot.is_idle()
    assert "stopped" in reply_to(way, identity)["error"]["message"]


def test_inputs_and_outputs(way: Way, allowed: Bridge, simulated_robot: Robot) -> None:
    lamp = "MediaFlange.LEDBlue"
    for value in (True, False):
        assert reply_to(way, send(way, "set_io", name=lamp, value=value))["value"] is value
        assert reply_to(way, send(way, "get_io", name=lamp))["value"] is value
        assert simulated_robot.ask("get_io", name=lamp)["value"] is value
    names = {signal["name"] for signal in reply_to(way, send(way, "list_io"))["io"]}
    assert lamp in names
    unknown = reply_to(way, send(way, "get_io", name="Nothing"))
    assert unknown["error"]["code"] == "bad_request"
    assert len(reply_to(way, send(way, "read_sensors"))["sensors"]["external_torque_nm"]) == 7


def test_what_is_wrong_is_refused(
    way: Way, allowed: Bridge, simulated_robot: Robot, name: str
) -> None:
    robot = simulated_robot
    before = robot.joints()
    for what, body in refused_commands(name, LONG).items():
        way.take()
        count = len(way.replies)
        way.send(body)
        read_until(way, lambda count=count: len(way.replies) > count, f"it is answered: {what}")
        reply = way.replies[-1]["reply"]
        assert not reply["ok"], what
        print(f"{what}: {reply['error']}")
        # A refusal does not repeat the full command.
        assert len(json.dumps(way.replies[-1])) < 5000, what
        assert robot.is_idle(), what
    assert robot.joints() == before
    assert reply_to(way, send(way, "state"))["ok"]


def test_what_is_repeated_runs_once(
    way: Way, allowed: Bridge, simulated_robot: Robot, name: str
) -> None:
    body = command(name, "run_motions", motions=SHORT["motions"])
    text = json.dumps(body).encode()
    for _ in range(5):
        way.send(text)
    read_until(
        way,
        lambda: len([it for it in way.replies if it.get("id") == body["id"]]) == 5,
        "all are answered",
    )
    replies = [it["reply"] for it in way.replies if it.get("id") == body["id"]]
    assert sorted(reply["ok"] for reply in replies) == [False] * 4 + [True]
    way.send(text)
    read_until(
        way,
        lambda: len([it for it in way.replies if it.get("id") == body["id"]]) == 6,
        "it is answered",
    )
    until(simulated_robot.is_idle, "the run has ended")
    read_until(
        way, lambda: [it for it in of(way, "run") if it["event"] == "end"], "the run is passed on"
    )
    assert len([it for it in of(way, "run") if it["event"] == "begin"]) == 1


def test_what_is_too_long_is_refused(
    way: Way, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    if isinstance(way, KafkaWay):
        # Topics may allow larger messages than the bridge.
        settings = {"max.message.bytes": "20000000"}
        request = NewTopic(way.topic("request"), 1, 1, config=settings)
        admin = AdminClient({"bootstrap.servers": way.broker.address()})
        admin.create_topics([request])[request.topic].result(60)
        way.writer = KafkaWriter(way.broker.address(), message_max_bytes="20000000")
    passing = bridge(simulated_robot, *way.options, "--allow-commands")
    take_commands(way)
    for mb in (0.9, 3, 5, 15):
        count = len(way.replies)
        way.send(
            json.dumps(
                command(name, "run_motions", identity="x" * int(mb * 1e6), motions=LONG["motions"])
            ).encode()
        )
        read_until(way, lambda count=count: len(way.replies) > count, f"it is answered: {mb} MB")
        assert not way.replies[-1]["reply"]["ok"]
        assert simulated_robot.is_idle()
    assert reply_to(way, send(way, "state"))["ok"]
    assert passing.memory_kb() < 300_000


def test_restarted_bridge_repeats_no_command(
    way: Way, allowed: Bridge, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    """A broker that stores a command delivers it again, and the next bridge does not know the first
    delivery.
    """
    identity = send(way, "run_motions", motions=SHORT["motions"])
    assert reply_to(way, identity)["ok"]
    allowed.kill()
    bridge(simulated_robot, *way.options, "--allow-commands")
    take_commands(way)
    way.take()
    runs = [it for it in of(way, "run") if it["event"] == "begin"]
    assert len(runs) == 1
    assert simulated_robot.is_idle()


def test_command_for_a_bridge_that_is_away_moves_nothing(
    way: Way, allowed: Bridge, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    allowed.end()
    send(way, "run_motions", motions=SHORT["motions"])
    # A command of this age is refused in any case.
    time.sleep(11)
    before = simulated_robot.joints()
    bridge(simulated_robot, *way.options, "--allow-commands")
    take_commands(way)
    assert simulated_robot.joints() == before
    assert not [it for it in of(way, "run")]


def test_command_for_a_drive_that_is_away_moves_nothing_later(
    way: Way, bridge: Start, binary: Path, tmp_path: Path, name: str
) -> None:
    with Robot(binary, tmp_path / "own") as robot:
        bridge(robot, *way.options, "--allow-commands")
        read_until(way, lambda: of(way, "joints"), "joints are passed on")
        take_commands(way)
        robot.drive.terminate()
        robot.drive.wait(30)
        identity = send(way, "run_motions", motions=LONG["motions"])
        assert not reply_to(way, identity)["ok"]
        robot.start_drive()
        robot.wait_until_ready()
        before = robot.joints()
        take_commands(way)
        time.sleep(3)
        assert robot.is_idle() and robot.joints() == before


def test_stop_passes_a_flood(way: Way, allowed: Bridge, simulated_robot: Robot, name: str) -> None:
    """A flood of other requests does not prevent a stop of the robot."""
    robot = simulated_robot
    identity = send(way, "run_motions", motions=VERY_LONG["motions"])
    until(lambda: not robot.is_idle(), "the robot moves")
    way.send(*(json.dumps(command(name, "read_sensors")).encode() for _ in range(12_000)))
    assert not robot.is_idle()
    began = time.monotonic()
    stop = reply_to(way, send(way, "stop"))
    print(
        f"{way.label}: in a flood, {stop} {time.monotonic() - began:.2f} s after the command to "
        "stop"
    )
    assert stop["ok"]
    assert "stopped" in reply_to(way, identity)["error"]["message"]
    assert allowed.memory_kb() < 300_000
