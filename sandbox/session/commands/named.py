"""Slots in commands, annotated with the namespace by whose names files call them."""

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias, get_args, get_type_hints

from pydantic import Field

from sandbox.level.format.level_error import shown, suggestion
from sandbox.physics.softness.firmness import firm_bodies
from sandbox.physics.world import World
from sandbox.session.commands.faults import NO_NAME, NO_SLOT, CommandError


@dataclass(frozen=True)
class Named:
    """Names of one kind of slot.

    noun: as messages call one; names: by slot; find: slot of a name, or KeyError; kind: how pages call it, "": they
    have none of it; active: the array of state that says which are in use, "": all.
    """

    noun: str
    names: Callable[[World], Sequence[str]]
    find: Callable[[World, str], int]
    kind: str = ""
    active: str = ""

    def slot(self, world: World, name: Any) -> int:
        """The slot of a name that a file holds. Raises CommandError."""
        if not isinstance(name, str):
            raise CommandError(NO_NAME.format(self.noun))
        try:
            return self.find(world, name)
        except (KeyError, ValueError):
            others = world.particle_naming.second if self.kind == "particle" else ()
            near = suggestion(name, [*(each for each, _ in others), *self.names(world)])
            raise CommandError(NO_SLOT.format(self.noun, shown(name)) + near) from None

    def check(self, world: World, slot: int) -> None:
        """Whether a slot is there, in use, and no hand's. Raises CommandError."""
        names = self.names(world)
        is_hand = self.active and (world.is_grab_particle if self.kind == "particle" else world.is_grab_spring)(slot)
        if slot >= len(names) or is_hand or (self.active and not getattr(world, self.active)[slot]):
            raise CommandError(NO_SLOT.format(self.noun, shown(names[slot]) if slot < len(names) else slot))

    def __get_pydantic_json_schema__(self, core_schema: Any, handler: Any) -> dict[str, Any]:
        """The schema of a slot, with what it goes by."""
        return {**handler(core_schema), "names": self.kind, "noun": self.noun}


class SlotAsSaid(int):
    """A slot that was called by a second name, such as rope.end, which recordings keep: said."""

    said: str

    def __new__(cls, slot: int, said: str = "") -> "SlotAsSaid":
        found = super().__new__(cls, slot)
        found.said = said
        return found


def _as_said(names: Callable[[World], Sequence[str]], find: Callable[[World, str], int]) -> Callable[[World, str], int]:
    def slot(world: World, name: str) -> int:
        found = find(world, name)
        return found if names(world)[found] == name else SlotAsSaid(found, name)

    return slot


def _listed(names: Callable[[World], Sequence[str]]) -> Callable[[World, str], int]:
    return lambda world, name: names(world).index(name)


def _particles(world: World) -> Sequence[str]:
    return world.particle_names


def _springs(world: World) -> Sequence[str]:
    return world.spring_names


def _parts(world: World) -> Sequence[str]:
    return world.actuators.names


def _bodies(world: World) -> Sequence[str]:
    return world.area_names


def _forms(world: World) -> Sequence[str]:
    return [body.name for body in firm_bodies(world)]


def _keys(world: World) -> Sequence[str]:
    return world.rule_keys


def _materials(world: World) -> Sequence[str]:
    return world.material_names


_Slot = Annotated[int, Field(ge=0)]
PARTICLES = Named(
    "particle", _particles, _as_said(_particles, World.particle_slot), "particle", active="particle_active"
)
SPRINGS = Named("spring", _springs, _as_said(_springs, World.spring_slot), "spring", active="spring_active")
if TYPE_CHECKING:
    # A slot, or until the command is carried out its name: no type says which of the two it is when.
    ParticleSlot: TypeAlias = Any
    SpringSlot: TypeAlias = Any
    PartSlot: TypeAlias = Any
    BodySlot: TypeAlias = Any
    FormSlot: TypeAlias = Any
    KeySlot: TypeAlias = Any
    MaterialSlot: TypeAlias = Any
else:
    ParticleSlot = Annotated[_Slot, PARTICLES]
    SpringSlot = Annotated[_Slot, SPRINGS]
    PartSlot = Annotated[_Slot, Named("driven part", _parts, _listed(_parts), "part")]
    BodySlot = Annotated[_Slot, Named("body that keeps an area", _bodies, _listed(_bodies), "area")]
    FormSlot = Annotated[_Slot, Named("body whose form may be stiff", _forms, _listed(_forms), "form")]
    KeySlot = Annotated[_Slot, Named("key that a rule asks for", _keys, _listed(_keys), "key")]
    MaterialSlot = Annotated[_Slot, Named("material", _materials, _listed(_materials), "material")]


def namespace(annotation: Any) -> Named | None:
    """The namespace of a field of that annotation: a slot, a slot or None, a tuple of slots; None for all else."""
    for inner in get_args(annotation):
        found = inner if isinstance(inner, Named) else namespace(inner)
        if found is not None:
            return found
    return None


@functools.cache
def namespaces(kind: type) -> dict[str, Named]:
    """The fields of a command that go by name."""
    found = {field: namespace(hint) for field, hint in get_type_hints(kind, include_extras=True).items()}
    return {field: names for field, names in found.items() if names is not None}


def particle_of(world: World, slot: int) -> str:
    """The name of a particle that a command may work on. Raises CommandError."""
    PARTICLES.check(world, slot)
    return world.particle_names[slot]
