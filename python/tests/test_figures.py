"""Figures of many programs: what is no program, no option and no motion, and Ctrl-C.

`tests/cluster` has all else of them, on one machine and on many.
"""

from __future__ import annotations

import pytest

pytest.importorskip("pyarrow", reason="figures of many programs need pyarrow")

import iiwasim as iw
from iiwasim import batches

HOME = [0] * 7


def program(*degrees: float) -> iw.Program:
    """Turns of A1."""
    return iw.Program([iw.ptp(deg=[angle, *HOME[1:]]) for angle in degrees], start_deg=HOME)


@pytest.mark.parametrize("motion", [iw.load(1), iw.wait(0)], ids=["load", "wait"])
def test_programs_without_a_motion_have_no_peak(motion: iw.Motion) -> None:
    at_rest = iw.Program([motion], start_deg=HOME)
    rows = batches.figures([at_rest, program(10)]).to_pylist()
    assert [row["error"] for row in rows] == [None, None]
    assert rows[0]["cycle_time_s"] == iw.plan(at_rest).cycle_time_s
    assert rows[0]["peak_torque_percent"] is None and rows[0]["peak_torque_joint"] is None
    assert rows[1]["peak_torque_percent"] > 0
