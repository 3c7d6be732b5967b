"""Programs of the tests."""

from __future__ import annotations

from pathlib import Path

import iiwasim as iw

FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"
PROGRAMS = ["appendix-b.json", "ten-motions.json", "waits-and-stops.json", "pick-and-place.json"]


def swing(deg: float = 30.0, **options: object) -> iw.Program:
    """A PTP motion of A1 and A4."""
    motions = [iw.ptp(deg=[deg, 0, 0, -deg, 0, 0, 0])]
    return iw.Program(motions, start_deg=[0] * 7, **options)  # type: ignore[arg-type]
