"""Checks of the charts in `iiwasim report` pages: texts, and input by mouse, touch and keys."""

from __future__ import annotations

import math
import re

from accessibility import check_accessibility
from chromium import Browser
from pages import desk, seek

# Records the texts of charts, with their extents in canvas px, and the lines that they draw.
WATCH = """(() => {
    window.texts = [];
    window.lines = [];
    const own = CanvasRenderingContext2D.prototype;
    if (own.watched) return;
    own.watched = true;
    const fillText = own.fillText;
    own.fillText = function (text, x, y) {
        const wide = this.measureText(text).width;
        const left = x - wide * { left: 0, center: 0.5, right: 1 }[this.textAlign];
        const top = { top: y, middle: y - 5, bottom: y - 10 }[this.textBaseline];
        const { clientWidth, clientHeight } = this.canvas;
        texts.push({ text, left, right: left + wide, top, wide: clientWidth, high: clientHeight });
        fillText.call(this, text, x, y);
    };
    for (const name of ["moveTo", "lineTo"]) {
        const draw = own[name];
        own[name] = function (x, y) {
            const { id } = this.canvas.parentElement.parentElement;
            if (id === "deviations") lines.push([name, x, y]);
            draw.call(this, x, y);
        };
    }
})()"""
SPAN = "state.window.to - state.window.from"
TOLD = "document.querySelector('.told:not([hidden])')"


def numbers_along_axes_are_whole(browser: Browser, pages) -> None:
    """Tick labels are not cut off at any size, and are short."""
    for name in ("exact", "run", "scene-run", "tool", "long-wait", "appendix-b"):
        for wide in (1400, 400):
            browser.size(wide, 900, phone=wide == 400)
            browser.open(pages.page(name))
            browser.run(WATCH)
            browser.run("drawCharts()")
            texts = browser.run("texts")
            assert len(texts) > 20, name
            for it in texts:
                assert it["left"] >= 0 and it["right"] <= it["wide"], f"{name}, {wide} px: {it}"
                assert it["top"] >= 0 and it["top"] + 10 <= it["high"], f"{name}, {wide} px: {it}"
                assert len(it["text"].replace(" s", "")) <= 8 or " " in it["text"], it
    desk(browser)
    # A recording that is on its path except for rounding.
    browser.open(pages.page("exact"))
    titles = browser.run(
        "[...document.querySelectorAll('#deviations h3')].map(it => it.textContent)"
    )
    assert titles == [
        "Flange deviation: below 0.001 mm",
        "Joint deviation: below 0.001 mrad",
    ], titles
    assert "below 0.001 mm" in browser.run("document.getElementById('errors').textContent")


def deviations_go_on_in_time(browser: Browser, pages) -> None:
    """Deviations continue over waits, stops, a motion without length, and gaps."""
    desk(browser)
    for name, gaps in (("waiting", 0), ("gap", 1)):
        browser.open(pages.page(name))
        browser.run(WATCH)
        browser.run("(lines.length = 0, drawCharts())")
        # Grid lines extend from side to side, or from top to bottom.
        lines = [
            (kind, x, y) for kind, x, y in browser.run("lines") if x % 1 != 0.5 and y % 1 != 0.5
        ]
        backwards = [
            (before, after)
            for before, after in zip(lines, lines[1:])
            if after[0] == "lineTo" and after[1] < before[1] - 1e-6
        ]
        assert not backwards, f"{name}: {backwards[:3]}"
        for key in ("tcp_mm", "joints_mrad"):
            breaks = browser.run(f"report.compared.{key}.low.filter(it => Number.isNaN(it)).length")
            assert breaks == gaps, (name, key, breaks)
            times = f"report.compared.{key}.t_s"
            assert browser.run(f"{times}.every((t, i) => i === 0 || t >= {times}[i - 1])"), name
            # The curve covers the whole time, including waits.
            first, last = browser.run(f"[{times}[0], {times}.at(-1)]")
            assert (
                last - first > 0.9 * browser.run("report.compared.report.cycle_time.real_s") - 0.4
            ), (first, last)


