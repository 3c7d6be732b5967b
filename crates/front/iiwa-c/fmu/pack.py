#!/usr/bin/env python3
"""Builds an FMU (FMI 3.0, co-simulation) of a motion program.

    pack.py PROGRAM.json [-o PROGRAM.fmu] [--library target/release/libiiwasim.so]

The program is planned first, and refused if planning fails. Libraries of further platforms are
given by --also x86_64-windows=iiwasim.dll. The same input gives the same bytes.
"""

import argparse
import json
import platform
import sys
import zipfile
from pathlib import Path

from library import Failure, Library

# Names of systems in FMI 3.0, with the suffixes of their libraries.
SYSTEMS = {
    "Linux": ("linux", ".so"),
    "Windows": ("windows", ".dll"),
    "Darwin": ("darwin", ".dylib"),
}
MACHINES = {"x86_64": "x86_64", "AMD64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}
ROOT = Path(__file__).resolve().parents[4]


def own_platform():
    system, _ = SYSTEMS[platform.system()]
    return f"{MACHINES[platform.machine()]}-{system}"


def built_library():
    name = {"Windows": "iiwasim.dll", "Darwin": "libiiwasim.dylib"}.get(
        platform.system(), "libiiwasim.so"
    )
    return ROOT / "target/release" / name


def pack(fmu, program, library, also=(), **options):
    """Writes the FMU of a program; `also` are pairs of a platform and its library."""
    loaded = Library(library)
    with loaded.plan(program, **options) as plan:
        files = json.loads(loaded.text("iiwasim_plan_fmu_json", plan, Path(fmu).stem.encode()))
    contents = {name: text.encode() for name, text in files.items()}
    for target, path in [(own_platform(), library), *also]:
        ending = {system: ending for system, ending in SYSTEMS.values()}[target.split("-")[1]]
        contents[f"binaries/{target}/iiwasim{ending}"] = Path(path).read_bytes()
    with zipfile.ZipFile(fmu, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in contents.items():
            # With the earliest possible date instead of today's, for reproducible files.
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program", type=Path)
    parser.add_argument("-o", "--output", type=Path)
    parser.add_argument("--library", type=Path, default=built_library())
    parser.add_argument("--also", action="append", default=[], metavar="PLATFORM=LIBRARY")
    parser.add_argument(
        "--robot", help="a built-in robot, or the file of a profile; else the program's"
    )
    parser.add_argument("--timing", choices=["sunrise", "jerk", "acceleration"], default="sunrise")
    options = parser.parse_args()
    fmu = options.output or Path(options.program.with_suffix(".fmu").name)
    also = [entry.split("=", 1) for entry in options.also]
    known = [system for system, _ in SYSTEMS.values()]
    for entry in also:
        if len(entry) != 2 or entry[0].split("-")[-1] not in known:
            parser.error(
                f"--also {'='.join(entry)}: it has to be PLATFORM=LIBRARY, as "
                "x86_64-windows=iiwasim.dll"
            )
    robot = options.robot
    try:
        if robot and Path(robot).is_file():
            robot = Path(robot).read_text(encoding="utf-8")
        pack(fmu, options.program, options.library, also, robot=robot, timing=options.timing)
    except (Failure, OSError) as error:
        sys.exit(f"{options.program}: {error}")
    print(f"{fmu}: {fmu.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
