"""Programs, plans and their samples."""

from __future__ import annotations

import copy
import json
import math
import os
import pickle
import shutil
from pathlib import Path
from typing import Any, Callable, TypeVar

import numpy as np
import pytest
from programs import FIXTURES, PROGRAMS, swing

import iiwasim as iw

JOINTS = FIXTURES / "sunrise/joints"


FRAME = ["x_mm", "y_mm", "z_mm", "a_deg", "b_deg", "c_deg"]


T = TypeVar("T")


@pytest.mark.parametrize("name", PROGRAMS)
@pytest.mark.parametrize("timing", ["jerk", "acceleration"])
def test_samples_are_the_plan(name: str, timing: str) -> None:
    plan = iw.plan(iw.Program.load(FIXTURES / name), timing=timing)
    samples = plan.sample(rate_hz=200)
    assert (
        len(samples) == len(samples.t) and samples.t[0] == 0 and samples.t[-1] == plan.cycle_time_s
    )
    for values in (samples.q, samples.dq, samples.ddq, samples.torque):
        assert (
            values.shape == (len(samples), 7)
            and values.dtype == np.float64
            and values.flags.c_contiguous
        )
    for place in range(0, len(samples), 37):
        state = plan.at(samples.t[place])
        assert np.array_equal(state.q, samples.q[place]) and np.array_equal(
            state.ddq, samples.ddq[place]
        )
        assert state.motion == samples.motion[place]
    # Velocities and accelerations are the derivatives of the positions.
    fine = plan.sample(rate_hz=2000)
    moved = np.gradient(fine.q, fine.t, axis=0, edge_order=2)
    assert np.abs(moved - fine.dq)[2:-2].max() < 0.02
    assert (np.abs(fine.dq) <= 1.001 * plan.robot.velocity_limits_rad_s).all()


@pytest.mark.parametrize("name", PROGRAMS)
def test_figures_fit_together(name: str) -> None:
    plan = iw.plan(iw.Program.load(FIXTURES / name))
    figures = plan.figures()
    assert figures["cycle_time_s"] == plan.cycle_time_s
    assert plan.cycle_time_s == pytest.approx(
        plan.motion_time_s + plan.settle_time_s + plan.wait_time_s, abs=1e-12
    )
    assert [motion.index for motion in plan.motions] == list(range(1, len(plan.program) + 1))
    assert all(motion.figures is not None and motion.time_s >= 0 for motion in plan.motions)
    # Motions end where the arm begins to settle.
    assert 0 <= plan.cycle_time_s - plan.motions[-1].end_s <= 0.05 + 1e-9
    assert f"{plan.cycle_time_s:.3f}" in plan.table() and f"{plan.cycle_time_s:.3f}" in repr(plan)


def test_states_at_several_times() -> None:
    plan = iw.plan(swing())
    times = np.array([-1.0, 0.1, 0.3, 99.0])
    for given in (times, times.tolist(), times[::1]):
        states = plan.at(given)
        assert states.q.shape == (4, 7) and np.array_equal(states.t_s, times)
        for row, time in enumerate(times):
            one = plan.at(time)
            for name in ("q", "dq", "ddq", "dddq"):
                assert np.array_equal(getattr(states, name)[row], getattr(one, name))
            assert states.motion[row] == one.motion
    assert plan.at(np.array(0.3)).q.shape == (7,) and plan.at(np.array([0.3])).q.shape == (1, 7)
    assert plan.at([]).q.shape == (0, 7)
    with pytest.raises(ValueError, match=r"t_s\[1\] is NaN"):
        plan.at([0.0, math.nan])
    with pytest.raises(ValueError, match="t_s is NaN"):
        plan.at(math.nan)


def test_equal_plans() -> None:
    plan = iw.plan(swing())
    same = [iw.plan(swing()), pickle.loads(pickle.dumps(plan)), iw.plan(plan.program)]
    assert all(again == plan and hash(again) == hash(plan) for again in same)
    others = [
        iw.plan(swing(31)),
        iw.plan(swing(), timing="jerk"),
        iw.plan(swing(), samples=50),
        iw.plan(swing(), blend_shape="circle"),
        iw.plan(swing(), override_percent=50),
        iw.plan(swing(), robot="lbr_iiwa_14_r820"),
    ]
    assert all(other != plan for other in others) and plan != "plan"
    assert len({plan, *same, *others}) == 1 + len(others)


