"""Application: what the parts of the app ask of it as a whole."""

from collections.abc import Callable
from pathlib import Path
from typing import Protocol

import pygame

from sandbox.app.base.display import Display
from sandbox.app.base.shortcuts import Mode
from sandbox.app.contracts.editing import Editing
from sandbox.app.contracts.screen import Screen
from sandbox.app.film.film import Film
from sandbox.app.film.film_pair import FilmPair
from sandbox.app.run.best_keeping import BestKeeping
from sandbox.app.run.playback import Playback
from sandbox.app.run.scene_keeping import SceneKeeping
from sandbox.app.settings.chosen import Chosen
from sandbox.app.sound.sounds import Sounds
from sandbox.app.widgets.ui import Ui
from sandbox.level.document.model import Level
from sandbox.session.scene import RunScene


class Keys(Protocol):
    """Keys that a level gives a meaning, by the controls of a gamepad."""

    def press_control(self, control: str) -> None:
        """Press the key that a control is for."""
        ...

    def release_control(self, control: str) -> None:
        """Let go the key that a control has pressed."""
        ...


class Run(Screen, Protocol):
    """A run on the screen; of_document: of the level that the editor has open; source: the file of its level.

    saved: where in My levels it is saved, and how it stood then.
    """

    of_document: bool
    source: Path | None
    saved: tuple[Path, RunScene] | None

    @property
    def playback(self) -> Playback:
        """The run."""
        ...

    def film(self, seconds: float) -> Film | FilmPair:
        """Film of its last seconds [s], as the camera shows it now."""
        ...

    @property
    def keys(self) -> Keys:
        """The keys of its level."""
        ...

    def show_sweep(self, path: Path) -> None:
        """Show a table that `sandbox sweep` made of its level. Raises SweepError and OSError."""
        ...


class Documents(Protocol):
    """What is done with the level that the editor has open; editor: its screen, also while it is played."""

    @property
    def editor(self) -> Editing | None:
        """The screen of the editor."""
        ...

    def new(self, then: Callable[[], object] = ..., level: Level | None = ...) -> None:
        """Begin an empty level, or the one given, once it is clear what becomes of the present one."""
        ...

    def new_place(self) -> None:
        """Begin a level with ground and walls to play in, and show it in the editor."""
        ...

    def play_new(self) -> None:
        """Begin a level with ground and walls, and play it with the parts at hand."""
        ...

    def open(self, path: str | Path) -> None:
        """Edit the level of a file; faults are shown."""
        ...

    def open_copy(self, path: str | Path) -> None:
        """Edit a level that is saved under a new name."""
        ...

    def edit_level(self, level: Level, label: str = ...) -> None:
        """Edit a level that has no file."""
        ...

    def edit_run(self, level: Level, source: Path | None, then: Callable[[], object]) -> None:
        """Edit the level of a run, in the file that it is from; then() is called once it is open."""
        ...

    def save(self) -> None:
        """Save the level to its file."""
        ...

    def save_as(self) -> None:
        """Save the level under a name that is asked for."""
        ...

    def revert(self) -> None:
        """Read the level from its file again."""
        ...

    def note(self, level: Level, path: Path | None, label: str) -> None:
        """Let the autosave keep the document as it is now."""
        ...

    def look_at_disk(self) -> None:
        """Say so where another program has changed the file."""
        ...

    def play(self) -> None:
        """Play the level."""
        ...

    def back(self) -> None:
        """Go back from a run of the level to the editor."""
        ...


