"""Every public name has a docstring with an example, and the example runs."""

from __future__ import annotations

import doctest
import inspect
from pathlib import Path

import pytest

import iiwasim

ROOT = Path(__file__).resolve().parents[2]

OPTIONS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE

# Their examples need a drive: `test_drive.py` runs them.
OF_THE_DRIVE = ("Drive", "Run", "JointSample")


def members(owner: type) -> list[tuple[str, object]]:
    """Public members of a class, including members of base classes in this package."""
    own = [base for base in owner.__mro__ if base.__module__.partition(".")[0] == "iiwasim"]
    found: dict[str, object] = {}
    for base in reversed(own):
        found.update(vars(base))
    offered = {}
    for name, member in found.items():
        is_field = name in getattr(owner, "_fields", ()) or name in getattr(
            owner, "__dataclass_fields__", ()
        )
        if name.startswith("_") or is_field:
            continue
        if inspect.isdatadescriptor(member):
            offered[name] = member
        elif callable(getattr(owner, name)):
            offered[name] = getattr(owner, name)
    return list(offered.items())


def documented() -> list[tuple[str, str | None]]:
    """Public names with their docstrings."""
    found = [("iiwasim", iiwasim.__doc__)]
    for name in iiwasim.__all__:
        item = getattr(iiwasim, name)
        if name == "Motion":
            continue
        found.append((name, item.__doc__))
        # The attributes of a clearance do not have docstrings of their own.
        if inspect.isclass(item) and name != "Clearance":
            found += [(f"{name}.{member}", value.__doc__) for member, value in members(item)]
    return found


DOCUMENTED = documented()


@pytest.mark.parametrize(("name", "text"), DOCUMENTED, ids=[name for name, _ in DOCUMENTED])
def test_example(name: str, text: str | None, monkeypatch: pytest.MonkeyPatch) -> None:
    assert text, f"{name} has no docstring"
    if name.partition(".")[0].startswith(OF_THE_DRIVE):
        return
    # Examples name fixtures of the repository.
    monkeypatch.chdir(ROOT)
    assert ">>>" in text, f"the docstring of {name} has no example"
    test = doctest.DocTestParser().get_doctest(text, {}, name, None, 0)
    said: list[str] = []
    runner = doctest.DocTestRunner(optionflags=OPTIONS)
    runner.run(test, out=said.append)
    assert runner.summarize(verbose=False).failed == 0, "".join(said)


def test_names_are_those_of_the_package() -> None:
    public = {name for name in vars(iiwasim) if not name.startswith("_")}
    modules = {name for name in public if inspect.ismodule(getattr(iiwasim, name))}
    assert public - modules == set(iiwasim.__all__)
