"""The drive client with a simulated robot."""

from __future__ import annotations

import doctest
import json
import math
import signal
import socket
import subprocess
import sys
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

zmq = pytest.importorskip("zmq", reason="the client of the drive needs pyzmq")

from drive_runs import AWAY, CYCLE_S, HOME, SLOW, go, in_background, program, rise
from simulated_robot import SimulatedRobot, binary

import iiwasim as iw
import iiwasim.drive
from iiwasim.drive import Drive, DriveError, DriveTimeout, JointSample, Run


def assert_on_the_way(q: np.ndarray) -> None:
    """Asserts that positions are on the straight line of `SLOW` and do not reach its end."""
    assert np.allclose(q[..., 3], -q[..., 0], atol=1e-6)
    assert np.allclose(np.delete(q, [0, 3], axis=-1), 0.0, atol=1e-6)
    assert 0.0 < q[..., -1, 0] < math.radians(59)


# Runs.


def test_a_run_takes_as_long_as_planned(drive: Drive, tmp_path: Path) -> None:
    there_and_back = program(AWAY, [0, 0, 0, -20, 0, 0, 0], HOME, blend={"fraction": 0.3})
    (tmp_path / "program.json").write_text(json.dumps(there_and_back))
    command = [binary(), "plan", tmp_path / "program.json", "--json"]
    plan = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    run = drive.run(there_and_back, move_to_start=True)
    assert run.cycle_time_s == pytest.approx(plan["cycle_time_s"], abs=CYCLE_S)
    assert run.timed_by is None and run.untimed_because is None and run.samples_left_out == 0
    assert run.t.dtype == run.q.dtype == np.float64
    assert run.q.shape == (len(run.t), 7)
    assert run.t[0] == pytest.approx(0.0, abs=CYCLE_S)
    assert run.t[-1] == pytest.approx(run.cycle_time_s, abs=2 * CYCLE_S)
    assert (np.diff(run.t) > 0.0).all() and np.median(np.diff(run.t)) == pytest.approx(CYCLE_S)
    assert np.allclose(run.q[[0, -1]], 0.0, atol=1e-4)
    assert np.degrees(run.q[:, 3]).min() < -15
    assert repr(run) == f"<Run: cycle time {run.cycle_time_s:.3f} s, {len(run.t)} samples>"
    again = drive.last_run()
    assert again.start_s == run.start_s and np.array_equal(again.q, run.q)


def test_runs_say_what_they_are(drive: Drive) -> None:
    go(drive, HOME)
    with zmq.Context() as context, context.socket(zmq.SUB) as stream:
        stream.set(zmq.RCVHWM, 0)
        stream.connect(drive._stream_at)
        stream.subscribe("")
        assert stream.poll(10_000), "the drive has read the subscription"
        drive.run(program(AWAY), name="away", planned_s=1.25)
        drive.run_trajectory(*rise(0.05), move_to_start=True, name="rise")
        events: list[dict] = []
        while len(events) < 6 and stream.poll(10_000):
            topic, message = stream.recv_multipart()
            if topic == b"run":
                events.append(json.loads(message))
    begins = [event.get("label") for event in events if "end" not in event]
    robot = {
        "model": "lbr_iiwa_7_r800",
        "lengths_mm": {"base": 340.0, "upper_arm": 400.0, "forearm": 400.0, "flange": 152.0},
    }
    plan = {"cycle_time_s": 1.25, "limited_by": []}
    # The motion to the start of a trajectory for an unknown robot does not have a label.
    assert begins == [
        {"program": "away", "planned_for": robot, "plan": plan},
        None,
        {"program": "rise"},
    ]
    for wrong in (-1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="planned_s"):
            drive.run(program(HOME), planned_s=wrong)


def test_programs_come_as_objects_keys_and_text(drive: Drive) -> None:
    class Program:
        def to_json(self) -> str:
            return json.dumps(program(AWAY))

    go(drive, HOME)
    drive.run(Program())
    drive.run(json.dumps(program(HOME, start=AWAY)))
    # Without a start, and with arrays.
    drive.run({"motions": [{"type": "ptp", "joints_rad": np.radians(AWAY)}]})
    assert np.allclose(drive.state().q, np.radians(AWAY), atol=1e-4)


