"""Processes that tests start, conditions that they wait for, and the end of both."""

from __future__ import annotations

import atexit
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

REPOSITORY = Path(__file__).resolve().parents[2]
# Where something waits for a condition that others fulfil: far above what a slow machine needs.
PATIENCE_S = 60.0

# The choice of ports of all tests in Python, and the simulated robot of those with a browser.
sys.path.append(str(REPOSITORY / "tests/browser"))

T = TypeVar("T")


def until(
    condition: Callable[[], T], what: str, *, patience_s: float = PATIENCE_S, every_s: float = 0.05
) -> T:
    """What the condition gives as soon as that is true."""
    end = time.monotonic() + patience_s
    while True:
        if found := condition():
            return found
        for program in running:
            assert program.runs() or not program.lasts, f"it has ended: {program.said()[-3000:]}"
        assert time.monotonic() < end, f"not within {patience_s:.0f} s: {what}"
        time.sleep(every_s)


class Program:
    """A program that runs, whose output is a file."""

    # Whether it is wrong that it ends before it is asked to.
    lasts = False

    def __init__(self, command: list[str], log: Path, *, folder: Path | None = None) -> None:
        self.log = log
        with log.open("ab") as output:
            self.process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                cwd=folder,
            )
        running.append(self)

    @property
    def pid(self) -> int:
        return self.process.pid

    def runs(self) -> bool:
        return self.process.poll() is None

    def said(self) -> str:
        return self.log.read_text(errors="replace")

    def send(self, number: signal.Signals) -> None:
        if self.runs():
            os.kill(self.pid, number)

    def wait(self, patience_s: float = PATIENCE_S) -> int:
        """Its exit code, once it has ended by itself."""
        self.lasts = False
        code = self.process.wait(patience_s)
        if self in running:
            running.remove(self)
        return code

    def end(self, patience_s: float = 20.0) -> int:
        """Asks it to end, and insists after a while."""
        self.send(signal.SIGCONT)
        self.send(signal.SIGTERM)
        try:
            return self.wait(patience_s)
        except subprocess.TimeoutExpired:
            return self.kill()

    def kill(self) -> int:
        self.send(signal.SIGKILL)
        return self.wait()


running: list[Program] = []


@atexit.register
def end_all() -> None:
    """A test that fails in between leaves nothing behind."""
    ending = running.copy()
    for program in ending:
        program.send(signal.SIGCONT)
        program.send(signal.SIGTERM)
    for program in ending:
        program.end(5)
