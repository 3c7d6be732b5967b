"""What a drive tells: its replies, its stream, its refusals."""

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

# What texts that are not as they should be lead to.
MALFORMED = (ValueError, KeyError, TypeError, IndexError, AttributeError, RecursionError)


class JointSample(NamedTuple):
    """Measured joint positions."""

    t_s: float
    """Time by the controller's clock, in s since its first message to the drive."""
    q: Joints
    """The positions, in rad, (7,)."""


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """What was measured in a run, with every cycle of the controller."""

    cycle_time_s: float | None
    """From start to end, in s; `None` if it is unknown, and `untimed_because` says why."""
    t: npt.NDArray[np.float64]
    """Times since the start, in s, (n,)."""
    q: Joints
    """Measured joint positions at these times, in rad, (n, 7)."""
    start_s: float
    """When it started, by the clock of `JointSample.t_s`, in s; the first sample, if the start is unknown."""
    timed_by: str | None = None
    """`commanded_position` if the times were taken from these; `None` if the robot program told them."""
    untimed_because: str | None = None
    """Why there is no cycle time."""
    samples_left_out: int = 0
    """Number of further samples, which the drive did not keep."""

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
    """Such as `monitoring_ready`; `silent` if the controller sends nothing."""
    quality: str
    """The controller's rating: `poor`, `fair`, `good` or `excellent`."""
    lost: int
    """Number of the controller's messages that did not arrive."""
    late: int
    """Number of those that arrived after a later one."""
    safety_stop: bool = False
    """Whether the safety controller demands a stop."""
    unexpected_source: str | None = None
    """Another IP than the expected one that messages come from."""


@dataclass(frozen=True)
class RobotProgram:
    """The program at the controller that the drive instructs."""

    connected: bool
    """Whether its messages arrive."""
    name: str | None = None
    """Name and version, if it tells them."""
    protocol: int | None = None
    """Version of its protocol, if it tells it."""
    sunrise: str | None = None
    """Version of Sunrise, if it tells it."""


@dataclass(frozen=True)
class Conditions:
    """Conditions at the controller; `None` is unknown."""

    operation_mode: str | None = None
    """`t1`, `t2`, `aut` or another one."""
    override_rel: float | None = None
    """What velocities are scaled by, from 0 to 1."""
    safety_stop: bool | None = None
    """Whether a safety stop is active."""
    tool: str | None = None
    """Name of the attached tool."""


@dataclass(frozen=True)
class RobotIdentity:
    """The identity of a robot arm: two arms with the same lengths are the same."""

    model: str
    """Name of the model or of the profile."""
    lengths_mm: Mapping[str, float]
    """The Denavit-Hartenberg lengths d1, d3, d5 and d7, in mm: `base`, `upper_arm`, `forearm`, `flange`."""


@dataclass(frozen=True, eq=False)
class DriveState:
    """A snapshot of drive and robot."""

    state: str
    """`idle`, `running_motion` or `running_trajectory`."""
    q: Joints | None
    """Measured joint positions, in rad, (7,); `None` before the controller's first message."""
    t_s: float | None
    """Their time, by the clock of `JointSample.t_s`."""
    fri: FriState
    """The connection to the controller."""
    robot_program: RobotProgram
    """The robot program."""
    conditions: Conditions = field(default_factory=Conditions)
    """The conditions, as far as the robot program tells them."""
    simulated: bool = False
    """Whether the robot is a simulated one."""
    robot: RobotIdentity | None = None
    """The robot that the drive is set up for; `None` from a drive of an older version."""


@dataclass(frozen=True, eq=False)
class Sensors:
    """Readings of the robot's sensors."""

    external_torque_nm: npt.NDArray[np.float64]
    """External torques of the joints, in Nm, (7,)."""
    joint_temperature_c: npt.NDArray[np.float64] | None = None
    """Temperatures of the joints, in degrees Celsius, (7,); `None` if the controller does not report them."""


@dataclass(frozen=True)
class Signal:
    """An input or output of the robot."""

    name: str
    """Its name, as `MediaFlange.LEDBlue`."""
    direction: str
    """`input`, or `output`, which can be set."""
    value: IoValue
    """Its value."""


class DriveError(RuntimeError):
    """What the drive, or the robot, refused or broke off, and why."""

    def __init__(self, code: str, message: str, run: Run | None = None) -> None:
        super().__init__(code, message, run)
        self.code = code
        """`bad_request`, `not_idle`, `limit`, `start_mismatch`, `robot`, `timeout` or `unauthorized`."""
        self.message = message
        """The reason, for people."""
        self.run = run
        """What was measured up to then, if it was a run that had begun."""

    def __str__(self) -> str:
        return f"{self.message} ({self.code})"


class DriveTimeout(DriveError):
    """No answer: there is no drive, it does not accept the keys (code `unauthorized`), or something took too long."""


def read_reply(text: bytes, read: Callable[[dict[str, Any]], T]) -> T:
    """What a reply says; a refusal is raised, with what it has of a run."""
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
    """What a reply has of a run, whatever became of it."""
    if text is None:
        return None
    try:
        return read_reply(text, read_run)
    except DriveError as error:
        return error.run


def read_run(reply: dict[str, Any]) -> Run:
    """The samples from the start of the run on, as in `iiwasim run`."""
    samples = reply["samples"]
    stamps = np.asarray(samples["t_s"], dtype=np.float64)
    q = np.asarray(samples["joints_rad"], dtype=np.float64).reshape(len(stamps), 7)
    start_s = float(reply.get("start_s", stamps[0] if len(stamps) else 0.0))
    # Stamps are rounded sums: the first sample may be just before the start.
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
    """A message of the stream."""
    try:
        message = json.loads(text)
        return JointSample(float(message["t_s"]), _joints(message["joints_rad"]))
    except MALFORMED as error:
        raise DriveError("bad_request", f"invalid message of the drive: {error!r}") from error


def state_message(text: bytes) -> str:
    """The state in a message of the stream."""
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
    """The keys that a dataclass has; later versions of the drive may send more."""
    names = [known.name for known in fields(kind)]
    return {name: keys[name] for name in names if name in keys}
