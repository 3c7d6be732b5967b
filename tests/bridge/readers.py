"""Clients that read and write Kafka and MQTT messages, with libraries unrelated to the bridge."""

from __future__ import annotations

import json
import ssl
import threading
import time
import uuid
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, Self

import paho.mqtt.client as mqtt
from confluent_kafka import (
    OFFSET_BEGINNING,
    Consumer,
    KafkaError,
    KafkaException,
    Message,
    Producer,
    TopicPartition,
)
from confluent_kafka.admin import AdminClient
from paho.mqtt.enums import CallbackAPIVersion, MQTTProtocolVersion
from paho.mqtt.packettypes import PacketTypes
from paho.mqtt.properties import Properties

from processes import PATIENCE_S, until

# Standard error is for test output: librdkafka would log each connection attempt.
QUIET = {"log_level": 0}


def kafka_login(mechanism: str, user: str, password: str) -> dict[str, str]:
    return {"sasl.mechanism": mechanism, "sasl.username": user, "sasl.password": password}


def kafka_errors(address: str, **settings: str) -> list[str]:
    """Reasons for refusing a client; empty if it is accepted. Settings are those of librdkafka,
    with _ in place of dots.
    """
    errors: list[KafkaError] = []
    given = {key.replace("_", "."): value for key, value in settings.items()}
    consumer = Consumer(
        {
            "bootstrap.servers": address,
            "group.id": "x",
            "error_cb": errors.append,
            **QUIET,
            **given,
        },
    )
    try:

        def decided() -> bool:
            consumer.poll(0.1)
            if [error for error in errors if error.code() != KafkaError._ALL_BROKERS_DOWN]:
                return True
            try:
                return bool(consumer.list_topics(timeout=0.5).brokers)
            except KafkaException:
                return False

        until(decided, f"{address} lets in or refuses")
        return [error.str() for error in errors if error.code() != KafkaError._ALL_BROKERS_DOWN]
    finally:
        consumer.close()


class KafkaReader:
    """Reads all partitions of topics from their beginning, and survives stops of the broker."""

    def __init__(self, address: str, *topics: str, **settings: str) -> None:
        self.topics = topics
        given = {key.replace("_", "."): value for key, value in settings.items()}
        common = {"bootstrap.servers": address, "reconnect.backoff.max.ms": 500, **QUIET, **given}
        self.admin = AdminClient(common)
        self.consumer = Consumer(
            {
                "group.id": uuid.uuid4().hex,
                "enable.auto.commit": False,
                "enable.partition.eof": False,
                **common,
            }
        )
        self.assigned: set[tuple[str, int]] = set()
        self.messages: list[Message] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.consumer.close()

    def look_for_partitions(self) -> None:
        """Finds partitions; topics may be created only with the first message."""
        try:
            known = self.admin.list_topics(timeout=2).topics
        except KafkaException:
            return
        found = {
            (topic, at) for topic in self.topics if topic in known for at in known[topic].partitions
        }
        if new := found - self.assigned:
            self.consumer.incremental_assign(
                [TopicPartition(*place, OFFSET_BEGINNING) for place in new]
            )
            self.assigned |= new

    def read(self) -> None:
        """Reads the available messages, with a short time limit."""
        missing = set(self.topics) - {topic for topic, _ in self.assigned}
        if missing:
            self.look_for_partitions()
        if not self.assigned:
            return
        for message in self.consumer.consume(10_000, 0.2):
            if message.error() is None:
                self.messages.append(message)

    def until(
        self, condition: Callable[[], Any], what: str, *, patience_s: float = PATIENCE_S
    ) -> None:
        """Reads until the condition is true."""

        def read_and_look() -> bool:
            self.read()
            return bool(condition())

        until(read_and_look, what, patience_s=patience_s, every_s=0)

    def of(self, topic: str) -> list[Message]:
        return [message for message in self.messages if message.topic() == topic]

    def json(self, topic: str) -> list[dict[str, Any]]:
        return [json.loads(message.value()) for message in self.of(topic)]


class KafkaWriter:
    """Writes messages, and reports acknowledgements of the broker."""

    def __init__(self, address: str, **settings: str) -> None:
        given = {key.replace("_", "."): value for key, value in settings.items()}
        self.producer = Producer(
            {
                "bootstrap.servers": address,
                "enable.idempotence": True,
                "linger.ms": 5,
                "reconnect.backoff.max.ms": 500,
                **QUIET,
                **given,
            }
        )
        self.acknowledged = 0
        self.failed: list[str] = []

    def told(self, error: KafkaError | None, _: Message) -> None:
        if error is None:
            self.acknowledged += 1
        else:
            self.failed.append(error.str())

    def write(self, topic: str, value: bytes, key: bytes | None = None, **headers: bytes) -> None:
        self.producer.produce(
            topic, value, key, headers=list(headers.items()), on_delivery=self.told
        )
        self.producer.poll(0)

    def flush(self) -> None:
        left = self.producer.flush(PATIENCE_S)
        assert left == 0, f"{left} messages are not acknowledged"


