"""Frame rate, latency and memory of the `iiwasim twin` page."""

from __future__ import annotations

import bisect
import json
import statistics
import subprocess
import threading
import time
from pathlib import Path

from chromium import Browser
from rig import Rig
from twins import Mover, Twin


class Witness(threading.Thread):
    """Another client of the drive, which records the arrival of each stamp, in ms since 1970."""

    def __init__(self, rig: Rig) -> None:
        super().__init__(daemon=True)
        self.stamps: list[float] = []
        self.heard_ms: list[float] = []
        self.process = rig.start(
            "status",
            "--watch",
            "--json",
            *rig.drive_at,
            *rig.stream_at,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.start()

    def run(self) -> None:
        for line in self.process.stdout:
            message = json.loads(line)
            if "joints_rad" in message:
                self.stamps.append(message["t_s"])
                self.heard_ms.append(1e3 * time.time())

    def when(self, stamp: float) -> float | None:
        at = bisect.bisect_left(self.stamps, stamp - 1e-9)
        same = at < len(self.stamps) and abs(self.stamps[at] - stamp) < 1e-6
        return self.heard_ms[at] if same else None


def resident_kb(process: subprocess.Popen) -> int:
    status = Path(f"/proc/{process.pid}/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0])


def heap_kb(browser: Browser) -> int:
    """Heap size of the page after garbage collection."""
    for _ in range(2):
        browser.call("HeapProfiler.collectGarbage")
    return int(browser.call("Runtime.getHeapUsage")["usedSize"]) // 1024


def frames_latency_and_memory(browser: Browser, twin: Twin) -> str:
    twin.open(browser)
    browser.run("allFrames = true")
    witness = Witness(twin.rig)
    mover = Mover(twin.rig)
    # Records the data of each frame with its drawing time.
    browser.run("""(() => {
        window.frames_ = [];
        const drawn = drawnNow;
        drawnNow = () => {
            if (live.fresh) frames_.push([clockMs(), live.newest.t_s]);
            drawn();
        };
    })()""")
    frames: list[list[float]] = []
    memory = []
    end = time.monotonic() + 60 * twin.minutes
    # A busy machine without a graphics card needs seconds per frame.
    last_end = end + 180
    try:
        # The page adapts its resolution first.
        time.sleep(10)
        browser.run("frames_.length = 0")
        while time.monotonic() < (end if frames else last_end):
            begin = time.monotonic()
            while time.monotonic() < begin + 10:
                time.sleep(1)
                frames += browser.run("frames_.splice(0)")
            memory.append((resident_kb(twin.process), heap_kb(browser)))
            # Garbage collection delays frames, which are dropped.
            browser.run("frames_.length = 0")
    finally:
        mover.end()
    time.sleep(0.5)
    seconds: dict[int, int] = {}
    for now_ms, _ in frames:
        seconds[int(now_ms // 1000)] = seconds.get(int(now_ms // 1000), 0) + 1
    late_ms = sorted(
        now_ms - heard for now_ms, stamp in frames if (heard := witness.when(stamp)) is not None
    )
    assert frames, "nothing was drawn"
    assert len(late_ms) > 0.9 * len(frames), (
        f"{len(late_ms)} of {len(frames)} frames are known to the witness"
    )
    usual = statistics.median(seconds.values())
    share = lambda part: late_ms[int(part * (len(late_ms) - 1))]
    # The initial messages have been received by then.
    first, last = memory[len(memory) // 4], memory[-1]
    grown = (
        f"twin {first[0] / 1e3:.1f} to {last[0] / 1e3:.1f} MB, page {first[1] / 1e3:.1f} to "
        f"{last[1] / 1e3:.1f} MB"
    )
    figure = (
        f"twin, {twin.minutes:g} minutes at 5 ms: {usual:.0f} frames a second without a graphics "
        "card, from robot to "
        f"screen {share(0.5):.0f} ms, 90 % within {share(0.9):.0f} ms, 99 % within "
        f"{share(0.99):.0f} ms; memory: {grown}"
    )
    print(f"        {figure}", flush=True)
    assert last[0] - first[0] < 4000, grown
    assert last[1] - first[1] < 2000, grown
    return figure
