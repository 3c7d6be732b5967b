#!/usr/bin/env python3
"""Builds message types without wheels on PyPI, and installs them into the current environment.

    message_types.py

Builds `control_msgs` and `tf2_msgs`, with the types that the bridge uses in the folder `messages`,
and `iiwasim_msgs`. Needs CMake, a C++ compiler, and the packages in requirements.txt. Takes a
minute.
"""

from __future__ import annotations

import re
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
    """Corrects CMake files of the wheels, which name the folders of the Python that built them."""
    theirs = re.compile(r'/opt/python/[^";]*')
    for file in (prefix / "share").rglob("*.cmake"):
        text = file.read_text()
        mended = theirs.sub(sysconfig.get_path("include"), text)
        if mended != text:
            file.write_text(mended)


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
