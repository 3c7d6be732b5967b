"""Kafka and MQTT behind a common interface, so that tests run on both brokers."""

from __future__ import annotations

import json
import uuid
from collections import defaultdict
from collections.abc import Callable
from typing import Any, Self

from kafka_broker import KafkaBroker
from messages import KINDS
from mosquitto import Mosquitto
from processes import PATIENCE_S, until
from readers import KafkaReader, KafkaWriter, MqttClient

ROOT = "iiwasim"


class KafkaWay:
    """The path from the bridge to readers over a Kafka broker."""

    label = "kafka"
    # Message kinds that may be incomplete after a stop of the broker.
    may_lack = ()

    def __init__(self, broker: KafkaBroker, robot: str) -> None:
        self.broker = broker
        self.robot = robot
        # Separate topics for each test, as topics are read from their beginning.
        self.prefix = robot
        self.options = ["--kafka", broker.address(), "--kafka-prefix", self.prefix, "--name", robot]
        self.read: list[dict[str, Any]] = []
        self.by_kind: dict[str, list[dict[str, Any]]] = defaultdict(list)
        self.replies: list[dict[str, Any]] = []

    def topic(self, kind: str) -> str:
        return f"{self.prefix}.{kind}"

    def __enter__(self) -> Self:
        self.reader = KafkaReader(self.broker.address(), *map(self.topic, (*KINDS, "reply")))
        self.writer = KafkaWriter(self.broker.address())
        return self

    def __exit__(self, *_: object) -> None:
        self.reader.__exit__()

    def take(self) -> None:
        self.reader.read()
        messages, self.reader.messages = self.reader.messages, []
        for message in messages:
            content = json.loads(message.value())
            if message.topic() == self.topic("reply"):
                self.replies.append(content)
            else:
                self.read.append(content)
                self.by_kind[content["kind"]].append(content)

    def send(self, *bodies: bytes) -> None:
        """Sends messages, and waits for the acknowledgement of the broker."""
        for body in bodies:
            self.writer.write(self.topic("request"), body, self.robot.encode())
        self.writer.flush()


class MqttWay:
    """The path from the bridge to readers over an MQTT broker."""

    label = "mqtt"
    may_lack = ("joints",)

    def __init__(self, broker: Mosquitto, robot: str, version: int = 5) -> None:
        self.broker = broker
        self.robot = robot
        self.version = version
        self.options = [
            "--mqtt",
            broker.address(),
            "--mqtt-rate",
            "0",
            "--mqtt-client",
            robot,
            "--name",
            robot,
        ]
        self.options += ["--mqtt-version", {4: "3", 5: "5"}[version]]
        self.read: list[dict[str, Any]] = []
        self.by_kind: dict[str, list[dict[str, Any]]] = defaultdict(list)
        self.replies: list[dict[str, Any]] = []
        self.wills: list[dict[str, Any]] = []
        self.seen = 0

    def topic(self, kind: str) -> str:
        return f"{ROOT}/{self.robot}/{kind}"

    def __enter__(self) -> Self:
        identity = uuid.uuid4().hex
        self.client = MqttClient(
            self.broker.port(), self.topic("#"), version=self.version, identity=identity
        )
        self.client.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self.client.__exit__()

    def take(self) -> None:
        new = self.client.received[self.seen :]
        self.seen += len(new)
        for message in new:
            kind = message.topic.removeprefix(self.topic(""))
            if kind == "reply":
                self.replies.append(message.json())
            elif kind in KINDS:
                read = message.json()
                # The last will, which the broker sends for a lost bridge.
                is_will = kind == "bridge" and not read["online"] and read["seq"] == 0
                if is_will:
                    self.wills.append(read)
                else:
                    self.read.append(read)
                    self.by_kind[kind].append(read)

    def send(self, *bodies: bytes) -> None:
        """Sends messages, and waits for the acknowledgement of the broker."""
        sent = [self.client.client.publish(self.topic("request"), body, qos=1) for body in bodies]
        for each in sent:
            each.wait_for_publish(PATIENCE_S)


Way = KafkaWay | MqttWay


def of(way: Way, kind: str) -> list[dict[str, Any]]:
    """Received messages of a kind."""
    return way.by_kind[kind]


def tells_losses(way: Way, count: int) -> bool:
    """True if the bridge has reported the loss of `count` messages."""
    return any(each["spools"][way.label]["dropped"] == count for each in of(way, "bridge"))


def read_until(way: Way, condition: Callable[[], Any], what: str, **patience: float) -> None:
    """Reads until the condition is true."""

    def read_and_look() -> bool:
        way.take()
        return bool(condition())

    until(read_and_look, what, **patience)