def test_motions_are_computed_once() -> None:
    plan = iw.plan(swing())
    assert plan.motions is plan.motions and plan.motions[0].figures == plan.figures()["motions"][0]


def test_the_tcp_is_the_tool() -> None:
    plan = iw.plan(iw.Program.load(FIXTURES / "pick-and-place.json"))
    samples = plan.sample(rate_hz=100)
    flange = plan.robot.flange(samples.q)
    # The tip of the gripper is 120 mm in front of the flange, and the other TCP 40 mm to its side.
    distance = np.linalg.norm(samples.tcp - flange, axis=1)
    assert set(np.round(1e3 * distance, 6)) == {120.0, round(float(np.hypot(120, 40)), 6)}


def test_logs_of_a_data_recorder(tmp_path: Path) -> None:
    names = [
        f"{kind}_LBR_iiwa_7_R800_1[{j}]" for kind in ("axisQMsr", "axisQCmdT1m") for j in range(7)
    ]
    row = "0 0 0 1 0 0 0"
    log = tmp_path / "recorder.log"
    log.write_text(
        f"% ZeitInSec ZeitInNanoSec {' '.join(names)}\n"
        + f" 5 0 {row} {row}\n 5 20000000 {row} 0 0 0 90 0 0 0\n"
    )
    assert iw.Recording.load(log).q[0, 3] == 1.0
    assert iw.Recording.load(log, unit="deg").q[0, 3] == math.radians(1)
    commanded = iw.Recording.load(log, positions="commanded")
    assert commanded.q[:, 3].tolist() == [math.radians(1), math.radians(90)]
    assert "read as degrees" in commanded.losses[0]
    with pytest.raises(ValueError, match="'measured', 'commanded' are known"):
        iw.Recording.load(log, positions="both")


def test_repeat_blocks() -> None:
    swing = [iw.ptp(deg=[30] + [0] * 6, name="out"), iw.ptp(deg=[0] * 7)]
    inner = iw.repeat(2, swing, name="swings", group="inner")
    program = iw.Program(
        [iw.wait(1), iw.repeat(3, [inner, iw.wait(0.5)], comment="text")], start_deg=[0] * 7
    )
    assert len(program) == 1 + 3 * 5
    assert len(program.motions) == 2
    assert program.motions[1]["motions"][0] == inner
    assert iw.Program.from_json(program.to_json()) == program
    assert len(program.with_motions([*program.motions, iw.wait(2)])) == 17
    plan = iw.plan(program)
    assert plan.motions[0].rounds == ()
    assert plan.motions[8].rounds == ((2, 3), (2, 2))
    outer, swings = plan.repeats
    assert (outer.name, outer.comment, outer.first_motion, outer.motions) == (None, "text", 2, 5)
    assert (swings.name, swings.group, swings.count, swings.depth) == ("swings", "inner", 2, 2)
    assert outer.duration_s == pytest.approx(plan.cycle_time_s - 1)
    assert outer.min_round_s == pytest.approx(outer.max_round_s)
    assert [group.motions for group in plan.groups] == [12]
    assert iw.plan(iw.Program(swing, start_deg=[0] * 7)).repeats == ()

    with pytest.raises(iw.ProgramError) as error:
        iw.Program([iw.repeat(2, [iw.wait(1), iw.wait(-1)])], start_deg=[0] * 7)
    assert str(error.value).startswith("motion 2 (round 1 of 2), seconds: a wait of -1 s")
    with pytest.raises(iw.ProgramError, match="motion 1, count: the repeat block's count is 0"):
        iw.Program([iw.repeat(0, [iw.wait(1)])], start_deg=[0] * 7)
    with pytest.raises(iw.ProgramError, match="motion 7 contains a value that is not finite"):
        iw.Program([iw.repeat(3, swing), iw.wait(float("nan"))], start_deg=[0] * 7)
    numbers = {"type": "repeat", "count": np.int64(3), "motions": [iw.wait(1)]}
    inner = iw.repeat(2, [iw.wait(1), iw.wait(float("nan"))])
    with pytest.raises(iw.ProgramError, match="motion 5 contains a value that is not finite"):
        iw.Program([numbers, iw.repeat(2, [inner])], start_deg=[0] * 7)


