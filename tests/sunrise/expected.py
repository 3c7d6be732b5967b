#!/usr/bin/env python3
"""Expected imports of the Sunrise projects in fixtures/sunrise, independent of their Java code.

    tests/sunrise/expected.py [--check]

Each project is stated a second time, motion by motion, with the arithmetic of this folder; only
line numbers are looked up in the Java files. Writes the data files of the projects and their
`expected.json`; `--check` compares the existing files. For the projects in
fixtures/sunrise/refused, which have to be refused, the places in their `expected.toml` have to
exist.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import tomllib
from pathlib import Path

import application_projects
import geometry_projects
from program import Program

ROOT = Path(__file__).resolve().parents[2]

PROJECTS = {
    "joints": geometry_projects.joints,
    "frames": geometry_projects.frames,
    "computed-frames": geometry_projects.computed_frames,
    "tools": geometry_projects.tools,
    "paths": geometry_projects.paths,
    "batches": geometry_projects.batches,
    "async": application_projects.asynchronous,
    "classes": application_projects.classes,
    "dialogs": application_projects.dialogs,
    "inputs": application_projects.inputs,
    "compliance": application_projects.compliance,
    "cell": application_projects.cell,
}


def files(folder: Path, program: Program) -> dict[Path, str]:
    return {
        folder / "RoboticsAPI.data.xml": program.station.xml(),
        folder / "expected.json": program.text(),
    }


def is_same(found: object, stated: object) -> bool:
    """True if two documents are equal except for the last bits of numbers, as sines differ between
    machines.
    """
    if isinstance(found, dict) and isinstance(stated, dict):
        return list(found) == list(stated) and all(
            is_same(found[key], stated[key]) for key in found
        )
    if isinstance(found, list) and isinstance(stated, list):
        return len(found) == len(stated) and all(map(is_same, found, stated))
    if isinstance(found, float) and isinstance(stated, float):
        return math.isclose(found, stated, rel_tol=1e-12, abs_tol=1e-12)
    return type(found) is type(stated) and found == stated


def is_as_stated(path: Path, text: str) -> bool:
    if not path.exists():
        return False
    found = path.read_text(encoding="utf-8")
    if path.suffix == ".json":
        return is_same(json.loads(found), json.loads(text))
    return found == text


def wrong_refusal(folder: Path) -> str | None:
    """The error in the expected refusal of a project; None if it is correct."""
    name = f"refused/{folder.name}"
    try:
        stated = tomllib.loads((folder / "expected.toml").read_text(encoding="utf-8"))
        lines = (folder / stated["file"]).read_text(encoding="utf-8").split("\n")
        if not lines[stated["line"] - 1].strip():
            return f"{name}: line {stated['line']} of {stated['file']} is empty"
        if not all(stated["reason_contains"]):
            return f"{name}: it gives no reason"
    except (OSError, KeyError, IndexError, tomllib.TOMLDecodeError) as error:
        return f"{name}: {error!r}"
    return None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--check", action="store_true", help="compare, and write nothing")
    is_check = parser.parse_args().check
    folders = {folder.name for folder in (ROOT / "fixtures/sunrise").iterdir()} - {"refused"}
    different = [f"{name}: not stated here" for name in sorted(folders - set(PROJECTS))]
    refused = sorted((ROOT / "fixtures/sunrise/refused").iterdir())
    different += filter(None, map(wrong_refusal, refused))
    motions = 0
    for name, stated in PROJECTS.items():
        folder = ROOT / "fixtures/sunrise" / name
        program = stated(folder)
        motions += len(program.motions)
        for path, text in files(folder, program).items():
            if not is_check:
                path.write_text(text, encoding="utf-8")
            elif not is_as_stated(path, text):
                different.append(f"{path.relative_to(ROOT)}: not what is stated here")
    print(*different, sep="\n", file=sys.stderr, end="\n" if different else "")
    counted = f"{len(PROJECTS)} projects of {motions} motions, {len(refused)} to be refused"
    print(f"sunrise: {counted}, {len(different)} differences")
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
