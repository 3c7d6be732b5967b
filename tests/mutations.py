"""Runs the command on damaged input files, and checks that it ends in good order.

    tests/mutations.py BINARY [--count N] [--kind KIND] [--seed S] [--jobs N] [--keep FOLDER]
    tests/mutations.py --self-test

Each run has one damaged file in a temporary folder. The exit code has to be 0 to 3, the processor
time at most 1 s and the resident memory at most 400 MB; standard error must not report a panic, and
no files may be left besides the requested outputs. Case I of seed S has seed S + I: `--kind KIND
--seed S --count 1` repeats a case. The undamaged files are run first, and have to be accepted.
`--self-test` checks that each of these faults is found.
"""

from __future__ import annotations

import argparse
import os
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

from mutation_kinds import ROOT, Kind, Seed, all_kinds
from mutation_operators import mutated

CODES = range(4)
MOST_CPU_S = 1.0
MOST_MB = 400.0
# The machine is protected by these. A program that waits is ended after the last one.
KILLED_AFTER_CPU_S = 5
ADDRESS_SPACE = 6 << 30
FILE_BYTES = 256 << 20
KILLED_AFTER_S = 60.0
# Options whose value is a path to write.
OUTPUT_OPTIONS = ("-o", "--csv", "--parquet", "--picture")
# Folders of a run: its files, and the user's and temporary files.
FOLDERS = ("case", "home", "tmp")
MOST_KEPT = 10


@dataclass
class Run:
    """Figures of a run, and its violations."""

    code: int
    cpu_s: float
    memory_mb: float
    message: str = ""
    violations: list[str] = field(default_factory=list)


def limit(process: int) -> None:
    try:
        resource.prlimit(process, resource.RLIMIT_CPU, (KILLED_AFTER_CPU_S, KILLED_AFTER_CPU_S))
        resource.prlimit(process, resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))
        resource.prlimit(process, resource.RLIMIT_FSIZE, (FILE_BYTES, FILE_BYTES))
        resource.prlimit(process, resource.RLIMIT_CORE, (0, 0))
    except ProcessLookupError:
        pass


def write(folder: Path, files: dict[str, bytes]) -> None:
    for path, data in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(data)


def execute(command: list[str], root: Path, seconds: float) -> Run:
    """Runs a command in the folder `case`, with its home and temporary files in folders beside."""
    environment = {
        "PATH": os.environ["PATH"],
        "HOME": str(root / "home"),
        "TMPDIR": str(root / "tmp"),
        # No settings of folders above, unless the case has settings.
        "IIWASIM_CONFIG": "iiwasim.toml" if (root / "case/iiwasim.toml").exists() else "",
    }
    input_path = Path(os.devnull)
    if "<" in command:
        at = command.index("<")
        command, input_path = command[:at], root / "case" / command[at + 1]
    with input_path.open("rb") as stdin, tempfile.TemporaryFile() as stderr:
        process = subprocess.Popen(
            command,
            cwd=root / "case",
            env=environment,
            stdin=stdin,
            stdout=subprocess.DEVNULL,
            stderr=stderr,
        )
        limit(process.pid)
        is_late = threading.Event()
        timer = threading.Timer(seconds, lambda: (is_late.set(), process.kill()))
        timer.start()
        _, status, usage = os.wait4(process.pid, 0)
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        stderr.seek(0)
        message = stderr.read(1 << 20).decode(errors="replace")
    # The memory is at least that of this process, which the new process is for an instant.
    cpu_s, memory_mb = usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024
    done = Run(process.returncode, cpu_s, memory_mb, message)
    if is_late.is_set():
        done.violations.append(f"still running after {seconds:g} s")
    return done


