#!/usr/bin/env python3
"""Checks README and guide: commands and their outputs, programs, links.

    tests/guide/check.py target/release/iiwasim [PAGE.md ...] [--renew]

Each page has a separate folder with `fixtures` in it, and `iiwasim` on the path. On Linux, as root,
it also has a separate network, so that the usual ports of drive and cabinet are free. Fences are
processed in order:

    ```sh      is run by bash, and has to succeed. `cargo run --release -p iiwasim --` is the given
               binary.
    ```text    after it is its standard output: a line `...` matches any lines. Without an `sh`
               since the last heading it is prose.
    ```json    is a program, a scene, frames, a profile or motions for a drive, and is planned with.
               Heights in the text before a program are compared with the plan (geometry.py).
    ```yaml    is parsed, and those of its commands that begin with iiwasim are run.
    ```python  and the `text` after it are left to `python/tests/test_guide.py`.

A comment before a fence changes its meaning (MARKS). `--renew` writes the actual outputs into the
pages, with the same parts left out.
"""

import argparse
import contextlib
import ctypes
import difflib
import fcntl
import json
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

from geometry import MARK, Runner, check_geometry

ROOT = Path(__file__).resolve().parents[2]

MARKS = {
    "not run": re.compile(r"not run: \S"),
    "background": re.compile(r'in the background, until "(?P<ready>[^"]+)"'),
    "interrupt": re.compile(r"for (?P<seconds>\d+) s, then Ctrl-C"),
    "exit code": re.compile(r"exit code (?P<code>\d+)"),
    "standard error": re.compile(r"standard error"),
    "no output": re.compile(r"not its output"),
    "file": re.compile(r"file (?P<name>[\w.-]+)"),
    "part": re.compile(r"a part of a file"),
    "geometry": MARK,
    # Around what a script writes.
    "generated": re.compile(r"\w+: made by tests/|end$"),
}

# Lines with measured figures, and tolerances of their numbers: one for all, or one each.
MEASURED = [
    (re.compile(r"^Measured +\d"), 0.06),
    (re.compile(r"by the robot program's clock"), [0.06, 0]),
    (re.compile(r"^\d+ samples recorded"), 40),
    # Comparison: motion number, planned and real time, error in s and in per cent.
    (
        re.compile(r"^ *\d+ +\w+ +\d\.\d{3} +\d\.\d{3} +-?\d\.\d{4} +-?\d\.\d\d$"),
        [0, 0, 0.01, 0.01, 2],
    ),
    (re.compile(r"^Cycle time .* measured: off by"), [0, 0.01, 0.01, 0.2]),
    # The response time of FRI depends on the load of the machine.
    (re.compile(r"^FRI +\w+, quality"), 1000),
    # Fits to noisy samples: velocity, acceleration and jerk limits.
    (re.compile(r"^ +A\d +.* \+- "), [1e-3, 1e-3, 0, 0.1, 0.1, 0, 10, 10, 0]),
    (re.compile(r"^Settles for"), [1e-5, 1e-5, 0, 1e-5, 0]),
]

# Pages whose Rust examples are doctests of the crate `iiwa`.
RUST = [ROOT / "README.md", ROOT / "docs/guide/library.md"]

# Pages whose Python examples are run by `python/tests/test_guide.py`.
PYTHON = [ROOT / "README.md", ROOT / "docs/guide/python.md"]

# Other cargo commands, and the place where they are run.
CARGO = {
    "cargo test": "the step `tests`",
    "cargo build": "the step `build`",
    "cargo install": "the step `build` compiles the same",
    "cargo doc": "the step `documentation`",
}

QUALITY = re.compile(r"(?<=quality )(excellent|good|fair|poor)")

NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?")


@dataclass
class Fence:
    language: str
    line: int
    text: str
    marks: dict = field(default_factory=dict)
    # Text between the fence and the previous heading or fence.
    prose: str = ""


@dataclass
class Page:
    path: Path
    fences: list
    problems: list = field(default_factory=list)
    commands: int = 0
    outputs: int = 0
    documents: int = 0

    def wrong(self, fence, message):
        self.problems.append(f"{self.path.relative_to(ROOT)}:{fence.line}: {message}")


