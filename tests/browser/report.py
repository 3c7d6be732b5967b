#!/usr/bin/env python3
"""Opens pages of `iiwasim report` in a browser and operates them like a user.

    report.py IIWASIM FOLDER [--hour] [--urdf FILE] [--only CHECK]

IIWASIM is the program; pages and screenshots are written to FOLDER. --hour adds a recording of one
hour at 1 kHz, which takes 300 MB in FOLDER while it runs. --urdf is the URDF in
pybullet_data/kuka_iiwa of pybullet 3.2.7, whose meshes are also drawn. --only runs one check, by
its name. Exit code 1 when a check fails. Needs Chromium and the packages in requirements.txt, next
to this file.
"""

from __future__ import annotations

import argparse
import io
import json
import math
import re
import time
from pathlib import Path

import pypdf

from charts import CHART_CHECKS
from checks import run_checks
from chromium import Browser
from pages import CHARTS, CLOCK, FIXTURES, SCENE, Pages, desk, seek
from pair import PAIR_CHECKS, make_pair
from playback import PLAYBACK_CHECKS
from scene import TOOL
from view import VIEW_CHECKS, meshes_of_a_urdf_are_drawn


def opens_and_is_drawn(browser: Browser, pages: Pages) -> str:
    desk(browser)
    sizes = {}
    for page in sorted(pages.folder.glob("*.html")):
        browser.open(page)
        ms = int(browser.run("document.documentElement.dataset.drawnMs"))
        assert browser.requests[-1].startswith("file:"), browser.requests
        others = [
            url for url in browser.requests if not url.startswith(("file:", "about:", "data:"))
        ]
        assert not others, others
        sizes[page.stem] = (page.stat().st_size, ms)
    size, ms = sizes["ten-motions"]
    assert size < 2_000_000, size
    return f"page of ten motions {size / 1e6:.2f} MB, drawn in {ms} ms without a graphics card"


def arm_moves(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("ten-motions"))
    pictures = set()
    for i, t in enumerate((0.0, 1.5, 3.0, 4.5, 6.0)):
        seek(browser, t)
        assert abs(browser.run(CLOCK) - t) < 1e-3
        pictures.add(browser.run(SCENE))
        pages.keep(browser, f"ten-motions-at-{i}", whole=False)
    assert len(pictures) == 5, "the arm looks the same at different times"
    # The robot is visible: its orange is in the middle of the view.
    script = """(() => {
        const scene = document.getElementById("scene");
        const flat = document.createElement("canvas");
        [flat.width, flat.height] = [scene.width, scene.height];
        const context = flat.getContext("2d");
        drawScene();
        context.drawImage(scene, 0, 0);
        const { data } = context.getImageData(0, 0, flat.width, flat.height);
        let orange = 0, blue = 0;
        for (let i = 0; i < data.length; i += 4) {
            const [r, g, b] = data.slice(i, i + 3);
            if (r > 150 && r > 1.6 * g && r > 3 * b) orange++;
            if (b > 120 && b > 1.3 * g && r < 60) blue++;
        }
        return [orange, blue];
    })()"""
    orange, blue = browser.run(script)
    assert orange > 500 and blue > 200, (orange, blue)


def flange_is_where_the_robot_model_has_it(browser: Browser, pages: Pages) -> None:
    browser.open(pages.page("ten-motions"))
    for t in (0.0, 0.777, 2.5, 5.1, 7.0):
        joints = browser.run(f"jointsAt(report.arms[0], {t})")
        text = ",".join(repr(q) for q in joints)
        told = json.loads(pages.iiwasim("fk", f"--joints-rad={text}", "--json"))
        found = browser.run(f"flangeAt({json.dumps(joints)})")
        off = math.dist(told["position_m"], found)
        assert off < 1e-6, f"{off} m at {t} s"
        seek(browser, t)
        shown = browser.run(
            "[...document.querySelectorAll('#pose td:nth-child(2)')].slice(0, 3).map(it => "
            "+it.textContent)"
        )
        assert math.dist([1e3 * v for v in told["position_m"]], shown) < 0.1, shown


