"""Properties of brokers and readers that the bridge tests rely on, tested without the bridge."""

from __future__ import annotations

import copy
import threading
import uuid

import pytest

from certificates import Certificates
from kafka_broker import MECHANISMS, PASSWORD, USER, KafkaBroker
from mosquitto import Mosquitto
from readers import (
    KafkaReader,
    KafkaWriter,
    MqttClient,
    Received,
    kafka_errors,
    kafka_login,
    mqtt_refusal,
    once_and_in_order,
)
from sparkplug import Host, Payload


def settings(
    listener: str, certificates: Certificates, mechanism: str = "PLAIN", password: str = PASSWORD
) -> dict:
    given = {
        "security.protocol": {"MUTUAL": "SSL", "MISNAMED": "SSL", "EXPIRED": "SSL"}.get(
            listener, listener
        )
    }
    if listener.startswith("SASL"):
        given |= kafka_login(mechanism, USER, password)
    if given["security.protocol"].endswith("SSL"):
        given |= {"ssl.ca.location": str(certificates.authority)}
    if listener == "MUTUAL":
        pair = certificates.client
        given |= {
            "ssl.certificate.location": str(pair.certificate),
            "ssl.key.location": str(pair.key),
        }
    return given


WAYS = [("PLAINTEXT", "PLAIN"), ("SSL", "PLAIN"), ("MUTUAL", "PLAIN")]
WAYS += [
    (listener, mechanism) for listener in ("SASL_PLAINTEXT", "SASL_SSL") for mechanism in MECHANISMS
]


@pytest.mark.parametrize(("listener", "mechanism"), WAYS)
def test_kafka_keeps_what_is_written(
    kafka: KafkaBroker, certificates: Certificates, listener: str, mechanism: str
) -> None:
    topic = uuid.uuid4().hex
    given = settings(listener, certificates, mechanism)
    writer = KafkaWriter(kafka.address(listener), **given)
    for i in range(100):
        writer.write(topic, str(i).encode(), b"robot", kind=b"test")
    writer.flush()
    assert writer.acknowledged == 100
    with KafkaReader(kafka.address(listener), topic, **given) as reader:
        reader.until(lambda: len(reader.messages) == 100, "all is read")
        assert [message.value() for message in reader.messages] == [
            str(i).encode() for i in range(100)
        ]
        assert {message.key() for message in reader.messages} == {b"robot"}
        assert reader.messages[0].headers() == [("kind", b"test")]


def test_kafka_refuses(kafka: KafkaBroker, certificates: Certificates) -> None:
    for listener, mechanism in WAYS:
        if listener.startswith("SASL"):
            wrong = settings(listener, certificates, mechanism, "let me out")
            assert "uthentication failed" in " ".join(
                kafka_errors(kafka.address(listener), **wrong)
            )
    for listener in ("MISNAMED", "EXPIRED"):
        given = settings(listener, certificates)
        assert "verify failed" in " ".join(kafka_errors(kafka.address(listener), **given))
    strange = settings("SSL", certificates) | {"ssl.ca.location": str(certificates.stranger)}
    assert "verify failed" in " ".join(kafka_errors(kafka.address("SSL"), **strange))
    assert kafka_errors(kafka.address("MUTUAL"), **settings("SSL", certificates))
    assert not kafka_errors(kafka.address("MUTUAL"), **settings("MUTUAL", certificates))


@pytest.mark.parametrize("gently", [True, False], ids=["stopped", "killed"])
def test_kafka_loses_nothing(kafka: KafkaBroker, gently: bool) -> None:
    topic = uuid.uuid4().hex
    writer = KafkaWriter(kafka.address())
    written = 0
    with KafkaReader(kafka.address(), topic) as reader:
        for _ in range(3):
            for _ in range(500):
                writer.write(topic, str(written).encode())
                written += 1
            reader.until(lambda: reader.messages, "some are read")
            kafka.stop() if gently else kafka.kill()
            for _ in range(500):
                writer.write(topic, str(written).encode())
                written += 1
            kafka.start()
        writer.flush()
        reader.until(lambda: len(reader.messages) >= written, "all are read")
        assert [message.value() for message in reader.messages] == [
            str(i).encode() for i in range(written)
        ]


def mqtt_ways(certificates: Certificates) -> dict[str, dict]:
    tls = {"authority": certificates.authority}
    user = {"user": (USER, PASSWORD)}
    mutual = tls | {"pair": certificates.client}
    return {"plain": {}, "password": user, "tls": tls, "tls_password": tls | user, "mutual": mutual}


@pytest.mark.parametrize("version", [4, 5])
def test_mosquitto_passes_on_what_is_written(
    mosquitto: Mosquitto, certificates: Certificates, version: int
) -> None:
    for listener, given in mqtt_ways(certificates).items():
        topic = f"test/{uuid.uuid4().hex}"
        with MqttClient(mosquitto.port(listener), f"{topic}/#", version=version, **given) as client:
            for i in range(100):
                client.publish(f"{topic}/{i % 3}", str(i))
            client.until(lambda client=client: len(client.received) == 100, "all is read")
            assert [message.payload for message in client.received] == [
                str(i).encode() for i in range(100)
            ]


