"""Conversion of Python values, including NumPy numbers, to JSON."""

from __future__ import annotations

import json
from typing import Any

from ._errors import ProgramError


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):
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
    for number, motion in enumerate(program["motions"], 1):
        try:
            dumps(motion)
        except ValueError as error:
            raise ProgramError(f"motion {number} {error}", None, None, number) from None
    return dumps(program)
