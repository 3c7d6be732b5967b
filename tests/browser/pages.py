"""Pages of `iiwasim report` for a browser, and their input files."""

from __future__ import annotations

import json
import math
import subprocess
from pathlib import Path
from random import Random

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from chromium import Browser
from rig import Rig
from scene import write_scene

FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"


# The WebGL buffer is cleared once it is on the screen, so draw and read it at once.
SCENE = "(drawScene(), document.getElementById('scene').toDataURL())"
CLOCK = "parseFloat(document.getElementById('clock').textContent)"
# Reading a canvas changes how it is drawn afterwards, so it is drawn again and read again.
READ = "[...document.querySelectorAll('#charts canvas')].map(it => it.toDataURL()).join()"
CHARTS = f"(() => {{ {READ}; drawCharts(); return {READ} }})()"


def many_motions(count: int) -> dict:
    """A program of alternating motions, some with blends and motion-specific limits."""
    motions = []
    for i in range(count):
        joints = [60 * math.sin(0.7 * i + j) for j in range(7)]
        motion = {"type": "ptp", "joints_deg": [round(q, 3) for q in joints]}
        if i % 3 == 1:
            motion["velocity_rel"] = 0.5
        if i % 5 == 2:
            motion["acceleration_rel"] = [1, 0.5, 1, 0.25, 1, 0.5, 1]
        if i % 2 and i + 1 < count:
            motion["blend"] = {"fraction": 0.3}
        motions.append(motion)
    return {"version": 1, "start": {"joints_deg": [0, 20, 0, -70, 0, 90, 0]}, "motions": motions}


# Stops, waits, and a motion without length.
WAITING = {
    "version": 1,
    "start": {"joints_deg": [0, 20, 0, -70, 0, 90, 0]},
    "motions": [
        {"type": "ptp", "joints_deg": [40, 20, 0, -70, 0, 90, 0]},
        {"type": "wait", "seconds": 0.8},
        {"type": "ptp", "joints_deg": [40, 20, 0, -70, 0, 90, 0]},
        {"type": "ptp", "joints_deg": [40, 50, 0, -60, 0, 60, 0]},
        {"type": "wait", "seconds": 0.5},
        {"type": "ptp", "joints_deg": [0, 20, 0, -70, 0, 90, 0]},
    ],
}
# Names, comments and groups with characters that HTML and JavaScript would interpret.
NAMED = {
    "version": 1,
    "start": {"joints_deg": [0, 20, 0, -70, 0, 90, 0]},
    "motions": [
        {
            "type": "ptp",
            "joints_deg": [40, 20, 0, -70, 0, 90, 0],
            "name": "<b>first</b> </script>",
            "comment": "one line\n<i>another</i> line",
            "group": "pick & place",
        },
        {"type": "wait", "seconds": 0.5},
        {"type": "ptp", "joints_deg": [0, 20, 0, -70, 0, 90, 0], "group": "pick & place"},
    ],
}
# The operating mode T1, an override, and a blend that is larger than half of a motion.
SLOWLY = {
    "version": 1,
    "mode": "t1",
    "override_percent": 30,
    "start": {"joints_deg": [0, 30, 0, -60, 0, 90, 0]},
    "motions": [
        {"type": "lin_rel", "offset": {"z_mm": -40}, "blend": {"cart_mm": 50}},
        {"type": "lin_rel", "offset": {"y_mm": 150}},
        {"type": "lin_rel", "offset": {"z_mm": 5}},
    ],
}
TURNED = {"a_deg": 10, "b_deg": 180, "c_deg": 0, "e1_deg": 0}
# An angled tool, and a linear motion of its TCP.
WITH_TOOL = {
    "version": 1,
    "tools": {"gripper": {"tcp": {"z_mm": 120, "b_deg": 20}}},
    "tool": "gripper",
    "start": {"joints_deg": [0, 30, 0, -60, 0, 90, 0]},
    "motions": [
        {"type": "ptp", "joints_deg": [30, 40, 0, -70, 0, 50, 40]},
        {"type": "lin_rel", "offset": {"z_mm": -100}},
        {"type": "lin_rel", "offset": {"x_mm": -50, "y_mm": 80}},
    ],
}

# A spline of four segments.
SPLINE = {
    "version": 1,
    "start": {"joints_deg": [0, 30, 0, -60, 0, 90, 0]},
    "motions": [
        {"type": "ptp", "joints_deg": [10, 40, 0, -60, 0, 80, 0]},
        {
            "type": "spline",
            "segments": [
                {"type": kind, "frame": dict(zip(("x_mm", "y_mm", "z_mm"), xyz)) | TURNED}
                for kind, *xyz in (
                    ("spl", 600, 100, 450),
                    ("spl", 600, 150, 480),
                    ("lin", 550, 200, 450),
                    ("spl", 500, 100, 450),
                )
            ],
        },
    ],
}


