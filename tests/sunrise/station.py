"""Stations with frames, tools, workpieces and process data, and the corresponding Sunrise data
file.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from poses import Pose, joints, turn

ROBOT = "LBR_iiwa_7_R800_1"
PACKAGE = "com.kuka.roboticsAPI"


@dataclass(frozen=True)
class Load:
    """A load: kg, mm and kg m^2, about axes parallel to the axes of its root."""

    mass: float
    center: tuple[float, float, float] = (0, 0, 0)
    inertia: tuple[float, float, float] = (0, 0, 0)

    def keys(self) -> dict:
        return {
            "mass_kg": self.mass,
            "center_mm": list(self.center),
            "inertia_kg_m2": list(self.inertia),
        }

    def moved(self, z: float) -> Load:
        """The load with its root shifted to z of another."""
        x, y, own = self.center
        return Load(self.mass, (x, y, own + z), self.inertia)

    def with_one(self, other: Load) -> Load:
        """Both loads combined; both centres are on the z axis, so that the axes do not change."""
        assert self.center[:2] == other.center[:2] == (0, 0)
        mass = self.mass + other.mass
        z = (self.mass * self.center[2] + other.mass * other.center[2]) / mass
        arms = [(load.mass, 1e-3 * (load.center[2] - z)) for load in (self, other)]
        by_distance = sum(m * arm * arm for m, arm in arms)
        inertia = [own + its for own, its in zip(self.inertia, other.inertia)]
        return Load(
            mass, (0, 0, z), (inertia[0] + by_distance, inertia[1] + by_distance, inertia[2])
        )


@dataclass(frozen=True)
class Frame:
    """A frame in its parent; taught if it has a status."""

    pose: Pose
    e1: float | None = None
    status: int | None = None
    tcp: str | None = None


@dataclass
class Tool:
    """A tool template: its TCPs in the flange frame; the first one is the default TCP."""

    tcps: dict[str, Pose] = field(default_factory=dict)
    load: Load | None = None


@dataclass
class ProcessData:
    """A value that the operator may change."""

    kind: str
    default: str
    value: str | None = None
    least: str | None = None
    most: str | None = None


@dataclass
class Station:
    """Frames by path, tools and workpieces by name, process data by id."""

    frames: dict[str, Frame] = field(default_factory=dict)
    tools: dict[str, Tool] = field(default_factory=dict)
    workpieces: dict[str, Load] = field(default_factory=dict)
    data: dict[str, ProcessData] = field(default_factory=dict)

    def world(self, path: str) -> Pose:
        """A frame in the world, which is the robot foot."""
        parent, _, _ = path.rpartition("/")
        own = self.frames[path].pose
        return self.world(parent).then(own) if parent else own

    def children(self, path: str) -> list[str]:
        return [name for name in self.frames if name.rpartition("/")[0] == path]

    def tcp(self, name: str | None) -> Pose:
        """A TCP by `TOOL/TCP`, in the flange frame."""
        if name is None:
            return Pose()
        tool, _, tip = name.partition("/")
        return self.tools[tool].tcps[tip]

    def turn(self, path: str) -> int | None:
        """The turn of a taught frame."""
        frame = self.frames[path]
        if frame.status is None or frame.e1 is None:
            return None
        flange = self.world(path).then(self.tcp(frame.tcp).inverse())
        return turn(joints(flange, frame.e1, frame.status))

    def redundancy(self, path: str) -> dict:
        """The redundancy data in programs."""
        frame = self.frames[path]
        if frame.status is None:
            return {}
        return {"e1_rad": frame.e1, "status": frame.status, "turn": self.turn(path)}

    def target(self, path: str) -> dict:
        """An entry of `frames`."""
        parent = path.rpartition("/")[0]
        return {**self.frames[path].pose.keys(), "base": parent or "robot", **self.redundancy(path)}

    def base(self, path: str) -> dict:
        """An entry of `bases`."""
        parent = path.rpartition("/")[0]
        return self.frames[path].pose.keys() | ({"base": parent} if parent else {})

    def tool(self, name: str) -> dict:
        """An entry of `tools`."""
        tool = self.tools[name]
        names = list(tool.tcps)
        entry: dict = {"tcp": (tool.tcps[names[0]] if names else Pose()).keys()}
        if names[1:]:
            entry["tips"] = {tip: tool.tcps[tip].keys() for tip in names[1:]}
        if tool.load:
            entry["load"] = tool.load.keys()
        return entry

    def xml(self) -> str:
        """The data file."""
        lines = [
            '<?xml version="1.0" encoding="UTF-8" standalone="no"?>',
            '<RoboticsAPIData version="3">',
            "  <world>",
        ]
        lines.append('    <gravitation x="0.0" y="0.0" z="9.81"/>')
        for path in self.children(""):
            lines += self.frame_lines(path, "    ")
        lines += ["  </world>", "  <objectTemplates>"]
        for name, tool in self.tools.items():
            lines += tool_lines(name, tool)
        for name, load in self.workpieces.items():
            lines.append(
                f'    <workpieceTemplate class="{PACKAGE}.geometricModel.Workpiece" name="{name}">'
            )
            lines += [load_line(load), "    </workpieceTemplate>"]
        lines += ["  </objectTemplates>"]
        if self.data:
            lines.append("  <processDataContainer>")
            for name, entry in self.data.items():
                optional = {"value": entry.value, "min": entry.least, "max": entry.most}
                given = "".join(
                    f' {key}="{value}"' for key, value in optional.items() if value is not None
                )
                kind = f"java.lang.{entry.kind}"
                lines.append(
                    f'    <processData dataType="{kind}" defaultValue="{entry.default}" '
                    f'id="{name}"{given}/>'
                )
            lines.append("  </processDataContainer>")
        return "\n".join([*lines, "</RoboticsAPIData>", ""])

    def frame_lines(self, path: str, indent: str) -> list[str]:
        frame = self.frames[path]
        lines = [
            f'{indent}<frame name="{path.rpartition("/")[2]}">',
            f"{indent}  {pose_line(frame.pose)}",
        ]
        if frame.status is not None:
            lines += [f"{indent}  {line}" for line in self.taught_lines(path)]
        for child in self.children(path):
            lines += self.frame_lines(child, indent + "  ")
        return [*lines, f"{indent}</frame>"]

    def taught_lines(self, path: str) -> list[str]:
        frame = self.frames[path]
        tcp = frame.tcp or "Flange"
        kind = f"{PACKAGE}.deviceModel"
        values = {
            "StatusTurnRedundancy$StatusParameter": frame.status,
            "StatusTurnRedundancy$TurnParameter": self.turn(path),
            "LBRE1Redundancy$E1Parameter": frame.e1,
        }
        return [
            "<additionalInformation>",
            (
                f'  <info base="World" device="{ROBOT}" tcpName="{tcp}" '
                f'type="{PACKAGE}.persistenceModel.TeachInformation">'
            ),
            f"    {pose_line(self.tcp(frame.tcp), 'tcpTransformation')}",
            "  </info>",
            "</additionalInformation>",
            "<redundancyData>",
            (
                f'  <redundancy transformationProviderName="Cabinet/{ROBOT}" '
                f'type="{kind}.LBRE1Redundancy">'
            ),
            *[
                f'    <info type="{kind}.{name}" value="{value}"/>'
                for name, value in values.items()
                if value is not None
            ],
            "  </redundancy>",
            "</redundancyData>",
        ]


def pose_line(pose: Pose, name: str = "transformation") -> str:
    values = {"a": pose.a, "b": pose.b, "c": pose.c, "x": pose.x, "y": pose.y, "z": pose.z}
    return f"<{name} " + " ".join(f'{key}="{float(value)}"' for key, value in values.items()) + "/>"


def load_line(load: Load) -> str:
    values = dict(zip(["cogX", "cogY", "cogZ"], load.center)) | dict(
        zip(["inertiaX", "inertiaY", "inertiaZ"], load.inertia)
    )
    given = " ".join(f'{key}="{float(value)}"' for key, value in values.items())
    return f'      <loadData cogA="0.0" cogB="0.0" cogC="0.0" {given} mass="{float(load.mass)}"/>'


def tool_lines(name: str, tool: Tool) -> list[str]:
    moves = f' defaultMotionFrameRef="/{next(iter(tool.tcps))}"' if tool.tcps else ""
    lines = [
        f'    <toolTemplate class="{PACKAGE}.geometricModel.Tool"{moves} name="{name}">',
        "      <frames>",
    ]
    for tip, pose in tool.tcps.items():
        lines += [
            f'        <frame name="{tip}">',
            f"          {pose_line(pose)}",
            "        </frame>",
        ]
    lines.append("      </frames>")
    if tool.load:
        lines.append(load_line(tool.load))
    return [*lines, "    </toolTemplate>"]
