"""Minimises the cycle time of a program over speeds, blends and elbow angles, clear of a press.

    python examples/search.py [--on one-core|cores|ray|dask] [--generations 40]

The program is `fixtures/pick-and-place.json`, the optimiser CMA-ES. All candidates of a generation
are planned at once: on one core, on all cores of this machine, or on a cluster. The figures, and
therefore the result, are the same everywhere. Needs `pip install 'iiwasim[batches]' cmaes`, and
`iiwasim[ray]` or `iiwasim[dask]` for a cluster.
"""

from __future__ import annotations

import argparse
import copy
import json
import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import cmaes
import numpy as np

import iiwasim as iw
from iiwasim import batches

PROGRAM = json.loads((Path(__file__).parents[2] / "fixtures" / "pick-and-place.json").read_text())
# The press is to the right of the robot, where the elbow is during the pick.
PRESS = {"name": "press", "type": "box", "center_mm": [175, -300, 700], "size_mm": [350, 200, 500]}
SCENE = iw.Scene.from_json(json.dumps({"version": 1, "obstacles": [PRESS]}))
CLEARANCE_M = 0.04

# What is searched: name, unit, where the program is, and the range.
VARIABLES = [
    ("speed of the first motion", "", 0.5, (0.1, 1.0)),
    ("speed on lines and circle", "times", 1.0, (0.2, 2.0)),
    ("blend after the first motion", "mm", 30, (1, 90)),
    ("blend above the pick", "mm", 20, (1, 90)),
    ("elbow at the pick", "deg", 0, (-60, 60)),
    ("elbow at the place", "deg", 0, (-60, 60)),
]
START = np.array([at for _, _, at, _ in VARIABLES])
BOUNDS = np.array([bounds for *_, bounds in VARIABLES])

Figures = Callable[..., Any]


def candidate(unit: np.ndarray) -> str:
    """The program for a point of the unit cube."""
    low, high = BOUNDS.T
    first_rel, times, first_mm, second_mm, pick_deg, place_deg = (
        float(at) for at in low + unit * (high - low)
    )
    program = copy.deepcopy(PROGRAM)
    frames, motions = program["frames"], program["motions"]
    frames["pick"]["e1_deg"], frames["place"]["e1_deg"] = pick_deg, place_deg
    for motion in motions:
        if "cart_velocity_mm_s" in motion:
            motion["cart_velocity_mm_s"] *= times
    motions[0]["velocity_rel"] = first_rel
    motions[0]["blend"]["cart_mm"] = first_mm
    motions[3]["blend"]["cart_mm"] = second_mm
    return json.dumps(program)


def cost(row: dict[str, Any]) -> float:
    """The cycle time, in s; 1000 and more if the robot is too close to the press, 2000 if the
    program cannot be planned.
    """
    if row["error"] is not None:
        return 2e3
    missing_m = CLEARANCE_M - row["clearance_m"]
    return 1e3 * (1.0 + missing_m) if missing_m > 0 else row["cycle_time_s"]


def search(figures: Figures, generations: int, seed: int) -> tuple[np.ndarray, float, int]:
    """The best point, its cost, and the number of programs that were planned."""
    low, high = BOUNDS.T
    start = (START - low) / (high - low)
    optimiser = cmaes.CMA(
        mean=start,
        sigma=0.2,
        bounds=np.array([[0.0, 1.0]] * len(start)),
        seed=seed,
        population_size=16,
    )
    best, least, planned = start, math.inf, 0
    for _ in range(generations):
        points = [optimiser.ask() for _ in range(optimiser.population_size)]
        rows = figures([candidate(point) for point in points], scene=SCENE).to_pylist()
        costs = [cost(row) for row in rows]
        optimiser.tell(list(zip(points, costs)))
        planned += len(points)
        if min(costs) < least:
            least = min(costs)
            best = points[costs.index(least)]
    return best, least, planned


@contextmanager
def workers(on: str) -> Iterator[Figures]:
    """Yields the function that plans the programs of a generation."""
    if on == "ray":
        import ray

        import iiwasim.ray

        # The cluster of RAY_ADDRESS, or one on this machine.
        ray.init(log_to_driver=False)
        try:
            yield iiwasim.ray.figures
        finally:
            ray.shutdown()
    elif on == "dask":
        from distributed import Client

        import iiwasim.dask

        with Client(
            threads_per_worker=1, host="127.0.0.1", dashboard_address="127.0.0.1:0"
        ) as client:
            yield partial(iiwasim.dask.figures, client=client)
    else:
        yield partial(batches.figures, jobs=1 if on == "one-core" else None)


def main() -> None:
    arguments = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    arguments.add_argument("--on", choices=["one-core", "cores", "ray", "dask"], default="cores")
    arguments.add_argument("--generations", type=int, default=40)
    arguments.add_argument("--seed", type=int, default=1)
    asked = arguments.parse_args()

    low, high = BOUNDS.T
    (before,) = batches.figures([candidate((START - low) / (high - low))], scene=SCENE).to_pylist()
    with workers(asked.on) as figures:
        begin = time.perf_counter()
        best, least, planned = search(figures, asked.generations, asked.seed)
        took_s = time.perf_counter() - begin
    if least >= 1e3:
        raise SystemExit(
            f"none of {planned} programs keeps {1e3 * CLEARANCE_M:.0f} mm; try more --generations"
        )
    (after,) = batches.figures([candidate(best)], scene=SCENE).to_pylist()

    print(f"{'':30}  {'before':>8}  {'after':>8}")
    for (name, unit, at, (low_at, high_at)), point in zip(VARIABLES, best):
        print(f"{name:30}  {at:8.2f}  {low_at + point * (high_at - low_at):8.2f} {unit}".rstrip())
    print(f"{'cycle time':30}  {before['cycle_time_s']:8.3f}  {after['cycle_time_s']:8.3f} s")
    print(
        f"{'clearance to the press':30}  {1e3 * before['clearance_m']:8.1f}  "
        f"{1e3 * after['clearance_m']:8.1f} mm"
    )
    print(f"{planned} programs in {took_s:.1f} s ({asked.on})")


if __name__ == "__main__":
    main()
