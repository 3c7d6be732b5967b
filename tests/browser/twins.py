"""A robot with its drive and its twin, and user actions on the page."""

from __future__ import annotations

import json
import threading
import time
from pathlib import Path

from chromium import Browser
from rig import Rig
from scene import write_scene

FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"

# Alternating motions, blended, so that the robot moves nearly all the time.
TO_AND_FRO = {
    "version": 1,
    "start": {"joints_deg": [0, 20, 0, -70, 0, 90, 0]},
    "motions": [
        {
            "type": "ptp",
            "joints_deg": [60 * (-1) ** i, 20 + 10 * (i % 3), 0, -70, 0, 90, 0],
            "velocity_rel": 0.6,
            "blend": {"fraction": 0.3},
        }
        for i in range(12)
    ]
    + [{"type": "ptp", "joints_deg": [0, 20, 0, -70, 0, 90, 0], "velocity_rel": 0.6}],
}


# A target whose turn does not match the joints there.
ODD = {
    "version": 1,
    "start": {"joints_deg": [0, 30, 0, -60, 0, 90, 0]},
    "motions": [
        {
            "type": "ptp",
            "frame": {"x_mm": 500, "y_mm": 100, "z_mm": 400, "a_deg": 0, "b_deg": 180, "c_deg": 0}
            | {"e1_deg": 0, "status": 2, "turn": 127},
        }
    ],
}


class Twin:
    """A robot, its drive and its twin."""

    def __init__(self, rig: Rig, minutes: float) -> None:
        self.rig = rig
        self.minutes = minutes
        self.has_spare_frames = False
        (rig.folder / "to-and-fro.json").write_text(json.dumps(TO_AND_FRO))
        self.start()

    def start(self) -> None:
        """Starts the twin, on the same port each time, so that an open page can reconnect."""
        rig = self.rig
        options = [
            "--port",
            "0",
            "--scene",
            write_scene(rig.folder),
            "--positions",
            "positions.json",
        ]
        printed = rig.folder / "address"
        with printed.open("w") as out:
            self.process = rig.start("twin", *options, *rig.drive_at, *rig.stream_at, stdout=out)
        until = time.monotonic() + 300
        while not printed.read_text().endswith("\n"):
            assert time.monotonic() < until, "the twin tells no address"
            time.sleep(0.02)
        self.address = printed.read_text().strip()

    def open(self, browser: Browser) -> None:
        browser.size(1280, 1000)
        browser.scheme("light")
        if not self.has_spare_frames:
            browser.spare_frames()
            self.has_spare_frames = True
        browser.go(self.address)
        browser.until(
            "document.readyState === 'complete' && typeof live === 'object' && live.newest && "
            "live.health.status"
        )
        browser.frames()

    def keep(self, browser: Browser, name: str) -> None:
        (self.rig.folder / f"{name}.png").write_bytes(browser.picture(whole=True))


def text(browser: Browser, place: str) -> str:
    return browser.run(f"document.getElementById('{place}').textContent")


def load(browser: Browser, program: Path) -> None:
    """Loads a program as if its file had been selected."""
    words = json.dumps(program.read_text())
    browser.run("desk.before = desk.plan && desk.plan.id")
    browser.run(f"loadFile(new File([{words}], {json.dumps(program.name)}))")
    browser.until("desk.plan && desk.plan.id !== desk.before")
    browser.frames()


def send(browser: Browser) -> None:
    browser.until("!document.getElementById('send').disabled")
    browser.click("#send")
    browser.until("document.getElementById('confirm').open")
    if browser.run("document.getElementById('confirm-yes').disabled"):
        browser.click("#move-to-start")
    assert not browser.run("document.getElementById('confirm-yes').disabled")
    browser.click("#confirm-yes")
    browser.until("!document.getElementById('confirm').open")


class Mover(threading.Thread):
    """Runs alternating motions until it is stopped."""

    def __init__(self, rig: Rig) -> None:
        super().__init__(daemon=True)
        self.rig = rig
        self.ended = False
        self.start()

    def run(self) -> None:
        while not self.ended:
            self.rig.run(Path("to-and-fro.json"), "--no-output", "--move-to-start=100")

    def end(self) -> None:
        self.ended = True
        self.join()
