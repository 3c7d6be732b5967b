"""Data read back from Kafka: recordings, replays, histories."""

from __future__ import annotations

import json
import subprocess
import time
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from bridges import Bridge, Schema
from kafka_broker import KafkaBroker
from ports import free_ports
from processes import Program, until
from readers import KafkaWriter
from robots import SHORT, Robot, ask, published
from ways import KafkaWay, of, read_until

Start = Callable[..., Bridge]


def read(
    binary: Path, kafka: KafkaBroker, name: str, command: str, *options: str
) -> subprocess.CompletedProcess:
    """Runs `iiwasim replay` or `history` on the messages of a test."""
    source = ["--kafka", kafka.address(), "--kafka-prefix", name]
    whole = [binary, command, *source, *options]
    return subprocess.run(whole, check=False, capture_output=True, text=True, timeout=120)


def recorded(path: Path) -> list[tuple[float, list[float]]]:
    """Times in s since the beginning, and joint positions."""
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        found = [
            (message.log_time / 1e9, list(state.position))
            for *_, message, state in reader.iter_decoded_messages(["/joint_states"])
        ]
    return [(at - found[0][0], joints) for at, joints in found]


@pytest.fixture
def stored(
    kafka: KafkaBroker, bridge: Start, quick_robot: Robot, name: str
) -> list[dict[str, Any]]:
    """Samples of a run in Kafka."""
    with KafkaWay(kafka, name) as way:
        passing = bridge(quick_robot, *way.options)
        read_until(way, lambda: of(way, "joints"), "joints are passed on")
        quick_robot.run_motions(SHORT)
        read_until(way, lambda: len(of(way, "run")) == 2, "the run is passed on")
        passing.end()
        last = of(way, "joints")[-1]["seq"]

        def is_all() -> bool:
            nonlocal last
            before, last = last, of(way, "joints")[-1]["seq"]
            return before == last

        read_until(way, is_all, "all is read", every_s=1.0)
        return of(way, "joints")


