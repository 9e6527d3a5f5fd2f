"""Keeping of what playing has changed: a choice that puts it into the document that is played."""

from collections.abc import Callable

from sandbox.app.contracts.application import Application
from sandbox.app.widgets.dialogs import choose
from sandbox.editor.document import Document
from sandbox.editor.edits.adopt_dropped import keep_added
from sandbox.editor.edits.bake import keep_coefficients, keep_cuts, keep_pins, keep_pose
from sandbox.physics.world import World

Keeper = Callable[[Document, World], Document]
KEEPERS: tuple[tuple[str, Keeper], ...] = (
    ("Cs and Cd of the materials", keep_coefficients),
    ("Pose: the present positions", keep_pose),
    ("Pins", keep_pins),
    # Late, as the springs have other numbers then.
    ("Cuts", keep_cuts),
    # Last, as there are more bodies then than the run began with.
    ("Added: what was dropped into it", keep_added),
)


def ask_to_keep(app: Application) -> None:
    """Ask what of the run the document takes over; each is a step of its history."""
    play, editor = app.play, app.documents.editor
    if play is None or editor is None or not play.of_document:
        app.say("Open the level in the editor first: press E.")
        return
    world = play.playback.session.world

    def keep(label: str, keepers: tuple[Keeper, ...]) -> None:
        def kept(document: Document) -> Document:
            for keeper in keepers:
                document = keeper(document, world)
            return document

        before = editor.document.level
        if editor.edit(label, kept):
            same = editor.document.level is before
            app.say("The level has all of that already." if same else f"{label}. Undo takes it back in the editor.")

    choices: list[tuple[str, Callable[[], object]]] = [
        (name, lambda name=name, keeper=keeper: keep(f"Keep {name[0].lower()}{name[1:]}", (keeper,)))  # type: ignore[misc]
        for name, keeper in KEEPERS
    ]
    everything = tuple(keeper for _, keeper in KEEPERS)
    choices.append(("All of it", lambda: keep("Keep all of the run", everything)))
    choose(app.ui, "Keep in the level", "What should the level take over from this run?", choices)
