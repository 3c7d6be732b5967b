"""Memory, interrupts, threads and processes of planning."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import pytest
from programs import FIXTURES, PROGRAMS, swing

import iiwasim as iw

LIMITED = """
import resource, sys
import numpy as np
import iiwasim as iw
plan = iw.plan(iw.Program([iw.wait(86400)], start_deg=[0] * 7))
resource.setrlimit(resource.RLIMIT_AS, (8 << 30, resource.RLIM_INFINITY))
for work in (
    lambda: plan.sample(rate_hz=1e6),
    lambda: iw.Robot().flange(np.broadcast_to(np.zeros(7), (10**9, 7))),
):
    try:
        work()
    except MemoryError as error:
        print(error)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="memory is limited by Linux")
def test_too_much_memory_is_an_exception() -> None:
    done = subprocess.run(
        [sys.executable, "-c", LIMITED], capture_output=True, text=True, timeout=120, check=True
    )
    assert len(done.stdout.splitlines()) == 2, done


CTRL_C = """
import os, signal, threading
import iiwasim as iw
plan = iw.plan(iw.Program([iw.wait(3600)], start_deg=[0] * 7))
threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    plan.sample(rate_hz=2000)
    threading.Event().wait(30)
except KeyboardInterrupt:
    print("interrupted")
"""


def test_ctrl_c_in_the_first_sampling_is_an_interrupt() -> None:
    done = subprocess.run(
        [sys.executable, "-c", CTRL_C], capture_output=True, text=True, timeout=120, check=True
    )
    assert done.stdout == "interrupted\n" and not done.stderr


def worker_threads() -> int:
    count = 0
    for task in Path("/proc/self/task").iterdir():
        # A thread may end between its listing and its reading.
        with suppress(OSError):
            count += (task / "comm").read_text().strip() == "iiwasim"
    return count


def test_idle_threads_are_few() -> None:
    program = swing()
    with ThreadPoolExecutor(64) as pool:
        assert len(list(pool.map(lambda _: iw.plan(program), range(400)))) == 400
    if sys.platform == "linux":
        # Surplus threads are released, not joined: they end some time later.
        end = time.monotonic() + 60
        while worker_threads() > (os.cpu_count() or 1) and time.monotonic() < end:
            time.sleep(0.01)
        assert worker_threads() <= (os.cpu_count() or 1)


def test_all_cores_plan_the_same() -> None:
    programs = (
        [swing(deg) for deg in range(5, 121, 5)]
        + [swing(300)]
        + [iw.Program.load(FIXTURES / PROGRAMS[1])]
    )
    seen: list[tuple[int, int]] = []
    plans = iw.plan_all(programs, progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (len(programs), len(programs))
    assert [done for done, _ in seen] == sorted({done for done, _ in seen})
    for program, plan, alone in zip(programs, plans, iw.plan_all(iter(programs), jobs=1)):
        if isinstance(plan, iw.Plan):
            assert isinstance(alone, iw.Plan)
            assert plan.cycle_time_s == alone.cycle_time_s == iw.plan(program).cycle_time_s
        else:
            assert (
                isinstance(plan, iw.ProgramError)
                and plan.motion == 1
                and "its range is" in str(plan)
            )
    assert sum(isinstance(plan, iw.Plan) for plan in plans) == len(programs) - 1
    assert iw.plan_all([]) == []
    with pytest.raises(TypeError, match=r"programs\[1\]"):
        iw.plan_all([programs[0], "program"])  # type: ignore[list-item]
    with pytest.raises(ValueError, match="jobs"):
        iw.plan_all(programs, jobs=0)


def test_a_failing_callback_ends_the_work() -> None:
    program = iw.Program.load(FIXTURES / "ten-motions.json")

    def fail(done: int, total: int) -> None:
        assert done < total
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        iw.plan_all([program] * 2000, progress=fail)


INTERRUPTED = """
import signal, sys, threading, time, os
import iiwasim as iw
program = iw.Program.load(sys.argv[1])
begun = []
def progress(done, total):
    if not begun:
        begun.append(done)
        threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    iw.plan_all([program] * 200000, progress=progress)
except KeyboardInterrupt:
    print("interrupted")
# The package still works.
print(iw.plan(program))
"""


def test_ctrl_c_ends_the_work() -> None:
    command = [sys.executable, "-c", INTERRUPTED, str(FIXTURES / "ten-motions.json")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    first, second = done.stdout.splitlines()
    assert first == "interrupted" and second.startswith("<iiwasim.Plan ")


def test_threads_share_the_package() -> None:
    program = iw.Program.load(FIXTURES / "ten-motions.json")
    times: list[float] = []
    threads = [
        threading.Thread(target=lambda: times.append(iw.plan(program).cycle_time_s))
        for _ in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(set(times)) == 1 and len(times) == 8


@pytest.mark.skipif(not hasattr(os, "fork"), reason="os.fork is not available")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_forked_process_plans() -> None:
    program = iw.Program.load(FIXTURES / "ten-motions.json")
    plans = iw.plan_all([program] * 4)
    assert all(isinstance(plan, iw.Plan) for plan in plans)
    child = os.fork()
    if child == 0:
        # Not the exceptions of the test itself.
        signal.alarm(60)
        os._exit(0 if all(isinstance(plan, iw.Plan) for plan in iw.plan_all([program] * 4)) else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
