#!/usr/bin/env python3
"""Checks the C library, and the FMUs built with it, against their specification.

    check.py [target/release/libiiwasim.so]

Needs gcc, g++, cmake, pkg-config and valgrind, and requirements.txt next to this file.
"""

import sys
import tempfile
import time
from pathlib import Path

CRATE = Path(__file__).resolve().parents[1]
ROOT = CRATE.parents[2]
sys.path.insert(0, str(CRATE / "fmu"))

import c_programs
import fmus
import refusals
from library import Library

# A tool, an included file and a profile, which an FMU has to contain.
CELL = '{ "version": 1, "tools": { "gripper": { "tcp": { "z_mm": 120 } } } }'
PROFILE = '{ "version": 1, "base": "lbr_iiwa_14_r820", "lengths_mm": { "flange": 126 } }'
WITH_FILES = """{ "version": 1, "robot": "own.json", "include": "cell.json", "tool": "gripper",
  "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
  "motions": [
    { "type": "lin_rel", "offset": { "z_mm": -50 } },
    { "type": "wait", "seconds": 0.2 },
    { "type": "ptp", "joints_deg": [40, 30, 0, -60, 0, 90, 0] }
  ] }"""


def main():
    binary = Path(
        sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/release/libiiwasim.so"
    ).resolve()
    began = time.monotonic()
    library = Library(binary)
    fixtures = [
        ROOT / "fixtures" / f"{name}.json"
        for name in ("appendix-b", "waits-and-stops", "pick-and-place")
    ]
    with tempfile.TemporaryDirectory(prefix="iiwa-c-") as name:
        folder = Path(name)
        c_programs.check(binary, fixtures[0], library, folder)
        refusals.check(library, folder)
        for file, text in [
            ("cell.json", CELL),
            ("own.json", PROFILE),
            ("with-files.json", WITH_FILES),
        ]:
            (folder / file).write_text(text)
        for number, program in enumerate([*fixtures, folder / "with-files.json"]):
            own = folder / str(number)
            own.mkdir()
            fmus.check(library, binary, program, own)
        fmus.check_two_programs(library, binary, fixtures, folder)
        fmus.check_altered(binary, fixtures[0], folder)
    print(f"C and FMI: all as promised, {time.monotonic() - began:.0f} s")


if __name__ == "__main__":
    main()
