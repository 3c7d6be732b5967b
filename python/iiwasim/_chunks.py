"""Figures of one chunk of programs: the work of each worker."""

from __future__ import annotations

import hashlib
import inspect
from collections import defaultdict
from importlib.metadata import version
from operator import index
from typing import TYPE_CHECKING, Any, SupportsIndex, TypedDict

from ._errors import ProgramError
from ._native import Plan, Program, Robot, Scene, plan_all

try:
    import pyarrow as pa
except ImportError as error:
    raise ImportError(
        "figures of many programs need pyarrow: pip install 'iiwasim[batches]'"
    ) from error

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from os import PathLike

    from ._options import Search, Shape, Timing

FIGURES = pa.schema(
    {
        "cycle_time_s": pa.float64(),
        "motion_time_s": pa.float64(),
        "settle_time_s": pa.float64(),
        "wait_time_s": pa.float64(),
        "motions": pa.int32(),
        "limited_joint": pa.int8(),
        "limited_by": pa.string(),
        "peak_torque_percent": pa.float64(),
        "peak_torque_joint": pa.int8(),
        "clearance_m": pa.float64(),
        "clearance_obstacle": pa.string(),
        "error": pa.string(),
    }
)
"""The columns of figures, described in `iiwasim.batches`."""


# All options of `plan_all` with their defaults, except those for parallel execution.
DEFAULTS = {
    name: option.default
    for name, option in inspect.signature(plan_all).parameters.items()
    if option.kind is option.KEYWORD_ONLY and name not in ("jobs", "progress")
}


class Options(TypedDict, total=False):
    """Planning options of each program: the options of `plan_all`, and a scene."""

    robot: Robot | str | PathLike[str] | None
    timing: Timing
    blend_shape: Shape
    blend_search: Search
    samples: int
    limit_torque_percent: float | None
    override_percent: float | None
    scene: Scene | str | PathLike[str] | None


class Planning:
    """Planner of chunks. It is pickled for workers, which do not need the files of its options."""

    def __init__(self, column: str, options: Mapping[str, Any]) -> None:
        """Reads programs from `column`. Raises `ValueError` or `TypeError` for a wrong option."""
        self.version = version("iiwasim")
        self.column = column
        self.options = {**DEFAULTS, **options}
        scene = self.options.pop("scene", None)
        self.scene = scene if scene is None or isinstance(scene, Scene) else Scene.load(scene)
        robot = self.options["robot"]
        if robot is not None and not isinstance(robot, Robot):
            self.options["robot"] = Robot(robot)
        if unknown := [name for name in self.options if name not in DEFAULTS]:
            raise TypeError(
                f"there is no option {unknown[0]!r}; there are {', '.join(DEFAULTS)} and scene"
            )
        plan_all([], **self.options)
        # NumPy numbers are accepted, but JSON cannot represent them.
        self.options["samples"] = int(self.options["samples"])
        for name in ("limit_torque_percent", "override_percent"):
            if (percent := self.options[name]) is not None:
                self.options[name] = float(percent)

    def described(self) -> dict[str, Any]:
        """The options as JSON values: equal options lead to equal figures."""
        return {
            "iiwasim": self.version,
            "column": self.column,
            "scene": None if self.scene is None else _digest(self.scene),
            **{
                name: _digest(value) if isinstance(value, Robot) else value
                for name, value in self.options.items()
            },
        }

    def figures(self, chunk: pa.Table, look: Callable[[], object] = lambda: None) -> pa.Table:
        """The rows of a chunk, in their order, with figures in place of the program.

        `look` is called at least between programs; an exception that it raises ends the planning.

        Raises `RuntimeError` on a worker with another version, whose figures may differ.
        """
        if version("iiwasim") != self.version:
            raise RuntimeError(
                f"a worker has iiwasim {version('iiwasim')}; {self.version} is needed, as here"
            )
        rows = []
        for planned in self._planned(chunk.column(self.column).to_pylist(), look):
            look()
            rows.append(self._row(planned))
        figures = pa.Table.from_pylist(rows, schema=FIGURES)
        kept = chunk.drop_columns([self.column])
        for name in FIGURES.names:
            kept = kept.append_column(FIGURES.field(name), figures.column(name))
        return kept

    def _planned(
        self, texts: list[str | None], look: Callable[[], object]
    ) -> list[Plan | ProgramError]:
        read = []
        for text in texts:
            look()
            read.append(_read(text))
        programs = [program for program in read if isinstance(program, Program)]
        # `plan_all` also reports progress within programs; an exception raised there ends it.
        plans = iter(plan_all(programs, jobs=1, progress=lambda *_: look(), **self.options))
        return [next(plans) if isinstance(program, Program) else program for program in read]

    def _row(self, planned: Plan | ProgramError) -> dict[str, Any]:
        if isinstance(planned, ProgramError):
            return {"error": str(planned)}
        figures = planned.figures()
        row = {
            name: figures[name]
            for name in ("cycle_time_s", "motion_time_s", "settle_time_s", "wait_time_s")
        }
        row["motions"] = len(figures["motions"])
        row["limited_joint"], row["limited_by"] = _limit(figures["motions"])
        peaks = [
            peak
            for motion in figures["motions"]
            for peak in enumerate(motion["torque"]["peak_percent"], 1)
        ]
        # A program without duration, such as a single load, has no peak.
        none = (None, None)
        row["peak_torque_joint"], row["peak_torque_percent"] = max(
            peaks, key=lambda peak: peak[1], default=none
        )
        clearance = None if self.scene is None else planned.clearance(self.scene)
        if clearance is not None:
            row["clearance_m"], row["clearance_obstacle"] = clearance.distance_m, clearance.obstacle
        return row


def count(name: str, value: SupportsIndex) -> int:
    """The argument `name` as an integer of at least 1. Raises `TypeError` or `ValueError`."""
    try:
        number = index(value)
    except TypeError:
        raise TypeError(f"{name} is {value!r}; a whole number is expected") from None
    if number < 1:
        raise ValueError(f"{name} is {number}; at least 1 is needed")
    return number


def _read(text: str | None) -> Program | ProgramError:
    if text is None:
        return ProgramError("there is no program in this row")
    try:
        return Program.from_json(text)
    except ProgramError as error:
        return error
    except (ValueError, OSError) as error:
        # The robot that the program names cannot be read.
        return ProgramError(str(error))


def _limit(motions: list[dict[str, Any]]) -> tuple[int | None, str | None]:
    """Joint and kind of the limit that is active for the longest time in a program."""
    times: defaultdict[tuple[int | None, str], float] = defaultdict(float)
    for motion in motions:
        for limit in motion["limits"]:
            times[limit["joint"], limit["kind"]] += limit["share"] * (
                motion["end_s"] - motion["start_s"]
            )
    return max(times, key=lambda limit: times[limit]) if times else (None, None)


def _digest(value: Robot | Scene) -> str:
    return hashlib.sha256(str(value.__reduce__()[1]).encode()).hexdigest()
