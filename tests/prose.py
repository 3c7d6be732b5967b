"""Counts habits of language that make texts hard to read, long lines, and ambiguous type names.

    tests/prose.py                   counts, compared with tests/prose.json: fails if one has risen
    tests/prose.py --places HABIT    each place, as FILE:LINE: text
    tests/prose.py --renew           writes the counts of now

Rust, Java and JavaScript are searched in their comments, Python in comments and docstrings,
Markdown outside of code blocks. A type name is ambiguous if several crates define it with different
meanings.
"""

from __future__ import annotations

import io
import json
import re
import subprocess
import sys
import tokenize
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BASELINE = ROOT / "tests/prose.json"
MOST_COLUMNS = 100
C_LIKE = {".rs", ".java", ".js"}
# What a habit looks like. The first is searched at the start of documentation lines, all others
# anywhere.
HABITS = {
    "clause in place of a noun": re.compile(r"^(What|How|Whether|Where|Who|Which)\b"),
    "negated noun": re.compile(
        r"\b(is|are|was|were) no (?!longer|more\b)|\bthere (is|are) none\b", re.IGNORECASE
    ),
    "household verb": re.compile(r"\b(stands|comes|goes|lies|hangs)\b(?! from)"),
    "genitive in place of a compound": re.compile(
        r"\b(limits|speeds?|paths?|poses?|blends?|frames?) of "
        r"(the TCP|torques?|velocity|acceleration|jerk)\b"
        r"|\b(messages|topics) of (the|a) (bridge|drive|link)\b|\bnames? of (the )?topics?\b"
    ),
    "ellipsis": re.compile(r"^(That|Those|The same) (of|for)\b|\b\w+s a (second|minute)\b"),
}
LONG = "line above 100 columns"
# A row of a Markdown table in the documentation of Rust, or in a docstring of Python.
TABLE_ROW = re.compile(r"\s*(?://[/!] )?\|.*\|$")
AMBIGUOUS = "type name of several crates"
# Type names that several crates may define, by reason, with these crates.
SAME_MEANING = {
    "ROS messages are named as in ROS": {
        "Header": "bridge log ros2",
        "JointState": "bridge log ros2",
        "JointTrajectory": "log ros2",
        "JointTrajectoryPoint": "log ros2",
        "Text": "log ros2",
        "Time": "bridge log ros2",
        "TransformStamped": "log ros2",
    },
    "Argument structs are named after their command or option": {
        "Bridge": "bridge cli",
        "BrokerAccess": "bridge cli",
        "Cabinet": "cabinet cli",
        "Drive": "cli drive",
        "History": "bridge cli",
        "Import": "cli sunrise",
        "Kafka": "bridge cli",
        "Mqtt": "bridge cli",
        "OpcUa": "cli opcua",
        "Plan": "cli plan",
        "RetimeGoals": "cli ros2",
        "Robot": "cli kin",
        "Ros2": "cli ros2",
        "Run": "cli link",
        "Sensors": "cli link",
        "Status": "cli kin",
        "Timing": "cli traj",
        "Twin": "cli twin",
    },
    "Python wrappers are named after the type that they wrap": {
        "Clearance": "python scene",
        "Comparison": "eval python",
        "Optimum": "optimise python",
        "PlaceMap": "optimise python",
        "Plan": "plan python",
        "Program": "program python",
        "Recording": "log python",
        "Robot": "kin python",
        "Scene": "python scene",
    },
    "The Python package has the type of the command line, and shares no crate with it": {
        "Workplace": "cli python",
    },
}
TYPE = re.compile(
    r"^\s*(?:pub(?:\([^)]*\))? )?(?:unsafe )?(?:struct|enum|trait) (\w+)"
    # Indented aliases are associated types, or local.
    r"|^(?:pub(?:\([^)]*\))? )?type (\w+)"
)
# Folders of crates, without the prefix of crate names; tests are not searched.
CRATE = re.compile(r"(?:crates/\w+/iiwa-|(?=cli/|python/))(\w+)/src/(?!.*tests[/.])")


def c_like(text: str) -> Iterator[tuple[int, str, bool]]:
    """Comments with their lines, and whether they are documentation."""
    is_block = False
    for number, line in enumerate(text.splitlines(), 1):
        stripped = line.strip()
        if is_block or stripped.startswith("/*"):
            yield number, stripped.lstrip("/*! ").removesuffix("*/").strip(), True
            is_block = "*/" not in stripped
        elif match := re.match(r"//([/!]?) ?(.*)", stripped):
            yield number, match[2].strip(), bool(match[1])
        elif match := re.search(r"[;{},)] +// (.*)$", line):
            yield number, match[1], False


