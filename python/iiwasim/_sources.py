"""Sources of programs, which are read in chunks of equal size."""

from __future__ import annotations

import hashlib
import os
from codecs import BOM_UTF8
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import pyarrow as pa
import pyarrow.dataset as ds

from ._chunks import FIGURES
from ._errors import IiwasimError
from ._native import Program

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from ._chunks import Planning

ROW = "row"
"""The column with the row index in the source, from 0."""

PARQUET = (".parquet", ".pq")
LINES = (".jsonl", ".ndjson")
READ_ROWS = 4096


class Source(NamedTuple):
    """Rows that can be read more than once, each time in the same order."""

    name: str
    """Name of the source in messages."""
    schema: Callable[[], pa.Schema]
    """Returns the columns, also of a source without rows."""
    read: Callable[[], Iterator[pa.RecordBatch]]
    """Reads the rows, from the first one at each call."""


class Extent:
    """Row count and checksum of a source, updated while the source is read."""

    def __init__(self) -> None:
        self.rows = 0
        self._digest = hashlib.sha256()

    def of(self, tables: Iterable[pa.Table]) -> Iterator[pa.Table]:
        """Passes the tables on, and counts their rows."""
        for table in tables:
            self.rows += table.num_rows
            self._digest.update(repr(table.to_pydict()).encode())
            yield table

    def sha256(self) -> str:
        return self._digest.hexdigest()


def of_path(path: str | os.PathLike[str], column: str) -> Source:
    """A source of JSON lines (one program per line, blank lines are ignored), a Parquet file, or a
    folder of Parquet files.
    """
    if isinstance(path, str) and path.lstrip()[:1] in ("{", "[") and not os.path.exists(path):
        raise IiwasimError(
            "the source is a JSON text; `plan` takes the path of a file, and `figures` programs in "
            "memory"
        )
    if not isinstance(path, (str, os.PathLike)):
        found = type(path).__name__
        raise TypeError(
            f"the source is a {found}; `plan` takes the path of a file, and `figures` programs in "
            "memory"
        )
    path = Path(path)
    if not path.exists():
        raise IiwasimError(f"there is no {path}")
    if path.suffix in LINES:
        return Source(
            str(path), lambda: pa.schema({column: pa.string()}), lambda: _lines(path, column)
        )
    if path.suffix not in PARQUET and not path.is_dir():
        known = (
            f"Parquet ({', '.join(PARQUET)}, or a folder of them) nor JSON lines "
            f"({', '.join(LINES)})"
        )
        raise IiwasimError(f"{path} is neither {known}")
    try:
        # The files of a folder are read in the order of their names.
        dataset = ds.dataset(path, format="parquet")
        check(str(path), dataset.schema, column)
    except (pa.ArrowInvalid, OSError) as error:
        raise IiwasimError(f"cannot read {path}: {error}") from error
    return Source(
        str(path), lambda: dataset.schema, lambda: dataset.to_batches(batch_size=READ_ROWS)
    )


def of_programs(programs: Iterable[Program | str], planning: Planning) -> Source:
    """A source of programs in memory."""
    # These types are iterable or path-like, but their items are not programs.
    if isinstance(programs, (str, bytes, Program, Mapping, os.PathLike)):
        found = type(programs).__name__
        expected = "a list of iiwasim.Program or of JSON texts is expected, [program] for one"
        raise TypeError(f"the programs are a {found}; {expected}, and `plan` takes files")
    texts = []
    for index, program in enumerate(programs):
        text = program.to_json() if isinstance(program, Program) else program
        if not isinstance(text, str):
            raise TypeError(f"programs[{index}] is not an iiwasim.Program and no text: {program!r}")
        texts.append(text)
        # The text only names the robot; a custom robot profile of the program would be lost.
        if planning.options["robot"] is None and _loses_robot(program, text):
            raise ValueError(
                f"programs[{index}] is for a robot with a profile of its own; give `robot`"
            )
    table = pa.table({planning.column: pa.array(texts, pa.string())})
    return Source("the programs", lambda: table.schema, lambda: iter(table.to_batches()))


def check(name: str, schema: pa.Schema, column: str) -> None:
    """Raises `IiwasimError` without a program column, or if a column has the name of a figure."""
    if column not in schema.names:
        raise IiwasimError(
            f"{name} has no column {column!r}; it has {', '.join(schema.names)}: give `column`"
        )
    kind = schema.field(column).type
    if not (
        pa.types.is_string(kind) or pa.types.is_large_string(kind) or pa.types.is_string_view(kind)
    ):
        raise IiwasimError(f"the column {column!r} of {name} has {kind}; programs are JSON texts")
    for taken in (ROW, *FIGURES.names):
        if taken != column and taken in schema.names:
            raise IiwasimError(f"{name} has a column {taken!r}, as figures have; rename or drop it")


def chunks(source: Source, size: int) -> Iterator[pa.Table]:
    """Tables of `size` rows with the column `ROW`; the last table may be shorter.

    A source without rows gives one empty table with the columns.
    """
    row = 0
    for batches in _regrouped(source.read(), size):
        table = pa.Table.from_batches(batches).combine_chunks()
        yield table.add_column(0, ROW, pa.array(range(row, row + table.num_rows), pa.int64()))
        row += table.num_rows
    if not row:
        yield source.schema().empty_table().add_column(0, ROW, pa.array([], pa.int64()))


def _loses_robot(program: Program | str, text: str) -> bool:
    return isinstance(program, Program) and Program.from_json(text).robot != program.robot


def _lines(path: Path, column: str) -> Iterator[pa.RecordBatch]:
    with path.open("rb") as file:
        # Some Windows programs write a byte order mark.
        if file.read(len(BOM_UTF8)) != BOM_UTF8:
            file.seek(0)
        while lines := file.readlines(1 << 20):
            # Invalid UTF-8 becomes invalid JSON, which is an error of its row.
            texts = [line.decode(errors="backslashreplace") for line in lines if not line.isspace()]
            yield pa.record_batch({column: pa.array(texts, pa.string())})


def _regrouped(batches: Iterable[pa.RecordBatch], size: int) -> Iterator[list[pa.RecordBatch]]:
    group: list[pa.RecordBatch] = []
    missing = size
    for batch in batches:
        while batch.num_rows:
            taken = batch.slice(0, missing)
            batch = batch.slice(taken.num_rows)
            group.append(taken)
            missing -= taken.num_rows
            if not missing:
                yield group
                group, missing = [], size
    if group:
        yield group