class Pages:
    """The `iiwasim` program, and the folder of its pages."""

    def __init__(self, program: Path, folder: Path, urdf: Path | None = None) -> None:
        self.program = program.resolve()
        self.urdf = urdf and urdf.resolve()
        self.folder = folder.resolve()
        self.folder.mkdir(parents=True, exist_ok=True)

    def iiwasim(self, *arguments: str) -> str:
        done = subprocess.run(
            [self.program, *arguments], cwd=self.folder, check=True, capture_output=True, text=True
        )
        return done.stdout

    def make(self) -> None:
        for name in ("ten-motions", "appendix-b", "waits-and-stops"):
            self.iiwasim("plan", str(FIXTURES / f"{name}.json"), "-o", f"{name}.mcap")
            self.iiwasim("report", f"{name}.mcap")
        # Substitute for the robot: the same program without jerk limits, and with other blends.
        program = str(FIXTURES / "appendix-b.json")
        other = ["--timing", "acceleration", "--blend-shape", "alpha", "--rate", "1000"]
        self.iiwasim("plan", program, "-o", "measured.mcap", *other)
        self.iiwasim("report", "appendix-b.mcap", "measured.mcap", "-o", "compared.html")
        # Ten times as fast as real time; time stamps are those of the robot.
        with Rig(self.program, self.folder, "--speed", "10", "--noise", "2e-5") as rig:
            rig.run(
                FIXTURES / "ten-motions.json",
                "-o",
                "real.mcap",
                "--overwrite",
                "--move-to-start=100",
            )
        self.iiwasim("report", "ten-motions.mcap", "real.mcap", "-o", "run.html")
        # The recording contains its program, so that the page can also show its plan.
        self.iiwasim("report", "real.mcap", "-o", "run-alone.html")
        self.iiwasim("report", str(FIXTURES / "data-recorder.log"), "-o", "recorder.html")
        # Many motions with motion-specific limits, some of them equal; one motion.
        (self.folder / "many.json").write_text(json.dumps(many_motions(300)))
        (self.folder / "one.json").write_text(json.dumps(many_motions(1)))
        (self.folder / "named.json").write_text(json.dumps(NAMED))
        (self.folder / "slowly.json").write_text(json.dumps(SLOWLY))
        for name in ("many", "one", "named", "slowly"):
            self.iiwasim("plan", f"{name}.json")
            self.iiwasim("report", f"{name}.mcap")
        # Obstacles, and a tool with all kinds of shapes.
        scene = write_scene(self.folder)
        self.iiwasim("report", "ten-motions.mcap", "--scene", scene, "-o", "scene.html")
        self.iiwasim(
            "report", "ten-motions.mcap", "real.mcap", "--scene", scene, "-o", "scene-run.html"
        )
        self.make_deviations()
        self.make_tool()
        # A truncated file, long enough for several chunks.
        self.iiwasim("plan", program, "-o", "cut.mcap", "--rate", "4000")
        cut = self.folder / "cut.mcap"
        cut.write_bytes(cut.read_bytes()[: cut.stat().st_size // 2])
        self.iiwasim("report", "cut.mcap")

    def make_deviations(self) -> None:
        """Creates recordings: exact, with waits, and with a gap."""
        (self.folder / "waiting.json").write_text(json.dumps(WAITING))
        self.iiwasim("plan", "waiting.json")
        self.csv("ten-motions", "exact.csv", 0.0)
        self.csv("waiting", "waiting.csv", 2e-5)
        self.csv("waiting", "gap.csv", 2e-5, (0.6, 0.9))
        for plan, recording in (
            ("ten-motions", "exact"),
            ("waiting", "waiting"),
            ("waiting", "gap"),
        ):
            self.iiwasim("report", f"{plan}.mcap", f"{recording}.csv", "-o", f"{recording}.html")
        self.iiwasim("report", "waiting.mcap", "-o", "long-wait.html")

    def make_tool(self) -> None:
        for name, program in (("tool", WITH_TOOL), ("spline", SPLINE)):
            (self.folder / f"{name}.json").write_text(json.dumps(program))
            self.iiwasim("plan", f"{name}.json")
            self.iiwasim("report", f"{name}.mcap")

    def csv(
        self, plan: str, name: str, noise_rad: float, gap: tuple[float, float] = (0, 0)
    ) -> None:
        """Creates the recording of a robot that follows a plan, with noise and a gap."""
        random = Random(7)
        with (
            (self.folder / name).open("w") as table,
            (self.folder / f"{plan}.mcap").open("rb") as file,
        ):
            table.write("t_s," + ",".join(f"joint_{j}_rad" for j in range(1, 8)) + "\n")
            reader = make_reader(file, decoder_factories=[DecoderFactory()])
            start = None
            for *_, message in reader.iter_decoded_messages(topics=["/joint_states"]):
                t = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
                start = t if start is None else start
                if gap[0] < t - start < gap[1]:
                    continue
                joints = [q + random.gauss(0, noise_rad) for q in message.position]
                table.write(f"{t - start:.6f}," + ",".join(f"{q:.9f}" for q in joints) + "\n")

    def efforts(self, name: str) -> list[tuple[float, list[float]]]:
        """Stamps in s and torques of a file, without conversion."""
        with (self.folder / f"{name}.mcap").open("rb") as file:
            reader = make_reader(file, decoder_factories=[DecoderFactory()])
            messages = [
                message for *_, message in reader.iter_decoded_messages(topics=["/joint_states"])
            ]
        return [
            (m.header.stamp.sec + 1e-9 * m.header.stamp.nanosec, list(m.effort)) for m in messages
        ]

    @staticmethod
    def json(text: str) -> dict:
        return json.loads(text)

    def page(self, name: str) -> Path:
        return self.folder / f"{name}.html"

    def keep(self, browser: Browser, name: str, whole: bool = True) -> None:
        (self.folder / f"{name}.png").write_bytes(browser.picture(whole))


def desk(browser: Browser) -> None:
    browser.size(1280, 900)
    browser.scheme("light")


def seek(browser: Browser, t: float) -> None:
    """Sets the time slider, like a user with keyboard or touch."""
    script = f"""(() => {{
        const scrub = document.getElementById("scrub");
        scrub.value = {t};
        scrub.dispatchEvent(new Event("input", {{ bubbles: true }}));
    }})()"""
    browser.run(script)
    browser.frames()
