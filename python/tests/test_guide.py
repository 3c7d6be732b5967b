"""The Python examples of the guide and of README run in order and print the outputs shown there.

A ```text fence after a ```python fence is the expected output, with `...` for any text.
`python tests/test_guide.py` writes the actual outputs into the guide.
"""

from __future__ import annotations

import contextlib
import doctest
import importlib.util
import inspect
import io
import os
import re
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import pytest

import iiwasim

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import ModuleType

    from simulated_robot import SimulatedRobot

ROOT = Path(__file__).resolve().parents[2]
GUIDE = ROOT / "docs/guide/python.md"
README = ROOT / "README.md"

# Classes whose methods and attributes are in the guide, too.
DESCRIBED = {
    "Comparison",
    "Drive",
    "Identification",
    "Plan",
    "Program",
    "Recording",
    "Robot",
    "Samples",
    "Scene",
}


class Example(NamedTuple):
    """A fenced Python example."""

    line: int
    code: str
    expected: str
    """The output shown on the page."""
    text_line: int | None
    """Line of the output fence."""
    is_run: bool


def checker() -> ModuleType:
    """The module that runs the commands of the guide and reads its pages."""
    spec = importlib.util.spec_from_file_location("guide_check", ROOT / "tests/guide/check.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    # Its dataclasses look up their module in `sys.modules`.
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, spec.name, module)
        patch.syspath_prepend(str(ROOT / "tests/guide"))
        spec.loader.exec_module(module)
    return module


def examples(path: Path) -> list[Example]:
    """The Python examples of a page."""
    page = checker().read_page(path)
    assert not page.problems, "\n".join(page.problems)
    found = []
    for fence, after in zip(page.fences, [*page.fences[1:], None]):
        # `tests/cluster` runs the cluster examples.
        if fence.language == "python" and "import iiwasim.ray" not in fence.text:
            # Two lines below the end.
            below = fence.line + fence.text.count("\n") + 4
            shows = after is not None and after.language == "text" and after.line == below
            expected, at = (
                (f"{after.text}\n" if after.text else "", after.line) if shows else ("", None)
            )
            found.append(
                Example(fence.line, fence.text, expected, at, "not run" not in fence.marks)
            )
    return found


def outputs(path: Path, *, with_drive: bool = False) -> Iterator[tuple[Example, str]]:
    """Runs the examples of a page as one program, and yields the output of each example.

    Examples that need a drive run only with `with_drive`.
    """
    names: dict[str, Any] = {"__name__": "__main__"}
    for example in examples(path):
        code = compile("\n" * example.line + example.code, str(path), "exec")
        if example.is_run or with_drive:
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(code, names)  # noqa: S102 The page is ours.
            lines = [line.rstrip() for line in printed.getvalue().strip("\n").split("\n")]
            yield example, "\n".join(lines) + "\n" if any(lines) else ""


def check(path: Path) -> int:
    """Compares the outputs of the examples of a page; returns the number of examples."""
    count = 0
    for example, printed in outputs(path):
        count += 1
        if not doctest.OutputChecker().check_output(example.expected, printed, doctest.ELLIPSIS):
            pytest.fail(
                f"{path.relative_to(ROOT)}:{example.line} prints\n{printed}\nbut "
                f"shows\n{example.expected}"
            )
    return count


@pytest.fixture
def beside_fixtures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Changes to a folder with `fixtures` in it, like the commands of the guide."""
    (tmp_path / "fixtures").symlink_to(ROOT / "fixtures")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")


@pytest.mark.usefixtures("beside_fixtures")
def test_readme() -> None:
    assert check(README) == 1


@pytest.mark.usefixtures("beside_fixtures")
def test_guide() -> None:
    for needed in ("pandas", "polars"):
        pytest.importorskip(needed)
    pyplot = pytest.importorskip("matplotlib.pyplot")
    try:
        assert check(GUIDE) > 15
    finally:
        pyplot.close("all")


@pytest.mark.usefixtures("beside_fixtures")
def test_guide_with_drive(robot: SimulatedRobot, monkeypatch: pytest.MonkeyPatch) -> None:
    for needed in ("pandas", "polars", "matplotlib"):
        pytest.importorskip(needed)
    monkeypatch.setenv("IIWASIM_DRIVE", robot.address)
    monkeypatch.setenv("IIWASIM_STREAM", robot.stream)
    printed = [text for example, text in outputs(GUIDE, with_drive=True) if not example.is_run]
    assert len(printed) == 3
    # The comparison of the run, and positions as they arrive.
    assert "Cycle time" in printed[0]
    assert len(printed[1].split()) > 100 and printed[2].count("\n") > 100


def public_names() -> list[str]:
    """Public names of the package; the guide has an example of each."""
    found = [name for name in iiwasim.__all__ if name != "Motion"]
    for owner in DESCRIBED:
        members = inspect.getmembers_static(getattr(iiwasim, owner))
        found += [f"{owner}.{name}" for name, _ in members if not name.startswith("_")]
    return found


@cache
def guide_of(kind: str) -> str:
    """The examples of the guide, or its whole text."""
    return (
        "\n".join(example.code for example in examples(GUIDE))
        if kind == "code"
        else GUIDE.read_text(encoding="utf-8")
    )


@pytest.mark.parametrize("name", public_names())
def test_guide_has(name: str) -> None:
    word = name.rpartition(".")[2]
    # A class may also appear as a return type or exception.
    is_class = inspect.isclass(getattr(iiwasim, name, None))
    where = guide_of("text" if is_class else "code")
    assert re.search(rf"\b{word}\b", where), (
        f"{GUIDE.name} has no {'word on' if is_class else 'example of'} {name}"
    )


def renew(path: Path) -> None:
    """Writes the outputs of the examples into a page."""
    lines = path.read_text(encoding="utf-8").split("\n")
    for example, printed in reversed(list(outputs(path))):
        if "..." in example.expected or example.text_line is None:
            continue
        begin = example.text_line
        end = begin + lines[begin:].index("```")
        lines[begin:end] = printed.rstrip("\n").split("\n") if printed else []
    path.write_text("\n".join(lines), encoding="utf-8")


if __name__ == "__main__":
    os.environ["MPLBACKEND"] = "agg"
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        Path("fixtures").symlink_to(ROOT / "fixtures")
        renew(GUIDE)