@pytest.mark.parametrize(
    ("other", "named"),
    [
        ("lbr_iiwa_14_r820", "lbr_iiwa_14_r820 with a flange of 152 mm"),
        (iw.Robot(flange_m=0.126), "lbr_iiwa_7_r800 with a flange of 126 mm"),
    ],
)
def test_programs_for_another_robot_are_refused(
    drive: Drive, other: iw.Robot | str, named: str
) -> None:
    go(drive, HOME)
    q = np.zeros((2, 7))
    motions = [iw.ptp(deg=AWAY)]
    model = other if isinstance(other, str) else None
    runs = [
        lambda: drive.run(iw.Program(motions, start_deg=HOME, robot=other)),
        lambda: drive.run(iw.Program(motions, start_deg=AWAY, robot=other), move_to_start=True),
        lambda: drive.run(program(AWAY), robot=other),
        lambda: drive.run_trajectory([0.0, 0.01], q + np.radians(HOME), robot=other),
        *([lambda: drive.run({**program(AWAY), "robot": model})] if model else []),
    ]
    for run in runs:
        with pytest.raises(DriveError, match=named) as refused:
            run()
        assert refused.value.code == "bad_request"
        assert "lbr_iiwa_7_r800 with a flange of 152 mm" in refused.value.message
    assert np.allclose(drive.state().q, np.radians(HOME), atol=1e-4)


def test_tools_bases_and_frames_go_along(drive: Drive) -> None:
    bend = [0, 30, 0, -60, 0, 90, 0]
    keys = {"tools": {"pen": {"tcp": {"z_mm": 100}}}, "tool": "pen", "limit_torque_percent": 50}
    motions = [{"type": "lin_rel", "offset": {"z_mm": -20}, "in": "tcp"}]
    with pytest.raises(ValueError, match="bend"):
        drive.run({**keys, "start": {"frame": "bend"}, "motions": motions})
    at = {"start_rad": np.radians(bend), "move_to_start": True, "start_velocity_rel": 0.8}
    up = drive.run({**keys, "start": {"frame": "bend"}, "motions": motions}, **at)
    assert np.allclose(up.q[0], np.radians(bend), atol=1e-4)
    assert np.abs(np.degrees(up.q[-1] - up.q[0])).max() > 1.0
    start = iw.Robot().frame(np.radians(bend))
    again = drive.run(
        iw.Program([iw.lin_rel(z_mm=-20)], start_frame=start), **{**at, "start_rad": None}
    )
    assert np.allclose(again.q[0], np.radians(bend), atol=1e-4)
    with pytest.raises(DriveError, match="pencil"):
        drive.run({"motions": motions, "tool": "pencil"})


def test_a_run_begins_at_its_start_only(drive: Drive) -> None:
    go(drive, HOME)
    drive.run(program([0, 0, 0, 1, 0, 0, 0], HOME, start=[0.4, 0, 0, 0, 0, 0, 0]))
    with pytest.raises(
        DriveError, match=r"A4 is at -?0\.000 deg, the program starts at -8\.000 deg"
    ) as refused:
        drive.run(program(HOME, start=AWAY))
    assert refused.value.code == "start_mismatch"
    with pytest.raises(DriveError) as refused:
        drive.run_trajectory(rise(0.05)[0], rise(0.05)[1] + 0.1)
    assert refused.value.code == "start_mismatch"
    assert np.allclose(drive.state().q, 0.0, atol=1e-6)


def test_samples_come_while_it_runs(drive: Drive) -> None:
    samples: list[JointSample] = []
    states: list[str] = []

    def keep(sample: JointSample) -> None:
        if not samples:
            states.append(drive.state().state)
        samples.append(sample)

    run = drive.run(program(AWAY, velocity_rel=0.1), move_to_start=True, on_sample=keep)
    assert states == ["running_motion"]
    measured = {round(t_s, 6): q for t_s, q in zip(run.start_s + run.t, run.q)}
    # The drive reports the start slightly early and the end slightly late.
    first_s, last_s = min(measured) - CYCLE_S / 2, max(measured) + CYCLE_S / 2
    of_the_run = [sample for sample in samples if first_s < sample.t_s < last_s]
    assert of_the_run and all(np.array_equal(measured[round(t_s, 6)], q) for t_s, q in of_the_run)


