"""Processes of tests, and waiting for conditions, with time limits."""

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
# Time limit for conditions that other processes fulfil: far above the time that a slow machine
# needs.
PATIENCE_S = 60.0

# The port selection of all Python tests, and the simulated robot of the browser tests.
sys.path.append(str(REPOSITORY / "tests/browser"))

T = TypeVar("T")


def until(
    condition: Callable[[], T], what: str, *, patience_s: float = PATIENCE_S, every_s: float = 0.05
) -> T:
    """Waits until a condition is true, and returns its value."""
    end = time.monotonic() + patience_s
    while True:
        if found := condition():
            return found
        for program in running:
            assert program.runs() or not program.lasts, f"it has ended: {program.said()[-3000:]}"
        assert time.monotonic() < end, f"not within {patience_s:.0f} s: {what}"
        time.sleep(every_s)


class Program:
    """A running program with its output in a file."""

    # True if the program must not end before it is stopped.
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
        """Waits until the program ends by itself, and returns its exit code."""
        self.lasts = False
        code = self.process.wait(patience_s)
        if self in running:
            running.remove(self)
        return code

    def end(self, patience_s: float = 20.0) -> int:
        """Terminates the program, and kills it after a while."""
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
    """Ends all programs, also after a test that failed."""
    ending = running.copy()
    for program in ending:
        program.send(signal.SIGCONT)
        program.send(signal.SIGTERM)
    for program in ending:
        program.end(5)
