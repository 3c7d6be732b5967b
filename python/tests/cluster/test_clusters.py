"""Two Ray or Dask workers return the rows of one core, also if workers die."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

import cloudpickle
import clusters
import dask.config
import dask.dataframe as dd
import pandas as pd
import pyarrow as pa
import pytest
import ray.cloudpickle
import ray.data
from conftest import CHUNK, COUNT, Cluster

import iiwasim as iw
import iiwasim.dask
import iiwasim.ray
from iiwasim import batches
from iiwasim._chunks import Planning


class Interrupted(Exception):
    """Raised to interrupt a run."""


class Deadly(Planning):
    """A `Planning` that kills each worker."""

    def figures(self, chunk: pa.Table) -> pa.Table:
        os._exit(1)


@contextmanager
def a_worker_is_killed(module: ModuleType, folder: Path) -> Iterator[None]:
    """Kills one worker that plans within the context."""
    pid_file = folder / "pid"
    with pytest.MonkeyPatch.context() as patch, ThreadPoolExecutor() as meanwhile:
        patch.setattr(module, "Planning", clusters.victim(pid_file))
        killed = meanwhile.submit(clusters.kill_victim, pid_file)
        yield
        killed.result()


def test_a_worker_is_killed(
    cluster: Cluster, source: Path, on_one_core: pa.Table, tmp_path: Path
) -> None:
    target = tmp_path / "figures"
    with a_worker_is_killed(cluster.module, tmp_path):
        assert cluster.plan(source, target, chunk=CHUNK) == (target, COUNT, COUNT)
    assert batches.read(target).equals(on_one_core)


def test_an_interrupted_run_is_taken_up_elsewhere(
    cluster: Cluster, source: Path, on_one_core: pa.Table, tmp_path: Path
) -> None:
    def stop(done: int, _: int) -> None:
        if done >= 3 * CHUNK:
            raise Interrupted

    with pytest.raises(Interrupted):
        cluster.plan(source, tmp_path, chunk=CHUNK, progress=stop)
    assert len(list(tmp_path.glob("part-*.parquet"))) == 3
    # The first parts on this machine, the others on the cluster.
    with pytest.raises(Interrupted):
        batches.plan(source, tmp_path, chunk=CHUNK, jobs=1, progress=stop)
    assert cluster.plan(source, tmp_path, chunk=CHUNK).rows_planned == COUNT - 4 * CHUNK
    assert cluster.plan(source, tmp_path, chunk=CHUNK).rows_planned == 0
    assert batches.read(tmp_path).equals(on_one_core)
    with pytest.raises(iw.IiwasimError, match="figures of another plan: `timing`"):
        cluster.plan(source, tmp_path, chunk=CHUNK, timing="acceleration")


def test_programs_that_kill_every_worker_end(
    cluster: Cluster, programs: list[str], on_one_core: pa.Table, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in (iiwasim.ray, iiwasim.dask):
        monkeypatch.setattr(module, "Planning", Deadly)
    # Workers cannot import this file.
    for pickle in (cloudpickle, ray.cloudpickle):
        pickle.register_pickle_by_value(sys.modules[__name__])
    with pytest.raises(RuntimeError, match=r"chunk 0 of the programs: .* is there enough memory"):
        cluster.figures(programs[:1])
    monkeypatch.undo()
    assert cluster.figures(programs).equals(on_one_core)


def test_dask_without_workers(programs: list[str]) -> None:
    with (
        dask.config.set({"distributed.scheduler.no-workers-timeout": "0.1s"}),
        clusters.dask_cluster(workers=0) as client,
        pytest.raises(Exception, match="without any running workers"),
    ):
        iiwasim.dask.figures(programs[:1], client=client)


def test_programs_in_memory(cluster: Cluster, programs: list[str], on_one_core: pa.Table) -> None:
    assert cluster.figures(programs).equals(on_one_core)
    assert cluster.figures([]).num_rows == 0


def test_no_programs(of_ray: Cluster, of_dask: Cluster, tmp_path: Path) -> None:
    rows = pd.DataFrame({"name": pd.array([], "string"), "program": pd.array([], "string")})
    dataset = ray.data.from_arrow(pa.Table.from_pandas(rows, preserve_index=False))
    for cluster, source in ((of_ray, dataset), (of_dask, dd.from_pandas(rows, npartitions=1))):
        target = tmp_path / type(source).__name__
        assert cluster.plan(source, target).rows == 0
        figures = batches.read(target)
        assert figures.num_rows == 0 and figures.column_names[:2] == ["row", "name"]
        assert cluster.plan(source, target).rows_planned == 0
        assert figures.drop_columns(["name"]).equals(batches.figures([]))


def test_ray_data(
    of_ray: Cluster, programs: list[str], on_one_core: pa.Table, tmp_path: Path
) -> None:
    names = [f"program {place}" for place in range(COUNT)]
    table = pa.table({"name": names, "program": programs})
    dataset = ray.data.from_arrow([table.slice(place, 70) for place in range(0, COUNT, 70)])
    with a_worker_is_killed(iiwasim.ray, tmp_path):
        rows = pa.Table.from_pylist(iiwasim.ray.mapped(dataset, chunk=CHUNK).take_all())
    assert rows["name"].to_pylist() == names
    for column in ("cycle_time_s", "limited_by", "error"):
        assert rows[column].to_pylist() == on_one_core[column].to_pylist()
    target = tmp_path / "figures"
    iiwasim.ray.plan(dataset, target, chunk=CHUNK)
    figures = batches.read(target)
    assert figures["name"].to_pylist() == names
    assert figures.drop_columns(["name"]).equals(on_one_core)
    assert iiwasim.ray.plan(dataset, target, chunk=CHUNK).rows_planned == 0
    with pytest.raises(iw.IiwasimError, match="no column 'json'"):
        iiwasim.ray.mapped(dataset, column="json")


def test_data_frame_of_dask(
    of_dask: Cluster, programs: list[str], on_one_core: pa.Table, tmp_path: Path
) -> None:
    names = [f"program {place}" for place in range(COUNT)]
    rows = pd.DataFrame(
        {"name": names, "program": programs}, index=pd.RangeIndex(1000, 1000 + COUNT)
    )
    frame = dd.from_pandas(rows, npartitions=7)
    with a_worker_is_killed(iiwasim.dask, tmp_path):
        mapped = iiwasim.dask.mapped(frame)
        computed = mapped.compute()
    assert computed["name"].tolist() == names
    assert computed.index.equals(rows.index)
    assert computed.dtypes.equals(mapped.dtypes)
    for column in ("cycle_time_s", "limited_by", "error"):
        values = pa.array(computed[column]).to_pylist()
        assert values == on_one_core[column].to_pylist()
    target = tmp_path / "figures"
    iiwasim.dask.plan(frame, target, chunk=CHUNK)
    figures = batches.read(target)
    assert figures["name"].to_pylist() == names
    assert figures.drop_columns(["name"]).equals(on_one_core)
    assert iiwasim.dask.plan(frame, target, chunk=CHUNK).rows_planned == 0
    with pytest.raises(iw.IiwasimError, match="no column 'json'"):
        iiwasim.dask.mapped(frame, column="json")
