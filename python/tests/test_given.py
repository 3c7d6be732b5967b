"""What is given wrongly: messages say where, and what is expected."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import iiwasim as iw

HOME = [0] * 7


def test_a_report_that_cannot_be_written_leaves_nothing(tmp_path: Path) -> None:
    plan = iw.plan(iw.Program([iw.ptp(deg=[10, *HOME[1:]])], start_deg=HOME))
    folder = tmp_path / "folder"
    folder.mkdir()
    with pytest.raises(OSError, match="folder") as caught:
        plan.report(folder)
    # On Windows, it is no permission.
    assert isinstance(caught.value, (IsADirectoryError, PermissionError))
    assert caught.value.errno and caught.value.filename == str(folder)
    assert list(tmp_path.iterdir()) == [folder] and not list(folder.iterdir())


@pytest.mark.parametrize("place", [dict, list])
def test_motions_that_contain_themselves(place: type) -> None:
    motion: dict[str, Any] = iw.wait(1)
    motion["source"] = motion if place is dict else [[motion]]
    with pytest.raises(iw.ProgramError, match="motion 2 contains a list or dict that contains itself") as caught:
        iw.Program([iw.wait(1), motion], start_deg=HOME)
    assert caught.value.motion == 2
    # A list that is there twice is not in itself.
    motion["source"] = {"again": [HOME, HOME], "never": np.inf}
    with pytest.raises(iw.ProgramError, match="motion 1 contains a value that is not finite"):
        iw.Program([motion], start_deg=HOME)


@pytest.mark.parametrize("overlap", [True, False])
def test_overlaps_are_booleans_of_numpy_too(overlap: bool) -> None:
    wait = iw.wait(1, overlap=np.bool_(overlap))  # type: ignore[arg-type]
    assert wait == iw.wait(1, overlap=overlap)
    assert len(iw.Program([iw.ptp(deg=[10, *HOME[1:]]), wait], start_deg=HOME)) == 2
