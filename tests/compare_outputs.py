#!/usr/bin/env python3
"""Compare the outputs of two builds of iiwasim for the programs in fixtures/.

    compare_outputs.py OLD_BINARY NEW_BINARY

Both binaries plan every program (with both timings), draw its picture, make its report and compare
the two plans; do all experiments on a virtual robot, and identify it. One line per file says
`equal` or lists the differences. MCAP files are compared by their messages, metadata and
attachments. Differences in EXPECTED are marked as expected. Exits with 1 on any other difference.

Needs the Python package `mcap` (tests/requirements.txt).
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from mcap.reader import make_reader

FIXTURES = Path(__file__).resolve().parent.parent / "fixtures"

# Intended differences of a change: (kind of file, difference).
EXPECTED = {
    ("mcap", "attachment robot.json is new"),
    ("mcap", "metadata iiwasim.samples is gone"),
    ("mcap", "metadata iiwasim.sample_count is new"),
}


def programs():
    """Programs in the fixtures: objects with motions."""
    for path in sorted(FIXTURES.glob("*.json")):
        content = json.loads(path.read_text())
        if isinstance(content, dict) and "motions" in content:
            yield path


def run(binary, folder, *arguments):
    """Standard output and error, and the exit code, of a command in a folder."""
    done = subprocess.run(
        [binary, *map(str, arguments)],
        cwd=folder,
        capture_output=True,
        check=False,
        text=True,
        timeout=3600,
    )
    return {"stdout": done.stdout, "stderr": done.stderr, "exit code": done.returncode}


def make(binary, folder):
    """Runs every command in a folder, and returns the printed texts."""
    texts = {}
    for program in programs():
        name = program.stem
        for timing in ("jerk", "acceleration"):
            label = f"{name}-{timing}"
            common = (program, "--timing", timing)
            texts[f"{label}.txt"] = run(binary, folder, "plan", *common, "--no-output")
            texts[f"{label}.json"] = run(
                binary,
                folder,
                "plan",
                *common,
                "--json",
                "-o",
                f"{label}.mcap",
                "--picture",
                f"{label}.svg",
            )
            texts[f"{label}-report"] = run(
                binary, folder, "report", f"{label}.mcap", "-o", f"{label}.html"
            )
        plan, other = f"{name}-jerk.mcap", f"{name}-acceleration.mcap"
        texts[f"{name}-compare"] = run(
            binary, folder, "compare", plan, other, "--json", "--picture", f"{name}-compare.svg"
        )
        texts[f"{name}-report-both"] = run(
            binary, folder, "report", plan, other, "-o", f"{name}-both.html"
        )
        scene = ("--scene", FIXTURES / "cage.json")
        texts[f"{name}-scene"] = run(binary, folder, "plan", program, *scene, "--no-output")
    texts["many"] = run(binary, folder, "plan", FIXTURES, "--no-output")
    texts["robot"] = run(binary, folder, "robot", "lbr_iiwa_14_r820")
    recorder = (FIXTURES / "data-recorder.log", "-o", "data-recorder.html")
    texts["data-recorder-report"] = run(binary, folder, "report", *recorder)
    experiment = ("all", "--simulate", "--count", "2", "-o", "experiment")
    texts["experiment"] = run(binary, folder, "experiment", *experiment)
    recordings = sorted((folder / "experiment" / "recordings").glob("*.mcap"))
    recordings = [path.relative_to(folder) for path in recordings]
    for option in ((), ("--json",)):
        texts[" ".join(("identify", *option))] = run(
            binary, folder, "identify", *recordings, "-o", "identified.json", *option
        )
    for recording in recordings[:3]:
        page = f"{recording.stem}.html"
        texts[f"report of {recording}"] = run(binary, folder, "report", recording, "-o", page)
    return texts


def mcap_content(path):
    """Messages, metadata and attachments of an MCAP file."""
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        messages = [
            (channel.topic, message.log_time, message.publish_time, message.sequence, message.data)
            for _, channel, message in reader.iter_messages(log_time_order=False)
        ]
        metadata = {}
        for record in reader.iter_metadata():
            for key, value in record.metadata.items():
                metadata[f"{record.name}.{key}"] = value
        attachments = {
            record.name: (record.media_type, record.data) for record in reader.iter_attachments()
        }
    return messages, metadata, attachments


def entries(what, old, new):
    """Differences of two dictionaries."""
    for key in sorted(old.keys() | new.keys()):
        if key not in new:
            yield f"{what} {key} is gone"
        elif key not in old:
            yield f"{what} {key} is new"
        elif old[key] != new[key]:
            yield f"{what} {key} differs"


def mcap_differences(old, new):
    old, new = mcap_content(old), mcap_content(new)
    if len(old[0]) != len(new[0]):
        yield f"{len(old[0])} messages became {len(new[0])}"
    else:
        first = next((i for i, pair in enumerate(zip(old[0], new[0])) if pair[0] != pair[1]), None)
        if first is not None:
            yield f"message {first} on {old[0][first][0]} differs"
    yield from entries("metadata", old[1], new[1])
    yield from entries("attachment", old[2], new[2])


def differences(kind, old, new):
    if kind == "mcap":
        return list(mcap_differences(old, new))
    old, new = old.read_bytes(), new.read_bytes()
    if old == new:
        return []
    at = next((i for i, pair in enumerate(zip(old, new)) if pair[0] != pair[1]), None)
    if at is None:
        return [f"{len(old)} bytes became {len(new)}"]
    near = slice(max(0, at - 30), at + 30)
    return [f"byte {at}: {old[near]!r} became {new[near]!r}"]


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    binaries = [str(Path(binary).resolve()) for binary in sys.argv[1:]]
    unexpected = 0

    def tell(name, found):
        nonlocal unexpected
        kind = name.rsplit(".", 1)[-1]
        others = [what for what in found if (kind, what) not in EXPECTED]
        unexpected += len(others)
        told = others + [f"{what} (expected)" for what in found if what not in others]
        print(f"{name}: {'; '.join(told) or 'equal'}")

    with tempfile.TemporaryDirectory() as old, tempfile.TemporaryDirectory() as new:
        folders = [Path(old), Path(new)]
        texts = [make(binary, folder) for binary, folder in zip(binaries, folders)]
        for name, before in texts[0].items():
            tell(f"output of {name}", list(entries("", before, texts[1][name])))
        names = [
            {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
            for folder in folders
        ]
        for name in sorted(names[0] | names[1]):
            if name not in names[1]:
                tell(name, ["is missing"])
            elif name not in names[0]:
                tell(name, ["is new"])
            else:
                kind = name.rsplit(".", 1)[-1]
                tell(name, differences(kind, *(folder / name for folder in folders)))
    print(f"{unexpected} unexpected differences")
    sys.exit(1 if unexpected else 0)


if __name__ == "__main__":
    main()
