"""Settings: the one table of what a person can choose about the app; what they chose is kept from start to start.

To add one: a line in SETTINGS; whoever obeys it reads `Chosen`.
"""

import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from sandbox.app.draw.colours import ThemeName
from sandbox.editor.storage.preferences import preferences, set_aside_broken, set_preferences

# A value and the words for it.
Option = tuple[str, str]
# Sizes of the widgets that can be chosen, in pixels for a layout unit.
SCALES = (0.5, 4.0)
# Longest wait [s] for the program that knows.
PATIENCE = 1.0
_QUESTIONS = {
    "darwin": ("defaults", "read", "-g", "AppleInterfaceStyle"),
    "linux": ("gsettings", "get", "org.gnome.desktop.interface", "color-scheme"),
}


@dataclass(frozen=True)
class OneOf:
    """A setting that takes one of several values; the first is what holds at first."""

    name: str
    label: str
    group: str
    options: tuple[Option, ...]
    tip: str = ""

    @property
    def default(self) -> str:
        """The value until another is chosen."""
        return self.options[0][0]

    def fault_of(self, value: Any) -> str | None:
        """Why a value cannot be taken."""
        names = [name for name, _ in self.options]
        return None if value in names else "use one of " + ", ".join(names)


@dataclass(frozen=True)
class Amount:
    """A setting that is a number from low to high, None = automatic; a step is `by`; shown in per cent."""

    name: str
    label: str
    group: str
    low: float
    high: float
    by: float
    default: float | None = None
    tip: str = ""

    def fault_of(self, value: Any) -> str | None:
        """Why a value cannot be taken."""
        if value is None and self.default is None:
            return None
        if isinstance(value, int | float) and not isinstance(value, bool) and self.low <= value <= self.high:
            return None
        return f"use a number from {self.low:g} to {self.high:g}"


@dataclass(frozen=True)
class Address:
    """A setting that is the address of a site; "": there is none."""

    name: str
    label: str
    group: str
    tip: str = ""
    default: str = ""

    def fault_of(self, value: Any) -> str | None:
        """Why a value cannot be taken."""
        is_one = isinstance(value, str) and (not value or value.startswith(("https://", "http://")))
        return None if is_one else "an address begins with https://"


Setting = OneOf | Amount | Address
SETTINGS: tuple[Setting, ...] = (
    OneOf("theme", "Theme", "Look", (("system", "As the system"), ("light", "Light"), ("dark", "Dark")),
          "Some levels set their own"),
    Amount("scale", "Size of widgets", "Look", *SCALES, 0.125, tip="Ctrl++ and Ctrl+- do the same"),
    OneOf("effects", "Shadows and effects", "Look", (("auto", "Automatic"), ("on", "On"), ("off", "Off")),
          "Automatic: switched off while drawing is slow"),
    OneOf("motion", "PlaneMap", "Look", (("full", "Full"), ("less", "Reduced")),
          "Reduced: pictures of the gallery stand still, no dust and no sparks"),
    OneOf("sound", "Sound", "Sound", (("on", "On"), ("off", "Off")), "The M key and the button in the bar do the same"),
    Amount("volume", "Volume", "Sound", 0.0, 1.0, 0.1, 0.6),
    OneOf("threads", "Cores for large bodies", "Speed",
          (("auto", "Automatic"), *((str(count), str(count)) for count in (1, 2, 4, 8))),
          "Automatic: all but one. Runs are the same with any number"),
    OneOf("hints", "Hints", "Help", (("show", "Show"), ("hide", "Hide")),
          "Show the level's description when it starts; F2 shows it again"),
    Address("link_site", "Site for links", "Sharing", "Where the pages lie that sandbox site wrote: links open them"),
)  # fmt: skip


class Chosen:
    """What a person has chosen, by the names of SETTINGS; changed(name) is called after each change.

    overrides: values that hold for this start alone, whatever is remembered. automatic: what an amount comes to while
    it is left open. faults: lines about what could not be read.
    """

    def __init__(self, changed: Callable[[str], object] = lambda name: None, **overrides: Any) -> None:
        self.changed = changed
        self.automatic: dict[str, float] = {}
        self.faults: list[str] = []
        aside = set_aside_broken()
        if aside is not None:
            self.faults.append(f"Your settings cannot be read, so the defaults apply. The file is kept as {aside}.")
        read = preferences()
        self._values = {setting.name: self._taken(setting, read) for setting in SETTINGS}
        self._values |= {name: value for name, value in overrides.items() if value is not None}
        self.keys = self._taken_keys(read.get("keys", {}))

    def __getitem__(self, name: str) -> Any:
        return self._values[name]

    def choose(self, name: str, value: Any) -> None:
        """Choose a value from now on, and at later starts; None = what holds at first."""
        setting = next(setting for setting in SETTINGS if setting.name == name)
        self._values[name] = setting.default if value is None else value
        set_preferences({name: value})
        self.changed(name)

    def choose_keys(self, keys: Mapping[str, tuple[str, ...]]) -> None:
        """Give actions other keys, by the names of the table of shortcuts, from now on and at later starts."""
        self.keys = dict(keys)
        set_preferences({"keys": {name: list(each) for name, each in keys.items()} or None})
        self.changed("keys")

    def _taken(self, setting: Setting, read: Mapping[str, Any]) -> Any:
        value = read.get(setting.name, setting.default)
        fault = setting.fault_of(value)
        if fault is None:
            return value
        self.faults.append(f"preferences.json: {setting.name}: {value!r:.40} cannot be used; {fault}.")
        return setting.default

    def _taken_keys(self, read: Any) -> dict[str, tuple[str, ...]]:
        if isinstance(read, dict) and all(
            isinstance(keys, list) and all(isinstance(key, str) for key in keys) for keys in read.values()
        ):
            return {name: tuple(keys) for name, keys in read.items()}
        self.faults.append("preferences.json: keys: not a list of keys for each action; the defaults apply.")
        return {}


def theme_of(chosen: str) -> ThemeName:
    """The theme that is meant by what was chosen: "dark", "light" or "system"; light where the system says nothing."""
    if chosen == "system":
        return "dark" if _is_dark() else "light"
    return "dark" if chosen == "dark" else "light"


def _is_dark() -> bool:
    if sys.platform == "win32":
        import winreg

        place = r"Software\Microsoft\Windows\CurrentVersion\Themes\Personalize"
        try:
            with winreg.OpenKey(winreg.HKEY_CURRENT_USER, place) as key:
                return not winreg.QueryValueEx(key, "AppsUseLightTheme")[0]
        except OSError:
            return False
    question = _QUESTIONS.get(sys.platform)
    if question is None or shutil.which(question[0]) is None:
        return False
    try:
        asked = subprocess.run(question, capture_output=True, text=True, timeout=PATIENCE, check=False)
    except (OSError, subprocess.SubprocessError):
        return False
    # On macOS the light one has no name.
    return "dark" in asked.stdout.casefold()
