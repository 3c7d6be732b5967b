"""Benchmark of Ray and Dask with two workers on this machine, one of which is killed in between.

    python benches/cluster.py [COUNT]

Plans COUNT (20000) small programs on one core, then with Ray and with Dask. Each row has to appear
once and to equal the row from one core; otherwise the exit code is 1. Then the script measures
throughput with one and with two workers, in turns. As other processes may use the machine, it also
measures the speed of two counting processes relative to one.
"""

from __future__ import annotations

import argparse
import multiprocessing
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from statistics import median

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "cluster"))

import clusters
from programs import random_programs

import iiwasim.dask
import iiwasim.ray
from iiwasim import batches

CLUSTERS = {"ray": iiwasim.ray, "dask": iiwasim.dask}
TURNS = 3
COUNTING_S = 1.0


def killed_on_the_way(on: str, source: Path, rows: int, folder: Path) -> tuple[float, int]:
    """Plans with two workers, and kills one after a third of the rows; returns the time in s, and
    the number of rows at that moment.
    """
    module = CLUSTERS[on]
    place = folder.with_suffix(".victim")
    began: list[int] = []

    def kill_once(done: int, _: int) -> None:
        if not began and done >= rows // 3:
            began.append(done)
            place.mkdir()

    with clusters.CLUSTERS[on](), ThreadPoolExecutor() as meanwhile:
        usual, module.Planning = module.Planning, clusters.victim(place / "pid")
        killed = meanwhile.submit(clusters.kill_victim, place / "pid")
        begin = time.perf_counter()
        module.plan(source, folder, chunk=chunk(rows), progress=kill_once)
        took_s = time.perf_counter() - begin
        module.Planning = usual
        killed.result()
        return took_s, began[0]


def throughput(on: str, workers: int, programs: list[str]) -> float:
    """Programs per second from file to file, after the start of the workers."""
    cluster = CLUSTERS[on]
    with clusters.CLUSTERS[on](workers), tempfile.TemporaryDirectory() as name:
        source = Path(name, "programs.jsonl")
        source.write_text("\n".join(programs))
        # Warm-up: workers import their modules.
        cluster.figures(programs[: 20 * workers])
        begin = time.perf_counter()
        cluster.plan(source, Path(name, "figures"), chunk=chunk(len(programs)))
        return len(programs) / (time.perf_counter() - begin)


def counted(_: int) -> int:
    """The count that a process reaches in a fixed time."""
    until, count = time.perf_counter() + COUNTING_S, 0
    while time.perf_counter() < until:
        count += 1
    return count


def counting(processes: int) -> int:
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        return sum(pool.map(counted, range(processes), chunksize=1))


def chunk(rows: int) -> int:
    return max(1, min(500, rows // 12))


def ratio(of: Callable[[int], float]) -> float:
    """Rate with two workers divided by the rate with one."""
    return of(2) / of(1)


def main() -> int:
    arguments = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    arguments.add_argument("count", nargs="?", type=int, default=20_000, help="number of programs")
    count = arguments.parse_args().count
    programs = random_programs(count)
    failed = False
    with tempfile.TemporaryDirectory() as name:
        source = Path(name, "programs.jsonl")
        source.write_text("\n".join(programs))
        begin = time.perf_counter()
        alone = batches.figures(programs, jobs=1)
        took_s = time.perf_counter() - begin
        print(
            f"one core: {count} programs in {took_s:.1f} s, {count / took_s:.0f} a second",
            flush=True,
        )
        for on in ("ray", "dask"):
            folder = Path(name, on)
            took_s, killed_at = killed_on_the_way(on, source, count, folder)
            figures = batches.read(folder)
            once = figures["row"].to_pylist() == list(range(count))
            equal = figures.equals(alone)
            failed |= not (once and equal)
            print(
                f"{on}, 2 workers, one killed after {killed_at} rows: {took_s:.1f} s, "
                f"{count / took_s:.0f} a second; "
                f"{'every row once' if once else 'ROWS ARE MISSING OR TWICE'}, "
                f"{'equal to one core' if equal else 'NOT EQUAL TO ONE CORE'}",
                flush=True,
            )
    some = programs[: min(count, 3000)]
    for on in ("ray", "dask"):
        turns = [
            (ratio(lambda workers, on=on: throughput(on, workers, some)), ratio(counting))
            for _ in range(TURNS)
        ]
        planned, machine = zip(*turns)
        print(
            f"{on}: two workers plan {median(planned):.2f} times what one does ({min(planned):.2f} "
            f"to {max(planned):.2f}, "
            f"{TURNS} turns of {len(some)}); two processes that count, {median(machine):.2f} times "
            f"({min(machine):.2f} to {max(machine):.2f})",
            flush=True,
        )
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
