"""Checks of playback: the play button, the speed, the timeline and the rows of the table."""

from __future__ import annotations

import time

from chromium import Browser
from pages import CLOCK, SCENE, Pages, desk, seek


def speed(browser: Browser, factor: float) -> None:
    script = f"""(() => {{
        const speed = document.getElementById("speed");
        speed.value = "{factor:g}";
        speed.dispatchEvent(new Event("change", {{ bubbles: true }}));
    }})()"""
    browser.run(script)


def buttons_do_what_they_say(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("ten-motions"))
    assert browser.run(CLOCK) == 0
    before = browser.run(SCENE)
    # Slowly, so that a busy machine does not reach the end before the pause.
    speed(browser, 0.25)
    browser.click("#play")
    assert browser.run("document.getElementById('play').textContent") == "Pause"
    browser.until(f"{CLOCK} > 0.3")
    browser.click("#play")
    paused = browser.run(CLOCK)
    assert browser.run("document.getElementById('play').textContent") == "Play"
    time.sleep(0.3)
    browser.frames()
    assert browser.run(CLOCK) == paused, "the time goes on after a pause"
    assert browser.run(SCENE) != before

    def pace(factor: float) -> float:
        """Page time per second of real time."""
        seek(browser, 0)
        speed(browser, factor)
        # Frames may be rare. Each advances the page by the time since the last one, at most 1 s.
        script = """(async () => {
            document.getElementById("play").click();
            const frame = () => new Promise(done => requestAnimationFrame(done));
            for (let i = 0; i < 3; i++) await frame();
            let [before, t, sum_s] = [await frame(), state.time, 0];
            while (sum_s < 1.5) {
                const now = await frame();
                sum_s += Math.min((now - before) / 1000, 1);
                before = now;
            }
            const passed = state.time - t;
            document.getElementById("play").click();
            return passed / sum_s;
        })()"""
        return float(browser.run(script))

    for factor in (0.25, 1, 2):
        found = pace(factor)
        assert 0.6 * factor < found < 1.4 * factor, f"{found} at a speed of {factor}"

    # To the end, and again from the start.
    speed(browser, 10)
    seek(browser, 7.0)
    browser.click("#play")
    browser.until("!state.playing")
    browser.until(f"Math.abs({CLOCK} - report.arms[0].end_s) < 2e-3")
    speed(browser, 0.25)
    browser.click("#play")
    browser.until(f"{CLOCK} < 5")
    speed(browser, 10)
    browser.until("!state.playing")

    box = browser.box("#scrub")
    browser.press(box["x"] + 0.75 * box["width"], box["y"] + box["height"] / 2)
    share = browser.run("state.time / report.arms[0].end_s")
    assert 0.7 < share < 0.8, share


def timeline_and_table_are_linked(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("waits-and-stops"))
    rows = browser.run("document.querySelectorAll('#table tbody tr').length")
    assert rows == browser.run("report.figures.motions.length") == 8
    before = browser.run(SCENE)
    box = browser.box("#timeline")
    browser.press(box["x"] + 0.6 * box["width"], box["y"] + 15)
    t = browser.run("state.time")
    share = t / browser.run("report.arms[0].end_s")
    assert 0.5 < share < 0.65, share
    current = browser.run("document.querySelector('#table tr.current td').textContent")
    assert browser.run(f"String(pieceAt({t}).motion)") == current
    assert browser.run(SCENE) != before
    browser.click("#table tbody tr:nth-child(2) td")
    assert abs(browser.run("state.time - report.figures.motions[1].start_s")) < 1e-9
    # Dragging sets the time.
    box = browser.box("#timeline")
    y = box["y"] + 15
    browser.drag([(box["x"] + 100, y), (box["x"] + 200, y), (box["x"] + 400, y)])
    share = browser.run("state.time / report.arms[0].end_s")
    assert abs(share - (400 - 56) / (box["width"] - 64)) < 0.01, share


PLAYBACK_CHECKS = [buttons_do_what_they_say, timeline_and_table_are_linked]
