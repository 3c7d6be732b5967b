"""Simulated robots with their drives, as processes on free ports of this machine.

`IIWASIM_BINARY` is the path of `iiwasim`; without it, tests are skipped.
"""

from __future__ import annotations

import atexit
import os
import signal
import subprocess
import sys
import time
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import ModuleType
    from typing import Self

    from iiwasim.drive import Drive

REPOSITORY = Path(__file__).resolve().parents[2]
START_TIMEOUT_S = 30.0


@cache
def ports() -> ModuleType:
    """The module that chooses ports for all Python tests."""
    sys.path.append(str(REPOSITORY / "tests/browser"))
    module = import_module("ports")
    atexit.register(lambda: [guard.close() for guard in module.guards])
    return module


def free_ports(count: int) -> list[int]:
    """Unused ports."""
    return ports().free_ports(count)


def binary() -> Path:
    """The program `iiwasim`; without it, the test is skipped."""
    named = os.environ.get("IIWASIM_BINARY")
    if named is None:
        pytest.skip("IIWASIM_BINARY is not set: it has to be a built program `iiwasim`")
    return Path(named).resolve()


class SimulatedRobot:
    """A robot and its drive, which end with the `with` block."""

    def __init__(
        self, folder: Path, *, cabinet: tuple[str, ...] = (), drive: tuple[str, ...] = ()
    ) -> None:
        self.folder = folder
        self.program = binary()
        self.started: list[subprocess.Popen[bytes]] = []
        fri, instructions, state, requests, stream = free_ports(5)
        self.address, self.stream = f"127.0.0.1:{requests}", f"127.0.0.1:{stream}"
        link = ["--fri", f"127.0.0.1:{fri}"]
        at = ["--instructions", f"127.0.0.1:{instructions}", "--state", f"127.0.0.1:{state}"]
        self.cabinet = self.start("cabinet", *link, *at, *cabinet)
        at = ["--cabinet-instructions", str(instructions), "--cabinet-state", str(state)]
        self.drive = self.start(
            "drive", *link, *at, "--instructions", self.address, "--stream", self.stream, *drive
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for process in self.started:
            process.terminate()
        for process in self.started:
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def start(self, *arguments: str) -> subprocess.Popen[bytes]:
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        process = subprocess.Popen([self.program, *arguments], cwd=self.folder, **quiet)
        self.started.append(process)
        return process

    def wait_until_ready(self, drive: Drive) -> None:
        """Waits until robot and drive are connected."""
        until = time.monotonic() + START_TIMEOUT_S
        while True:
            state = drive.state()
            if state.robot_program.connected and state.fri.session == "monitoring_ready":
                return
            assert time.monotonic() < until, f"the robot is not ready: {state}"
            time.sleep(0.05)


@pytest.fixture(scope="session")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SimulatedRobot]:
    """The robot that tests share; each test leaves it at rest."""
    from iiwasim.drive import Drive

    with SimulatedRobot(tmp_path_factory.mktemp("robot")) as started:
        started.wait_until_ready(Drive(started.address, timeout_s=START_TIMEOUT_S))
        yield started


@pytest.fixture
def drive(robot: SimulatedRobot) -> Iterator[Drive]:
    """The drive of the shared robot."""
    from iiwasim.drive import Drive

    with Drive(robot.address, stream=robot.stream) as connected:
        yield connected


@pytest.fixture(autouse=True)
def bounded() -> Iterator[None]:
    """Time limit: a test that blocks fails, and the processes that it started end."""

    def give_up(*_: object) -> None:
        raise TimeoutError("the test takes more than five minutes")

    if sys.platform == "win32":
        yield
        return
    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(300)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)
