"""Fixtures: brokers, simulated robots and bridges."""

from __future__ import annotations

import os
import signal
import uuid
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from bridges import Bridge, Schema
from certificates import Certificates
from kafka_broker import KafkaBroker, fetch_jars
from mosquitto import Mosquitto
from robots import Robot
from ways import KafkaWay, MqttWay, Way

# Time limit of a test, sufficient for slow machines.
LONGEST_S = 400


def pytest_configure() -> None:
    """Makes termination end all started processes, like an interrupt."""
    signal.signal(signal.SIGTERM, lambda *_: pytest.exit("terminated", 143))


@pytest.fixture(autouse=True)
def bounded() -> Iterator[None]:
    """Time limit: a test that blocks fails, and the processes that it started end."""

    def give_up(*_: object) -> None:
        raise TimeoutError(f"the test takes more than {LONGEST_S} s")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(LONGEST_S)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.fixture(scope="session")
def certificates(tmp_path_factory: pytest.TempPathFactory) -> Certificates:
    return Certificates(tmp_path_factory.mktemp("certificates"))


@pytest.fixture(scope="session")
def kafka_of_session(
    tmp_path_factory: pytest.TempPathFactory, certificates: Certificates
) -> Iterator[KafkaBroker]:
    with KafkaBroker(fetch_jars(), tmp_path_factory.mktemp("kafka"), certificates) as broker:
        yield broker


@pytest.fixture
def kafka(kafka_of_session: KafkaBroker) -> KafkaBroker:
    """The broker that tests share; each test may stop it."""
    return kafka_of_session.running()


@pytest.fixture(scope="session")
def mosquitto_of_session(
    tmp_path_factory: pytest.TempPathFactory, certificates: Certificates
) -> Iterator[Mosquitto]:
    with Mosquitto(tmp_path_factory.mktemp("mosquitto"), certificates) as broker:
        yield broker


@pytest.fixture
def mosquitto(mosquitto_of_session: Mosquitto) -> Mosquitto:
    """The broker that tests share; each test may stop it."""
    return mosquitto_of_session.running()


@pytest.fixture(scope="session")
def binary() -> Path:
    """The program `iiwasim`; without it, the test is skipped."""
    named = os.environ.get("IIWASIM_BINARY")
    if named is None:
        pytest.skip("IIWASIM_BINARY is not set: it has to be a built program `iiwasim`")
    return Path(named).resolve()


@pytest.fixture(scope="session")
def schema(binary: Path) -> Schema:
    return Schema(binary)


@pytest.fixture(scope="session")
def robot_of_session(tmp_path_factory: pytest.TempPathFactory, binary: Path) -> Iterator[Robot]:
    with Robot(binary, tmp_path_factory.mktemp("robot")) as robot:
        yield robot


@pytest.fixture
def simulated_robot(robot_of_session: Robot) -> Iterator[Robot]:
    """The robot that tests share, at rest."""
    robot_of_session.rest()
    yield robot_of_session
    robot_of_session.rest()


@pytest.fixture
def quick_robot(tmp_path: Path, binary: Path) -> Iterator[Robot]:
    """A robot for one test, which reports its joints every 1 ms."""
    with Robot(binary, tmp_path / "robot", "--period", "1") as robot:
        yield robot


@pytest.fixture
def name() -> str:
    """A unique robot name, so that its topics are new."""
    return f"robot-{uuid.uuid4().hex[:12]}"


@pytest.fixture
def bridge(binary: Path, tmp_path: Path) -> Iterator[Callable[..., Bridge]]:
    """Starts bridges of a robot, which end with the test."""
    started: list[Bridge] = []

    def start(robot: Robot, *options: str) -> Bridge:
        given = [] if "--spool" in options else ["--spool", str(tmp_path / f"spool-{len(started)}")]
        started.append(
            Bridge(binary, robot, tmp_path / f"bridge-{len(started)}.log", *options, *given)
        )
        return started[-1]

    yield start
    for each in started:
        each.end()
        # Shown if the test fails.
        print(each.said())


@pytest.fixture(params=["kafka", "mqtt", "mqtt 3.1.1"])
def way(request: pytest.FixtureRequest, name: str) -> Iterator[Way]:
    """Each kind of broker, with its readers."""
    if request.param == "kafka":
        made = KafkaWay(request.getfixturevalue("kafka"), name)
    else:
        made = MqttWay(
            request.getfixturevalue("mosquitto"), name, 5 if request.param == "mqtt" else 4
        )
    with made as way:
        yield way
