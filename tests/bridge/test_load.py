"""CPU load of the bridge: measured without bounds, which would depend on the machine."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

from bridges import Bridge
from kafka_broker import KafkaBroker
from messages import check_numbers
from rig import cpu_s
from robots import LONG, Robot
from ways import KafkaWay, of, read_until

Start = Callable[..., Bridge]

SECONDS = 10


def load(passing: Bridge, way: KafkaWay) -> str:
    """Measures the load over some seconds, and checks that all received messages arrive."""
    way.take()
    used_s, began_s, before = cpu_s(passing.pid), time.monotonic(), len(of(way, "joints"))
    while time.monotonic() < began_s + SECONDS:
        way.take()
        time.sleep(0.1)
    took_s = time.monotonic() - began_s
    share = 100 * (cpu_s(passing.pid) - used_s) / took_s
    rate = (len(of(way, "joints")) - before) / took_s
    check_numbers(way.read)
    return (
        f"{share:.1f} % of a core for {rate:.0f} samples a second, "
        f"{passing.memory_kb() / 1000:.0f} MB"
    )


def test_load_of_a_robot_at_1_khz(
    kafka: KafkaBroker, bridge: Start, quick_robot: Robot, name: str
) -> None:
    with KafkaWay(kafka, name) as way:
        passing = bridge(quick_robot, *way.options)
        run = quick_robot.start_run(LONG)
        read_until(way, lambda: of(way, "run"), "the beginning is passed on")
        print(f"Load, one robot at 1 kHz: {load(passing, way)}")
        assert run.wait() == 0


def test_load_of_ten_robots(
    kafka: KafkaBroker, bridge: Start, binary: Path, tmp_path: Path, name: str
) -> None:
    """Ten robots on one bridge, in one set of topics."""
    with ExitStack() as stack, KafkaWay(kafka, name) as way:
        first, *others = [
            stack.enter_context(Robot(binary, tmp_path / f"robot-{i}", "--period", "5"))
            for i in range(10)
        ]
        added = [
            f"--add={name}-{i}={robot.address},{robot.stream}" for i, robot in enumerate(others)
        ]
        passing = bridge(first, *way.options, *added)

        def are_all_there() -> bool:
            counts = Counter(message["robot"] for message in of(way, "joints"))
            return len(counts) == 10 and min(counts.values()) > 100

        read_until(way, are_all_there, "all robots are passed on")
        print(f"Load, ten robots at 200 Hz: {load(passing, way)}")
