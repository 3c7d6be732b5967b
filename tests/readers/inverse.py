#!/usr/bin/env python3
"""Compares `iiwasim ik` with an inverse kinematics from another project.

    inverse.py IIWASIM [--poses N]

For random joint positions of both robots, `ssik` finds solutions with the same pose, from the URDF
of `iiwasim robot --urdf`. With the A3 position and the status of such a solution, `iiwasim ik` has
to return that solution. Exit code 1 if one differs. Needs the packages in inverse.txt, next to this
file.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import ssik

# Position limits of A1 to A7 on both robots, in degrees.
LIMITS = [170, 120, 170, 120, 170, 120, 175]
# Upper arm and forearm, in m.
ROBOTS = {"lbr_iiwa_7_r800": (0.400, 0.400), "lbr_iiwa_14_r820": (0.420, 0.400)}
TOLERANCE = 1e-8
# Near a singularity, both lose digits in proportion to its distance.
LEAST_MEASURE = 1e-3


def measures(q: np.ndarray, arm: tuple[float, float]) -> tuple[float, float, float]:
    """Distances from singularities: wrist x in the A1 frame as a share of the arm length, sin A4,
    sin A6.
    """
    upper, fore = arm
    ahead = upper * math.sin(q[1]) + fore * (
        math.sin(q[1]) * math.cos(q[3]) - math.cos(q[1]) * math.sin(q[3]) * math.cos(q[2])
    )
    return ahead / (upper + fore), math.sin(q[3]), math.sin(q[5])


def status(q: np.ndarray, arm: tuple[float, float]) -> int:
    return (measures(q, arm)[0] < 0) | (q[3] < 0) << 1 | (q[5] < 0) << 2


def frame(pose: np.ndarray) -> str:
    r = pose[:3, :3]
    a = math.atan2(r[1, 0], r[0, 0])
    b = math.atan2(-r[2, 0], math.hypot(r[0, 0], r[1, 0]))
    c = math.atan2(r[2, 1], r[2, 2])
    x, y, z = (1e3 * pose[:3, 3]).tolist()
    return json.dumps({"x_mm": x, "y_mm": y, "z_mm": z, "a_rad": a, "b_rad": b, "c_rad": c})


def inside(q: np.ndarray) -> bool:
    return all(abs(math.degrees(v)) < limit for v, limit in zip(q, LIMITS, strict=True))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("iiwasim")
    parser.add_argument("--poses", type=int, default=200)
    options = parser.parse_args()
    numbers = random.Random(1)
    worst = worst_pose = 0.0
    compared = 0
    for name, arm in ROBOTS.items():
        urdf = subprocess.run(
            [options.iiwasim, "robot", name, "--urdf"], check=True, capture_output=True
        ).stdout
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "robot.urdf")
            path.write_bytes(urdf)
            foreign = ssik.Manipulator.from_urdf(str(path), base="iiwa_link_0", ee="iiwa_link_ee")
        for _ in range(options.poses // len(ROBOTS)):
            joints = np.radians([numbers.uniform(-limit, limit) for limit in LIMITS])
            pose = np.asarray(foreign.fk(joints))
            answers = [np.asarray(solution.q) for solution in foreign.solve(pose)]
            answers = [
                q for q in answers if inside(q) and min(map(abs, measures(q, arm))) > LEAST_MEASURE
            ]
            if not answers:
                continue
            q = numbers.choice(answers)
            command = [options.iiwasim, "ik", "--json", "--robot", name, "--frame", frame(pose)]
            command += ["--e1-deg", repr(math.degrees(q[2])), "--status", str(status(q, arm))]
            found = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
            ours = np.asarray(found["joints_rad"])
            worst = max(worst, float(np.abs(ours - q).max()))
            worst_pose = max(worst_pose, float(np.abs(np.asarray(foreign.fk(ours)) - pose).max()))
            compared += 1
    print(
        f"ik: {compared} answers of ssik {ssik.__version__ if hasattr(ssik, '__version__') else ''}"
        f" found again, joints to {worst:.1e} rad, its pose to {worst_pose:.1e}"
    )
    enough = compared > options.poses // 2
    return 0 if enough and worst < TOLERANCE and worst_pose < TOLERANCE else 1


if __name__ == "__main__":
    sys.exit(main())
