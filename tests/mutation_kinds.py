"""Kinds of input files: small valid files, what is beside them, and the commands that read them."""

from __future__ import annotations

import json
import struct
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SEEDS = ROOT / "tests/fuzz/seeds"
FIXTURES = ROOT / "fixtures"
ROBOT = "lbr_iiwa_7_r800"
# A box of 40 x 30 x 60 mm.
CORNERS = [(x, y, z) for z in (0, 60) for y in (-15, 15) for x in (-20, 20)]
TRIANGLES = [
    tuple(map(int, corners))
    for corners in [
        "021",
        "123",
        "456",
        "576",
        "014",
        "154",
        "263",
        "367",
        "042",
        "246",
        "135",
        "375",
    ]
]
PROGRAM = {
    "version": 1,
    "robot": ROBOT,
    "start": {"joints_deg": [0, 30, 0, -60, 0, 90, 0]},
    "motions": [
        {"type": "ptp", "joints_deg": [110, 30, 0, -60, 0, 90, 0]},
        {"type": "ptp", "joints_deg": [30, 40, 0, -60, 0, 90, 0], "blend": {"fraction": 0.3}},
        {"type": "ptp", "joints_deg": [10, 40, 5, -60, 0, 80, 0]},
        {"type": "wait", "seconds": 0.2},
    ],
}
DOWN = {"a_deg": 0, "b_deg": 180, "c_deg": 0}
# All types of motions.
PATHS = {
    "version": 1,
    "mount": {"rpy_deg": [0, 0, 90]},
    "override_percent": 80,
    "tools": {"pen": {"tcp": {"z_mm": 120}, "load": {"mass_kg": 1.2, "center_mm": [0, 0, 60]}}},
    "bases": {"table": {"x_mm": 500, "y_mm": -150, "z_mm": 100}},
    "frames": {
        "via": {"base": "table", "x_mm": 80, "y_mm": 220, "z_mm": 150, **DOWN},
        "place": {"base": "table", "x_mm": 0, "y_mm": 300, "z_mm": 150, **DOWN},
    },
    "tool": "pen",
    "start": {"joints_deg": [0, 30, 0, -60, 0, 90, 0]},
    "motions": [
        {
            "type": "lin",
            "frame": {"x_mm": 500, "y_mm": 0, "z_mm": 300, **DOWN},
            "blend": {"cart_mm": 20},
        },
        {"type": "circ", "aux": "via", "frame": "place", "cart_velocity_mm_s": 300},
        {"type": "lin_rel", "offset": {"x_mm": 30}},
        {
            "type": "spline",
            "segments": [
                {"type": "spl", "frame": "via"},
                {"type": "lin", "frame": "place", "cart_velocity_mm_s": 100},
            ],
        },
        {"type": "set", "io": "Gripper.Close", "value": True},
        {"type": "wait_for", "io": "Gripper.Closed", "value": True, "seconds": 0.3},
        {
            "type": "load",
            "load": {
                "mass_kg": 2,
                "shapes": [
                    {"type": "box", "center_mm": [0, 0, 180], "size_mm": [200, 60, 40]},
                    {"type": "sphere", "center_mm": [0, 0, 150], "radius_mm": 30},
                ],
            },
        },
        {
            "type": "repeat",
            "count": 2,
            "motions": [
                {"type": "lin_rel", "offset": {"z_mm": 20}, "blend": {"cart_mm": 5}},
                {
                    "type": "repeat",
                    "count": 3,
                    "name": "row",
                    "motions": [{"type": "lin_rel", "offset": {"x_mm": 5}}],
                },
                {"type": "lin_rel", "offset": {"x_mm": -15, "z_mm": -20}},
            ],
        },
        {"type": "load", "load": None},
        {"type": "wait", "seconds": 0.1},
    ],
}
FRAMES = {key: PATHS[key] for key in ("version", "tools", "bases", "frames")}
WITH_FRAMES = {
    "version": 1,
    "include": "frames.json",
    "tool": "pen",
    "start": {"joints_deg": [0, 30, 0, -60, 0, 90, 0]},
    "motions": [{"type": "ptp", "frame": "via"}, {"type": "lin", "frame": "place"}],
}
TOOL_SCENE = {
    "version": 1,
    "obstacles": [
        {"name": "post", "type": "box", "center_mm": [600, 0, 300], "size_mm": [80, 80, 600]},
        {"name": "lamp", "type": "sphere", "center_mm": [0, 700, 900], "radius_mm": 80},
        {
            "name": "rail",
            "type": "cylinder",
            "center_mm": [0, -700, 300],
            "rpy_deg": [0, 90, 0],
            "radius_mm": 40,
            "length_mm": 500,
        },
    ],
    "tool": [
        {"type": "cylinder", "center_mm": [0, 0, 40], "radius_mm": 30, "length_mm": 80},
        {"type": "sphere", "center_mm": [0, 30, 115], "radius_mm": 10},
    ],
    "ignore": [["link 2", "post"]],
}
POSES = (
    "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg,e1_deg,status,turn\n"
    "500,0,600,0,180,0,0,2,0\n450,120.5,550,10,170,0,5,2,0\n9000,0,600,0,180,0,0,2,0\n"
)
JOINTS = "joint_1_deg;joint_2_deg;joint_3_deg;joint_4_deg;joint_5_deg;joint_6_deg;joint_7_deg\n"
JOINTS += "0;30;0;-60;0;90;0\n10.5;-20;1e1;-60;0;90;170\n"


