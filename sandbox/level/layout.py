"""Layout: which slots the bodies, loose particles and loose springs of a level get, and who has which name."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from sandbox.level.bodies import AnyBody, BridgeDef, RopeDef
from sandbox.level.faults import shown, suggestion
from sandbox.level.model import Level

_INDEX = re.compile(r"0|[1-9][0-9]{0,8}")


@dataclass(frozen=True)
class Owner:
    """The slots of one body or loose particle: first, how many, and the indices of its ends if it has ends."""

    first: int
    count: int
    ends: dict[str, int] | None = None
    loose: bool = False


class Layout:
    """Slots by name: particles of bodies in file order, then loose particles.

    counts: particles of each body. Names that are taken twice keep their first owner; `repeated` lists the others.
    """

    def __init__(self, level: Level, counts: Sequence[int]) -> None:
        self.owners: dict[str, Owner] = {}
        self.repeated: list[tuple[str, str]] = []
        first = 0
        for index, (body, count) in enumerate(zip(level.bodies, counts, strict=True)):
            self._add(body.id, Owner(first, count, _ends(body)), f"bodies.{index}.id")
            first += count
        for index, particle in enumerate(level.particles):
            self._add(particle.id, Owner(first, 1, loose=True), f"particles.{index}.id")
            first += 1
        self.particle_count = first

    def _add(self, name: str, owner: Owner, path: str) -> None:
        if name in self.owners:
            self.repeated.append((path, name))
        else:
            self.owners[name] = owner

    def end_names(self) -> Iterator[tuple[str, int]]:
        """The names `id.start` and `id.end` of the bodies that have ends, with their slots."""
        for name, owner in self.owners.items():
            for end, index in (owner.ends or {}).items():
                yield f"{name}.{end}", owner.first + index

    def slot(self, reference: str) -> int:
        """Slot of the particle that `id`, `id.k`, `id.start` or `id.end` refers to. Raises LookupError."""
        name, dot, part = reference.partition(".")
        owner = self.owners.get(name)
        if owner is None:
            raise LookupError(f"there is no body or particle {shown(name)}" + suggestion(name, self.owners))
        if owner.loose:
            if dot:
                raise LookupError(f'"{name}" is a single particle; write "{name}"')
            return owner.first
        if owner.ends and part in owner.ends:
            return owner.first + owner.ends[part]
        if _INDEX.fullmatch(part):
            if int(part) < owner.count:
                return owner.first + int(part)
            raise LookupError(f'"{name}" has the particles {name}.0 to {name}.{owner.count - 1}')
        ends = f", {name}.start or {name}.end" if owner.ends else ""
        raise LookupError(f'"{name}" is a body; name one of its particles: {name}.0 to {name}.{owner.count - 1}{ends}')


def _ends(body: AnyBody) -> dict[str, int] | None:
    return {"start": 0, "end": body.segments} if isinstance(body, RopeDef | BridgeDef) else None
