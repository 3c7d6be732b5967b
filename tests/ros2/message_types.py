#!/usr/bin/env python3
"""Builds the message types that PyPI has no wheels of, into the environment that this runs in.

    message_types.py

`control_msgs` and `tf2_msgs`, of which the folder `messages` has what the bridge uses, and `iiwasim_msgs`. Needs CMake, a C++
compiler, and what requirements.txt names. Takes a minute.
"""

from __future__ import annotations

import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
PACKAGES = [
    HERE / "messages/tf2_msgs",
    HERE / "messages/control_msgs",
    HERE.parents[1] / "docs/ros/iiwasim_msgs",
]


def mend(prefix: Path) -> None:
    """The wheels' CMake files name the headers of the Python that they were built with."""
    theirs = f"/opt/python/cp{sys.version_info.major}{sys.version_info.minor}-cp"
    for file in (prefix / "share").rglob("*.cmake"):
        text = file.read_text()
        start = text.find(theirs)
        if start >= 0:
            end = min(at for mark in '";' if (at := text.find(mark, start)) >= 0)
            file.write_text(text.replace(text[start:end], sysconfig.get_path("include")))


def build(package: Path, prefix: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        own = ["-S", str(package), "-B", folder, f"-DCMAKE_PREFIX_PATH={prefix}"]
        own += [f"-DCMAKE_INSTALL_PREFIX={prefix}", f"-DPython3_EXECUTABLE={sys.executable}"]
        subprocess.run(["cmake", *own, "-DCMAKE_BUILD_TYPE=Debug"], check=True)
        subprocess.run(["cmake", "--build", folder, "--target", "install"], check=True)


def main() -> None:
    prefix = Path(sys.prefix)
    mend(prefix)
    for package in PACKAGES:
        build(package, prefix)


if __name__ == "__main__":
    main()