def read_page(path):
    page = Page(path, [])
    lines = path.read_text(encoding="utf-8").split("\n")
    marks, fence, prose = {}, None, []
    for number, line in enumerate(lines, 1):
        if fence is not None:
            if line.strip() == "```":
                fence.text = "\n".join(lines[fence.line : number - 1])
                page.fences.append(fence)
                fence, prose = None, []
        elif match := re.match(r"```(\S*)", line):
            fence, marks = Fence(match[1], number, "", marks, "\n".join(prose)), {}
        elif match := re.match(r"<!-- (.*) -->$", line):
            known = {name: found for name, mark in MARKS.items() if (found := mark.match(match[1]))}
            if not known:
                page.problems.append(f"{path.relative_to(ROOT)}:{number}: unknown mark: {match[1]}")
            marks |= known
        elif line.startswith("#"):
            page.fences.append(Fence("#", number, line))
            marks, prose = {}, []
        elif line.strip():
            marks = {}
            prose.append(line)
    return page


class Folder:
    """The folder for the commands of a page, and its background processes."""

    def __init__(self, binary):
        self.path = Path(tempfile.mkdtemp(prefix="guide-"))
        (self.path / "fixtures").symlink_to(ROOT / "fixtures")
        programs = self.path / ".bin"
        programs.mkdir()
        (programs / "iiwasim").symlink_to(binary)
        inherited = {
            name: value for name, value in os.environ.items() if not name.startswith("IIWASIM_")
        }
        self.environment = inherited | {
            "PATH": f"{programs}:{os.environ['PATH']}",
            "HOME": str(self.path),
            "NO_COLOR": "1",
            "COLUMNS": "120",
        }
        self.running = []
        self.count = 0

    def start(self, script):
        """Starts a script in a separate process group, so that Ctrl-C reaches exactly its
        processes.
        """
        self.count += 1
        streams = [(self.path / f".{name}-{self.count}").open("w+") for name in ("out", "err")]
        process = subprocess.Popen(
            ["bash", "-euo", "pipefail", "-c", script],
            cwd=self.path,
            env=self.environment,
            stdin=subprocess.DEVNULL,
            stdout=streams[0],
            stderr=streams[1],
            start_new_session=True,
        )
        return process, [Path(stream.name) for stream in streams]

    def close(self):
        for process in reversed(self.running):
            stop(process, signal.SIGINT)
        shutil.rmtree(self.path, ignore_errors=True)


def stop(process, number):
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, number)
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def commands(text):
    """The lines of a fence that are run; of cargo commands, only those that run this binary."""
    found = []
    for line in text.split("\n"):
        line = line.replace("cargo run --release -p iiwasim --", "iiwasim")
        if line.startswith("cargo ") and any(line.startswith(known) for known in CARGO):
            continue
        found.append(line)
    return "\n".join(found)


def run(page, fence, folder):
    """Runs a fence; returns expected and actual output, or None."""
    script = commands(fence.text)
    if not script.strip():
        return None
    page.commands += 1
    process, files = folder.start(script)

    def outputs():
        return [file.read_text(encoding="utf-8", errors="replace") for file in files]

    if ready := fence.marks.get("background"):
        folder.running.append(process)
        for _ in range(300):
            if ready["ready"] in "".join(outputs()):
                return outputs()
            if process.poll() is not None:
                break
            time.sleep(0.1)
        page.wrong(fence, f"never printed {ready['ready']!r}:\n" + "".join(outputs()))
        return None
    if wait := fence.marks.get("interrupt"):
        time.sleep(int(wait["seconds"]))
        stop(process, signal.SIGINT)
        code = process.returncode
        allowed = {0, 130, -signal.SIGINT}
    else:
        try:
            code = process.wait(240)
        except subprocess.TimeoutExpired:
            stop(process, signal.SIGKILL)
            page.wrong(fence, "did not end within 4 minutes")
            return None
        wanted = fence.marks.get("exit code")
        allowed = {int(wanted["code"]) if wanted else 0}
    if code not in allowed:
        page.wrong(fence, f"exit code {code}:\n" + "".join(outputs()))
    return outputs()