def python(text: str) -> Iterator[tuple[int, str, bool]]:
    before = tokenize.INDENT
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        is_docstring = token.type == tokenize.STRING and before in (
            tokenize.INDENT,
            tokenize.NEWLINE,
            tokenize.ENCODING,
        )
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string.lstrip("# "), False
        elif is_docstring or (token.type == tokenize.STRING and token.start == (1, 0)):
            for offset, line in enumerate(token.string.splitlines()):
                yield token.start[0] + offset, line.strip().strip('"').strip(), offset == 0
        if token.type not in (tokenize.NL, tokenize.COMMENT):
            before = token.type


def markdown(text: str) -> Iterator[tuple[int, str, bool]]:
    is_code = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            is_code = not is_code
        elif not is_code:
            yield number, re.sub(r"`[^`]*`", "`x`", line.strip()), False


def places() -> Iterator[tuple[str, str, int, str]]:
    """Each habit with its file, line and text."""
    listed = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True
    ).stdout.splitlines()
    yield from ambiguous(listed)
    for name in listed:
        path = ROOT / name
        suffix = path.suffix
        if (
            suffix not in {*C_LIKE, ".py", ".md"}
            or path.is_symlink()
            or name.startswith(("fixtures/", "tests/fuzz/seeds/"))
        ):
            continue
        text = path.read_text()
        read = c_like if suffix in C_LIKE else python if suffix == ".py" else markdown
        for number, prose, is_documentation in read(text):
            for habit, pattern in HABITS.items():
                if habit == "clause in place of a noun" and not is_documentation:
                    continue
                if pattern.search(prose):
                    yield habit, name, number, prose
        is_code = False
        for number, line in enumerate(text.splitlines(), 1):
            if suffix == ".md" and line.lstrip().startswith("```"):
                is_code = not is_code
            # Tables and links cannot be wrapped, nor code and comments for checkers in documents.
            is_fixed = (
                "://" in line
                or TABLE_ROW.match(line)
                or (suffix == ".md" and (is_code or "|" in line or "](" in line or "<!-- " in line))
            )
            if len(line) > MOST_COLUMNS and not is_fixed:
                yield LONG, name, number, line


def ambiguous(files: list[str]) -> Iterator[tuple[str, str, int, str]]:
    """Type names that more than one crate defines; each name is one place, its first definition."""
    crates: dict[str, set[str]] = {}
    first: dict[str, tuple[str, int]] = {}
    for name in files:
        crate = CRATE.match(name)
        if not crate or not name.endswith(".rs"):
            continue
        code = re.split(r"#\[cfg\(test\)\]\s+mod \w+ \{", (ROOT / name).read_text())[0]
        for number, line in enumerate(code.splitlines(), 1):
            if match := TYPE.match(line):
                type_name = match[1] or match[2]
                crates.setdefault(type_name, set()).add(crate[1])
                first.setdefault(type_name, (name, number))
    for type_name, found in crates.items():
        same = {
            crate for names in SAME_MEANING.values() for crate in names.get(type_name, "").split()
        }
        # Crates of one meaning count as one crate.
        if len(found - same) + bool(found & same) > 1:
            yield AMBIGUOUS, *first[type_name], f"{type_name}: {', '.join(sorted(found))}"


def main() -> None:
    found = list(places())
    if "--places" in sys.argv:
        wanted = sys.argv[sys.argv.index("--places") + 1]
        for habit, name, number, text in found:
            if habit == wanted:
                print(f"{name}:{number}: {text}")
        return
    counts = Counter(habit for habit, *_ in found)
    counts = {habit: counts[habit] for habit in (*HABITS, LONG, AMBIGUOUS)}
    if "--renew" in sys.argv:
        BASELINE.write_text(json.dumps(counts, indent=2) + "\n")
    baseline = json.loads(BASELINE.read_text())
    risen = []
    for habit, count in counts.items():
        print(f"{count:7}  {habit}, {baseline[habit]} at most")
        if count > baseline[habit]:
            risen.append(habit)
    if risen:
        print(
            f"tests/prose.py --places '{risen[0]}' lists them; CONTRIBUTING.md says what to write "
            "instead"
        )
    sys.exit(bool(risen))


if __name__ == "__main__":
    main()
