"""Draws the dependency graph of the crates, from Cargo metadata.

    tests/arrows.py            compares the graphs in ARCHITECTURE.md and README.md
    tests/arrows.py --renew    writes the graphs

An arrow points from a crate to a crate that uses it. Transitive dependencies are not drawn.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
COMMAND = "iiwasim"
# The crate that uses all others.
FACADE = "iiwa"


def crates() -> tuple[dict[str, str], dict[str, set[str]]]:
    """The folder and the dependencies of each crate."""
    command = [
        "cargo",
        "metadata",
        "--no-deps",
        "--locked",
        "--format-version",
        "1",
        "--manifest-path",
        ROOT / "Cargo.toml",
    ]
    packages = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)[
        "packages"
    ]
    folders = {}
    for package in packages:
        path = Path(package["manifest_path"]).parent.relative_to(ROOT)
        if path.parts[0] in ("crates", "cli"):
            folders[package["name"]] = path.parts[1] if path.parts[0] == "crates" else "cli"
    uses = {
        package["name"]: {
            dependency["name"]
            for dependency in package["dependencies"]
            if dependency["kind"] is None and dependency["name"] in folders
        }
        for package in packages
        if package["name"] in folders
    }
    return folders, uses


def reached(uses: dict[str, set[str]], start: str) -> set[str]:
    """All transitive dependencies of a crate."""
    found: set[str] = set()
    open_ = list(uses[start])
    while open_:
        name = open_.pop()
        if name not in found:
            found.add(name)
            open_ += uses[name]
    return found


def short(name: str) -> str:
    return name.removeprefix("iiwa-")


def diagram(folders: dict[str, str], uses: dict[str, set[str]]) -> str:
    """A Mermaid diagram, with one box per folder."""
    lines = ["```mermaid", "flowchart LR"]
    for folder in sorted(set(folders.values()) - {"cli"}):
        names = sorted(
            short(name) for name in folders if folders[name] == folder and name != FACADE
        )
        lines.append(f"  subgraph {folder}_[crates/{folder}]\n    {'; '.join(names)}\n  end")
    for name in sorted(folders):
        if name == FACADE:
            continue
        implied = set().union(*(reached(uses, other) for other in uses[name]))
        lines += [f"  {short(other)} --> {short(name)}" for other in sorted(uses[name] - implied)]
    return "\n".join([*lines, "```"])


def folder_list(folders: dict[str, str]) -> str:
    """The crates of each folder."""
    lines = []
    for folder in sorted(set(folders.values()) - {"cli"}):
        names = ", ".join(f"`{name}`" for name in sorted(folders) if folders[name] == folder)
        line = f"- `crates/{folder}`: {names}"
        lines += textwrap.wrap(
            line, 100, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False
        )
    return "\n".join(lines)


def main() -> None:
    folders, uses = crates()
    wrong = []
    for file, mark, text in [
        ("ARCHITECTURE.md", "arrows", diagram(folders, uses)),
        ("README.md", "crates", folder_list(folders)),
    ]:
        path = ROOT / file
        old = path.read_text()
        block = f"<!-- {mark}: made by tests/arrows.py -->\n{text}\n<!-- end -->"
        new = re.sub(
            rf"<!-- {mark}:.*?<!-- end -->", lambda _, block=block: block, old, flags=re.DOTALL
        )
        if block not in new:
            sys.exit(f"{file} has no place for its {mark}")
        if new != old:
            wrong.append(file)
            if "--renew" in sys.argv:
                path.write_text(new)
    if wrong and "--renew" not in sys.argv:
        sys.exit(
            f"{' and '.join(wrong)}: the crates or their arrows have changed; tests/arrows.py "
            "--renew draws them"
        )
    print("The arrows are as drawn.")


if __name__ == "__main__":
    main()
