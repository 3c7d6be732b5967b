"""A simulated robot and its drive as processes, on free ports of this machine."""

from __future__ import annotations

import os
import subprocess
import time
from pathlib import Path
from typing import Self

from ports import free_ports


def cpu_s(pid: int) -> float:
    """User and system CPU time of a process."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Rig:
    """A robot and its drive, which end with the `with` block."""

    def __init__(self, program: Path, folder: Path, *cabinet: str) -> None:
        self.program = program.resolve()
        self.folder = folder.resolve()
        self.folder.mkdir(parents=True, exist_ok=True)
        self.started: list[subprocess.Popen] = []
        fri, instructions, state, requests, stream = free_ports(5)
        at = "127.0.0.1:{}".format
        self.drive_options = [
            "--fri",
            at(fri),
            "--instructions",
            at(requests),
            "--stream",
            at(stream),
        ]
        self.drive_options += [
            "--cabinet-instructions",
            str(instructions),
            "--cabinet-state",
            str(state),
        ]
        self.drive_at = ["--drive", at(requests)]
        self.stream_at = ["--stream", at(stream)]
        robot = ["--fri", at(fri), "--instructions", at(instructions), "--state", at(state)]
        self.start("cabinet", *cabinet, *robot)
        self.drive = self.start("drive", *self.drive_options)
        self.wait_until_ready()

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

    def start(self, *arguments: str, **options: object) -> subprocess.Popen:
        given = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, **options}
        process = subprocess.Popen([self.program, *arguments], cwd=self.folder, **given)
        self.started.append(process)
        return process

    def start_drive(self) -> None:
        self.drive = self.start("drive", *self.drive_options)

    def run(self, program: Path, *options: str) -> None:
        """Runs a program on the robot to its end."""
        command = ["run", str(program), *options, *self.drive_at, *self.stream_at]
        subprocess.run([self.program, *command], cwd=self.folder, check=True, capture_output=True)

    def wait_until_ready(self) -> None:
        """Waits until robot and drive are connected."""
        until = time.monotonic() + 300
        while True:
            command = [self.program, "status", "--json", *self.drive_at]
            done = subprocess.run(command, check=False, capture_output=True, text=True)
            ready = ('"session":"monitoring_ready"', '"robot_program":"connected"')
            if done.returncode == 0 and all(part in done.stdout for part in ready):
                return
            if time.monotonic() > until:
                raise AssertionError(f"the robot is not ready: {done.stdout}{done.stderr}")
            time.sleep(0.1)
