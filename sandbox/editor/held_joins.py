"""Joins under an edit: what is joined to something that an edit moved stays joined to it.

An end of a rope, bridge or girder goes to where its join is; anything else comes along whole, with its group. A join is
let go where the edit moved one end of such a body away from it, and where two joins would pull one body apart.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sandbox.editor.document import Document, EditError, check_places, checked
from sandbox.editor.edits.grouping import with_groups
from sandbox.editor.edits.moving import shifted, within, without_dust
from sandbox.editor.edits.names import owner_of
from sandbox.editor.items import Item, Kind, with_same
from sandbox.level.document.model import Level, ParticleDef
from sandbox.level.format.level_error import shown
from sandbox.level.format.quantities import Point, replaced
from sandbox.level.kinds.bodies import AnyBody, expansion
from sandbox.level.kinds.geometry import Points

# Two places this near [m] are one, far above rounding.
SAME = 1e-6
ENDS = ("start", "end")
_KINDS = ("bodies", "particles", "terrain")

Weld = tuple[str, str]
# An end of a body: its id and the name of the field.
End = tuple[str, str]


@dataclass(frozen=True)
class Held:
    """A document whose joins hold, and the pairs of particles, by name, that are joined no longer.

    is_undone: whether joins undid all that the edit did.
    """

    document: Document
    let_go: tuple[Weld, ...] = ()

    is_undone: bool = False

    @property
    def notice(self) -> str:
        """A line for the person: which joins were let go, or that joins keep all in place; "" where there is none."""
        if self.is_undone:
            return "Nothing moved: its joins hold it. Select what it is joined to too, or take its joints apart (K)."
        pairs = dict.fromkeys(tuple(shown(owner_of(name)) for name in pair) for pair in self.let_go)
        if not pairs:
            return ""
        names = "; ".join(f"{a} and {b}" for a, b in pairs)
        return f"No longer joined: {names}. Undo joins {'them' if len(self.let_go) == 1 else 'all of them'} again."


def with_joins_held(before: Level, document: Document) -> Held:
    """The document after an edit, with its joins made to hold."""
    level = document.level
    if not level.welds or level is before or (level.bodies, level.particles) == (before.bodies, before.particles):
        return Held(document)
    work = _Holding(before, level)
    now = work.held()
    if now == before:
        return Held(replace(document, level=before), is_undone=True)
    return Held(replace(document, level=now), tuple(work.let_go))


class _Holding:
    """Goes from join to join: each part gives way once, so that it comes to an end."""

    def __init__(self, before: Level, level: Level) -> None:
        self._level, self.let_go = level, list[Weld]()
        self._was, self._is = _parts(before), _parts(level)
        same = _same_welds(before, level)
        # What each weld was called before; new ones are not among them.
        self._before = {new: old for old, new in same}
        # Places of particles by the object that they are of, most of which stay the same ones.
        self._places: dict[int, Points] = {}
        self._alive: list[AnyBody] = []
        names = {name: old for pair in same for old, name in zip(*pair, strict=True)}
        moved = {
            name for name, old in names.items()
            if self._was[owner_of(old)] is not self._is[owner_of(name)]
            and not _is_same(self._place(self._was, old), self._place(self._is, name))
        }  # fmt: skip
        # What does not give way: bodies, by id, that the edit moved or that have come along, and ends that are set.
        self._settled = {owner_of(name) for name in moved}
        self._set: set[End] = set()
        # Ends that the edit moved on their own, the other end of the body staying.
        self._meant = {
            end for name in moved if (end := self._end_of(name)) is not None and self._is_alone(names[name], end)
        }

    def held(self) -> Level:
        """The level with all joins held, or let go. Raises EditError where it could not be saved so."""
        todo = [weld for weld in self._before if self._settled & {owner_of(name) for name in weld}]
        while todo:
            a, b = weld = todo.pop(0)
            if weld not in self._before:
                continue
            now, was = self._between(self._is, weld), self._between(self._was, self._before[weld])
            gap = (now[0] - was[0], now[1] - was[1])
            if _is_same(gap, (0.0, 0.0)) or _is_same(now, (0.0, 0.0)):
                continue
            moved = self._give_way(a, b, gap)
            if moved:
                # All that hangs on what gave way is looked at again.
                todo += [other for other in self._before if moved & {owner_of(name) for name in other}]
            else:
                del self._before[weld]
                self.let_go.append(weld)
        level = self._level
        gone = set(self.let_go)
        kept = tuple(pair for pair in level.welds if pair not in gone)
        kinds = {name: tuple(self._is[part.id] for part in getattr(level, name)) for name in _KINDS}
        level = with_same(level, **kinds)
        if gone:
            level = replaced(level, welds=kept)
        return level if level is self._level else checked(level)

    def _give_way(self, a: str, b: str, gap: Point) -> set[str]:
        """Move one of two particles to the other; the ids of what moved, none where neither can give way.

        gap [m]: from where the second ought to be to where it is.
        """
        sides = [(b, (-gap[0], -gap[1])), (a, gap)]
        # What the edit left alone gives way first.
        sides.sort(key=lambda side: owner_of(side[0]) in self._settled)
        ends = [self._end_of(name) for name, _ in sides]
        if self._meant.intersection(ends):
            return set()
        for end, (_, by) in zip(ends, sides, strict=True):
            if end is not None and end not in self._set and self._put_end(end, by):
                return {end[0]}
        for name, by in sides:
            if owner_of(name) not in self._settled and (along := self._bring(owner_of(name), by)):
                return along
        return set()

    def _put_end(self, end: End, by: Point) -> bool:
        """Move an end of a body alone; whether it can be."""
        self._set.add(end)
        owner, field = end
        old = self._is[owner]
        x, y = old.__dict__[field]
        new = without_dust(replaced(old, **{field: (x + by[0], y + by[1])}))
        try:
            check_places([within(new)])
            if old.pose is not None:
                pose = expansion(new).form + np.array(old.pose) - expansion(old).form
                new = within(replaced(new, pose=tuple(map(tuple, pose.tolist()))))
        except EditError:
            return False
        self._is[owner] = new
        return True

    def _bring(self, owner: str, by: Point) -> set[str]:
        """Move a body or loose particle with its group; the ids of what moved, none where it cannot."""
        kind: Kind = "particle" if isinstance(self._is[owner], ParticleDef) else "body"
        group = with_groups(self._level, frozenset([Item(kind, owner)]))
        ids = {str(item.key) for item in group if item.kind != "spring"} - self._settled
        try:
            self._is |= {name: within(without_dust(shifted(self._is[name], *by))) for name in ids}
        except EditError:
            return set()
        self._settled |= ids
        return ids

    def _end_of(self, name: str) -> End | None:
        """The end of a body that a particle is, of those that have a field for it."""
        owner, _, part = name.partition(".")
        body = self._is[owner]
        if isinstance(body, ParticleDef) or any(field not in body.__dict__ for field in ENDS):
            return None
        named = expansion(body).named_particles
        slot = named[part] if part in named else int(part)
        return next(((owner, field) for field in ENDS if named[field] == slot), None)

    def _place(self, parts: dict[str, Any], name: str) -> Point:
        """Where a particle lies [m], by itself: of one that is welded its own place."""
        owner, _, part = name.partition(".")
        body = parts[owner]
        if isinstance(body, ParticleDef):
            return body.position
        if id(body) not in self._places:
            self._places[id(body)] = expansion(body).position
            self._alive.append(body)
        named = expansion(body).named_particles
        x, y = self._places[id(body)][named[part] if part in named else int(part)].tolist()
        return x, y

    def _between(self, parts: dict[str, Any], weld: Weld) -> Point:
        """The way from the first particle of a weld to the second [m]."""
        (ax, ay), (bx, by) = (self._place(parts, name) for name in weld)
        return bx - ax, by - ay

    def _is_alone(self, old_name: str, end: End) -> bool:
        """Whether the body's other end has not moved."""
        owner, field = end
        other = ENDS[1 - ENDS.index(field)]
        before, now = self._was[owner_of(old_name)].__dict__.get(other), self._is[owner].__dict__[other]
        return before is not None and _is_same(before, now)


def _same_welds(before: Level, after: Level) -> list[tuple[Weld, Weld]]:
    """Welds of the level before, with what they are called in that after."""
    old, new = before.welds, after.welds
    if len(old) == len(new):
        return list(zip(old, new, strict=True))
    there = set(old)
    return [(weld, weld) for weld in new if weld in there]


def _parts(level: Level) -> dict[str, Any]:
    """Bodies, loose particles and terrain, by id."""
    return {part.id: part for name in _KINDS for part in getattr(level, name)}


def _is_same(one: Point, other: Point) -> bool:
    return math.dist(one, other) <= SAME