def test_names_and_groups() -> None:
    labels = {"name": "a name", "comment": "two\nlines", "group": "pick"}
    frame = {"x_mm": 500, "y_mm": 0, "z_mm": 500, "a_deg": 0, "b_deg": 180, "c_deg": 0}
    motions = [
        iw.ptp(deg=[0, 30, 0, -60, 0, 90, 0], **labels),
        iw.lin(frame, **labels),
        iw.lin_rel(z_mm=10, **labels),
        iw.circ(frame, frame, **labels),
        iw.spline([{"type": "spl", "frame": frame}], **labels),
        iw.wait(1, overlap=True, **labels),
        iw.wait(1, overlap=2, **labels),
        iw.load(1, **labels),
        iw.load(None, **labels),
    ]
    for motion in motions:
        assert {key: motion[key] for key in labels} == labels
    assert motions[5]["overlap"] is True and motions[6]["overlap_motions"] == 2
    assert motions[8]["load"] is None

    labelled = iw.Program(
        [
            iw.ptp(deg=[30, 0, 0, 0, 0, 0, 0], name="out", group="move", comment="to the left"),
            iw.load(1, name="grip"),
            iw.wait(0.5, group="hold"),
            iw.ptp(deg=[0] * 7, group="move"),
        ],
        start_deg=[0] * 7,
    )
    assert iw.Program.from_json(labelled.to_json()) == labelled
    plan = iw.plan(labelled)
    assert [motion.name for motion in plan.motions] == ["out", None, None]
    assert [motion.group for motion in plan.motions] == ["move", "hold", "move"]
    assert plan.motions[0].comment == "to the left"
    move, hold = plan.groups
    assert (move.name, move.motions, move.contiguous) == ("move", 2, False)
    assert (hold.name, hold.motions, hold.contiguous) == ("hold", 1, True)
    assert move.duration_s == pytest.approx(plan.motion_time_s)
    assert move.share == pytest.approx(plan.motion_time_s / plan.cycle_time_s)
    assert iw.plan(swing()).groups == ()
    with pytest.raises(iw.ProgramError, match="`name` has 201 characters"):
        iw.Program([iw.wait(1, name="n" * 201)], start_deg=[0] * 7)
    wrong = iw.wait(-1, name="pause")
    with pytest.raises(iw.ProgramError, match='motion 1 "pause"'):
        iw.Program([wrong], start_deg=[0] * 7)


def test_inputs_and_outputs() -> None:
    motions = [
        iw.ptp(deg=[30, 0, 0, 0, 0, 0, 0]),
        iw.set_io("Gripper.Close", np.bool_(True), name="close"),
        iw.wait_for("Gripper.Closed", False, 0.4, group="pick"),
        iw.ptp(deg=[0] * 7, blend_sunrise_rel=0.2),
        iw.set_io("Belt.Speed", np.float32(0.5), overlap=True),
        iw.wait_for("Belt.Count", 3, 0.01, overlap=1),
        iw.ptp(deg=[30, 0, 0, -30, 0, 0, 0]),
    ]
    assert motions[1] == {"type": "set", "io": "Gripper.Close", "value": True, "name": "close"}
    assert motions[2]["value"] is False
    program = iw.Program(motions, start_deg=[0] * 7)
    assert iw.Program.from_json(program.to_json()) == program
    plan = iw.plan(program)
    rows = {motion.index: motion for motion in plan.motions}
    close, closed, belt = rows[2], rows[3], rows[5]
    assert (close.type, close.io, close.value, close.time_s) == ("set", "Gripper.Close", True, 0)
    assert (closed.type, closed.io, closed.value) == ("wait_for", "Gripper.Closed", False)
    assert closed.time_s == pytest.approx(0.4) and plan.wait_time_s == pytest.approx(0.4)
    assert (belt.io, belt.value, rows[1].io, rows[1].value) == ("Belt.Speed", 0.5, None, None)
    assumed = [it["what"] for it in plan.figures()["rests_on"] if "wait_for" in it["what"]]
    assert assumed == [
        "wait_for: Gripper.Closed = false after 0.4 s",
        "wait_for: Belt.Count = 3 after 0.01 s",
    ]
    with pytest.raises(iw.ProgramError, match="motion 1, io: `io` is empty"):
        iw.Program([iw.set_io("", True)], start_deg=[0] * 7)
    with pytest.raises(iw.ProgramError, match="motion 1, value: expected true, false or a number"):
        iw.Program([iw.wait_for("A.B", "on", 1)], start_deg=[0] * 7)  # type: ignore[arg-type]


