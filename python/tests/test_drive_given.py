"""The drive client reports invalid arguments before it sends a request."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("zmq", reason="the client of the drive needs pyzmq")

import iiwasim as iw
from iiwasim.drive import Drive

RESTING = {"motions": [iw.wait(0)]}


@pytest.fixture
def drive(monkeypatch: pytest.MonkeyPatch) -> Drive:
    """A `Drive` that cannot connect."""

    def connect(*_: object) -> None:
        pytest.fail("it connects")

    monkeypatch.setattr(Drive, "_line", connect)
    return Drive("127.0.0.1:5560")


@pytest.mark.parametrize("address", [5560, b"127.0.0.1:5560", Path("127.0.0.1:5560")])
def test_addresses_are_texts(address: Any) -> None:
    with pytest.raises(TypeError, match=r"is not an address: give HOST:PORT, as .* as a str"):
        Drive(address)
    with pytest.raises(TypeError, match="is not an address"):
        Drive("127.0.0.1:5560", stream=address)


@pytest.mark.parametrize("on_sample", [3, 0, "print", []])
def test_what_takes_samples_is_callable(drive: Drive, on_sample: Any) -> None:
    with pytest.raises(
        TypeError, match=r"on_sample is .*; a function of a JointSample is expected"
    ):
        drive.run(RESTING, on_sample=on_sample)
    with pytest.raises(TypeError, match="on_sample is "):
        drive.run_trajectory([0.0, 0.01], np.zeros((2, 7)), on_sample=on_sample)


@pytest.mark.parametrize("is_repeated", [False, True])
def test_programs_with_signals_are_refused_before_the_robot_moves(
    drive: Drive, is_repeated: bool
) -> None:
    entry: dict[str, Any] = {"type": "set", "io": "Gripper.Close", "value": True}
    if is_repeated:
        entry = {"type": "repeat", "count": 2, "motions": [entry]}
    program = {"start": {"joints_deg": [0] * 7}, "motions": [iw.wait(0), entry]}
    with pytest.raises(ValueError, match=r"has an input or output \(set 'Gripper.Close'\)"):
        drive.run(program, move_to_start=True)


def test_programs_are_no_files_and_no_lists(drive: Drive) -> None:
    with pytest.raises(
        ValueError,
        match=r"is not JSON: .*line 1 column 1.*; a str is taken .* iiwasim\.Program\.load",
    ):
        drive.run("program.json")
    for program in ([iw.ptp(deg=[0] * 7)], [], Path("program.json"), b"{}", 3):
        with pytest.raises(
            TypeError, match=rf"iiwasim\.Program, .*; found {type(program).__name__}$"
        ):
            drive.run(program)  # type: ignore[arg-type]