@dataclass
class Received:
    """An MQTT message with its time of arrival."""

    topic: str
    payload: bytes
    qos: int
    retained: bool
    properties: dict[str, Any] = field(default_factory=dict)
    at_s: float = 0.0

    def json(self) -> dict[str, Any]:
        return json.loads(self.payload)


class MqttClient:
    """A client that subscribes and publishes; it survives stops of the broker, and so does its
    session.
    """

    def __init__(
        self,
        port: int,
        *topics: str,
        version: int = 5,
        identity: str | None = None,
        user: tuple[str, str] | None = None,
        authority: object = None,
        pair: Any = None,
        host: str = "localhost",
    ) -> None:
        self.topics = topics
        self.received: list[Received] = []
        self.refused: list[str] = []
        self.subscribed = threading.Event()
        self.connections = 0
        self.lock = threading.Lock()
        is_5 = version == 5
        protocol = MQTTProtocolVersion.MQTTv5 if is_5 else MQTTProtocolVersion.MQTTv311
        session = {} if is_5 else {"clean_session": identity is None}
        self.client = mqtt.Client(
            CallbackAPIVersion.VERSION2,
            client_id=identity or uuid.uuid4().hex,
            protocol=protocol,
            **session,
        )
        self.client.on_connect = self.connected
        self.client.on_subscribe = lambda *_: self.subscribed.set()
        self.client.on_message = self.on_message
        self.client.reconnect_delay_set(0.1, 0.5)
        if user:
            self.client.username_pw_set(*user)
        if authority:
            shown = {"certfile": str(pair.certificate), "keyfile": str(pair.key)} if pair else {}
            self.client.tls_set(
                ca_certs=str(authority), tls_version=ssl.PROTOCOL_TLS_CLIENT, **shown
            )
        start: dict[str, Any] = {}
        if is_5:
            start["clean_start"] = identity is None
            if identity:
                start["properties"] = Properties(PacketTypes.CONNECT)
                start["properties"].SessionExpiryInterval = 3600
        self.client.connect(host, port, keepalive=10, **start)
        self.client.loop_start()

    def __enter__(self) -> Self:
        if self.topics:
            assert self.subscribed.wait(PATIENCE_S), f"not subscribed: {self.refused}"
        return self

    def __exit__(self, *_: object) -> None:
        self.client.disconnect()
        self.client.loop_stop()

    def connected(self, client: mqtt.Client, _: Any, __: Any, reason: Any, ___: Any = None) -> None:
        if reason.is_failure:
            self.refused.append(str(reason))
            return
        self.connections += 1
        if self.topics:
            client.subscribe([(topic, 1) for topic in self.topics])

    def on_message(self, _: Any, __: Any, message: mqtt.MQTTMessage) -> None:
        properties = message.properties.json() if message.properties else {}
        received = Received(
            message.topic,
            message.payload,
            message.qos,
            message.retain,
            properties,
            time.monotonic(),
        )
        with self.lock:
            self.received.append(received)

    def of(self, topic: str) -> list[Received]:
        with self.lock:
            return [message for message in self.received if message.topic == topic]

    def latest(self, topic: str) -> dict[str, Any] | None:
        """The latest message of a topic."""
        messages = self.of(topic)
        return messages[-1].json() if messages else None

    def publish(
        self,
        topic: str,
        payload: bytes | str,
        *,
        qos: int = 1,
        retain: bool = False,
        **properties: Any,
    ) -> None:
        """Publishes a message, and waits for the acknowledgement of the broker.

        Properties are those of MQTT 5: ResponseTopic, CorrelationData.
        """
        given = None
        if properties:
            given = Properties(PacketTypes.PUBLISH)
            for name, value in properties.items():
                setattr(given, name, value)
        self.client.publish(
            topic, payload, qos=qos, retain=retain, properties=given
        ).wait_for_publish(PATIENCE_S)

    def until(
        self, condition: Callable[[], Any], what: str, *, patience_s: float = PATIENCE_S
    ) -> Any:
        return until(condition, what, patience_s=patience_s, every_s=0.02)


def mqtt_refusal(port: int, **client: Any) -> str | None:
    """Reason for refusing a client; `None` if it is accepted."""
    try:
        asked = MqttClient(port, **client)
    except OSError as why:
        return str(why)
    try:
        until(lambda: asked.connections or asked.refused, "the broker lets in or refuses")
        return asked.refused[0] if asked.refused else None
    finally:
        asked.__exit__()


def once_and_in_order(keys: Iterator[tuple[Any, ...]] | list[Any]) -> tuple[list[Any], int]:
    """Keys without repetitions, and the number of repetitions: delivery is at least once."""
    seen: dict[Any, None] = {}
    repeated = 0
    for key in keys:
        repeated += key in seen
        seen.setdefault(key)
    return list(seen), repeated
