"""Brokers, simulated robots and bridges that tests ask for."""

from __future__ import annotations

import signal
from collections.abc import Iterator

import pytest
from certificates import Certificates
from kafka_broker import KafkaBroker, fetch_jars
from mosquitto import Mosquitto

# A test that hangs is to end, on a slow machine as well.
LONGEST_S = 400


@pytest.fixture(autouse=True)
def bounded() -> Iterator[None]:
    """A test that hangs fails, and what it has started ends."""

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
def kafka_of_session(tmp_path_factory: pytest.TempPathFactory, certificates: Certificates) -> Iterator[KafkaBroker]:
    broker = KafkaBroker(fetch_jars(), tmp_path_factory.mktemp("kafka"), certificates)
    broker.start()
    yield broker
    broker.stop()


@pytest.fixture
def kafka(kafka_of_session: KafkaBroker) -> KafkaBroker:
    """The broker that tests share: each may stop it."""
    if kafka_of_session.program is None:
        kafka_of_session.start()
    return kafka_of_session


@pytest.fixture(scope="session")
def mosquitto_of_session(tmp_path_factory: pytest.TempPathFactory, certificates: Certificates) -> Iterator[Mosquitto]:
    broker = Mosquitto(tmp_path_factory.mktemp("mosquitto"), certificates)
    broker.start()
    yield broker
    broker.stop()


@pytest.fixture
def mosquitto(mosquitto_of_session: Mosquitto) -> Mosquitto:
    """The broker that tests share: each may stop it."""
    if mosquitto_of_session.program is None:
        mosquitto_of_session.start()
    return mosquitto_of_session
