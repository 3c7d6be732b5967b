"""Requests that the drive client or the drive refuses, and invalid replies."""

from __future__ import annotations

import json
import math
import pickle
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np
import pytest

zmq = pytest.importorskip("zmq", reason="the client of the drive needs pyzmq")

from drive_runs import AWAY, HOME, SLOW, go, in_background, program, rise

from iiwasim.drive import Drive, DriveError

if TYPE_CHECKING:
    from collections.abc import Iterator


@pytest.mark.parametrize(
    ("motion", "code", "says"),
    [
        ({"type": "ptp", "joints_deg": AWAY, "speed": 1}, "bad_request", "motion 1: .*speed"),
        ({"type": "fly"}, "bad_request", "unknown type `fly`"),
        ({"type": "ptp", "joints_deg": [0, 0, 0, -500, 0, 0, 0]}, "limit", "A4 is at -500 deg"),
        ({"type": "lin_rel", "offset": {"z_mm": 900}}, "limit", "motion 1"),
    ],
)
def test_what_the_drive_refuses_is_raised(
    drive: Drive, motion: dict[str, object], code: str, says: str
) -> None:
    with pytest.raises(DriveError, match=says) as refused:
        drive.run({"motions": [motion]})
    assert refused.value.code == code and refused.value.run is None
    assert str(refused.value) == f"{refused.value.message} ({code})"
    copied = pickle.loads(pickle.dumps(refused.value))
    assert (type(copied), copied.code, copied.message) == (DriveError, code, refused.value.message)


def test_too_fast_a_trajectory_is_refused(drive: Drive) -> None:
    with pytest.raises(DriveError, match="A1") as refused:
        drive.run_trajectory(*rise(2.0), move_to_start=True)
    assert refused.value.code == "limit"


def test_a_start_out_of_reach_is_told(drive: Drive) -> None:
    with pytest.raises(DriveError, match=r"the robot did not move to the start: .*A4") as refused:
        drive.run(program(HOME, start=[0, 0, 0, 130, 0, 0, 0]), move_to_start=True)
    assert refused.value.code == "limit"


def test_threads_share_a_drive(drive: Drive) -> None:
    with in_background(drive.run, SLOW, move_to_start=True), ThreadPoolExecutor(8) as threads:
        states = list(threads.map(lambda _: drive.state().state, range(100)))
        drive.stop()
    assert states == ["running_motion"] * 100


def test_only_one_run_is_on(drive: Drive) -> None:
    go(drive, HOME)
    with in_background(drive.run, SLOW) as results:
        for request in (
            lambda: drive.run(program(AWAY)),
            lambda: drive.run({"motions": [{"type": "wait", "seconds": 1}]}),
            drive.sensors,
            lambda: drive.get_io("MediaFlange.LEDBlue"),
        ):
            with pytest.raises(DriveError) as refused:
                request()
            assert refused.value.code == "not_idle"
        assert drive.state().state == "running_motion" and not results
        drive.stop()


@pytest.mark.parametrize(
    ("bad", "says"),
    [
        ({**program(AWAY), "include": "cell.json"}, "includes 'cell.json'.*Program.load"),
        (program(AWAY, start=[0, 0]), r"the start's joints_deg .* found \[0.0, 0.0\]"),
        ({"start": {}, "motions": []}, "start"),
        ({"motions": [{"type": "wait", "seconds": math.nan}]}, "not JSON compliant"),
        (
            {"motions": [{"type": "wait", "seconds": 1}] * 200_000},
            "bytes, and a drive takes 4194304",
        ),
        ("{", "line 1"),
    ],
)
def test_what_is_no_program_is_a_value_error(drive: Drive, bad: object, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        drive.run(bad)


def test_what_is_no_trajectory_is_a_value_error(drive: Drive) -> None:
    t, q = rise(0.1)
    for times, points, says in [
        (t, q[:, :6], r"\(101, 6\)"),
        (t[:3], q, r"\(3,\)"),
        (t, q * np.nan, "finite"),
        ([], [], "0"),
    ]:
        with pytest.raises(ValueError, match=says):
            drive.run_trajectory(times, points)
    with pytest.raises(ValueError, match="no start"):
        drive.run({"motions": []}, move_to_start=True)


@contextmanager
def answering(text: bytes) -> Iterator[Drive]:
    """A drive that gives the same answer to all requests."""
    with zmq.Context() as context, context.socket(zmq.REP) as socket:
        socket.linger = 0
        port = socket.bind_to_random_port("tcp://127.0.0.1")
        ended = threading.Event()

        def answer() -> None:
            while not ended.is_set():
                if socket.poll(20):
                    socket.recv()
                    socket.send(text)

        thread = threading.Thread(target=answer)
        thread.start()
        try:
            with Drive(f"127.0.0.1:{port}") as drive:
                yield drive
        finally:
            ended.set()
            thread.join()


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"{",
        b"\xff",
        b"[]",
        b"{}",
        b'{"ok": true}',
        b'{"ok": false}',
        b'{"ok": false, "error": "no"}',
        (
            b'{"ok": true, "state": "idle", "joints_rad": [1], "t_s": 1, '
            b'"robot_program": "silent", "fri": {}}'
        ),
        b'{"ok": true, "samples": {"t_s": [1], "joints_rad": [[1]]}}',
        b"[" * 100_000,
    ],
)
def test_answers_that_are_none_are_errors(text: bytes) -> None:
    with answering(text) as drive:
        for request in (drive.state, drive.last_run, drive.sensors, drive.list_io):
            with pytest.raises(DriveError, match="invalid reply of the drive"):
                request()


def test_what_slows_or_hides_the_robot_is_told() -> None:
    fri = {"session": "monitoring_ready", "quality": "good", "lost": 0, "late": 0, "later": 1}
    state = {
        "ok": True,
        "state": "idle",
        "joints_rad": HOME,
        "t_s": 1.0,
        "fri": fri,
        "robot_program": "connected",
    }
    state["conditions"] = {"operation_mode": "t1", "override": 0.305}
    with answering(json.dumps(state).encode()) as drive:
        slowed = pytest.warns(
            RuntimeWarning, match=r"override is 30\.5 %, and the operation mode is T1"
        )
        with slowed, pytest.raises(DriveError, match="not at the program's start"):
            drive.run(program(HOME, start=AWAY))
    fri.update(session="silent", unexpected_source="10.0.0.9")
    with (
        answering(json.dumps(state).encode()) as drive,
        pytest.raises(DriveError, match=r"from 10\.0\.0\.9"),
    ):
        drive.run(program(AWAY))
    state["state"] = "running_motion"
    with (
        answering(json.dumps(state).encode()) as drive,
        pytest.raises(DriveError, match="busy") as busy,
    ):
        drive.run(program(AWAY))
    assert busy.value.code == "not_idle"
