"""Checks of the twin's page: places of controls on screens, and texts for missing data."""

from __future__ import annotations

import json

from chromium import Browser
from twins import FIXTURES, Twin, load, send, text

# The screens of a phone, a laptop and a desk.
SCREENS = [(390, 844), (1300, 900), (1920, 1080)]

# Elements that an expression names and that the mouse does not meet at their centre.
UNMET = """(elements => [...elements].filter(it => {
    const { x, y, width, height } = it.getBoundingClientRect();
    const met = document.elementFromPoint(x + width / 2, y + height / 2);
    return !it.contains(met) && !it.closest('label')?.contains(met);
}).map(it => it.outerHTML))"""

# Buttons, fields and links that are drawn, but those in dialogs and the ones that open a file
# dialog.
CONTROLS = """[...document.querySelectorAll('main :is(button, input:not([type=file]), a)')]
    .filter(it => it.offsetWidth && !it.disabled)"""


def controls_are_beside_the_arm(browser: Browser, twin: Twin) -> None:
    """Without scrolling, a screen holds the arm and the controls that load, send, switch and
    stop."""
    twin.open(browser)
    always = ["#scene", "#stop", ".program label", "#send", "#live", "#simulation", "#replay"]
    for state, more in (
        ("empty", ["#plan-empty", "#send-why", "#player-why"]),
        ("plan", ["#plan-figures", "#clear", "#plan-nearest", "#player-why"]),
    ):
        if state == "plan":
            load(browser, FIXTURES / "ten-motions.json")
        for width, height in [*SCREENS, (1000, 700)]:
            browser.size(width, height, phone=width < 500)
            browser.run("scrollTo(0, 0)")
            browser.frames()
            boxes = browser.run(
                f"{json.dumps(always + more)}.map(it => {{"
                " const { left, right, top, bottom } ="
                " document.querySelector(it).getBoundingClientRect();"
                " return [it, left, right, top, bottom] })"
            )
            outside = [
                (name, *box)
                for name, *box in boxes
                if not (0 <= box[0] < box[1] <= width and 0 <= box[2] < box[3] <= height)
            ]
            assert not outside, f"{state}, {width} x {height}: {outside}"
            _, left, right, top, bottom = boxes[0]
            assert right - left >= 300 and bottom - top >= 300, (width, height, boxes[0])
            met = f"{UNMET}(document.querySelectorAll('{', '.join(always)}'))"
            assert not (unmet := browser.run(met)), (state, width, unmet)
            (twin.rig.folder / f"twin-{state}-{width}.png").write_bytes(browser.picture())
    browser.size(1280, 1000)
    browser.click("#clear")
    browser.until("desk.plan === null")


# Visible controls that are disabled: the reason in the tooltip, and texts that describe them.
DISABLED = """[...document.querySelectorAll(':disabled')].filter(it => it.offsetWidth).map(it => [
    it.id || it.getAttribute('aria-label'), it.title,
    (it.getAttribute('aria-describedby') ?? '').split(' ').map(id => document.getElementById(id))
        .filter(text => text?.offsetWidth).map(text => text.textContent).join(' ')])"""


def disabled_controls_say_why(browser: Browser, twin: Twin) -> None:
    twin.open(browser)

    def reasons() -> dict[str, str]:
        found = {}
        for name, title, described in browser.run(DISABLED):
            # A plan that cannot be sent has its reason in a note, others beside the button.
            assert title and title in described, f"{name}: {title!r}, described by {described!r}"
            found[name] = title
        return found

    browser.until("live.health.status.state === 'idle'")
    moves = "Play and the time slider work in Simulation and Replay."
    player = {"play": moves, "scrub": moves}
    assert reasons() == player | {
        "simulation": "Simulation needs a loaded program.",
        "replay": "Replay needs a recorded run on the robot.",
        "send": "First load a program, or create one from saved positions.",
    }
    load(browser, twin.rig.folder / "to-and-fro.json")
    assert reasons() == {"replay": "Replay needs a recorded run on the robot."}
    # The robot is away from the start: the question has a box to tick.
    browser.run("confirmed('A question', [], 'Yes', 'Move to the start'), 1")
    assert reasons()["confirm-yes"] == "Tick the move to the program's start first."
    browser.run("document.getElementById('move-to-start').click()")
    assert "confirm-yes" not in reasons() and text(browser, "confirm-why") == ""
    browser.run("document.getElementById('confirm').close()")
    send(browser)
    browser.until("desk.run?.phase === 'running' && live.health.status.state === 'running_motion'")
    running = "A program is running: wait for its end, or stop the robot."
    jog = 'Jogging needs a robot at rest with an open session; its state is "running motion".'
    assert reasons() == player | {
        "replay": "Replay is available after the run.",
        "send": running,
        "clear": running,
    } | {
        f"Jog A{j} in {way} direction": jog for j in range(1, 8) for way in ("positive", "negative")
    }
    browser.click("#stop")
    browser.until("desk.run.phase === 'failed' && live.health.status.state === 'idle'")
    browser.click("#clear")
    browser.until("desk.plan === null")
    # First and last saved position: the arrow's tooltip describes it.
    browser.run("link.takes.positions([{ id: 1, name: 'P1', joints_rad: [0, 0, 0, 0, 0, 0, 0] }])")
    arrows = "[...document.querySelectorAll('#positions :disabled')].map(it => it.title)"
    assert browser.run(arrows) == ["P1 is already first", "P1 is already last"]
    browser.run("link.takes.positions([])")


