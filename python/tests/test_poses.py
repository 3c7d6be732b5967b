"""TCPs of tools, poses (4, 4), and joint positions in degrees."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from programs import FIXTURES

import iiwasim as iw

if TYPE_CHECKING:
    from collections.abc import Callable

HOME = [0, 30, 0, -60, 0, 90, 0]
TOOL = {"x_mm": 20, "y_mm": -30, "z_mm": 120, "a_deg": 30, "b_deg": 20, "c_deg": -10}
BASE = {"x_mm": 500, "y_mm": -150, "z_mm": 100, "a_deg": 45, "b_deg": 5, "c_deg": 3}
RANDOM = np.random.default_rng(11)


def postures(count: int) -> np.ndarray:
    low, high = iw.Robot().position_limits_rad
    return RANDOM.uniform(0.9 * low, 0.9 * high, (count, 7))


def cell() -> iw.Program:
    return iw.Program(
        [iw.wait(1)],
        start_deg=HOME,
        tools={"gripper": {"tcp": TOOL}},
        bases={"table": BASE},
        tool="gripper",
        base="table",
    )


def test_poses_of_tools() -> None:
    robot, program, q = iw.Robot(), cell(), postures(40)
    flange = robot.pose(q)
    assert flange.shape == (40, 4, 4) and np.array_equal(flange[:, :3, 3], robot.flange(q))
    expected = np.linalg.inv(iw.pose(BASE)) @ flange @ iw.pose(TOOL)
    given: list[dict[str, Any]] = [
        {"program": program},
        {"program": program, "tool": "gripper", "base": "table"},
        {"tool": TOOL, "base": BASE},
        {"tool": iw.pose(TOOL), "base": iw.pose(BASE)},
    ]
    for places in given:
        assert robot.pose(q, **places) == pytest.approx(expected, abs=1e-12)
        position, rotation = robot.fk(q, **places)
        assert position == pytest.approx(expected[:, :3, 3], abs=1e-12)
        assert rotation == pytest.approx(expected[:, :3, :3], abs=1e-12)
        assert iw.pose(robot.frame(q[0], **places)) == pytest.approx(expected[0], abs=1e-9)
        again = robot.ik(expected[0], near=q[0], **places)
        assert again == pytest.approx(q[0], abs=1e-7)
        assert robot.ik(robot.frame(q[0], **places), **places) == pytest.approx(q[0], abs=1e-7)
    # The tool of a program is its own unless another one is named.
    bare = robot.pose(q, program=program, tool="flange", base="robot")
    assert np.array_equal(bare, flange)


def test_the_jacobian_of_a_tool() -> None:
    robot, step = iw.Robot(), 1e-6
    for q in postures(20):
        jacobian = robot.jacobian(q, tool=TOOL, base=BASE)
        for joint in range(7):
            by = step * np.eye(7)[joint]
            before, after = (
                robot.pose(joints, tool=TOOL, base=BASE) for joints in (q - by, q + by)
            )
            slope = (after - before) / (2 * step)
            spin = slope[:3, :3] @ robot.pose(q, tool=TOOL, base=BASE)[:3, :3].T
            assert np.abs(slope[:3, 3] - jacobian[:3, joint]).max() < 1e-8
            angular = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
            assert np.abs(angular - jacobian[3:, joint]).max() < 1e-8
    many = robot.jacobian(postures(5), program=cell())
    assert many.shape == (5, 6, 7)


def test_samples_have_the_whole_tcp() -> None:
    plan = iw.plan(iw.Program.load(FIXTURES / "pick-and-place.json"))
    samples = plan.sample(rate_hz=2000)
    assert np.array_equal(samples.tcp_pose[:, :3, 3], samples.tcp)
    q = samples.q
    expected = plan.robot.pose(q, program=plan.program, base="robot")
    in_gripper = np.isclose(np.linalg.norm(samples.tcp - plan.robot.flange(q), axis=1), 0.12)
    assert in_gripper.sum() > 1000
    assert np.abs(samples.tcp_pose - expected)[in_gripper].max() < 1e-12
    jacobian = plan.robot.jacobian(q, program=plan.program, base="robot")
    velocity = np.einsum("nij,nj->ni", jacobian, samples.dq)
    assert np.abs(samples.tcp_velocity - velocity)[in_gripper].max() < 1e-12
    assert samples.tcp_speed == pytest.approx(np.linalg.norm(samples.tcp_velocity[:, :3], axis=1))
    angular = np.linalg.norm(samples.tcp_velocity[:, 3:], axis=1)
    assert samples.tcp_angular_speed == pytest.approx(angular)
    # The speed is the derivative of the position.
    moved = np.linalg.norm(np.gradient(samples.tcp, samples.t, axis=0), axis=1)
    inner = in_gripper[:-2] & in_gripper[1:-1] & in_gripper[2:]
    assert np.abs(moved - samples.tcp_speed)[1:-1][inner].max() < 0.01


def test_poses_are_frames() -> None:
    frame = {"x_mm": 500, "y_mm": 0, "z_mm": 300, "a_deg": 0, "b_deg": 180, "c_deg": 0}
    pose = iw.pose(frame)
    assert iw.pose(iw.frame(pose)) == pytest.approx(pose, abs=1e-15)
    assert iw.frame(pose, e1_deg=5, status=2, turn=8)["turn"] == 8
    whole = {**iw.frame(pose), "e1_deg": 0, "status": 2}
    assert iw.frame(pose, e1_deg=0, status=2) == whole
    # E1, status, turn and base do not change the pose in the base of a frame.
    assert iw.pose({**whole, "base": "table"}) == pytest.approx(pose, abs=1e-15)
    lower = pose.copy()
    lower[2, 3] -= 0.05

    def planned(*poses: Any) -> iw.Program:
        first, second = poses
        return iw.Program(
            [iw.ptp(frame=whole), iw.lin(first), iw.spline([{"type": "spl", "frame": second}])],
            start_deg=HOME,
            frames={"low": first},
            tools={"tip": {"tcp": np.eye(4)}},
        )

    program = planned(lower, pose)
    assert program == planned(iw.frame(lower), iw.frame(pose))
    assert program.motions[1]["frame"] == program.frames["low"] == iw.frame(lower)
    assert set(program.tools) == {"tip"} and program.tool is None and program.bases == {}
    end = iw.plan(program).sample(rate_hz=100).tcp_pose[-1]
    assert end == pytest.approx(pose, abs=1e-9)


def test_frames_and_tools_are_read_back() -> None:
    program = iw.Program.load(FIXTURES / "pick-and-place.json")
    again = iw.Program(
        program.motions,
        start_rad=program.start_rad,
        frames=program.frames,
        tools=program.tools,
        bases=program.bases,
        tool=program.tool,
        base=program.base,
    )
    assert iw.plan(again).cycle_time_s == iw.plan(program).cycle_time_s
    program.frames["pick"]["x_mm"] = 1
    assert program.frames["pick"]["x_mm"] == 0


def rotated(matrix: Any) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = matrix
    return pose


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: iw.frame(np.eye(3)), "its shape is [3, 3]"),
        (lambda: iw.frame(rotated(2 * np.eye(3))), "is not a rotation matrix"),
        (lambda: iw.frame(rotated(np.diag([1, 1, -1]))), "is not a rotation matrix"),
        (lambda: iw.frame(np.full((4, 4), np.nan)), "not finite"),
        (lambda: iw.frame(np.eye(4)[::-1]), "its last row has to be [0, 0, 0, 1]"),
        (lambda: iw.frame("pick"), "pose is not a pose (4, 4): numbers are expected"),
        (lambda: iw.pose({"x": 1}), "frame: unknown key `x`"),
        (lambda: iw.Robot().fk(HOME, tool={"z": 1}), "tool: unknown key `z`"),
        (lambda: iw.Robot().fk(HOME, base=np.eye(3)), "base is not a pose (4, 4)"),
        (lambda: iw.Robot().fk(HOME, tool="gripper"), "unknown tool `gripper`"),
        (lambda: iw.Robot().ik(rotated(2 * np.eye(3)), near=[0] * 7), "frame is not a pose"),
    ],
)
def test_wrong_poses_are_refused(make: Callable[[], object], says: str) -> None:
    with pytest.raises(ValueError, match=re.escape(says)):
        make()


def test_a_tool_is_not_a_number() -> None:
    with pytest.raises(TypeError, match=r"of type int; a name, a dict .* or a pose"):
        iw.Robot().fk(HOME, tool=3)  # type: ignore[arg-type]


def test_degrees_are_refused() -> None:
    robot = iw.Robot()
    q = np.radians(HOME)
    plain = iw.frame(robot.pose(q))
    assert robot.ik(plain, near=q) == pytest.approx(q, abs=1e-9)
    says = "near is in rad, and outside the joint limits: joint A2 .* numpy.radians"
    with pytest.raises(ValueError, match=says):
        robot.ik(plain, near=HOME)
    with pytest.raises(ValueError, match="q is in rad, and outside the joint limits: joint A2"):
        robot.frame(HOME)
    # The advice is only for positions that are plausible in degrees.
    with pytest.raises(ValueError, match=r"its range is -120 to 120 deg$"):
        robot.ik(plain, near=[0, 1e4, 0, 0, 0, 0, 0])