def test_options_of_plans() -> None:
    program = iw.Program.load(FIXTURES / "ten-motions.json")
    jerk = iw.plan(program)
    assert iw.plan(program, timing="acceleration").cycle_time_s < jerk.cycle_time_s
    assert iw.plan(program, timing="sunrise").timing == "sunrise"
    assert iw.plan(program, blend_shape="alpha").cycle_time_s != jerk.cycle_time_s
    assert iw.plan(program, robot="lbr_iiwa_14_r820").robot.name == "lbr_iiwa_14_r820"
    assert iw.plan(program, robot=iw.Robot("lbr_iiwa_14_r820")) is not None
    limited = iw.plan(program, limit_torque_percent=40)
    assert limited.cycle_time_s > jerk.cycle_time_s
    assert limited.figures()["limit_torque_percent"] == 40
    wrongs: list[dict[str, Any]] = [
        {"timing": "speed"},
        {"blend_shape": "round"},
        {"samples": 1},
        {"limit_torque_percent": 0},
        {"override_percent": 0},
        {"override_percent": 100.1},
    ]
    for wrong in wrongs:
        with pytest.raises(ValueError, match=next(iter(wrong))):
            iw.plan(program, **wrong)
    with pytest.raises(TypeError):
        iw.plan(program, "jerk")  # type: ignore[misc]


@pytest.mark.parametrize(
    ("text", "line", "motion", "says"),
    [
        ("{", 1, None, "ends too early"),
        (
            (
                '{"version": 1,\n "start": {"joints_deg": [0,0,0,0,0,0,0]},\n "motions": [{"type": '
                '"hop"}]}'
            ),
            3,
            1,
            "hop",
        ),
        (
            '{"version": 1, "start": {"joints_deg": [0,0,0,0,0,0]}, "motions": []}',
            1,
            None,
            "seven|7",
        ),
        (
            '{"version": 9, "start": {"joints_deg": [0,0,0,0,0,0,0]}, "motions": []}',
            1,
            None,
            "version 9",
        ),
    ],
)
def test_errors_say_where(text: str, line: int, motion: int | None, says: str) -> None:
    with pytest.raises(iw.ProgramError, match=says) as caught:
        iw.Program.from_json(text)
    assert caught.value.line == line and caught.value.motion == motion
    assert pickle.loads(pickle.dumps(caught.value)).line == line


def test_programs_are_planned_for_the_robot_that_they_name() -> None:
    text = swing().to_json()
    heavy = iw.Program.from_json(text.replace("{", '{"robot": "lbr_iiwa_14_r820",', 1))
    named = iw.plan(heavy)
    assert named.robot.name == "lbr_iiwa_14_r820"
    assert named.cycle_time_s == iw.plan(swing(), robot="lbr_iiwa_14_r820").cycle_time_s
    assert named.cycle_time_s != iw.plan(swing()).cycle_time_s
    assert iw.plan(heavy, robot="lbr_iiwa_7_r800").cycle_time_s == iw.plan(swing()).cycle_time_s


