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
from iiwasim._arrays import real_array

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
        (
            lambda: iw.ptp(deg="home"),  # type: ignore[arg-type]
            ValueError,
            "deg is 'home'; a list of numbers is expected",
        ),
        (
            lambda: iw.ptp(rad=5),  # type: ignore[arg-type]
            TypeError,
            "rad is 5; a list of numbers is expected",
        ),
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
            "lin has no argument 'blend': give blend_cart_mm, blend_ori_deg or blend_sunrise_rel",
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
        (
            lambda _: iw.lin_rel(**{"in": "tcp"}),  # type: ignore[arg-type]
            "lin_rel has no argument 'in': give within",
        ),
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


MASKED = np.ma.masked_array(np.zeros(7), mask=[True] + [False] * 6)
COMPLEX = np.zeros(7) + 1j


@pytest.mark.parametrize("values", [MASKED, COMPLEX], ids=["masked", "complex"])
@pytest.mark.parametrize(
    "make",
    [
        lambda q: iw.Robot().flange(q),
        lambda q: iw.Robot().flange([q, np.zeros(7)]),
        lambda q: real_array("q", [([*q[:1], *HOME[1:]],)]),
        lambda q: iw.Robot().torques(np.zeros(7), q),
        lambda q: iw.Recording(q, np.zeros((7, 7))),
        lambda q: iw.Program([], start_rad=q),
        lambda q: iw.ptp(rad=q),
        lambda q: iw.ptp(rad=HOME, velocity_rel=q),
    ],
    ids=["q", "rows", "nested", "dq", "t", "start", "ptp", "share"],
)
def test_masked_and_complex_numbers_are_refused(make: Callable[[Any], object], values: Any) -> None:
    with pytest.raises(TypeError, match=r"masked|complex|expected"):
        make(values)


def test_a_mask_without_masked_values_is_accepted() -> None:
    joints = np.ma.masked_array(np.zeros(7), mask=False)
    assert np.array_equal(iw.Robot().flange(joints), iw.Robot().flange(np.zeros(7)))
    assert iw.ptp(rad=joints) == iw.ptp(rad=HOME)


def test_a_byte_order_mark_is_skipped(tmp_path: Path) -> None:
    robot = iw.Robot.from_profile(iw.Robot().profile())
    profile = "\ufeff" + iw.Robot().profile()
    assert iw.Robot.from_profile(profile) == robot
    (tmp_path / "robot.json").write_text(profile, encoding="utf-8")
    assert iw.Robot(str(tmp_path / "robot.json")) == robot
    keys = '"robot": "robot.json", "start": {"joints_deg": [0, 0, 0, 0, 0, 0, 0]}'
    program = f'\ufeff{{"version": 1, {keys}, "motions": [{{"type": "wait", "seconds": 1}}]}}'
    (tmp_path / "program.json").write_text(program, encoding="utf-8")
    assert len(iw.Program.load(tmp_path / "program.json")) == 1
    assert len(iw.Program.from_json(program.replace('"robot": "robot.json", ', ""))) == 1
    assert iw.Scene.from_json('\ufeff{"version": 1, "obstacles": []}').obstacles == []
    (tmp_path / "program.json").write_text(program, encoding="utf-16")
    with pytest.raises(iw.ProgramError, match="UTF-16: save it as UTF-8"):
        iw.Program.load(tmp_path / "program.json")


FUNCTIONS = [name for name in iw.__all__ if inspect.isfunction(getattr(iw, name))]


@pytest.mark.skipif(sys.version_info < (3, 10), reason="unions by | are no types there")
@pytest.mark.parametrize("name", FUNCTIONS)
def test_annotations_can_be_looked_up(name: str) -> None:
    function = getattr(iw, name)
    assert set(typing.get_type_hints(function)) == {
        *inspect.signature(function).parameters,
        "return",
    }