def leftovers(done: Run, command: list[str], files: dict[str, bytes], root: Path) -> list[str]:
    """Violations in the folders of a run: new files besides outputs, and changed input files."""
    # An invalid input has no output.
    is_valid = done.code in (0, 3)
    outputs = {
        f"case/{path}"
        for option, path in zip(command, command[1:])
        if option in OUTPUT_OPTIONS and is_valid
    }
    inputs = {f"case/{path}": data for path, data in files.items()}
    known = {*FOLDERS, *inputs, *(str(parent) for path in inputs for parent in Path(path).parents)}
    found = {path.relative_to(root).as_posix() for path in root.rglob("*")}
    left = [
        path
        for path in sorted(found - known)
        if not any(path == output or path.startswith(f"{output}/") for output in outputs)
    ]
    changed = [
        path
        for path, data in inputs.items()
        if path not in found or (root / path).read_bytes() != data
    ]
    violations = [f"files left behind: {', '.join(left)}"] if left else []
    return violations + ([f"input files changed: {', '.join(changed)}"] if changed else [])


def run(command: list[str], files: dict[str, bytes], seconds: float = KILLED_AFTER_S) -> Run:
    """Runs a command once in a temporary folder with these files. `<` redirects its input."""
    with tempfile.TemporaryDirectory(prefix="mutation-") as name:
        root = Path(name)
        for folder in FOLDERS:
            (root / folder).mkdir()
        write(root / "case", files)
        done = execute(command, root, seconds)
        lines = done.message.strip().splitlines() or [""]
        if done.code not in CODES:
            done.violations.append(f"exit code {done.code} {lines[-1][:200]}".rstrip())
        panics = [line for line in lines if "panicked" in line]
        if panics:
            done.violations.append(f"panic: {panics[0][:200]}")
        if done.cpu_s > MOST_CPU_S:
            done.violations.append(f"{done.cpu_s:.2f} s of processor time")
        if done.memory_mb > MOST_MB:
            done.violations.append(f"{done.memory_mb:.0f} MB resident")
        done.violations += leftovers(done, command, files, root)
    return done


def command_line(binary: str, text: str, seed: Seed) -> list[str]:
    return [binary, *text.format(application=seed.application).split()]


@dataclass(frozen=True)
class Case:
    """A damaged file, with the command that reads it."""

    kind: Kind
    number: int
    command: list[str]
    files: dict[str, bytes]
    operators: list[str]


def case(binary: str, kind: Kind, number: int) -> Case:
    rng = Random(f"{kind.name} {number}")
    seed = rng.choice(kind.seeds)
    command = command_line(binary, rng.choice(kind.commands), seed)
    others = [*(other.data for other in kind.seeds), *kind.donors]
    data, operators = mutated(rng, seed.data, others, kind.is_binary)
    return Case(kind, number, command, {**seed.beside, seed.path: data}, operators)


def checked(case: Case) -> Run:
    done = run(case.command, case.files)
    if done.cpu_s > MOST_CPU_S:
        # The machine may be shared: the smaller of two times counts.
        again = run(case.command, case.files)
        done = min(done, again, key=lambda run: run.cpu_s)
    return done


def keep(case: Case, done: Run, folder: Path) -> str:
    """Keeps the files of a case, and describes it."""
    target = folder / f"{case.kind.name}-{case.number}"
    shutil.rmtree(target, ignore_errors=True)
    write(target, case.files)
    command = " ".join("<" if word == "<" else shlex.quote(word) for word in case.command)
    return (
        f"{case.kind.name}, seed {case.number}: {'; '.join(done.violations)}\n"
        f"    after {', '.join(case.operators)}\n    (cd {target} && {command})"
    )


def accepts_undamaged(binary: str, kinds: list[Kind]) -> bool:
    """Runs each undamaged file with each command. Cases of refused files would test little."""
    is_good = True
    for kind in kinds:
        for text in kind.commands:
            for index, seed in enumerate(kind.seeds):
                command = command_line(binary, text, seed)
                done = run(command, {**seed.beside, seed.path: seed.data})
                if done.code not in (0, 3) or done.violations:
                    is_good = False
                    print(f"{kind.name}, undamaged file {index}: exit code {done.code} of {text}")
                    print("   ", *done.violations, done.message)
    return is_good


