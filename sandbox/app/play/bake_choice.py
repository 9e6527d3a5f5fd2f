"""Keeping of what playing has changed: a choice that puts it into the document that is played."""

from collections.abc import Callable

from sandbox.app.contracts.application import Application
from sandbox.app.widgets.dialogs import choose
from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.adopt_dropped import keep_added
from sandbox.editor.edits.bake import keep_coefficients, keep_cuts, keep_masses, keep_pins, keep_pose, keep_settings
from sandbox.level.assembly.level_world import LevelWorld

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