def test_errors_of_plans_say_where() -> None:
    program = swing().with_motions([iw.wait(1), iw.ptp(deg=[0, 0, 0, 0, 0, 0, 200])])
    with pytest.raises(iw.ProgramError, match="A7") as caught:
        iw.plan(program)
    assert caught.value.motion == 2 and caught.value.line is None
    assert str(caught.value).startswith("motion 2, deg[6]: joint A7 is at 200 deg")
    assert "line" not in str(caught.value)
    # A text that the caller has seen.
    with pytest.raises(iw.ProgramError, match=r"A7.*, at line 1, column") as caught:
        iw.plan(iw.Program.from_json(program.to_json()))
    assert caught.value.motion == 2 and caught.value.line == 1
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
    for again in (program, iw.Program.from_json(program.to_json())):
        (error,) = iw.plan_all([pickle.loads(pickle.dumps(again))])
        assert isinstance(error, iw.ProgramError)
        assert (error.line is None) == (again is program)
    with pytest.raises(iw.ProgramError):
        swing().with_motions([])
    with pytest.raises(ValueError, match="no robot is called 'kr6'"):
        swing(robot="kr6")
    with pytest.raises(ValueError, match="start_deg"):
        iw.Program([iw.wait(1)])
    with pytest.raises(FileNotFoundError, match=r"no-such-file\.json"):
        iw.Program.load("no-such-file.json")
    with pytest.raises(
        iw.ProgramError, match="motion 2 contains a value that is not finite"
    ) as caught:
        iw.Program([iw.wait(1), iw.ptp(deg=[np.nan] * 7)], start_deg=[0] * 7)
    assert caught.value.motion == 2
    with pytest.raises(ValueError, match="not finite"):
        iw.Program([iw.wait(1)], start_deg=[np.inf] * 7)


def test_numbers_of_numpy_are_numbers() -> None:
    by_numpy = iw.Program(
        [
            iw.ptp(deg=np.arange(7, dtype=np.float32), velocity_rel=np.float32(0.5)),
            iw.wait(np.float64(1)),
        ],  # type: ignore[arg-type]
        start_deg=np.zeros(7),
    )
    assert by_numpy == iw.Program(
        [iw.ptp(deg=range(7), velocity_rel=0.5), iw.wait(1)], start_deg=[0] * 7
    )


def test_arrays_of_samples_are_not_written_to() -> None:
    samples = iw.plan(swing()).sample()
    for values in (
        samples.t,
        samples.q,
        samples.dq,
        samples.ddq,
        samples.motion,
        samples.tcp,
        samples.tcp_pose,
        samples.tcp_velocity,
        samples.tcp_speed,
        samples.tcp_angular_speed,
        samples.torque,
    ):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 1


def test_the_override_slows_motions_and_nothing_else() -> None:
    program = iw.Program.load(FIXTURES / "ten-motions.json")
    full, slow = iw.plan(program), iw.plan(program, override_percent=25)
    assert slow.motion_time_s == pytest.approx(4 * full.motion_time_s, rel=1e-3)
    assert (slow.settle_time_s, slow.wait_time_s) == (full.settle_time_s, full.wait_time_s)
    # The option replaces the value of the program, and the program of the plan has it.
    assert iw.plan(slow.program).cycle_time_s == slow.cycle_time_s
    assert iw.plan(slow.program, override_percent=100).cycle_time_s == full.cycle_time_s
    assert json.loads(slow.program.to_json())["override_percent"] == 25
    (of_many,) = iw.plan_all([program], override_percent=25)
    assert isinstance(of_many, iw.Plan)
    assert of_many.cycle_time_s == slow.cycle_time_s
    assert pickle.loads(pickle.dumps(slow)).cycle_time_s == slow.cycle_time_s


def test_the_program_of_a_plan_is_the_program() -> None:
    program = iw.Program.load(FIXTURES / "ten-motions.json")
    assert iw.plan(program).program == program
    assert iw.plan(program).program.to_json() == program.to_json()
    assert iw.plan(program, limit_torque_percent=50).program != program


def test_programs_are_what_they_were() -> None:
    program = iw.Program.load(FIXTURES / "pick-and-place.json")
    assert program.with_motions(program.motions) == program
    assert iw.Program.from_json(program.to_json()) == program
    rad = np.deg2rad([10, 20, 0, -60, 0, 90, 0])
    assert program.with_start(rad=rad) == program.with_start(deg=[10, 20, 0, -60, 0, 90, 0])
    with pytest.raises(ValueError, match="either"):
        program.with_start(deg=rad, rad=rad)
    assert hash(program) == hash(program.with_motions(program.motions))