def same(expected, found):
    if expected.rstrip() == found.rstrip():
        return True
    expected, found = (QUALITY.sub("#", line) for line in (expected, found))
    for pattern, bounds in MEASURED:
        if not (pattern.search(expected) and pattern.search(found)):
            continue
        # The width of columns depends on their numbers.
        shape = [
            re.sub(r"[\s─]+", " ", NUMBER.sub("#", line)).strip() for line in (expected, found)
        ]
        numbers = [[float(number) for number in NUMBER.findall(line)] for line in (expected, found)]
        if shape[0] != shape[1]:
            continue
        bounds = bounds if isinstance(bounds, list) else [bounds] * len(numbers[0])
        if len(bounds) == len(numbers[0]) and all(
            abs(a - b) <= by for a, b, by in zip(*numbers, bounds)
        ):
            return True
    return False


def agrees(expected, found):
    """True if the lines match; `...` matches any number of lines."""
    if not expected:
        return not found
    if expected[0].strip() == "...":
        return any(agrees(expected[1:], found[at:]) for at in range(len(found) + 1))
    return bool(found) and same(expected[0], found[0]) and agrees(expected[1:], found[1:])


def renewed(expected, found):
    """The lines found, cut at each `...` of those expected; None where a line after one has no
    counterpart: a line of the same words. Of several, it is the one that resembles it most.
    """
    if all(line.strip() != "..." for line in expected):
        return found

    def shape(line):
        return re.sub(r"[\s─]+", " ", NUMBER.sub("#", line)).strip()

    lines, at, is_cut = [], 0, False
    for line in expected:
        if line.strip() == "...":
            lines.append(line)
            is_cut = True
            continue
        if is_cut:
            alike = [i for i in range(at, len(found)) if shape(found[i]) == shape(line)]
            at = max(
                alike,
                key=lambda i: difflib.SequenceMatcher(None, line, found[i]).ratio(),
                default=len(found),
            )
        if at >= len(found):
            return None
        lines.append(found[at])
        at, is_cut = at + 1, False
    return lines if is_cut else lines + found[at:]


def compare(page, fence, outputs):
    page.outputs += 1
    stream = outputs[1 if "standard error" in fence.marks else 0]
    found = [line.rstrip() for line in stream.strip("\n").split("\n")]
    expected = [line.rstrip() for line in fence.text.strip("\n").split("\n")]
    if not agrees(expected, found):
        page.wrong(fence, "is not what the command prints:\n" + "\n".join(found))
        return renewed(expected, found)
    return None


# ---- documents in JSON and YAML

HOME_POSE = {"joints_deg": [0, 30, 0, -60, 0, 90, 0]}


