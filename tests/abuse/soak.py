"""Soak: random mouse and keyboard at the app for minutes; nothing may fail, leak, or be replayed otherwise.

Run by hand: make soak, or python -m tests.abuse.soak [--frames 36000] [--seed 1] [--seconds S] [--screen]. In
stretches, each from another screen on, with the same few places in between at which memory is measured and the run so
far is recorded and verified. Whatever it writes goes to a folder that is thrown away. Ends with 1 where something was
found.
"""

import argparse
import contextlib
import ctypes
import gc
import itertools
import os
import random
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter, deque
from pathlib import Path

import pygame

from sandbox.app.base.display import SCALE_RANGE, Display, StartRequest
from sandbox.app.edit.edit_screen import EditScreen
from sandbox.app.edit.side.side import PAGES, UNLISTED
from sandbox.app.run.playback import Playback
from sandbox.app.settings.chosen import SETTINGS
from sandbox.app.window.app import App
from sandbox.editor.items import items_of
from sandbox.editor.storage.level_file import catalogue
from sandbox.level.reading.files import load_level
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from tests.support.person import VirtualScreen

FRAME = 1 / 60
STRETCH = 600
# Memory may grow by this part after so much of the frames.
MOST_GROWTH, WARM_UP = 0.02, 0.35
# What stretches begin with: an action, and a level to do it in, or "" for one of the ready parts in turn.
SCREENS = (
    ("gallery", ""), ("palette", "jelly_cube"), ("edit", "rope"), ("settings", ""), ("share", "newtons_cradle"),
    ("help", "truss_bridge"), ("edit", ""), ("play", "jelly_pile"), ("edit", "suspension_car"), ("edit", ""),
    ("palette", "wrecking_ball"), ("play", "walker"),
)  # fmt: skip
SIZES = ((1280, 720), (640, 480), (900, 700), (1600, 900), (1280, 720))
# What is typed, and never a name of a folder.
LETTERS = "abcxyz 0123456789-+e,;äß"
# Where systems say that a person's folders are.
HOMES = (
    "HOME", "USERPROFILE", "APPDATA", "LOCALAPPDATA", "XDG_DATA_HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME",
    "XDG_DOCUMENTS_DIR", "XDG_PICTURES_DIR",
)  # fmt: skip
KEYS = "abcdefghijklmnopqrstuvwxyz0123456789"


def hide_home(folder: Path) -> None:
    """Let a person's folders be in this one, and no programs of the system be found."""
    for name in HOMES:
        os.environ[name] = str(folder)
    (folder / "nothing").mkdir(exist_ok=True)
    os.environ["PATH"] = str(folder / "nothing")
    os.chdir(folder)


