"""Whether things touch each other in a level that is played, and how: another way begins the run again."""

from dataclasses import dataclass, replace

from sandbox.app.base.sentences import sentence
from sandbox.app.contracts.application import Application
from sandbox.app.panel.rate_choice import level_at_rate
from sandbox.app.run.playback import Playback
from sandbox.editor.document import EditError
from sandbox.level.document.model import ContactsDef, Level
from sandbox.level.format.quantities import replaced


@dataclass(frozen=True)
class Touching:
    """Whether things touch, and friction and bounce of what says nothing else; fixed: terrain or walls are touched."""

    is_on: bool
    friction: float
    restitution: float
    fixed: bool

    @classmethod
    def of(cls, level: Level) -> "Touching":
        """That of a level."""
        contacts = level.contacts or ContactsDef()
        fixed = level.walls is not None or bool(level.terrain)
        return cls(level.has_contacts, contacts.friction, contacts.restitution, fixed)

    @property
    def other(self) -> "Touching":
        """The other way."""
        return replace(self, is_on=not self.is_on)


def level_touching(playback: Playback, touching: Touching) -> Level:
    """The level of a run, with the springs and the solver that the run has now, in which things touch so.

    Raises EditError where the run cannot be had as a level.
    """
    world = playback.session.world
    level = level_at_rate(playback.level, world, world.settings.tick_rate, in_pace=False)
    contacts = ContactsDef(friction=touching.friction, restitution=touching.restitution)
    return replaced(level, contacts=contacts if touching.is_on else None)


def begin_touching(app: Application, playback: Playback, touching: Touching, of_document: bool) -> None:
    """Begin a run again with things that touch so, or say why that cannot be."""
    if of_document:
        app.say("This run belongs to the editor. Change it there, on the page Level.")
        return
    if touching.fixed and not touching.is_on:
        app.say("This level has terrain or walls, so contacts stay on.")
        return
    try:
        level = level_touching(playback, touching)
    except EditError as error:
        app.say(sentence(error))
        return
    app.start(Playback(level))
    app.say(f"From the beginning: things {'touch' if touching.is_on else 'pass through'} each other.")