def examine(kind: Kind, options: argparse.Namespace) -> tuple[list[str], int]:
    """Runs all cases of a kind; returns its row of the table and the number of violations."""
    codes: Counter[int] = Counter()
    cpu_s = memory_mb = 0.0
    count = 0

    def examined(number: int) -> tuple[Case, Run]:
        made = case(options.binary, kind, number)
        return made, checked(made)

    with ThreadPoolExecutor(options.jobs) as pool:
        for made, done in pool.map(examined, range(options.seed, options.seed + options.count)):
            codes[done.code] += 1
            cpu_s = max(cpu_s, done.cpu_s)
            memory_mb = max(memory_mb, done.memory_mb)
            if done.violations:
                count += 1
                if count <= MOST_KEPT:
                    print(keep(made, done, options.keep), flush=True)
    others = " ".join(f"{code}:{codes[code]}" for code in sorted(codes) if code not in CODES)
    row = [kind.name, str(options.count), *(str(codes[code]) for code in CODES), others or "-"]
    return [*row, f"{cpu_s:.2f}", f"{memory_mb:.0f}", str(count)], count


def table(rows: list[list[str]]) -> str:
    widths = [max(map(len, column)) for column in zip(*rows)]
    return "\n".join(
        "| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |"
        for row in rows
    )


def self_test() -> None:
    """Checks that each fault of a program is found, and that a good program has none."""
    stubs = {
        "": "print('all well')",
        "still running": "import time; time.sleep(20)",
        "s of processor time": "import time\nwhile time.process_time() < 1.5: pass",
        "MB resident": "x = b'x' * (450 << 20)",
        "exit code 101": "import sys; sys.exit(101)",
        "exit code -6": "import os; os.abort()",
        "panic": "import sys; sys.stderr.write('thread main panicked at a.rs:1'); sys.exit(1)",
        "left behind: case/part": "open('part', 'w')",
        "left behind: case/out": "open('out', 'w'); import sys; sys.exit(2)",
        "left behind: home/.x": "import os; os.mkdir(os.environ['HOME'] + '/.x')",
        "left behind: tmp/x": "import os; open(os.environ['TMPDIR'] + '/x', 'w')",
        "files changed: case/input": "open('input', 'a').write('x')",
        "files changed: case/input ": "import os; os.remove('input')",
    }
    for expected, code in stubs.items():
        command = [sys.executable, "-c", code, "-o", "out", "<", "input"]
        seconds = 2.0 if "sleep" in code else KILLED_AFTER_S
        found = run(command, {"input": b"text"}, seconds).violations
        is_found = any(expected.strip() in each for each in found) if expected else not found
        print(f"{'found' if is_found else 'NOT FOUND'}: {expected or 'nothing'} {found}")
        if not is_found:
            sys.exit(1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("binary", nargs="?")
    parser.add_argument("--count", type=int, default=100, help="cases of each kind")
    parser.add_argument("--kind", action="append", help="may be given more than once")
    parser.add_argument("--seed", type=int, default=1, help="seed of the first case")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="cases at a time")
    parser.add_argument("--keep", type=Path, default=ROOT / "target/mutations")
    parser.add_argument("--self-test", action="store_true")
    options = parser.parse_args()
    if options.self_test:
        self_test()
        return
    if options.binary is None:
        parser.error("the program to test is missing")
    options.binary = str(Path(options.binary).resolve())
    kinds = all_kinds(options.binary)
    names = [kind.name for kind in kinds]
    for name in options.kind or []:
        if name not in names:
            parser.error(f"unknown kind {name}: use one of {', '.join(names)}")
    kinds = [kind for kind in kinds if not options.kind or kind.name in options.kind]
    is_good = accepts_undamaged(options.binary, kinds)
    head = ["kind", "runs", *(f"exit {code}" for code in CODES), "other", "CPU s", "MB"]
    rows = [[*head, "violations"], ["---"] * (len(head) + 1)]
    total = 0
    for kind in kinds:
        row, count = examine(kind, options)
        rows.append(row)
        total += count
    print(table(rows))
    runs = options.count * len(kinds)
    print(f"Mutations: {len(kinds)} kinds, {runs} runs, {total} violations")
    if total or not is_good:
        sys.exit(1)


if __name__ == "__main__":
    main()
