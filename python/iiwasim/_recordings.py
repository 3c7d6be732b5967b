"""Comparison of recordings from any source with plans."""

from __future__ import annotations

# Imported at run time, too: `typing.get_type_hints` needs these names.
from collections.abc import Iterable
from os import PathLike
from typing import Any

from . import _native
from ._native import Comparison, Identification, Plan, Program, Recording, Robot
from ._replies import Run


def recording_of(measured: Recording | Run | str | PathLike[str]) -> Recording:
    """Converts the path of a file, or a run, to a recording."""
    if isinstance(measured, Recording):
        return measured
    if isinstance(measured, (str, PathLike)):
        return Recording.load(measured)
    if not (hasattr(measured, "t") and hasattr(measured, "q")):
        found = type(measured).__name__
        raise TypeError(
            f"a Recording, a Run or the path of a file is expected, not an object of type {found}"
        )
    return Recording(measured.t, measured.q, cycle_time_s=getattr(measured, "cycle_time_s", None))


def compare(
    plan: Plan | str | PathLike[str], measured: Recording | Run | str | PathLike[str], /
) -> Comparison:
    """Compares a plan with a recording of the robot: time, path and, if recorded, torques.

    `plan` is a plan or the path of its MCAP file, `measured` a recording, a run of a drive, or the
    path of a file. Raises `RecordingError` if the recording is not of this program.

    >>> import iiwasim as iw
    >>> plan = iw.plan(iw.Program([iw.ptp(deg=[30] + [0] * 6)], start_deg=[0] * 7))
    >>> samples = plan.sample(rate_hz=250)
    >>> measured = iw.Recording(samples.t, samples.q)
    >>> abs(iw.compare(plan, measured).cycle_time_error_s) < 0.01
    True
    """
    return _native.compare(plan, recording_of(measured))


def identify(
    recordings: Iterable[Recording | Run | str | PathLike[str]],
    *,
    program: Program | None = None,
    robot: Robot | str | PathLike[str] | None = None,
    name: str = "identified",
) -> Identification:
    """Identifies limits, settling times, blends, loads and friction from recordings.

    Recordings may also be runs of a drive, or paths of files. `program` and `robot`, if given,
    replace the program and the robot that each recording contains. Raises `RecordingError` if a
    recording is not of its program.

    >>> import iiwasim as iw
    >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    >>> samples = iw.plan(program).sample(rate_hz=250)
    >>> found = iw.identify([iw.Recording(samples.t, samples.q, program=program)])
    >>> found.robot.name
    'identified'
    """
    if isinstance(recordings, (str, PathLike, Recording)):
        raise TypeError("recordings is one of them; give a list")
    return _native.identify(
        [recording_of(it) for it in recordings], program=program, robot=robot, name=name
    )


def identified(recordings: list[Recording], options: dict[str, Any]) -> Identification:
    """Restores a pickled identification."""
    return _native.identify(recordings, **options)
