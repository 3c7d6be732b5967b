"""Figures of many programs, from file to file, on the cores of this machine.

`iiwasim.ray` and `iiwasim.dask` do the same on many machines, with the same arguments and the same
rows. Needs pyarrow: `pip install 'iiwasim[batches]'`.

>>> import tempfile, pathlib
>>> import iiwasim as iw
>>> from iiwasim import batches
>>> folder = pathlib.Path(tempfile.mkdtemp())
>>> programs = [iw.Program([iw.ptp(deg=[a] + [0] * 6)], start_deg=[0] * 7) for a in (10, 20, 700)]
>>> source = folder / "programs.jsonl"
>>> _ = source.write_text("\\n".join(program.to_json() for program in programs))
>>> batches.plan(source, folder / "figures").rows
3
>>> figures = batches.read(folder / "figures")
>>> [round(time_s, 3) for time_s in figures["cycle_time_s"].to_pylist()[:2]]
[0.493, 0.6]
>>> figures["error"].to_pylist()[2]
'motion 1: ...'

The columns of figures:

| column | |
|---|---|
| `row` | row index in the source, from 0; blank lines do not count |
| columns of the source | without the program column |
| `cycle_time_s`, `motion_time_s`, `settle_time_s`, `wait_time_s` | in s; the first is the sum of the others |
| `motions` | number of motions |
| `limited_joint`, `limited_by` | limit that is active for the longest time; no joint for TCP limits |
| `peak_torque_percent`, `peak_torque_joint` | peak torque as a share of its limit, over all joints |
| `clearance_m`, `clearance_obstacle` | minimum clearance of the robot, if there is a `scene` |
| `error` | reason for missing figures; else null |
"""

from __future__ import annotations

import os
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, ThreadPoolExecutor, wait
from threading import Event
from typing import TYPE_CHECKING

from ._chunks import Options, Planning, count
from ._mapping import Planned, to_folder, to_table
from ._parts import read
from ._sources import of_path, of_programs

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable
    from os import PathLike

    import pyarrow as pa
    from typing_extensions import Self, TypeAlias, Unpack

    from ._native import Program

    _Task: TypeAlias = Future[pa.Table]

__all__ = ["Options", "Planned", "figures", "plan", "read"]

# On Windows, Ctrl-C takes effect only at the end of a wait.
WAIT_S = 0.1


def plan(
    source: str | PathLike[str],
    target: str | PathLike[str],
    *,
    column: str = "program",
    chunk: int = 500,
    jobs: int | None = None,
    progress: Callable[[int, int], object] | None = None,
    **options: Unpack[Options],
) -> Planned:
    """Plans all programs of a file, and writes their figures to a folder of Parquet files.

    `source` is a file of JSON lines (one program per line, blank lines are ignored), or a Parquet
    file or folder with the programs, as JSON, in `column`. A program that cannot be planned has its
    error in its row. The folder gets one part per `chunk` rows, and each part is written
    atomically; the parts, read in the order of their names, have the rows in the order of the
    source. A call that resumes after an interrupt plans the missing parts only. Only one call at a
    time may write to a folder.

    `jobs` is the number of threads, by default the number of cores. `progress(rows_done, rows)` is
    called after each part. Further options are the options of `plan_all`, and `scene`. Raises
    `IiwasimError` if the source cannot be read, or the folder has figures of other programs or
    options.

    >>> import tempfile, pathlib
    >>> import iiwasim as iw
    >>> from iiwasim import batches
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6)], start_deg=[0] * 7)
    >>> source, target = folder / "programs.jsonl", folder / "figures"
    >>> _ = source.write_text(program.to_json())
    >>> batches.plan(source, target, timing="acceleration").rows_planned
    1
    >>> batches.plan(source, target, timing="acceleration").rows_planned
    0
    >>> batches.plan(source, target)
    Traceback (most recent call last):
        ...
    iiwasim._errors.IiwasimError: ... `timing` is 'acceleration' there, 'sunrise' here. ...
    """
    planning = Planning(column, options)
    with _Threads(jobs) as workers:
        return to_folder(of_path(source, column), target, chunk, planning, workers, progress)


def figures(
    programs: Iterable[Program | str], *, jobs: int | None = None, **options: Unpack[Options]
) -> pa.Table:
    """Figures of programs in memory, in their order: for example, of the candidates of an
    optimiser.

    A text that is not a valid program has its error in its row. The options are the options of
    `plan`.

    >>> import iiwasim as iw
    >>> from iiwasim import batches
    >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6)], start_deg=[0] * 7)
    >>> table = batches.figures([program, "nonsense"], scene="fixtures/cage.json")
    >>> round(table["cycle_time_s"][0].as_py(), 3), table["clearance_obstacle"][0].as_py()
    (0.696, 'column')
    >>> table["error"].to_pylist()
    [None, 'this is not JSON: ..., at line 1, column 1']
    """
    planning = Planning("program", options)
    source = of_programs(programs, planning)
    with _Threads(jobs) as workers:
        return to_table(source, planning, workers)


class _Threads:
    """Threads of this process: planning releases the interpreter lock."""

    def __init__(self, jobs: int | None) -> None:
        cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
        self._jobs = (cores or 1) if jobs is None else count("jobs", jobs)
        self._pool = ThreadPoolExecutor(self._jobs, thread_name_prefix="iiwasim")
        self._has_ended = Event()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        # After Ctrl-C, results are not needed any more: running chunks end at the next look.
        self._has_ended.set()
        self._pool.shutdown(cancel_futures=True)

    def limit(self) -> int:
        return 2 * self._jobs

    def start(self, planning: Planning, chunk: pa.Table) -> _Task:
        return self._pool.submit(planning.figures, chunk, self._look)

    def _look(self) -> None:
        if self._has_ended.is_set():
            raise CancelledError

    def ended(self, tasks: Collection[_Task]) -> Collection[_Task]:
        while not (done := wait(tasks, timeout=WAIT_S, return_when=FIRST_COMPLETED).done):
            pass
        return done

    def figures(self, task: _Task) -> pa.Table:
        return task.result()

    def cancel(self, tasks: Collection[_Task]) -> None:
        for task in tasks:
            task.cancel()
