"""Matplotlib figures of plans and comparisons."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from ._native import Comparison, Plan

# The joint colours of the HTML pages.
COLOURS = ("#1b1f24", "#e69f00", "#56b4e9", "#009e73", "#cc79a7", "#0072b2", "#d55e00")
# Matplotlib backends that only draw into files.
WINDOWLESS = {"agg", "cairo", "pdf", "pgf", "ps", "svg", "template"}
# Least ranges of the axes, so that tiny TCP motions are not magnified further.
MIN_SPAN_MM = 10.0
MIN_SPEED_MM_S = 1.0
MIN_ROTATION_DEG = 1.0


# Colours of the planned and of the measured path.
PLANNED, MEASURED = "#1f5fa8", "#d55e00"


def plot(plan: Plan, rate_hz: float) -> Figure:
    """The TCP path in side and top view, the joint speeds as shares of their limits, and the TCP
    speed and rotation.
    """
    samples = plan.sample(rate_hz=rate_hz)
    figure = _figure("plot", (8, 8.6))
    parts = figure.subplot_mosaic(
        [["side", "top"], ["speeds", "speeds"], ["speed", "rotation"]], height_ratios=[4, 4, 3]
    )
    _path(parts["side"], 1e3 * samples.tcp, 0, 2)
    _path(parts["top"], 1e3 * samples.tcp, 0, 1)
    speeds = parts["speeds"]
    shares = 100 * np.abs(samples.dq) / plan.robot.velocity_limits_rad_s
    for joint, colour in enumerate(COLOURS):
        speeds.plot(samples.t, shares[:, joint], label=f"A{joint + 1}", color=colour, linewidth=1.2)
    speeds.set_ylabel("speed / % of the limit")
    speeds.set_ylim(0, 105)
    speeds.legend(
        ncols=7, fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False
    )
    parts["speed"].plot(samples.t, 1e3 * samples.tcp_speed, color=PLANNED, linewidth=1.2)
    parts["speed"].set_ylabel("TCP speed / mm/s")
    turned = np.degrees(rotation_angles(samples.tcp_pose[:, :3, :3]))
    parts["rotation"].plot(samples.t, turned, color=PLANNED, linewidth=1.2)
    parts["rotation"].set_ylabel("TCP rotation / deg")
    for name, least in (("speed", MIN_SPEED_MM_S), ("rotation", MIN_ROTATION_DEG)):
        parts[name].set_ylim(0, max(least, parts[name].get_ylim()[1]))
    for axes in (speeds, parts["speed"], parts["rotation"]):
        for motion in plan.motions[1:]:
            axes.axvline(motion.start_s, color="0.85", linewidth=0.8, zorder=0)
        axes.set_xlabel("t / s")
        axes.set_xlim(0, max(plan.cycle_time_s, 1e-3))
    figure.suptitle(f"Cycle time {plan.cycle_time_s:.3f} s")
    return _shown(figure)


def compared(comparison: Comparison) -> Figure:
    """The planned and the measured flange path in side and top view, and their deviations."""
    trace = comparison._trace()
    t, measured, planned = trace[:, 1], 1e3 * trace[:, 2:5], 1e3 * trace[:, 5:8]
    figure = _figure("plot", (8, 6.4))
    parts = figure.subplot_mosaic([["side", "top"], ["tcp", "joints"]])
    for name, up in (("side", 2), ("top", 1)):
        _path(parts[name], planned, 0, up, PLANNED, label="planned")
        _path(parts[name], measured, 0, up, MEASURED, label="measured")
    parts["side"].legend(
        ncols=2, fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False
    )
    parts["tcp"].plot(t, 1e3 * trace[:, 9], color=MEASURED, linewidth=1.2)
    parts["tcp"].set_ylabel("path deviation / mm")
    parts["joints"].plot(t, 1e3 * trace[:, 8], color=MEASURED, linewidth=1.2)
    parts["joints"].set_ylabel("joint deviation / mrad")
    for axes in (parts["tcp"], parts["joints"]):
        axes.set_xlabel("t / s")
        axes.set_ylim(bottom=0)
    figure.suptitle(
        f"Planned {comparison.planned_s:.3f} s, measured {comparison.measured_s:.3f} s: "
        f"{comparison.cycle_time_error_s:+.3f} s"
    )
    return _shown(figure)


def rotation_angles(rotations: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angles (n,) of rotations (n, 3, 3) relative to the first one, in rad."""
    relative = rotations[0].T @ rotations
    # The sine is accurate for small angles, the cosine for angles about 90 degrees.
    axis = np.stack(
        [
            relative[:, 2, 1] - relative[:, 1, 2],
            relative[:, 0, 2] - relative[:, 2, 0],
            relative[:, 1, 0] - relative[:, 0, 1],
        ]
    )
    cosine = np.trace(relative, axis1=1, axis2=2) - 1
    angles: NDArray[np.float64] = np.arctan2(np.linalg.norm(axis, axis=0), cosine)
    return angles


def _figure(method: str, size: tuple[float, float]) -> Figure:
    """An empty figure."""
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise ImportError(f"{method} needs matplotlib: pip install 'iiwasim[plot]'") from error
    return plt.figure(figsize=size, layout="constrained")


def _shown(figure: Figure) -> Figure:
    """The figure, closed if its backend has no windows."""
    import matplotlib as mpl
    import matplotlib.pyplot as plt

    backend = mpl.get_backend().lower()
    if backend in WINDOWLESS or "inline" in backend:
        # A figure without a window need not stay open; and a notebook would show an open figure
        # twice: as the result of the cell, and as an open figure.
        plt.close(figure)
    return figure


def _path(
    axes: Axes,
    tcp_mm: NDArray[np.float64],
    across: int,
    up: int,
    colour: str = PLANNED,
    label: str | None = None,
) -> None:
    """The TCP path, seen along the third axis, with a dot at the start."""
    start = tcp_mm[0, [across, up]]
    axes.plot(tcp_mm[:, across], tcp_mm[:, up], color=colour, label=label)
    axes.plot(*start, "o", color=colour, markersize=4)
    axes.set_xlabel(f"{'xyz'[across]} / mm")
    axes.set_ylabel(f"{'xyz'[up]} / mm")
    axes.ticklabel_format(useOffset=False)
    axes.update_datalim([start - MIN_SPAN_MM / 2, start + MIN_SPAN_MM / 2])
    axes.autoscale_view()
    axes.set_aspect("equal", adjustable="datalim")
