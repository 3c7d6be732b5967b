"""Plots of plans: labels do not overlap, and everything is within the figure."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
import pytest

import iiwasim as iw

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from types import ModuleType

HOME = [0, 30, 0, -60, 0, 90, 0]
PROGRAMS = {
    "wide": [iw.ptp(deg=[120, 30, 0, -60, 0, 90, 0]), iw.wait(0.2), iw.ptp(deg=HOME)],
    "long": [iw.ptp(deg=[0, -60 + 120 * (turn % 2), 0, -20, 0, 90, 0]) for turn in range(20)],
    "the TCP stays": [iw.ptp(deg=[0, 30, 0, -60, 0, 90, 40])],
    "at rest": [iw.wait(1)],
    "without time": [iw.wait(0)],
}


@pytest.fixture
def pyplot(monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pyplot.switch_backend("agg")
    yield pyplot
    pyplot.close("all")


@pytest.mark.parametrize("name", PROGRAMS)
def test_nothing_is_covered(name: str, pyplot: ModuleType) -> None:
    figure = iw.plan(iw.Program(PROGRAMS[name], start_deg=HOME)).plot()
    figure.draw_without_rendering()
    # Axes with their labels and, for the speeds, the legend above.
    boxes = [axes.get_tightbbox() for axes in figure.axes] + [figure.texts[0].get_window_extent()]
    for one, other in combinations(boxes, 2):
        assert not one.overlaps(other)
    within = figure.bbox.padded(0.5)
    assert all(within.contains(*corner) for box in boxes for corner in box.corners())


def test_what_is_drawn(pyplot: ModuleType) -> None:
    plan = iw.plan(iw.Program(PROGRAMS["wide"], start_deg=HOME))
    side, top, speeds, speed, rotation = plan.plot(rate_hz=100).axes
    samples = plan.sample(rate_hz=100)
    assert side.lines[0].get_ydata() == pytest.approx(1e3 * samples.tcp[:, 2])
    assert top.lines[0].get_ydata() == pytest.approx(1e3 * samples.tcp[:, 1])
    # A1 is at its limit, and the other joints are at rest.
    tops = [line.get_ydata().max() for line in speeds.lines[:7]]
    assert tops == pytest.approx([100, 0, 0, 0, 0, 0, 0], abs=0.1)
    begins = [line.get_xdata()[0] for line in speeds.lines[7:]]
    assert begins == pytest.approx([motion.start_s for motion in plan.motions[1:]])
    assert speed.lines[0].get_ydata() == pytest.approx(1e3 * samples.tcp_speed)
    # A1 turns the TCP about the vertical axis, by 120 degrees and back.
    turned = np.degrees(samples.q[:, 0])
    assert rotation.lines[0].get_ydata() == pytest.approx(turned, abs=1e-6)


def test_comparisons(pyplot: ModuleType, tmp_path: Path) -> None:
    plan = iw.plan(iw.Program(PROGRAMS["wide"], start_deg=HOME))
    samples = plan.sample(rate_hz=200)
    shift = np.array([0, 1e-3, 0, 0, 0, 0, 0])
    comparison = iw.compare(plan, iw.Recording(1.01 * samples.t, samples.q + shift))
    figure = comparison.plot()
    figure.draw_without_rendering()
    boxes = [axes.get_tightbbox() for axes in figure.axes] + [figure.texts[0].get_window_extent()]
    for one, other in combinations(boxes, 2):
        assert not one.overlaps(other)
    side, _, tcp, joints = figure.axes
    planned, measured = side.lines[0], side.lines[2]
    assert measured.get_label() == "measured" and planned.get_label() == "planned"
    # A2 lowers the flange, at the distance of the flange from its axis.
    fall = planned.get_ydata() - measured.get_ydata()
    assert fall == pytest.approx(np.full(len(fall), 0.6), abs=0.02)
    assert joints.lines[0].get_ydata().max() == pytest.approx(1, abs=1e-3)
    assert tcp.lines[0].get_ydata().max() == pytest.approx(comparison.max_deviation_mm, abs=1e-9)
    # The plan of a file has the same plot.
    plan.write(tmp_path / "plan.mcap")
    again = iw.compare(tmp_path / "plan.mcap", iw.Recording(1.01 * samples.t, samples.q + shift))
    assert len(again.plot().axes) == 4


@pytest.mark.parametrize("backend", ["agg", "svg"])
def test_figures_without_windows_are_not_kept(
    backend: str, pyplot: ModuleType, tmp_path: Path
) -> None:
    pyplot.switch_backend(backend)
    own = pyplot.figure()
    plan = iw.plan(iw.Program(PROGRAMS["at rest"], start_deg=HOME))
    figures = [plan.plot(rate_hz=10) for _ in range(2)]
    assert pyplot.get_fignums() == [own.number]
    figures[1].savefig(tmp_path / "plan.png")
    assert (tmp_path / "plan.png").stat().st_size > 0


def test_figures_with_windows_are_kept(pyplot: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    """`pyplot.show` needs the open figures."""
    monkeypatch.setattr("matplotlib.get_backend", lambda: "QtAgg")
    figure = iw.plan(iw.Program(PROGRAMS["at rest"], start_deg=HOME)).plot(rate_hz=10)
    assert pyplot.get_fignums() == [figure.number]
