"""Checks of the page with the plans before and after the changes of `iiwasim optimise`."""

from __future__ import annotations

import io
import json

import pypdf

from accessibility import check_accessibility
from chromium import Browser
from pages import CLOCK, FIXTURES, Pages, desk, seek

# A document in each of the two frames.
INSIDE = "[...document.querySelectorAll('iframe')].map(it => it.contentDocument)"
CLOCKS = f"{INSIDE}.map(it => parseFloat(it.getElementById('clock').textContent))"


def views(browser: Browser) -> list[str]:
    """Both 3D views, drawn at once, since a WebGL buffer is cleared once it is on the screen."""
    return browser.run(
        "[...document.querySelectorAll('iframe')].map(it => (it.contentWindow.drawScene(), "
        "it.contentDocument.getElementById('scene').toDataURL()))"
    )


def place(browser: Browser, frame: int, selector: str) -> tuple[float, float]:
    """The centre of an element in a frame, scrolled into view."""
    find = f"{INSIDE}[{frame}].querySelector({json.dumps(selector)})"
    browser.run(f"{find}.scrollIntoView({{ block: 'center' }})")
    browser.frames()
    return browser.run(
        f"""(() => {{
        const outer = document.querySelectorAll("iframe")[{frame}].getBoundingClientRect();
        const inner = {find}.getBoundingClientRect();
        return [outer.x + inner.x + inner.width / 2, outer.y + inner.y + inner.height / 2];
    }})()"""
    )


def both_plans_have_one_time(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("pair"))
    before, after = browser.run("ends")
    assert 1.5 < after < before - 0.3, (before, after)
    for t in (0.0, 0.7, after + 0.1, before):
        seek(browser, t)
        browser.frames()
        clocks = browser.run(CLOCKS)
        assert abs(clocks[0] - t) < 1e-3 and abs(clocks[1] - min(t, after)) < 1e-3, (t, clocks)
        assert abs(browser.run(CLOCK) - t) < 1e-3
    # A click on a timeline, and on a curve of either plan.
    box = browser.box("#timelines .chart:nth-of-type(2) canvas")
    browser.press(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    assert 0.4 < browser.run("state.time / whole.to") < 0.6
    for frame in (0, 1):
        seek(browser, 0)
        x, y = place(browser, frame, "#charts canvas")
        browser.press(x, y)
        browser.frames()
        clocks = browser.run(CLOCKS)
        assert 0.3 * before < clocks[frame] < 0.7 * before, (frame, clocks)
        assert abs(clocks[0] - clocks[1]) < 2e-3, clocks


def both_plans_play_together(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("pair"))
    still = views(browser)
    browser.run(
        "(() => { const speed = document.getElementById('speed'); speed.value = '0.25';"
        " speed.dispatchEvent(new Event('change')) })()"
    )
    browser.click("#play")
    browser.until(f"{CLOCK} > 0.3")
    browser.click("#play")
    browser.frames()
    paused = browser.run(CLOCK)
    for clock in browser.run(CLOCKS):
        assert abs(clock - paused) < 2e-3, (clock, paused)
    assert all(a != b for a, b in zip(still, views(browser)))


def both_views_turn_together(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("pair"))
    still = views(browser)
    x, y = place(browser, 1, "#scene")
    browser.drag([(x, y), (x + 60, y + 10)])
    assert all(a != b for a, b in zip(still, views(browser)))
    # Both have the viewpoint of the one that was reset.
    place(browser, 0, "#look")
    browser.run(f"{INSIDE}[0].getElementById('look').click()")
    browser.frames()
    assert views(browser) == still


def both_plans_are_printed(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("pair"))
    heights = [box["height"] for box in frame_boxes(browser)]
    pdf = browser.pdf()
    (pages.folder / "pair.pdf").write_bytes(pdf)
    reader = pypdf.PdfReader(io.BytesIO(pdf))
    text = " ".join(page.extract_text() for page in reader.pages)
    for end in browser.run("ends"):
        assert text.count(f"{end:.3f} s") >= 2, (end, text)
    assert text.count("limited by") >= 2, text
    browser.frames()
    assert [box["height"] for box in frame_boxes(browser)] == heights


def frame_boxes(browser: Browser) -> list[dict]:
    return browser.run(
        "[...document.querySelectorAll('iframe')].map(it => it.getBoundingClientRect().toJSON())"
    )


def changes_are_listed(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("pair"))
    told = json.loads((pages.folder / "pair-changes.json").read_text())
    rows = browser.run(
        "[...document.querySelectorAll('#change-table tbody tr')].map(row => "
        "[...row.children].map(it => it.textContent))"
    )
    assert rows == [[str(change["motion"]), change["change"]] for change in told["changes"]], rows
    figures = browser.run("document.getElementById('figures').textContent")
    for key in ("cycle_time_s", "changed_cycle_time_s"):
        assert f"{told[key]:.3f} s" in figures, figures
    # Each plan is whole: no frame scrolls, and each has its own figures and motions.
    inside = browser.run(
        f"{INSIDE}.map(it => [it.documentElement.scrollHeight, it.defaultView.innerHeight,"
        " it.querySelectorAll('#table tbody tr').length,"
        " it.getElementById('controls').getClientRects().length])"
    )
    for content, height, motions, controls in inside:
        assert content <= height and motions == 8 and controls == 0, inside


def pair_on_a_phone_and_in_the_dark(browser: Browser, pages: Pages) -> None:
    looks = []
    for scheme in ("light", "dark"):
        desk(browser)
        browser.scheme(scheme)
        browser.open(pages.page("pair"))
        seek(browser, 1.0)
        pages.keep(browser, f"pair-{scheme}")
        looks.append(views(browser))
        check_accessibility(browser, f"pair-{scheme}")
        browser.size(390, 844, phone=True)
        browser.frames()
        assert browser.run("document.documentElement.scrollWidth") <= 390
        pages.keep(browser, f"pair-{scheme}-phone")
    assert all(a != b for a, b in zip(*looks)), "light and dark look the same"
    browser.scheme("light")


PAIR_CHECKS = [
    both_plans_have_one_time,
    both_plans_play_together,
    both_views_turn_together,
    changes_are_listed,
    both_plans_are_printed,
    pair_on_a_phone_and_in_the_dark,
]


def make_pair(pages: Pages) -> None:
    """Writes pick-and-place.json with other elbow angles and blends, and the page of both."""
    program = str(FIXTURES / "pick-and-place.json")
    kinds = ["--free", "e1,blends", "-o", "pair.json", "--overwrite"]
    told = pages.iiwasim("optimise", program, *kinds, "--page", "pair.html", "--json")
    (pages.folder / "pair-changes.json").write_text(told)