def tcp_pose_is_beside_the_flange(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("tool"))
    for t in (0.0, 0.777):
        joints = browser.run(f"jointsAt(report.arms[0], {t})")
        text = ",".join(repr(q) for q in joints)
        seek(browser, t)
        head = browser.run(
            "[...document.querySelectorAll('#pose-head th')].map(it => it.textContent)"
        )
        assert head == ["", "flange", "TCP"], head
        for column, tool in ((2, "flange"), (3, "gripper")):
            told = pages.iiwasim(
                "fk", f"--joints-rad={text}", "--program=tool.json", f"--tool={tool}", "--json"
            )
            frame = json.loads(told)["frame"]
            shown = browser.run(
                f"[...document.querySelectorAll('#pose td:nth-child({column})')].map(it => "
                "+it.textContent)"
            )
            for k, (key, least) in enumerate(
                (f"{axis}_{unit}", least)
                for axes, unit, least in (("xyz", "mm", 0.051), ("abc", "deg", 0.0051))
                for axis in axes
            ):
                # 180 deg and -180 deg are the same angle.
                off = abs(shown[k] - frame[key])
                assert min(off, abs(off - 360)) < least, (tool, key, shown, frame)


def spline_segments_are_rows(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("spline"))
    rows = browser.run(
        "[...document.querySelectorAll('#table tbody tr')].map(row => "
        "[...row.children].map(it => it.textContent))"
    )
    assert [row[:2] for row in rows] == [
        ["1", "PTP"],
        ["2", "Spline"],
        ["2.1", "SPL"],
        ["2.2", "SPL"],
        ["2.3", "LIN"],
        ["2.4", "SPL"],
    ], rows
    # Segments follow each other from the start of the spline to its end.
    spline, *segments = ([float(cell) for cell in row[2:5]] for row in rows[1:])
    assert segments[0][0] == spline[0] and segments[-1][1] == spline[1], rows
    assert all(a[1] == b[0] for a, b in zip(segments, segments[1:])), rows
    browser.click("#table tbody tr:nth-child(5) td")
    assert abs(browser.run("state.time") - segments[2][0]) < 1e-3
    current = "[...document.querySelectorAll('#table .current')].map(it => it.cells[0].textContent)"
    assert browser.run(current) == ["2", "2.3"]


def curves_can_be_chosen(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("ten-motions"))
    shown = "document.querySelectorAll('#charts .chart:not([hidden]) canvas').length"
    assert browser.run(shown) == 5
    seen = {browser.run(CHARTS)}
    for selector in ("#chips label:nth-child(1)", "#units", "#in"):
        browser.click(selector)
        seen.add(browser.run(CHARTS))
    assert len(seen) == 4, "a button changes nothing"
    assert browser.run("document.querySelector('#charts h3').textContent") == "Position, deg"
    span = browser.run("state.window.to - state.window.from")
    browser.click("#out")
    assert browser.run("state.window.to - state.window.from") > 1.9 * span
    browser.click("#in")
    browser.click("#whole")
    for selector in ("#units", "#chips label:nth-child(1)"):
        browser.click(selector)
    assert browser.run(CHARTS) in seen, "what was changed back looks otherwise"
    # The snap is shown on request, without a limit. Each ramp of a linear motion begins with snap.
    titles = "[...document.querySelectorAll('#charts h3:not([hidden])')].map(it => it.textContent)"
    browser.click("#snap")
    assert browser.run(shown) == 6
    assert browser.run(titles)[4] == "Snap, deg/s\u2074", browser.run(titles)
    browser.click("#snap")
    assert browser.run(shown) == 5
    browser.open(pages.page("recorder"))
    assert browser.run("document.getElementById('snap').hidden"), "a recording has no snap"


