"""A headless browser, controlled by the DevTools protocol."""

from __future__ import annotations

import base64
import json
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import websocket


class Browser:
    """The Chromium of the system with one page. `complaints` are errors and warnings in its
    console, and uncaught exceptions.
    """

    def __init__(self) -> None:
        program = shutil.which("chromium") or shutil.which("chromium-browser")
        if program is None:
            raise SystemExit("chromium is not installed: apt-get install chromium")
        self.folder = tempfile.mkdtemp(prefix="iiwasim-browser-")
        self.process = subprocess.Popen(
            [
                program,
                "--headless=new",
                # A container has neither a sandbox nor a graphics card.
                "--no-sandbox",
                "--use-angle=swiftshader",
                "--enable-unsafe-swiftshader",
                # Without a graphics card, everything except WebGL is ten times as fast in software.
                "--disable-gpu-rasterization",
                "--disable-gpu-compositing",
                "--hide-scrollbars",
                "--remote-debugging-port=0",
                "--remote-allow-origins=*",
                f"--user-data-dir={self.folder}",
                "about:blank",
            ],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self.count = 0
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.events: list[dict] = []
        port, path = self._address()
        self.socket = websocket.create_connection(f"ws://127.0.0.1:{port}{path}", timeout=600)
        self.session = None
        target = self.call("Target.getTargets")["targetInfos"]
        page = next(info["targetId"] for info in target if info["type"] == "page")
        attached = self.call("Target.attachToTarget", targetId=page, flatten=True)
        self.session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def _address(self) -> tuple[str, str]:
        file = Path(self.folder, "DevToolsActivePort")
        until = time.monotonic() + 300
        while time.monotonic() < until:
            if file.exists() and len(lines := file.read_text().split("\n")) >= 2:
                return lines[0], lines[1]
            if self.process.poll() is not None:
                raise SystemExit(f"chromium ended with {self.process.returncode}")
            time.sleep(0.05)
        raise SystemExit("chromium did not start within 5 minutes")

    def close(self) -> None:
        """Ends the browser."""
        self.socket.close()
        self.process.terminate()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def call(self, method: str, **parameters: object) -> dict:
        """Sends a command and waits for the answer."""
        self.count += 1
        number = self.count
        message = {"id": number, "method": method, "params": parameters}
        if self.session is not None:
            message["sessionId"] = self.session
        self.socket.send(json.dumps(message))
        while True:
            answer = json.loads(self.socket.recv())
            if answer.get("id") == number:
                if "error" in answer:
                    raise AssertionError(f"{method}: {answer['error']}")
                return answer["result"]
            self._event(answer)

    def _event(self, event: dict) -> None:
        method, parameters = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = parameters["exceptionDetails"]
            thrown = details.get("exception", {}).get("description", details["text"])
            self.complaints.append(f"exception: {thrown}")
        elif method == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "warning"):
            words = [str(it.get("value", it.get("description"))) for it in parameters["args"]]
            self.complaints.append(f"{parameters['type']}: {' '.join(words)}")
        elif method == "Log.entryAdded" and parameters["entry"]["level"] in ("error", "warning"):
            entry = parameters["entry"]
            # Ignored: a driver without a graphics card warns about reading pixels.
            if "GPU stall due to ReadPixels" not in entry["text"]:
                self.complaints.append(f"{entry['level']}: {entry['text']}")
        elif method == "Network.requestWillBeSent":
            self.requests.append(parameters["request"]["url"])
        self.events.append(event)

    def run(self, script: str) -> object:
        """Runs a script in the page and returns its value; promises are awaited."""
        answer = self.call(
            "Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True
        )
        if "exceptionDetails" in answer:
            raise AssertionError(f"{script}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def open(self, file: Path, fragment: str = "") -> None:
        """Opens a file and waits until it is loaded and drawn."""
        self.go(file.resolve().as_uri() + fragment)
        self.until(
            "document.readyState === 'complete' && document.documentElement?.dataset.drawnMs > ''"
        )
        self.frames()

    def go(self, url: str) -> None:
        """Opens a URL."""
        self.events.clear()
        self.requests.clear()
        self.call("Page.navigate", url="about:blank")
        self.call("Page.navigate", url=url)

    def frames(self) -> None:
        """Waits until requested changes are on the screen."""
        self.run(
            "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))"
        )

    def spare_frames(self) -> None:
        """Limits pages that are opened later to four frames per second.

        Without a graphics card, a page that draws all the time keeps a core busy. `allFrames`, set
        to true in a page, ends this.
        """
        script = """(() => {
            const next = window.requestAnimationFrame.bind(window);
            let drawn = 0;
            window.requestAnimationFrame = done => next(function frame(now) {
                if (!window.allFrames && now !== drawn && now - drawn < 250) return next(frame);
                drawn = now;
                done(now);
            });
        })()"""
        self.call("Page.addScriptToEvaluateOnNewDocument", source=script)

    def until(self, script: str, seconds: float = 300) -> None:
        """Waits until a script returns true."""
        until = time.monotonic() + seconds
        while not self.run(script):
            if time.monotonic() > until:
                raise AssertionError(f"not within {seconds} s: {script}")
            time.sleep(0.03)

    def size(self, width: int, height: int, ratio: float = 1, phone: bool = False) -> None:
        """Sets the screen size, in CSS px."""
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=ratio,
            mobile=phone,
        )

    def scheme(self, name: str) -> None:
        """Sets the colour scheme: light or dark."""
        features = [{"name": "prefers-color-scheme", "value": name}]
        self.call("Emulation.setEmulatedMedia", features=features)
        self.frames()

    def picture(self, whole: bool = False) -> bytes:
        """A PNG of the screen, or of the whole page."""
        clip = {}
        if whole:
            content = self.call("Page.getLayoutMetrics")["cssContentSize"]
            clip = {"clip": {**content, "scale": 1}}
        answer = self.call(
            "Page.captureScreenshot", format="png", captureBeyondViewport=whole, **clip
        )
        return base64.b64decode(answer["data"])

    def pdf(self) -> bytes:
        """The page printed on A4."""
        answer = self.call(
            "Page.printToPDF",
            printBackground=True,
            preferCSSPageSize=True,
            paperWidth=8.27,
            paperHeight=11.69,
        )
        return base64.b64decode(answer["data"])

    def click(self, selector: str) -> None:
        """Clicks the centre of an element, again if the page moved under the mouse."""
        told = f"event.target.closest?.({json.dumps(selector)})"
        for _ in range(10):
            self.run(
                "window.met = 'nothing yet';"
                f"addEventListener('click', event => {{ window.met = !!{told} }}, {{ capture: "
                f"true, once: true }})"
            )
            box = self.box(selector)
            self.press(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
            # A busy browser confirms a click before the page receives it; an immediate retry would
            # click twice.
            until = time.monotonic() + 30
            while (
                met := self.run("window.met ?? 'another page'")
            ) == "nothing yet" and time.monotonic() < until:
                time.sleep(0.02)
            if met is True or met == "another page":
                return
        raise AssertionError(f"the mouse does not meet {selector}")

    def box(self, selector: str) -> dict:
        """Scrolls an element into view, and returns its box."""
        find = f"document.querySelector({json.dumps(selector)})"
        self.run(f"{find}.scrollIntoView({{ block: 'center' }})")
        # The mouse hits the elements on the screen, so wait for the scrolled frame.
        self.frames()
        script = f"""(() => {{
            const found = {find};
            const {{ x, y, width, height }} = found.getBoundingClientRect();
            return {{ x, y, width, height }};
        }})()"""
        box = self.run(script)
        assert isinstance(box, dict) and box["width"] > 0 and box["height"] > 0, selector
        return box

    def press(self, x: float, y: float, count: int = 1) -> None:
        """Clicks at a place, once or twice."""
        for i in range(count):
            self._mouse("mousePressed", x, y, "left", True, count=i + 1)
            self._mouse("mouseReleased", x, y, "left", False, count=i + 1)
        self.frames()

    def move(self, x: float, y: float) -> None:
        """Moves the mouse."""
        self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
        self.frames()

    def drag(
        self, places: list[tuple[float, float]], button: str = "left", shift: bool = False
    ) -> None:
        """Drags the mouse through places."""
        for i, (x, y) in enumerate(places):
            kind = "mousePressed" if i == 0 else "mouseMoved"
            self._mouse(kind, x, y, button, True, shift)
        self._mouse("mouseReleased", *places[-1], button, False, shift)
        self.frames()

    def _mouse(
        self,
        kind: str,
        x: float,
        y: float,
        button: str,
        down: bool,
        shift: bool = False,
        count: int = 1,
    ) -> None:
        self.call(
            "Input.dispatchMouseEvent",
            type=kind,
            x=x,
            y=y,
            button=button,
            buttons={"left": 1, "right": 2}[button] if down else 0,
            modifiers=8 if shift else 0,
            clickCount=count,
        )

    def wheel(self, x: float, y: float, down: float) -> None:
        """Turns the wheel at a place, in px."""
        self.call("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=down)
        self.frames()

    def fingers(self, ways: list[list[tuple[float, float]]]) -> None:
        """Touches the screen with fingers, moves each along its path, and lifts them."""
        self.touch([list(places) for places in zip(*ways, strict=True)])

    def touch(self, places: list[list[tuple[float, float]]]) -> None:
        """Sends touch events for fingers: start, moves, end."""
        for i, fingers in enumerate(places):
            points = [{"x": x, "y": y, "id": k} for k, (x, y) in enumerate(fingers)]
            self.call(
                "Input.dispatchTouchEvent",
                type="touchMove" if i else "touchStart",
                touchPoints=points,
            )
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
        self.frames()

    def key(self, key: str, text: str = "", shift: bool = False) -> None:
        """Presses a key."""
        codes = {
            "Tab": 9,
            "End": 35,
            "Home": 36,
            "ArrowLeft": 37,
            "ArrowRight": 39,
            "Enter": 13,
            "Escape": 27,
        }
        for kind in ("keyDown", "keyUp"):
            extra = {"text": text} if text and kind == "keyDown" else {}
            extra["modifiers"] = 8 if shift else 0
            code = codes.get(key, 0)
            self.call(
                "Input.dispatchKeyEvent", type=kind, key=key, windowsVirtualKeyCode=code, **extra
            )
        self.frames()
