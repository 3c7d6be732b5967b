"""Kinematics, dynamics, scenes and recordings."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import iiwasim as iw

FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"
HOME = [0, 30, 0, -60, 0, 90, 0]
RANDOM = np.random.default_rng(7)


def postures(count: int) -> np.ndarray:
    low, high = iw.Robot().position_limits_rad
    return RANDOM.uniform(0.9 * low, 0.9 * high, (count, 7))


def test_one_and_many_are_the_same() -> None:
    robot, q = iw.Robot(), postures(50)
    position, rotation = robot.fk(q)
    assert np.array_equal(robot.flange(q), position)
    for place in range(50):
        one = robot.fk(q[place])
        assert np.array_equal(one[0], position[place]) and np.array_equal(one[1], rotation[place])
    assert np.abs(rotation @ rotation.transpose(0, 2, 1) - np.eye(3)).max() < 1e-12


def test_the_jacobian_is_the_derivative() -> None:
    robot = iw.Robot()
    step = 1e-6
    for q in postures(20):
        jacobian = robot.jacobian(q)
        for joint in range(7):
            by = step * np.eye(7)[joint]
            slope = (robot.flange(q + by) - robot.flange(q - by)) / (2 * step)
            assert np.abs(slope - jacobian[:3, joint]).max() < 1e-8


def test_frames_and_joints_are_inverse() -> None:
    robot = iw.Robot("lbr_iiwa_14_r820")
    program = iw.Program.load(FIXTURES / "pick-and-place.json")
    for q in postures(50):
        assert np.abs(robot.ik(robot.frame(q)) - q).max() < 1e-7
        frame = robot.frame(q, program=program, tool="gripper/left", base="table")
        assert (
            np.abs(robot.ik(frame, program=program, tool="gripper/left", base="table") - q).max()
            < 1e-7
        )
    plain = {
        key: value
        for key, value in robot.frame(q).items()
        if key not in ("e1_deg", "status", "turn")
    }
    assert np.abs(robot.ik(plain, near=q) - q).max() < 1e-7
    with pytest.raises(ValueError, match="E1"):
        robot.ik(plain)
    with pytest.raises(ValueError, match="gripper2"):
        robot.ik(plain, near=q, program=program, tool="gripper2")
    assert robot.ik("pick", program=program).shape == (7,)


def test_torques_follow_from_the_mass_matrix() -> None:
    robot = iw.Robot()
    for q in postures(20):
        ddq = RANDOM.uniform(-5, 5, 7)
        inertia = robot.torques(q, ddq=ddq) - robot.torques(q)
        assert np.abs(robot.mass_matrix(q) @ ddq - inertia).max() < 1e-9
    held = {"mass_kg": 3.0, "center_mm": [0, 0, 100]}
    assert not np.array_equal(robot.torques(q, load=held), robot.torques(q))
    with pytest.raises(iw.ProgramError, match="mass_kg"):
        robot.torques(q, load={"mass": 3})
    with pytest.raises(ValueError, match="dq"):
        robot.torques(np.zeros((3, 7)), np.zeros((2, 7)))


@pytest.mark.parametrize(
    ("q", "says"),
    [
        (np.zeros((3, 6)), "shape"),
        (np.zeros((2, 2, 7)), "shape"),
        ([0, 0, 0, 0, 0, 0, np.nan], "not finite"),
        ([[0] * 7, [np.inf] + [0] * 6], "row 1"),
    ],
)
def test_wrong_arrays_are_refused(q: object, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        iw.Robot().flange(q)  # type: ignore[arg-type]


def test_arrays_of_all_kinds_are_taken() -> None:
    robot, q = iw.Robot(), postures(40)
    expected = robot.flange(q)
    assert np.array_equal(robot.flange(np.asfortranarray(q)), expected)
    assert np.array_equal(robot.flange(q[::2]), expected[::2])
    assert np.array_equal(robot.flange(q.tolist()), expected)
    assert np.allclose(robot.flange(q.astype(np.float32)), expected, atol=1e-6)
    assert robot.flange(np.zeros((0, 7))).shape == (0, 3)
    assert np.array_equal(robot.flange(np.zeros(7, dtype=int)), robot.flange(np.zeros(7)))


def test_clearances() -> None:
    scene = iw.Scene.load(FIXTURES / "cage.json")
    plan = iw.plan(
        iw.Program([iw.ptp(deg=[60, 40, 0, -60, 0, 40, 0])], start_deg=[-60, 40, 0, -60, 0, 40, 0])
    )
    near = plan.clearance(scene)
    assert near is not None and near.at_s is not None
    # The minimum over samples is not below the found minimum by more than its tolerance.
    least = min(
        found.distance_m
        for q in plan.sample(rate_hz=100).q
        if (found := scene.clearance(q)) is not None
    )
    assert near.distance_m <= least + 1e-9 and near.distance_m > least - 5e-3
    at = scene.clearance(plan.at(near.at_s).q)
    assert at is not None and at.distance_m == pytest.approx(near.distance_m, abs=1e-6)
    empty = iw.Scene.from_json('{"version": 1, "obstacles": []}')
    assert plan.clearance(empty) is None and plan.self_clearance(empty) is not None


def test_workpieces_count_in_clearances() -> None:
    rod = {"type": "cylinder", "center_mm": [0, 0, 200], "radius_mm": 10, "length_mm": 400}
    motions = [iw.ptp(deg=[30, 0, 0, -120, 0, 80, 0]), iw.ptp(deg=[0, 0, 0, -120, 0, 80, 0])]
    start = [0, 0, 0, -120, 0, 80, 0]
    bare = iw.plan(iw.Program(motions, start_deg=start))
    picked = iw.load(1, shapes=[rod])
    loaded = iw.plan(iw.Program([motions[0], picked, motions[1]], start_deg=start))
    floor = iw.Scene.from_json(
        '{"version": 1, "obstacles": [{"name": "floor", "type": "plane",'
        ' "point_mm": [0, 0, -1000], "normal": [0, 0, 1]}]}'
    )
    without, near = bare.clearance(floor), loaded.clearance(floor)
    assert without is not None and near is not None
    assert (near.link, near.obstacle) == (9, "floor")
    assert near.distance_m < without.distance_m
    itself, bare_itself = loaded.self_clearance(), bare.self_clearance()
    assert itself is not None and bare_itself is not None
    assert itself.distance_m <= bare_itself.distance_m


def test_recordings_are_held_against_plans(tmp_path: Path) -> None:
    plan = iw.plan(iw.Program.load(FIXTURES / "appendix-b.json"))
    samples = plan.sample(rate_hz=200)
    measured = iw.Recording(1.004 * samples.t, samples.q)
    comparison = iw.compare(plan, measured)
    assert comparison.cycle_time_error_percent == pytest.approx(-0.4, abs=0.1)
    plan.write(tmp_path / "plan.mcap")
    assert iw.compare(tmp_path / "plan.mcap", measured).measured_s == pytest.approx(
        comparison.measured_s
    )
    with pytest.raises(iw.RecordingError, match="not the same program"):
        iw.compare(plan, iw.Recording(samples.t, samples.q * 0.5))
    with pytest.raises(iw.RecordingError):
        iw.compare(FIXTURES / "appendix-b.json", measured)
    with pytest.raises(ValueError, match="increase"):
        iw.Recording([0, 1, 1], np.zeros((3, 7)))
    with pytest.raises(ValueError, match=r"\(3, 7\)"):
        iw.Recording([0, 1, 2], np.zeros((2, 7)))


def test_a_robot_is_identified() -> None:
    program = iw.Program.load(FIXTURES / "appendix-b.json")
    samples = iw.plan(program).sample(rate_hz=500)
    found = iw.identify([iw.Recording(samples.t, samples.q, program=program)], name="bench")
    assert found.robot.name == "bench" and "A6" in found.table()
    assert found.figures()["settle"] is not None or found.figures()["blends"]
    bend = [
        iw.ptp(deg=[30, 0, 0, -60, 0, 0, 0], blend_fraction=0.3),
        iw.ptp(deg=[0, 40, 0, -60, 0, 40, 0]),
    ]
    other = iw.Program(bend, start_deg=[0] * 7, robot="lbr_iiwa_14_r820")
    moved = iw.plan(other).sample(rate_hz=500)
    of_the_other = iw.identify([iw.Recording(moved.t, moved.q, program=other)])
    assert np.array_equal(
        of_the_other.robot.torque_limits_nm, iw.Robot("lbr_iiwa_14_r820").torque_limits_nm
    )
    with pytest.raises(ValueError, match="program"):
        iw.identify([iw.Recording(samples.t, samples.q)])
    with pytest.raises(ValueError, match="empty"):
        iw.identify([])


def test_what_is_not_identified_is_assumed() -> None:
    program = iw.Program([iw.ptp(deg=[40, 0, 0, 0, 0, 0, 0])], start_deg=[0] * 7)
    samples = iw.plan(program).sample(rate_hz=500)
    found = iw.identify([iw.Recording(samples.t, samples.q, program=program)]).robot
    assumed = found.assumptions
    # The masses are an assumption of the model, and remain one.
    assert any(line.startswith("masses: ") for line in assumed)
    assert (
        "velocity of A2, A3, A4, A5, A6, A7: not shown by the recordings; taken from "
        "lbr_iiwa_7_r800"
    ) in assumed
    assert any(line.startswith("friction: ") for line in assumed)
    for again in (pickle.loads(pickle.dumps(found)), iw.plan(program, robot=found).program.robot):
        assert again == found and again.assumptions == assumed
    # A profile does not contain assumptions.
    assert iw.Robot.from_profile(found.profile()) == found


def test_recordings_with_an_offset() -> None:
    plan = iw.plan(iw.Program([iw.ptp(deg=[40, *HOME[1:]]), iw.ptp(deg=HOME)], start_deg=HOME))
    samples = plan.sample(rate_hz=250)
    for offset in (-0.02, 0.02):
        shifted = samples.q + np.array([offset, 0, 0, 0, 0, 0, 0])
        comparison = iw.compare(plan, iw.Recording(samples.t, shifted))
        assert abs(comparison.cycle_time_error_s) < 1e-4
        assert comparison.max_deviation_mm == pytest.approx(12, abs=0.1)
        losses = comparison.figures()["losses"]
        assert sum("at rest 1.15 deg from the plan's" in loss for loss in losses) == 2
    shifted = samples.q - np.array([0.1, 0, 0, 0, 0, 0, 0])
    with pytest.raises(iw.RecordingError, match="is not at rest at the plan's start"):
        iw.compare(plan, iw.Recording(samples.t, shifted))


def test_robots_are_saved(tmp_path: Path) -> None:
    robot = iw.Robot("lbr_iiwa_14_r820", flange_m=0.126)
    robot.save(tmp_path / "mine.json")
    assert iw.Robot(tmp_path / "mine.json") == robot
    assert iw.plan(iw.Program([iw.wait(1)], start_deg=HOME, robot=tmp_path / "mine.json"))
    with pytest.raises(FileNotFoundError, match="none"):
        robot.save(tmp_path / "none" / "mine.json")


def test_sunrise_projects() -> None:
    program, told = iw.import_application(FIXTURES / "sunrise" / "joints")
    assert told["application"] == "application.ShelfScan" and iw.plan(program).cycle_time_s > 0
    with pytest.raises(iw.SunriseError, match=r"\.java"):
        iw.import_application(FIXTURES / "sunrise" / "refused" / "endless")
    with pytest.raises(FileNotFoundError):
        iw.applications(FIXTURES / "sunrise" / "no-such-project")