def values_are_at_the_mouse(browser: Browser, pages) -> None:
    desk(browser)
    browser.open(pages.page("ten-motions"))
    box = browser.box("#charts canvas")
    assert browser.run(f"{TOLD}") is None
    browser.move(box["x"] + 0.4 * box["width"], box["y"] + 70)
    assert browser.run("state.time") == 0, "the mouse alone takes the arm along"
    told = browser.run(f"{TOLD}.textContent")
    t = browser.run("pointing.t")
    assert f"{t:.3f} s" in told, told
    lower, upper = browser.run("[report.robot.lower_rad[1], report.robot.upper_rad[1]]")
    q = browser.run(f"jointsAt(report.arms[0], {t})[1]")
    percent = 200 * (q - lower) / (upper - lower) - 100
    assert f"A2 {percent:.1f} %" in told, (percent, told)
    assert all(f"A{j} " in told for j in range(1, 8)), told
    # In degrees, and without a hidden joint.
    browser.click("#units")
    browser.click("#chips label:nth-child(1)")
    browser.box("#charts canvas")
    box = browser.box("#charts canvas")
    browser.move(box["x"] + 0.4 * box["width"], box["y"] + 70)
    told = browser.run(f"{TOLD}.textContent")
    assert f"A2 {math.degrees(q):.2f} deg" in told and "A1" not in told, told
    # Line and values are within all charts at both ends.
    assert browser.run("charts.every(it => !it.hover.hidden)")
    for share in (0.05, 0.99):
        browser.move(box["x"] + share * box["width"], box["y"] + 70)
        inside = browser.run(
            f"(() => {{ const a = {TOLD}.getBoundingClientRect(), b = "
            f"{TOLD}.parentElement.getBoundingClientRect();"
            " return a.left >= b.left && a.right <= b.right })()"
        )
        assert inside, share
    browser.move(5, 5)
    assert browser.run(f"{TOLD}") is None
    # Values of both robots; the clearance with the nearest pair.
    browser.open(pages.page("scene-run"))
    for chart, words in (("#clearances canvas", "link "), ("#point-charts canvas", "measured")):
        box = browser.box(chart)
        browser.move(box["x"] + 0.5 * box["width"], box["y"] + 50)
        assert words in browser.run(f"{TOLD}.textContent"), chart
    box = browser.box("#charts canvas")
    browser.move(box["x"] + 0.5 * box["width"], box["y"] + 50)
    assert " | " in browser.run(f"{TOLD}.textContent")


