"""Faster programs: their plans, clearances, progress and errors."""

from __future__ import annotations

import pytest
from programs import FIXTURES

import iiwasim as iw

ALL = ("e1", "blends", "speeds")


def pick_and_place() -> iw.Program:
    return iw.Program.load(FIXTURES / "pick-and-place.json")


def test_the_changed_program_takes_as_long_as_stated() -> None:
    program = pick_and_place()
    optimum = iw.optimise(program, free=ALL)
    assert optimum.cycle_time_s == pytest.approx(iw.plan(program).cycle_time_s, abs=1e-9)
    planned = iw.plan(optimum.program).cycle_time_s
    assert planned == pytest.approx(optimum.changed_cycle_time_s, abs=1e-9)
    assert planned < 0.85 * optimum.cycle_time_s
    assert optimum.complete
    assert all(line.startswith("motion ") for line in optimum.changes)
    assert "Optimum" in repr(optimum)


def test_what_is_not_free_stays() -> None:
    program = iw.Program.load(FIXTURES / "ten-motions.json")
    optimum = iw.optimise(program)
    assert optimum.changes == []
    assert optimum.changed_cycle_time_s == optimum.cycle_time_s


def test_clearances_are_kept_in_a_scene() -> None:
    program = pick_and_place()
    scene = iw.Scene.load(FIXTURES / "cage.json")
    optimum = iw.optimise(program, free=ALL, scene=scene, min_clearance_mm=1000)

    def nearest(program: iw.Program) -> float:
        clearance = iw.plan(program).clearance(scene)
        assert clearance is not None
        return clearance.distance_m

    assert nearest(optimum.program) > nearest(program) - 2e-4


def test_progress_is_reported() -> None:
    seen: list[int] = []
    cell = iw.Program.load(FIXTURES / "sunrise/cell/expected.json")
    optimum = iw.optimise(cell, free=ALL, progress=seen.append)
    assert seen
    assert seen == sorted(seen)
    assert all(plans <= optimum.plans for plans in seen)


def test_an_error_of_progress_ends_the_search() -> None:
    def fail(_: int) -> None:
        raise RuntimeError("enough")

    cell = iw.Program.load(FIXTURES / "sunrise/cell/expected.json")
    with pytest.raises(RuntimeError, match="enough"):
        iw.optimise(cell, free=ALL, progress=fail)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"free": ["order"]}, "free has 'order'; 'e1', 'blends', 'speeds' are known"),
        ({"max_blend_mm": -1}, "max_blend_mm is -1"),
        ({"min_clearance_mm": float("nan")}, "min_clearance_mm is NaN"),
        ({"timing": "fast"}, "timing is 'fast'"),
    ],
)
def test_wrong_options_are_named(options: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        iw.optimise(pick_and_place(), **options)  # type: ignore[arg-type]
