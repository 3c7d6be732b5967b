"""Figures of many programs on a Ray cluster, with the same rows as `iiwasim.batches`.

Workers need the same version of iiwasim, and only the files of robot profiles that programs name:
the caller reads the source, sends chunks of programs to the workers, and writes the figures.
Needs Ray: `pip install 'iiwasim[ray]'`. The examples need a cluster; without one, Ray starts a
local cluster.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._chunks import Planning
from ._mapping import Planned, to_folder, to_table
from ._sources import Source, check, of_path, of_programs

try:
    import ray
    from ray.data import Dataset
except ImportError as error:
    raise ImportError("iiwasim.ray needs Ray: pip install 'iiwasim[ray]'") from error

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator
    from os import PathLike

    import pyarrow as pa
    from typing_extensions import Unpack

    from ._chunks import Options
    from ._native import Program

__all__ = ["figures", "mapped", "plan"]

# Maximum number of retries of a chunk whose worker has died.
RETRIES = 3


def plan(
    source: str | PathLike[str] | Dataset,
    target: str | PathLike[str],
    *,
    column: str = "program",
    chunk: int = 500,
    progress: Callable[[int, int], object] | None = None,
    **options: Unpack[Options],
) -> Planned:
    """Plans all programs of a file or a Ray Data dataset, and writes their figures to Parquet
    files.

    Works like `iiwasim.batches.plan`, on all CPUs of the cluster. Each chunk is a Ray task: if its
    worker dies, the task is retried on another one, up to three times. This function uses tasks
    rather than a Ray Data pipeline, because a pipeline does not write its results in parts with
    fixed row ranges, from which an interrupted run can resume. A dataset is kept in the cluster
    meanwhile.

    >>> import iiwasim.ray
    >>> iiwasim.ray.plan("programs.jsonl", "figures").rows
    600
    """
    planning = Planning(column, options)
    origin = _of_dataset(source, column) if isinstance(source, Dataset) else of_path(source, column)
    return to_folder(origin, target, chunk, planning, _Tasks(), progress)


def figures(programs: Iterable[Program | str], **options: Unpack[Options]) -> pa.Table:
    """Figures of programs in memory, in their order, like `iiwasim.batches.figures`.

    >>> import iiwasim as iw
    >>> import iiwasim.ray
    >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6)], start_deg=[0] * 7)
    >>> round(iiwasim.ray.figures([program])["cycle_time_s"][0].as_py(), 3)
    0.696
    """
    planning = Planning("program", options)
    return to_table(of_programs(programs, planning), planning, _Tasks())


def mapped(
    dataset: Dataset, *, column: str = "program", chunk: int = 500, **options: Unpack[Options]
) -> Dataset:
    """The dataset with figures in place of the programs in `column`, as a lazy step of a Ray Data
    pipeline.

    Rows keep their order, so that a column `row` is not needed. The options are the options of
    `plan`.

    >>> import iiwasim as iw
    >>> import iiwasim.ray, ray
    >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6)], start_deg=[0] * 7)
    >>> dataset = ray.data.from_items([{"name": "a", "program": program.to_json()}])
    >>> row, = iiwasim.ray.mapped(dataset).take_all()
    >>> row["name"], round(row["cycle_time_s"], 3)
    ('a', 0.696)
    """
    planning = Planning(column, options)
    check("the dataset", dataset.schema().base_schema, column)
    result = dataset.map_batches(
        planning.figures, batch_size=chunk, batch_format="pyarrow", zero_copy_batch=True
    )
    return _in_order(result)


def _of_dataset(dataset: Dataset, column: str) -> Source:
    held = _in_order(dataset).materialize()
    check("the dataset", held.schema().base_schema, column)

    def read() -> Iterator[pa.RecordBatch]:
        for table in held.iter_batches(batch_size=None, batch_format="pyarrow"):
            yield from table.to_batches()

    return Source("the dataset", lambda: held.schema().base_schema, read)


def _in_order(dataset: Dataset) -> Dataset:
    dataset.context.execution_options.preserve_order = True
    return dataset


def _figures(planning: Planning, chunk: pa.Table) -> pa.Table:
    return planning.figures(chunk)


class _Tasks:
    """Ray tasks, each on one CPU."""

    def __init__(self) -> None:
        if not ray.is_initialized():
            ray.init()
        self._task = ray.remote(num_cpus=1, max_retries=RETRIES)(_figures)

    def limit(self) -> int:
        # Read at each call, as clusters grow.
        return 2 * int(ray.cluster_resources().get("CPU", 1))

    def start(self, planning: Planning, chunk: pa.Table) -> Any:
        return self._task.remote(planning, chunk)

    def ended(self, tasks: Collection[Any]) -> Collection[Any]:
        ended: list[Any] = ray.wait(list(tasks), num_returns=1)[0]
        return ended

    def figures(self, task: Any) -> pa.Table:
        try:
            return ray.get(task)
        except (ray.exceptions.WorkerCrashedError, ray.exceptions.OutOfMemoryError) as error:
            raise RuntimeError(
                f"its worker died {1 + RETRIES} times; is there enough memory? {error}"
            ) from error

    def cancel(self, tasks: Collection[Any]) -> None:
        for task in tasks:
            ray.cancel(task)