@dataclass(frozen=True)
class Seed:
    """A valid file, by path in the folder of a run, with the files beside it."""

    path: str
    data: bytes
    beside: dict[str, bytes] = field(default_factory=dict)
    # Class of the application in a Sunrise project.
    application: str = ""


@dataclass(frozen=True)
class Kind:
    """A kind of input. `< FILE` in a command redirects standard input."""

    name: str
    seeds: list[Seed]
    commands: list[str]
    # Further files for splices, which may be invalid.
    donors: list[bytes] = field(default_factory=list)
    is_binary: bool = False


def text(value: object) -> bytes:
    return json.dumps(value, indent=1).encode()


def fuzz_seeds(folder: str, skipped: int = 0) -> list[bytes]:
    """Files of a fuzz target; those of meshes begin with a byte that selects the format."""
    return [path.read_bytes()[skipped:] for path in sorted((SEEDS / folder).iterdir())]


# ---- meshes


def obj() -> bytes:
    lines = ["# a box", "mtllib a.mtl", *(f"v {x} {y} {z}" for x, y, z in CORNERS), "vn 0 0 1"]
    faces = [f"f {a + 1}//1 {b + 1}//1 {c + 1}//1" for a, b, c in TRIANGLES]
    return "\n".join([*lines, "g sides", *faces, ""]).encode()


def stl_binary() -> bytes:
    triangles = [
        struct.pack("<12fH", 0, 0, 0, *CORNERS[a], *CORNERS[b], *CORNERS[c], 0)
        for a, b, c in TRIANGLES
    ]
    return b"box".ljust(80, b"\0") + struct.pack("<I", len(triangles)) + b"".join(triangles)


def stl_ascii() -> bytes:
    lines = ["solid box"]
    for triangle in TRIANGLES:
        lines += ["facet normal 0 0 0", " outer loop"]
        lines += ["  vertex {} {} {}".format(*CORNERS[corner]) for corner in triangle]
        lines += [" endloop", "endfacet"]
    return "\n".join([*lines, "endsolid box", ""]).encode()