def schemes_and_phones(browser: Browser, pages: Pages) -> None:
    names = ("ten-motions", "appendix-b", "waits-and-stops", "compared", "recorder", "cut")
    for name in names:
        looks = []
        for scheme in ("light", "dark"):
            browser.size(1280, 900)
            browser.scheme(scheme)
            browser.open(pages.page(name), "#t=1.3")
            pages.keep(browser, f"{name}-{scheme}")
            ground = browser.run("getComputedStyle(document.documentElement).backgroundColor")
            looks.append((ground, browser.run(SCENE), browser.run(CHARTS)))
            browser.size(390, 844, phone=True)
            browser.frames()
            width = browser.run("document.documentElement.scrollWidth")
            assert width <= 390, f"{name}: {width} px wide on a phone"
            # Touch targets need a minimum size.
            script = (
                "[...document.querySelectorAll('button, select, #chips label')].map(it => "
                "it.getBoundingClientRect().height)"
            )
            assert min(h for h in browser.run(script) if h > 0) >= 32, name
            pages.keep(browser, f"{name}-{scheme}-phone")
        assert all(a != b for a, b in zip(*looks)), f"{name}: light and dark look the same"
    # The colour scheme can change while the page is open.
    desk(browser)
    browser.open(pages.page("appendix-b"))
    before = browser.run(CHARTS)
    browser.scheme("dark")
    browser.frames()
    assert browser.run(CHARTS) != before
    browser.scheme("light")


def paper_has_the_tables(browser: Browser, pages: Pages) -> None:
    for scheme in ("light", "dark"):
        browser.size(1280, 900)
        browser.scheme(scheme)
        browser.open(pages.page("compared"), "#t=1.3")
        before = browser.run(CHARTS)
        pdf = browser.pdf()
        (pages.folder / f"compared-{scheme}.pdf").write_bytes(pdf)
        reader = pypdf.PdfReader(io.BytesIO(pdf))
        text = re.sub(r"\s+", " ", " ".join(page.extract_text() for page in reader.pages))
        figures = browser.run("report.figures")
        words = ["Motions", "Plan against recording", "limited by", "A1", "A7"]
        words += [f"{motion['end_s']:.3f}" for motion in figures["motions"]]
        # Cycle times of the plan and of the substitute for the robot.
        cycle = browser.run("report.compared.report.cycle_time")
        words += [f"{seconds:.3f}" for seconds in (figures["cycle_time_s"], cycle["real_s"])]
        for word in words:
            assert word in text, f"{word} is not printed: {text}"
        assert len(reader.pages) <= 4, len(reader.pages)
        # The 3D view is a picture; curves may be drawn as lines.
        images = sum(
            found.get_object()["/Subtype"] == "/Image"
            for page in reader.pages
            for found in page["/Resources"].get("/XObject", {}).values()
        )
        assert images >= 1, "no picture on paper"
        browser.frames()
        assert browser.run(CHARTS) == before, "the page looks otherwise after it was printed"
    # The printed 3D view is not empty.
    browser.run("window.dispatchEvent(new Event('beforeprint'))")
    assert (
        browser.run(
            """(() => {
        const { width, height } = document.getElementById("paper");
        const context = document.getElementById("paper").getContext("2d");
        const { data } = context.getImageData(0, 0, width, height);
        return new Set(new Uint32Array(data.buffer)).size;
    })()"""
        )
        > 100
    )
    browser.run("window.dispatchEvent(new Event('afterprint'))")
    browser.scheme("light")


