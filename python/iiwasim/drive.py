"""Client of `iiwasim drive`: runs programs and trajectories on the robot, and reads measurements.

Needs pyzmq: `pip install 'iiwasim[drive]'`. Joint positions are in rad, A1 to A7, in arrays (7,) or
(n, 7); times are in s.

A `Drive` may be shared by threads, as each request has its own connection: while one thread waits
for a run, others may `stop` it or read the `state`. An iterator of `Drive.stream` belongs to one
thread at a time.

Ctrl-C stops the robot if `Drive.run` is called in the main thread: Python raises
`KeyboardInterrupt` only there. If another thread calls `Drive.run`, catch `KeyboardInterrupt` in
the main thread and call `Drive.stop`. A stop depends on the network and does not replace an
emergency stop.
"""

from __future__ import annotations

import math
import os
import time
import warnings
from contextlib import ExitStack, suppress
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from ._arrays import real_array
from ._replies import (
    Conditions,
    DriveError,
    DriveState,
    DriveTimeout,
    FriState,
    JointSample,
    RobotIdentity,
    RobotProgram,
    Run,
    Sensors,
    Signal,
    joint_sample,
    read_reply,
    read_run,
    read_sensors,
    read_signals,
    read_state,
    read_value,
    run_of,
    state_message,
)
from ._requests import (
    MAX_POINTS,
    MOTION_KEYS,
    ProgramText,
    as_robot,
    check_without_signals,
    program_keys,
    request_text,
    robot_of,
    run_label,
    seven_joints,
    start_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Mapping
    from types import TracebackType
    from typing import Self

    import numpy.typing as npt

    from ._link import Line
    from ._native import Robot
    from ._replies import IoValue, Joints

__all__ = [
    "Conditions",
    "Drive",
    "DriveError",
    "DriveState",
    "DriveTimeout",
    "FriState",
    "JointSample",
    "ProgramText",
    "RobotIdentity",
    "RobotProgram",
    "Run",
    "Sensors",
    "Signal",
]

T = TypeVar("T")

ADDRESS = "127.0.0.1:5560"
"""Default address of a drive."""
START_TOLERANCE_RAD = math.radians(0.5)
"""Maximum joint deviation from the start of a program, as in `iiwasim run`."""
# Above the 4 s within which the drive answers a stop.
STOP_TIMEOUT_S = 5.0
# Pause before a stop whose connection was lost is sent again.
RETRY_S = 0.05
# Maximum time for repeated stops of a run, as the first stop may arrive before the run has begun.
REST_TIMEOUT_S = 10.0
# Poll interval for the end of a run, and for samples.
PAUSE_S = 0.05
# Maximum time for handing on the samples that arrived by the end of their run.
LAST_SAMPLES_S = 0.5


class Drive:
    """A drive at `address` (`HOST:PORT`), by default `IIWASIM_DRIVE`, else 127.0.0.1:5560.

    `stream` is the address at which the drive publishes; its default is the next port, or
    `IIWASIM_STREAM` if `address` is left out. A drive on another machine requires keys from
    `iiwasim keygen`: `key` is your `.key` file, `server_key` the `.pub` file of the drive; the
    defaults are `IIWASIM_KEY` and `IIWASIM_SERVER_KEY`. `timeout_s` is the maximum time for
    replies to requests without motion.

    The first request connects. An invalid address or key file raises `ValueError`; requests raise
    `DriveError` and `DriveTimeout`.

    >>> program = {
    ...     "version": 1,
    ...     "start": {"joints_deg": [0, 0, 0, 0, 0, 0, 0]},
    ...     "motions": [{"type": "ptp", "joints_deg": [5, 0, 0, -5, 0, 0, 0]}],
    ... }
    >>> with Drive() as drive:
    ...     run = drive.run(program, move_to_start=True)
    >>> run.q.shape == (len(run.t), 7)
    True
    >>> np.degrees(run.q[-1]).round(1) + 0.0
    array([ 5.,  0.,  0., -5.,  0.,  0.,  0.])
    """

    def __init__(
        self,
        address: str | None = None,
        *,
        stream: str | None = None,
        key: str | os.PathLike[str] | None = None,
        server_key: str | os.PathLike[str] | None = None,
        timeout_s: float = 5.0,
    ) -> None:
        if not 0.0 < timeout_s < math.inf:
            raise ValueError(f"timeout_s is {timeout_s}; give a time in s above 0")
        # Imported here, because the rest of the package works without pyzmq.
        from ._link import Keys, endpoint

        if address is None:
            address = os.environ.get("IIWASIM_DRIVE", ADDRESS)
            stream = stream or os.environ.get("IIWASIM_STREAM")
        keys = Keys.read(
            key or os.environ.get("IIWASIM_KEY"), server_key or os.environ.get("IIWASIM_SERVER_KEY")
        )
        host, port = endpoint(address, keys)
        stream_host, stream_port = endpoint(stream, keys) if stream else (host, port + 1)
        self._at = f"tcp://{host}:{port}"
        self._stream_at = f"tcp://{stream_host}:{stream_port}"
        self._keys = keys
        self._timeout_s = timeout_s
        self._closed = False

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Drive at {self._at}{', closed' if self._closed else ''}>"

    def close(self) -> None:
        """Refuses further requests, and ends iterators of `stream`. Does not stop the robot."""
        self._closed = True

    def state(self) -> DriveState:
        """Reads the current state of drive and robot.

        >>> with Drive() as drive:
        ...     drive.state().state
        'idle'
        """
        return self._ask({"type": "state"}, read_state)

    def run(
        self,
        program: ProgramText | Mapping[str, Any] | str,
        *,
        start_rad: npt.ArrayLike | None = None,
        move_to_start: bool = False,
        start_velocity_rel: float = 0.1,
        timeout_s: float | None = None,
        on_sample: Callable[[JointSample], object] | None = None,
        name: str | None = None,
        planned_s: float | None = None,
        robot: Robot | str | None = None,
    ) -> Run:
        """Runs a program, waits for its end and returns the measurements; the controller plans it.

        `program` is an `iiwasim.Program`, the keys of a program, or its JSON. The robot has to be
        at the start of the program, within 0.5 deg; with `move_to_start`, the robot first moves
        there, on a straight line in joint space at `start_velocity_rel` of the velocity limits.
        `start_rad`, (7,), replaces the start of the program. A program without a `start` starts at
        the current position. `limit_torque_percent` is for planning only; to enforce it, run the
        samples of the plan with `run_trajectory`. A program with `set` or `wait_for` raises
        `ValueError`: a request contains motions only.

        Ctrl-C, an exception in `on_sample`, and a run of more than `timeout_s` stop the robot on
        its path, also during the motion to the start; the exception is raised once the robot is at
        rest. A second Ctrl-C does not wait for that. `on_sample` is called with measured positions
        while the program runs, and should be quick; positions that arrive too fast for it are only
        in the result.

        `name` and `planned_s`, the planned cycle time, are published with the run for monitoring
        clients such as `iiwasim bridge`; `iiwasim history` groups runs by name.

        `robot`, a model or a profile, is the robot for which the program was written; the default
        is the robot of the program. The drive refuses the program, with `bad_request`, if it
        controls a robot with other lengths or another flange.

        Raises `DriveError`; its `.run` has the measurements up to the error if the run was stopped
        or aborted.
        """
        _check_callable(on_sample)
        keys = program_keys(program)
        check_without_signals(keys)
        start = (
            start_of(program, keys) if start_rad is None else seven_joints(start_rad, "start_rad")
        )
        request = {"type": "run_motions", **{key: keys[key] for key in MOTION_KEYS if key in keys}}
        robot = robot_of(program, keys) if robot is None else as_robot(robot)
        text = request_text({**request, **run_label(name, planned_s, robot)})
        if start is not None:
            self._go_to_start(start, move_to_start, start_velocity_rel, robot)
        elif move_to_start:
            raise ValueError(
                "the program has no start to move to; give it one, or leave out move_to_start"
            )
        return self._execute(text, timeout_s, on_sample)

    def run_trajectory(
        self,
        t: npt.ArrayLike,
        q: npt.ArrayLike,
        *,
        move_to_start: bool = False,
        start_velocity_rel: float = 0.1,
        timeout_s: float | None = None,
        on_sample: Callable[[JointSample], object] | None = None,
        name: str | None = None,
        planned_s: float | None = None,
        robot: Robot | str | None = None,
    ) -> Run:
        """Runs joint positions `q`, in rad, (n, 7), at times `t`, in s, (n,), as FRI set-points.

        The other arguments are as in `run`. The drive checks the trajectory: at most 25 ms between
        set-points while the robot moves, within all limits, at rest at both ends, and starting at
        the current position; and, if `robot` is given, that the trajectory was planned for the
        robot of the drive.

        >>> rise = np.linspace(0.0, 1.0, 101)
        >>> q = np.zeros((101, 7))
        >>> q[:, 0] = 0.02 * rise**4 * (35 - 84 * rise + 70 * rise**2 - 20 * rise**3)
        >>> with Drive() as drive:
        ...     run = drive.run_trajectory(rise, q, move_to_start=True)
        >>> f"{run.q[-1, 0]:.3f}"
        '0.020'
        """
        _check_callable(on_sample)
        times, points = real_array("t", t), real_array("q", q)
        if times.ndim != 1 or points.shape != (len(times), 7) or not 0 < len(times) <= MAX_POINTS:
            found = f"t {times.shape}, q {points.shape}"
            raise ValueError(
                f"a trajectory is t (n,) and q (n, 7) of up to {MAX_POINTS} points; found {found}"
            )
        if not (np.isfinite(times).all() and np.isfinite(points).all()):
            raise ValueError("t and q have to be finite")
        trajectory = {"t_s": times.tolist(), "joints_rad": points.tolist()}
        robot = None if robot is None else as_robot(robot)
        label = run_label(name, planned_s, robot)
        text = request_text({"type": "run_trajectory", "trajectory": trajectory, **label})
        self._go_to_start(points[0], move_to_start, start_velocity_rel, robot)
        return self._execute(text, timeout_s, on_sample)

    def last_run(self) -> Run:
        """Reads the result of the last run again, for example after a lost connection.

        If the last run was aborted, its `DriveError` is raised again.
        """
        return self._ask({"type": "last_run"}, read_run)

    def stop(self) -> None:
        """Stops the running motion on its path, and returns once the robot is at rest.

        Any thread may call it, and the motion may be of any client. The stop is sent again if the
        connection is lost, for 5 s.
        """
        self._check_open()
        self._stop()

    def sensors(self) -> Sensors:
        """Reads the sensors; refused during a run (`not_idle`).

        >>> with Drive() as drive:
        ...     drive.sensors().external_torque_nm.shape
        (7,)
        """
        return self._ask({"type": "read_sensors"}, read_sensors)

    def list_io(self) -> list[Signal]:
        """Reads all inputs and outputs; refused during a run (`not_idle`)."""
        return self._ask({"type": "list_io"}, read_signals)

    def get_io(self, name: str) -> IoValue:
        """Reads an input or output; refused during a run (`not_idle`)."""
        return self._ask({"type": "get_io", "name": name}, read_value)

    def set_io(self, name: str, value: IoValue) -> IoValue:
        """Sets an output and returns its new value; refused during a run (`not_idle`).

        >>> with Drive() as drive:
        ...     drive.set_io("MediaFlange.LEDBlue", True), drive.get_io("MediaFlange.LEDBlue")
        (True, True)
        """
        return self._ask({"type": "set_io", "name": name, "value": value}, read_value)

    def stream(self, *, duration_s: float | None = None) -> Generator[JointSample, None, None]:
        """Iterates over measured joint positions, in every controller cycle, for `duration_s` or
        endlessly.

        The iterator connects when the iteration begins. A loop that is too slow loses samples once
        a backlog of some thousand samples is full. Silence for more than the `timeout_s` of this
        `Drive` raises `DriveTimeout`.

        >>> with Drive() as drive:
        ...     for t_s, q in drive.stream():
        ...         print(q.shape)
        ...         break
        (7,)
        """
        self._check_open()
        with self._subscription(b"joints") as line:
            first_s = None
            while line.poll(self._timeout_s, lambda: self._closed) and not self._closed:
                sample = joint_sample(line.receive()[1])
                first_s = sample.t_s if first_s is None else first_s
                if duration_s is not None and sample.t_s - first_s > duration_s:
                    return
                yield sample
            if not self._closed:
                heard = (
                    f"the drive at {self._stream_at} has published nothing for {self._timeout_s:g} "
                    "s"
                )
                raise DriveTimeout(
                    "timeout", f"{heard}; does it hear the robot? `iiwasim status` tells"
                )

    def _ask(self, request: dict[str, Any], read: Callable[[dict[str, Any]], T]) -> T:
        self._check_open()
        return self._exchange(request, read, self._timeout_s)

    def _stop(self) -> None:
        """Stops the robot, also if another thread has closed this `Drive`.

        The stop is sent again after a lost connection, as a drive under load may close connections.
        """
        from ._link import ConnectionLost

        until = time.monotonic() + max(self._timeout_s, STOP_TIMEOUT_S)
        while True:
            try:
                return self._exchange({"type": "stop"}, lambda _: None, until - time.monotonic())
            except ConnectionLost:
                if time.monotonic() + RETRY_S >= until:
                    raise
                time.sleep(RETRY_S)

    def _exchange(
        self, request: dict[str, Any], read: Callable[[dict[str, Any]], T], timeout_s: float
    ) -> T:
        """Sends a request, and reads its reply."""
        with self._connection() as line:
            line.send(request_text(request))
            if not line.poll(timeout_s):
                raise DriveTimeout(
                    "timeout", f"the drive at {self._at} did not reply within {timeout_s:.3g} s"
                )
            return read_reply(line.receive()[-1], read)

    def _connection(self) -> Line:
        return self._line(self._at)

    def _subscription(self, *topics: bytes) -> Line:
        return self._line(self._stream_at, topics)

    def _line(self, at: str, topics: tuple[bytes, ...] = ()) -> Line:
        from ._link import Line

        return Line(at, self._keys, self._timeout_s, topics)

    def _check_open(self) -> None:
        if self._closed:
            raise ValueError("the drive is closed")

    def _go_to_start(
        self, start: Joints, move: bool, velocity_rel: float, robot: Robot | None
    ) -> None:
        """Moves the robot to a start if `move` is true; raises `DriveError` if it is elsewhere."""
        state = self.state()
        if state.state != "idle":
            raise DriveError("not_idle", "the robot is busy: it is running another program")
        if state.q is None or state.fri.session == "silent":
            raise DriveError("robot", _unknown_position(state.fri))
        if caution := _caution(state.conditions):
            warnings.warn(
                f"{caution}: the program takes longer than planned", RuntimeWarning, stacklevel=3
            )
        off = np.abs(state.q - start)
        joint = int(off.argmax())
        if off[joint] <= (1e-6 if move else START_TOLERANCE_RAD):
            return
        if not move:
            at, begin = math.degrees(state.q[joint]), math.degrees(start[joint])
            where = f"joint A{joint + 1} is at {at:.3f} deg, the program starts at {begin:.3f} deg"
            how = "move_to_start=True moves it there first"
            raise DriveError(
                "start_mismatch", f"the robot is not at the program's start: {where}; {how}"
            )
        approach = {"type": "ptp", "joints_rad": start.tolist(), "velocity_rel": velocity_rel}
        try:
            request = {"type": "run_motions", "motions": [approach], **run_label(None, None, robot)}
            self._execute(request_text(request), None, None)
        except DriveError as error:
            raise type(error)(
                error.code, f"the robot did not move to the start: {error.message}"
            ) from error

    def _execute(
        self,
        request: bytes,
        timeout_s: float | None,
        on_sample: Callable[[JointSample], object] | None,
    ) -> Run:
        """Sends a run and waits for its end; an exception in the meantime stops the robot."""
        self._check_open()
        with ExitStack() as open_lines:
            samples = (
                open_lines.enter_context(self._subscription(b"state", b"joints"))
                if on_sample
                else None
            )
            if samples is not None:
                # The run must not begin before the drive has read the subscription.
                samples.poll(self._timeout_s)
            line = open_lines.enter_context(self._connection())
            try:
                line.send(request)
                has_ended = _follow(line, samples, timeout_s, on_sample)
            except BaseException:
                # Without a connection, the run cannot be stopped and continues.
                if not line.is_lost:
                    self._bring_to_rest(line)
                raise
            if has_ended:
                return read_reply(line.receive()[-1], read_run)
            reply = self._bring_to_rest(line)
            raise DriveTimeout(
                "timeout", f"the run took more than {timeout_s:g} s, and was stopped", run_of(reply)
            )

    def _bring_to_rest(self, line: Line) -> bytes | None:
        """Stops the run whose reply is expected on `line`, and returns the reply."""
        failure: DriveError | None = None
        until = time.monotonic() + REST_TIMEOUT_S
        with suppress(DriveError):
            pause_s = 0.0
            while not line.poll(pause_s) and time.monotonic() < until:
                pause_s = PAUSE_S
                try:
                    self._stop()
                    failure = None
                except DriveError as error:
                    failure = error
            if line.poll(0.0):
                return line.receive()[-1]
        why = failure or "the drive does not report the end of the run"
        warnings.warn(f"the robot may still be moving: {why}", RuntimeWarning, stacklevel=4)
        return None


def _follow(
    line: Line,
    samples: Line | None,
    timeout_s: float | None,
    on_sample: Callable[[JointSample], object] | None,
) -> bool:
    """Waits for the end of a run, and hands on its samples; returns true if it ended in time."""
    if samples is None or on_sample is None:
        return line.poll(math.inf if timeout_s is None else timeout_s)
    until = math.inf if timeout_s is None else time.monotonic() + timeout_s
    runs = has_ended = False
    while time.monotonic() < until:
        if not has_ended and line.poll(0.0):
            has_ended = True
            until = time.monotonic() + LAST_SAMPLES_S
        if has_ended and not runs:
            break
        if not samples.poll(0.0 if has_ended else PAUSE_S):
            if has_ended:
                break
            continue
        topic, text = samples.receive()
        if topic == b"state":
            # Samples before the published state of a run do not belong to it.
            runs = state_message(text) != "idle"
        elif runs:
            on_sample(joint_sample(text))
    return has_ended or line.poll(0.0)


def _check_callable(on_sample: object) -> None:
    """Raises `TypeError` for an invalid `on_sample` before the robot moves."""
    if on_sample is not None and not callable(on_sample):
        raise TypeError(f"on_sample is {on_sample!r}; a function of a JointSample is expected")


def _caution(conditions: Conditions) -> str:
    """Reasons for runs to take longer than planned; empty without a reason."""
    causes = []
    if conditions.override_rel is not None and conditions.override_rel < 1.0:
        causes.append(f"the override is {100 * conditions.override_rel:g} %")
    if conditions.operation_mode == "t1":
        causes.append("the operation mode is T1, which limits velocities")
    return ", and ".join(causes)


def _unknown_position(fri: FriState) -> str:
    why = "the position of the robot is unknown: the drive receives nothing from the controller"
    if fri.unexpected_source is None:
        return why
    return f"{why}, but FRI messages from {fri.unexpected_source} (iiwasim drive --fri-cabinet)"