def collada() -> bytes:
    numbers = " ".join(f"{0.1 * value:g}" for corner in CORNERS for value in corner)
    corners = " ".join(str(corner) for triangle in TRIANGLES for corner in triangle)
    params = "".join(f'<param name="{name}" type="float"/>' for name in "XYZ")
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="24">{numbers}</float_array>
<technique_common><accessor source="#pa" count="8" stride="3">{params}</accessor>
</technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/>
<p>{corners}</p></triangles>
</mesh></geometry></library_geometries>
<library_nodes><node id="m"><rotate>0 0 1 90</rotate><scale>1 1 0.5</scale>
<instance_geometry url="#g"/></node></library_nodes>
<library_visual_scenes><visual_scene id="s"><node id="n">
<matrix>1 0 0 0 0 1 0 0 0 0 1 5 0 0 0 1</matrix><instance_node url="#m"/></node>
</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
""".encode()


# ---- MCAP


def lz4_block(data: bytes) -> bytes:
    out, at = bytearray(), 0

    def length(nibble: int) -> int:
        nonlocal at
        total = nibble
        is_continued = nibble == 15
        while is_continued:
            is_continued = data[at] == 255
            total += data[at]
            at += 1
        return total

    while at < len(data):
        token = data[at]
        at += 1
        literals = length(token >> 4)
        out += data[at : at + literals]
        at += literals
        if at >= len(data):
            break
        distance = int.from_bytes(data[at : at + 2], "little")
        at += 2
        for _ in range(length(token & 15) + 4):
            out.append(out[-distance])
    return bytes(out)


def lz4_frame(data: bytes) -> bytes:
    flags = data[4]
    at = 7 + (8 if flags & 8 else 0) + (4 if flags & 1 else 0)
    out = b""
    while size := int.from_bytes(data[at : at + 4], "little"):
        at += 4
        block = data[at : at + (size & 0x7FFF_FFFF)]
        out += block if size >> 31 else lz4_block(block)
        at += len(block) + (4 if flags & 16 else 0)
    return out


def stored_lz4(data: bytes) -> bytes:
    """An LZ4 frame of stored blocks."""
    blocks = [data[at : at + 65536] for at in range(0, len(data), 65536)]
    frame = b"".join(struct.pack("<I", len(block) | 1 << 31) + block for block in blocks)
    return b"\x04\x22\x4d\x18\x60\x40\x82" + frame + bytes(4)


def stored_zstd(data: bytes) -> bytes:
    """A zstd frame of stored blocks."""
    frame = b"\x28\xb5\x2f\xfd\xa0" + struct.pack("<I", len(data))
    for at in range(0, len(data), 65536):
        block = data[at : at + 65536]
        is_last = at + 65536 >= len(data)
        frame += struct.pack("<I", len(block) << 3 | is_last)[:3] + block
    return frame


def record(code: int, content: bytes) -> bytes:
    return struct.pack("<BQ", code, len(content)) + content


def stored(mcap: bytes, compression: str | None) -> bytes:
    """An MCAP file with stored chunks or, with `None`, without chunks; without checksums and index.

    Mutations of compressed chunks seldom pass the checksum.
    """
    out, at = mcap[:8], 8
    while at < len(mcap) - 8:
        code, size = struct.unpack_from("<BQ", mcap, at)
        content = mcap[at + 9 : at + 9 + size]
        at += 9 + size
        if code == 6:
            name_end = 32 + int.from_bytes(content[28:32], "little")
            records = lz4_frame(content[name_end + 8 :])
            if compression is None:
                out += records
                continue
            packed = {"": bytes, "lz4": stored_lz4, "zstd": stored_zstd}[compression](records)
            content = content[:16] + struct.pack("<QI", len(records), 0)
            content += struct.pack("<I", len(compression)) + compression.encode()
            content += struct.pack("<Q", len(packed)) + packed
        elif code == 9:
            content = content[:-4] + bytes(4)
        elif code == 0x0F:
            break
        elif code == 7:
            continue
        out += record(code, content)
    return out + record(0x0F, bytes(4)) + record(2, bytes(20)) + mcap[:8]


def mcap_files(mcap: bytes) -> list[bytes]:
    return [mcap, *(stored(mcap, compression) for compression in (None, "", "lz4", "zstd"))]


# ---- tables of recordings


def tables(csv: bytes) -> dict[str, list[bytes]]:
    """Recordings as tables, by kind, from a CSV file with commas."""
    rows = [line.split(",") for line in csv.decode().splitlines() if not line.startswith("#")]
    time = rows[0].index("t_s")
    joints = [rows[0].index(f"joint_{joint}_rad") for joint in range(1, 8)]
    rows = [[row[column] for column in (time, *joints)] for row in rows]
    degrees = [["time", *(f"A{joint}_deg" for joint in range(1, 8))]]
    degrees += [
        [row[0], *(f"{float(q) * 57.29577951308232:.6f}" for q in row[1:])] for row in rows[1:]
    ]

    def lines(separator: str, rows: list[list[str]], end: str = "\n") -> bytes:
        return "".join(separator.join(row) + end for row in rows).encode()

    quoted = [[f'"{name}"' for name in rows[0]], *rows[1:]]
    log = ["ZeitInSec", "ZeitInNanoSec"]
    log += [f"axisQMsr_LBR_iiwa_7_R800_1[{joint}]" for joint in range(7)]
    log += [f"axisTauMsr_LBR_iiwa_7_R800_1[{joint}]" for joint in range(7)]
    logged = [log]
    for row in rows[1:]:
        nanoseconds = round(1e9 * float(row[0]))
        second, rest = divmod(nanoseconds, 10**9)
        logged.append([str(1557834123 + second), str(rest), *row[1:], *(["0.5"] * 7)])
    return {
        "csv-commas": [csv, lines(",", quoted, "\r\n"), lines(",", rows)],
        "csv-semicolons": [lines(";", degrees), b"\xef\xbb\xbf" + lines(";", quoted, "\r\n")],
        "csv-tabs": [lines("\t", degrees), lines("\t", rows, "\r")],
        "csv-numpy": [b"# " + lines(" ", rows), b"# x\n% " + lines(",", rows)],
        "data-recorder": [lines(" ", logged), b"% " + lines("\t", logged)],
    }


# ---- Sunrise projects


def project(name: str) -> dict[str, bytes]:
    folder = FIXTURES / "sunrise" / name
    return {
        f"project/{path.relative_to(folder)}": path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != "expected.json"
    }


def sunrise(kind: str, file: str, names: list[str], commands: list[str]) -> Kind:
    """A kind of file of Sunrise projects, found by the end of its path in the projects."""
    seeds = []
    for name in names:
        files = project(name)
        (application,) = (Path(path).stem for path in files if "/application/" in path)
        for path, data in files.items():
            if path.endswith(file):
                beside = {other: files[other] for other in files if other != path}
                seeds.append(Seed(path, data, beside, application))
    donors = fuzz_seeds("java") if file == ".java" else fuzz_seeds("sunrise")
    return Kind(kind, seeds, commands, donors)


# ---- all kinds


def made(binary: str) -> dict[str, bytes]:
    """Files that the command writes itself."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "program.json").write_bytes(text(PROGRAM))

        def output(arguments: str, file: str = "") -> bytes:
            command = [binary, *arguments.split()]
            done = subprocess.run(command, cwd=folder, check=True, capture_output=True)
            return (folder / file).read_bytes() if file else done.stdout

        plan = "plan program.json --rate"
        experiment = "experiment settle --simulate --count 2 --rate 50 -o results"
        return {
            "plan": output(f"{plan} 50 -o plan.mcap", "plan.mcap"),
            "table": output(f"{plan} 50 --no-output --csv plan.csv", "plan.csv"),
            "parquet": output(f"{plan} 50 --no-output --parquet plan.parquet", "plan.parquet"),
            "recording": output(experiment, "results/recordings/settle.mcap"),
            "urdf": output(f"robot {ROBOT} --urdf"),
        }


