"""Messages from a drive: replies, stream messages and errors."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import TypeAlias

T = TypeVar("T")
Joints = npt.NDArray[np.float64]
IoValue: TypeAlias = "bool | int | float"

# Exceptions that malformed messages lead to.
MALFORMED = (ValueError, KeyError, TypeError, IndexError, AttributeError, RecursionError)


class JointSample(NamedTuple):
    """Measured joint positions."""

    t_s: float
    """Time by the controller's clock, in s since its first message to the drive."""
    q: Joints
    """The positions, in rad, (7,)."""


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """Measurements of a run, in every cycle of the controller."""

    cycle_time_s: float | None
    """Time from start to end, in s; `None` if unknown, for the reason in `untimed_because`."""
    t: npt.NDArray[np.float64]
    """Times since the start, in s, (n,)."""
    q: Joints
    """Measured joint positions at these times, in rad, (n, 7)."""
    start_s: float
    """Start time by the clock of `JointSample.t_s`, in s.

    If the start is unknown, the time of the first sample.
    """
    timed_by: str | None = None
    """`commanded_position` if start and end were found from the commanded positions; `None` if the
    robot program reported them.
    """
    untimed_because: str | None = None
    """Reason for a missing cycle time."""
    samples_left_out: int = 0
    """Number of further samples that the drive did not keep."""

    def __repr__(self) -> str:
        took = (
            "no cycle time"
            if self.cycle_time_s is None
            else f"cycle time {self.cycle_time_s:.3f} s"
        )
        return f"<Run: {took}, {len(self.t)} samples>"


@dataclass(frozen=True)
class FriState:
    """The connection between drive and controller."""

    session: str
    """State of the FRI session, such as `monitoring_ready`; `silent` without messages."""
    quality: str
    """Connection quality reported by the controller: `poor`, `fair`, `good` or `excellent`."""
    lost: int
    """Number of controller messages that did not arrive."""
    late: int
    """Number of controller messages that arrived after a later one."""
    safety_stop: bool = False
    """`True` if the safety controller demands a stop."""
    unexpected_source: str | None = None
    """IP address of messages that are not from the expected address."""


@dataclass(frozen=True)
class RobotProgram:
    """The program on the controller that executes requests of the drive."""

    connected: bool
    """`True` if messages of the robot program arrive."""
    name: str | None = None
    """Name and version, if reported."""
    protocol: int | None = None
    """Protocol version, if reported."""
    sunrise: str | None = None
    """Sunrise version, if reported."""


@dataclass(frozen=True)
class Conditions:
    """Conditions at the controller; `None` means unknown."""

    operation_mode: str | None = None
    """Operation mode: `t1`, `t2`, `aut` or another one."""
    override_rel: float | None = None
    """Override: scaling factor of velocities, from 0 to 1."""
    safety_stop: bool | None = None
    """`True` if a safety stop is active."""
    tool: str | None = None
    """Name of the attached tool."""


@dataclass(frozen=True)
class RobotIdentity:
    """The identity of a robot: robots with equal lengths are treated as the same."""

    model: str
    """Name of the model or profile."""
    lengths_mm: Mapping[str, float]
    """Denavit-Hartenberg lengths in mm: `base` (d1), `upper_arm` (d3), `forearm` (d5) and
    `flange` (d7).
    """


@dataclass(frozen=True, eq=False)
class DriveState:
    """A snapshot of drive and robot."""

    state: str
    """`idle`, `running_motion` or `running_trajectory`."""
    q: Joints | None
    """Measured joint positions, in rad, (7,); `None` before the controller's first message."""
    t_s: float | None
    """Time of `q`, by the clock of `JointSample.t_s`, in s."""
    fri: FriState
    """The connection to the controller."""
    robot_program: RobotProgram
    """The robot program."""
    conditions: Conditions = field(default_factory=Conditions)
    """The conditions that the robot program reports."""
    simulated: bool = False
    """`True` if the robot is simulated."""
    robot: RobotIdentity | None = None
    """The robot for which the drive is configured; `None` from an older version of the drive."""


@dataclass(frozen=True, eq=False)
class Sensors:
    """Readings of the robot's sensors."""

    external_torque_nm: npt.NDArray[np.float64]
    """External joint torques, in Nm, (7,)."""
    joint_temperature_c: npt.NDArray[np.float64] | None = None
    """Joint temperatures, in degrees Celsius, (7,); `None` if the controller does not report them.
    """


@dataclass(frozen=True)
class Signal:
    """An input or output of the robot."""

    name: str
    """Name, such as `MediaFlange.LEDBlue`."""
    direction: str
    """`input` or `output`; only outputs can be set."""
    value: IoValue
    """Current value."""


