"""Compares the licences and sources of all dependencies with .deny.toml.

`cargo deny check` reads the same file, but would have to be compiled first.
"""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

from license_expression import get_spdx_licensing

ROOT = Path(__file__).parent.parent
SPDX = get_spdx_licensing()


def dependencies(target: str) -> set[tuple[str, str]]:
    """Names with version and source, and licences, of all packages for a target."""
    command = ["cargo", "tree", "--locked", "--workspace", "--all-features", "--target", target]
    command += ["--prefix", "none", "--format", "{p}|{l}"]
    lines = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    lines = (line.removesuffix(" (*)") for line in lines.splitlines())
    return {tuple(line.rsplit("|", 1)) for line in lines if line}


def is_allowed(expression: str, allowed: set[str]) -> bool:
    """True if one of the choices of an SPDX expression needs allowed licences only."""
    # Before SPDX, a slash meant OR.
    parsed = SPDX.parse(expression.replace("/", " OR "), validate=True)
    symbols = SPDX.license_symbols(parsed, decompose=False)
    values = {symbol: SPDX.TRUE if str(symbol) in allowed else SPDX.FALSE for symbol in symbols}
    return parsed.subs(values).simplify() == SPDX.TRUE


def fault(package: str, licence: str, allowed: set[str], exceptions: dict[str, set[str]]) -> str:
    """The fault of a dependency; empty without one."""
    name, _version, *source = package.removesuffix(" (proc-macro)").split(" ", 2)
    # Packages of the registry have no source here, and ours have their folder.
    if source and not source[0].startswith(f"({ROOT}"):
        return f"{package} is not from the registry"
    if not licence:
        return f"{package} names no licence"
    if not is_allowed(licence, allowed | exceptions.get(name, set())):
        return f"{package} is licensed as {licence}, which .deny.toml does not allow"
    return ""


def main() -> int:
    """Prints the faults, or the number of packages."""
    rules = tomllib.loads((ROOT / ".deny.toml").read_text())
    allowed = set(rules["licenses"]["allow"])
    exceptions = {rule["crate"]: set(rule["allow"]) for rule in rules["licenses"]["exceptions"]}
    packages = set()
    for target in rules["graph"]["targets"]:
        packages |= dependencies(target)
    faults = [fault(*package, allowed, exceptions) for package in sorted(packages)]
    print("\n".join(filter(None, faults)) or f"{len(packages)} packages have allowed licences")
    return 1 if any(faults) else 0


if __name__ == "__main__":
    sys.exit(main())
