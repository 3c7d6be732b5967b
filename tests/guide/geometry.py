"""Compares statements of the guide on the geometry of programs with the TCP motions of their plans.

A comment before a program makes claims, each with the quoted words of the page:

    <!-- geometry: motion 2 lowers by 80 mm, "by 80 mm"; motion 4 ends at place, "to the place" -->

    motion N lifts by D mm        the TCP moves up by D in the robot's base frame, and not sideways
    motion N lowers by D mm       the TCP moves down by D in the same way
    motion N ends D mm over BASE  the motion ends at D along z of a base
    motion N ends at FRAME        the motion ends at a frame of the program

The comment is required if the text before a program states a distance or height of the TCP. The
program is planned without its blends, so that each motion ends at its target. Targets must not be
below a base named `table`.
"""

from __future__ import annotations

import csv
import json
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

MARK = re.compile(r"geometry: (?P<claims>.+)")

# Words for heights and vertical motions, with a length.
HEIGHT = re.compile(
    r"\b(?:lift|lower|rais|retract|retreat|approach|descend)\w*\b[^.;:]*?\d+ mm"
    r"|\d+ mm (?:over|above|below|under|up|down)\b"
)

CLAIM = re.compile(
    r"motion (?P<motion>\d+) (?:"
    r"(?P<way>lifts|lowers) by (?P<by>[\d.]+) mm"
    r"|ends (?P<height>-?[\d.]+) mm over (?P<base>\w+)"
    r"|ends at (?P<frame>\w+)"
    r'), "(?P<words>[^"]+)"$'
)

# Tolerance for the rounding of the table; plans are exact.
TOLERANCE_MM = 1e-3


@dataclass
class Runner:
    """Folder and environment for planning programs."""

    folder: Path
    environment: dict

    def ends_mm(self, program: dict) -> dict[int, list[float]]:
        """TCP positions at the end of each motion and at the start (motion 0), in the robot's base
        frame.
        """
        motions = [
            {k: v for k, v in motion.items() if k != "blend"} for motion in program["motions"]
        ]
        file, table = self.folder / "geometry.json", self.folder / "geometry.csv"
        file.write_text(json.dumps(program | {"motions": motions}))
        try:
            command = ["iiwasim", "plan", file, "--no-output", "--csv", table, "--exact"]
            subprocess.run(
                command, cwd=self.folder, env=self.environment, check=True, capture_output=True
            )
            ends: dict[int, list[float]] = {}
            with table.open(newline="") as rows:
                for row in csv.DictReader(rows):
                    place = [1000 * float(row[f"tcp_{axis}_m"]) for axis in "xyz"]
                    ends.setdefault(0, place)
                    ends[int(row["motion"])] = place
            return ends
        finally:
            file.unlink()
            table.unlink(missing_ok=True)


def base_mm(program: dict, name: str) -> list[float]:
    """Origin of a base. Rotated bases are not supported."""
    base = program["bases"][name]
    assert not any(base.get(key) for key in ("a_deg", "b_deg", "c_deg", "base")), (
        f"the base {name} is turned"
    )
    return [base.get(f"{axis}_mm", 0) for axis in "xyz"]


def frame_mm(program: dict, name: str) -> list[float]:
    frame = program["frames"][name]
    base = frame.get("base", program.get("base", "robot"))
    origin = [0, 0, 0] if base == "robot" else base_mm(program, base)
    return [at + frame.get(f"{axis}_mm", 0) for at, axis in zip(origin, "xyz")]


def apart_mm(a: list[float], b: list[float]) -> float:
    return max(abs(x - y) for x, y in zip(a, b))


def check_claim(claim: re.Match, program: dict, ends: dict[int, list[float]]) -> str | None:
    """The error in a claim; None if it is correct."""
    motion = int(claim["motion"])
    # Waits and loads do not have rows.
    before, after = (ends[max(k for k in ends if k <= number)] for number in (motion - 1, motion))
    if claim["way"]:
        up = float(claim["by"]) * (1 if claim["way"] == "lifts" else -1)
        moved = [b - a for a, b in zip(before, after)]
        wrong = apart_mm(moved, [0, 0, up]) > TOLERANCE_MM
        found = "moves the TCP by {:.1f}, {:.1f}, {:.1f} mm".format(*moved)
    elif claim["base"]:
        over = after[2] - base_mm(program, claim["base"])[2]
        wrong = abs(over - float(claim["height"])) > TOLERANCE_MM
        found = f"ends {over:.1f} mm over {claim['base']}"
    else:
        wrong = apart_mm(after, frame_mm(program, claim["frame"])) > TOLERANCE_MM
        found = "ends at {:.1f}, {:.1f}, {:.1f} mm".format(*after)
    return f"“{claim['words']}”: motion {motion} {found}" if wrong else None


def check_geometry(program: dict, prose: str, mark: re.Match | None, runner: Runner) -> list[str]:
    """Errors in the text before a program, or in the program."""
    prose = " ".join(prose.split())
    problems = []
    claims = []
    for text in mark["claims"].split("; ") if mark else []:
        claim = CLAIM.match(text)
        if claim is None:
            problems.append(f"no claim on the geometry: {text}")
        elif claim["words"] not in prose:
            problems.append(f"the text before it does not say “{claim['words']}”")
        else:
            claims.append(claim)
    for said in HEIGHT.finditer(prose):
        if not any(claim["words"] in said[0] or said[0] in claim["words"] for claim in claims):
            problems.append(
                f"“{said[0]}” needs a claim that is checked: see tests/guide/geometry.py"
            )
    has_table = "table" in program.get("bases", {})
    if not claims and not has_table:
        return problems
    ends = runner.ends_mm(program)
    problems += filter(None, (check_claim(claim, program, ends) for claim in claims))
    if has_table:
        table_mm = base_mm(program, "table")[2]
        below = [motion for motion, place in ends.items() if place[2] < table_mm]
        problems += [f"motion {motion} ends below the table" for motion in below]
    return problems
