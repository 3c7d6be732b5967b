#!/usr/bin/env python3
"""Compares the torques of `iiwasim plan` with an inverse dynamics from another project.

    torques.py IIWASIM

For both robots, on the floor without a load and on the ceiling with a load, Pinocchio computes the
torques of each row of `plan --csv` from the URDF of `iiwasim robot --urdf`. Exit code 1 if one
differs. Needs the packages in torques.txt, next to this file.
"""

from __future__ import annotations

import argparse
import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pinocchio

ROBOTS = ("lbr_iiwa_7_r800", "lbr_iiwa_14_r820")
LOAD = {
    "mass_kg": 4.5,
    "center_mm": [20, -30, 90],
    "inertia_kg_m2": [0.03, 0.04, 0.02],
    "abc_deg": [10, 20, 30],
}
TOLERANCE_NM = 1e-9


def program(robot: str, loaded: bool) -> dict:
    """Three motions with a blend, without a load or with one."""
    turns = (
        [20, 60, -40, -70, 50, 30, 90],
        [-60, 30, 20, -90, -30, 60, -45],
        [0, 10, 0, -40, 0, 20, 0],
    )
    motions = [{"type": "ptp", "joints_deg": turn} for turn in turns]
    motions[0]["blend"] = {"fraction": 0.3}
    whole = {"version": 1, "robot": robot, "start": {"joints_deg": [0, 10, 0, -40, 0, 20, 0]}}
    if loaded:
        motions.insert(0, {"type": "load", "load": LOAD})
        whole["mount"] = {"rpy_deg": [180, 0, 0]}
    return whole | {"motions": motions}


def add_load(model: pinocchio.Model) -> None:
    """Attaches the load to the flange."""
    flange = model.frames[model.getFrameId("iiwa_link_ee")]
    a, b, c = np.radians(LOAD["abc_deg"])
    rotation = pinocchio.rpy.rpyToMatrix(c, b, a)
    inertia = rotation @ np.diag(LOAD["inertia_kg_m2"]) @ rotation.T
    body = pinocchio.Inertia(LOAD["mass_kg"], np.array(LOAD["center_mm"]) / 1e3, inertia)
    model.appendBodyToJoint(flange.parentJoint, body, flange.placement)


def largest_difference_nm(
    iiwasim: str, folder: Path, robot: str, loaded: bool
) -> tuple[float, int]:
    """The largest torque difference, and the number of compared states."""
    (folder / "program.json").write_text(json.dumps(program(robot, loaded)))
    subprocess.run(
        [iiwasim, "plan", "program.json", "--no-output", "--csv", "plan.csv", "--exact"],
        cwd=folder,
        check=True,
        stdout=subprocess.DEVNULL,
    )
    urdf = subprocess.run(
        [iiwasim, "robot", robot, "--urdf"], check=True, capture_output=True, text=True
    ).stdout
    model = pinocchio.buildModelFromXML(urdf)
    if loaded:
        add_load(model)
    model.gravity.linear = np.array([0.0, 0.0, 9.81 if loaded else -9.81])
    data = model.createData()
    worst, states = 0.0, 0
    with (folder / "plan.csv").open() as file:
        for row in csv.DictReader(file):
            q, v, a, torques = (
                np.array([float(row[f"{name}_{j}_{unit}"]) for j in range(1, 8)])
                for name, unit in (
                    ("joint", "rad"),
                    ("joint", "rad_s"),
                    ("joint", "rad_s2"),
                    ("torque", "nm"),
                )
            )
            worst = max(worst, np.abs(pinocchio.rnea(model, data, q, v, a) - torques).max())
            states += 1
    return worst, states


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("iiwasim")
    iiwasim = str(Path(parser.parse_args().iiwasim).resolve())
    worst, states = 0.0, 0
    with tempfile.TemporaryDirectory() as folder:
        for robot in ROBOTS:
            for loaded in (False, True):
                difference, count = largest_difference_nm(iiwasim, Path(folder), robot, loaded)
                print(
                    f"{robot}, {'with a load at the ceiling' if loaded else 'alone'}: "
                    f"{difference:.1e} Nm"
                )
                worst, states = max(worst, difference), states + count
    print(f"torques: {states} states, at most {worst:.1e} Nm off Pinocchio {pinocchio.__version__}")
    return 0 if worst < TOLERANCE_NM and states > 1000 else 1


if __name__ == "__main__":
    sys.exit(main())
