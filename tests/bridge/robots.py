"""A simulated robot with its drive, accessed by the drive protocol without the bridge."""

from __future__ import annotations

import json
import math
import subprocess
import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import zmq

from processes import PATIENCE_S, REPOSITORY, Program, until
from rig import Rig

FIXTURES = REPOSITORY / "fixtures"
START_DEG = [0, 20, 0, -70, 0, 90, 0]
# Tolerance for equal joints, above the error of measured positions.
SAME_RAD = 1e-3


def program(*targets_deg: list[float], velocity_rel: float = 0.6, **options: Any) -> dict[str, Any]:
    """Motions through targets and back to the start."""
    targets = [*targets_deg, START_DEG]
    motions = [
        {"type": "ptp", "joints_deg": target, "velocity_rel": velocity_rel} for target in targets
    ]
    return {"version": 1, "start": {"joints_deg": START_DEG}, "motions": motions, **options}


# Some seconds of motion, so that tests can act during the run.
AWAY_DEG = [60, 40, 0, -70, 0, 60, 0]
LONG = program(*[AWAY_DEG, START_DEG] * 3, velocity_rel=0.4)
VERY_LONG = program(*[AWAY_DEG, START_DEG] * 12, velocity_rel=0.2)
SHORT = program([10, *START_DEG[1:]])


def ask(address: str, type: str, **request: Any) -> dict[str, Any]:
    """The reply of a drive."""
    with zmq.Context() as context, context.socket(zmq.REQ) as socket:
        socket.setsockopt(zmq.LINGER, 0)
        socket.setsockopt(zmq.RCVTIMEO, int(PATIENCE_S * 1000))
        socket.connect(f"tcp://{address}")
        socket.send_json({"type": type, **request})
        return socket.recv_json()


@contextmanager
def published(stream: str, topic: str = "joints") -> Iterator[list[dict[str, Any]]]:
    """Messages that a drive publishes within the context; joints are received before it begins."""
    read: list[dict[str, Any]] = []
    ended, begun = threading.Event(), threading.Event()

    def follow() -> None:
        with zmq.Context() as context, context.socket(zmq.SUB) as socket:
            socket.setsockopt(zmq.RCVHWM, 0)
            socket.setsockopt(zmq.RCVTIMEO, 100)
            socket.setsockopt(zmq.LINGER, 0)
            socket.subscribe(topic)
            socket.connect(f"tcp://{stream}")
            while not ended.is_set():
                try:
                    _, message = socket.recv_multipart()
                except zmq.Again:
                    continue
                read.append(json.loads(message))
                begun.set()

    thread = threading.Thread(target=follow, daemon=True)
    thread.start()
    assert topic != "joints" or begun.wait(PATIENCE_S), "the drive publishes nothing"
    try:
        yield read
    finally:
        ended.set()
        thread.join(PATIENCE_S)


class Robot(Rig):
    """A robot and its drive; started processes end with the `with` block."""

    def __init__(self, binary: Path, folder: Path, *cabinet: str) -> None:
        start = ",".join(map(str, START_DEG))
        super().__init__(binary, folder, f"--start-deg={start}", *cabinet)
        self.address = self.drive_at[1]
        self.stream = self.stream_at[1]

    def ask(self, type: str, **request: Any) -> dict[str, Any]:
        """The drive's reply."""
        return ask(self.address, type, **request)

    def state(self) -> dict[str, Any]:
        return self.ask("state")

    def joints(self) -> list[float]:
        return self.state()["joints_rad"]

    def lost_and_late(self) -> tuple[int, int]:
        fri = self.state()["fri"]
        return fri["lost"], fri["late"]

    def is_idle(self) -> bool:
        return self.state()["state"] == "idle"

    def is_at(self, joints_rad: list[float], within_rad: float = SAME_RAD) -> bool:
        return all(abs(a - b) < within_rad for a, b in zip(self.joints(), joints_rad))

    def start_run(self, motions: dict[str, Any], *options: str, name: str = "program") -> Program:
        """Starts `iiwasim run` in the background."""
        path = self.folder / f"{name}.json"
        path.write_text(json.dumps(motions))
        command = [str(self.program), "run", str(path), "--no-output", "--json", *options]
        command += ["--move-to-start=50", *self.drive_at, *self.stream_at]
        log = self.folder / f"{name}.run"
        log.unlink(missing_ok=True)
        return Program(command, log, folder=self.folder)

    def run_motions(self, motions: dict[str, Any], *options: str) -> dict[str, Any]:
        """Runs motions to their end, and returns the figures."""
        run = self.start_run(motions, *options)
        code = run.wait(PATIENCE_S * 2)
        assert code == 0, run.said()
        return json.loads(run.said().splitlines()[-1])

    def stop(self) -> None:
        subprocess.run(
            [self.program, "stop", *self.drive_at],
            check=True,
            capture_output=True,
            timeout=PATIENCE_S,
        )

    def rest(self) -> None:
        """Brings the robot to rest at the start of programs, so that a program is a single run."""
        self.stop()
        until(self.is_idle, "the robot is idle")
        if not self.is_at([math.radians(angle) for angle in START_DEG]):
            self.run_motions(SHORT)
            until(self.is_idle, "the robot is idle")

    def samples(self, topic: str = "joints") -> AbstractContextManager[list[dict[str, Any]]]:
        """Messages that the drive publishes within the context."""
        return published(self.stream, topic)
