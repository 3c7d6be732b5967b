"""Clusters that tests share, as the start of a cluster takes seconds."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import clusters
import pyarrow as pa
import pytest
from programs import random_programs

import iiwasim.dask
import iiwasim.ray
from iiwasim import batches

COUNT = 600
CHUNK = 50


class Cluster(NamedTuple):
    """A kind of cluster and its functions."""

    module: ModuleType
    plan: Callable[..., batches.Planned]
    figures: Callable[..., pa.Table]


@pytest.fixture(scope="session")
def of_ray() -> Iterator[Cluster]:
    with clusters.ray_cluster():
        yield Cluster(iiwasim.ray, iiwasim.ray.plan, iiwasim.ray.figures)


@pytest.fixture(scope="session")
def of_dask() -> Iterator[Cluster]:
    with clusters.dask_cluster():
        yield Cluster(iiwasim.dask, iiwasim.dask.plan, iiwasim.dask.figures)


@pytest.fixture(params=["of_ray", "of_dask"])
def cluster(request: pytest.FixtureRequest) -> Cluster:
    return request.getfixturevalue(request.param)


@pytest.fixture(scope="session")
def programs() -> list[str]:
    """Programs, one of which cannot be planned, and two texts that are not programs."""
    texts = random_programs(COUNT)
    texts[7] = texts[7].replace('"joints_deg": [', '"joints_deg": [9', 1)
    texts[60] = "{}"
    texts[COUNT - 1] = "[]"
    return texts


@pytest.fixture(scope="session")
def source(programs: list[str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The programs as a file of JSON lines."""
    file = tmp_path_factory.mktemp("programs") / "programs.jsonl"
    file.write_text("".join(f"{program}\n" for program in programs))
    return file


@pytest.fixture(scope="session")
def on_one_core(programs: list[str]) -> pa.Table:
    return batches.figures(programs, jobs=1)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    # Ray Data warns about its own options.
    for item in items:
        item.add_marker(pytest.mark.filterwarnings("ignore::DeprecationWarning:ray"))
