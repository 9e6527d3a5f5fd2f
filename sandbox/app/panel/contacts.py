"""ContactSettings: whether and how things touch in a level that is played; other settings begin the run again."""

from dataclasses import dataclass, replace
from functools import partial

from sandbox.app.base.sentences import sentence
from sandbox.app.contracts.application import Application
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.dialogs import choose
from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.bake import keep_coefficients
from sandbox.editor.edits.fields import set_setting
from sandbox.editor.edits.materials import set_rate_in_pace
from sandbox.level.document.model import CHANGEABLE_SETTINGS, ContactsDef, Level
from sandbox.level.format.quantities import replaced
from sandbox.physics.world import World


@dataclass(frozen=True)
class ContactSettings:
    """Whether things touch, and friction and bounce of what has none of its own; fixed: terrain or walls are there."""

    is_on: bool
    friction: float
    restitution: float
    fixed: bool

    @classmethod
    def of(cls, level: Level) -> "ContactSettings":
        """The contacts that a level has."""
        contacts = level.contacts or ContactsDef()
        fixed = level.walls is not None or bool(level.terrain)
        return cls(level.has_contacts, contacts.friction, contacts.restitution, fixed)

    @property
    def other(self) -> "ContactSettings":
        """These settings with contacts switched: on where they are off, off where they are on."""
        return replace(self, is_on=not self.is_on)


def level_with_contacts(playback: Playback, contacts: ContactSettings) -> Level:
    """The level of a run with these contacts, and the springs and the solver that the run has now.

    Raises EditError where the run cannot be had as a level.
    """
    world = playback.session.world
    level = level_at_rate(playback.level, world, world.settings.tick_rate, in_pace=False)
    changed = ContactsDef(friction=contacts.friction, restitution=contacts.restitution)
    return replaced(level, contacts=changed if contacts.is_on else None)


def restart_with_contacts(app: Application, playback: Playback, contacts: ContactSettings, of_document: bool) -> None:
    """Begin a run again with these contacts, or say why that cannot be."""
    if of_document:
        app.say("This run belongs to the editor. Change it there, on the page Level.", app.screen)
        return
    if contacts.fixed and not contacts.is_on:
        app.say("This level has terrain or walls, so contacts stay on.", app.screen)
        return
    try:
        level = level_with_contacts(playback, contacts)
    except EditError as error:
        app.say(sentence(error), app.screen)
        return
    app.start(Playback(level))
    app.say(f"From the beginning: things {'touch' if contacts.is_on else 'pass through'} each other.", app.screen)


def level_at_rate(level: Level, world: World, rate: int, in_pace: bool) -> Level:
    """The level of a run at another tick rate, with the springs and the solver that its world has now.

    in_pace: Cs and Cd are worked out again so that springs move per second as they do. Raises EditError.
    """
    document = keep_coefficients(Document(level), world)
    for name in CHANGEABLE_SETTINGS:
        document = set_setting(document, name, getattr(world.settings, name))
    return (set_rate_in_pace(document, rate) if in_pace else set_setting(document, "tick_rate", rate)).level


def ask_for_pace(app: Application, playback: Playback, rate: int) -> None:
    """Ask whether behaviour per second or Cs and Cd are kept, and begin the run again so."""

    def begin(in_pace: bool) -> None:
        try:
            level = level_at_rate(playback.level, playback.session.world, rate, in_pace)
        except EditError as error:
            app.say(sentence(error), app.screen)
            return
        app.start(Playback(level))
        app.say(f"The run starts over at {rate} ticks a second; E edits the level with them.", app.screen)

    choices = [
        ("Keep the behaviour per second", partial(begin, True)), ("Keep Cs and Cd as they are", partial(begin, False)),
    ]  # fmt: skip
    about = "The run starts over. With more ticks a second, the same Cs and Cd make a stiffer spring."
    choose(app.ui, f"{rate} ticks a second", about, choices)
