"""The hangers tool: many springs between two ropes, bridges or girders in one drag."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.document import Document, EditError, checked
from sandbox.editor.edits.grouping import taken_groups
from sandbox.editor.edits.names import free_ids
from sandbox.editor.items import Item
from sandbox.editor.scene import Scene
from sandbox.editor.tools.drawing_bodies import known_material
from sandbox.editor.tools.drawing_options import Options, count_option, material_option
from sandbox.editor.tools.drawing_tool import Drawing, EditorTool, staged
from sandbox.editor.tools.snap import Snap
from sandbox.level.document.model import SpringDef
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import AnyBody
from sandbox.level.kinds.bridge import BridgeDef
from sandbox.level.kinds.girder import GirderDef
from sandbox.level.kinds.mesh import MeshDef
from sandbox.level.kinds.rope import RopeDef

Slots = NDArray[np.int64]
WHERE = "on a rope, a bridge or a girder"


@dataclass(frozen=True)
class HangersOptions(Options):
    """Options of hangers: how many, and of what."""

    count: int | None = count_option(
        "hangers", "Number of hangers; empty = one for each particle of the coarser side.", 1
    )
    material: str = material_option()


class HangersDrawing(Drawing[HangersOptions]):
    """Springs from one row of particles to another, between where the drag begins and where it ends."""

    defaults = HangersOptions()
    step = "Draw hangers"
    start_hint = f"Press {WHERE}, where the first hanger goes, and drag to the other one, where the last ends"
    end_hint = f"End {WHERE} beside it"
    counted = "count"

    def __init__(self, options: HangersOptions | None = None, reach: float = 0.0) -> None:
        super().__init__(options, reach)
        self._most = self._made = 1

    def _shown(self, document: Document, points: list[Snap]) -> Document:
        """The hangers, with stand-ins of the particles that they join."""
        stage, stood = staged(document, [snap for pair in self._pairs(document, points) for snap in pair])
        return self._hung(stage, list(zip(stood[::2], stood[1::2], strict=True)))

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the hangers, one group, selected. Raises EditError."""
        return self._hung(document, self._pairs(document, points))

    def fitting(self, points: list[Snap]) -> int:
        """How many hangers there are with one at every particle of the coarser row."""
        return self._most

    def sizes(self, points: list[Snap]) -> str:
        """Number of hangers, in words."""
        return "" if self._ghost_fault else f"{self._made} {'hanger' if self._made == 1 else 'hangers'}"

    def _hung(self, document: Document, pairs: list[tuple[Snap, Snap]]) -> Document:
        level, material = document.level, known_material(document, self.options.material)
        group = free_ids(taken_groups(level), ["hangers"])[0] if len(pairs) > 1 else None
        new = tuple(SpringDef(a=str(a.name), b=str(b.name), material=material, group=group) for a, b in pairs)
        first = len(level.springs)
        level = checked(replaced(level, springs=(*level.springs, *new)))
        return Document(level, frozenset(Item("spring", first + index) for index in range(len(new))))

    def _pairs(self, document: Document, points: list[Snap]) -> list[tuple[Snap, Snap]]:
        """The particles that hangers join. Raises EditError."""
        scene = self._scene_of(document)
        (upper, first), (lower, last) = (
            _row(scene, point, verb) for point, verb in zip(points, ("begin", "end"), strict=True)
        )
        if upper[0] == lower[0]:
            raise EditError("finish on the other rope: hangers join two of them")
        ranges = [
            _between(upper, first, _nearest(scene, upper, lower[last])),
            _between(lower, _nearest(scene, lower, upper[first]), last),
        ]
        coarse, fine = sorted(ranges, key=len)
        self._most = len(coarse)
        count = min(self.options.count or self._most, len(fine))
        base = fine if count > len(coarse) else coarse
        other = coarse if base is fine else fine
        chosen = base[np.round(np.linspace(0, len(base) - 1, count)).astype(np.int64)]
        way = scene.position[base[-1]] - scene.position[base[0]]
        along = scene.position[other] @ way
        partners = [int(other[np.argmin(np.abs(along - scene.position[slot] @ way))]) for slot in chosen.tolist()]
        joined = {frozenset((spring.a, spring.b)) for spring in scene.level.springs}
        pairs = []
        for slot, partner in dict(zip(chosen.tolist(), partners, strict=True)).items():
            a, b = (slot, partner) if base is ranges[0] else (partner, slot)
            names = scene.names(a), scene.names(b)
            if scene.first_of_weld[a] != scene.first_of_weld[b] and frozenset(names) not in joined:
                pairs.append((_snap(scene, a), _snap(scene, b)))
        self._made = len(pairs)
        if not pairs:
            raise EditError("they are joined there already")
        return pairs


def _row(scene: Scene, point: Snap, verb: str) -> tuple[Slots, int]:
    """The row of particles that a point is on, and which of it. Raises EditError where it is on none."""
    if point.name is not None:
        slot = scene.slot(point.name)
        item = int(scene.particle_item[slot])
        if item < len(scene.level.bodies):
            start = int(np.searchsorted(scene.particle_item, item))
            found = next((row for row in _rows(scene.level.bodies[item]) if slot - start in row), None)
            if found is not None:
                return np.array(found) + start, found.index(slot - start)
    raise EditError(f"{verb} {WHERE}")


def _rows(body: AnyBody) -> Sequence[Sequence[int]]:
    """The rows of a body, by the indices of its particles."""
    if isinstance(body, RopeDef):
        return [range(body.segments + 1)]
    if isinstance(body, MeshDef):
        return _strand(body)
    if isinstance(body, BridgeDef):
        return [range(body.segments + 1), range(body.segments + 1, 2 * body.segments + 2)]
    if isinstance(body, GirderDef):
        return [range(body.segments + 1), range(body.segments + 1, 2 * body.segments + 1)]
    return []


def _strand(body: MeshDef) -> list[list[int]]:
    """The particles of a mesh in their order along it, where its springs make it one strand, as a rope's do."""
    beside: dict[int, list[int]] = {}
    for a, b in body.springs:
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    ends = [particle for particle, others in beside.items() if len(others) == 1]
    if len(ends) != 2 or max(map(len, beside.values())) > 2:
        return []
    row, before = [min(ends)], -1
    while (onward := [other for other in beside[row[-1]] if other != before]) and len(row) <= len(beside):
        before = row[-1]
        row.append(onward[0])
    return [row]


def _nearest(scene: Scene, row: Slots, slot: int) -> int:
    """Which particle of a row is beside another, measured along the row from end to end: a cable sags."""
    apart = scene.position[row] - scene.position[slot]
    return int(np.argmin(np.abs(apart @ (apart[-1] - apart[0]))))


def _between(row: Slots, first: int, last: int) -> Slots:
    """The particles of a row from one to another, in that order."""
    return row[first : last + 1] if first <= last else row[last : first + 1][::-1]


def _snap(scene: Scene, slot: int) -> Snap:
    return Snap(scene.place(slot), "particle", scene.names(slot))


HANGERS = EditorTool("hangers", "Shift+S", "Hangers: many springs between two ropes", HangersDrawing)
