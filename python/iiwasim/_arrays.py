"""Arrays from callers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt


def check_real(name: str, values: Any) -> None:
    """Refuses masked values and complex numbers, also within lists.

    NumPy would ignore the masks of arrays, and drop imaginary parts.
    """
    if isinstance(values, (list, tuple)):
        for part in values:
            # Most parts are numbers.
            if not isinstance(part, (float, int)):
                check_real(name, part)
    elif np.ma.is_masked(values):
        raise TypeError(f"{name} has masked values; fill them or leave them out")
    elif np.iscomplexobj(values):
        raise TypeError(f"{name} has complex numbers; real numbers are expected")


def real_array(name: str, values: Any) -> npt.NDArray[np.float64]:
    """Converts to an array of real numbers."""
    check_real(name, values)
    return np.asarray(values, dtype=np.float64)