def test_things_are_pickled(tmp_path: Path) -> None:
    profile = json.loads(iw.Robot().profile())
    profile["velocity_limit_deg_s"] = [50] * 7
    robot = iw.Robot.from_profile(json.dumps(profile))
    for own in (iw.Robot(), robot):
        assert pickle.loads(pickle.dumps(own)) == own
    program = swing(robot=robot)
    again = pickle.loads(pickle.dumps(program))
    assert again == program and again.robot == robot
    plan = iw.plan(program, timing="acceleration")
    planned = pickle.loads(pickle.dumps(plan))
    assert planned.cycle_time_s == plan.cycle_time_s and planned.timing == plan.timing
    assert np.array_equal(planned.sample().q, plan.sample().q)
    scene = iw.Scene.load(FIXTURES / "cage.json")
    assert pickle.loads(pickle.dumps(scene)).obstacles == scene.obstacles
    near = plan.clearance(scene)
    assert near is not None and repr(pickle.loads(pickle.dumps(near))) == repr(near)
    samples = pickle.loads(pickle.dumps(plan.sample(rate_hz=123)))
    assert np.array_equal(samples.torque, plan.sample(rate_hz=123).torque)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda own: iw.plan(own, robot=own), "robot is of type Program; a Robot, the name"),
        (lambda own: iw.compare(own, own), "a Recording, a Run or the path of a file"),
        (
            lambda own: iw.compare(3, iw.Recording([0.0, 0.01], [[0.0] * 7] * 2)),
            "plan is of type int; a Plan or",
        ),
        (lambda own: iw.identify("log.csv"), "give a list"),
        (lambda own: iw.plan_all([own, 3]), r"programs\[1\] is of type int; a Program"),
        (lambda own: iw.Program([], start_deg=[0] * 7, robot=3), "robot is of type int; a Robot"),
        (lambda own: iw.Robot().torques([0.0] * 7, load=3), "load is of type int; a dict"),
        (
            lambda own: iw.import_application(JOINTS, answers={"Go?": "Yes"}),
            "of type str; the number of a button",
        ),
        (
            lambda own: iw.import_application(JOINTS, inputs={"speed": [1]}),
            "a value is of type list; True or False",
        ),
    ],
)
def test_wrong_types_are_told(call: Callable[[iw.Program], object], says: str) -> None:
    with pytest.raises(TypeError, match=says):
        call(swing())