class Files(Protocol):
    """What is done with files; faults are shown as lines."""

    def open_path(self, path: str | Path) -> bool:
        """Open a level or a recording; whether it could be."""
        ...

    def open_level(self, path: str | Path, shipped: bool = ...) -> bool:
        """Open a level, to be played or edited; whether it could be."""
        ...

    def next_level(self, level: Level, source: Path | None) -> tuple[Path, bool] | None:
        """The level to play after one that was won, and whether it is shipped; source: the file of that one."""
        ...

    def open_replay(self, path: str | Path) -> bool:
        """Open a recording; whether it could be."""
        ...

    def ask_to_open(self) -> None:
        """Ask for the path of a file, and open it."""
        ...

    def toggle_recording(self) -> None:
        """Begin to record the run, or stop."""
        ...

    def save_run(self) -> None:
        """Save the run so far as a recording."""
        ...

    def save_scene(self) -> None:
        """Save how the run stands, in My levels."""
        ...

    def open_scene(self, path: Path) -> bool:
        """Open a scene as it stood; whether it could be."""
        ...


class Page(Protocol):
    """A page over the screen that takes keys and the wheel."""

    @property
    def is_on_top(self) -> bool:
        """Whether no other page lies over it."""
        ...

    def press_key(self, event: pygame.event.Event) -> bool:
        """React to a key; whether it has a meaning here."""
        ...

    def scroll(self, notches: float) -> None:
        """React to the mouse's wheel."""
        ...


class Application(Protocol):
    """The app as its parts see it."""

    @property
    def display(self) -> Display:
        """The window."""
        ...

    @property
    def ui(self) -> Ui:
        """The widgets."""
        ...

    @property
    def chosen(self) -> Chosen:
        """The person's settings of the app."""
        ...

    @property
    def sounds(self) -> Sounds:
        """Plays the sounds of the run."""
        ...

    @property
    def mode(self) -> Mode:
        """The mode whose shortcuts hold now."""
        ...

    @property
    def screen(self) -> Screen | None:
        """What fills the window under its pages."""
        ...

    @property
    def play(self) -> Run | None:
        """The run that is on the screen, if it is one."""
        ...

    @property
    def gallery(self) -> Page | None:
        """The page of levels or recordings, where it is open."""
        ...

    @property
    def documents(self) -> Documents:
        """What is done with the level that the editor has open."""
        ...

    @property
    def scenes(self) -> SceneKeeping:
        """Keeps runs on disk, so that they outlive the app."""
        ...

    @property
    def best(self) -> BestKeeping:
        """Keeps the best runs of levels."""
        ...

    @property
    def files(self) -> Files:
        """Opening, recording, saving."""
        ...

    def say(self, text: str, screen: Screen | None = None) -> None:
        """Show a line to the person for some seconds; screen: what it is about, and ends with."""
        ...

    def take_back(self, text: str) -> None:
        """Take away a line that no longer holds."""
        ...

    def end_messages(self, screen: Screen) -> None:
        """Take away all lines about a screen."""
        ...

    def show_faults(self, title: str, faults: list[str]) -> None:
        """Show lines in a box."""
        ...

    def act(self, action: str) -> None:
        """Do what a key or button asks for, where the screen knows it."""
        ...

    def start(self, playback: Playback, source: Path | None = None) -> None:
        """Show a run from its beginning; source: the file of its level."""
        ...

    def start_document(self, playback: Playback) -> Run:
        """Show a run of the level that the editor has open."""
        ...

    def show_screen(self, screen: Screen) -> None:
        """Fill the window with another screen."""
        ...

    def start_pair(self, path: Path) -> None:
        """Play the level of a file twice side by side, with the pad in the panel."""
        ...

    def start_melt(self) -> None:
        """Begin the lesson on springs that are solved one by one."""
        ...

    def start_lesson(self) -> None:
        """Begin the lesson on Hooke's spring and the article's."""
        ...

    def show_replay_progress(self, playback: Playback, can_cancel: bool = True) -> None:
        """Show a bar while a run is played again from the past, where that takes long; can_cancel: Escape ends it."""
        ...

    def offer_tour(self) -> None:
        """Offer the tour of the editor to who has not seen it."""
        ...

    def open_gallery(self, section: str = ..., query: str = ...) -> None:
        """Choose a level or a recording."""
        ...

    def rebuild(self) -> None:
        """Lay everything out again."""
        ...

    def quit(self) -> None:
        """Leave after this frame."""
        ...
