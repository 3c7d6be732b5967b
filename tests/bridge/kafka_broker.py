"""A Kafka broker on this machine: one node, broker and controller at once."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

from confluent_kafka import KafkaException
from confluent_kafka.admin import AdminClient

from broker import Broker
from certificates import Certificates
from ports import free_ports
from processes import REPOSITORY

CLUSTER = "iiwasim-tests-bridge00"
USER, PASSWORD = "robot", "let me in"
# Listeners and their protocols. One listener requires client certificates; clients have to refuse
# the certificates of the last two listeners.
LISTENERS = {
    "PLAINTEXT": "PLAINTEXT",
    "SASL_PLAINTEXT": "SASL_PLAINTEXT",
    "SASL_SSL": "SASL_SSL",
    "SSL": "SSL",
    "MUTUAL": "SSL",
    "MISNAMED": "SSL",
    "EXPIRED": "SSL",
}
# Options for a fast start: runs are too short for an optimising compiler to pay off.
JAVA = [
    "java",
    "-Xmx256m",
    "-Xms64m",
    "-XX:+UseSerialGC",
    "-XX:TieredStopAtLevel=1",
    "-Xshare:auto",
]
MECHANISMS = ("PLAIN", "SCRAM-SHA-256", "SCRAM-SHA-512")


def fetch_jars(folder: Path | None = None) -> Path:
    """The folder with the broker's jars; Maven fetches missing jars.

    Without `folder`, the environment variable `IIWASIM_KAFKA` names the folder; its default is the
    folder of CI.
    """
    folder = (
        folder or Path(os.environ.get("IIWASIM_KAFKA", REPOSITORY / "target/ci/kafka")).resolve()
    )
    pom = Path(__file__).parent / "kafka/pom.xml"
    # The versions of the fetched jars: if the pins have changed, the jars are fetched again.
    fetched = folder / "pom.xml"
    if not fetched.exists() or fetched.read_bytes() != pom.read_bytes():
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        subprocess.run(
            ["mvn", "-B", "-q", "-f", pom, f"-Djars={folder}", "package"], check=True, timeout=600
        )
        shutil.copy(pom, fetched)
    return folder


class KafkaBroker(Broker):
    """A node that is both broker and controller."""

    label = "Kafka"

    def __init__(
        self, jars: Path, folder: Path, certificates: Certificates | None = None, **settings: str
    ) -> None:
        """Opens all LISTENERS with certificates, otherwise the listeners without TLS. Settings are
        as in server.properties, with _ in place of dots.
        """
        super().__init__(folder)
        self.jars = jars
        names = [
            name for name, protocol in LISTENERS.items() if certificates or "SSL" not in protocol
        ]
        *ports, controller = free_ports(len(names) + 1)
        self.addresses = {name: f"localhost:{port}" for name, port in zip(names, ports)}
        self.properties = folder / "server.properties"
        lines = self.settings(controller) | {
            key.replace("_", "."): value for key, value in settings.items()
        }
        if certificates:
            lines |= self.secured(certificates)
        self.properties.write_text("".join(f"{key}={value}\n" for key, value in lines.items()))
        self.format()

    def settings(self, controller: int) -> dict[str, str]:
        listeners = ",".join(f"{name}://{address}" for name, address in self.addresses.items())
        protocols = {
            **{name: LISTENERS[name] for name in self.addresses},
            "CONTROLLER": "PLAINTEXT",
        }
        return {
            "process.roles": "broker,controller",
            "node.id": "1",
            "controller.quorum.voters": f"1@localhost:{controller}",
            "controller.listener.names": "CONTROLLER",
            "listeners": f"{listeners},CONTROLLER://localhost:{controller}",
            "advertised.listeners": listeners,
            "listener.security.protocol.map": ",".join(
                f"{name}:{protocol}" for name, protocol in protocols.items()
            ),
            "inter.broker.listener.name": "PLAINTEXT",
            "log.dirs": str(self.folder / "data"),
            "group.initial.rebalance.delay.ms": "0",
            # After a kill, the restart waits until the old session has timed out.
            "broker.session.timeout.ms": "3000",
            "broker.heartbeat.interval.ms": "500",
            # A single broker, without replicas to wait for.
            "offsets.topic.replication.factor": "1",
            "share.coordinator.state.topic.replication.factor": "1",
            "share.coordinator.state.topic.min.isr": "1",
            "transaction.state.log.replication.factor": "1",
            "transaction.state.log.min.isr": "1",
            "offsets.topic.num.partitions": "1",
            "transaction.state.log.num.partitions": "1",
            "share.coordinator.state.topic.num.partitions": "1",
            "sasl.enabled.mechanisms": ",".join(MECHANISMS),
            **self.passwords(),
        }

    def passwords(self) -> dict[str, str]:
        """Users of PLAIN; the users of SCRAM are written by `format`."""
        plain = (
            f"org.apache.kafka.common.security.plain.PlainLoginModule required "
            f'user_{USER}="{PASSWORD}";'
        )
        scram = "org.apache.kafka.common.security.scram.ScramLoginModule required;"
        return {
            f"listener.name.{name.lower()}.{mechanism.lower()}.sasl.jaas.config": plain
            if mechanism == "PLAIN"
            else scram
            for name in self.addresses
            if LISTENERS[name].startswith("SASL")
            for mechanism in MECHANISMS
        }

    def secured(self, certificates: Certificates) -> dict[str, str]:
        return {
            "ssl.keystore.type": "PEM",
            "ssl.keystore.location": str(certificates.server.both),
            "ssl.truststore.type": "PEM",
            "ssl.truststore.location": str(certificates.authority),
            "listener.name.mutual.ssl.client.auth": "required",
            "listener.name.misnamed.ssl.keystore.location": str(certificates.misnamed.both),
            "listener.name.expired.ssl.keystore.location": str(certificates.expired.both),
        }

    def format(self) -> None:
        command = ["format", "--cluster-id", CLUSTER, "--config", str(self.properties)]
        for mechanism in MECHANISMS[1:]:
            command += ["--add-scram", f'{mechanism}=[name="{USER}",password="{PASSWORD}"]']
        command = [*self.java(), "kafka.tools.StorageTool", *command]
        done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, done.stdout + done.stderr

    def java(self) -> list[str]:
        return [*JAVA, "-Dorg.slf4j.simpleLogger.defaultLogLevel=warn", "-cp", f"{self.jars}/*"]

    def address(self, listener: str = "PLAINTEXT") -> str:
        """Host and port."""
        return self.addresses[listener]

    def start(self) -> None:
        # A new client, because an old one delays its next attempt after failures.
        self.admin = AdminClient({"bootstrap.servers": self.address(), "log_level": 0})
        super().start()

    def command(self) -> list[str]:
        return [*self.java(), "kafka.Kafka", str(self.properties)]

    def answers(self) -> bool:
        try:
            return bool(self.admin.list_topics(timeout=1).brokers)
        except KafkaException:
            return False
