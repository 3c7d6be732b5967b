"""Where programs come from, in chunks of equal size."""

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
"""The column with the place in the source, from 0."""

PARQUET = (".parquet", ".pq")
LINES = (".jsonl", ".ndjson")
READ_ROWS = 4096


class Source(NamedTuple):
    """Rows that can be read more than once, each time in the same order."""

    name: str
    """For messages."""
    schema: Callable[[], pa.Schema]
    """Its columns, also where it has no rows."""
    read: Callable[[], Iterator[pa.RecordBatch]]
    """Begins anew."""


class Extent:
    """What the rows of a source come to, as they are read."""

    def __init__(self) -> None:
        self.rows = 0
        self._digest = hashlib.sha256()

    def of(self, tables: Iterable[pa.Table]) -> Iterator[pa.Table]:
        """The tables, counted as they pass."""
        for table in tables:
            self.rows += table.num_rows
            self._digest.update(repr(table.to_pydict()).encode())
            yield table

    def sha256(self) -> str:
        return self._digest.hexdigest()


def of_path(path: str | os.PathLike[str], column: str) -> Source:
    """A file of JSON lines, one program a line, blank ones aside; or of Parquet, or a folder of such files."""
    if isinstance(path, str) and path.lstrip()[:1] in ("{", "[") and not os.path.exists(path):
        raise IiwasimError(
            "the source is a JSON text; `plan` takes the path of a file, and `figures` programs in memory"
        )
    if not isinstance(path, (str, os.PathLike)):
        found = type(path).__name__
        raise TypeError(
            f"the source is a {found}; `plan` takes the path of a file, and `figures` programs in memory"
        )
    path = Path(path)
    if not path.exists():
        raise IiwasimError(f"there is no {path}")
    if path.suffix in LINES:
        return Source(
            str(path), lambda: pa.schema({column: pa.string()}), lambda: _lines(path, column)
        )
    if path.suffix not in PARQUET and not path.is_dir():
        known = f"Parquet ({', '.join(PARQUET)}, or a folder of them) nor JSON lines ({', '.join(LINES)})"
        raise IiwasimError(f"{path} is neither {known}")
    try:
        # In a folder, in the order of the names.
        dataset = ds.dataset(path, format="parquet")
        check(str(path), dataset.schema, column)
    except (pa.ArrowInvalid, OSError) as error:
        raise IiwasimError(f"cannot read {path}: {error}") from error
    return Source(
        str(path), lambda: dataset.schema, lambda: dataset.to_batches(batch_size=READ_ROWS)
    )


def of_programs(programs: Iterable[Program | str], planning: Planning) -> Source:
    """Programs in memory."""
    # A text, a dict and a path have other things in them than programs.
    if isinstance(programs, (str, bytes, Program, Mapping, os.PathLike)):
        found = type(programs).__name__
        expected = "a list of iiwasim.Program or of JSON texts is expected, [program] for one"
        raise TypeError(f"the programs are a {found}; {expected}, and `plan` takes files")
    texts = []
    for index, program in enumerate(programs):
        text = program.to_json() if isinstance(program, Program) else program
        if not isinstance(text, str):
            raise TypeError(f"programs[{index}] is no iiwasim.Program and no text: {program!r}")
        texts.append(text)
        # The text names robots only; a profile of the program's own would be lost.
        if planning.options["robot"] is None and _loses_robot(program, text):
            raise ValueError(
                f"programs[{index}] is for a robot with a profile of its own; give `robot`"
            )
    table = pa.table({planning.column: pa.array(texts, pa.string())})
    return Source("the programs", lambda: table.schema, lambda: iter(table.to_batches()))


def check(name: str, schema: pa.Schema, column: str) -> None:
    """Whether the programs can be found, and figures put beside the other columns."""
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
    """Tables of `size` rows, the last of fewer, with the place of each row. Without rows, one with the columns."""
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
        # Some programs of Windows begin texts by a mark of their encoding.
        if file.read(len(BOM_UTF8)) != BOM_UTF8:
            file.seek(0)
        while lines := file.readlines(1 << 20):
            # Bytes that are no UTF-8 become what is no JSON: an error of their row.
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
