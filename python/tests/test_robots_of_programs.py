"""Programs keep their robot."""

from __future__ import annotations

import json
import pickle
import subprocess
from pathlib import Path

import numpy as np
import pytest
from simulated_robot import binary

import iiwasim as iw

HOME = [0, 30, 0, -60, 0, 90, 0]


def gentle(name: str = "lbr_iiwa_7_r800") -> iw.Robot:
    """A robot with other limits."""
    profile = json.loads(iw.Robot().profile())
    profile["velocity_limit_deg_s"] = [40] * 7
    profile["name"] = name
    return iw.Robot.from_profile(json.dumps(profile))


def swing(robot: iw.Robot | None = None) -> iw.Program:
    return iw.Program([iw.ptp(deg=[60, 30, 0, -60, 0, 90, 0])], start_deg=HOME, robot=robot)


@pytest.mark.parametrize(
    "program",
    [
        swing(gentle()),
        swing(gentle("gentle")),
        swing(iw.Robot(flange_m=0.126)),
        swing(iw.Robot("lbr_iiwa_14_r820")),
        iw.plan(swing(), robot=gentle()).program,
        iw.plan(swing(), robot="lbr_iiwa_14_r820").program,
        iw.plan(swing(), limit_torque_percent=60).program,
    ],
    ids=["limits", "name", "flange", "built-in", "planned", "planned for another", "torques"],
)
def test_a_saved_program_takes_as_long(program: iw.Program, tmp_path: Path) -> None:
    file = tmp_path / "cell.json"
    program.save(file)
    again = iw.Program.load(file)
    expected = iw.plan(program)
    assert iw.plan(again).cycle_time_s == expected.cycle_time_s
    assert np.array_equal(iw.plan(again).at(0.3).q, expected.at(0.3).q)
    # A built-in robot does not need a profile.
    is_built_in = again.robot in (iw.Robot(), iw.Robot("lbr_iiwa_14_r820"))
    assert (
        sorted(it.name for it in tmp_path.iterdir())
        == ["cell-robot.json", "cell.json"][is_built_in:]
    )


def test_the_command_plans_what_was_saved(tmp_path: Path) -> None:
    program = swing(gentle("gentle"))
    program.save(tmp_path / "cell.json")
    command = [binary(), "plan", tmp_path / "cell.json", "--no-output", "--json"]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    assert json.loads(done.stdout)["cycle_time_s"] == iw.plan(program).cycle_time_s


def test_a_start_at_a_frame_is_that_of_the_robot() -> None:
    short = iw.Robot(flange_m=0.126)
    program = iw.Program([iw.wait(1)], start_frame=short.frame(np.radians(HOME)), robot=short)
    assert np.allclose(program.start_rad, np.radians(HOME), atol=1e-9)
    assert not np.allclose(
        iw.Program.from_json(program.to_json()).start_rad, program.start_rad, atol=1e-3
    )
    far = {"x_mm": 5000, "y_mm": 0, "z_mm": 0, "a_deg": 0, "b_deg": 0, "c_deg": 0}
    with pytest.raises(iw.ProgramError, match="start"):
        iw.Program([iw.wait(1)], start_frame=far).start_rad  # noqa: B018


def test_robots_are_equal_to_their_copies() -> None:
    for robot in (iw.Robot(), gentle(), iw.Robot(flange_m=0.126), iw.Robot("lbr_iiwa_14_r820")):
        assert pickle.loads(pickle.dumps(robot)) == robot
        assert iw.Robot.from_profile(robot.profile()).name == robot.name
        program = swing(robot)
        assert len({program, pickle.loads(pickle.dumps(program))}) == 1
    assert gentle() != iw.Robot() and iw.Robot(flange_m=0.126) != iw.Robot()
