"""Conversion of Python values, including NumPy numbers and poses (4, 4), to JSON."""

from __future__ import annotations

import json
from operator import index
from typing import Any

from ._errors import ProgramError

# Deepest nesting of repeat blocks.
_MAX_DEPTH = 8


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):
        if getattr(value, "shape", None) == (4, 4):
            from ._native import frame

            return frame(value)
        return value.tolist()
    if hasattr(value, "keys"):
        return dict(value)
    raise TypeError(f"{value!r} is not a number, text, list or dict")


def dumps(value: Any) -> str:
    """The JSON of a value."""
    try:
        return json.dumps(value, allow_nan=False, default=_plain)
    except ValueError:
        pass
    try:
        # With non-finite numbers allowed, only a list or dict that contains itself still fails.
        json.dumps(value, default=_plain)
    except ValueError:
        raise ValueError("contains a list or dict that contains itself") from None
    raise ValueError("contains a value that is not finite")


def program(program: dict[str, Any]) -> str:
    """The JSON of a program."""
    _check(program["motions"], 1, 0)
    return dumps(program)


def _check(motions: Any, number: int, depth: int) -> None:
    """Raise the error of the first motion without JSON. The first of the motions has a number."""
    for motion in motions:
        try:
            dumps(motion)
        except ValueError as error:
            # Blocks that contain themselves have no end.
            if depth < _MAX_DEPTH and _is_block(motion):
                _check(motion["motions"], number, depth + 1)
            raise ProgramError(f"motion {number} {error}", None, None, number) from None
        number += _length(motion)


def _is_block(motion: Any) -> bool:
    is_repeat = isinstance(motion, dict) and motion.get("type") == "repeat"
    return is_repeat and isinstance(motion.get("motions"), (list, tuple))


def _length(motion: Any) -> int:
    """The number of motions of an entry, with those of all rounds."""
    if not _is_block(motion):
        return 1
    try:
        count = index(motion.get("count"))
    except TypeError:
        return 1
    return count * sum(map(_length, motion["motions"]))
