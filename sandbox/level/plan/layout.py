"""Layout: the slots of bodies, loose particles and loose springs of a level, and their names."""

import re
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

from sandbox.level.format.level_error import shown, suggestion
from sandbox.level.kinds.expansion import Expansion

_INDEX = re.compile(r"0|[1-9][0-9]{0,8}")


class Owner(NamedTuple):
    """The slots of one body or loose particle: first slot, count, and the indices of particles with names."""

    first: int
    size: int
    named: Mapping[str, int] = MappingProxyType({})
    loose: bool = False


class Layout:
    """Slots by name, as they are before welds: particles of bodies in file order, then loose particles.

    bodies: expansions of the bodies, which have the first ids. A repeated name belongs to its first owner; `repeated`
    lists the others.
    """

    def __init__(self, body_ids: Sequence[str], bodies: Sequence[Expansion[Any]], particle_ids: Sequence[str]) -> None:
        self.owners: dict[str, Owner] = {}
        self.repeated: list[tuple[str, str]] = []
        first = 0
        for index, (name, body) in enumerate(zip(body_ids, bodies, strict=True)):
            count = body.form_count[0]
            self._add("bodies", index, name, Owner(first, count, body.named_particles))
            first += count
        for index, name in enumerate(particle_ids):
            self._add("particles", index, name, Owner(first, 1, loose=True))
            first += 1
        self.particle_count = first

    def _add(self, part: str, index: int, name: str, owner: Owner) -> None:
        if name in self.owners:
            self.repeated.append((f"{part}.{index}.id", name))
        else:
            self.owners[name] = owner

    def second_names(self) -> Iterator[tuple[str, int]]:
        """Names such as `id.start`, with their slots."""
        for name, owner in self.owners.items():
            for part, index in owner.named.items():
                yield f"{name}.{part}", owner.first + index

    def slot(self, reference: str) -> int:
        """Slot of the particle with a name: `id`, `id.k`, or one such as `id.start`. Raises LookupError."""
        owner = self.owners.get(reference)
        if owner is not None and owner.loose:
            return owner.first
        name, _, part = reference.partition(".")
        owner = self.owners.get(name)
        if owner is None:
            raise LookupError(f"there is no body or particle {shown(name)}" + suggestion(name, self.owners))
        if owner.loose:
            raise LookupError(f'"{name}" is a single particle; write "{name}"')
        if part in owner.named:
            return owner.first + owner.named[part]
        if _INDEX.fullmatch(part):
            if int(part) < owner.size:
                return owner.first + int(part)
            raise LookupError(f'"{name}" has the particles {name}.0 to {name}.{owner.size - 1}')
        choices = [f"{name}.0 to {name}.{owner.size - 1}", *(f"{name}.{part}" for part in owner.named)]
        listed = choices[0] if len(choices) == 1 else ", ".join(choices[:-1]) + " or " + choices[-1]
        raise LookupError(f'"{name}" is a body; name one of its particles: {listed}')
