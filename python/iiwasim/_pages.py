"""HTML pages of plans."""

from __future__ import annotations

import html
import os
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from ._native import page
from ._recordings import recording_of

if TYPE_CHECKING:
    from ._native import Plan, Recording, Scene


def report(
    plan: Plan,
    path: str | os.PathLike[str] | None,
    *,
    measured: Recording | str | os.PathLike[str] | None = None,
    scene: Scene | None = None,
) -> str:
    """The page of a plan, which is also written to `path` if given."""
    with tempfile.TemporaryDirectory() as folder:
        # The title of a page is the name of its file.
        file = Path(folder, "Plan")
        plan.write(file)
        recorded: str | os.PathLike[str] | None = None
        if isinstance(measured, (str, os.PathLike)):
            # A file that cannot be opened raises the `OSError` of the system.
            with open(measured, "rb"):
                recorded = measured
        elif measured is not None:
            recorded = _written(plan, measured, folder)
        text = page(file, recorded, scene)
    if path is not None:
        # Atomic write.
        part = Path(f"{os.fspath(path)}.part")
        try:
            part.write_text(text, encoding="utf-8")
            part.replace(path)
        except BaseException as error:
            with suppress(OSError):
                part.unlink()
            if isinstance(error, OSError):
                raise OSError(error.errno, error.strerror, os.fspath(path)) from None
            raise
    return text


def _written(plan: Plan, measured: Recording, folder: str) -> Path:
    """Writes a recording in memory as the CSV table that pages read."""
    recording = recording_of(measured)
    file = Path(folder, "recording")
    head = ",".join(["t_s", *(f"joint_{joint}_rad" for joint in range(1, 8))])
    rows = (
        ",".join(repr(float(value)) for value in (t, *q)) for t, q in zip(recording.t, recording.q)
    )
    file.write_text("\n".join([head, *rows, ""]), encoding="utf-8")
    return file


def notebook(plan: Plan) -> str:
    """The figures and the page as HTML, for a notebook."""
    page_of_plan = html.escape(report(plan, None), quote=True)
    return (
        f"<pre>{html.escape(plan.table())}</pre>"
        f'<iframe srcdoc="{page_of_plan}" style="width: 100%; height: 860px; border: 1px solid '
        f'#ccc"></iframe>'
    )