def test_trajectories_are_followed(drive: Drive) -> None:
    t, q = rise(0.1)
    run = drive.run_trajectory(t, q, move_to_start=True)
    assert run.cycle_time_s == pytest.approx(1.0, abs=2 * CYCLE_S)
    expected = np.interp(run.t, t, q[:, 0])
    # A delay of a few cycles at most; the speed is at most 0.22 rad/s.
    assert np.allclose(run.q[:, 0], expected, atol=0.22 * 4 * CYCLE_S)
    assert run.q[-1, 0] == pytest.approx(0.1, abs=1e-4)


def test_real_cabinets_tell_no_times(tmp_path: Path) -> None:
    with (
        SimulatedRobot(tmp_path, cabinet=("--without-times",)) as robot,
        Drive(robot.address, timeout_s=30) as drive,
    ):
        robot.wait_until_ready(drive)
        run = drive.run(program(AWAY))
        assert run.timed_by == "commanded_position" and run.cycle_time_s is not None
        assert drive.sensors().joint_temperature_c is None
        still = drive.run({"motions": [{"type": "wait", "seconds": 0.1}]})
        assert still.cycle_time_s is None and still.untimed_because
        assert repr(still).startswith("<Run: no cycle time, ")


# Stops.


def test_a_stop_leaves_the_arm_on_its_path(drive: Drive) -> None:
    go(drive, HOME)
    with in_background(drive.run, SLOW) as results:
        drive.stop()
    (stopped,) = results
    assert isinstance(stopped, DriveError) and stopped.code == "robot"
    assert stopped.run is not None
    assert_on_the_way(stopped.run.q)
    state = drive.state()
    assert state.state == "idle"
    assert np.allclose(state.q, stopped.run.q[-1], atol=1e-4)


def test_a_stop_is_sent_again_after_lost_connections() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]

        def serve() -> bytes:
            # More closed handshakes than other requests accept before they report a refusal.
            for _ in range(6):
                server.accept()[0].close()
            server.close()
            with zmq.Context.instance().socket(zmq.REP) as replies:
                replies.bind(f"tcp://127.0.0.1:{port}")
                request = replies.recv()
                replies.send(b'{"ok": true}')
                return request

        with ThreadPoolExecutor(1) as threads, Drive(f"127.0.0.1:{port}") as drive:
            request = threads.submit(serve)
            drive.stop()
    assert json.loads(request.result()) == {"type": "stop"}


def test_a_run_of_too_long_is_stopped(drive: Drive) -> None:
    with pytest.raises(DriveTimeout, match=r"more than 1 s, and was stopped") as timeout:
        drive.run(SLOW, move_to_start=True, timeout_s=1.0)
    assert timeout.value.run is not None
    assert_on_the_way(timeout.value.run.q)
    assert drive.state().state == "idle"


def test_an_exception_of_the_caller_stops_the_run(drive: Drive) -> None:
    def fail(sample: JointSample) -> None:
        if sample.q[0] > 0.002:
            raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        drive.run(SLOW, move_to_start=True, on_sample=fail)
    state = drive.state()
    assert state.state == "idle"
    assert_on_the_way(state.q[None])


def test_an_emergency_stop_is_told(tmp_path: Path) -> None:
    with (
        SimulatedRobot(tmp_path, cabinet=("--emergency-stop", "50")) as robot,
        Drive(robot.address, timeout_s=30) as drive,
    ):
        robot.wait_until_ready(drive)
        with pytest.raises(DriveError, match="emergency stop") as stopped:
            drive.run(program([10, 0, 0, -10, 0, 0, 0]))
        assert stopped.value.code == "robot"
        assert_on_the_way(stopped.value.run.q)


