"""A browser without a window, told what to do by the DevTools protocol through a pair of pipes."""

import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from pathlib import Path
from typing import Any, Self

NAMES = ("chromium-headless-shell", "chrome-headless-shell", "chromium", "chromium-browser", "google-chrome")
FLAGS = (
    "--headless", "--no-sandbox", "--remote-debugging-pipe", "--hide-scrollbars", "--no-first-run",
    "--autoplay-policy=user-gesture-required", "--disable-gpu",
    # All pages in one process: kernels that one of them has compiled are there for the next.
    "--renderer-process-limit=1", "--disable-site-isolation-trials",
    # A mouse, which a machine for tests has not: it hovers, and points finely.
    "--blink-settings=primaryHoverType=2,availableHoverTypes=2,primaryPointerType=4,availablePointerTypes=4",
)  # fmt: skip
# The browser reads from 3 and writes to 4.
_BEGIN = """
import fcntl, os, sys
reads, writes = (fcntl.fcntl(int(end), fcntl.F_DUPFD, 10) for end in sys.argv[1:3])
os.dup2(reads, 3)
os.dup2(writes, 4)
os.execv(sys.argv[3], sys.argv[3:])
"""


def browser_path() -> str | None:
    """Where a browser is that can be driven; None: nowhere."""
    return next(filter(None, map(shutil.which, NAMES)), None)


# Until a page plays, or says what is wrong.
_READY = """new Promise((done) => {
  const isReady = () => globalThis.page || !(document.getElementById('error')?.hidden ?? true);
  const look = () => (isReady() ? done() : requestAnimationFrame(look));
  look();
})"""


class AnyTab(ABC):
    """A page of whichever browser. faults: errors of its scripts and of its log, a line each."""

    def __init__(self) -> None:
        self.faults: list[str] = []

    @abstractmethod
    def evaluate(self, expression: str) -> Any:
        """The value of an expression, or what its promise comes to. Raises RuntimeError where it throws."""

    @abstractmethod
    def show(self, address: str) -> Self:
        """Go to an address, and wait until all of the page is there."""

    @abstractmethod
    def mouse(self, kind: str, x: float, y: float) -> None:
        """Press, move or release the left button at a pixel: mousePressed, mouseMoved, mouseReleased."""

    @abstractmethod
    def press(self, key: str) -> None:
        """Press a key, which may begin with Shift+."""

    @abstractmethod
    def release(self, key: str) -> None:
        """Release a key."""

    def key(self, key: str) -> None:
        """Press and release a key."""
        self.press(key)
        self.release(key)

    def open(self, address: str) -> Self:
        """Go to an address, and wait until the page plays or says what is wrong."""
        return self.show(address).begun()

    def begun(self) -> Self:
        """Wait until the page plays or says what is wrong."""
        self.evaluate(_READY)
        return self


class Tab(AnyTab):
    """A page of Chromium."""

    def __init__(self, browser: "Browser", session: str) -> None:
        super().__init__()
        self._browser, self._session = browser, session

    def send(self, method: str, **given: Any) -> Any:
        """What the protocol answers to a method."""
        return self._browser.send(method, given, self._session)

    def evaluate(self, expression: str) -> Any:
        """As said of any tab."""
        given = {"expression": expression, "awaitPromise": True, "returnByValue": True, "userGesture": True}
        answer = self.send("Runtime.evaluate", **given)
        if "exceptionDetails" in answer:
            raise RuntimeError(json.dumps(answer["exceptionDetails"])[:600])
        return answer["result"].get("value")

    def show(self, address: str) -> Self:
        """As said of any tab."""
        # The empty page of a new tab may be there only now.
        self._browser.events.clear()
        self.send("Page.navigate", url=address)
        self._browser.until(lambda: "Page.loadEventFired" in self._browser.events)
        return self

    def led(self, act: Callable[[], None]) -> Self:
        """Do what leads to another page that plays, and wait until it does."""
        self._browser.events.clear()
        act()
        self._browser.until(lambda: "Page.loadEventFired" in self._browser.events)
        return self.begun()

    def picture(self) -> bytes:
        """What is seen, as PNG."""
        return base64.b64decode(self.send("Page.captureScreenshot", format="png")["data"])

    def mouse(self, kind: str, x: float, y: float, button: str = "left") -> None:
        """As said of any tab; button: left or right."""
        held = {"left": 1, "right": 2}[button]
        self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, buttons=held, clickCount=1)

    def touch(self, kind: str, *points: tuple[float, float]) -> None:
        """All fingers that are down after this: touchStart, touchMove, touchEnd."""
        fingers = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(points)]
        self.send("Input.dispatchTouchEvent", type=kind, touchPoints=fingers)

    def tap_twice(self, point: tuple[float, float]) -> None:
        """Tap two times within a tenth of a second, however long the browser takes to hear of it."""
        began = time.time()
        for step, kind in enumerate(("touchStart", "touchEnd") * 2):
            fingers = [{"x": point[0], "y": point[1], "id": 0}] if kind == "touchStart" else []
            self.send("Input.dispatchTouchEvent", type=kind, touchPoints=fingers, timestamp=began + 0.03 * step)

    def press(self, key: str) -> None:
        """As said of any tab."""
        name = key.removeprefix("Shift+")
        text = {"text": name} if len(name) == 1 else {}
        self.send("Input.dispatchKeyEvent", type="keyDown", key=name, modifiers=8 * (name != key), **text)

    def release(self, key: str) -> None:
        """As said of any tab."""
        name = key.removeprefix("Shift+")
        self.send("Input.dispatchKeyEvent", type="keyUp", key=name, modifiers=8 * (name != key))

    def key_with_ctrl(self, key: str) -> None:
        """Press and release a key while Ctrl is down, and Shift for a capital letter."""
        held = 2 | (8 if key.isupper() else 0)
        for kind in ("rawKeyDown", "keyUp"):
            self.send("Input.dispatchKeyEvent", type=kind, key=key, modifiers=held)

    def is_asked(self, expression: str, stays: bool) -> bool:
        """Whether the browser asks before it leaves the page as an expression says; stays: what is answered."""
        self._browser.events.clear()
        self.evaluate(f"setTimeout(() => {{ {expression} }})")
        self._browser.until(lambda: {"Page.javascriptDialogOpening", "Page.loadEventFired"} & set(self._browser.events))
        if "Page.javascriptDialogOpening" not in self._browser.events:
            return False
        self.send("Page.handleJavaScriptDialog", accept=not stays)
        return True


