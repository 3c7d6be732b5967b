"""Types of options and arguments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, Union

import numpy as np
import numpy.typing as npt

Timing = Literal["sunrise", "jerk", "acceleration"]
Shape = Literal["iiwa", "alpha", "min-acceleration", "circle"]
Free = Literal["e1", "blends", "speeds"]
Search = Literal["first-crossing", "algorithm-1", "algorithm-2"]

Numbers = Union[Sequence[float], npt.NDArray[np.floating[Any]], npt.NDArray[np.integer[Any]]]
"""A list of numbers, or an array (n,)."""

Frame = Union[str, Mapping[str, Any], npt.NDArray[np.floating[Any]]]
"""A frame: its name, a dict with the keys of programs, or a pose (4, 4)."""
