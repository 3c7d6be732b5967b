"""Messages of the bridge on any broker: complete, unique by their number, and in order."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from bridges import Bridge, Schema
from kafka_broker import KafkaBroker
from messages import KINDS, check_numbers, check_times, without_repetitions
from mosquitto import Mosquitto
from processes import until
from robots import LONG, SHORT, Robot
from ways import KafkaWay, MqttWay, Way, of, read_until

Start = Callable[..., Bridge]


def test_each_kind_is_passed_on(
    way: Way, bridge: Start, simulated_robot: Robot, schema: Schema, name: str
) -> None:
    robot = simulated_robot
    bridge(robot, *way.options)
    read_until(way, lambda: of(way, "joints"), "joints are passed on")
    with robot.samples() as published:
        figures = robot.run_motions(SHORT)
        until(robot.is_idle, "the run has ended")
    read_until(
        way,
        lambda: [it for it in of(way, "run") if it["event"] == "end"],
        "the end of the run is passed on",
    )
    robot.ask("set_io", name="MediaFlange.LEDBlue", value=True)

    def lit() -> list[bool]:
        last = (of(way, "io") or [{"io": []}])[-1]
        return [signal["value"] for signal in last["io"] if signal["name"] == "MediaFlange.LEDBlue"]

    read_until(way, lambda: lit() == [True], "the lamp is passed on")
    robot.ask("set_io", name="MediaFlange.LEDBlue", value=False)
    read_until(way, lambda: lit() == [False], "the lamp is passed on")
    read_until(way, lambda: all(of(way, kind) for kind in KINDS), "there is a message of each kind")
    read_until(
        way,
        lambda: of(way, "joints")[-1]["t_s"] >= published[-1]["t_s"],
        "all samples are passed on",
    )

    for message in way.read:
        schema.check(message)
        assert message["robot"] == name
    assert check_numbers(way.read, may_lack=way.may_lack) == 0

    begin, end = of(way, "run")
    assert (begin["event"], end["event"], begin["what"]) == ("begin", "end", "motions")
    assert begin["run"] == end["run"]
    assert begin["plan"]["cycle_time_s"] == pytest.approx(figures["planned_cycle_time_s"], abs=1e-9)
    assert end["result"]["cycle_time_s"] == pytest.approx(
        figures["robot_program_cycle_time_s"], abs=1e-9
    )
    assert "error" not in end["result"]
    assert [message["state"] for message in of(way, "state")][-2:] == ["running_motion", "idle"]

    passed_on = {message["t_s"]: message["joints_rad"] for message in of(way, "joints")}
    other = [
        sample["t_s"]
        for sample in published
        if passed_on.get(sample["t_s"]) != sample["joints_rad"]
    ]
    assert not other, (
        f"{len(other)} of {len(published)} samples are not as the drive published them"
    )
    conditions = of(way, "conditions")[-1]
    assert conditions["drive"] == conditions["robot_program"] == "connected"
    assert conditions["simulated"]
    assert len(of(way, "sensors")[-1]["external_torque_nm"]) == 7


def test_stopped_run_is_told(
    way: Way, bridge: Start, simulated_robot: Robot, schema: Schema, name: str
) -> None:
    robot = simulated_robot
    bridge(robot, *way.options)
    read_until(way, lambda: of(way, "joints"), "joints are passed on")
    run = robot.start_run(LONG)
    read_until(way, lambda: len(of(way, "run")) > 0, "the beginning is passed on")
    robot.stop()
    run.wait()
    read_until(way, lambda: of(way, "run")[-1]["event"] == "end", "the end is passed on")
    end = schema.check(of(way, "run")[-1])
    assert end["result"]["error"]["code"] == "robot"
    assert "stopped" in end["result"]["error"]["message"]


@pytest.mark.parametrize("gently", [True, False], ids=["stopped", "killed"])
def test_nothing_is_lost_with_the_broker(
    way: Way,
    bridge: Start,
    quick_robot: Robot,
    name: str,
    gently: bool,
    request: pytest.FixtureRequest,
) -> None:
    """Every sample at 1 kHz and every run event arrives, although the broker stops three times."""
    if isinstance(way, MqttWay) and not gently:
        pytest.skip("mosquitto forgets what it has acknowledged when it is killed")
    robot = quick_robot
    passing = bridge(robot, *way.options)
    read_until(way, lambda: of(way, "joints"), "joints are passed on")
    memory, runs = [], 0
    with robot.samples() as published:
        first = published[0]["t_s"]
        run = robot.start_run(LONG)
        for _ in range(3):
            way.broker.stop() if gently else way.broker.kill()
            memory.append(passing.memory_kb())
            # A run begins and ends while the broker is stopped.
            run.wait(120)
            robot.run_motions(SHORT)
            runs += 2
            memory.append(passing.memory_kb())
            run = robot.start_run(LONG)
            way.broker.start()
            so_far = published[-1]["t_s"]
            read_until(
                way,
                lambda so_far=so_far: of(way, "joints")[-1]["t_s"] >= so_far,
                "the rest is passed on",
            )
            memory.append(passing.memory_kb())
        run.wait(120)
        runs += 1
        last = published[-1]["t_s"]
    read_until(way, lambda: of(way, "joints")[-1]["t_s"] >= last, "all samples are passed on")
    read_until(
        way,
        lambda: len(without_repetitions(of(way, "run"))[0]) >= 2 * runs,
        "all runs are passed on",
    )

    repeated = check_numbers(way.read, may_lack=way.may_lack)
    samples, _ = without_repetitions(of(way, "joints"))
    missing = check_times(samples, 0.001)
    passed_on = {message["t_s"] for message in samples}
    lost = [
        sample["t_s"]
        for sample in published
        if first <= sample["t_s"] <= last and sample["t_s"] not in passed_on
    ]
    assert "joints" in way.may_lack or not lost, (
        f"{len(lost)} of {len(published)} samples, the first at {lost[0]} s"
    )
    events = [
        (message["run"], message["event"]) for message in without_repetitions(of(way, "run"))[0]
    ]
    assert len(events) == 2 * runs
    assert all(
        a[0] == b[0] and (a[1], b[1]) == ("begin", "end") for a, b in zip(events[::2], events[1::2])
    )
    # Queued messages are on the disk. At the first measurement, buffers and heap have reached their
    # size.
    assert max(memory) < memory[0] + 30_000, memory
    lost_and_late = robot.lost_and_late()
    print(
        f"{request.node.name}: {len(samples)} samples, {repeated} repeated, {missing} cycles "
        "missing,"
        f" memory {min(memory)} to {max(memory)} kB, lost and late {lost_and_late}"
    )


def test_broker_that_answers_nothing_is_waited_for(
    way: Way, bridge: Start, quick_robot: Robot, name: str
) -> None:
    robot = quick_robot
    passing = bridge(robot, *way.options)
    read_until(way, lambda: of(way, "joints"), "joints are passed on")
    way.broker.pause()
    try:
        robot.run_motions(SHORT)
        before = passing.memory_kb()
        robot.run_motions(LONG)
        assert passing.memory_kb() < before + 30_000
    finally:
        way.broker.resume()
    last = robot.state()["t_s"]
    read_until(way, lambda: of(way, "joints")[-1]["t_s"] >= last, "all samples are passed on")
    read_until(
        way, lambda: len(without_repetitions(of(way, "run"))[0]) >= 4, "both runs are passed on"
    )
    check_numbers(way.read, may_lack=way.may_lack)


def test_bridge_begins_without_a_broker(
    way: Way, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    robot = simulated_robot
    way.broker.stop()
    try:
        bridge(robot, *way.options)
        # The bridge follows the robot before it has a broker; some of the run has to be queued.
        time.sleep(3)
        robot.run_motions(SHORT)
    finally:
        way.broker.start()
    read_until(way, lambda: len(of(way, "run")) >= 2, "the run is passed on")
    check_numbers(way.read, may_lack=way.may_lack)


def test_killed_bridge_continues(
    way: Way, bridge: Start, simulated_robot: Robot, name: str, tmp_path: Path
) -> None:
    """Messages queued for a stopped broker are sent by the next bridge, which numbers its own from
    0.
    """
    robot = simulated_robot
    options = [*way.options, "--spool", str(tmp_path / "spool")]
    first = bridge(robot, *options)
    read_until(way, lambda: of(way, "joints"), "joints are passed on")
    way.broker.stop()
    try:
        robot.run_motions(SHORT)
        # The last few ms may be lost with the process.
        before = robot.state()["t_s"]
        until(lambda: robot.state()["t_s"] > before + 2, "the robot goes on")
        first.kill()
        bridge(robot, *options)
    finally:
        way.broker.start()
    read_until(
        way,
        lambda: len({message["session"] for message in way.read}) == 2,
        "the second one passes on",
    )
    read_until(
        way, lambda: len(without_repetitions(of(way, "run"))[0]) >= 2, "the run is passed on"
    )
    check_numbers(way.read, may_lack=way.may_lack)
    sessions = [message["session"] for message in without_repetitions(of(way, "joints"))[0]]
    assert sessions == sorted(sessions)
    if "joints" not in way.may_lack:
        assert (
            max(
                message["t_s"] for message in of(way, "joints") if message["session"] == sessions[0]
            )
            >= before
        )


def test_drive_may_go_away(
    way: Way, bridge: Start, tmp_path: Path, binary: Path, name: str
) -> None:
    with Robot(binary, tmp_path / "own") as robot:
        bridge(robot, *way.options)
        read_until(way, lambda: of(way, "joints"), "joints are passed on")
        robot.drive.terminate()
        robot.drive.wait(30)
        read_until(
            way,
            lambda: of(way, "conditions")[-1]["drive"] == "silent",
            "it is told that the drive is silent",
        )
        robot.start_drive()
        robot.wait_until_ready()
        read_until(
            way,
            lambda: of(way, "conditions")[-1]["drive"] == "connected",
            "it is told that the drive is back",
        )
        robot.run_motions(SHORT)
        read_until(way, lambda: len(of(way, "run")) >= 2, "the run is passed on")
        check_numbers(way.read, may_lack=way.may_lack)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=["ctrl-c", "terminated"])
def test_it_ends_when_asked(
    way: Way, bridge: Start, simulated_robot: Robot, name: str, number: int
) -> None:
    passing = bridge(simulated_robot, *way.options)
    read_until(way, lambda: of(way, "joints"), "joints are passed on")
    passing.send(number)
    assert passing.wait(30) in (0, 1, -number), passing.said()
    assert "panic" not in passing.said()


def test_it_ends_when_asked_without_a_broker(
    way: Way, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    passing = bridge(simulated_robot, *way.options)
    read_until(way, lambda: of(way, "joints"), "joints are passed on")
    way.broker.stop()
    time.sleep(1)
    began = time.monotonic()
    passing.send(signal.SIGTERM)
    passing.wait(30)
    print(f"{way.label}: ended {time.monotonic() - began:.1f} s after it was asked to")
    assert "panic" not in passing.said()


def test_both_at_once(
    kafka: KafkaBroker, mosquitto: Mosquitto, bridge: Start, quick_robot: Robot, name: str
) -> None:
    """A stopped broker does not block the other one."""
    with KafkaWay(kafka, name) as one, MqttWay(mosquitto, name) as other:
        others = [
            option for option in other.options if option not in ("--name", "--mqtt-client", name)
        ]
        bridge(quick_robot, *one.options, *others, "--mqtt-client", name)
        for way in (one, other):
            read_until(way, lambda way=way: of(way, "joints"), "joints are passed on")
        mosquitto.stop()
        try:
            quick_robot.run_motions(SHORT)
            read_until(one, lambda: len(of(one, "run")) == 2, "Kafka has the run")
        finally:
            mosquitto.start()
        read_until(
            other, lambda: len(without_repetitions(of(other, "run"))[0]) == 2, "MQTT has the run"
        )
        check_numbers(one.read)
        check_numbers(other.read, may_lack=other.may_lack)
