"""Firefox without a window, told what to do by WebDriver BiDi, which it speaks over a web socket by itself."""

import json
import re
import shutil
import subprocess
import tempfile
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Self

from websockets.sync.client import ClientConnection, connect

from tests.page.browser import AnyTab

NAMES = ("firefox-esr", "firefox")
# Nothing is fetched by itself, and nothing is asked at the first start.
PREFERENCES = {
    "app.update.auto": False, "browser.shell.checkDefaultBrowser": False, "browser.aboutwelcome.enabled": False,
    "datareporting.policy.dataSubmissionEnabled": False, "toolkit.telemetry.enabled": False,
    "browser.startup.page": 0, "browser.region.update.enabled": False, "extensions.getAddons.cache.enabled": False,
    "services.settings.server": "data:,", "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False, "browser.safebrowsing.update.enabled": False,
    "layout.css.prefers-color-scheme.content-override": 0,
}  # fmt: skip
LISTENING = re.compile(r"WebDriver BiDi listening on (ws://\S+)")
# What events of a mouse and keys without a letter are called there.
MOUSE = {"mousePressed": "pointerDown", "mouseMoved": "pointerMove", "mouseReleased": "pointerUp"}
KEYS = {
    "Shift": "\ue008",
    "Enter": "\ue007",
    "Escape": "\ue00c",
    "Tab": "\ue004",
    "ArrowUp": "\ue013",
    "ArrowDown": "\ue015",
}


def firefox_path() -> str | None:
    """Where Firefox is; None: nowhere."""
    return next(filter(None, map(shutil.which, NAMES)), None)


def _value_of(remote: dict[str, Any]) -> Any:
    """A value of a script, as BiDi says it."""
    kind, value = remote["type"], remote.get("value")
    if kind in ("array", "set"):
        return [_value_of(each) for each in value or ()]
    if kind in ("object", "map"):
        return {name: _value_of(each) for name, each in value or ()}
    if kind in ("undefined", "null"):
        return None
    return float(value) if kind == "number" and isinstance(value, str) else value


class FirefoxTab(AnyTab):
    """A page of Firefox."""

    def __init__(self, browser: "Firefox", context: str) -> None:
        super().__init__()
        self._browser, self._context = browser, context

    def send(self, method: str, **given: Any) -> Any:
        """What the protocol answers to a method of this page."""
        return self._browser.send(method, {"context": self._context, **given})

    def evaluate(self, expression: str) -> Any:
        """As said of any tab."""
        given = {"expression": expression, "target": {"context": self._context}}
        answer = self._browser.send("script.evaluate", {**given, "awaitPromise": True, "userActivation": True})
        if answer["type"] == "exception":
            raise RuntimeError(answer["exceptionDetails"]["text"])
        return _value_of(answer["result"])

    def show(self, address: str) -> Self:
        """As said of any tab."""
        self.send("browsingContext.navigate", url=address, wait="complete")
        return self

    def mouse(self, kind: str, x: float, y: float) -> None:
        """As said of any tab."""
        deeds: list[dict[str, Any]] = [{"type": "pointerMove", "x": round(x), "y": round(y)}]
        if kind != "mouseMoved":
            deeds.append({"type": MOUSE[kind], "button": 0})
        self._act({"type": "pointer", "id": "mouse", "actions": deeds})

    def press(self, key: str) -> None:
        """As said of any tab."""
        self._type("keyDown", *re.findall(r"Shift(?=\+)|[^+]+$|\+$", key))

    def release(self, key: str) -> None:
        """As said of any tab."""
        self._type("keyUp", *reversed(re.findall(r"Shift(?=\+)|[^+]+$|\+$", key)))

    def _type(self, kind: str, *keys: str) -> None:
        deeds = [{"type": kind, "value": KEYS.get(key, key)} for key in keys]
        self._act({"type": "key", "id": "keys", "actions": deeds})

    def _act(self, source: dict[str, Any]) -> None:
        self.send("input.performActions", actions=[source])


class Firefox:
    """A process of Firefox, which ends with it. Raises RuntimeError where it does not begin."""

    def __init__(self, path: str) -> None:
        self._open = ExitStack()
        folder = self._open.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True))
        lines = (f"user_pref({json.dumps(name)}, {json.dumps(value)});" for name, value in PREFERENCES.items())
        (Path(folder) / "user.js").write_text("\n".join(lines))
        arguments = [path, "--headless", "--no-remote", "--profile", folder, "--remote-debugging-port", "0"]
        self._process = subprocess.Popen(arguments, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self._socket = self._connected()
        self._number = 0
        self._tabs: dict[str, FirefoxTab] = {}
        self.send("session.new", {"capabilities": {}})
        self.send("session.subscribe", {"events": ["log.entryAdded"]})

    def _connected(self) -> ClientConnection:
        assert self._process.stderr is not None
        for line in self._process.stderr:
            if found := LISTENING.search(line):
                socket = connect(f"{found[1]}/session", max_size=None, compression=None)
                return self._open.enter_context(socket)
        raise RuntimeError("Firefox has ended")

    def tab(self, width: int = 1280, height: int = 720) -> FirefoxTab:
        """A new page of a size [pixels]; those before it are closed."""
        context = self.send("browsingContext.create", {"type": "tab"})["context"]
        for other in self._tabs:
            self.send("browsingContext.close", {"context": other})
        tab = FirefoxTab(self, context)
        self._tabs = {context: tab}
        tab.send("browsingContext.setViewport", viewport={"width": width, "height": height})
        return tab

    def send(self, method: str, given: dict[str, Any]) -> Any:
        """What it answers. Raises RuntimeError where it cannot."""
        self._number += 1
        self._socket.send(json.dumps({"id": self._number, "method": method, "params": given}))
        while True:
            answer = json.loads(self._socket.recv())
            if answer.get("id") == self._number:
                if answer["type"] == "error":
                    raise RuntimeError(f"{method}: {answer['message']}")
                return answer["result"]
            self._note(answer)

    def _note(self, event: dict[str, Any]) -> None:
        """Keep what goes wrong in a page."""
        told = event.get("params", {})
        tab = self._tabs.get(told.get("source", {}).get("context", ""))
        if tab is not None and event.get("method") == "log.entryAdded" and told["level"] == "error":
            tab.faults.append(told["text"])

    def close(self) -> None:
        """End it."""
        self._process.terminate()
        self._process.wait()
        self._open.close()