class Browser:
    """A process of a browser, which ends with it."""

    def __init__(self, path: str) -> None:
        self._folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        ours, theirs = os.pipe(), os.pipe()
        ends = str(ours[0]), str(theirs[1])
        arguments = [sys.executable, "-c", _BEGIN, *ends, path, *FLAGS, f"--user-data-dir={self._folder.name}"]
        self._process = subprocess.Popen(
            arguments, pass_fds=(ours[0], theirs[1]), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        os.close(ours[0])
        os.close(theirs[1])
        self._to, self._from = os.fdopen(ours[1], "wb"), os.fdopen(theirs[0], "rb", buffering=0)
        self._rest, self._number = b"", 0
        self.events: list[str] = []
        self._tabs: dict[str, Tab] = {}
        self._target: str | None = None

    def tab(self, width: int = 1280, height: int = 720, scheme: str = "dark", is_phone: bool = False) -> Tab:
        """A new page of a size [pixels], for a person who prefers this colour scheme; the one before it is closed."""
        if self._target is not None:
            self.send("Target.closeTarget", {"targetId": self._target})
        target = self._target = self.send("Target.createTarget", {"url": "about:blank"})["targetId"]
        session = self.send("Target.attachToTarget", {"targetId": target, "flatten": True})["sessionId"]
        tab = self._tabs[session] = Tab(self, session)
        for domain in ("Page", "Runtime", "Log"):
            tab.send(f"{domain}.enable")
        ratio = 2 if is_phone else 1
        tab.send(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=ratio, mobile=is_phone
        )
        tab.send("Emulation.setTouchEmulationEnabled", enabled=is_phone, maxTouchPoints=5)
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        tab.send("Emulation.setEmulatedMedia", features=features)
        return tab

    def keep(self) -> None:
        """Let the page that is open stay: the next one does not close it."""
        self._target = None

    def send(self, method: str, given: dict[str, Any], session: str | None = None) -> Any:
        """What the browser answers. Raises RuntimeError where it cannot."""
        self._number += 1
        number = self._number
        message = {"id": number, "method": method, "params": given} | ({"sessionId": session} if session else {})
        self._to.write(json.dumps(message).encode() + b"\0")
        self._to.flush()
        while True:
            answer = self._next()
            if answer.get("id") == number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]

    def until(self, has_come: Any) -> None:
        """Read what the browser tells until something has come."""
        while not has_come():
            self._next()

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._rest:
            more = os.read(self._from.fileno(), 1 << 20)
            if not more:
                raise RuntimeError("the browser has ended")
            self._rest += more
        text, _, self._rest = self._rest.partition(b"\0")
        message: dict[str, Any] = json.loads(text)
        method, tab = message.get("method", ""), self._tabs.get(message.get("sessionId", ""))
        self.events.append(method)
        if tab is not None and method == "Runtime.exceptionThrown":
            details = message["params"]["exceptionDetails"]
            tab.faults.append(details.get("exception", {}).get("description", details["text"]))
        elif tab is not None and method == "Log.entryAdded" and message["params"]["entry"]["level"] == "error":
            tab.faults.append(message["params"]["entry"]["text"])
        elif tab is not None and method == "Runtime.consoleAPICalled" and message["params"]["type"] == "error":
            tab.faults.append(json.dumps(message["params"]["args"])[:600])
        return message

    def close(self) -> None:
        """End the browser."""
        self._to.close()
        self._process.terminate()
        self._process.wait()
        self._from.close()
        self._folder.cleanup()


def page_address(path: Path) -> str:
    """The address of a file."""
    return path.resolve().as_uri()
