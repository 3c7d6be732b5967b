"""Checks the remaining motion time that `iiwasim run` shows in a terminal.

    tests/terminal.py PROGRAM DRIVE STREAM

A robot has to be connected to the drive. The remaining time is compared with the planned time.
"""

import fcntl
import os
import pty
import re
import struct
import subprocess
import sys
import termios
import threading
from pathlib import Path

FIXTURE = Path(__file__).resolve().parent.parent / "fixtures" / "ten-motions.json"
SECONDS = 180


def shown(command: list[str]) -> str:
    """Output of a command to a terminal of 100 columns."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 30, 100, 0, 0))
    process = subprocess.Popen(command, stdout=theirs, stderr=theirs)
    os.close(theirs)
    end = threading.Timer(SECONDS, process.kill)
    end.start()
    parts = []
    try:
        while part := os.read(ours, 65536):
            parts.append(part)
    except OSError:
        # The terminal is closed with the process.
        pass
    finally:
        os.close(ours)
        code = process.wait()
        end.cancel()
    text = b"".join(parts).decode()
    assert code == 0, text
    return text


def main() -> None:
    binary, drive, stream = sys.argv[1:]
    command = [
        binary,
        "run",
        str(FIXTURE),
        "--no-output",
        "--move-to-start=30",
        "--drive",
        drive,
        "--stream",
        stream,
    ]
    text = shown(command)
    planned_s = float(re.search(r"Cycle time ([0-9.]+) s", text)[1])
    for bar, most_s in (("moving to the start", None), ("running", planned_s)):
        left_s = [int(found) for found in re.findall(rf"{bar} [^\r\n]*?([0-9]+) s left", text)]
        assert left_s, f"no bar says how long it is {bar}:\n{text}"
        assert left_s == sorted(left_s, reverse=True), f"{bar}: {left_s}"
        assert len(set(left_s)) > 1, f"{bar}: {left_s}"
        assert most_s is None or left_s[0] <= most_s + 1, f"{bar}: {left_s} of {most_s} s"
        print(f"{bar}: {left_s[0]} s left, then down to {left_s[-1]} s")


main()
