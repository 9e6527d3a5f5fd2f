"""ContactSettings: whether and how things touch in a level that is played; other settings begin the run again."""

from dataclasses import dataclass, replace

from sandbox.app.base.sentences import sentence
from sandbox.app.contracts.application import Application
from sandbox.app.panel.rate_choice import level_at_rate
from sandbox.app.run.playback import Playback
from sandbox.editor.document import EditError
from sandbox.level.document.model import ContactsDef, Level
from sandbox.level.format.quantities import replaced


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
        """The same with contacts on where they are off, or off where they are on."""
        return replace(self, is_on=not self.is_on)


def level_with_contacts(playback: Playback, contacts: ContactSettings) -> Level:
    """The level of a run with these contacts, and the springs and the solver that the run has now.

    Raises EditError where the run cannot be had as a level.
    """
    world = playback.session.world
    level = level_at_rate(playback.level, world, world.settings.tick_rate, in_pace=False)
    given = ContactsDef(friction=contacts.friction, restitution=contacts.restitution)
    return replaced(level, contacts=given if contacts.is_on else None)


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
