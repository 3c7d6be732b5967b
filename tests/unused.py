"""Finds dependencies that no source file of their package names, in all workspaces.

A package lists dependencies that it needs only for their features in `ignored` of
`[package.metadata.unused]`; `*` means all.
"""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).parent.parent
WORKSPACES = [".", "tests/fuzz"]


def metadata(workspace: str) -> dict:
    """Cargo metadata of a workspace and its dependencies."""
    manifest = ROOT / workspace / "Cargo.toml"
    command = [
        "cargo",
        "metadata",
        "--locked",
        "--all-features",
        "--format-version",
        "1",
        "--manifest-path",
        manifest,
    ]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def sources(pattern: str, folder: Path = ROOT) -> list[Path]:
    """Files that git tracks or would track.

    Builds may run at the same time: files in their folders appear and disappear during a walk.
    """
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", "--", pattern]
    names = subprocess.run(command, cwd=folder, check=True, stdout=subprocess.PIPE, text=True)
    files = (folder / name for name in names.stdout.split("\0") if name)
    return [file for file in files if file.exists()]


def code(folder: Path, others: set[Path]) -> str:
    """The Rust code of a package, without comments and without packages in its subfolders."""
    lines = []
    for file in sources("*.rs", folder):
        if not others.intersection(file.parents):
            lines += [line.split("//")[0] for line in file.read_text().splitlines()]
    return "\n".join(lines)


def unused(workspace: str) -> list[str]:
    found = metadata(workspace)
    libraries = {
        package["name"]: target["name"].replace("-", "_")
        for package in found["packages"]
        for target in package["targets"]
        if {"lib", "proc-macro", "rlib", "dylib", "cdylib"}.intersection(target["kind"])
    }
    members = [
        package for package in found["packages"] if package["id"] in found["workspace_members"]
    ]
    folders = {file.parent for file in sources("*Cargo.toml")}
    lines = []
    for package in members:
        folder = Path(package["manifest_path"]).parent
        text = code(folder, {other for other in folders if folder in other.parents})
        ignored = set(((package["metadata"] or {}).get("unused") or {}).get("ignored", []))
        for dependency in package["dependencies"]:
            name = dependency["name"]
            known_as = (dependency["rename"] or libraries.get(name, name)).replace("-", "_")
            if not ignored & {name, "*"} and not re.search(rf"\b{known_as}\b", text):
                lines.append(f"{folder.relative_to(ROOT)}: nothing uses {name}")
    return lines


def main() -> None:
    lines = [line for workspace in WORKSPACES for line in unused(workspace)]
    print("\n".join(lines) or "Each dependency is used.")
    raise SystemExit(bool(lines))


if __name__ == "__main__":
    main()