class Monkey:
    """Somebody who knows nothing of the app; done: what was last done, seen: on which screens there were frames."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)
        self.app = App(Display(1.0))
        self.app.open(StartRequest())
        self.done: deque[str] = deque(maxlen=40)
        self.seen: Counter[str] = Counter()
        self._parts = itertools.cycle(part.level for part in catalogue() if part.level is not None)
        self._held: set[int] = set()
        self._path: list[tuple[int, int]] = []
        self._keys = [getattr(pygame, f"K_{name}") for name in KEYS]
        self._keys += [
            pygame.K_SPACE, pygame.K_RETURN, pygame.K_ESCAPE, pygame.K_TAB, pygame.K_DELETE, pygame.K_BACKSPACE,
            pygame.K_PERIOD, pygame.K_COMMA, pygame.K_PLUS, pygame.K_MINUS, pygame.K_HOME, pygame.K_LEFT,
            pygame.K_RIGHT, pygame.K_UP, pygame.K_DOWN, *(getattr(pygame, f"K_F{k}") for k in range(1, 13)),
        ]  # fmt: skip
        self._deeds = (
            (self._move, 30), (self._press, 14), (self._click_button, 8), (self._press_key, 14), (self._type, 3),
            (self._turn_wheel, 5), (self._rest, 25), (self._escape, 3), (self._resize, 0.15), (self._turn_page, 2),
            (self._select, 2),
        )  # fmt: skip

    # Deeds.

    def _post(self, kind: int, **data: object) -> None:
        pygame.event.post(pygame.event.Event(kind, **data))

    def _place(self) -> tuple[int, int]:
        width, height = self.app.display.size
        return self._random.randrange(width), self._random.randrange(height)

    def _move_to(self, at: tuple[int, int]) -> None:
        before = pygame.mouse.get_pos()
        pygame.mouse.set_pos(at)
        buttons = tuple(int(button in self._held) for button in (1, 2, 3))
        self._post(pygame.MOUSEMOTION, pos=at, rel=(at[0] - before[0], at[1] - before[1]), buttons=buttons)

    def _move(self) -> None:
        if not self._path:
            end, steps = self._place(), self._random.choice((1, 4, 12))
            x, y = pygame.mouse.get_pos()
            self._path = [
                (round(x + (end[0] - x) * k / steps), round(y + (end[1] - y) * k / steps)) for k in range(1, steps + 1)
            ]

    def _press(self) -> None:
        at, button = pygame.mouse.get_pos(), self._random.choice((1, 1, 1, 1, 2, 3))
        if button in self._held:
            self._held.discard(button)
            self._post(pygame.MOUSEBUTTONUP, pos=at, button=button)
        else:
            self._held.add(button)
            self._post(pygame.MOUSEBUTTONDOWN, pos=at, button=button)

    def _click_button(self) -> None:
        buttons = [button for button in self.app.ui.buttons() if button.visible and button.is_enabled]
        if buttons:
            at = self._random.choice(buttons).rect.center
            self._move_to(at)
            for kind in (pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP):
                self._post(kind, pos=at, button=1)

    def _press_key(self) -> None:
        mod = self._random.choice((0, 0, 0, 0, pygame.KMOD_CTRL, pygame.KMOD_SHIFT))
        key = self._random.choice(self._keys)
        pygame.key.set_mods(mod)
        self._post(pygame.KEYDOWN, key=key, mod=mod, unicode="", scancode=0)
        self._post(pygame.KEYUP, key=key, mod=mod, unicode="", scancode=0)

    def _type(self) -> None:
        for letter in self._random.choices(LETTERS, k=self._random.randrange(1, 8)):
            self._post(pygame.TEXTINPUT, text=letter)

    def _turn_wheel(self) -> None:
        y = self._random.choice((-2, -1, 1, 2))
        self._post(pygame.MOUSEWHEEL, x=0, y=y, precise_x=0.0, precise_y=float(y), flipped=False)

    def _rest(self) -> None:
        """Do nothing."""

    def _escape(self) -> None:
        self.tap(pygame.K_ESCAPE)

    @property
    def _editor(self) -> EditScreen | None:
        """The editor, where it is what the window shows."""
        editor = self.app.documents.editor
        return editor if editor is not None and self.app.screen is editor else None

    def _turn_page(self) -> None:
        editor = self._editor
        if editor is not None and editor.side is not None:
            editor.side.choose(self._random.choice([*sorted(PAGES), *UNLISTED]))

    def _select(self) -> None:
        """Select something in the editor: its fields and materials are shown."""
        editor = self._editor
        if editor is not None and (items := list(items_of(editor.document.level))):
            editor.select(frozenset(self._random.choices(items, k=self._random.choice((1, 1, 2, 9)))))

    def _resize(self) -> None:
        self.app.display.window.size = self._random.choice(SIZES)

    def tap(self, key: int) -> None:
        """Press a key and let it go."""
        for kind in (pygame.KEYDOWN, pygame.KEYUP):
            self._post(kind, key=key, mod=0, unicode="", scancode=0)

    def let_go(self) -> None:
        """Let go of everything, and answer no question."""
        for button in sorted(self._held):
            self._post(pygame.MOUSEBUTTONUP, pos=pygame.mouse.get_pos(), button=button)
        self._held.clear()
        self._path.clear()
        pygame.key.set_mods(0)
        for _ in range(4):
            self._escape()
            self.frame()

    # Time.

    @property
    def screen(self) -> str:
        """What the window shows."""
        app = self.app
        if app.gallery is not None:
            return "gallery"
        return f"{app.mode} with {type(app.ui.top_sheet).__name__}" if app.ui.has_sheet else str(app.mode)

    def frame(self) -> None:
        """Let a frame pass."""
        app = self.app
        app.frame(FRAME)
        # Nobody goes before the time is over.
        app.running = True
        self.seen[self.screen] += 1

    def act(self) -> None:
        """Do something, and let a frame pass."""
        if self._path:
            self._move_to(self._path.pop(0))
        else:
            deeds, weights = zip(*self._deeds, strict=True)
            deed = self._random.choices(deeds, weights)[0]
            self.done.append(f"{deed.__name__} at {pygame.mouse.get_pos()} on {self.screen}")
            deed()
        self.frame()

    def begin(self, screen: str, level: str) -> None:
        """Go to a screen."""
        self.let_go()
        self.app.documents.give_up()
        if level:
            self.app.start(Playback(load_level(level)))
            self.frame()
        if screen == "edit":
            self.app.documents.edit_level(load_level(level) if level else next(self._parts))
        elif screen == "gallery":
            self.app.open_gallery()
        elif screen != "play":
            self.app.act(screen)
        self.done.append(f"begin {screen} {level}")
        self.frame()
        self.seen[f"begun: {screen}"] += 1

    def meet_parts(self) -> None:
        """See every ready part and every page of it once, as later stretches do in turn: their pictures are kept."""
        for part in catalogue():
            if part.level is not None:
                self.app.documents.edit_level(part.level)
                for page in PAGES:
                    self.app.documents.editor.side.choose(page)
                    self.frame()
                self.app.documents.give_up()

    def verified(self, path: Path) -> str | None:
        """Record the run on the screen into a file and play it again; what differs, None where nothing does."""
        play = self.app.play
        if play is None or play.playback.replay is not None:
            return None
        session = play.playback.session
        if session.recording is None:
            session.record_to(path)
        written = play.playback.stop_recording()
        found = verify(read_replay(written)) if written is not None else None
        return None if found is None else str(found)

    def memory(self) -> int:
        """Bytes that this process holds, on a small page that is always the same."""
        self.let_go()
        self.app.documents.give_up()
        # A window that fills the screen takes no other size.
        if self.app.display.fullscreen:
            self.app.display.toggle_fullscreen()
        self.app.display.window.size = SIZES[0]
        # Larger widgets take more: what was chosen is put back afterwards. Shapes of widgets are kept in so many bytes
        # as long as the scale is the same: it becomes what it is now.
        chosen = {setting.name: self.app.chosen[setting.name] for setting in SETTINGS}
        self.app.chosen.choose("scale", SCALE_RANGE[1])
        for name in chosen:
            self.app.chosen.choose(name, None)
        # Pictures of cards are kept in a size, for the next time: all of them in that of this page. None of them plays.
        self._move_to((0, 0))
        self.app.open_gallery()
        while self.app.gallery is not None and self.app.gallery.moves:
            self.frame()
        self.app.start(Playback(load_level("rope")))
        for _ in range(5):
            self.frame()
        gc.collect()
        held = resident()
        for name, value in chosen.items():
            self.app.chosen.choose(name, value)
        return held


def resident() -> int:
    """Bytes of this process in memory, without what is only kept for the next allocation; 0 where nobody says."""
    try:
        ctypes.CDLL("libc.so.6").malloc_trim(0)
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, AttributeError):
        return 0


def end_toys(folder: Path) -> None:
    """End what was opened from files in this folder, and goes on when the app ends."""
    for said in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):
            words = said.read_bytes().split(b"\0")
            if b"toy" in words and any(word.startswith(os.fsencode(folder)) for word in words):
                os.kill(int(said.parent.name), signal.SIGTERM)


def soak(seed: int, frames: int, folder: Path, seconds: float | None = None, stretch: int = STRETCH) -> list[str]:
    """Do it; what was found."""
    measures = frames // stretch > len(SCREENS)
    monkey = Monkey(seed)
    if measures:
        monkey.meet_parts()
    sizes: list[int] = []
    found: list[str] = []
    end = None if seconds is None else time.monotonic() + seconds
    try:
        for number in range(max(1, frames // stretch)):
            if end is not None and time.monotonic() > end:
                break
            monkey.begin(*SCREENS[number % len(SCREENS)])
            for _ in range(stretch):
                monkey.act()
            monkey.let_go()
            fault = monkey.verified(folder / f"soak-{number}.replay")
            found += [f"stretch {number}: its recording does not verify: {fault}"] if fault else []
            end_toys(folder)
            if measures:
                sizes.append(monkey.memory())
                print(f"{number + 1} stretches, {sizes[-1] / 1e6:.1f} MB", flush=True)
    except Exception:
        found.append("\n".join([*monkey.done, traceback.format_exc()]))
    monkey.app.close()
    end_toys(folder)
    # Whole rounds of all screens, so that the same was open before.
    first = sizes[int(WARM_UP * len(sizes)) :]
    if len(first) > 2 * len(SCREENS) and first[0]:
        early, late = min(first[: len(SCREENS)]), min(first[-len(SCREENS) :])
        print(f"memory {early / 1e6:.1f} MB after warm-up, {late / 1e6:.1f} MB in the end: {late / early - 1:+.2%}")
        if late > early * (1.0 + MOST_GROWTH):
            found.append(f"memory grows by {late / early - 1:.2%}")
    print(", ".join(f"{name} {count}" for name, count in sorted(monkey.seen.items())))
    return found


def main(arguments: list[str] | None = None) -> int:
    """Print what was found; 1 where that is anything."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--frames", type=int, default=36_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float)
    parser.add_argument("--screen", action="store_true", help="in a window on a virtual screen, where Xvfb is")
    parser.add_argument("--all", action="store_true", help="the usual; for make abuse")
    given = parser.parse_args(arguments)
    if given.screen and not shutil.which("Xvfb"):
        print("needs Xvfb (apt install xvfb)")
        return 0
    with tempfile.TemporaryDirectory() as folder:
        screen = VirtualScreen(Path(folder)) if given.screen else None
        os.environ |= {"SDL_VIDEODRIVER": "x11", "DISPLAY": screen.display} if screen else {}
        try:
            hide_home(Path(folder))
            found = soak(given.seed, given.frames, Path(folder), given.seconds)
        finally:
            os.chdir("/")
            if screen is not None:
                screen.close()
    print("\n".join(found) or "nothing was found")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
