#!/usr/bin/env python3
"""Draws docs/blends.svg: a corner with four blends, and the speed over time, from plans of iiwasim.

    tests/guide/blends.py target/release/iiwasim docs/blends.svg

Needs mcap and mcap-ros2-support (tests/requirements.txt).
"""

import json
import subprocess
import sys
import tempfile
from itertools import pairwise
from math import dist
from pathlib import Path

from mcap_ros2.reader import read_ros2_messages

TARGETS = [[0, 0, 0, -110, 0, 70, 0], [0, 50, 0, -60, 0, 70, 0], [45, 50, 0, -60, 0, 70, 0]]
BLENDS = [
    ("no blend", None, "#8a8f98"),
    ("30 mm", {"cart_mm": 30}, "#2f7ed8"),
    ("80 mm", {"cart_mm": 80}, "#3b9a4b"),
    ("half of both motions", {"fraction": 0.5}, "#d9741a"),
]


def positions(binary, blend, folder):
    """Times in s and flange positions in mm."""
    motions = [{"type": "ptp", "joints_deg": joints} for joints in TARGETS[1:]]
    if blend:
        motions[0]["blend"] = blend
    program = folder / "corner.json"
    program.write_text(
        json.dumps({"version": 1, "start": {"joints_deg": TARGETS[0]}, "motions": motions})
    )
    plan = folder / "corner.mcap"
    subprocess.run(
        [binary, "plan", program, "-o", plan, "--rate", "500"],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    found = []
    for message in read_ros2_messages(plan, topics=["/tcp_pose"]):
        stamp, at = message.ros_msg.header.stamp, message.ros_msg.pose.position
        found.append((stamp.sec + stamp.nanosec * 1e-9, [1000 * at.x, 1000 * at.y, 1000 * at.z]))
    began = found[0][0]
    return [(t - began, at) for t, at in found]


def line(points, colour):
    shown = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<polyline points="{shown}" fill="none" stroke="{colour}" stroke-width="2.5"/>'


def main(binary, output):
    out = []
    with tempfile.TemporaryDirectory() as folder:
        runs = [(*blend, positions(binary, blend[1], Path(folder))) for blend in BLENDS]
    all_at = [at for *_, run in runs for _, at in run]
    # Top view: x up, y to the left, as seen from behind the robot.
    low_x, high_x = min(at[0] for at in all_at), max(at[0] for at in all_at)
    high_y = max(at[1] for at in all_at)
    low_y = min(at[1] for at in all_at)
    scale = min(400 / (high_y - low_y), 270 / (high_x - low_x))
    middle = (high_y + low_y) / 2
    end = max(run[-1][0] for *_, run in runs)
    speeds = [
        [(b[0], dist(a[1], b[1]) / (b[0] - a[0])) for a, b in pairwise(run)] for *_, run in runs
    ]
    top = max(v for speed in speeds for _, v in speed)
    for (name, _, colour, run), speed in zip(runs, speeds, strict=True):
        out.append(
            line(
                [(265 - scale * (at[1] - middle), 345 - scale * (at[0] - low_x)) for _, at in run],
                colour,
            )
        )
        out.append(line([(510 + 410 * t / end, 340 - 230 * v / top) for t, v in speed], colour))
        y = 200 + 6 * len(out)
        out.append(f'<rect x="190" y="{y + 21:.0f}" width="22" height="4" fill="{colour}"/>')
        out.append(f'<text x="220" y="{y + 28:.0f}">{name}, {run[-1][0]:.2f} s</text>')
    labels = [
        '<text class="head" x="24" y="24">The flange\'s path from above</text>',
        '<text class="head" x="500" y="24">Its speed over time</text>',
        f'<text x="500" y="100">{top:.0f} mm/s</text>',
        f'<text x="920" y="362" text-anchor="end">{end:.1f} s</text>',
        '<text x="510" y="362">0</text>',
        '<path class="axis" d="M510 105V340H925"/>',
    ]
    style = (
        ".ground{fill:#fbfbfa;stroke:#d8d8d4}text{fill:#1d2329}.head{font-weight:600}"
        ".axis{fill:none;stroke:#8a8f98}"
        "@media(prefers-color-scheme:dark){.ground{fill:#16191d;stroke:#34393f}"
        "text{fill:#eceff2}}"
    )
    Path(output).write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 960 380" font-size="14" '
        "font-family=\"system-ui, 'Segoe UI', Helvetica, Arial, sans-serif\">\n"
        f'<style>{style}</style>\n<rect class="ground" x=".5" y=".5" width="959" height="379" '
        f'rx="10"/>\n' + "\n".join(out + labels) + "\n</svg>\n"
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