def test_scenes_with_meshes_are_pickled(tmp_path: Path) -> None:
    corners = [(0, 0, 0), (60, 0, 0), (0, 60, 0), (0, 0, 90)]
    faces = [(1, 3, 2), (1, 2, 4), (2, 3, 4), (1, 4, 3)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a} {b} {c}" for a, b, c in faces]
    (tmp_path / "tool.obj").write_text("\n".join(lines))
    tool = [{"type": "mesh", "file": "tool.obj"}]
    floor = {"name": "floor", "type": "plane", "point_mm": [0, 0, 0], "normal": [0, 0, 1]}
    (tmp_path / "scene.json").write_text(
        json.dumps({"version": 1, "tool": tool, "obstacles": [floor]})
    )
    scene = iw.Scene.load(tmp_path / "scene.json")
    shutil.rmtree(tmp_path)
    plan = iw.plan(swing())
    for again in (pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene)):
        assert repr(plan.clearance(again)) == repr(plan.clearance(scene))


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda own: iw.plan(own, samples=-1), "samples is -1; from 2"),
        (lambda own: iw.plan_all([own], jobs=-1), "jobs is -1; at least 1"),
        (lambda own: iw.Robot().ik(dict.fromkeys(FRAME, 0), e1_deg=0, status=300), "status is 300"),
        (
            lambda own: iw.Robot().ik(dict.fromkeys(FRAME, 0), e1_deg=math.nan, status=2),
            "e1_deg is NaN",
        ),
        (lambda own: own.with_start(), "either in deg or in rad"),
        (
            lambda own: iw.Program([], start_deg=[[0] * 7]),
            r"start_deg has to be of the shape \(7,\)",
        ),
    ],
)
def test_wrong_values_are_told(call: Callable[[iw.Program], object], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        call(swing())


@pytest.mark.parametrize(
    ("call", "error"),
    [
        (lambda folder: iw.Recording.load(folder), IsADirectoryError),
        (
            lambda folder: iw.compare(
                folder / "none.mcap", iw.Recording([0, 0.01], [[0.0] * 7] * 2)
            ),
            FileNotFoundError,
        ),
        (lambda folder: iw.applications(folder / "none"), FileNotFoundError),
        (lambda folder: iw.plan(swing()).write(folder), IsADirectoryError),
        (lambda folder: iw.plan(swing()).write(folder / "none/plan.mcap"), FileNotFoundError),
        (lambda folder: swing().save(folder / "none/cell.json"), FileNotFoundError),
        (lambda folder: iw.plan(swing()).report(measured=folder / "none.mcap"), FileNotFoundError),
        (lambda folder: iw.plan(swing()).report(folder), IsADirectoryError),
        (lambda folder: iw.Program.load(folder), IsADirectoryError),
        (lambda folder: iw.Program.load(folder / "latin-1.json"), iw.ProgramError),
        (lambda folder: iw.Scene.load(folder / "latin-1.json"), iw.SceneError),
    ],
)
def test_what_is_wrong_with_files_is_told(
    call: Callable[[Path], object], error: type[Exception], tmp_path: Path
) -> None:
    (tmp_path / "latin-1.json").write_bytes(
        '{"version": 1, "robot": "Gr\u00fc\u00dfe"}'.encode("latin-1")
    )
    with pytest.raises(error) as raised:
        call(tmp_path)
    assert str(tmp_path) in str(raised.value)
    assert [file.name for file in tmp_path.iterdir()] == ["latin-1.json"]


def test_answers_that_nothing_asks_for_are_told() -> None:
    _, told = iw.import_application(JOINTS, answers={"No such dialog": 0}, data={"velocitty": 0.9})
    assert [note for note in told["notes"] if "nothing asks for" in note] == [
        'nothing asks for "No such dialog"',
        'nothing asks for "velocitty"',
    ]


def test_an_imported_program_has_the_flange_that_is_given() -> None:
    program, told = iw.import_application(JOINTS, robot="lbr_iiwa_14_r820", flange_mm=126)
    assert iw.plan(program).robot.flange([0] * 7)[2] == pytest.approx(0.36 + 0.42 + 0.4 + 0.126)
    stated = json.loads(program.to_json())
    assert (stated["robot"], stated["flange_mm"]) == ("lbr_iiwa_14_r820", 126)
    assert any('asks "start"' in question for question in told["questions"])
    # The name of a model does not determine the flange.
    small = iw.plan(program, robot="lbr_iiwa_7_r800").robot
    assert small.flange([0] * 7)[2] == pytest.approx(0.34 + 0.4 + 0.4 + 0.126)


def test_another_start_leaves_the_rest_as_it_is() -> None:
    program = swing()
    moved = program.with_start(deg=[1] * 7)
    assert moved.motions == program.motions
    assert np.allclose(moved.start_rad, np.radians([1] * 7))


def test_recordings_and_what_they_show_are_pickled(tmp_path: Path) -> None:
    def copied(own: T) -> T:
        again = pickle.loads(pickle.dumps(own))
        assert type(again) is type(own)
        return again  # type: ignore[no-any-return]

    plan = iw.plan(iw.Program.load(FIXTURES / "pick-and-place.json"))
    plan.write(tmp_path / "plan.mcap")
    table = tmp_path / "broken-off.csv"
    row = ",0,0,0,0,0,0,0"
    names = ",".join(f"q{joint}_rad" for joint in range(1, 8))
    table.write_text(f"t_s,{names}\n0{row}\n0.01{row}\n0.02{row}\n0.9{row}\n0.91,0")
    for file in (tmp_path / "plan.mcap", FIXTURES / "data-recorder.log", table):
        recording = iw.Recording.load(file)
        again = copied(recording)
        assert np.array_equal(again.t, recording.t) and np.array_equal(again.q, recording.q)
        assert (again.torque is None) == (recording.torque is None)
        if recording.torque is not None and again.torque is not None:
            assert np.array_equal(again.torque, recording.torque, equal_nan=True)
        assert (again.program, again.losses) == (recording.program, recording.losses)
        assert again.cycle_time_s == recording.cycle_time_s
    assert len(iw.Recording.load(table).losses) == 2
    recording = iw.Recording.load(tmp_path / "plan.mcap")
    for own in (plan, tmp_path / "plan.mcap"):
        comparison = iw.compare(own, recording)
        kept = pickle.dumps(comparison)
        assert copied(comparison).figures() == comparison.figures()
    # The comparison survives deletion and replacement of the file.
    (tmp_path / "plan.mcap").unlink()
    assert pickle.loads(kept).figures() == comparison.figures()
    plan.write(tmp_path / "plan.mcap")
    samples = plan.sample(rate_hz=250)
    found = iw.identify([iw.Recording(samples.t, samples.q)], program=plan.program, name="cell 3")
    assert copied(found).robot == found.robot and copied(found).figures() == found.figures()
    again = iw.identify([tmp_path / "plan.mcap"], name="cell 3")
    assert np.allclose(
        again.robot.velocity_limits_rad_s, found.robot.velocity_limits_rad_s, rtol=1e-3
    )


def test_a_profile_counts_as_it_does_on_the_command_line(tmp_path: Path) -> None:
    profile = json.loads(iw.Robot().profile())
    profile["velocity_limit_deg_s"] = [40] * 7
    (tmp_path / "slow.json").write_text(json.dumps(profile))
    text = json.loads(swing(90).to_json())
    text["robot"] = "slow.json"
    (tmp_path / "program.json").write_text(json.dumps(text))
    slow = iw.plan(iw.Program.load(tmp_path / "program.json"))
    assert slow.cycle_time_s > 1.5 * iw.plan(swing(90)).cycle_time_s
    # A program cannot name files in other folders.
    text["robot"] = "../slow.json"
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "program.json").write_text(json.dumps(text))
    with pytest.raises(iw.ProgramError, match="beside"):
        iw.Program.load(tmp_path / "sub" / "program.json")


