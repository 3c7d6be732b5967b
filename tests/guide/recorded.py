#!/usr/bin/env python3
"""Draws docs/recorded-ptp.svg: a PTP motion of a real robot, recorded by KUKA's DataRecorder, and
its plans.

    tests/guide/recorded.py target/release/iiwasim LOG OVERRIDE_PERCENT NUMBER docs/recorded-ptp.svg

LOG has the columns `axisQCmdT1m_...[0]` to `[6]` in degrees; NUMBER counts its motions that are
straight in joint space, from 1. The logs are not part of this project; docs/evidence.md names their
source.
"""

import csv
import json
import subprocess
import sys
import tempfile
from itertools import pairwise
from math import dist
from pathlib import Path

COLOURS = {"sunrise": "#2f7ed8", "jerk": "#d9741a"}
STILL_DEG = 1e-6
LEAST_DEG = 10


def recorded(path):
    """Times in s and commanded joint positions in deg."""
    lines = Path(path).read_text().splitlines()
    head = lines[0].lstrip("% ").split()
    joints = [column for column, name in enumerate(head) if name.startswith("axisQCmdT1m")]
    for line in lines[1:]:
        values = line.split()
        if values:
            yield (
                float(values[0]) + 1e-9 * float(values[1]),
                [float(values[column]) for column in joints],
            )


def straight_motions(samples):
    """The motions from rest to rest that are straight in joint space, with the samples at rest
    around them.
    """
    moving = [dist(a[1], b[1]) > STILL_DEG for a, b in pairwise(samples)]
    first = None
    for at, moves in enumerate([*moving, False]):
        if moves and first is None:
            first = at
        elif not moves and first is not None:
            run, first = samples[first : at + 1], None
            start, end = run[0][1], run[-1][1]
            length = dist(start, end)
            if length < LEAST_DEG:
                continue
            way = [b - a for a, b in zip(start, end, strict=True)]
            shares = [
                sum((q - a) * w for q, a, w in zip(joints, start, way, strict=True)) / length**2
                for _, joints in run
            ]
            off = max(
                dist(joints, [a + share * w for a, w in zip(start, way, strict=True)])
                for (_, joints), share in zip(run, shares, strict=True)
            )
            if off < 1e-4:
                yield (
                    start,
                    end,
                    length,
                    [
                        (t - run[0][0], length * share)
                        for (t, _), share in zip(run, shares, strict=True)
                    ],
                )


def planned(binary, start, end, timing, override, folder):
    """Times in s, and the position along the line in deg."""
    program = {"version": 1, "override_percent": override, "start": {"joints_deg": start}}
    program["motions"] = [{"type": "ptp", "joints_deg": end}]
    Path(folder, "ptp.json").write_text(json.dumps(program))
    options = ["--timing", timing, "--no-output", "--csv", "ptp.csv", "--exact", "--rate", "1000"]
    subprocess.run(
        [Path(binary).resolve(), "plan", "ptp.json", *options],
        cwd=folder,
        check=True,
        stdout=subprocess.DEVNULL,
    )
    with open(Path(folder, "ptp.csv")) as table:
        for row in csv.DictReader(table):
            joints = [float(row[f"joint_{j}_rad"]) * 57.29577951308232 for j in range(1, 8)]
            yield float(row["t_s"]), dist(start, joints)


def speeds(samples):
    return [((a[0] + b[0]) / 2, (b[1] - a[1]) / (b[0] - a[0])) for a, b in pairwise(samples)]


def shifted(samples, plan):
    """The recorded samples, shifted in time for the best fit to the plan, as the log gives the
    start only to one sample.
    """

    def way(t):
        return next((s for at, s in plan if at >= t), plan[-1][1])

    def error(shift):
        return sum((way(t + shift) - s) ** 2 for t, s in samples)

    step = samples[1][0] - samples[0][0]
    best = min((k * step / 50 for k in range(-50, 51)), key=error)
    return [(t + best, s) for t, s in samples]


def main(binary, log, override, number, output):
    start, end, length, samples = list(straight_motions(list(recorded(log))))[int(number) - 1]
    out, labels = [], []
    with tempfile.TemporaryDirectory() as folder:
        plans = {
            timing: list(planned(binary, start, end, timing, float(override), folder))
            for timing in COLOURS
        }
    samples = shifted(samples, plans["sunrise"])
    whole = max(plan[-1][0] for plan in plans.values()) * 1.02
    curves = {timing: speeds(plan) for timing, plan in plans.items()}
    accelerations = {timing: speeds(curve) for timing, curve in curves.items()}
    points = speeds(samples)
    for row, (of_plans, of_log, unit) in enumerate(
        [(curves, points, "deg/s"), (accelerations, speeds(points), "deg/s²")]
    ):
        top = 1.05 * max(abs(v) for curve in of_plans.values() for _, v in curve)
        zero, height = [(300, 230), (480, 130)][row]

        def place(t, v, zero=zero, height=height, top=top):
            return 70 + 860 * t / whole, zero - height * v / top

        for timing, curve in of_plans.items():
            shown = " ".join("{:.1f},{:.1f}".format(*place(t, v)) for t, v in curve[::5])
            out.append(
                f'<polyline points="{shown}" fill="none" stroke="{COLOURS[timing]}" '
                f'stroke-width="2"/>'
            )
        out += ['<circle cx="{:.1f}" cy="{:.1f}" r="3"/>'.format(*place(t, v)) for t, v in of_log]
        labels.append(
            f'<path class="axis" d="M70 {zero}H930"/><text x="24" '
            f'y="{zero - height + 4}">{top / 1.05:.0f} {unit}</text>'
        )
    labels += [
        (
            f'<text class="head" x="24" y="28">A PTP motion of {length:.0f} deg along its line, '
            f"override {override} %</text>"
        ),
        '<circle cx="560" cy="24" r="3"/><text x="572" y="28">recorded</text>',
        (
            f'<rect x="660" y="22" width="22" height="4" fill="{COLOURS["sunrise"]}"/>'
            '<text x="690" y="28">plan</text>'
        ),
        (
            f'<rect x="750" y="22" width="22" height="4" fill="{COLOURS["jerk"]}"/>'
            '<text x="780" y="28">plan, --timing jerk</text>'
        ),
        f'<text x="930" y="640" text-anchor="end">{whole:.1f} s</text>',
    ]
    style = (
        ".ground{fill:#fbfbfa;stroke:#d8d8d4}text,circle{fill:#1d2329}.head{font-weight:600}"
        ".axis{fill:none;stroke:#8a8f98}"
        "@media(prefers-color-scheme:dark){.ground{fill:#16191d;stroke:#34393f}"
        "text,circle{fill:#eceff2}}"
    )
    Path(output).write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 960 660" font-size="14" '
        "font-family=\"system-ui, 'Segoe UI', Helvetica, Arial, sans-serif\">\n"
        f'<style>{style}</style>\n<rect class="ground" x=".5" y=".5" width="959" height="659" '
        f'rx="10"/>\n' + "\n".join(out + labels) + "\n</svg>\n"
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
