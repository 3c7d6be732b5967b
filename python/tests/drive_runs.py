"""Programs for the tests of the drive client, and runs in the background."""

from __future__ import annotations

import threading
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from iiwasim.drive import Drive, DriveError, JointSample

if TYPE_CHECKING:
    from collections.abc import Iterator

CYCLE_S = 0.005
HOME = [0, 0, 0, 0, 0, 0, 0]
AWAY = [6, 4, 0, -8, 0, 4, 0]


def program(*targets: list[float], start: list[float] = HOME, **keys: object) -> dict[str, object]:
    """A program of PTP motions from a start to targets, all in deg."""
    motions = [{"type": "ptp", "joints_deg": target, **keys} for target in targets]
    return {"version": 1, "start": {"joints_deg": start}, "motions": motions}


def go(drive: Drive, pose: list[float]) -> None:
    """Moves the robot to joint positions in deg."""
    drive.run({"motions": [{"type": "ptp", "joints_deg": pose}]})


def rise(to_rad: float, count: int = 101) -> tuple[np.ndarray, np.ndarray]:
    """A trajectory of joint 1 from zero within 1 s, at rest at both ends."""
    t = np.linspace(0.0, 1.0, count)
    q = np.zeros((count, 7))
    q[:, 0] = to_rad * t**4 * (35 - 84 * t + 70 * t**2 - 20 * t**3)
    return t, q


# A program that takes much longer than any test waits for it.
SLOW = program([60, 0, 0, -60, 0, 0, 0], velocity_rel=0.03)


@contextmanager
def in_background(run: object, *arguments: object, **keys: object) -> Iterator[list[object]]:
    """Starts a run in a separate thread and waits for motion; at the end, the list has its result
    or its exception.
    """
    results: list[object] = []
    samples: list[JointSample] = []
    has_begun = threading.Event()

    def watch(sample: JointSample) -> None:
        samples.append(sample)
        if np.abs(sample.q - samples[0].q).max() > 1e-3:
            has_begun.set()

    def target() -> None:
        try:
            results.append(run(*arguments, **keys, on_sample=watch))
        except DriveError as error:
            results.append(error)
        has_begun.set()

    thread = threading.Thread(target=target)
    thread.start()
    assert has_begun.wait(20)
    yield results
    thread.join(20)
    assert not thread.is_alive()
