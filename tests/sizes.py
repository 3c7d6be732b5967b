"""Prints the lines of Rust of each crate, and the longest files: a report without limits.

Tests are counted separately: files in folders called tests, and files with names ending in
tests.rs.
"""

from __future__ import annotations

import subprocess
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LONGEST = 8


def is_test(path: Path) -> bool:
    return "tests" in path.parts[:-1] or path.name.endswith("tests.rs")


def main() -> None:
    listed = subprocess.run(
        ["git", "ls-files", "*.rs"], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True
    ).stdout
    lines = {
        Path(name): len((ROOT / name).read_text().splitlines()) for name in listed.splitlines()
    }
    product, tests = Counter(), Counter()
    for path, count in lines.items():
        place = path.parts[2] if path.parts[0] == "crates" else path.parts[0]
        (tests if is_test(path) else product)[place] += count
    print(f"Rust: {product.total()} lines, and {tests.total()} of tests")
    for place in sorted(product | tests):
        print(f"{product[place]:8} {tests[place]:8}  {place}")
    print("The longest files:")
    for path in sorted(lines, key=lambda path: -lines[path])[:LONGEST]:
        print(f"{lines[path]:8}  {path}")


if __name__ == "__main__":
    main()
