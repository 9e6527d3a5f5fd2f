"""What joined the run gets another colour, which physics does not know."""

from dataclasses import dataclass, replace
from typing import Any

from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.assembly.joining import Joiners
from sandbox.level.format.look import ColourName
from sandbox.session.commands.command import Command, CommandError
from sandbox.session.commands.named import ParticleSlot

# Skins that are painted over: what they show is no colour.
LAID = ("wood", "stone", "brick")
NOT_MADE = "{} is of the level: only what was made in the run gets another colour"


@dataclass(frozen=True)
class SetColour(Command):
    """Give the body of a particle that joined the run a colour: one of the palette by its name, or #RRGGBB.

    What is laid of planks or stones is painted over.
    """

    type = "set_colour"
    particle: ParticleSlot
    colour: ColourName

    def carry_out(self, world: LevelWorld, giver: int) -> None:
        name = world.particle_names[self.particle]
        body = name.partition(".")[0]
        found = next((k for k, each in enumerate(world.joined) if body in each.names), None)
        if found is None or "kit" in world.joined[found].definition:
            raise CommandError(NOT_MADE.format(name))
        joined = world.joined[found]
        bodies = [joined.definition["body"], *(joined.definition.get("others") or ())]
        number = joined.names.index(body)
        bodies[number] = self._painted(bodies[number])
        definition = {**joined.definition, "body": bodies[0], "others": tuple(bodies[1:])}
        level = Joiners(world, definition).level
        painted = replace(joined, definition=definition, level=level)
        world.joined = (*world.joined[:found], painted, *world.joined[found + 1 :])

    def _painted(self, body: dict[str, Any]) -> dict[str, Any]:
        """A definition of a body in the colour."""
        look = dict(body.get("look") or {})
        skin = {"skin": "plain"} if look.get("skin") in LAID else {}
        return {**body, "look": look | skin | {"colour": self.colour}}