def empty_charts_say_what_will_appear(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    browser.run("link.takes.live = () => {}, [history_.count, history_.places] = [0, []], 1")
    texts = (
        "(drawHistory(), [...document.querySelectorAll('.empty')].filter(it => it.offsetWidth)"
        ".map(it => it.textContent))"
    )
    joints, speed, torque = browser.run(texts)
    assert joints == "Positions of A1 to A7 appear here as soon as the robot sends them."
    assert speed == "The speed appears here as soon as the robot sends positions."
    assert torque.startswith("Measured torques appear here if the drive reports them")
    twin.keep(browser, "twin-empty-charts")
    # One position without torques; a second one makes a speed, and measured torques are the last.
    sample = "remember({ t_s: 1e6 + %s, joints_rad: [0, 0, 0, 0, 0, 0, 0], torque_nm: %s }), "
    assert browser.run(f"({sample % (0, 'null')} {texts})") == [speed, torque]
    assert browser.run(f"({sample % (0.1, 'null')} {texts})") == [torque]
    assert browser.run(f"({sample % (0.2, '[0, 0, 0, 0, 0, 0, 0]')} {texts})") == []


def stop_button_is_in_view(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    load(browser, FIXTURES / "ten-motions.json")
    for width, height in SCREENS:
        browser.size(width, height, phone=width < 500)
        browser.frames()
        for share in (0, 0.2, 0.4, 0.6, 0.8, 1):
            browser.run(
                f"scrollTo(0, {share} * (document.documentElement.scrollHeight - innerHeight))"
            )
            browser.frames()
            assert not (unmet := browser.run(f"{UNMET}([document.getElementById('stop')])")), (
                width,
                share,
                unmet,
            )
            assert share == 0 or browser.run("scrollY") > 0, f"{width} px: nothing to scroll"
        # At the upper and the lower edge of the screen, no control is behind the header.
        for edge in ("start", "end"):
            script = (
                f"{CONTROLS}.flatMap(it => (it.scrollIntoView({{ block: '{edge}' }}), "
                f"{UNMET}([it])))"
            )
            assert not (unmet := browser.run(script)), (width, edge, unmet)
        # In a dialog that is longer than the screen.
        browser.run("confirmed('A question', Array(60).fill('A line'), 'Yes', 'Move'), 1")
        for share in (0, 0.5, 1):
            where = "document.getElementById('confirm')"
            browser.run(
                f"{where}.scrollTop = {share} * ({where}.scrollHeight - {where}.clientHeight)"
            )
            browser.frames()
            script = f"{UNMET}(document.querySelectorAll('#confirm .stop'))"
            assert not (unmet := browser.run(script)), (width, share, unmet)
            assert share == 0 or browser.run(f"{where}.scrollTop") > 0, (
                f"{width} px: nothing to scroll"
            )
        for scheme in ("light", "dark"):
            browser.scheme(scheme)
            (twin.rig.folder / f"twin-stop-dialog-{width}-{scheme}.png").write_bytes(
                browser.picture()
            )
        browser.run("document.getElementById('confirm').close()")
        for scheme in ("light", "dark"):
            browser.scheme(scheme)
            browser.run("document.getElementById('send').scrollIntoView({ block: 'center' })")
            browser.frames()
            (twin.rig.folder / f"twin-stop-{width}-{scheme}.png").write_bytes(browser.picture())
        browser.scheme("light")
        browser.run("askForName(1, 'a name'), 1")
        assert not (unmet := browser.run(f"{UNMET}(document.querySelectorAll('#rename .stop'))")), (
            width,
            unmet,
        )
        browser.run("document.getElementById('rename').close()")
    browser.size(1280, 1000)
    browser.click("#look-full")
    browser.until("!!document.fullscreenElement")
    browser.frames()
    assert not (unmet := browser.run(f"{UNMET}(document.querySelectorAll('.view .stop'))")), unmet
    browser.click("#look-full")
    browser.until("!document.fullscreenElement")
    browser.click("#clear")


def schemes_and_phones(browser: Browser, twin: Twin) -> None:
    twin.open(browser)
    load(browser, FIXTURES / "ten-motions.json")
    for scheme in ("light", "dark"):
        browser.size(1280, 1000)
        browser.scheme(scheme)
        twin.keep(browser, f"twin-{scheme}")
        browser.size(390, 844, phone=True)
        browser.frames()
        assert browser.run("document.documentElement.scrollWidth") <= 390
        twin.keep(browser, f"twin-phone-{scheme}")
    browser.size(1280, 1000)
    browser.click("#clear")
