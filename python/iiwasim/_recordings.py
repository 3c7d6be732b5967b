"""Recordings of any origin, held against plans."""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Any

from . import _native
from ._native import Comparison, Identification, Plan, Recording

if TYPE_CHECKING:
    from .drive import Run


def recording_of(measured: Recording | Run | str | PathLike[str]) -> Recording:
    """A recording, of a file if that is what it is."""
    if isinstance(measured, Recording):
        return measured
    if isinstance(measured, (str, PathLike)):
        return Recording.load(measured)
    return Recording(measured.t, measured.q, cycle_time_s=getattr(measured, "cycle_time_s", None))


def compare(plan: Plan | str | PathLike[str], measured: Recording | Run | str | PathLike[str], /) -> Comparison:
    """Holds a plan against what the robot did: in time, on the path and, where there are any, in torques.

    `plan` is a plan or the path of its MCAP file, `measured` a recording, a run of a drive, or the path of a file.
    Raises `RecordingError` where the recording is not of this program.

    >>> import iiwasim as iw
    >>> plan = iw.plan(iw.Program([iw.ptp(deg=[30] + [0] * 6)], start_deg=[0] * 7))
    >>> samples = plan.sample(rate_hz=250)
    >>> measured = iw.Recording(samples.t, samples.q)
    >>> abs(iw.compare(plan, measured).cycle_time_error_s) < 0.01
    True
    """
    return _native.compare(plan, recording_of(measured))


def identified(recordings: list[Recording], options: dict[str, Any]) -> Identification:
    """What was identified and pickled."""
    return _native.identify(recordings, **options)
