"""Requests to a drive: programs, labels and their JSON."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from ._arrays import real_array

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from ._native import Robot
    from ._replies import Joints

# Keys of a program that are sent to the drive; the other keys are for planning only.
MOTION_KEYS = ("motions", "tools", "bases", "frames", "tool", "base", "mode", "mount")
MAX_BYTES = {"run_motions": 4 << 20, "run_trajectory": 32 << 20}
MAX_POINTS = 200_000


class ProgramText(Protocol):
    """An object with a motion program in JSON, such as `iiwasim.Program`."""

    def to_json(self) -> str:
        """The program in JSON."""
        ...


def as_robot(robot: Robot | str) -> Robot:
    from ._native import Robot as NativeRobot

    return NativeRobot(robot) if isinstance(robot, str) else robot


def robot_of(program: object, keys: dict[str, Any]) -> Robot:
    """The robot for which a program is written."""
    from ._native import Program, Robot

    return (
        program.robot
        if isinstance(program, Program)
        else Robot(keys.get("robot") or "lbr_iiwa_7_r800")
    )


def run_label(name: str | None, planned_s: float | None, robot: Robot | None) -> dict[str, Any]:
    """The label of a run request: statements about the run."""
    label: dict[str, Any] = {} if name is None else {"program": name}
    if robot is not None:
        label["planned_for"] = {
            "model": robot.name,
            "lengths_mm": json.loads(robot.profile())["lengths_mm"],
        }
    if planned_s is not None:
        if not 0.0 <= planned_s < math.inf:
            raise ValueError(f"planned_s is {planned_s}; give a time in s")
        label["plan"] = {"cycle_time_s": float(planned_s)}
    return {"label": label} if label else {}


def program_keys(program: ProgramText | Mapping[str, Any] | str) -> dict[str, Any]:
    """The keys of a program in any of its forms."""
    if isinstance(program, str):
        try:
            keys = json.loads(program)
        except ValueError as error:
            taken = "a str is taken for the JSON of a program, and iiwasim.Program.load reads files"
            raise ValueError(f"the program is not JSON: {error}; {taken}") from None
    elif hasattr(program, "to_json"):
        keys = json.loads(program.to_json())
    elif hasattr(program, "keys"):
        keys = dict(program)
    else:
        forms = (
            "an iiwasim.Program, of motions or of a file by its load, the keys of one, or its JSON "
            "as a str"
        )
        raise TypeError(f"a program is {forms}; found {type(program).__name__}")
    if not isinstance(keys, dict):
        raise TypeError(f"a program is a JSON object, found {type(keys).__name__}")
    if "include" in keys:
        included = f"the program includes {keys['include']!r}, which a drive cannot read"
        raise ValueError(f"{included}: load it by iiwasim.Program.load, which does")
    return keys


def check_without_signals(keys: dict[str, Any]) -> None:
    """Raises `ValueError` for a program with inputs or outputs, before the robot moves."""
    entries = _entries(keys.get("motions"))
    for entry in entries:
        if entry.get("type") in ("set", "wait_for"):
            raise ValueError(
                f"the program has an input or output ({entry['type']} {entry.get('io')!r}), and a "
                "drive runs motions only: split the program there and use Drive.set_io and "
                "Drive.get_io, or run its file with `iiwasim run`"
            )


def _entries(motions: object) -> Iterator[Mapping[str, Any]]:
    """The entries of a program, also those within repeat blocks."""
    if not isinstance(motions, (list, tuple)):
        return
    for entry in motions:
        if hasattr(entry, "get"):
            yield entry
            yield from _entries(entry.get("motions"))


def start_of(program: object, keys: dict[str, Any]) -> Joints | None:
    """The start of a program, in rad; `None` if it has no start."""
    if "start" not in keys:
        return None
    start = keys["start"]
    for name, to_rad in (("joints_rad", 1.0), ("joints_deg", math.pi / 180.0)):
        if isinstance(start, dict) and name in start:
            return seven_joints(start[name], f"the start's {name}") * to_rad
    # The start is a frame: its joint positions depend on the robot, which `Program` knows.
    from ._native import Program

    if not isinstance(program, Program):
        program = Program.from_json(json.dumps({"version": 1, **keys}, default=_plain))
    return seven_joints(program.start_rad, "the program's start")


def seven_joints(values: object, what: str) -> Joints:
    joints = real_array(what, values)
    if joints.shape != (7,) or not np.isfinite(joints).all():
        raise ValueError(
            f"{what} has to be seven finite numbers, A1 to A7; found {joints.tolist()}"
        )
    return joints


def request_text(request: dict[str, Any]) -> bytes:
    text = json.dumps(request, allow_nan=False, separators=(",", ":"), default=_plain).encode()
    most = MAX_BYTES.get(request["type"], 64 << 10)
    if len(text) > most:
        raise ValueError(f"the request has {len(text)} bytes, and a drive takes {most}: split it")
    return text


def _plain(value: object) -> object:
    """Converts NumPy arrays and numbers to JSON values."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no form in JSON")
