"""What is given wrongly: messages say where, and what is expected."""

from __future__ import annotations

from pathlib import Path

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
