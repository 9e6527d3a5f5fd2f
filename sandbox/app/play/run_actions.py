"""What is done with a run as a whole: undo beyond its beginning, keep it in the level, melt it."""

from collections.abc import Callable
from dataclasses import replace

from sandbox.app.contracts.application import Application
from sandbox.app.run.playback import RAMP_TIME, Playback
from sandbox.app.widgets.dialogs import choose
from sandbox.editor.document import UNTITLED, Document, EditError
from sandbox.editor.edits.bake import (
    keep_added,
    keep_coefficients,
    keep_cuts,
    keep_masses,
    keep_pins,
    keep_pose,
    keep_settings,
)
from sandbox.level.assembly.build_world import LevelWorld
from sandbox.session.commands import SetSolver
from sandbox.session.scene import RunScene

BEGUN_AGAIN = "Back to the beginning. Ctrl+Z brings back what was there."
BROUGHT_BACK = "The run before is back, as it stood. Ctrl+Y goes on to the other one."


# What the place is called that New begins with.
NEW_PLACE = "New place"


def level_name(name: str) -> str:
    """What a level of that name is called for people."""
    return NEW_PLACE if name == UNTITLED else name


class EarlierRuns:
    """The runs of a level around the present one; before: how the one stood that was there last.

    show: shows another run in place of the present one. say: shows a line.
    """

    def __init__(
        self, before: RunScene | None, show: Callable[[Playback], object], say: Callable[[str], object]
    ) -> None:
        self.before, self._show, self._say = before, show, say
        # The run that was left by going back, and the revision of the one gone back to.
        self._after: tuple[Playback, int] | None = None
        # The run that has begun again, where what it began with is no deed to be undone.
        self._begun: Playback | None = None

    def begin_again(self, playback: Playback, earlier: RunScene | None) -> None:
        """Remember the run that a new one takes the place of, as it stood; None where nothing was done in it."""
        self._after, self._begun = None, playback
        if earlier is not None:
            self.before = earlier
            self._say(BEGUN_AGAIN)

    def can_undo(self, playback: Playback) -> bool:
        """Whether something was done in the run, or another was there before it."""
        return playback.session.can_undo or self.before is not None

    def can_redo(self, playback: Playback) -> bool:
        """Whether something was undone in the run, or another was left by going back to it."""
        return playback.session.can_redo or (self._after is not None and self._after[1] == playback.revision)

    def undo(self, playback: Playback) -> None:
        """Take the last gesture back, or bring back the run that was there before."""
        playback.apply_pending()
        before = self.before
        is_untouched = playback is self._begun and playback.scene() is None
        if before is None or (playback.session.can_undo and not is_untouched):
            playback.submit_undo()
            return
        earlier = Playback(before.level, first=before)
        earlier.clock = replace(playback.clock, speed=abs(playback.clock.speed), accumulator=0.0, single_steps=0)
        self.before, self._after = None, (playback, earlier.revision)
        self._show(earlier)
        self._say(BROUGHT_BACK)

    def redo(self, playback: Playback) -> None:
        """Make the gesture again that was undone last, or go on to the run that was left by going back."""
        playback.apply_pending()
        if playback.session.can_redo or not self.can_redo(playback) or self._after is None:
            playback.submit_redo()
            return
        after = self._after[0]
        self.before, self._after = playback.scene() or playback.first, None
        self._show(after)


Keeper = Callable[[Document, LevelWorld], Document]
KEEPERS: tuple[tuple[str, Keeper], ...] = (
    ("Pose: the present positions", keep_pose),
    ("Cs and Cd of the materials", keep_coefficients),
    ("Settings: gravity, solver, air", keep_settings),
    ("Masses", keep_masses),
    ("Pins", keep_pins),
    # Late, as the springs have other numbers then.
    ("Cuts", keep_cuts),
    # Last, as there are more bodies then than the run began with.
    ("Added: what was dropped into it", keep_added),
)


def ask_to_keep(app: Application) -> None:
    """Ask what of the run the editor takes over, which opens the level where it has not; each is a step of history."""
    play = app.play
    if play is None:
        return
    playback, source, of_document = play.playback, play.source, play.of_document
    world = playback.session.world

    def edit(label: str, keepers: tuple[Keeper, ...]) -> None:
        def kept(document: Document) -> Document:
            for keeper in keepers:
                document = keeper(document, world)
            return document

        editor = app.documents.editor
        assert editor is not None
        before = editor.document.level
        if editor.edit(label, kept):
            same = editor.document.level is before
            app.say("The level has all of that already." if same else f"{label}. Undo takes it back in the editor.")

    def keep(label: str, keepers: tuple[Keeper, ...]) -> None:
        if of_document:
            edit(label, keepers)
        else:
            app.documents.edit_run(playback.level, source, lambda: edit(label, keepers))

    editor = app.documents.editor
    document = editor.document if of_document and editor is not None else Document(playback.level)
    differing = tuple((name, keeper) for name, keeper in KEEPERS if _differs(document, keeper, world))
    if not differing:
        app.say("The level has all of the run already.", app.screen)
        return
    choices: list[tuple[str, Callable[[], object]]] = [
        (name, lambda name=name, keeper=keeper: keep(f"Keep {name[0].lower()}{name[1:]}", (keeper,)))  # type: ignore[misc]
        for name, keeper in differing
    ]
    if len(differing) > 1:
        everything = tuple(keeper for _, keeper in KEEPERS)
        choices.append(("All of it", lambda: keep("Keep all of the run", everything)))
    choose(app.ui, "Keep in the level", "What should the sheet take over from this run?", choices)


def _differs(document: Document, keeper: Keeper, world: LevelWorld) -> bool:
    """Whether a keeper finds something in the world that the level has otherwise, and can take it over."""
    try:
        return keeper(document, world).level != document.level
    except EditError:
        return False


MELTED = "One spring after another, as in the article's loop: what is stiff melts or explodes."
WHOLE = "All springs at once: it is whole again."


def is_melted(playback: Playback) -> bool:
    """Whether the run uses the solver that takes springs one by one, in which bodies melt."""
    return playback.session.world.settings.solver == "single_pass"


def toggle_melt(playback: Playback) -> str:
    """Solve springs one by one, which melts what is stiff, or all at once again; gives a line that says so."""
    before = is_melted(playback)
    duration = round(RAMP_TIME * playback.session.world.settings.tick_rate)
    playback.submit(SetSolver(solver="direct" if before else "single_pass", duration=duration))
    return WHOLE if before else MELTED
