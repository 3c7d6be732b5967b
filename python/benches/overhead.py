#!/usr/bin/env python3
"""Overhead of the Python package compared with Rust alone.

    python/benches/overhead.py target/release/native [WHEEL]

Rust and Python run in turns, under the same machine load; medians are compared.
"""

from __future__ import annotations

import json
import os
import signal
import statistics
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Callable

import numpy as np

import iiwasim as iw

ROOT = Path(__file__).resolve().parents[2]
TURNS = 5
IMPORT = (
    "import numpy, time; t = time.perf_counter(); import iiwasim; print(time.perf_counter() - t)"
)


def median_us(rounds: int, work: Callable[[], object]) -> float:
    times = []
    for _ in range(rounds):
        begin = time.perf_counter()
        work()
        times.append(1e6 * (time.perf_counter() - begin))
    return statistics.median(times)


def beside_rust(native: str) -> None:
    program = iw.Program.load(ROOT / "fixtures/ten-motions.json")
    plan, robot = iw.plan(program), iw.Robot()
    joints = np.repeat(1e-5 * np.arange(100_000.0)[:, None], 7, axis=1)
    works: dict[str, tuple[int, Callable[[], object]]] = {
        "plan_us": (41, lambda: iw.plan(program)),
        "sample_us": (41, lambda: plan.sample(rate_hz=1000)),
        "fk_us": (21, lambda: robot.fk(joints)),
    }
    turns: dict[str, list[tuple[float, float]]] = {name: [] for name in works}
    samples = 0
    for _ in range(TURNS):
        rust = json.loads(
            subprocess.run([native], capture_output=True, text=True, check=True).stdout
        )
        samples = rust["samples"]
        for name, (rounds, work) in works.items():
            turns[name].append((median_us(rounds, work), rust[name]))
    middle = {
        name: [statistics.median(column) for column in zip(*pairs)] for name, pairs in turns.items()
    }
    ours, theirs = middle["plan_us"]
    print(
        f"plan of ten motions: Python {ours:.0f} us, Rust {theirs:.0f} us: {ours - theirs:+.0f} "
        f"us, {ours / theirs:.3f}"
    )
    ours, theirs = middle["sample_us"]
    print(
        f"{samples} samples at 1 kHz: Python {ours / 1e3:.2f} ms, Rust {theirs / 1e3:.2f} ms; "
        f"{10e3 / samples * ours / 1e3:.2f} ms for 10 s"
    )
    ours, theirs = middle["fk_us"]
    print(
        f"100 000 poses: Python {ours / 1e3:.2f} ms, Rust {theirs / 1e3:.2f} ms: "
        f"{ours / theirs:.2f}"
    )


def cores() -> None:
    program = iw.Program.load(ROOT / "fixtures/ten-motions.json")
    programs = [program.with_start(deg=[0.01 * place] + [0] * 6) for place in range(300)]
    ratios = []
    for _ in range(TURNS):
        took = []
        for jobs in (1, 2):
            begin = time.perf_counter()
            iw.plan_all(programs, jobs=jobs)
            took.append(time.perf_counter() - begin)
        ratios.append(took[0] / took[1])
    print(
        f"plan_all on two cores: {statistics.median(ratios):.2f} times one core ({os.cpu_count()} "
        "cores here)"
    )

    def speed(stop: threading.Event, counted: list[float]) -> None:
        begin, count = time.perf_counter(), 0
        while not stop.is_set():
            sum(range(2000))
            count += 1
        counted.append(count / (time.perf_counter() - begin))

    def beside(work: Callable[[], object]) -> float:
        stop, counted = threading.Event(), list[float]()
        thread = threading.Thread(target=speed, args=(stop, counted))
        thread.start()
        work()
        stop.set()
        thread.join()
        return counted[0]

    for jobs in (1, 2):
        kept = [
            beside(lambda jobs=jobs: iw.plan_all(programs, jobs=jobs))
            / beside(lambda: time.sleep(1))
            for _ in range(TURNS)
        ]
        print(
            f"another thread of Python beside plan_all(jobs={jobs}): {statistics.median(kept):.2f} "
            "of its speed alone"
        )


def interrupted() -> None:
    # A shell that starts the script in the background may have disabled Ctrl-C.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    program = iw.Program.load(ROOT / "fixtures/ten-motions.json")
    waits = []
    for _ in range(TURNS):
        sent = []

        def send(sent: list[float] = sent) -> None:
            sent.append(time.perf_counter())
            os.kill(os.getpid(), signal.SIGINT)

        programs = [program] * 20_000
        timer = threading.Timer(0.3, send)
        timer.start()
        try:
            iw.plan_all(programs)
        except KeyboardInterrupt:
            waits.append(time.perf_counter() - sent[0])
    print(
        f"Ctrl-C ends plan_all after {1e3 * statistics.median(waits):.0f} ms, at most "
        f"{1e3 * max(waits):.0f} ms"
    )


def main() -> None:
    native, *wheels = sys.argv[1:]
    for wheel in wheels:
        print(f"wheel: {Path(wheel).stat().st_size / 1e3:.0f} kB")
    imports = [
        float(
            subprocess.run(
                [sys.executable, "-c", IMPORT], capture_output=True, text=True, check=True
            ).stdout
        )
        for _ in range(9)
    ]
    print(f"import after numpy: {1e3 * statistics.median(imports):.1f} ms")
    beside_rust(native)
    cores()
    interrupted()


if __name__ == "__main__":
    main()