class DriveError(RuntimeError):
    """A request that the drive or the robot refused or aborted."""

    def __init__(self, code: str, message: str, run: Run | None = None) -> None:
        super().__init__(code, message, run)
        self.code = code
        """`bad_request`, `not_idle`, `limit`, `start_mismatch`, `robot`, `timeout` or
        `unauthorized`.
        """
        self.message = message
        """The reason, in words."""
        self.run = run
        """The measurements up to the error, if a run had begun."""

    def __str__(self) -> str:
        return f"{self.message} ({self.code})"


class DriveTimeout(DriveError):
    """The drive does not answer in time, or does not accept the keys (code `unauthorized`)."""


def read_reply(text: bytes, read: Callable[[dict[str, Any]], T]) -> T:
    """Reads a reply; raises a refusal as `DriveError`, with the measurements that it has."""
    try:
        reply = json.loads(text)
        if reply["ok"]:
            return read(reply)
        code, message = str(reply["error"]["code"]), str(reply["error"]["message"])
        run = read_run(reply) if reply.get("samples", {}).get("t_s") else None
    except MALFORMED as error:
        raise DriveError("bad_request", f"invalid reply of the drive: {error!r}") from error
    raise (DriveTimeout if code == "timeout" else DriveError)(code, message, run)


def run_of(text: bytes | None) -> Run | None:
    """The measurements in a reply, also of a run that failed; `None` without measurements."""
    if text is None:
        return None
    try:
        return read_reply(text, read_run)
    except DriveError as error:
        return error.run


def read_run(reply: dict[str, Any]) -> Run:
    """Reads a run, with the samples from its start on, as `iiwasim run` does."""
    samples = reply["samples"]
    stamps = np.asarray(samples["t_s"], dtype=np.float64)
    q = np.asarray(samples["joints_rad"], dtype=np.float64).reshape(len(stamps), 7)
    start_s = float(reply.get("start_s", stamps[0] if len(stamps) else 0.0))
    # Time stamps are rounded sums: the first sample may be just before the start.
    first = int(np.searchsorted(stamps - start_s, -1e-6, side="right"))
    t = np.maximum(stamps[first:] - start_s, 0.0)
    told = {name: reply.get(name) for name in ("cycle_time_s", "timed_by", "untimed_because")}
    left_out = reply.get("samples_left_out", 0)
    return Run(t=_fixed(t), q=_fixed(q[first:]), start_s=start_s, samples_left_out=left_out, **told)


def read_state(reply: dict[str, Any]) -> DriveState:
    hello = reply.get("hello", {})
    conditions = dict(reply.get("conditions", {}))
    conditions["override_rel"] = conditions.pop("override", None)
    return DriveState(
        state=reply["state"],
        q=None if reply["joints_rad"] is None else _joints(reply["joints_rad"]),
        t_s=reply["t_s"],
        fri=FriState(**_known(FriState, reply["fri"])),
        robot_program=RobotProgram(
            connected=reply["robot_program"] == "connected",
            name=hello.get("program"),
            protocol=hello.get("protocol"),
            sunrise=hello.get("sunrise"),
        ),
        conditions=Conditions(**_known(Conditions, conditions)),
        simulated=reply.get("simulated", False),
        robot=RobotIdentity(**_known(RobotIdentity, reply["robot"])) if "robot" in reply else None,
    )


def read_sensors(reply: dict[str, Any]) -> Sensors:
    sensors = reply["sensors"]
    temperatures = sensors.get("joint_temperature_c")
    return Sensors(
        _joints(sensors["external_torque_nm"]),
        None if temperatures is None else _joints(temperatures),
    )


def read_signals(reply: dict[str, Any]) -> list[Signal]:
    return [Signal(**_known(Signal, signal)) for signal in reply["io"]]


def read_value(reply: dict[str, Any]) -> IoValue:
    value: IoValue = reply["value"]
    return value


def joint_sample(text: bytes) -> JointSample:
    """Reads a stream message with joint positions."""
    try:
        message = json.loads(text)
        return JointSample(float(message["t_s"]), _joints(message["joints_rad"]))
    except MALFORMED as error:
        raise DriveError("bad_request", f"invalid message of the drive: {error!r}") from error


def state_message(text: bytes) -> str:
    """The state in a stream message."""
    try:
        return str(json.loads(text)["state"])
    except MALFORMED as error:
        raise DriveError("bad_request", f"invalid message of the drive: {error!r}") from error


def _joints(values: list[float]) -> Joints:
    return _fixed(np.asarray(values, dtype=np.float64).reshape(7))


def _fixed(array: Joints) -> Joints:
    array.setflags(write=False)
    return array


def _known(kind: type, keys: Mapping[str, Any]) -> dict[str, Any]:
    """The keys that are fields of a dataclass; later versions of the drive may send more."""
    names = [known.name for known in fields(kind)]
    return {name: keys[name] for name in names if name in keys}