def torques_have_a_curve(browser: Browser, pages) -> None:
    """Torques of the plan as in its file, and torques of the recording, with the controller's sign
    inverted.
    """
    desk(browser)
    browser.open(pages.page("run"))
    titles = browser.run("[...document.querySelectorAll('#charts h3')].map(it => it.textContent)")
    assert titles[-1] == "Torque, link side, % of the limit", titles
    for arm, (file, sign) in enumerate((("ten-motions", 1), ("real", -1))):
        efforts = pages.efforts(file)
        known = [(t, effort) for t, effort in efforts if effort]
        assert len(known) > 0.5 * len(efforts) > 100, (file, len(known), len(efforts))
        shift = browser.run(f"report.arms[{arm}].start_s") - efforts[0][0]
        for t, effort in known[5 :: len(known) // 7]:
            shown = browser.run(
                f"Array.from({{ length: 7 }}, (_, j) => readingAt(report.arms[{arm}].torque, "
                f"{t + shift}, j, 7))"
            )
            off = [abs(a - sign * b) for a, b in zip(shown, effort)]
            assert max(off) < 0.01, (file, t, shown, effort)
    # At the mouse, as a share of the limit and in Nm; in the table of values; in the table of
    # motions; in the head.
    box = browser.box("#charts .chart:last-child canvas")
    browser.move(box["x"] + 0.4 * box["width"], box["y"] + 50)
    t, limit = browser.run("[pointing.t, report.robot.torque_nm[1]]")
    nm = browser.run(f"report.arms.map(arm => readingAt(arm.torque, {t}, 1, 7))")
    told = browser.run(f"{TOLD}.textContent")
    assert f"A2 {100 * nm[0] / limit:.1f} | {100 * nm[1] / limit:.1f} %" in told, (nm, told)
    browser.click("#units")
    browser.box("#charts canvas")
    box = browser.box("#charts .chart:last-child canvas")
    browser.move(box["x"] + 0.4 * box["width"], box["y"] + 50)
    assert f"A2 {nm[0]:.2f} | {nm[1]:.2f} Nm" in browser.run(f"{TOLD}.textContent")
    browser.click("#units")
    seek(browser, 3)
    cell = browser.run(
        "document.querySelector('#joints tr:nth-child(2) td:nth-child(4)').textContent"
    )
    assert abs(float(cell) - browser.run("readingAt(second.torque, 3, 1, 7)")) < 0.06, cell
    head = browser.run("[...document.querySelectorAll('#table th')].map(it => it.textContent)")
    column = head.index("top torque") + 1
    shares = browser.run(
        f"[...document.querySelectorAll('#table td:nth-child({column})')].map(it => it.textContent)"
    )
    assert len(shares) == 10 and all(
        re.fullmatch(r"A\d \d+ %, -?[\d.]+ Nm", it) for it in shares
    ), shares
    assert "peak power" in browser.run("document.getElementById('figures').textContent")
    pages.keep(browser, "torques")
    # The page of a file without torques does not mention torques.
    browser.open(pages.page("recorder"))
    assert "Torque" not in browser.run("document.getElementById('charts').textContent")
    assert browser.run("document.getElementById('torques').hidden")


def a_part_is_zoomed_into(browser: Browser, pages) -> None:
    desk(browser)
    browser.open(pages.page("ten-motions"))
    whole = browser.run(SPAN)
    box = browser.box("#charts canvas")
    y, left, inner = box["y"] + 60, box["x"] + 56, box["width"] - 64
    browser.drag([(left + share * inner, y) for share in (0.25, 0.3, 0.4, 0.5)])
    window = browser.run("[state.window.from, state.window.to]")
    assert (
        abs(window[0] - 0.25 * whole) < 0.01 * whole and abs(window[1] - 0.5 * whole) < 0.01 * whole
    ), window
    assert browser.run("state.time") == 0, "a zoom takes the arm along"
    # A click sets the time, and a double click shows the whole time again.
    browser.press(left + 0.5 * inner, y)
    assert abs(browser.run("state.time") - 0.375 * whole) < 0.01 * whole
    browser.press(left + 0.5 * inner, y, 2)
    assert browser.run(SPAN) == whole
    # Also backwards; beyond the chart, the selection ends at its edge.
    browser.drag([(left + share * inner, y) for share in (0.5, 0.3, -0.2)])
    assert (
        browser.run("state.window.from") == 0
        and abs(browser.run(SPAN) - 0.5 * whole) < 0.01 * whole
    )
    browser.click("#whole")
    assert browser.run(SPAN) == whole


def charts_have_keys(browser: Browser, pages) -> None:
    desk(browser)
    browser.open(pages.page("ten-motions"))
    whole = browser.run(SPAN)
    # With Tab only.
    browser.run("document.getElementById('whole').focus()")
    browser.key("Tab")
    assert browser.run("document.activeElement === charts[0].canvas")
    told = browser.run(f"{TOLD}.textContent")
    for _ in range(20):
        browser.key("ArrowRight")
    assert abs(browser.run("state.time") - 0.2 * whole) < 1e-3 * whole
    assert browser.run(f"{TOLD}.textContent") != told
    browser.key("ArrowLeft")
    assert abs(browser.run("state.time") - 0.19 * whole) < 1e-3 * whole
    browser.key("+", text="+")
    assert abs(browser.run(SPAN) - 0.5 * whole) < 1e-6
    browser.key("0", text="0")
    assert browser.run(SPAN) == whole
    browser.key("End")
    assert browser.run("state.time") == browser.run("endS")
    slider = browser.run(
        "['role', 'aria-label', 'aria-valuenow', 'aria-valuetext'].map(it => "
        "charts[0].canvas.getAttribute(it))"
    )
    assert slider[0] == "slider" and "Position" in slider[1] and "A7" in slider[3], slider
    assert abs(float(slider[2]) - browser.run("state.time")) < 1e-3, slider
    browser.key("Tab")
    assert browser.run("document.activeElement === charts[1].canvas")


def charts_have_fingers(browser: Browser, pages) -> None:
    browser.size(390, 844, phone=True)
    browser.open(pages.page("ten-motions"))
    whole = browser.run(SPAN)
    box = browser.box("#charts canvas")
    y, left, inner = box["y"] + 60, box["x"] + 56, box["width"] - 64
    browser.touch([[(left + share * inner, y)] for share in (0.2, 0.3, 0.4, 0.5)])
    assert abs(browser.run("state.time") - 0.5 * whole) < 0.02 * whole
    assert browser.run(SPAN) == whole
    at = lambda *shares: [(left + share * inner, y) for share in shares]
    browser.touch([at(0.4, 0.6), at(0.35, 0.65), at(0.3, 0.7)])
    assert abs(browser.run(SPAN) - 0.5 * whole) < 0.03 * whole, browser.run(SPAN)
    desk(browser)


def the_tcp_has_curves(browser: Browser, pages) -> None:
    desk(browser)
    browser.open(pages.page("ten-motions"))
    assert browser.run("document.querySelectorAll('#point-charts canvas').length") == 3
    assert browser.run("document.getElementById('point-tcp').hidden"), "there is no tool"
    assert browser.run("document.getElementById('point-title').textContent") == "Flange over time"
    # Position, angles and path speed of the program.
    for t in (0.4, 3.1):
        joints = ",".join(repr(q) for q in browser.run(f"jointsAt(report.arms[0], {t})"))
        printed = pages.iiwasim("fk", f"--joints-rad={joints}", "--json")
        told = pages.json(printed)["frame"]
        place = browser.run(f"placeOf(report.arms[0], {t})")
        expected = [told[key] for key in ("x_mm", "y_mm", "z_mm", "a_deg", "b_deg", "c_deg")]
        assert all(abs(a - b) < 1e-3 for a, b in zip(place, expected)), (place, expected)
        before, after = (
            browser.run(f"placeOf(report.arms[0], {at})") for at in (t - 0.004, t + 0.004)
        )
        speed = math.dist(before[:3], after[:3]) / 0.008
        shown = 1000 * browser.run(f"readingAt(report.arms[0].speed, {t}, 0, 1)")
        assert abs(speed - shown) < 0.01 * shown + 1, (speed, shown)
    canvas = "document.querySelector('#point-charts canvas')"
    before = browser.run(f"{canvas}.toDataURL()")
    browser.click("#level")
    assert browser.run(f"{canvas}.toDataURL()") != before, "there is no line at 250 mm/s"
    browser.click("#level")
    # With a tool, the TCP or the flange can be shown.
    browser.open(pages.page("tool"))
    assert browser.run("document.getElementById('point-title').textContent") == "TCP over time"
    look = "[...document.querySelectorAll('#point-charts canvas')].map(it => it.toDataURL())"
    tcp = browser.run(look)
    tip = browser.run("placeOf(report.arms[0], 1)")
    browser.click("#point-flange")
    assert browser.run("document.getElementById('point-title').textContent") == "Flange over time"
    assert all(a != b for a, b in zip(tcp, browser.run(look))), "flange and TCP look the same"
    flange = browser.run("placeOf(report.arms[0], 1)")
    assert abs(math.dist(tip[:3], flange[:3]) - 120) < 0.01, (tip, flange)
    most = browser.run("Math.max(...report.figures.motions.map(it => it.tcp_speed_peak_mm_s || 0))")
    highest = browser.run(
        "1000 * Math.max(...report.arms[0].speed.high.filter((_, i) => i % 2 === 1))"
    )
    assert highest > 0.95 * most, (highest, most)
    # Also for a recording.
    browser.open(pages.page("run"))
    assert browser.run("report.arms[1].speed.columns") > 100


def people_without_a_mouse_are_served(browser: Browser, pages) -> None:
    for name in ("scene-run", "tool", "recorder", "exact"):
        for scheme in ("light", "dark"):
            browser.size(1280, 900)
            browser.scheme(scheme)
            browser.open(pages.page(name))
            check_accessibility(browser, f"{name}, {scheme}")
    browser.size(390, 844, phone=True)
    browser.open(pages.page("scene-run"))
    check_accessibility(browser, "scene-run on a phone")
    desk(browser)


CHART_CHECKS = [
    numbers_along_axes_are_whole,
    deviations_go_on_in_time,
    values_are_at_the_mouse,
    torques_have_a_curve,
    a_part_is_zoomed_into,
    charts_have_keys,
    charts_have_fingers,
    the_tcp_has_curves,
    people_without_a_mouse_are_served,
]