def test_replay_is_a_recording(
    stored: list[dict[str, Any]], binary: Path, kafka: KafkaBroker, name: str, tmp_path: Path
) -> None:
    whole, part = tmp_path / "whole.mcap", tmp_path / "part.mcap"
    done = read(binary, kafka, name, "replay", "--name", name, "-o", str(whole))
    assert done.returncode == 0, done.stderr
    found = recorded(whole)
    assert len(found) == len(stored)
    begin = stored[0]["t_s"]
    for (at, joints), sample in zip(found, stored):
        assert joints == sample["joints_rad"]
        assert at == pytest.approx(sample["t_s"] - begin, abs=1e-6)
    middle = stored[len(stored) // 2]["at"]
    done = read(binary, kafka, name, "replay", "--name", name, "--from", middle, "-o", str(part))
    assert done.returncode == 0, done.stderr
    expected = [sample["joints_rad"] for sample in stored if sample["at"] >= middle]
    assert [joints for _, joints in recorded(part)] == expected
    done = read(
        binary,
        kafka,
        name,
        "replay",
        "--name",
        name,
        "--until",
        middle,
        "-o",
        str(part),
        "--overwrite",
    )
    assert len(recorded(part)) == len(stored) - len(expected)
    # Existing files are not replaced without an option, and empty data does not create a file.
    assert read(binary, kafka, name, "replay", "--name", name, "-o", str(part)).returncode != 0
    none = read(
        binary, kafka, name, "replay", "--name", "nobody", "-o", str(tmp_path / "none.mcap")
    )
    assert none.returncode == 1 and "nobody" in none.stderr
    assert not (tmp_path / "none.mcap").exists()


def test_replay_is_a_drive(
    stored: list[dict[str, Any]], binary: Path, kafka: KafkaBroker, name: str, tmp_path: Path
) -> None:
    """Monitoring clients can follow a replay like a drive, but cannot move it."""
    drive, stream = (f"127.0.0.1:{port}" for port in free_ports(2))
    options = [
        "--kafka",
        kafka.address(),
        "--kafka-prefix",
        name,
        "--name",
        name,
        "--serve",
        "--speed",
        "0.2",
    ]
    command = [str(binary), "replay", *options, "--drive", drive, "--stream", stream]
    replay = Program(command, tmp_path / "replay.log")
    try:
        with published(stream) as samples:
            for type, more in (
                ("run_motions", {"motions": SHORT["motions"]}),
                ("set_io", {"name": "a", "value": 1}),
            ):
                reply = ask(drive, type, **more)
                assert not reply["ok"], reply
                print(reply)
            assert ask(drive, "state")["ok"]
            until(lambda: not replay.runs(), "the replay ends", patience_s=120)
        assert replay.wait() == 0, replay.said()
    finally:
        replay.end()
    played = {json.dumps(sample["joints_rad"]) for sample in samples}
    assert len(samples) > 100
    assert played <= {json.dumps(sample["joints_rad"]) for sample in stored}


def end_of_run(
    name: str, number: int, cycle_time_s: float, planned_s: float | None, **more: Any
) -> dict[str, Any]:
    """The bridge message for the end of a run."""
    plan = {} if planned_s is None else {"plan": {"cycle_time_s": planned_s, "limited_by": []}}
    at = datetime.now(UTC).isoformat(timespec="microseconds").replace("+00:00", "Z")
    head = {
        "version": 1,
        "robot": name,
        "session": 1,
        "seq": number,
        "at": at,
        "kind": "run",
        "t_s": float(number),
    }
    run = {"run": number, "event": "end", "what": "motions", "program": "weld", **plan}
    return {**head, **run, "result": {"cycle_time_s": cycle_time_s}, **more}


def write(kafka: KafkaBroker, name: str, *bodies: bytes | None, **settings: str) -> None:
    writer = KafkaWriter(kafka.address(), **settings)
    for body in bodies:
        writer.write(f"{name}.run", body, name.encode())
    writer.flush()


@pytest.mark.parametrize(("slower", "planned"), [(1.0, 2.0), (1.05, 2.0), (1.05, None)])
def test_drift_is_found(
    kafka: KafkaBroker,
    binary: Path,
    schema: Schema,
    name: str,
    slower: float,
    planned: float | None,
) -> None:
    runs = [end_of_run(name, i, 2.0 * (slower if i >= 15 else 1.0), planned) for i in range(20)]
    write(kafka, name, *(json.dumps(schema.check(run)).encode() for run in runs))
    done = read(binary, kafka, name, "history", "--max-drift", "2", "--json")
    (program,) = json.loads(done.stdout)["programs"]
    assert len(program["runs"]) == 20
    assert program["drift"]["percent"] == pytest.approx(100 * (slower - 1), abs=1e-6)
    assert done.returncode == (3 if slower > 1.02 else 0), done.stderr


def test_edited_program_does_not_drift(kafka: KafkaBroker, binary: Path, name: str) -> None:
    runs = [end_of_run(name, i, 2.0 + (i >= 15), 2.0 + (i >= 15)) for i in range(20)]
    write(kafka, name, *(json.dumps(run).encode() for run in runs))
    done = read(binary, kafka, name, "history", "--max-drift", "2")
    assert done.returncode == 0, done.stderr
    assert "weld" in done.stdout


def test_repeated_and_foreign_records_do_not_count(
    kafka: KafkaBroker, binary: Path, name: str
) -> None:
    """Repeated records count once; foreign records are reported and ignored."""
    runs = [json.dumps(end_of_run(name, i, 2.0, 2.0)).encode() for i in range(10)]
    write(kafka, name, *runs[:5], *runs[2:7])
    write(
        kafka,
        name,
        b"",
        None,
        b"\xff\xfe",
        b"{",
        b"[" * 50_000,
        b'{"version": 2}',
        compression_type="zstd",
    )
    write(kafka, name, *runs[7:], compression_type="lz4")
    time.sleep(0.5)
    done = read(binary, kafka, name, "history", "--json")
    print(done.stdout[-2000:], done.stderr)
    (program,) = json.loads(done.stdout)["programs"]
    assert [run["run"] for run in program["runs"]] == list(range(10))
    assert "could not be read" in done.stderr


def test_history_of_nothing(kafka: KafkaBroker, binary: Path, name: str) -> None:
    done = read(binary, kafka, name, "history")
    print(done.returncode, done.stdout, done.stderr)
    assert "panic" not in done.stderr
