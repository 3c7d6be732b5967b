"""The fastest order of tasks, and the fastest robot base position."""

from __future__ import annotations

import json

import numpy as np
import pytest
from programs import FIXTURES

import iiwasim as iw


def screws() -> iw.Program:
    return iw.Program.load(FIXTURES / "screws.json")


def pick_and_place() -> iw.Program:
    return iw.Program.load(FIXTURES / "pick-and-place.json")


def test_the_program_in_the_fastest_order_takes_as_long_as_stated() -> None:
    order = iw.order(screws())
    planned = iw.plan(order.program).cycle_time_s
    assert planned == pytest.approx(order.changed_cycle_time_s, abs=1e-9)
    assert planned < 0.96 * order.cycle_time_s
    assert sorted(order.tasks) == [f"screw {number}" for number in range(1, 9)]
    motions = json.loads(order.program.to_json())["motions"]
    assert [motion["group"] for motion in motions[:-1:4]] == order.tasks
    assert order.complete
    assert "8 tasks" in repr(order)


def test_tasks_of_a_program_are_given_as_dicts() -> None:
    turns = {"left": 60, "right": -40, "left again": 55}
    motions = [iw.ptp(deg=[turn, 30, 0, -60, 0, 90, 0], group=name) for name, turn in turns.items()]
    motions.append(iw.ptp(deg=[-60, 30, 0, -60, 0, 90, 0]))
    start_deg = [0, 30, 0, -60, 0, 90, 0]
    tasks: list[dict[str, object]] = [{"group": name} for name in turns]
    order = iw.order(iw.Program(motions, start_deg=start_deg, tasks=tasks))
    assert order.tasks == ["left", "left again", "right"]
    tasks[2]["after"] = ["right"]
    order = iw.order(iw.Program(motions, start_deg=start_deg, tasks=tasks))
    assert order.tasks.index("right") < order.tasks.index("left again")
    with pytest.raises(iw.ProgramError, match="middle"):
        iw.Program(motions, start_deg=start_deg, tasks=[{"group": "middle"}])


def test_the_order_keeps_clearances() -> None:
    post = {"type": "box", "name": "post", "size_mm": [40, 40, 170], "center_mm": [550, 0, 175]}
    scene = iw.Scene.from_json(json.dumps({"version": 1, "obstacles": [post]}))
    near = iw.order(screws(), scene=scene)
    far = iw.order(screws(), scene=scene, min_clearance_mm=150)
    assert near.tasks != far.tasks
    assert near.changed_cycle_time_s < far.changed_cycle_time_s < far.cycle_time_s


def test_a_program_without_tasks_stays_as_it_is() -> None:
    program = pick_and_place()
    order = iw.order(program)
    assert order.program == program
    assert order.tasks == []


def test_the_program_at_the_best_place_takes_as_long_as_stated() -> None:
    program = pick_and_place()
    places = iw.place(program, x_mm=(-50, 50), y_mm=(0, 20), steps=2)
    assert places.places.shape == (4, 4)
    assert places.places[:, 0] == pytest.approx([-50, 50, -50, 50])
    assert places.best is not None
    assert places.best[0] == pytest.approx(-50)
    planned = iw.plan(places.program).cycle_time_s
    assert planned == pytest.approx(places.changed_cycle_time_s, abs=1e-9)
    assert planned <= places.cycle_times_s.min() < places.cycle_time_s
    assert "4 places" in repr(places)


def test_places_out_of_reach_have_no_time() -> None:
    places = iw.place(pick_and_place(), x_mm=(-2000, 2000), y_mm=0, steps=2)
    assert np.isnan(places.cycle_times_s).all()
    assert places.best is None
    assert places.program == pick_and_place()


def test_a_robot_on_a_wall_does_not_turn() -> None:
    program = pick_and_place()
    wall = iw.Program.from_json(
        program.to_json().replace(
            '"version": 1,', '"version": 1, "mount": {"rpy_deg": [0, 90, 0]},'
        )
    )
    with pytest.raises(ValueError, match="yaw_deg turns a robot"):
        iw.place(wall, x_mm=0, y_mm=0, yaw_deg=(0, 9), steps=2)
    assert iw.place(wall, x_mm=0, y_mm=0, yaw_deg=0).cycle_time_s > 0


def scene_with_wall(x_mm: float) -> iw.Scene:
    """A scene with a wall behind the robot."""
    wall = {"name": "wall", "type": "plane", "point_mm": [x_mm, 0, 0], "normal": [1, 0, 0]}
    return iw.Scene.from_json(json.dumps({"version": 1, "obstacles": [wall]}))


def test_places_too_near_to_a_wall_are_marked() -> None:
    program = pick_and_place()
    free = iw.place(program, x_mm=(-100, 100), y_mm=0)
    assert free.best is not None and free.best[0] == pytest.approx(-100)
    assert not free.too_near.any()
    scene = scene_with_wall(-200)
    near = iw.place(program, x_mm=(-100, 100), y_mm=0, scene=scene)
    assert near.too_near.tolist() == [True, False, False, False, False]
    assert near.cycle_times_s == pytest.approx(free.cycle_times_s)
    # The base has a radius of 115 mm.
    assert near.best is not None and -75.2 <= near.best[0] <= -50
    planned = iw.plan(near.program).cycle_time_s
    assert planned == pytest.approx(near.changed_cycle_time_s, abs=1e-9)
    wide = iw.place(program, x_mm=(-100, 100), y_mm=0, scene=scene, min_clearance_mm=50)
    assert wide.too_near.tolist() == [True, True, False, False, False]


def test_obstacles_that_move_with_the_robot_keep_their_clearance() -> None:
    program = pick_and_place()
    scene = scene_with_wall(-200)
    moving = iw.place(program, x_mm=(-100, 100), y_mm=0, scene=scene, with_robot=["wall"])
    assert not moving.too_near.any()
    assert moving.best == iw.place(program, x_mm=(-100, 100), y_mm=0).best


def test_progress_of_places_is_reported() -> None:
    seen: list[int] = []
    places = iw.place(pick_and_place(), steps=25, progress=seen.append)
    assert seen and seen == sorted(seen)
    assert all(plans <= places.plans for plans in seen)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"x_mm": (1, -1)}, "x_mm is"),
        ({"yaw_deg": float("inf")}, "yaw_deg is"),
        ({"steps": 1}, "steps is 1"),
        ({"z_mm": (0, 1), "yaw_deg": (0, 1), "steps": 100}, "100000000 places"),
        ({"with_robot": ["wall"]}, "give their scene"),
        ({"scene": scene_with_wall(-200), "with_robot": ["door"]}, "`wall` is known"),
        ({"scene": scene_with_wall(-200), "min_clearance_mm": -1}, "min_clearance_mm is -1"),
    ],
)
def test_wrong_ranges_are_named(options: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        iw.place(pick_and_place(), **options)  # type: ignore[arg-type]
