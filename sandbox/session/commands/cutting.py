"""Springs are cut."""

from dataclasses import dataclass

from sandbox.physics.world import World
from sandbox.session.commands.command import Command, CommandError
from sandbox.session.commands.named import SpringSlot


@dataclass(frozen=True)
class CutSprings(Command):
    """Take springs out of the world."""

    type = "cut_springs"
    springs: tuple[SpringSlot, ...]

    def carry_out(self, world: World) -> None:
        for slot in self.springs:
            if slot >= world.spring_count or world.is_grab_spring(slot) or not world.spring_active[slot]:
                name = repr(world.spring_names[slot]) if slot < len(world.spring_names) else slot
                raise CommandError(f"there is no spring {name} to cut")
        world.cut(self.springs)
