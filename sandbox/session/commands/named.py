"""Slots in commands, annotated with the namespace by whose names files call them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, get_args

from pydantic import Field

from sandbox.level.format.level_error import suggestion
from sandbox.physics.world import World
from sandbox.session.commands.command import CommandError


@dataclass(frozen=True)
class Named:
    """Names of one kind of slot. noun: as messages call one; names: by slot; find: slot of a name, or KeyError."""

    noun: str
    names: Callable[[World], Sequence[str]]
    find: Callable[[World, str], int]

    def slot(self, world: World, name: Any) -> int:
        """The slot of a name that a file holds. Raises CommandError."""
        if not isinstance(name, str):
            raise CommandError(f"a {self.noun} goes by its name in quotes, not {name!r:.80}")
        try:
            return self.find(world, name)
        except (KeyError, ValueError):
            near = suggestion(name, self.names(world))
            raise CommandError(f"there is no {self.noun} {name!r:.80}{near}") from None


def _listed(names: Callable[[World], Sequence[str]]) -> Callable[[World, str], int]:
    return lambda world, name: names(world).index(name)


def _parts(world: World) -> Sequence[str]:
    return world.actuators.names


def _bodies(world: World) -> Sequence[str]:
    return world.area_names


def _forms(world: World) -> Sequence[str]:
    return [body.name for body in world.forms]


def _materials(world: World) -> Sequence[str]:
    return world.material_names


_Slot = Annotated[int, Field(ge=0)]
ParticleSlot = Annotated[_Slot, Named("particle", lambda world: world.particle_names, World.particle_slot)]
SpringSlot = Annotated[_Slot, Named("spring", lambda world: world.spring_names, World.spring_slot)]
PartSlot = Annotated[_Slot, Named("driven part", _parts, _listed(_parts))]
BodySlot = Annotated[_Slot, Named("body that keeps an area", _bodies, _listed(_bodies))]
FormSlot = Annotated[_Slot, Named("body whose form may be stiff", _forms, _listed(_forms))]
MaterialSlot = Annotated[_Slot, Named("material", _materials, _listed(_materials))]


def namespace(annotation: Any) -> Named | None:
    """The namespace of a field of that annotation: a slot, a slot or None, a tuple of slots; None for all else."""
    for inner in get_args(annotation):
        found = inner if isinstance(inner, Named) else namespace(inner)
        if found is not None:
            return found
    return None


def particle_of(world: World, slot: int) -> str:
    """The name of a particle that a command may work on. Raises CommandError."""
    if slot >= world.particle_count or world.is_grab_particle(slot) or not world.particle_active[slot]:
        raise CommandError(f"there is no particle {slot}")
    return world.particle_names[slot]
