#!/usr/bin/env python3
"""Opens the page of `iiwasim twin` with a simulated robot in a browser, and operates it like a
user.

    twin.py IIWASIM FOLDER [--minutes N] [--only CHECK]

IIWASIM is the program; screenshots are written to FOLDER. Frames, latency and memory are measured
over N minutes (default 2). --only runs one check, by its name. Exit code 1 when a check fails.
Needs Chromium and the packages in requirements.txt, next to this file.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import time
import urllib.error
import urllib.request
from pathlib import Path

from accessibility import check_accessibility
from checks import run_checks
from chromium import Browser
from latency import frames_latency_and_memory
from rig import Rig
from scene import TOOL
from twin_layout import (
    UNMET,
    controls_are_beside_the_arm,
    disabled_controls_say_why,
    empty_charts_say_what_will_appear,
    schemes_and_phones,
    stop_button_is_in_view,
)
from twins import FIXTURES, ODD, TO_AND_FRO, Mover, Twin, load, send, text

SCENE = "(drawArms(), document.getElementById('scene').toDataURL())"


def page_follows_the_robot(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    browser.until("document.getElementById('link').textContent === 'live'")
    browser.until("/excellent|good/.test(document.getElementById('state').textContent)")
    browser.until("document.getElementById('nearest').textContent.startsWith('Nearest obstacle: ')")
    pictures = set()
    mover = Mover(twin.rig)
    try:
        browser.until("live.health.status.state === 'running_motion'")
        # Between two runs, the robot is briefly at rest.
        for _ in range(100):
            time.sleep(0.7)
            before = len(pictures)
            pictures.add(browser.run(SCENE))
            if len(pictures) > before:
                twin.keep(browser, f"twin-moves-{before}")
            if len(pictures) == 5:
                break
        # The text shows the current position.
        written = "parseFloat(document.querySelector('#joints td:nth-child(2)').textContent)"
        assert browser.run(f"new Set([{written}, 1]).size") == 2
    finally:
        mover.end()
    assert len(pictures) == 5, "the arm looks the same at different times"
    browser.until("live.health.status.state === 'idle'")
    status = [twin.rig.program, "status", "--json", *twin.rig.drive_at]
    where = json.loads(subprocess.run(status, check=True, capture_output=True).stdout)["joints_rad"]
    browser.until(
        f"{json.dumps(where)}.every((q, j) => Math.abs(q - live.newest.joints_rad[j]) < 1e-6)"
    )


def tool_is_drawn(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    # Fixed poses, because the live robot may have noise; in one of them, each shape is in front of
    # the others.
    poses = [[0, 0.5, 0, -1.2, 0, 1, turn] for turn in (0, 1.5, 3, -1.5)]
    look = (
        f"{json.dumps(poses)}.map(q => (scene.show([{{ q, ghost: null }}]),"
        " document.getElementById('scene').toDataURL())).join()"
    )
    looks = [browser.run(look)]
    for i in range(len(TOOL)):
        looks.append(
            browser.run(
                f"(scene.fill({{ tool: around.tool.filter((_, k) => k !== {i}) }}), {look})"
            )
        )
    looks.append(browser.run(f"(scene.fill({{ tool: [] }}), {look})"))
    assert len(set(looks)) == len(TOOL) + 2, "a shape is not drawn"
    browser.run("scene.fill(around)")
    assert "tool" in text(browser, "legend"), text(browser, "legend")
    for _ in range(4):
        browser.run("scene.turn(0, 0, 1.4)")
    browser.frames()
    twin.keep(browser, "twin-tool")
    browser.click("#look")


def program_is_simulated_sent_and_replayed(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    for bad, why in (("{", "line 1"), ('{"version": 1, "motions": []}', "start")):
        browser.run(f"loadFile(new File([{json.dumps(bad)}], 'bad.json'))")
        browser.until(
            f"document.getElementById('program-said').textContent.includes({json.dumps(why)})"
        )
    load(browser, FIXTURES / "ten-motions.json")
    assert text(browser, "program-said") == ""
    planned = [twin.rig.program, "plan", FIXTURES / "ten-motions.json", "--no-output", "--json"]
    cycle_s = json.loads(subprocess.run(planned, check=True, capture_output=True).stdout)[
        "cycle_time_s"
    ]
    assert f"{cycle_s:.3f} s" in text(browser, "plan-figures") and "10" in text(
        browser, "plan-figures"
    )
    # The simulation starts to play automatically, next to the live robot.
    browser.until(
        "document.getElementById('mode').textContent === \"Live, with the plan's simulation\""
    )
    browser.until("shown.time > 1")
    pictures = {browser.run(SCENE)}
    twin.keep(browser, "twin-simulation")
    # In one script: on a slow machine, the simulation may end before a mouse event arrives.
    assert (
        browser.run(
            "(play(true), shown.time = 1, document.getElementById('play').click(), shown.playing)"
        )
        is False
    )
    assert text(browser, "play") == "Play"
    at = browser.run("shown.time")
    browser.frames()
    assert browser.run("shown.time") == at
    browser.run(
        "(() => { const it = document.getElementById('scrub'); it.value = 5; it.dispatchEvent(new "
        "Event('input')); })()"
    )
    browser.frames()
    assert text(browser, "clock") == "5.00 s"
    pictures.add(browser.run(SCENE))
    assert len(pictures) == 2
    browser.click("#live")
    browser.until("document.getElementById('mode').textContent === 'Live'")
    assert browser.run("document.getElementById('play').disabled")

    # Cancelled in the dialog.
    browser.click("#send")
    browser.until("document.getElementById('confirm').open")
    twin.keep(browser, "twin-confirm")
    browser.click("#confirm button[value=no]")
    browser.until("!document.getElementById('confirm').open")
    assert browser.run("desk.run") is None
    # Record the start of the motion, which the page drops at the end of the run.
    browser.run(
        "(() => { const known = remember; window.left_ = null;"
        " remember = it => { known(it); left_ = watched.left_s ?? left_ } })()"
    )
    send(browser)
    browser.until(
        "desk.run && desk.run.phase === 'running' && document.getElementById('send').disabled"
    )
    browser.until("document.getElementById('mode').textContent === 'Live'")
    twin.keep(browser, "twin-running")
    # Measured torques, with planned ones below, from the history of the page: on a busy machine,
    # the run may be over.
    browser.run("document.getElementById('history-torque').scrollIntoView({ block: 'center' })")
    browser.until("left_ !== null && live.newest.t_s - left_ > 3")
    # The sample with planned torques that is nearest to 2.5 s after the start: a busy page misses
    # samples.
    q, *both, planned = browser.run(
        "(() => { const from = i => Math.abs(history_.t_s[i] - left_ - 2.5);"
        " const at = [...Array(history_.count).keys()]"
        ".filter(i => !Number.isNaN(history_.rows[NUMBERS * i + PLANNED]))"
        ".reduce((a, b) => from(b) < from(a) ? b : a), i = NUMBERS * at;"
        " const seven = it => [...history_.rows.slice(i + it, i + it + 7)];"
        " return [seven(0), seven(MEASURED), seven(PLANNED), [...jointsAt(desk.plan.arms[0], "
        "history_.t_s[at] - left_)]] })()"
    )
    assert all(math.isfinite(nm) for row in both for nm in row), both
    ahead = [abs(a - b) for a, b in zip(planned, q)]
    assert max(ahead) < 0.1, f"the plan's time is off: {ahead} rad"
    twin.keep(browser, "twin-torques")
    browser.until("desk.run.phase === 'done'")
    assert browser.run("watched.from_rad") is None
    assert "Measured 7." in text(browser, "run-notes"), text(browser, "run-notes")
    browser.click("#replay")
    assert text(browser, "mode") == "Replay: not live"
    browser.until("shown.time > 1")
    off = browser.run(
        "Math.max(...[1, 2, 3, 4, 5, 6, 7].map(t => Math.max(...jointsAt(desk.run.arms[0], t).map("
        "(q, j) => Math.abs(q - jointsAt(desk.run.arms[1], t)[j])))))"
    )
    assert off < 0.01, f"plan and run are {off} rad apart"
    twin.keep(browser, "twin-replay")
    link = browser.run(
        "[...document.querySelectorAll('#files a')].map(it => [it.textContent, it.href])"
    )
    assert [name for name, _ in link] == ["Report", "Program", "Plan", "Run result"]
    browser.go(dict(link)["Report"])
    browser.until("document.documentElement?.dataset.drawnMs > ''")
    assert browser.run("report.arms.length") == 2
    twin.keep(browser, "twin-report")


def stop_stops(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    load(browser, twin.rig.folder / "to-and-fro.json")
    send(browser)
    browser.until("desk.run && desk.run.phase === 'running'")
    time.sleep(1)
    browser.click("#stop")
    browser.until("desk.run.phase === 'failed'")
    assert "stopped on request" in text(browser, "run")
    before = browser.run("live.newest.joints_rad")
    time.sleep(0.3)
    assert browser.run("live.newest.joints_rad") == before
    browser.click("#clear")
    browser.until("desk.plan === null")
    assert browser.run("document.getElementById('plan').hidden")


def escape_and_dialogs_stop(browser: Browser, twin: Twin) -> None:
    """Each way to stop stops a slow motion; Escape in a field or a dialog requests nothing."""
    twin.open(browser)
    program = twin.rig.folder / "slow.json"
    turned = [60, 20, 0, -70, 0, 90, 0]
    motion = {"type": "ptp", "joints_deg": turned, "velocity_rel": 0.01}
    program.write_text(json.dumps(TO_AND_FRO | {"motions": [motion]}))
    load(browser, program)

    browser.run("document.getElementById('position-name').focus()")
    orders = browser.run("link.count")
    browser.key("Escape")
    assert browser.run("document.activeElement === document.body"), (
        "Escape does not leave the field"
    )
    browser.run("confirmed('A question', [], 'Yes'), 1")
    browser.key("Escape")
    browser.until("!document.getElementById('confirm').open")
    assert browser.run("link.count") == orders, "Escape in a field or a dialog requests something"

    def with_the_key() -> None:
        browser.run("scrollTo(0, document.documentElement.scrollHeight)")
        browser.key("Escape")

    def in_the_dialog() -> None:
        browser.run(
            "window.sure = null, confirmed('A question', [], 'Yes').then(it => { window.sure = it "
            "}), 1"
        )
        browser.click("#confirm .stop")
        browser.until("window.sure === false && !document.getElementById('confirm').open")

    def on_the_full_screen() -> None:
        browser.click("#look-full")
        browser.until("!!document.fullscreenElement")
        browser.click(".view .stop")

    for stop in (with_the_key, in_the_dialog, on_the_full_screen):
        send(browser)
        browser.until(
            "desk.run && desk.run.phase === 'running' && live.health.status.state === "
            "'running_motion'"
        )
        stop()
        browser.until("desk.run.phase === 'failed'")
        assert "stopped on request" in text(browser, "run"), stop.__name__
        assert text(browser, "stop-said") == ""
    # A failed stop is reported in the visible header.
    browser.run("link.open = false")
    browser.click(".view .stop")
    browser.until("!document.fullscreenElement")
    browser.until("document.getElementById('stop-said').textContent.includes('cannot be reached')")
    assert not browser.run(f"{UNMET}([document.getElementById('stop-said')])")
    browser.run("link.open = true")
    browser.click("#clear")


def positions_are_kept(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    # The page asks for a name, and suggests one.
    browser.until("document.getElementById('position-name').value === 'P1'")
    browser.run("document.getElementById('position-name').value = ''")
    browser.click("#save button")
    browser.frames()
    assert browser.run("desk.positions.length") == 0, "a position without a name is saved"
    for count, name in ((1, "<i>first</i>"), (2, "P2")):
        if count == 1:
            browser.run(f"document.getElementById('position-name').value = {json.dumps(name)}")
        browser.click("#save button")
        browser.until(f"desk.positions.length === {count}")
        browser.until(f"document.getElementById('position-name').value === 'P{count + 1}'")
        twin.rig.run(Path("to-and-fro.json"), "--no-output", "--move-to-start=100")
    browser.frames()
    assert "<i>first</i>" in text(browser, "positions")
    names = "desk.positions.map(it => it.name).join()"
    # The same name is refused; the next request removes the error.
    browser.run("document.getElementById('position-name').value = 'P2'")
    browser.click("#save button")
    browser.until("document.getElementById('positions-said').textContent.includes('already')")
    browser.click("#positions tr:nth-child(2) [aria-label='Move P2 up']")
    browser.until(f"{names} === 'P2,<i>first</i>'")
    assert text(browser, "positions-said") == ""
    browser.click("#positions tr:nth-child(1) [aria-label='Move P2 down']")
    browser.until(f"{names} === '<i>first</i>,P2'")
    assert browser.run(
        "document.querySelector('#positions [aria-label=\"Move P2 down\"]').disabled"
    )
    browser.click("#positions tr:nth-child(2) .name")
    browser.until("document.getElementById('rename').open")
    twin.keep(browser, "twin-rename")
    browser.run("document.getElementById('new-name').value = 'home'")
    browser.click("#rename button[value=yes]")
    browser.until(f"{names} === '<i>first</i>,home'")
    browser.click("#make button")
    browser.until("desk.plan && desk.plan.name.startsWith('positions')")
    twin.keep(browser, "twin-positions")
    # The program refers to positions by name.
    link = browser.run(
        "[...document.querySelectorAll('#files a')].find(it => it.textContent === 'Program').href"
    )
    program = json.loads(urllib.request.urlopen(link, timeout=10).read())
    assert program["motions"][0]["frame"] == "home" and "home" in program["frames"], program
    # Positions are kept across restarts of the twin.
    twin.process.terminate()
    twin.process.wait(60)
    browser.go("about:blank")
    browser.complaints.clear()
    twin.start()
    twin.open(browser)
    browser.until(f"{names} === '<i>first</i>,home'")
    for count in (1, 0):
        browser.click("#positions [aria-label^=Remove]")
        browser.until(f"desk.positions.length === {count}")


def nothing_is_armed_after_a_broken_file(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    load(browser, FIXTURES / "ten-motions.json")
    assert browser.run("document.getElementById('plan-warnings').children.length") == 0
    browser.run("loadFile(new File(['{'], 'bad.json'))")
    browser.until("document.getElementById('program-said').textContent.includes('line 1')")
    browser.until("desk.plan === null && document.getElementById('plan').hidden")
    browser.until(
        "document.getElementById('program-said').textContent.includes('Nothing is loaded')"
    )
    twin.keep(browser, "twin-broken")
    # The next program has a warning, and the previous error is gone.
    program = twin.rig.folder / "odd.json"
    program.write_text(json.dumps(ODD))
    load(browser, program)
    assert text(browser, "program-said") == ""
    assert "Warning: " in text(browser, "plan-warnings"), text(browser, "plan-warnings")
    twin.keep(browser, "twin-warning")
    browser.click("#send")
    browser.until("document.getElementById('confirm').open")
    assert "Warning: " in text(browser, "confirm-text")
    browser.click("#confirm button[value=no]")
    browser.click("#clear")


def the_last_minutes_are_plotted(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    mover = Mover(twin.rig)
    try:
        browser.until("live.health.status.state === 'running_motion'")
        browser.run("document.getElementById('history-joints').scrollIntoView({ block: 'center' })")
        browser.until("isHistorySeen")
        browser.until("1000 * (speedNow() ?? 0) > 100")
        browser.until(
            "document.getElementById('speed-now').textContent.includes('The flange moves at ')"
        )
        twin.keep(browser, "twin-history")
    finally:
        mover.end()
    # Positions of the robot by their own stamps, each once.
    assert browser.run(
        "history_.t_s.subarray(0, history_.count).every((t, i, all) => i === 0 || t > all[i - 1])"
    )
    browser.until("speedNow() < 0.001")
    newest = (
        "[...history_.rows.slice(NUMBERS * (history_.count - 1), NUMBERS * (history_.count - 1) + "
        "7)]"
    )
    browser.until(f"{newest}.every((q, j) => Math.abs(q - live.newest.joints_rad[j]) < 1e-3)")
    look = "(drawHistory(), document.getElementById('history-joints').toDataURL())"
    before = browser.run(look)
    browser.click("#history-120")
    assert browser.run("history_.span") == 120 and browser.run(look) != before
    assert (
        browser.run("document.getElementById('history-120').getAttribute('aria-pressed')") == "true"
    )
    # Two minutes are kept, within the capacity.
    kept = browser.run(
        "(() => { const t = history_.t_s[history_.count - 1];"
        " for (let i = 1; i < 40000; i++) remember({ t_s: t + 0.01 * i, joints_rad: "
        "live.newest.joints_rad });"
        " return [history_.count, history_.t_s[history_.count - 1] - history_.t_s[0]] })()"
    )
    assert kept[0] <= 16_000 and kept[1] >= 119, kept
    # A restarted drive has other times.
    browser.until("history_.count < 10_000")


def joints_are_turned(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    browser.until(
        "live.health.status.state === 'idle' && document.body.classList.contains('simulated')"
    )
    assert browser.run("getComputedStyle(document.getElementById('simulated')).display") != "none"
    # The joint table fits into its column.
    assert browser.run(
        "document.querySelector('aside').scrollWidth <= document.querySelector('aside').clientWidth"
    )
    joint = "live.newest.joints_rad[2] * DEG"
    before = browser.run(joint)
    browser.run("document.getElementById('jog-step').value = '7'")
    for name, by in (("Jog A3 in positive direction", 7), ("Jog A3 in negative direction", 0)):
        browser.until(f"!document.querySelector('[aria-label=\"{name}\"]').disabled")
        browser.click(f"[aria-label='{name}']")
        browser.until(f"Math.abs({joint} - {before + by}) < 0.01")
        assert text(browser, "jog-said") == ""
    twin.keep(browser, "twin-jog")
    # A refusal is reported, and an invalid step is not requested.
    why = browser.run("order('jog', { joint: 3, step_deg: 46 }).then(() => '', it => it.message)")
    assert "45 deg at most" in why, why
    # The buttons are hidden unless the drive reports a simulated robot.
    # In one script, as the next message of the drive restores the state.
    shown = browser.run(
        "(link.takes.health({ status: { ...live.health.status, simulated: false } }),"
        " getComputedStyle(document.querySelector('td.jog')).display)"
    )
    assert shown == "none", shown


def nothing_is_called_live_before_data(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    browser.run("([live.newest, live.fresh] = [null, false], link.takes.live = () => {}, 1)")
    browser.until("document.getElementById('mode').textContent !== 'Live'")
    browser.until("document.getElementById('link').textContent !== 'live'")
    # The page before its first message.
    page = urllib.request.urlopen(twin.address, timeout=10).read().decode()
    assert '<span id="link" class="chip waiting">connecting</span>' in page
    green = browser.run(
        "(() => { const it = document.getElementById('link'); it.className = 'chip';"
        " const live = getComputedStyle(it).backgroundColor; it.className = 'chip waiting';"
        " return [live, getComputedStyle(it).backgroundColor] })()"
    )
    assert green[0] != green[1], green


def people_without_a_mouse_are_served(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    load(browser, FIXTURES / "ten-motions.json")
    browser.run("document.getElementById('position-name').value = 'there'")
    # Loading moves the button, so that a mouse click could miss it.
    browser.run("document.querySelector('#save button').click()")
    browser.until("desk.positions.length === 1")
    for scheme in ("light", "dark"):
        browser.scheme(scheme)
        check_accessibility(browser, f"twin, {scheme}")
        browser.click("#send")
        browser.until("document.getElementById('confirm').open")
        check_accessibility(browser, f"twin's question, {scheme}")
        browser.click("#confirm button[value=no]")
    browser.scheme("light")
    browser.click("#positions [aria-label^=Remove]")
    browser.until("desk.positions.length === 0")
    browser.click("#clear")


def outputs_are_switched(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    browser.until("live.health.io.length > 1")
    row = "[...document.querySelectorAll('#io tr')].find(it => it.textContent.includes('LEDBlue'))"
    index = browser.run(f"[...document.querySelectorAll('#io tr')].indexOf({row}) + 1")
    browser.click(f"#io tr:nth-child({index}) button")
    browser.until("document.getElementById('confirm').open")
    browser.click("#confirm-yes")
    browser.until(f"{row}.children[1].textContent === 'on'")


def too_near_is_not_sent(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    back = {
        "version": 1,
        "start": {"joints_deg": [0] * 7},
        "motions": [{"type": "ptp", "joints_deg": [0, -90, 0, 0, 0, 0, 0]}],
    }
    program = twin.rig.folder / "back.json"
    program.write_text(json.dumps(back))
    load(browser, program)
    assert "Cannot be sent: " in text(browser, "plan-refused")
    assert browser.run("document.getElementById('send').disabled")
    # The reason is the tooltip too, and the text that describes the button.
    assert browser.run("document.getElementById('send').title") == text(browser, "plan-refused")
    described = "document.getElementById('send').getAttribute('aria-describedby').split(' ')"
    assert "plan-refused" in browser.run(described)
    # The server also refuses, not only the page.
    why = browser.run(
        "order('send', { plan: desk.plan.id, move_to_start: true }).then(() => '', it => "
        "it.message)"
    )
    assert why.startswith("the program is not sent: "), why
    browser.until("shown.time > 0.8")
    twin.keep(browser, "twin-too-near")
    browser.click("#clear")


def drive_goes_and_comes_back(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    twin.rig.drive.kill()
    twin.rig.drive.wait()
    # The banner, the link and the mode are drawn by different messages.
    browser.until("document.getElementById('banner').textContent.includes('no drive answers')")
    browser.until("!document.getElementById('banner').hidden")
    browser.until("document.getElementById('link').textContent === 'not live'")
    browser.until("document.getElementById('mode').textContent === 'Not live: last known position'")
    twin.keep(browser, "twin-no-drive")
    twin.rig.start_drive()
    browser.until("document.getElementById('link').textContent === 'live'")
    browser.until("document.getElementById('banner').hidden")


def twin_ends(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    token = twin.address.split("token=")[1]
    twin.process.terminate()
    twin.process.wait(60)
    browser.until(
        "document.getElementById('banner').textContent.includes('The twin cannot be reached')"
    )
    twin.keep(browser, "twin-gone")
    # The browser would log failed connections.
    browser.go("about:blank")
    browser.complaints.clear()
    # A new twin has a new token.
    twin.start()
    assert token not in twin.address
    try:
        urllib.request.urlopen(twin.address.split("?")[0] + f"?token={token}", timeout=10)
        raise AssertionError("the old token is let in")
    except urllib.error.HTTPError as error:
        assert error.code == 403, error.code


CHECKS = [
    page_follows_the_robot,
    tool_is_drawn,
    program_is_simulated_sent_and_replayed,
    stop_stops,
    controls_are_beside_the_arm,
    disabled_controls_say_why,
    empty_charts_say_what_will_appear,
    stop_button_is_in_view,
    escape_and_dialogs_stop,
    positions_are_kept,
    nothing_is_armed_after_a_broken_file,
    the_last_minutes_are_plotted,
    joints_are_turned,
    nothing_is_called_live_before_data,
    people_without_a_mouse_are_served,
    outputs_are_switched,
    too_near_is_not_sent,
    schemes_and_phones,
    drive_goes_and_comes_back,
    twin_ends,
    frames_latency_and_memory,
]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("program", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--minutes", type=float, default=2)
    parser.add_argument("--only", choices=[check.__name__ for check in CHECKS], metavar="CHECK")
    options = parser.parse_args()
    checks = [check for check in CHECKS if options.only in (None, check.__name__)]
    with Rig(options.program, options.folder) as rig:
        code = run_checks("the twin", checks, Twin(rig, options.minutes))
    raise SystemExit(code)


if __name__ == "__main__":
    main()