def check_json(page, fence, folder):
    page.documents += 1
    try:
        document = json.loads(fence.text)
    except ValueError as error:
        page.wrong(fence, f"is not JSON: {error}")
        return
    if name := fence.marks.get("file"):
        (folder.path / name["name"]).write_text(fence.text + "\n")
    if "part" in fence.marks:
        return
    file = folder.path / "document.json"
    program = folder.path / "program-around-it.json"
    file.write_text(fence.text)
    program.write_text((ROOT / "fixtures/appendix-b.json").read_text())
    arguments = [program]
    if "obstacles" in document:
        arguments += ["--scene", file]
    elif isinstance(document.get("base"), str) and not document.keys() & {
        "motions",
        "frames",
        "bases",
        "tools",
    }:
        arguments += ["--robot", file]
    elif document.get("type") == "run_motions":
        motions = {key: value for key, value in document.items() if key != "type"}
        program.write_text(json.dumps({"version": 1, "start": HOME_POSE} | motions))
    elif "motions" in document:
        arguments = [file]
    else:
        around = {
            "version": 1,
            "include": file.name,
            "start": HOME_POSE,
            "motions": [{"type": "ptp"} | HOME_POSE],
        }
        program.write_text(json.dumps(around))
    done = subprocess.run(
        ["iiwasim", "plan", *arguments, "--no-output"],
        cwd=folder.path,
        env=folder.environment,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        page.wrong(fence, done.stderr)
    elif "motions" in document:
        planned = json.loads(arguments[0].read_text())
        runner = Runner(folder.path, folder.environment)
        for problem in check_geometry(planned, fence.prose, fence.marks.get("geometry"), runner):
            page.wrong(fence, problem)
    file.unlink()
    program.unlink()


def check_yaml(page, fence, folder):
    import yaml

    page.documents += 1

    def scripts(value):
        if isinstance(value, dict):
            for key, inner in value.items():
                if key in ("run", "script"):
                    yield from inner if isinstance(inner, list) else [inner]
                else:
                    yield from scripts(inner)
        elif isinstance(value, list):
            for inner in value:
                yield from scripts(inner)

    for script in scripts(yaml.safe_load(fence.text)):
        ours = "\n".join(
            line for line in script.split("\n") if line.lstrip().startswith("iiwasim ")
        )
        if ours:
            run(page, Fence("sh", fence.line, ours), folder)


def check_page(path, binary, renew):
    page = read_page(path)
    if not any(fence.language in ("sh", "json", "yaml") for fence in page.fences):
        return page
    folder = Folder(binary)
    outputs, replaced = None, {}
    try:
        for fence in page.fences:
            if fence.language == "#" or "not run" in fence.marks:
                outputs = None
            elif fence.language == "sh":
                outputs = run(page, fence, folder)
            elif fence.language == "text" and outputs and "no output" not in fence.marks:
                if (found := compare(page, fence, outputs)) is not None:
                    replaced[fence.line] = (fence.text, found)
            elif fence.language == "json":
                check_json(page, fence, folder)
            elif fence.language == "yaml":
                check_yaml(page, fence, folder)
            elif fence.language.startswith("rust") and page.path not in RUST:
                page.wrong(
                    fence,
                    "no doctest compiles it: crates/front/iiwa/src/lib.rs and RUST name the pages",
                )
            elif fence.language == "python":
                outputs = None
                if page.path not in PYTHON:
                    page.wrong(
                        fence,
                        "no test runs it: python/tests/test_guide.py and PYTHON name the pages",
                    )
            elif fence.language == "toml":
                page.documents += 1
                (folder.path / "iiwasim.toml").write_text(fence.text + "\n")
                run(page, Fence("sh", fence.line, "iiwasim schema"), folder)
            elif not fence.language.startswith(("rust", "text")):
                page.wrong(
                    fence, f"nothing checks {fence.language or 'a fence without a language'}"
                )
    finally:
        folder.close()
    if renew and replaced:
        lines = path.read_text(encoding="utf-8").split("\n")
        for line, (old, new) in sorted(replaced.items(), reverse=True):
            lines[line : line + len(old.split("\n"))] = new
        path.write_text("\n".join(lines), encoding="utf-8")
    return page


def own_network():
    """Creates a loopback interface only for this process and its children, if the system permits
    it.
    """
    library = ctypes.CDLL(None, use_errno=True)
    if not hasattr(library, "unshare") or library.unshare(0x40000000) != 0:
        return False
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        up = struct.pack("16sH14s", b"lo", 0x1 | 0x40, b"")
        fcntl.ioctl(any_socket, 0x8914, up)
    return True


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("binary", type=Path)
    parser.add_argument("pages", nargs="*", type=Path)
    parser.add_argument("--renew", action="store_true")
    options = parser.parse_args()
    paths = [page.resolve() for page in options.pages] or [
        ROOT / "README.md",
        *sorted((ROOT / "docs").rglob("*.md")),
    ]
    # A terminated check also ends its child processes.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    own_network()
    began, problems = time.monotonic(), []
    commands_run = outputs = documents = 0
    for path in paths:
        page_began = time.monotonic()
        page = check_page(path, options.binary.resolve(), options.renew)
        if page.commands or page.documents or page.problems:
            took = time.monotonic() - page_began
            verdict = f"{len(page.problems)} wrong" if page.problems else "as written"
            print(
                f"{path.relative_to(ROOT)}: {page.commands} blocks of commands, {verdict}, "
                f"{took:.1f} s",
                flush=True,
            )
        problems += page.problems
        commands_run += page.commands
        outputs += page.outputs
        documents += page.documents
    for problem in problems:
        print(problem, file=sys.stderr)
    print(
        f"guide: {commands_run} blocks of commands run, {outputs} outputs compared, {documents} "
        "documents read, "
        f"{len(problems)} wrong, {time.monotonic() - began:.0f} s"
    )
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
