"""Errors of programs that are made from arguments: they name the motion and the argument."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

import iiwasim as iw

HOME = [0, 30, 0, -60, 0, 90, 0]
FRAME = {"x_mm": 500, "y_mm": 0, "z_mm": 300, "a_deg": 0, "b_deg": 180, "c_deg": 0}
SPL = {"type": "spl", "frame": {**FRAME, "x_mm": "far"}}


@pytest.mark.parametrize(
    ("motions", "options", "says"),
    [
        ([iw.ptp(deg=[1, 2])], {}, "motion 1, deg: expected seven joint angles"),
        ([iw.ptp(rad=[1, 2])], {}, "motion 1, rad: expected seven joint angles"),
        ([iw.wait(1), iw.ptp(deg=HOME, velocity_rel=2)], {}, "motion 2: velocity_rel is 2; it"),
        ([iw.ptp(deg=HOME, jerk_rel=[1, 2])], {}, "motion 1, jerk_rel: expected seven shares"),
        ([iw.ptp(deg=HOME, blend_cart_mm="a")], {}, "motion 1, blend_cart_mm: expected a number"),
        ([iw.wait(-1)], {}, "motion 1, seconds: a wait of -1 s"),
        ([iw.lin({**FRAME, "x_mm": "far"})], {}, "motion 1, frame.x_mm: expected a number"),
        ([iw.lin({"x": 1, "y_mm": []})], {}, "motion 1, frame: unknown key `x`"),
        ([iw.lin_rel(x_mm="a")], {}, "motion 1, x_mm: expected a number"),
        ([iw.lin_rel(x_mm=1, within={"base": 3})], {}, "motion 1, within.base: expected"),
        ([iw.circ({"x_mm": []}, FRAME)], {}, "motion 1, aux.x_mm: expected a number"),
        ([iw.spline([SPL])], {}, "motion 1, segments[0].frame.x_mm: expected a number"),
        ([iw.wait(1), 3], {}, "motion 2: expected an object, found `3`"),
        ([iw.wait(1)], {"tools": {"a": {"tcp": {"z": 1}}}}, "tools.a.tcp: unknown key `z`"),
        ([iw.wait(1)], {"tools": {'"}': {"tcp": 3}}}, 'tools."}.tcp: expected an object'),
        ([iw.wait(1)], {"frames": {"a": {"x_mm": None}}}, "frames.a: `a`: `x_mm`, `y_mm`, `z_mm`"),
        ([iw.wait(1)], {"mode": "T2"}, "mode: unknown value `T2`"),
        ([iw.wait(1)], {"override_percent": 0}, "override_percent: an override of 0 %"),
        ([iw.wait(1)], {"start_deg": None, "start_frame": {"x": 1}}, "start_frame: unknown key"),
        ([], {}, "the program has no motions"),
    ],
)
def test_errors_name_the_argument(motions: Any, options: dict[str, Any], says: str) -> None:
    with pytest.raises(iw.ProgramError) as caught:
        iw.Program(motions, **{"start_deg": HOME, **options})
    error = caught.value
    assert str(error).startswith(says)
    assert "column" not in str(error) and error.line is None and error.column is None


def test_errors_of_changed_programs(tmp_path: Path) -> None:
    program = iw.Program([iw.wait(1)], start_deg=HOME)
    program.save(tmp_path / "wait.json")
    loaded = iw.Program.load(tmp_path / "wait.json")
    for own in (program, loaded):
        with pytest.raises(iw.ProgramError, match=r"^motion 2, deg: expected seven.* found 2$"):
            own.with_motions([iw.wait(1), iw.ptp(deg=[1, 2])])
        with pytest.raises(iw.ProgramError, match=r"^the start pose: .* deg$"):
            iw.plan(own.with_start(deg=[500, 0, 0, 0, 0, 0, 0]))
    (tmp_path / "wait.json").write_text(program.to_json().replace('"seconds": 1', '"seconds": -1'))
    with pytest.raises(iw.ProgramError, match="at line 1, column"):
        iw.Program.load(tmp_path / "wait.json")


def test_errors_of_frames_and_loads() -> None:
    robot = iw.Robot()
    with pytest.raises(iw.ProgramError, match=r"^frame: unknown key `x`"):
        robot.ik({"x": 1})
    with pytest.raises(iw.ProgramError, match=r"^frame.x_mm: expected a number"):
        robot.ik({"x_mm": "far"})
    with pytest.raises(iw.ProgramError, match=r"^load: unknown key `mass`"):
        robot.torques([0.0] * 7, load={"mass": 3})
    with pytest.raises(iw.ProgramError, match=r"^load.center_mm"):
        robot.torques([0.0] * 7, load={"mass_kg": 3, "center_mm": [1, 2]})


TYPED = """
import numpy as np
import iiwasim as iw

iw.ptp(deg=np.zeros(7), velocity_rel=np.ones(7))
iw.ptp(rad=(0.0,) * 7, jerk_rel=[1] * 7)
program = iw.Program([iw.lin(np.eye(4)), iw.load(1, center_mm=np.zeros(3))], start_deg=np.zeros(7))
plan = iw.plan(program, timing="jerk", blend_shape="alpha", blend_search="algorithm-1")
plan.at(0.5).q
plan.at([0.5]).motion.dtype
plan.at(np.zeros(3)).motion.dtype
iw.Robot().fk(np.zeros(7), program=program, tool=np.eye(4), base={"z_mm": 1})
iw.Recording.load("file", unit="deg", positions="commanded")
"""
WRONG = [
    'iw.plan(program, timing="jrek")',
    'iw.plan_all([program], blend_shape="round")',
    'iw.plan(program, blend_search="none")',
    'iw.Recording.load("file", unit="grad")',
    "iw.ptp(deg=3)",
    "iw.Robot().tcp(np.zeros(7))",
]


def test_types_agree_with_the_runtime(tmp_path: Path) -> None:
    api = pytest.importorskip("mypy.api")
    (tmp_path / "right.py").write_text(TYPED)
    (tmp_path / "wrong.py").write_text(TYPED + "\n".join(WRONG) + "\n")
    config = tmp_path / "mypy.ini"
    config.write_text(f"[mypy]\npython_version = 3.{max(10, sys.version_info[1])}\n")
    options = ["--config-file", str(config), "--cache-dir", str(tmp_path / "cache")]
    said, errors, _ = api.run([*options, str(tmp_path / "right.py"), str(tmp_path / "wrong.py")])
    assert not errors, errors
    lines = [line for line in said.splitlines() if ": error: " in line]
    first = TYPED.count("\n") + 1
    found = {int(line.split(".py:")[1].split(":")[0]) for line in lines}
    assert not [line for line in lines if "right.py" in line], said
    assert found == set(range(first, first + len(WRONG))), said
