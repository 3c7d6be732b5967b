"""Planning from file to file on one machine: sources, folders, errors."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from conftest import CHUNK, COUNT

import iiwasim as iw
from iiwasim import batches
from iiwasim._chunks import Planning

FIXTURES = Path(__file__).resolve().parents[3] / "fixtures"


class Interrupted(Exception):
    """Raised to interrupt a run."""


def test_figures_are_those_of_plans(programs: list[str], on_one_core: pa.Table) -> None:
    plans = iw.plan_all([iw.Program.from_json(text) for text in programs[:5]], jobs=1)
    rows = on_one_core.slice(0, 5).to_pylist()
    for plan, row in zip(plans, rows):
        assert isinstance(plan, iw.Plan)
        assert [
            row[name] for name in ("cycle_time_s", "motion_time_s", "settle_time_s", "wait_time_s")
        ] == [
            plan.cycle_time_s,
            plan.motion_time_s,
            plan.settle_time_s,
            plan.wait_time_s,
        ]
        assert row["motions"] == len(plan.motions)
        peak = max(max(motion.figures["torque"]["peak_percent"]) for motion in plan.motions)
        assert row["peak_torque_percent"] == peak


def test_limits_and_clearance() -> None:
    names = ("appendix-b", "pick-and-place")
    scene = iw.Scene.load(FIXTURES / "cage.json")
    programs = [iw.Program.load(FIXTURES / f"{name}.json") for name in names]
    rows = batches.figures(programs, scene=scene).to_pylist()
    # The values that `iiwasim plan fixtures` prints.
    assert [(row["limited_joint"], row["limited_by"]) for row in rows] == [
        (4, "velocity"),
        (None, "cart_velocity"),
    ]
    for program, row in zip(programs, rows):
        clearance = iw.plan(program).clearance(scene)
        assert clearance is not None
        assert (row["clearance_m"], row["clearance_obstacle"]) == (
            clearance.distance_m,
            clearance.obstacle,
        )


def test_bad_rows_stop_nothing(programs: list[str], on_one_core: pa.Table) -> None:
    errors = {row["row"]: row["error"] for row in on_one_core.to_pylist() if row["error"]}
    assert set(errors) == {7, 60, COUNT - 1}
    for row, error in errors.items():
        with pytest.raises(iw.ProgramError) as raised:
            iw.plan(iw.Program.from_json(programs[row]))
        assert error == str(raised.value)
    assert on_one_core["cycle_time_s"].null_count == 3


@pytest.mark.parametrize("jobs", [1, 2])
def test_lines(source: Path, on_one_core: pa.Table, tmp_path: Path, jobs: int) -> None:
    told: list[tuple[int, int]] = []
    planned = batches.plan(
        source,
        tmp_path / "figures",
        chunk=CHUNK,
        jobs=jobs,
        progress=lambda *done: told.append(done),
    )
    assert planned == (tmp_path / "figures", COUNT, COUNT)
    assert told == [(done, COUNT) for done in range(CHUNK, COUNT + 1, CHUNK)]
    assert batches.read(planned.folder).equals(on_one_core)
    # Parquet readers find only the parts, with rows in order.
    assert pq.read_table(planned.folder).equals(on_one_core)


def test_bytes_that_are_no_text(tmp_path: Path, programs: list[str]) -> None:
    good = programs[0].encode()
    (tmp_path / "programs.jsonl").write_bytes(
        good + b"\n" + good.replace(b"ptp", b"pt\xff") + b"\r\n\n" + good
    )
    batches.plan(tmp_path / "programs.jsonl", tmp_path / "figures")
    errors = batches.read(tmp_path / "figures")["error"].to_pylist()
    assert [error is None for error in errors] == [True, False, True]


@pytest.mark.parametrize("files", [1, 3])
@pytest.mark.parametrize("kind", [pa.string(), pa.large_string()])
def test_parquet(
    programs: list[str], on_one_core: pa.Table, tmp_path: Path, files: int, kind: pa.DataType
) -> None:
    texts: list[str | None] = [*programs]
    names = [f"program {place}" for place in range(COUNT)]
    table = pa.table({"name": names, "json": pa.array(texts, kind), "weight": [0.5] * COUNT})
    folder = tmp_path / "programs"
    folder.mkdir()
    share = COUNT // files
    for place in range(files):
        # Row groups whose size is not a multiple of the chunk size.
        pq.write_table(
            table.slice(place * share, share), folder / f"{place}.parquet", row_group_size=37
        )
    source = folder if files > 1 else folder / "0.parquet"
    planned = batches.plan(source, tmp_path / "figures", column="json", chunk=CHUNK)
    figures = batches.read(planned.folder)
    assert figures["name"].to_pylist() == names
    assert figures.drop_columns(["name", "weight"]).equals(on_one_core)


def test_missing_programs_are_errors(tmp_path: Path, programs: list[str]) -> None:
    pq.write_table(pa.table({"program": [None, programs[0]]}), tmp_path / "programs.parquet")
    batches.plan(tmp_path / "programs.parquet", tmp_path / "figures")
    assert batches.read(tmp_path / "figures")["error"].to_pylist() == [
        "there is no program in this row",
        None,
    ]


def test_an_interrupted_run_is_taken_up(
    source: Path, on_one_core: pa.Table, tmp_path: Path
) -> None:
    def stop(done: int, _: int) -> None:
        if done >= 3 * CHUNK:
            raise Interrupted

    with pytest.raises(Interrupted):
        # One thread plans the parts in order.
        batches.plan(source, tmp_path, chunk=CHUNK, jobs=1, progress=stop)
    parts = sorted(tmp_path.glob("part-*.parquet"))
    assert len(parts) == 3
    written = [part.stat().st_mtime_ns for part in parts]
    # An incomplete part, as left by a process that died while writing.
    (tmp_path / ".part-00003.parquet").write_bytes(b"PAR1")
    assert batches.plan(source, tmp_path, chunk=CHUNK).rows_planned == COUNT - 3 * CHUNK
    assert [part.stat().st_mtime_ns for part in parts] == written
    assert batches.read(tmp_path).equals(on_one_core)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "_plan.json",
        *(f"part-{place:05}.parquet" for place in range(COUNT // CHUNK)),
    ]


def test_a_killed_run_is_taken_up(source: Path, on_one_core: pa.Table, tmp_path: Path) -> None:
    target = tmp_path / "figures"
    script = (
        f"from iiwasim import batches; batches.plan({str(source)!r}, {str(target)!r}, chunk=10)"
    )
    run = subprocess.Popen([sys.executable, "-c", script])
    until = time.monotonic() + 300
    while len(list(target.glob("part-*.parquet"))) < 3:
        assert run.poll() is None and time.monotonic() < until
        time.sleep(0.01)
    run.kill()
    run.wait()
    parts = len(list(target.glob("part-*.parquet")))
    with pytest.raises(iw.IiwasimError, match=rf"has figures of {10 * parts} of {COUNT} programs"):
        batches.read(target)
    assert batches.plan(source, target, chunk=10).rows_planned == COUNT - 10 * parts
    assert batches.read(target).equals(on_one_core)


def test_foreign_folders_are_refused(programs: list[str], tmp_path: Path) -> None:
    source, target = tmp_path / "programs.jsonl", tmp_path / "figures"
    source.write_text("\n".join(programs[:4]))
    batches.plan(source, target, chunk=2)
    profile = iw.Robot.from_profile(iw.Robot("lbr_iiwa_14_r820").profile())
    for named, options in {
        "`chunk` is 2 there, 3 here": {"chunk": 3},
        "`timing` is 'sunrise' there, 'acceleration' here": {"timing": "acceleration"},
        "`robot` is None there": {"robot": profile},
        "`scene` is None there": {"scene": FIXTURES / "cage.json"},
    }.items():
        with pytest.raises(iw.IiwasimError, match=named):
            batches.plan(source, target, **{"chunk": 2, **options})
    # An explicit default equals an option that is left out.
    assert batches.plan(source, target, chunk=2, timing="sunrise").rows_planned == 0
    source.write_text("\n".join([*programs[:3], programs[5]]))
    with pytest.raises(iw.IiwasimError, match="figures of another plan: `programs` is"):
        batches.plan(source, target, chunk=2)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "letter.txt").write_text("mine")
    with pytest.raises(iw.IiwasimError, match="files in it that are no figures"):
        batches.plan(source, tmp_path / "other")
    (target / "_plan.json").write_text("[")
    with pytest.raises(iw.IiwasimError, match="is not as it was written"):
        batches.plan(source, target, chunk=2)


def test_a_source_that_changes_is_told(programs: list[str], tmp_path: Path) -> None:
    source = tmp_path / "programs.jsonl"
    # More than one read buffer.
    source.write_text("\n".join(program + 100_000 * " " for program in programs[:40]))

    def change(*_: int) -> None:
        source.write_text("\n".join(programs[:2]))

    with pytest.raises(iw.IiwasimError, match="changed while it was planned"):
        batches.plan(source, tmp_path / "figures", chunk=1, jobs=1, progress=change)


def test_bad_sources(programs: list[str], tmp_path: Path) -> None:
    def parquet(**columns: object) -> Path:
        pq.write_table(pa.table(columns), tmp_path / "bad.parquet")
        return tmp_path / "bad.parquet"

    def refused(path: Path) -> str:
        with pytest.raises(iw.IiwasimError) as raised:
            batches.plan(path, tmp_path / "figures")
        return str(raised.value)

    assert refused(tmp_path / "none.jsonl").startswith("there is no ")
    (tmp_path / "programs.csv").write_text("program")
    assert "neither Parquet" in refused(tmp_path / "programs.csv")
    assert "has no column 'program'; it has id, json" in refused(parquet(id=[1], json=["{}"]))
    assert "has int64; programs are JSON texts" in refused(parquet(program=[1]))
    assert "a column 'cycle_time_s', as figures have" in refused(
        parquet(program=["{}"], cycle_time_s=[1.0])
    )
    (tmp_path / "bad.parquet").write_text("no Parquet")
    assert "cannot read" in refused(tmp_path / "bad.parquet")
    assert not (tmp_path / "figures").exists()


def test_bad_options(programs: list[str]) -> None:
    with pytest.raises(ValueError, match="'jerk', 'sunrise', 'acceleration' are known"):
        batches.figures(programs[:1], timing="fast")
    with pytest.raises(TypeError, match="no option 'speed'"):
        batches.figures(programs[:1], speed=2)  # type: ignore[call-arg]
    with pytest.raises(ValueError, match="jobs is 0"):
        batches.figures(programs[:1], jobs=0)
    with pytest.raises(TypeError, match=r"programs\[1\] is not an iiwasim.Program"):
        batches.figures([programs[0], json.loads(programs[1])])


def test_a_profile_is_not_lost(programs: list[str]) -> None:
    profile = json.loads(iw.Robot().profile())
    profile["velocity_limit_deg_s"] = [value / 2 for value in profile["velocity_limit_deg_s"]]
    slow = iw.Robot.from_profile(json.dumps(profile))
    text = json.loads(programs[0])
    program = iw.Program(text["motions"], start_deg=text["start"]["joints_deg"], robot=slow)
    with pytest.raises(ValueError, match=r"programs\[0\] is for a robot with a profile of its own"):
        batches.figures([program])
    (figures,) = batches.figures([program], robot=slow).to_pylist()
    assert figures["cycle_time_s"] == iw.plan(program).cycle_time_s


def test_workers_of_another_version_are_refused(programs: list[str]) -> None:
    planning = Planning("program", {})
    planning.version = "0.0.1"
    with pytest.raises(RuntimeError, match=r"a worker has iiwasim .*; 0\.0\.1 is needed, as here"):
        planning.figures(pa.table({"program": programs[:1]}))


def test_no_programs(tmp_path: Path) -> None:
    (tmp_path / "programs.jsonl").write_text("")
    assert batches.plan(tmp_path / "programs.jsonl", tmp_path / "figures").rows == 0
    assert batches.read(tmp_path / "figures").num_rows == 0
    assert batches.figures([]).num_rows == 0