INTERRUPTED = """
import json, sys
from iiwasim.drive import Drive
drive = Drive(sys.argv[1])

def tell(sample):
    if sample.q[0] > 0.002:
        print("moves", flush=True)

try:
    drive.run(sys.argv[2], move_to_start=True, on_sample=tell)
except KeyboardInterrupt:
    print("interrupted", drive.state().state, flush=True)
    raise
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT for one process")
@pytest.mark.parametrize("approach", [False, True], ids=["in the run", "on the way to the start"])
def test_ctrl_c_stops_the_robot(drive: Drive, robot: SimulatedRobot, approach: bool) -> None:
    go(drive, [30, 0, 0, 0, 0, 0, 0] if approach else HOME)
    command = [sys.executable, "-u", "-c", INTERRUPTED, robot.address, json.dumps(SLOW)]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as client:
        try:
            if approach:
                moves = (
                    sample
                    for sample in drive.stream(duration_s=20)
                    if sample.q[0] < math.radians(29.9)
                )
                assert next(moves)
            else:
                assert client.stdout.readline() == "moves\n"
            client.send_signal(signal.SIGINT)
            out, err = client.communicate(timeout=20)
        finally:
            client.kill()
    assert client.returncode == -signal.SIGINT, err
    assert out.splitlines()[-1] == "interrupted idle"
    assert err.splitlines()[-1] == "KeyboardInterrupt"
    state = drive.state()
    assert state.state == "idle"
    if approach:
        assert 0.1 < state.q[0] < math.radians(29.95)
    else:
        assert_on_the_way(state.q[None])


# All other requests.


def test_the_state_tells_of_robot_and_program(drive: Drive) -> None:
    state = drive.state()
    assert state.state == "idle" and state.simulated
    assert (state.robot.model, state.robot.lengths_mm["flange"]) == ("lbr_iiwa_7_r800", 152.0)
    assert state.q.shape == (7,) and state.t_s > 0.0
    assert state.fri.session == "monitoring_ready" and not state.fri.safety_stop
    assert state.robot_program.connected and state.robot_program.name.startswith("iiwasim cabinet")
    assert state.conditions.operation_mode == "aut" and state.conditions.override_rel == 1.0
    with pytest.raises(ValueError, match="read-only"):
        state.q[0] = 1.0


def test_inputs_and_outputs_are_read_and_set(drive: Drive) -> None:
    for name, value in [
        ("MediaFlange.LEDBlue", True),
        ("Simulation.DigitalOutput", 7),
        ("Simulation.AnalogOutput", -0.5),
        ("MediaFlange.LEDBlue", False),
    ]:
        assert drive.set_io(name, value) == value
        got = drive.get_io(name)
        assert got == value and type(got) is type(value)
    listed = {signal.name: signal for signal in drive.list_io()}
    assert listed["Simulation.DigitalOutput"].value == 7
    assert listed["Simulation.DigitalOutput"].direction == "output"
    assert listed["MediaFlange.UserButton"].direction == "input"
    with pytest.raises(DriveError, match="UserButton") as refused:
        drive.set_io("MediaFlange.UserButton", True)
    assert refused.value.code == "bad_request"
    with pytest.raises(DriveError, match="Nothing"):
        drive.get_io("Nothing")


def test_sensors_are_read(drive: Drive) -> None:
    sensors = drive.sensors()
    assert sensors.external_torque_nm.shape == (7,) and np.allclose(
        sensors.external_torque_nm, 0.0, atol=1e-6
    )
    assert sensors.joint_temperature_c.shape == (7,) and (sensors.joint_temperature_c > 10).all()


def test_the_stream_goes_on_during_runs(drive: Drive) -> None:
    go(drive, HOME)
    with in_background(drive.run, program(AWAY, HOME, velocity_rel=0.1)) as results:
        streamed = list(drive.stream(duration_s=0.3))
    (run,) = results
    assert isinstance(run, Run)
    times = [sample.t_s for sample in streamed]
    assert (np.diff(times) > 0.0).all() and np.median(np.diff(times)) == pytest.approx(CYCLE_S)
    assert 0.25 < times[-1] - times[0] < 0.3 + CYCLE_S / 2
    assert np.ptp([sample.q[3] for sample in streamed]) > 0.01


def test_a_closed_drive_takes_nothing(robot: SimulatedRobot) -> None:
    drive = Drive(robot.address, stream=robot.stream)
    stream = drive.stream()
    assert next(stream).q.shape == (7,)
    with drive:
        pass
    assert list(stream) == []
    for request in (
        drive.state,
        drive.stop,
        lambda: next(drive.stream()),
        lambda: drive.run(program(AWAY)),
    ):
        with pytest.raises(ValueError, match="closed"):
            request()
    assert repr(drive) == f"<Drive at tcp://{robot.address}, closed>"


# As a whole.


def test_the_examples_are_true(robot: SimulatedRobot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IIWASIM_DRIVE", robot.address)
    monkeypatch.setenv("IIWASIM_STREAM", robot.stream)
    failed, tried = doctest.testmod(iiwasim.drive)
    assert tried > 10 and failed == 0


def test_nothing_is_left_open(robot: SimulatedRobot) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", ResourceWarning)
        with Drive(robot.address, stream=robot.stream) as drive:
            drive.state()
            list(drive.stream(duration_s=0.02))