def test_mosquitto_refuses(mosquitto: Mosquitto, certificates: Certificates) -> None:
    tls = {"authority": certificates.authority}
    wrong = {"user": (USER, "let me out")}
    assert "uthori" in mqtt_refusal(mosquitto.port("password"))
    assert "uthori" in mqtt_refusal(mosquitto.port("password"), **wrong)
    assert "uthori" in mqtt_refusal(mosquitto.port("tls_password"), **tls, **wrong)
    assert "verify failed" in mqtt_refusal(mosquitto.port("misnamed"), **tls)
    assert "verify failed" in mqtt_refusal(mosquitto.port("expired"), **tls)
    assert "verify failed" in mqtt_refusal(mosquitto.port("tls"), authority=certificates.stranger)
    for way, given in mqtt_ways(certificates).items():
        assert mqtt_refusal(mosquitto.port(way), **given) is None, way


def test_mosquitto_keeps_retained_messages_and_wills(mosquitto: Mosquitto) -> None:
    topic = f"test/{uuid.uuid4().hex}"
    with MqttClient(mosquitto.port()) as client:
        client.publish(topic, "kept", retain=True)
    mosquitto.restart()
    with MqttClient(mosquitto.port(), topic) as client:
        client.until(lambda: client.received, "what was kept is read")
        assert client.received[0].retained


@pytest.mark.parametrize("version", [4, 5])
def test_mosquitto_loses_nothing(mosquitto: Mosquitto, version: int) -> None:
    """Messages reach both a connected and a disconnected reader."""
    topic = f"test/{uuid.uuid4().hex}"
    away = uuid.uuid4().hex
    with MqttClient(mosquitto.port(), topic, version=version, identity=away):
        pass
    written, done = 1500, threading.Event()
    with (
        MqttClient(mosquitto.port(), topic, version=version, identity=uuid.uuid4().hex) as reader,
        MqttClient(mosquitto.port(), version=version, identity=uuid.uuid4().hex) as writer,
    ):

        def write() -> None:
            for i in range(written):
                writer.client.publish(topic, str(i), qos=1).wait_for_publish(60)
            done.set()

        thread = threading.Thread(target=write, daemon=True)
        thread.start()
        for i in range(3):
            reader.until(lambda i=i: len(reader.received) > 300 * i, "some are read")
            mosquitto.restart()
        thread.join(60)
        assert done.is_set()
        reader.until(
            lambda: reader.received[-1].payload == str(written - 1).encode(), "all are read"
        )
        keys, _ = once_and_in_order([message.payload for message in reader.received])
        assert keys == [str(i).encode() for i in range(written)]
    with MqttClient(mosquitto.port(), topic, version=version, identity=away) as late:
        late.until(
            lambda: late.received and late.received[-1].payload == str(written - 1).encode(),
            "all are read",
        )
        assert once_and_in_order([message.payload for message in late.received])[0] == keys


def test_sparkplug_is_held_to_its_rules() -> None:
    def message(kind: str, seq: int | None, *metrics: dict, device: str = "") -> Received:
        payload = Payload(timestamp=1)
        if seq is not None:
            payload.seq = seq
        for metric in metrics:
            payload.metrics.add(timestamp=1, **metric)
        topic = "/".join(["spBv1.0", "group", kind, "node", *([device] if device else [])])
        return Received(topic, payload.SerializeToString(), 0, False)

    sequence = {"name": "bdSeq", "datatype": 4, "long_value": 4}
    rebirth = {"name": "Node Control/Rebirth", "datatype": 11, "boolean_value": False}
    host = Host()
    host.take(message("NBIRTH", 0, sequence, rebirth))
    angle = {"name": "A1", "alias": 7, "datatype": 10, "double_value": 0.5}
    host.take(message("DBIRTH", 1, angle, device="robot"))
    host.take(message("DDATA", 2, {"alias": 7, "double_value": 0.75}, device="robot"))
    node = host.nodes["group/node"]
    assert node.values["robot", "A1"] == 0.75 and node.devices == {"robot": True}
    for broken in (
        message("DDATA", 4, {"alias": 7, "double_value": 1}, device="robot"),
        message("DDATA", 3, {"alias": 8, "double_value": 1}, device="robot"),
        message("DDATA", 3, {"alias": 7, "double_value": 1}, device="other"),
        message("NBIRTH", 1, sequence, rebirth),
    ):
        with pytest.raises(AssertionError):
            copy.deepcopy(host).take(broken)
    host.take(message("NDEATH", None, {"name": "bdSeq", "datatype": 4, "long_value": 3}))
    assert node.is_online
    host.take(message("NDEATH", None, sequence))
    assert not node.is_online and node.devices == {"robot": False}
