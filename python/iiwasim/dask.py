"""Figures of many programs on a Dask cluster, with the same rows as `iiwasim.batches`.

Workers need the same version of iiwasim, and only the files of robot profiles that programs name:
the caller reads the source, sends chunks of programs to the workers, and writes the figures.
Needs Dask: `pip install 'iiwasim[dask]'`. The examples need a cluster: an existing
`distributed.Client`.

While a cluster has no workers, `plan` and `figures` wait, like every Dask computation. If the
scheduler was started with the setting `distributed.scheduler.no-workers-timeout`, they raise the
error of Dask after that time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._chunks import Planning
from ._errors import IiwasimError
from ._mapping import Planned, to_folder, to_table
from ._sources import Source, check, of_path, of_programs

try:
    import dask.dataframe as dd
    import distributed
    import pandas as pd
except ImportError as error:
    raise ImportError("iiwasim.dask needs Dask: pip install 'iiwasim[dask]'") from error

import pyarrow as pa

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator
    from os import PathLike

    from typing_extensions import Unpack

    from ._chunks import Options
    from ._native import Program

__all__ = ["figures", "mapped", "plan"]


def plan(
    source: str | PathLike[str] | dd.DataFrame,
    target: str | PathLike[str],
    *,
    column: str = "program",
    chunk: int = 500,
    client: distributed.Client | None = None,
    progress: Callable[[int, int], object] | None = None,
    **options: Unpack[Options],
) -> Planned:
    """Plans all programs of a file or a Dask data frame, and writes their figures to Parquet files.

    Works like `iiwasim.batches.plan`, on all threads of the cluster of `client`, by default the
    client that was created last. Each chunk is a future: if its worker dies, the scheduler retries
    it on another one. The partitions of a data frame are computed twice, one after the other; its
    index is left out.

    >>> import iiwasim.dask
    >>> iiwasim.dask.plan("programs.jsonl", "figures").rows
    600
    """
    planning = Planning(column, options)
    client = _client(client)
    origin = (
        _of_frame(source, column, client)
        if isinstance(source, dd.DataFrame)
        else of_path(source, column)
    )
    return to_folder(origin, target, chunk, planning, _Futures(client), progress)


def figures(
    programs: Iterable[Program | str],
    *,
    client: distributed.Client | None = None,
    **options: Unpack[Options],
) -> pa.Table:
    """Figures of programs in memory, in their order, like `iiwasim.batches.figures`.

    >>> import iiwasim as iw
    >>> import iiwasim.dask
    >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6)], start_deg=[0] * 7)
    >>> round(iiwasim.dask.figures([program])["cycle_time_s"][0].as_py(), 3)
    0.696
    """
    planning = Planning("program", options)
    return to_table(of_programs(programs, planning), planning, _Futures(_client(client)))


def mapped(
    frame: dd.DataFrame, *, column: str = "program", **options: Unpack[Options]
) -> dd.DataFrame:
    """The data frame with figures in place of the programs in `column`, computed lazily.

    Index and order are kept. The options are the options of `plan`; the columns of figures have
    Arrow types.

    >>> import iiwasim as iw
    >>> import iiwasim.dask, dask.dataframe, pandas
    >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6)], start_deg=[0] * 7)
    >>> programs = pandas.DataFrame({"name": ["a"], "program": [program.to_json()]})
    >>> result = iiwasim.dask.mapped(dask.dataframe.from_pandas(programs, npartitions=1)).compute()
    >>> result["name"][0], round(result["cycle_time_s"][0], 3)
    ('a', 0.696)
    """
    planning = Planning(column, options)
    if column not in frame.columns:
        raise IiwasimError(
            f"the data frame has no column {column!r}; it has {', '.join(frame.columns)}: give "
            "`column`"
        )
    return frame.map_partitions(_partition, planning, meta=_partition(frame._meta, planning))


def _partition(frame: pd.DataFrame, planning: Planning) -> pd.DataFrame:
    programs = pa.table(
        {planning.column: pa.array(frame[planning.column], pa.string(), from_pandas=True)}
    )
    # Arrow types can represent missing integers.
    figures = planning.figures(programs).to_pandas(types_mapper=pd.ArrowDtype)
    return frame.drop(columns=planning.column).join(figures.set_index(frame.index))


def _of_frame(frame: dd.DataFrame, column: str, client: distributed.Client) -> Source:
    def read() -> Iterator[pa.RecordBatch]:
        schema = None
        for place in range(frame.npartitions):
            rows = client.compute(frame.partitions[place]).result()
            table = pa.Table.from_pandas(rows, schema=schema, preserve_index=False)
            if schema is None:
                check("the data frame", table.schema, column)
                schema = table.schema
            yield from table.to_batches()

    return Source(
        "the data frame", lambda: pa.Schema.from_pandas(frame._meta, preserve_index=False), read
    )


def _client(client: distributed.Client | None) -> distributed.Client:
    try:
        return client or distributed.default_client()
    except ValueError as error:
        raise IiwasimError(
            "there is no cluster: make a `distributed.Client`, or give one as `client`"
        ) from error


class _Futures:
    """Dask futures; each worker thread computes one at a time."""

    def __init__(self, client: distributed.Client) -> None:
        self._client = client

    def limit(self) -> int:
        # Read at each call, as clusters grow.
        threads: dict[str, int] = self._client.nthreads()
        return 2 * sum(threads.values())

    def start(self, planning: Planning, chunk: pa.Table) -> Any:
        return self._client.submit(planning.figures, chunk, pure=False)

    def ended(self, tasks: Collection[Any]) -> Collection[Any]:
        ended: set[Any] = distributed.wait(tasks, return_when="FIRST_COMPLETED").done
        return ended

    def figures(self, task: Any) -> pa.Table:
        try:
            return task.result()
        except distributed.KilledWorker as error:
            raise RuntimeError(
                f"one worker after the other died of it; is there enough memory? {error}"
            ) from error

    def cancel(self, tasks: Collection[Any]) -> None:
        if tasks:
            self._client.cancel(list(tasks))
