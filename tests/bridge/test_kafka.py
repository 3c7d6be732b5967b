"""Features of Kafka: keys, partitions, batches, formats."""

from __future__ import annotations

import json
import struct
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from confluent_kafka.admin import AdminClient, NewTopic

from bridges import Bridge
from kafka_broker import KafkaBroker, fetch_jars
from messages import check_numbers, command, without_repetitions
from processes import until
from readers import KafkaReader, KafkaWriter
from robots import LONG, SHORT, Robot
from ways import KafkaWay, of, read_until, tells_losses

Start = Callable[..., Bridge]


def test_keys_and_times(
    kafka: KafkaBroker, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    with KafkaWay(kafka, name) as way:
        before = time.time()
        bridge(simulated_robot, *way.options)
        topic = way.topic("joints")
        way.reader.until(lambda: len(way.reader.of(topic)) > 100, "joints are passed on")
        for message in way.reader.messages:
            assert message.key() == name.encode()
            # Creation time: when the bridge received the sample.
            kind, at_ms = message.timestamp()
            assert kind == 1
            assert before - 60 < at_ms / 1000 < time.time() + 60
        assert not way.reader.of(topic)[0].headers()


def test_robots_keep_their_order_over_partitions(
    kafka: KafkaBroker,
    bridge: Start,
    binary: Path,
    tmp_path: Path,
    simulated_robot: Robot,
    name: str,
) -> None:
    """Two robots share topics with several partitions; each robot keeps the partition that Kafka's
    own clients choose.
    """
    admin = AdminClient({"bootstrap.servers": kafka.address()})
    with Robot(binary, tmp_path / "other") as other, KafkaWay(kafka, name) as way:
        topics = [NewTopic(way.topic(kind), 4, 1) for kind in ("joints", "run")]
        for made in admin.create_topics(topics).values():
            made.result(60)
        second = f"{name}-2"
        bridge(simulated_robot, *way.options, "--add", f"{second}={other.address},{other.stream}")
        topic = way.topic("joints")
        seen: dict[bytes, set[int]] = {}

        def both() -> bool:
            for message in way.reader.of(topic):
                seen.setdefault(message.key(), set()).add(message.partition())
            return len(seen) == 2

        way.reader.until(both, "both robots are passed on")
        assert all(len(partitions) == 1 for partitions in seen.values())
        other.run_motions(SHORT)
        read_until(way, lambda: len(of(way, "run")) == 2, "the run is passed on")
        assert {message["robot"] for message in of(way, "run")} == {second}
        for robot in (name, second):
            check_numbers(message for message in way.read if message["robot"] == robot)
        # Another producer puts the same key into the same partition.
        writer = KafkaWriter(kafka.address(), partitioner="murmur2_random")
        probe = way.topic("run")
        for key in seen:
            writer.write(probe, b'{"kind": "probe"}', key)
        writer.flush()
        with KafkaReader(kafka.address(), probe) as reader:
            reader.until(
                lambda: len([it for it in reader.of(probe) if b"probe" in it.value()]) == 2,
                "what was written is read",
            )
            probes = {it.key(): it.partition() for it in reader.of(probe) if b"probe" in it.value()}
        assert {key: {partition} for key, partition in probes.items()} == seen


@pytest.mark.parametrize("compression", ["none", "snappy", "gzip"])
def test_compressed_batches_are_read(
    kafka: KafkaBroker, bridge: Start, quick_robot: Robot, name: str, compression: str
) -> None:
    with KafkaWay(kafka, name) as way:
        bridge(quick_robot, *way.options, "--kafka-compression", compression)
        read_until(way, lambda: len(of(way, "joints")) > 2000, "joints are passed on")
        check_numbers(way.read)
        log = sum(
            file.stat().st_size for file in (kafka.folder / "data").glob(f"{name}.joints-*/*.log")
        )
        print(f"{compression}: {log / len(of(way, 'joints')):.0f} bytes a sample")


@pytest.mark.parametrize("form", ["protobuf", "cdr"])
def test_other_formats(
    kafka: KafkaBroker, bridge: Start, simulated_robot: Robot, name: str, form: str
) -> None:
    with KafkaWay(kafka, name) as way:
        bridge(simulated_robot, *way.options, "--joints", form)
        topic = way.topic("joints")
        way.reader.until(lambda: len(way.reader.of(topic)) > 20, "joints are passed on")
        expected = simulated_robot.joints()
        numbers = []
        for message in way.reader.of(topic):
            headers = dict(message.headers())
            numbers.append(int(headers["seq"]))
            read = (
                from_protobuf(message.value()) if form == "protobuf" else from_cdr(message.value())
            )
            assert read["robot"] == name
            assert read["joints_rad"] == pytest.approx(expected, abs=1e-6)
            if form == "protobuf":
                assert (read["seq"], read["session"]) == (
                    int(headers["seq"]),
                    int(headers["session"]),
                )
        assert numbers == list(range(len(numbers)))


def from_protobuf(payload: bytes) -> dict:
    """Decodes a message with the schema of the guide."""
    from sparkplug import compiled

    fields = {
        "version": (1, "uint32"),
        "robot": (2, "string"),
        "session": (3, "uint64"),
        "seq": (4, "uint64"),
    }
    fields |= {"at_us": (5, "uint64"), "t_s": (6, "double"), "joints_rad": (7, "double*")}
    fields |= {"measured_nm": (8, "double*"), "external_nm": (9, "double*")}
    message = compiled("Joints", {"Joints": fields}).FromString(payload)
    read = {field: getattr(message, field) for field in fields}
    return read | {"joints_rad": list(read["joints_rad"])}


def from_cdr(payload: bytes) -> dict:
    """Decodes `sensor_msgs/JointState` in little-endian CDR: numbers are aligned to their size,
    after a header of four bytes.
    """
    assert payload[:4] == b"\x00\x01\x00\x00"
    body, at = payload[4:], 0

    def take(form: str) -> float:
        nonlocal at
        size = struct.calcsize(form)
        at += -at % size
        (value,) = struct.unpack_from(f"<{form}", body, at)
        at += size
        return value

    def text() -> str:
        nonlocal at
        length = take("I")
        at += length
        return body[at - length : at - 1].decode()

    def doubles() -> list[float]:
        return [take("d") for _ in range(take("I"))]

    take("i"), take("I")
    robot = text()
    names = [text() for _ in range(take("I"))]
    assert len(names) == 7
    position, velocity, effort = doubles(), doubles(), doubles()
    assert velocity == [] and len(effort) in (0, 7) and at == len(body)
    return {"robot": robot, "joints_rad": position}


def test_broker_that_takes_less_at_a_time(
    bridge: Start, quick_robot: Robot, tmp_path: Path, name: str
) -> None:
    """The limit of the broker is far below the batch that the bridge collects during its stop."""
    small = KafkaBroker(fetch_jars(), tmp_path / "small", message_max_bytes="60000")
    with small as broker, KafkaWay(broker, name) as way:
        bridge(quick_robot, *way.options, "--kafka-compression", "none")
        read_until(way, lambda: of(way, "joints"), "joints are passed on")
        broker.stop()
        quick_robot.run_motions(SHORT)
        before = quick_robot.state()["t_s"]
        until(lambda: quick_robot.state()["t_s"] > before + 3, "the robot goes on")
        broker.start()
        read_until(way, lambda: of(way, "joints")[-1]["t_s"] > before + 3, "joints are passed on")
        check_numbers(way.read)


def test_message_that_is_too_large_is_left_out(
    kafka: KafkaBroker, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    """A message too large for its topic does not block others, and the bridge reports the loss."""
    admin = AdminClient({"bootstrap.servers": kafka.address()})
    with KafkaWay(kafka, name) as way:
        small = NewTopic(way.topic("run"), 1, 1, config={"max.message.bytes": "150"})
        admin.create_topics([small])[small.topic].result(60)
        passing = bridge(simulated_robot, *way.options)
        read_until(way, lambda: of(way, "joints"), "joints are passed on")
        simulated_robot.run_motions(SHORT)
        read_until(way, lambda: tells_losses(way, 2), "both events of the run are counted")
        assert "running_motion" in [message["state"] for message in of(way, "state")]
        assert not of(way, "run")
        assert passing.said().count("one message was left out") == 2


def test_full_spool_drops_the_oldest(
    kafka: KafkaBroker, bridge: Start, binary: Path, tmp_path: Path, name: str
) -> None:
    """The bridge reports the loss, keeps events, and sends the rest in order."""
    # A robot with fast cycles fills the minimum spool in reasonable time.
    with (
        Robot(binary, tmp_path / "fast", "--period", "1", "--speed", "10") as robot,
        KafkaWay(kafka, name) as way,
    ):
        passing = bridge(robot, *way.options, "--spool-mb", "64")
        read_until(way, lambda: of(way, "joints"), "joints are passed on")
        kafka.stop()
        robot.run_motions(SHORT)
        until(lambda: "the spool is full" in passing.said(), "the spool is full", patience_s=240)
        memory = passing.memory_kb()
        files = [
            file.stat().st_size for file in (tmp_path / "spool-0").rglob("*") if file.is_file()
        ]
        assert sum(files) < 70e6
        last = robot.state()["t_s"]
        # Stops the fast robot, which readers could not follow.
        robot.started[0].terminate()
        kafka.start()
        read_until(
            way,
            lambda: of(way, "joints")[-1]["t_s"] >= last,
            "joints are passed on",
            patience_s=240,
        )
        read_until(
            way, lambda: len(without_repetitions(of(way, "run"))[0]) == 2, "the run is passed on"
        )
        check_numbers(way.read, may_lack=["joints"])
        numbers = [message["seq"] for message in without_repetitions(of(way, "joints"))[0]]
        lacking = numbers[-1] + 1 - len(numbers)

        def told() -> bool:
            latest = of(way, "bridge")[-1]
            return latest["seq"] > 0 and latest["spools"]["kafka"]["bytes"] < 10e6

        read_until(way, told, "the bridge tells how it is")
        dropped = of(way, "bridge")[-1]["spools"]["kafka"]["dropped"]
        print(f"{lacking} samples lack, {dropped} were dropped, {memory} kB")
        assert lacking == dropped > 0


@pytest.mark.parametrize("codec", ["none", "gzip", "snappy", "lz4", "zstd"])
def test_commands_of_any_producer(
    kafka: KafkaBroker, bridge: Start, simulated_robot: Robot, name: str, codec: str
) -> None:
    """For any compression by producers, the bridge answers, or continues with the next command."""
    with KafkaWay(kafka, name) as way:
        bridge(simulated_robot, *way.options, "--allow-commands")
        read_until(way, lambda: of(way, "joints"), "joints are passed on")
        writer = KafkaWriter(kafka.address(), compression_type=codec)

        def answered(writer: KafkaWriter) -> bool:
            body = command(name, "state")
            writer.write(way.topic("request"), json.dumps(body).encode(), name.encode())
            writer.flush()
            end = time.monotonic() + 3
            while time.monotonic() < end:
                way.take()
                if any(reply.get("id") == body["id"] for reply in way.replies):
                    return True
            return False

        plain = KafkaWriter(kafka.address())
        until(lambda: answered(plain), "commands are taken")
        taken = answered(writer)
        print(f"{codec}: {'answered' if taken else 'not answered'}")
        until(lambda: answered(plain), "commands are taken")


def test_topics_that_are_deleted_come_again(
    kafka: KafkaBroker, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    admin = AdminClient({"bootstrap.servers": kafka.address()})
    with KafkaWay(kafka, name) as way:
        bridge(simulated_robot, *way.options)
        read_until(way, lambda: of(way, "joints"), "joints are passed on")
    for gone in admin.delete_topics([f"{name}.joints"]).values():
        gone.result(60)
    time.sleep(1)
    with KafkaWay(kafka, name) as way:
        read_until(way, lambda: of(way, "joints"), "joints are passed on again")


def test_latency(kafka: KafkaBroker, bridge: Start, quick_robot: Robot, name: str) -> None:
    """Latency from reception by the bridge to the reader: measured, without a bound."""
    with KafkaWay(kafka, name) as way:
        bridge(quick_robot, *way.options)
        read_until(way, lambda: of(way, "joints"), "joints are passed on")
        run = quick_robot.start_run(LONG)
        ages = []
        while run.runs():
            # One by one, as a reader that batches messages adds to their age.
            message = way.reader.consumer.poll(0.1)
            if message and not message.error() and message.topic() == way.topic("joints"):
                ages.append(time.time() - message.timestamp()[1] / 1000)
        run.wait()
        ages.sort()
        print(
            f"Kafka: {len(ages)} samples, {1000 * ages[len(ages) // 2]:.1f} ms old when read, at "
            f"most {1000 * ages[-1]:.0f}"
        )
        assert without_repetitions([])[1] == 0
