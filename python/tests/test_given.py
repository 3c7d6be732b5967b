"""Arguments: accepted forms, and messages with the place and the expected value."""

from __future__ import annotations

import inspect
import sys
import typing
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import iiwasim as iw

if TYPE_CHECKING:
    from collections.abc import Callable

HOME = [0] * 7


def test_a_report_that_cannot_be_written_leaves_nothing(tmp_path: Path) -> None:
    plan = iw.plan(iw.Program([iw.ptp(deg=[10, *HOME[1:]])], start_deg=HOME))
    folder = tmp_path / "folder"
    folder.mkdir()
    with pytest.raises(OSError, match="folder") as caught:
        plan.report(folder)
    # Windows reports a missing permission.
    assert isinstance(caught.value, (IsADirectoryError, PermissionError))
    assert caught.value.errno and caught.value.filename == str(folder)
    assert list(tmp_path.iterdir()) == [folder] and not list(folder.iterdir())


@pytest.mark.parametrize("place", [dict, list])
def test_motions_that_contain_themselves(place: type) -> None:
    motion: dict[str, Any] = iw.wait(1)
    motion["source"] = motion if place is dict else [[motion]]
    with pytest.raises(
        iw.ProgramError, match="motion 2 contains a list or dict that contains itself"
    ) as caught:
        iw.Program([iw.wait(1), motion], start_deg=HOME)
    assert caught.value.motion == 2
    # A list that occurs twice does not contain itself.
    motion["source"] = {"again": [HOME, HOME], "never": np.inf}
    with pytest.raises(iw.ProgramError, match="motion 1 contains a value that is not finite"):
        iw.Program([motion], start_deg=HOME)


@pytest.mark.parametrize("overlap", [True, False])
def test_overlaps_are_booleans_of_numpy_too(overlap: bool) -> None:
    wait = iw.wait(1, overlap=np.bool_(overlap))  # type: ignore[arg-type]
    assert wait == iw.wait(1, overlap=overlap)
    assert len(iw.Program([iw.ptp(deg=[10, *HOME[1:]]), wait], start_deg=HOME)) == 2


@pytest.mark.parametrize(
    ("make", "kind", "says"),
    [
        (
            lambda: iw.ptp(deg=HOME, velocity_rel="fast"),
            ValueError,
            "velocity_rel is 'fast'; a number, or one for each",
        ),  # type: ignore[arg-type]
        (
            lambda: iw.ptp(deg=HOME, jerk_rel=[1, "a"]),
            ValueError,
            r"jerk_rel is \[1, 'a'\]; a number, or",
        ),  # type: ignore[list-item]
        (
            lambda: iw.ptp(deg=HOME, acceleration_rel={}),
            TypeError,
            r"acceleration_rel is \{\}; a number, or",
        ),  # type: ignore[arg-type]
        (lambda: iw.ptp(deg="home"), ValueError, "deg is 'home'; a list of numbers is expected"),  # type: ignore[arg-type]
        (lambda: iw.ptp(rad=5), TypeError, "rad is 5; a list of numbers is expected"),  # type: ignore[arg-type]
        (
            lambda: iw.load(1, center_mm=[0, None, 0]),
            TypeError,
            r"center_mm is \[0, None, 0\]; a list of",
        ),  # type: ignore[list-item]
    ],
)
def test_numbers_that_are_none_are_named(
    make: Callable[[], object], kind: type[Exception], says: str
) -> None:
    with pytest.raises(kind, match=f"^{says}"):
        make()


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (
            lambda given: iw.lin("a", **given),
            "lin has no argument 'blend': give blend_cart_mm or blend_ori_deg",
        ),
        (lambda given: iw.lin_rel(**given), "lin_rel has no argument 'blend': give blend_cart_mm"),
        (
            lambda given: iw.circ("a", "b", **given),
            "circ has no argument 'blend': give blend_cart_mm",
        ),
        (
            lambda given: iw.spline([], **given),
            "spline has no argument 'blend': give blend_cart_mm",
        ),
        (
            lambda _: iw.lin_rel(offset={"z_mm": 1}),
            "lin_rel has no argument 'offset': give x_mm, y_mm",
        ),
        (lambda _: iw.lin_rel(**{"in": "tcp"}), "lin_rel has no argument 'in': give within"),  # type: ignore[arg-type]
        (
            lambda _: iw.lin("a", type="ptp"),
            "lin has no argument 'type': its motions have their type",
        ),
    ],
)
def test_keys_that_other_arguments_make(
    make: Callable[[dict[str, Any]], object], says: str
) -> None:
    with pytest.raises(TypeError, match=f"^{says}"):
        make({"blend": {"cart_mm": 5}})


def test_unknown_keys_are_told_by_the_program() -> None:
    frame = iw.Robot().frame(np.radians([0, 30, 0, -60, 0, 90, 0]))
    with pytest.raises(iw.ProgramError, match="motion 1: unknown key `kind`"):
        iw.Program([iw.lin(frame, kind="ptp")], start_deg=HOME)


FUNCTIONS = [name for name in iw.__all__ if inspect.isfunction(getattr(iw, name))]


@pytest.mark.skipif(sys.version_info < (3, 10), reason="unions by | are no types there")
@pytest.mark.parametrize("name", FUNCTIONS)
def test_annotations_can_be_looked_up(name: str) -> None:
    function = getattr(iw, name)
    assert set(typing.get_type_hints(function)) == {
        *inspect.signature(function).parameters,
        "return",
    }