def own_limits_are_bands(browser: Browser, pages: Pages) -> None:
    """Motions with shares of the limits below 1."""
    desk(browser)
    browser.open(pages.page("waits-and-stops"))
    runs = browser.run("Object.fromEntries(QUANTITIES.map(({ key, own }) => [key, own]))")
    program = json.loads((FIXTURES / "waits-and-stops.json").read_text())
    rows = browser.run("report.figures.motions")
    expected = [
        (row["start_s"], row["end_s"], motion["velocity_rel"])
        for row, motion in zip(rows, program["motions"])
        if "velocity_rel" in motion
    ]
    assert len(runs["velocity"]) == len(expected) == 2
    for run, (start, end, share) in zip(runs["velocity"], expected):
        assert abs(run["from"] - start) < 1e-6 and run["shares"] == [share] * 7, run
        # The band continues during the settling time.
        assert end - 1e-6 < run["to"] < end + 0.06, run
    assert [run["shares"] for run in runs["acceleration"]] == [[1, 0.5, 1, 0.5, 1, 0.5, 1]]
    assert not runs["jerk"] and not runs["position"]
    # The bands are visible.
    seen = browser.run(CHARTS)
    assert (
        browser.run(f"(() => {{ for (const it of QUANTITIES) it.own = []; return {CHARTS} }})()")
        != seen
    )
    assert "own limits" in browser.run("document.getElementById('bands').textContent")
    browser.open(pages.page("ten-motions"))
    assert "own limits" not in browser.run("document.getElementById('bands').textContent")


def a_run_is_beside_its_plan(browser: Browser, pages: Pages) -> None:
    desk(browser)
    compared = []
    for name in ("run", "run-alone"):
        browser.open(pages.page(name), "#t=3")
        assert browser.run(
            "[...document.querySelectorAll('#pose-head tr:first-child th')].map(it => "
            "it.textContent)"
        ) == ["", "plan", "measured"]
        told = browser.run("report.compared.report")
        assert told["tcp_deviation"]["max_mm"] < 0.2, told["tcp_deviation"]
        assert abs(told["cycle_time"]["error_s"]) < 0.01, told["cycle_time"]
        # The curves coincide: at the same time, both robots have the same position.
        off = browser.run(
            "Math.max(...[1, 2, 3, 4, 5, 6, 7].map(t => Math.max(...jointsAt(first, t).map("
            "(q, j) => Math.abs(q - jointsAt(second, t)[j])))))"
        )
        assert off < 0.01, f"{off} rad"
        compared.append(told["motions"])
        pages.keep(browser, f"{name}-light")
    assert len(compared[0]) == len(compared[1]) == 10
    notes = browser.run("document.getElementById('notes').textContent")
    assert "made for this page" in notes, notes


