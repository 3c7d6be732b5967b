"""The bridge as a Sparkplug B edge node."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Self

import pytest

from bridges import Bridge
from mosquitto import Mosquitto
from processes import until
from readers import MqttClient
from robots import SHORT, Robot
from sparkplug import Host, Node, command

Start = Callable[..., Bridge]


class Follower:
    """A host that follows one edge node."""

    def __init__(self, mosquitto: Mosquitto, name: str) -> None:
        self.mosquitto = mosquitto
        self.name = name
        self.group = f"group {name}"
        self.options = ["--mqtt", mosquitto.address(), "--mqtt-client", name, "--name", name]
        self.options += [f"--sparkplug={self.group}", "--mqtt-rate", "20"]
        self.host = Host()
        self.seen = 0

    def __enter__(self) -> Self:
        self.client = MqttClient(self.mosquitto.port(), f"spBv1.0/{self.group}/#")
        self.client.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self.client.__exit__()

    def node(self) -> Node:
        new = self.client.received[self.seen :]
        self.seen += len(new)
        for message in new:
            self.host.take(message)
        nodes = list(self.host.nodes.values())
        assert len(nodes) < 2
        return nodes[0] if nodes else Node()

    def until(self, condition: Callable[[Node], object], what: str) -> Node:
        until(lambda: condition(self.node()), what)
        return self.node()

    def ask_for_birth(self) -> None:
        self.client.publish(
            f"spBv1.0/{self.group}/NCMD/{self.name}", command("Node Control/Rebirth", True), qos=0
        )


@pytest.fixture
def follower(mosquitto: Mosquitto, name: str) -> Iterator[Follower]:
    with Follower(mosquitto, name) as follower:
        yield follower


def test_births_and_data(
    follower: Follower, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    bridge(simulated_robot, *follower.options)
    node = follower.until(lambda node: node.devices.get(name), "the robot is born")
    assert node.is_online and node.births == 1
    joints = [f"Joints/A{i}/Position" for i in range(1, 8)]
    follower.until(
        lambda node: all((name, joint) in node.values for joint in joints), "its joints are known"
    )
    simulated_robot.run_motions(SHORT)
    node = follower.until(
        lambda node: node.values.get((name, "Run/Cycle Time")), "the run is known"
    )
    assert node.values[name, "Run/Planned Cycle Time"] == pytest.approx(
        node.values[name, "Run/Cycle Time"], abs=0.01
    )
    follower.until(lambda node: node.values.get((name, "State")) == "idle", "the robot is idle")
    expected = simulated_robot.joints()
    follower.until(
        lambda node: all(
            abs(node.values[name, it] - angle) < 1e-3 for it, angle in zip(joints, expected)
        ),
        "its joints are where it is",
    )


def test_it_is_born_again_when_asked(
    follower: Follower, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    bridge(simulated_robot, *follower.options)
    follower.until(lambda node: node.devices.get(name), "the robot is born")
    follower.ask_for_birth()
    follower.until(lambda node: node.births == 2 and node.devices.get(name), "it is born again")


def test_deaths(follower: Follower, bridge: Start, simulated_robot: Robot, name: str) -> None:
    passing = bridge(simulated_robot, *follower.options)
    follower.until(lambda node: node.devices.get(name), "the robot is born")
    passing.kill()
    follower.until(lambda node: not node.is_online and node.deaths == 1, "its will is there")
    passing = bridge(simulated_robot, *follower.options)
    follower.until(
        lambda node: node.is_online and node.devices.get(name), "the robot is born again"
    )
    passing.end()
    follower.until(lambda node: not node.is_online and node.deaths == 2, "it has said goodbye")


def test_broker_that_was_away(
    follower: Follower, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    bridge(simulated_robot, *follower.options)
    first = follower.until(lambda node: node.devices.get(name), "the robot is born").birth_seq
    follower.mosquitto.restart()
    # A disconnected host may miss the birth, and requests one.
    until(lambda: follower.client.connections > 1, "the host is connected again")
    time.sleep(3)
    follower.seen = len(follower.client.received)
    follower.host = Host()
    follower.ask_for_birth()
    node = follower.until(lambda node: node.devices.get(name), "the robot is born again")
    assert node.birth_seq == (first + 1) % 256


def test_robot_that_is_away_is_dead(
    follower: Follower, bridge: Start, binary: object, tmp_path: object, name: str
) -> None:
    with Robot(binary, tmp_path / "own") as robot:
        bridge(robot, *follower.options)
        follower.until(lambda node: node.devices.get(name), "the robot is born")
        robot.drive.terminate()
        robot.drive.wait(30)
        follower.until(lambda node: node.devices.get(name) is False, "the robot is dead")
        robot.start_drive()
        robot.wait_until_ready()
        follower.until(lambda node: node.devices.get(name), "the robot is born again")
