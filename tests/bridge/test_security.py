"""Authentication of bridges by brokers, and of brokers by bridges."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from bridges import Bridge
from certificates import Certificates
from kafka_broker import MECHANISMS, PASSWORD, USER, KafkaBroker
from mosquitto import Mosquitto
from robots import Robot
from ways import KafkaWay, MqttWay, Way, of, read_until

Start = Callable[..., Bridge]


class Access:
    """Bridge options for the access to a broker: `kafka` or `mqtt`."""

    def __init__(self, broker: str, folder: Path, certificates: Certificates) -> None:
        self.broker = broker
        self.folder = folder
        self.certificates = certificates

    def user(self, name: str = USER, password: str = PASSWORD) -> list[str]:
        file = self.folder / f"password-of-{name}-{len(password)}"
        file.write_text(password + "\n")
        return [f"--{self.broker}-user", name, f"--{self.broker}-password-file", str(file)]

    def authority(self, file: Path | None = None) -> list[str]:
        return [f"--{self.broker}-ca", str(file or self.certificates.authority)]

    def pair(self) -> list[str]:
        pair = self.certificates.client
        return [
            f"--{self.broker}-cert",
            str(pair.certificate),
            f"--{self.broker}-cert-key",
            str(pair.key),
        ]


@pytest.fixture
def kafka_access(tmp_path: Path, certificates: Certificates) -> Access:
    return Access("kafka", tmp_path, certificates)


@pytest.fixture
def mqtt_access(tmp_path: Path, certificates: Certificates) -> Access:
    return Access("mqtt", tmp_path, certificates)


def to(way: Way, listener: str, *options: str) -> list[str]:
    """The options of a kind of broker, with another listener."""
    return [
        way.broker.address(listener) if it == way.broker.address() else it for it in way.options
    ] + [*options]


def passes(way: Way, passing: Bridge) -> None:
    """Checks that bridge messages arrive."""
    read_until(way, lambda: of(way, "joints"), "joints are passed on")
    assert passing.runs(), passing.said()


def refuses(passing: Bridge, *words: str) -> None:
    """Checks that the bridge ends at once, with the reason."""
    assert passing.wait(60) not in (0, None)
    said = passing.said()
    print(said)
    assert any(word.lower() in said.lower() for word in words), said
    assert PASSWORD not in said and "panic" not in said


@pytest.mark.parametrize("listener", ["SASL_PLAINTEXT", "SASL_SSL"])
@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_kafka_with_password(
    kafka: KafkaBroker,
    kafka_access: Access,
    bridge: Start,
    simulated_robot: Robot,
    name: str,
    listener: str,
    mechanism: str,
) -> None:
    tls = kafka_access.authority() if listener == "SASL_SSL" else []
    sasl = ["--kafka-sasl", mechanism.lower()]
    with KafkaWay(kafka, name) as way:
        passes(way, bridge(simulated_robot, *to(way, listener, *tls, *sasl, *kafka_access.user())))
        for user in (kafka_access.user(password="let me out"), kafka_access.user("stranger")):
            refused = bridge(simulated_robot, *to(way, listener, *tls, *sasl, *user))
            refuses(refused, "does not accept the user", "password")


def test_kafka_with_tls(
    kafka: KafkaBroker, kafka_access: Access, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    authority, pair = kafka_access.authority(), kafka_access.pair()
    with KafkaWay(kafka, name) as way:
        passes(way, bridge(simulated_robot, *to(way, "SSL", *authority)))
    with KafkaWay(kafka, f"{name}-mutual") as way:
        passes(way, bridge(simulated_robot, *to(way, "MUTUAL", *authority, *pair)))
    strange = kafka_access.authority(kafka_access.certificates.stranger)
    with KafkaWay(kafka, f"{name}-refused") as way:
        for listener in ("MISNAMED", "EXPIRED"):
            refuses(bridge(simulated_robot, *to(way, listener, *authority)), "certificate")
        refuses(bridge(simulated_robot, *to(way, "SSL", *strange)), "certificate", "UnknownIssuer")
        refuses(
            bridge(simulated_robot, *to(way, "SSL", "--kafka-tls")), "certificate", "UnknownIssuer"
        )
        way.take()
        assert not way.read


def test_kafka_that_asks_for_what_is_not_given_is_told(
    kafka: KafkaBroker, kafka_access: Access, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    """Kafka requires a certificate or TLS: the bridge may keep trying, but reports the error."""
    with KafkaWay(kafka, name) as way:
        for listener, options in (
            ("MUTUAL", kafka_access.authority()),
            ("SSL", []),
            ("PLAINTEXT", ["--kafka-tls"]),
        ):
            passing = bridge(simulated_robot, *to(way, listener, *options))
            passing.lasts = False
            read_until(
                way,
                lambda passing=passing: not passing.runs() or "WARN" in passing.said(),
                "it is told",
            )
            print(listener, options, passing.said())
            assert "panic" not in passing.said()
            passing.end()
        assert not way.read


@pytest.mark.parametrize("version", [4, 5])
def test_mqtt_with_password(
    mosquitto: Mosquitto,
    mqtt_access: Access,
    bridge: Start,
    simulated_robot: Robot,
    name: str,
    version: int,
) -> None:
    for listener, tls in (("password", []), ("tls_password", mqtt_access.authority())):
        with MqttWay(mosquitto, f"{name}-{listener}", version) as way:
            passes(way, bridge(simulated_robot, *to(way, listener, *tls, *mqtt_access.user())))
            for user in (mqtt_access.user(password="let me out"), mqtt_access.user("stranger"), []):
                refused = bridge(simulated_robot, *to(way, listener, *tls, *user))
                refuses(refused, "does not accept the user", "password")


@pytest.mark.parametrize("version", [4, 5])
def test_mqtt_with_tls(
    mosquitto: Mosquitto,
    mqtt_access: Access,
    bridge: Start,
    simulated_robot: Robot,
    name: str,
    version: int,
) -> None:
    authority, pair = mqtt_access.authority(), mqtt_access.pair()
    with MqttWay(mosquitto, name, version) as way:
        passes(way, bridge(simulated_robot, *to(way, "tls", *authority)))
    with MqttWay(mosquitto, f"{name}-mutual", version) as way:
        passes(way, bridge(simulated_robot, *to(way, "mutual", *authority, *pair)))
    strange = mqtt_access.authority(mqtt_access.certificates.stranger)
    with MqttWay(mosquitto, f"{name}-refused", version) as way:
        for listener in ("misnamed", "expired"):
            refuses(bridge(simulated_robot, *to(way, listener, *authority)), "certificate")
        refuses(bridge(simulated_robot, *to(way, "tls", *strange)), "certificate", "UnknownIssuer")
        refuses(
            bridge(simulated_robot, *to(way, "tls", "--mqtt-tls")), "certificate", "UnknownIssuer"
        )
        way.take()
        assert not way.read


def test_passwords_do_not_leave_this_machine_in_the_clear(
    kafka_access: Access, mqtt_access: Access, bridge: Start, simulated_robot: Robot
) -> None:
    # An address reserved for documentation, which does not answer.
    kafka = ["--kafka", "192.0.2.1:9092", "--kafka-sasl", "plain", *kafka_access.user()]
    refuses(bridge(simulated_robot, *kafka), "in the clear")
    refuses(
        bridge(simulated_robot, "--mqtt", "192.0.2.1:1883", *mqtt_access.user()), "in the clear"
    )


def test_files_that_cannot_be_used_are_named(
    kafka: KafkaBroker,
    kafka_access: Access,
    bridge: Start,
    simulated_robot: Robot,
    tmp_path: Path,
    name: str,
) -> None:
    way = KafkaWay(kafka, name)
    empty = tmp_path / "empty.pem"
    empty.write_text("")
    refuses(bridge(simulated_robot, *to(way, "SSL", *kafka_access.authority(empty))), "empty.pem")
    refuses(
        bridge(simulated_robot, *to(way, "SSL", *kafka_access.authority(tmp_path / "none.pem"))),
        "none.pem",
    )
    missing = ["--kafka-user", USER, "--kafka-password-file", str(tmp_path / "nowhere")]
    refuses(bridge(simulated_robot, *to(way, "SASL_SSL", *missing)), "nowhere")
    missing[-1] = str(empty)
    refuses(bridge(simulated_robot, *to(way, "SASL_SSL", *missing)), "empty.pem")


def test_spool_is_one_bridge_s(
    kafka: KafkaBroker, bridge: Start, simulated_robot: Robot, tmp_path: Path, name: str
) -> None:
    spool = ["--spool", str(tmp_path / "spool")]
    with KafkaWay(kafka, name) as way:
        passes(way, bridge(simulated_robot, *way.options, *spool))
        refuses(bridge(simulated_robot, *way.options, *spool), "another bridge uses the spool")


@pytest.mark.parametrize(
    "options", [["--name", ".."], ["--add", "..=127.0.0.1:1,127.0.0.1:1"]], ids=["name", "add"]
)
def test_name_that_leads_out_of_the_spool_is_refused(
    mosquitto: Mosquitto, bridge: Start, simulated_robot: Robot, tmp_path: Path, options: list[str]
) -> None:
    spool = tmp_path / "plant" / "spool"
    passing = bridge(
        simulated_robot, "--mqtt", mosquitto.address(), "--spool", str(spool), *options
    )
    refuses(passing, "invalid robot name `..`: use 1 to 64 letters, digits, `-` and `_`")
    assert not spool.parent.exists()


@pytest.mark.parametrize("file", ["lock", "cursor", "000000000001.spool"])
def test_link_in_the_spool_is_refused(
    mosquitto: Mosquitto,
    bridge: Start,
    simulated_robot: Robot,
    tmp_path: Path,
    name: str,
    file: str,
) -> None:
    """Write access to the spool folder is not enough to make the bridge truncate or send another
    file.
    """
    victim = tmp_path / "victim"
    victim.write_text("precious")
    with MqttWay(mosquitto, name) as way:
        link = tmp_path / "spool" / "mqtt" / name / file
        link.parent.mkdir(parents=True)
        link.symlink_to(victim)
        refuses(
            bridge(simulated_robot, *way.options, "--spool", str(tmp_path / "spool")),
            f"{link} is a symbolic link",
        )
        assert victim.read_text() == "precious"
        link.unlink()
        bridge(simulated_robot, *way.options, "--spool", str(tmp_path / "spool"))
        read_until(way, lambda: of(way, "joints"), "joints are passed on")
