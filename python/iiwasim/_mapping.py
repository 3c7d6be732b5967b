"""Chunks of programs to figures, on whatever workers there are."""

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
    """What plans chunks: threads of this process, or processes here and elsewhere."""

    def limit(self) -> int:
        """How many chunks they may be given at once: enough to keep all of them busy."""

    def start(self, planning: Planning, chunk: pa.Table) -> Task:
        """Has a chunk planned by any of them. If it dies, another one does it."""

    def ended(self, tasks: Collection[Task]) -> Iterable[Task]:
        """Waits for at least one."""

    def figures(self, task: Task) -> pa.Table:
        """The result of one that has ended. Raises `RuntimeError` if one worker after the other died of it."""

    def cancel(self, tasks: Collection[Task]) -> None:
        """They are of no use any more."""


class Planned(NamedTuple):
    """What became of a source of programs.

    >>> from iiwasim import batches
    >>> planned = batches.Planned("figures", rows=600, rows_planned=450)
    >>> planned.rows - planned.rows_planned
    150
    """

    folder: Path
    """Where the figures are; `iiwasim.batches.read` reads them."""
    rows: int
    """Number of programs."""
    rows_planned: int
    """Number of those that were planned now; the others' figures were there."""


def to_folder(
    source: Source,
    target: str | PathLike[str],
    size: int,
    planning: Planning,
    workers: Workers[Task],
    progress: Callable[[int, int], object] | None,
) -> Planned:
    """Figures of all rows, in parts of `size` rows."""
    size = count("chunk", size)
    if progress is not None and not callable(progress):
        raise TypeError(f"progress is {progress!r}; a function of two numbers is expected")
    # Read twice: nothing is written into a folder of other programs.
    before, now = Extent(), Extent()
    for _ in before.of(chunks(source, size)):
        pass
    rows = before.rows
    plan = {"chunk": size, "rows": rows, "programs": before.sha256()}
    # A source without programs has a part, too, with the columns.
    folder = Folder(target, {**plan, **planning.described()}, -(-rows // size) or 1)
    missing = set(folder.missing())
    # The last part may be a short one.
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
    """Figures of rows in memory."""
    rows = sum(batch.num_rows for batch in source.read())
    if not rows:
        return FIGURES.insert(0, pa.field(ROW, pa.int64())).empty_table()
    size = max(1, -(-rows // max(1, workers.limit())))
    parts = dict(_mapped(enumerate(chunks(source, size)), planning, workers))
    return pa.concat_tables(parts[index] for index in range(len(parts)))


def _mapped(
    work: Iterable[tuple[int, pa.Table]], planning: Planning, workers: Workers[Task]
) -> Iterator[tuple[int, pa.Table]]:
    """Figures of chunks with their places, as they come."""
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
