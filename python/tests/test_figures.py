"""Figures of many programs: invalid programs, options and motions, and Ctrl-C.

`tests/cluster` has the other tests, on one machine and on clusters.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Event
from typing import Any

import numpy as np
import pytest

pa = pytest.importorskip("pyarrow", reason="figures of many programs need pyarrow")
pq = pytest.importorskip("pyarrow.parquet")

import iiwasim as iw
from iiwasim import _chunks, batches
from iiwasim._chunks import Planning

HOME = [0] * 7


def program(*degrees: float) -> iw.Program:
    """A program of PTP motions of A1."""
    return iw.Program([iw.ptp(deg=[angle, *HOME[1:]]) for angle in degrees], start_deg=HOME)


def lines(folder: Path, *texts: str | bytes) -> Path:
    """Writes a file of JSON lines."""
    source = folder / "programs.jsonl"
    source.write_bytes(
        b"\n".join(text if isinstance(text, bytes) else text.encode() for text in texts)
    )
    return source


@pytest.mark.parametrize("motion", [iw.load(1), iw.wait(0)], ids=["load", "wait"])
def test_programs_without_a_motion_have_no_peak(motion: iw.Motion) -> None:
    at_rest = iw.Program([motion], start_deg=HOME)
    rows = batches.figures([at_rest, program(10)]).to_pylist()
    assert [row["error"] for row in rows] == [None, None]
    assert rows[0]["cycle_time_s"] == iw.plan(at_rest).cycle_time_s
    assert rows[0]["peak_torque_percent"] is None and rows[0]["peak_torque_joint"] is None
    assert rows[1]["peak_torque_percent"] > 0


@pytest.mark.parametrize(
    "options",
    [
        {"samples": np.int64(50), "timing": "acceleration"},
        {"limit_torque_percent": np.float32(80)},
        {"override_percent": np.float32(50)},
        {"chunk": np.int32(1), "jobs": np.uint8(1)},
    ],
    ids=str,
)
def test_numbers_of_numpy_are_options(options: dict[str, Any], tmp_path: Path) -> None:
    source, target = (
        lines(tmp_path, program(10).to_json(), program(20).to_json()),
        tmp_path / "figures",
    )
    assert batches.plan(source, target, **options).rows_planned == 2
    # Equal Python values give the same plan.
    plain = {
        name: getattr(value, "tolist", lambda value=value: value)()
        for name, value in options.items()
    }
    assert batches.plan(source, target, **plain).rows_planned == 0


@pytest.mark.parametrize(
    ("options", "kind", "says"),
    [
        ({"samples": 50.5}, TypeError, "integer"),
        ({"samples": 1}, ValueError, "samples is 1; from 2"),
        ({"chunk": 2.5}, TypeError, r"chunk is 2\.5; a whole number is expected"),
        ({"chunk": 0}, ValueError, "chunk is 0; at least 1 is needed"),
        ({"jobs": "all"}, TypeError, "jobs is 'all'; a whole number is expected"),
        ({"progress": 3}, TypeError, "progress is 3; a function of two numbers is expected"),
    ],
    ids=str,
)
def test_wrong_options_are_told_before_anything_is_written(
    options: dict[str, Any], kind: type[Exception], says: str, tmp_path: Path
) -> None:
    source = lines(tmp_path, program(10).to_json())
    with pytest.raises(kind, match=says):
        batches.plan(source, tmp_path / "figures", **options)
    assert list(tmp_path.iterdir()) == [source]


def test_blank_lines_are_no_programs(tmp_path: Path) -> None:
    texts = [program(10).to_json(), "", "nonsense", " \t\r", program(20).to_json(), "", ""]
    source, target = lines(tmp_path, *texts), tmp_path / "figures"
    told: list[tuple[int, int]] = []
    assert batches.plan(source, target, chunk=1, progress=lambda *done: told.append(done)).rows == 3
    assert told[-1] == (3, 3)
    figures = batches.read(target)
    assert figures["row"].to_pylist() == [0, 1, 2]
    assert [error is None for error in figures["error"].to_pylist()] == [True, False, True]
    assert figures.equals(batches.figures([texts[0], texts[2], texts[4]]))
    # A run resumes with equal numbers, and also without the blank lines.
    (target / "part-00001.parquet").unlink()
    assert batches.plan(source, target, chunk=1).rows_planned == 1
    lines(tmp_path, texts[0], texts[2], texts[4] + "\n")
    assert batches.plan(source, target, chunk=1).rows_planned == 0
    assert batches.read(target).equals(figures)


def test_a_mark_of_the_encoding_is_no_part_of_a_program(tmp_path: Path) -> None:
    source = lines(
        tmp_path, b"\xef\xbb\xbf" + program(10).to_json().encode(), program(20).to_json()
    )
    batches.plan(source, tmp_path / "figures")
    assert batches.read(tmp_path / "figures").equals(batches.figures([program(10), program(20)]))


@pytest.mark.parametrize("text", [b"", b"\n \n", b"\xef\xbb\xbf"], ids=["empty", "blank", "mark"])
def test_no_lines_have_no_figures(text: bytes, tmp_path: Path) -> None:
    source, target = lines(tmp_path, text), tmp_path / "figures"
    told: list[tuple[int, int]] = []
    for _ in range(2):
        assert batches.plan(source, target, progress=lambda *done: told.append(done)) == (
            target,
            0,
            0,
        )
        figures = batches.read(target)
        assert figures.num_rows == 0 and figures.equals(batches.figures([]))
    # Without programs, `progress` is not called, as it may divide by their number.
    assert told == []


def test_columns_without_rows_stay(tmp_path: Path) -> None:
    columns = {
        "name": pa.array([], pa.string()),
        "program": pa.array([], pa.string()),
        "weight": pa.array([], "f8"),
    }
    pq.write_table(pa.table(columns), tmp_path / "programs.parquet")
    batches.plan(tmp_path / "programs.parquet", tmp_path / "figures")
    figures = batches.read(tmp_path / "figures")
    assert figures.num_rows == 0 and figures.column_names[:3] == ["row", "name", "weight"]
    assert figures.drop_columns(["name", "weight"]).schema == batches.figures([program(10)]).schema


@pytest.mark.parametrize(
    ("programs", "says"),
    [
        (
            program(10).to_json(),
            r"are a str; a list of .* is expected, \[program\] for one, and `plan` takes files",
        ),
        ("programs.jsonl", "are a str; a list of iiwasim.Program or of JSON texts is expected"),
        (program(10).to_json().encode(), "are a bytes; "),
        ({"version": 1, "motions": []}, "are a dict; "),
        (program(10), "are a Program; "),
        (Path("programs.jsonl"), "Path; .*, and `plan` takes files"),
    ],
    ids=["json", "name", "bytes", "keys", "program", "path"],
)
def test_what_is_no_list_of_programs(programs: Any, says: str) -> None:
    with pytest.raises(TypeError, match=says):
        batches.figures(programs)


def test_what_is_no_file_of_programs(tmp_path: Path) -> None:
    with pytest.raises(
        iw.IiwasimError, match="the source is a JSON text; `plan` takes the path of a file"
    ):
        batches.plan(program(*range(1, 90)).to_json(), tmp_path / "figures")
    with pytest.raises(
        TypeError, match="the source is a list; `plan` takes the path of a file, and `figures`"
    ):
        batches.plan([program(10)], tmp_path / "figures")  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())


def test_names_of_files_may_begin_as_json(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    lines(tmp_path, program(10).to_json()).rename("[1].jsonl")
    assert batches.plan("[1].jsonl", "figures").rows == 1


@pytest.mark.parametrize("phase", ["planning", "figures"])
def test_ctrl_c_does_not_wait_for_the_rest_of_a_chunk(
    phase: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    chunks: list[int] = []
    rows: list[object] = []
    is_at_hand, is_told = Event(), Event()
    plan_all, row, shutdown = _chunks.plan_all, Planning._row, ThreadPoolExecutor.shutdown

    def interrupted(*_: Any, timeout: float, **__: Any) -> None:
        """Acts like Ctrl-C while the main thread waits for chunks; on Windows, at the end of a
        wait.
        """
        assert timeout <= 1 and is_at_hand.wait(20)
        raise KeyboardInterrupt

    def hold() -> None:
        """Waits until the main thread has received the interrupt."""
        is_at_hand.set()
        assert is_told.wait(20)

    def planned(programs: list[iw.Program], **options: Any) -> list[iw.Plan | iw.ProgramError]:
        if programs:
            chunks.append(len(programs))
            if phase == "planning":
                hold()
        return plan_all(programs, **options)

    def figures_of(*arguments: Any) -> Any:
        rows.append(arguments)
        if phase == "figures" and not is_told.is_set():
            hold()
        return row(*arguments)

    def end(*arguments: Any, **options: Any) -> None:
        is_told.set()
        shutdown(*arguments, **options)

    monkeypatch.setattr(_chunks, "plan_all", planned)
    monkeypatch.setattr(Planning, "_row", figures_of)
    monkeypatch.setattr(batches, "wait", interrupted)
    monkeypatch.setattr(ThreadPoolExecutor, "shutdown", end)
    source = lines(tmp_path, *[program(10).to_json()] * 20)
    with pytest.raises(KeyboardInterrupt):
        batches.plan(source, tmp_path / "figures", chunk=10, jobs=1)
    # Nothing from the second chunk, and from the first at most the program in progress.
    assert chunks == [10] and len(rows) == (0 if phase == "planning" else 1)
    monkeypatch.undo()
    assert batches.plan(source, tmp_path / "figures", chunk=10, jobs=1).rows_planned == 20