def a_scene_is_shown(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("scene"), "#t=0.5")
    planned = json.loads(
        pages.iiwasim(
            "plan",
            str(FIXTURES / "ten-motions.json"),
            "--scene",
            "cage.json",
            "--no-output",
            "--json",
        )
    )
    told, itself = planned["clearance"], planned["self_clearance"]
    figures = browser.run("document.getElementById('figures').textContent")
    assert f"{told['distance_mm']:.1f} mm" in figures and f"and {told['obstacle']}" in figures, (
        figures
    )
    assert (
        f"from itself: {'the tool' if itself['link'] == 8 else 'link ' + str(itself['link'])}"
        in figures
    ), figures
    assert f"{itself['distance_mm']:.1f} mm" in figures, figures
    assert browser.run("document.querySelectorAll('#clearances canvas').length") == 2
    # The text shows the clearance at the current position.
    for t in (0.0, 0.96, 3.3, 6.0):
        seek(browser, t)
        pair = browser.run("document.getElementById('pair').textContent")
        assert re.fullmatch(rf"At {t:.3f} s: [0-9.]+ mm, (the tool|link [2-7]) and .+", pair), pair
    # Each shape is drawn: without it, the picture differs.
    looks = [browser.run(SCENE)]
    count = browser.run("around.tool.length")
    assert count == len(TOOL)
    for i in range(count):
        looks.append(
            browser.run(
                f"(scene.fill({{ tool: around.tool.filter((_, k) => k !== {i}) }}), {SCENE})"
            )
        )
    looks.append(browser.run(f"(scene.fill({{ tool: [] }}), {SCENE})"))
    looks.append(browser.run(f"(scene.fill({{ ...around, obstacles: [] }}), {SCENE})"))
    assert len(set(looks)) == count + 3, "a shape is not drawn"
    browser.run("scene.fill(around)")
    assert browser.run(SCENE) == looks[0]
    # The chart sets the time like all charts, and shows another time window.
    canvas = "document.querySelector('#clearances canvas')"
    before = browser.run(f"{canvas}.toDataURL()")
    box = browser.box("#clearances canvas")
    browser.press(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    assert 0.4 < browser.run("state.time / report.arms[0].end_s") < 0.6
    browser.click("#in")
    assert browser.run(f"{canvas}.toDataURL()") != before
    for name in ("scene", "scene-run"):
        for scheme in ("light", "dark"):
            desk(browser)
            browser.scheme(scheme)
            browser.open(pages.page(name), "#t=0.9")
            pages.keep(browser, f"{name}-{scheme}")
            browser.size(390, 844, phone=True)
            browser.frames()
            assert browser.run("document.documentElement.scrollWidth") <= 390, name
            pages.keep(browser, f"{name}-{scheme}-phone")
    assert browser.run("report.arms.filter(it => it.clearance && it.self_clearance).length") == 2
    assert "clearance, measured" in browser.run("document.getElementById('figures').textContent")
    browser.scheme("light")
    browser.open(pages.page("scene"))
    pdf = browser.pdf()
    (pages.folder / "scene.pdf").write_bytes(pdf)
    reader = pypdf.PdfReader(io.BytesIO(pdf))
    printed = " ".join(page.extract_text() for page in reader.pages)
    assert "Clearance" in printed and len(reader.pages) <= 4, len(reader.pages)
    # Without a scene, the page has no clearance.
    browser.open(pages.page("ten-motions"))
    assert browser.run("document.getElementById('clearance').hidden")
    assert not browser.run("around.obstacles.length + around.tool.length")


def many_motions_and_one(browser: Browser, pages: Pages) -> None:
    for name, motions in (("many", 300), ("one", 1)):
        desk(browser)
        browser.open(pages.page(name), "#t=0.4")
        assert browser.run("document.querySelectorAll('#table tbody tr').length") == motions
        pages.keep(browser, f"{name}-light", whole=motions == 1)
        browser.size(390, 844, phone=True)
        browser.frames()
        assert browser.run("document.documentElement.scrollWidth") <= 390
        # The whole table is within the screen.
        wide = browser.run(
            "Math.max(...[...document.querySelectorAll('#table td')].map(it => "
            "it.getBoundingClientRect().right))"
        )
        assert wide <= 390, wide


def names_and_groups_are_shown(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("named"))
    head = browser.run("[...document.querySelectorAll('#table th')].map(it => it.textContent)")
    assert head[2:4] == ["name", "group"] and head[-1] == "comment", head
    row = browser.run("[...document.querySelectorAll('#table td')].map(it => it.textContent)")
    assert row[2:4] == ["<b>first</b> </script>", "pick & place"], row
    assert row[len(head) - 1] == "one line\n<i>another</i> line", row
    piece = browser.run("document.getElementById('piece').textContent")
    assert piece.startswith('Motion 1 "<b>first</b> </script>", '), piece
    group = browser.run(
        "[...document.querySelectorAll('#group-table td')].map(it => it.textContent)"
    )
    times = browser.run("report.figures.motions.map(it => it.end_s - it.start_s)")
    assert group[:2] == ["pick & place *", "2"] and len(group) == 4, group
    assert abs(float(group[2]) - times[0] - times[2]) < 6e-4, (group, times)
    browser.open(pages.page("one"))
    assert browser.run("document.getElementById('groups').hidden")


def mode_override_and_warnings_are_stated(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("slowly"))
    notes = "[...document.querySelectorAll('#notes li')].map(it => it.textContent)"
    mode, override, warning, *_ = browser.run(notes)
    assert mode == "Operating mode T1: TCP and flange are limited to 225 mm/s", mode
    assert override.startswith("Override 30 %"), override
    expected = "Warning: motion 1: its blend of 50 mm is shortened to 20.0 mm: "
    assert warning.startswith(expected), warning
    table = browser.run("document.getElementById('table').textContent")
    assert "minimum duration" in table and "cart velocity" not in table, table
    browser.open(pages.page("ten-motions"))
    assert not any("Override" in note or "mode" in note for note in browser.run(notes))


def two_files_and_damaged_ones(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("compared"), "#t=6.1")
    assert browser.run("document.querySelectorAll('#pose tr:first-child td').length") == 3
    assert browser.run("document.querySelectorAll('#deviations canvas').length") == 2
    assert "off by" in browser.run("document.getElementById('figures').textContent")
    browser.open(pages.page("cut"))
    notes = browser.run("document.getElementById('notes').textContent")
    assert "cut off" in notes and "is lost" in notes, notes
    assert browser.run("document.querySelector('#pose-head').textContent") == "flange"
    browser.open(pages.page("recorder"))
    assert browser.run("document.getElementById('motions').hidden")
    assert "Recording" in browser.run("document.getElementById('summary').textContent")


def an_hour(browser: Browser, pages: Pages) -> str:
    file = pages.folder / "hour.csv"
    with file.open("w") as table:
        table.write("t_s,q1,q2,q3,q4,q5,q6,q7\n")
        for k in range(3_600_000):
            q = math.sin(k / 1000)
            # A peak of one sample on top of the sine, which must not be lost.
            off = 0.05 if k == 1_233_075 else 0
            table.write(
                f"{k / 1000},{q:.6f},{0.3 * q + off:.6f},0,{0.5 * q - 1.2:.6f},0,{0.5 * q:.6f},0\n"
            )
    begin = time.monotonic()
    pages.iiwasim("report", "hour.csv")
    made_s = time.monotonic() - begin
    file.unlink()
    page = pages.page("hour")
    desk(browser)
    browser.open(page, "#t=1234")
    ms = int(browser.run("document.documentElement.dataset.drawnMs"))
    # The peak is at its original time.
    high = browser.run(
        "(() => { const { t_s, high } = report.arms[0].position;"
        " return high[7 * (countUpTo(t_s, 1233.075) - 1) + 1] })()"
    )
    assert abs(high - (0.3 * math.sin(1233.075) + 0.05)) < 1e-5, high
    browser.click("#play")
    browser.until("state.time > 1234.2")
    browser.click("#play")
    pages.keep(browser, "hour-light")
    size = page.stat().st_size
    return f"page of an hour at 1 kHz {size / 1e6:.1f} MB, made in {made_s:.1f} s, drawn in {ms} ms"


CHECKS = [
    opens_and_is_drawn,
    arm_moves,
    flange_is_where_the_robot_model_has_it,
    tcp_pose_is_beside_the_flange,
    spline_segments_are_rows,
    *PLAYBACK_CHECKS,
    curves_can_be_chosen,
    *VIEW_CHECKS,
    schemes_and_phones,
    paper_has_the_tables,
    own_limits_are_bands,
    a_run_is_beside_its_plan,
    a_scene_is_shown,
    many_motions_and_one,
    names_and_groups_are_shown,
    mode_override_and_warnings_are_stated,
    two_files_and_damaged_ones,
    *CHART_CHECKS,
    *PAIR_CHECKS,
]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("program", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--hour", action="store_true")
    parser.add_argument("--urdf", type=Path)
    names = [check.__name__ for check in [*CHECKS, meshes_of_a_urdf_are_drawn, an_hour]]
    parser.add_argument("--only", choices=names, metavar="CHECK")
    options = parser.parse_args()
    pages = Pages(options.program, options.folder, options.urdf)
    pages.make()
    make_pair(pages)
    if options.urdf is None:
        print("left out, without --urdf: meshes_of_a_urdf_are_drawn", flush=True)
    checks = (
        CHECKS
        + [meshes_of_a_urdf_are_drawn] * (options.urdf is not None)
        + [an_hour] * options.hour
    )
    checks = [check for check in checks if options.only in (None, check.__name__)]
    raise SystemExit(run_checks("reports", checks, pages))


if __name__ == "__main__":
    main()
