"""Distribution of chunks of programs to any kind of workers, which return figures."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol, TypeVar

import pyarrow as pa

from ._chunks import FIGURES, count
from ._errors import IiwasimError
from ._parts import Folder
from ._sources import ROW, Extent, Source, chunks

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator
    from os import PathLike
    from pathlib import Path

    from ._chunks import Planning

Task = TypeVar("Task")


class Workers(Protocol[Task]):
    """Workers that plan chunks: threads of this process, or processes on any machine."""

    def limit(self) -> int:
        """Maximum number of chunks in progress: enough to keep all workers busy."""

    def start(self, planning: Planning, chunk: pa.Table) -> Task:
        """Starts the planning of a chunk on any worker; another worker retries if it dies."""

    def ended(self, tasks: Collection[Task]) -> Iterable[Task]:
        """Waits for at least one task and returns the tasks that have ended."""

    def figures(self, task: Task) -> pa.Table:
        """The result of a task that has ended. Raises `RuntimeError` if every attempt failed
        because its worker died.
        """

    def cancel(self, tasks: Collection[Task]) -> None:
        """Cancels tasks whose results are not needed any more."""


class Planned(NamedTuple):
    """The result of planning a source of programs.

    >>> from iiwasim import batches
    >>> planned = batches.Planned("figures", rows=600, rows_planned=450)
    >>> planned.rows - planned.rows_planned
    150
    """

    folder: Path
    """The folder with the figures; `iiwasim.batches.read` reads them."""
    rows: int
    """Number of programs."""
    rows_planned: int
    """Number of programs planned in this call; the figures of the others existed already."""


def to_folder(
    source: Source,
    target: str | PathLike[str],
    size: int,
    planning: Planning,
    workers: Workers[Task],
    progress: Callable[[int, int], object] | None,
) -> Planned:
    """Writes the figures of all rows to a folder, in parts of `size` rows."""
    size = count("chunk", size)
    if progress is not None and not callable(progress):
        raise TypeError(f"progress is {progress!r}; a function of two numbers is expected")
    # The source is read twice, so that a folder with figures of other programs stays untouched.
    before, now = Extent(), Extent()
    for _ in before.of(chunks(source, size)):
        pass
    rows = before.rows
    plan = {"chunk": size, "rows": rows, "programs": before.sha256()}
    # A source without programs also gets a part, which has the columns.
    folder = Folder(target, {**plan, **planning.described()}, -(-rows // size) or 1)
    missing = set(folder.missing())
    # The last part may be shorter.
    rows_missing = sum(min(size, rows - index * size) for index in missing)
    done = rows - rows_missing
    work = (
        (index, chunk)
        for index, chunk in enumerate(now.of(chunks(source, size)))
        if index in missing
    )
    for index, figures in _mapped(work, planning, workers):
        folder.write(index, figures)
        done += figures.num_rows
        if progress is not None and rows:
            progress(done, rows)
    if now.sha256() != before.sha256():
        raise IiwasimError(
            f"{source.name} changed while it was planned; delete {folder.path} and plan it again"
        )
    return Planned(folder.path, rows, rows_missing)


def to_table(source: Source, planning: Planning, workers: Workers[Task]) -> pa.Table:
    """The figures of all rows, as a table in memory."""
    rows = sum(batch.num_rows for batch in source.read())
    if not rows:
        return FIGURES.insert(0, pa.field(ROW, pa.int64())).empty_table()
    size = max(1, -(-rows // max(1, workers.limit())))
    parts = dict(_mapped(enumerate(chunks(source, size)), planning, workers))
    return pa.concat_tables(parts[index] for index in range(len(parts)))


def _mapped(
    work: Iterable[tuple[int, pa.Table]], planning: Planning, workers: Workers[Task]
) -> Iterator[tuple[int, pa.Table]]:
    """Figures of chunks with their positions in the source, in order of completion."""
    places: dict[Task, int] = {}

    def ended() -> Iterator[tuple[int, pa.Table]]:
        for task in workers.ended(list(places)):
            place = places.pop(task)
            try:
                figures = workers.figures(task)
            except RuntimeError as error:
                raise RuntimeError(f"chunk {place} of the programs: {error}") from error
            yield place, figures

    try:
        for place, chunk in work:
            while len(places) >= max(1, workers.limit()):
                yield from ended()
            places[workers.start(planning, chunk)] = place
        while places:
            yield from ended()
    finally:
        workers.cancel(list(places))
