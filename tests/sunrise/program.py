"""Expected programs of the import, motion by motion."""

from __future__ import annotations

import json
import math
from pathlib import Path

from poses import FLANGE, Pose
from station import Load, Station


def exact_deg(rad: float) -> float:
    """An angle in deg that reads back exactly as `rad`, as conversion to deg and back may differ by
    one bit.
    """
    about = math.degrees(rad)
    near = [about, math.nextafter(about, math.inf), math.nextafter(about, -math.inf)]
    return next((deg for deg in near if math.radians(deg) == rad), about)


# Keys of motions in the order of written programs.
ORDER = [
    *[
        "type",
        "io",
        "value",
        "joints_rad",
        "offset",
        "in",
        "aux",
        "frame",
        "circ_angle_deg",
        "orientation_reference",
        "segments",
    ],
    *["seconds", "overlap", "overlap_motions", "load", "tool", "orientation"],
    *["velocity_rel", "acceleration_rel", "jerk_rel"],
    *["cart_velocity_mm_s", "cart_acceleration_mm_s2", "cart_jerk_mm_s3"],
    *[
        "orientation_velocity_deg_s",
        "orientation_acceleration_deg_s2",
        "blend",
        "blocking",
        "source",
    ],
]


class Program:
    """Start and motions of a program; `folder` has the sources of the project."""

    def __init__(self, folder: Path, station: Station, main: str, tool: str | None = None) -> None:
        self.folder, self.station, self.main, self.tool = folder, station, main, tool
        self.motions: list[dict] = []
        self.used_tools = {tool} if tool else set()
        self.used_frames: set[str] = set()
        self.used_bases: set[str] = set()

    def source(self, place: str | tuple[str, str]) -> dict:
        """The place of a call, found by text that is unique to its line; a file name may precede
        it.
        """
        name, text = place if isinstance(place, tuple) else (self.main, place)
        (file,) = sorted(self.folder.glob(f"src/**/{name}.java"))
        lines = file.read_text(encoding="utf-8").split("\n")
        found = [number for number, line in enumerate(lines, 1) if text in line]
        assert len(found) == 1, f"{file}: `{text}` is in lines {found}"
        return {"file": file.relative_to(self.folder).as_posix(), "line": found[0]}

    def add(self, kind: str, place: str | tuple[str, str], **keys: object) -> None:
        if kind not in ("wait", "set", "wait_for") and not keys.get("blend"):
            # By default, the program waits for the end of the motion.
            keys.setdefault("blocking", True)
        given = {key: value for key, value in keys.items() if value is not None}
        motion = {"type": kind, **given, "source": self.source(place)}
        self.motions.append({key: motion[key] for key in sorted(motion, key=ORDER.index)})

    def ptp(
        self, to: list[float] | str | dict, place: str | tuple[str, str], **keys: object
    ) -> None:
        if isinstance(to, list):
            self.add("ptp", place, joints_rad=[float(value) for value in to], **keys)
        else:
            self.path("ptp", place, frame=to, **keys)

    def lin(self, to: str | dict, place: str | tuple[str, str], **keys: object) -> None:
        self.path("lin", place, frame=to, **keys)

    def lin_rel(self, offset: Pose, place: str | tuple[str, str], **keys: object) -> None:
        self.path("lin_rel", place, offset=offset.keys(), **keys)

    def path(
        self, kind: str, place: str | tuple[str, str], tool: str | None = None, **keys: object
    ) -> None:
        """Adds a motion of a TCP; `tool` if it differs from the tool of the program."""
        self.use_tool(tool)
        for target in [keys.get("frame"), keys.get("aux"), keys.get("in")]:
            self.use(target)
        for segment in keys.get("segments", []):
            self.use(segment["frame"])
            self.use(segment.get("aux"))
        self.add(kind, place, **keys, tool=tool)

    def use_tool(self, tool: str | None) -> None:
        if tool and tool != "flange":
            self.used_tools.add(tool.partition("/")[0])

    def use(self, target: object) -> None:
        if isinstance(target, dict):
            self.use_base(target["base"])
        elif isinstance(target, str):
            self.used_frames.add(target)
            self.use_base(target.rpartition("/")[0])

    def use_base(self, path: str) -> None:
        while path and path != "robot":
            self.used_bases.add(path)
            path = path.rpartition("/")[0]

    def wait(self, seconds: float, place: str | tuple[str, str], overlap: int = 0) -> None:
        how = {0: {}, 1: {"overlap": True}}.get(overlap, {"overlap_motions": overlap})
        self.add("wait", place, seconds=seconds, **how)

    def set(self, io: str, value: object, place: str | tuple[str, str]) -> None:
        self.add("set", place, io=io, value=value)

    def wait_for(self, io: str, value: object, place: str | tuple[str, str]) -> None:
        """A wait for an input whose time is not stated."""
        self.add("wait_for", place, io=io, value=value, seconds=0)

    def load(self, load: Load | None, place: str | tuple[str, str]) -> None:
        source = {"source": self.source(place)}
        self.motions.append({"type": "load", "load": load.keys() if load else None} | source)

    def text(self) -> str:
        """The program as JSON, with one line per entry and motion."""
        station = self.station
        named = {
            "tools": {name: station.tool(name) for name in sorted(self.used_tools)},
            "bases": {name: station.base(name) for name in sorted(self.used_bases)},
            "frames": {name: station.target(name) for name in sorted(self.used_frames)},
        }
        parts = [
            '  "version": 1',
            '  "robot": "lbr_iiwa_7_r800"',
            f'  "flange_mm": {FLANGE}',
            '  "start": { "joints_rad": [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0] }',
        ]
        for key, entries in named.items():
            if entries:
                lines = [
                    f"    {json.dumps(name)}: {json.dumps(entry)}"
                    for name, entry in entries.items()
                ]
                parts.append(f'  "{key}": {{\n' + ",\n".join(lines) + "\n  }")
        if self.tool:
            parts.append(f'  "tool": {json.dumps(self.tool)}')
        motions = [f"    {json.dumps(motion)}" for motion in self.motions]
        parts.append('  "motions": [\n' + ",\n".join(motions) + "\n  ]")
        return "{\n" + ",\n".join(parts) + "\n}\n"


def placed(pose: Pose, redundancy: dict | None = None) -> dict:
    """An inline target, relative to the robot foot."""
    return {**pose.keys(), "base": "robot", **(redundancy or {})}
