"""Matplotlib figures of plans."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from ._native import Plan

# The joint colours of the HTML pages.
COLOURS = ("#1b1f24", "#e69f00", "#56b4e9", "#009e73", "#cc79a7", "#0072b2", "#d55e00")
# Matplotlib backends that only draw into files.
WINDOWLESS = {"agg", "cairo", "pdf", "pgf", "ps", "svg", "template"}
# Least range of the axes, so that tiny TCP motions are not magnified further.
MIN_SPAN_MM = 10.0


def plot(plan: Plan, rate_hz: float) -> Figure:
    """The TCP path in side and top view, and the joint speeds as shares of their limits."""
    try:
        import matplotlib as mpl
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise ImportError("plot needs matplotlib: pip install 'iiwasim[plot]'") from error
    samples = plan.sample(rate_hz=rate_hz)
    figure = plt.figure(figsize=(8, 6.4), layout="constrained")
    parts = figure.subplot_mosaic([["side", "top"], ["speeds", "speeds"]])
    _way(parts["side"], 1e3 * samples.tcp, 0, 2)
    _way(parts["top"], 1e3 * samples.tcp, 0, 1)
    speeds = parts["speeds"]
    shares = 100 * np.abs(samples.dq) / plan.robot.velocity_limits_rad_s
    for joint, colour in enumerate(COLOURS):
        speeds.plot(samples.t, shares[:, joint], label=f"A{joint + 1}", color=colour, linewidth=1.2)
    for motion in plan.motions[1:]:
        speeds.axvline(motion.start_s, color="0.85", linewidth=0.8, zorder=0)
    speeds.set_xlabel("t / s")
    speeds.set_ylabel("speed / % of the limit")
    speeds.set_xlim(0, max(plan.cycle_time_s, 1e-3))
    speeds.set_ylim(0, 105)
    speeds.legend(
        ncols=7, fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False
    )
    figure.suptitle(f"Cycle time {plan.cycle_time_s:.3f} s")
    backend = mpl.get_backend().lower()
    if backend in WINDOWLESS or "inline" in backend:
        # A figure without a window need not stay open; and a notebook would show an open figure
        # twice: as the result of the cell, and as an open figure.
        plt.close(figure)
    return figure


def _way(axes: Axes, tcp_mm: NDArray[np.float64], across: int, up: int) -> None:
    """The TCP path, seen along the third axis, with a dot at the start."""
    start = tcp_mm[0, [across, up]]
    axes.plot(tcp_mm[:, across], tcp_mm[:, up], color="#1f5fa8")
    axes.plot(*start, "o", color="#1f5fa8", markersize=4)
    axes.set_xlabel(f"{'xyz'[across]} / mm")
    axes.set_ylabel(f"{'xyz'[up]} / mm")
    axes.ticklabel_format(useOffset=False)
    axes.update_datalim([start - MIN_SPAN_MM / 2, start + MIN_SPAN_MM / 2])
    axes.autoscale_view()
    axes.set_aspect("equal", adjustable="datalim")