def all_kinds(binary: str) -> list[Kind]:
    """All kinds, with seeds that the command itself has written in part."""
    files = made(binary)
    program, plan = text(PROGRAM), files["plan"]
    planned = {"program.json": program, "plan.mcap": plan}
    recorded = tables(files["table"])
    meshed = files["urdf"].replace(
        b'<cylinder radius="0.115" length="0.068"/>', b'<mesh filename="FILE" scale="SCALE"/>'
    )

    def seeds(path: str, data: list[bytes], **beside: bytes) -> list[Seed]:
        return [Seed(path, each, planned | beside) for each in data]

    def recordings(name: str, file: str, data: list[bytes], donors: list[bytes], **options) -> Kind:
        return Kind(
            name,
            seeds(file, data),
            [
                f"report {file} -o page.html",
                f"report plan.mcap {file} -o page.html",
                f"compare plan.mcap {file} --json",
                f"compare plan.mcap {file} --picture paths.svg",
                f"validate program.json {file}",
                f"identify {file} --program program.json --json -o profile.json",
            ],
            donors,
            **options,
        )

    def mesh(name: str, file: str, data: bytes, is_binary: bool = False) -> Kind:
        fixture = {"name": "fixture", "type": "mesh", "file": file, "origin_mm": [0, 700, 0]}
        scene = {
            **TOOL_SCENE,
            "obstacles": [*TOOL_SCENE["obstacles"], fixture],
            "tool": [{"type": "mesh", "file": file}],
        }
        scale = b"1 1 1" if file.endswith(".dae") else b"0.001 0.001 0.001"
        urdf = meshed.replace(b"FILE", file.encode()).replace(b"SCALE", scale)
        beside = {"scene.json": text(scene), "arm.urdf": urdf}
        commands = ["report plan.mcap --urdf arm.urdf -o page.html"]
        if not file.endswith(".dae"):
            commands.append("plan program.json --no-output --scene scene.json")
        beside["cage.json"] = text(TOOL_SCENE)
        commands.append("plan program.json --no-output --scene cage.json --urdf arm.urdf")
        return Kind(name, seeds(file, [data], **beside), commands, fuzz_seeds("mesh", 1), is_binary)

    def tables_of(name: str, file: str, command: str, data: list[str]) -> Kind:
        return Kind(
            name,
            seeds(file, [each.encode() for each in data]),
            [f"{command} --stdin < {file}", f"{command} --stdin --json < {file}"],
        )

    programs = [program, text(PATHS), (FIXTURES / "pick-and-place.json").read_bytes()]
    scenes = [text(TOOL_SCENE), (FIXTURES / "cage.json").read_bytes(), *fuzz_seeds("scene")]
    logs = fuzz_seeds("joint_log")
    with_frames = {"program.json": text(WITH_FRAMES)}
    poses = json.dumps(DOWN | {"x_mm": 500, "y_mm": 0, "z_mm": 600, "e1_deg": 0, "status": 2})
    mcap_donors = [*fuzz_seeds("mcap"), *(data for data in logs if data.startswith(b"\x89MCAP"))]
    return [
        Kind(
            "program",
            seeds("input.json", programs, **{"before.json": program}),
            [
                "plan input.json -o out.mcap --max-file-size 2MB",
                "plan input.json --json --timing jerk --no-output --csv a.csv --max-file-size 2MB",
                "plan - --no-output --limit-torque < input.json",
                "plan input.json --no-output --picture path.svg",
                "export input.json --sunrise -o out",
                "diff before.json input.json --markdown",
            ],
            fuzz_seeds("program"),
        ),
        Kind(
            "folder",
            seeds("programs/b.json", programs, **{"programs/a.json": program}),
            [
                "plan programs --no-output --jobs 2",
                "plan programs -o out --max-file-size 2MB --json",
            ],
            [*fuzz_seeds("program"), *fuzz_seeds("profile"), *fuzz_seeds("scene")],
        ),
        Kind(
            "frames",
            seeds("frames.json", [text(FRAMES)], **with_frames),
            [
                "plan program.json --no-output",
                "ik --program frames.json --tool pen --frame place --near 0,30,0,-60,0,90,0",
                "fk --program frames.json --tool pen --base table --joints-deg 0,30,0,-60,0,90,0",
            ],
            fuzz_seeds("program"),
        ),
        Kind(
            "profile",
            seeds("profile.json", fuzz_seeds("profile"), **{"poses.csv": POSES.encode()}),
            [
                "plan program.json --no-output --robot profile.json",
                "robot profile.json --json --all",
                "robot profile.json --urdf",
                "fk --robot profile.json --joints-deg 0,30,0,-60,0,90,0",
                "ik --robot profile.json --stdin < poses.csv",
            ],
        ),
        Kind(
            "scene",
            seeds("scene.json", scenes),
            [
                "plan program.json --no-output --json --scene scene.json",
                "report plan.mcap --scene scene.json -o page.html",
            ],
        ),
        mesh("mesh-obj", "tool.obj", obj()),
        mesh("mesh-stl-binary", "tool.stl", stl_binary(), is_binary=True),
        mesh("mesh-stl-ascii", "tool.stl", stl_ascii()),
        mesh("mesh-collada", "tool.dae", collada()),
        Kind(
            "urdf",
            seeds(
                "arm.urdf",
                [
                    meshed.replace(b"FILE", b"package://arm/tool.stl").replace(
                        b"SCALE", b"0.001 0.001 0.001"
                    )
                ],
                **{"arm/tool.stl": stl_ascii(), "scene.json": text(TOOL_SCENE)},
            ),
            [
                f"robot {ROBOT} --check arm.urdf",
                "report plan.mcap --urdf arm.urdf --package-path arm -o page.html",
                (
                    "plan program.json --no-output --scene scene.json --urdf arm.urdf "
                    "--package-path arm"
                ),
            ],
            [files["urdf"]],
        ),
        Kind(
            "plan",
            seeds("input.mcap", mcap_files(plan), **{"recording.csv": files["table"]}),
            [
                "report input.mcap -o page.html",
                "report input.mcap recording.csv -o page.html",
                "compare input.mcap recording.csv",
                "diff plan.mcap input.mcap --json",
                "identify recording.csv --program program.json --no-output",
            ],
            mcap_donors,
            is_binary=True,
        ),
        recordings("recording", "input.mcap", mcap_files(plan), mcap_donors, is_binary=True),
        Kind(
            "recording-of-run",
            seeds("run.mcap", mcap_files(files["recording"])),
            ["report run.mcap -o page.html", "identify run.mcap -o profile.json --json"],
            mcap_donors,
            is_binary=True,
        ),
        *(recordings(name, "table.csv", data, logs) for name, data in recorded.items()),
        recordings("parquet", "table.parquet", [files["parquet"]], logs, is_binary=True),
        tables_of("ik-table", "poses.csv", "ik", [POSES, POSES.replace(",", "\t")]),
        tables_of("ik-json", "poses.jsonl", "ik", [f"{poses}\n" * 3]),
        tables_of("fk-table", "joints.csv", "fk", [JOINTS, JOINTS.replace(";", " ")]),
        tables_of("fk-json", "joints.jsonl", "fk", ['{"joints_deg":[0,30,0,-60,0,90,0]}\n' * 3]),
        sunrise(
            "sunrise-java",
            ".java",
            ["cell", "classes", "paths", "batches", "computed-frames", "tools", "joints", "inputs"],
            [
                "import project -o out.json",
                "import project --no-output --json",
                "plan project --application {application} --no-output",
            ],
        ),
        sunrise(
            "sunrise-data",
            "RoboticsAPI.data.xml",
            ["frames", "cell", "tools", "paths"],
            [
                "import project --frames -o out.json",
                "import project -o out.json",
                "import - --frames --no-output < project/RoboticsAPI.data.xml",
            ],
        ),
        sunrise("sunrise-station", "StationSetup.cat", ["cell"], ["import project -o out.json"]),
        sunrise(
            "sunrise-answers",
            "iiwasim-answers.toml",
            ["cell", "dialogs", "inputs"],
            ["import project -o out.json", "import project --no-output --json"],
        ),
        Kind(
            "settings",
            seeds(
                "iiwasim.toml",
                [b'# a\nrobot = "profile.json"\nscene = "scene.json"\nros_prefix = "left"\n'],
                **{"profile.json": fuzz_seeds("profile")[1], "scene.json": text(TOOL_SCENE)},
            ),
            ["plan program.json --no-output", f"robot {ROBOT} --urdf"],
        ),
    ]
