"""Data frames of sampled plans, with the columns of `iiwasim plan --csv`."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    import polars as pl
    from numpy.typing import NDArray

    from ._native import Plan


def columns(plan: Plan, rate_hz: float) -> dict[str, NDArray[np.float64]]:
    """The columns by name."""
    samples = plan.sample(rate_hz=rate_hz)
    table = {"t_s": samples.t}
    for name, values in (
        ("joint_{}_rad", samples.q),
        ("joint_{}_rad_s", samples.dq),
        ("joint_{}_rad_s2", samples.ddq),
    ):
        table.update({name.format(joint + 1): values[:, joint] for joint in range(7)})
    table.update({f"tcp_{axis}_m": samples.tcp[:, place] for place, axis in enumerate("xyz")})
    table.update({f"torque_{joint + 1}_nm": samples.torque[:, joint] for joint in range(7)})
    return table


def pandas(plan: Plan, rate_hz: float) -> pd.DataFrame:
    """A pandas data frame."""
    try:
        import pandas as pd
    except ImportError as error:
        raise ImportError("to_pandas needs pandas: pip install 'iiwasim[pandas]'") from error
    return pd.DataFrame(columns(plan, rate_hz))


def polars(plan: Plan, rate_hz: float) -> pl.DataFrame:
    """A polars data frame."""
    try:
        import polars as pl
    except ImportError as error:
        raise ImportError("to_polars needs polars: pip install 'iiwasim[polars]'") from error
    return pl.DataFrame(columns(plan, rate_hz))