def test_plans_are_written_and_read(tmp_path: Path) -> None:
    plan = iw.plan(iw.Program.load(FIXTURES / "pick-and-place.json"))
    file = tmp_path / "plan.mcap"
    plan.write(file, rate_hz=100)
    recording = iw.Recording.load(file)
    samples = plan.sample(rate_hz=100)
    assert np.abs(recording.q - samples.q).max() < 1e-9
    assert recording.program == plan.program and recording.torque is not None
    assert np.abs(recording.torque - samples.torque).max() < 1e-9
    assert os.listdir(tmp_path) == ["plan.mcap"]
    with pytest.raises(OSError, match="no-folder"):
        plan.write(tmp_path / "no-folder" / "plan.mcap")
    with pytest.raises(ValueError, match="rate_hz"):
        plan.write(file, rate_hz=0)


def test_tables_have_the_columns_of_the_command_line() -> None:
    plan = iw.plan(swing())
    pandas = plan.to_pandas(rate_hz=100)
    polars = plan.to_polars(rate_hz=100)
    assert list(pandas.columns) == list(polars.columns) and len(pandas) == len(polars) == len(
        plan.sample(rate_hz=100)
    )
    assert np.array_equal(pandas["joint_4_rad_s"], plan.sample(rate_hz=100).dq[:, 3])
    assert np.array_equal(polars["torque_2_nm"].to_numpy(), plan.sample(rate_hz=100).torque[:, 1])


def test_pages_and_pictures(tmp_path: Path) -> None:
    plan = iw.plan(swing())
    page = plan.report(tmp_path / "page.html", scene=iw.Scene.load(FIXTURES / "cage.json"))
    assert (tmp_path / "page.html").read_text(encoding="utf-8") == page and "</html>" in page
    samples = plan.sample(rate_hz=200)
    assert len(plan.report(measured=iw.Recording(samples.t, samples.q))) > 10_000
    assert "srcdoc" in plan._repr_html_()
    assert plan.picture().rstrip().endswith("</svg>")
    assert len(plan.plot().axes) == 5
