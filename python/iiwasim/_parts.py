"""Folders of figures: one Parquet file per chunk, and a description of their input."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pyarrow as pa
import pyarrow.parquet as pq

from ._errors import IiwasimError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from os import PathLike
    from typing import BinaryIO

# Parquet readers ignore file names that begin with an underscore.
PLAN = "_plan.json"


class Folder:
    """A folder of parts in the order of their names.

    Each part is written atomically, so that existing parts need not be planned again.
    """

    def __init__(self, path: str | PathLike[str], plan: Mapping[str, Any], parts: int) -> None:
        """Creates the folder, or resumes an existing one.

        Raises `IiwasimError` if the folder has figures of another plan, or other files.
        """
        self.path = Path(path)
        self._width = max(5, len(str(parts)))
        self._parts = parts
        # Serialised first: an error here must not leave an empty folder.
        text = json.dumps(plan, indent=2)
        self.path.mkdir(parents=True, exist_ok=True)
        if (self.path / PLAN).exists():
            self._check(plan)
        elif any(not name.startswith(".") for name in os.listdir(self.path)):
            raise IiwasimError(
                f"{self.path} has files in it that are no figures; give a new folder"
            )
        else:
            self._write(PLAN, lambda file: file.write(text.encode()))

    def missing(self) -> list[int]:
        """Indices of the missing parts."""
        return [
            index for index in range(self._parts) if not (self.path / self._name(index)).exists()
        ]

    def write(self, index: int, figures: pa.Table) -> None:
        self._write(self._name(index), lambda file: pq.write_table(figures, file))

    def _check(self, plan: Mapping[str, Any]) -> None:
        known = _known(self.path)
        other = [name for name in {**known, **plan} if known.get(name) != plan.get(name)]
        if other:
            said = "; ".join(
                f"`{name}` is {known.get(name)!r} there, {plan.get(name)!r} here" for name in other
            )
            raise IiwasimError(
                f"{self.path} has figures of another plan: {said}. Give a new folder"
            )

    def _name(self, index: int) -> str:
        return f"part-{index:0{self._width}}.parquet"

    def _write(self, name: str, write: Callable[[BinaryIO], object]) -> None:
        beside = self.path / f".{name}"
        with beside.open("wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        beside.replace(self.path / name)


def read(folder: str | PathLike[str]) -> pa.Table:
    """The figures in a folder, in the order of the programs.

    Raises `IiwasimError` if figures are missing.

    >>> import tempfile
    >>> from iiwasim import batches
    >>> batches.read(tempfile.mkdtemp())
    Traceback (most recent call last):
        ...
    iiwasim._errors.IiwasimError: ... has no figures
    """
    parts = sorted(Path(folder).glob("part-*.parquet"))
    if not parts:
        raise IiwasimError(f"{folder} has no figures")
    figures = pa.concat_tables(pq.read_table(part) for part in parts)
    rows = _known(Path(folder)).get("rows")
    if figures.num_rows != rows:
        raise IiwasimError(
            f"{folder} has figures of {figures.num_rows} of {rows} programs; plan them again for "
            "the others"
        )
    return figures


def _known(folder: Path) -> dict[str, Any]:
    """The description of the programs and options from which the parts were planned."""
    try:
        return dict(json.loads((folder / PLAN).read_text()))
    except (OSError, ValueError, TypeError) as error:
        raise IiwasimError(
            f"{folder / PLAN} is not as it was written: {error}; give a new folder"
        ) from error
