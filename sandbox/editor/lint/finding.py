"""Finding: one thing about a level that its maker may want to know; rules look for them, remedies mend them."""

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.document import Document, EditError, select
from sandbox.editor.edits.deleting import delete
from sandbox.editor.edits.fields import set_level_field, set_setting
from sandbox.editor.edits.placing import weld
from sandbox.editor.edits.terrain import add_terrain, with_corners
from sandbox.editor.items import Item, Selection
from sandbox.editor.scene import Scene, make_scene
from sandbox.level.document.model import ContactsDef, Level, TerrainDef
from sandbox.physics.marks import TERRAIN_GROUP

Severity = Literal["error", "warning", "hint"]
Floats = NDArray[np.float64]
Slots = NDArray[np.int64]
# What a rule gives: findings, and None where it has worked for long enough to let the window draw.
Rule = Iterator["Finding | None"]

# Findings of one kind that are listed one by one; more of them are one line.
LISTED = 3
_DECIMALS = 2
Edit = Callable[[Document], Document]


class Remedy(NamedTuple):
    """An edit that mends what was found, and what its button says.

    many: the same for several things, whose edit is made from all of them; None: each is mended by its own edit.
    """

    label: str
    edit: Edit
    many: tuple[str, Callable[[Selection], Edit]] | None = None


# The gravest first.
SEVERITIES: tuple[Severity, ...] = ("error", "warning", "hint")


@dataclass(frozen=True)
class Finding:
    """A sentence that says what is so and what to do, the items it is about, where [m], and what mends it.

    many: what is said of several of its kind, with {count}; "": each stands for itself.
    """

    severity: Severity
    text: str
    items: Selection
    place: tuple[float, float] | None
    remedy: Remedy | None = None
    many: str = ""


def listed(rule: Rule) -> Rule:
    """The findings of a rule; of a kind that is found more often than LISTED times, one for all."""
    kinds: dict[str, list[Finding]] = {}
    for finding in rule:
        if finding is None or not finding.many:
            yield finding
        else:
            kinds.setdefault(finding.many, []).append(finding)
            yield None
    for found in kinds.values():
        yield from found if len(found) <= LISTED else [_of_all(found)]


def _of_all(found: list[Finding]) -> Finding:
    """One finding for several of a kind."""
    items = frozenset[Item]().union(*(each.items for each in found))
    severity = min((each.severity for each in found), key=SEVERITIES.index)
    text, remedies = found[0].many.format(count=len(found)), [each.remedy for each in found if each.remedy is not None]
    return Finding(severity, text, items, found[0].place, _remedy_of_all(remedies, items))


def _remedy_of_all(remedies: list[Remedy], items: Selection) -> Remedy | None:
    if not remedies:
        return None
    first = remedies[0]
    if first.many is not None:
        return Remedy(first.many[0], first.many[1](items))

    def each(document: Document) -> Document:
        before, error = document, EditError("nothing is left to mend")
        for remedy in remedies:
            try:
                document = remedy.edit(document)
            except EditError as fault:
                # One may have mended another: what is joined to both ends of a third is joined already.
                error = fault
        if document is before:
            raise error
        return document

    return Remedy(f"{first.label}, all {len(remedies)}", each)


def called(level: Level, item: Item) -> str:
    """An item as sentences name it: a loose spring by its name, or else by its ends."""
    if item.kind != "spring":
        return f'"{item.key}"'
    spring = level.springs[int(item.key)]
    return f'the spring "{spring.name}"' if spring.name else f'the spring from "{spring.a}" to "{spring.b}"'


def called_spring(scene: Scene, spring: int) -> str:
    """The name of a spring in sentences."""
    item = scene.items[int(scene.spring_item[spring])]
    return called(scene.level, item) if item.kind == "spring" else scene.spring_name(spring)


def middle_of(scene: Scene, spring: int) -> tuple[float, float]:
    """Middle [m] of a spring."""
    ends = scene.position[[scene.particle_a[spring], scene.particle_b[spring]]]
    x, y = ends.mean(axis=0).tolist()
    return x, y


def connected_parts(scene: Scene) -> Generator[None, None, Slots]:
    """The lowest slot of the part that each particle belongs to (n,): what springs and welds hold together.

    Roots take over the lowest neighbour's label until no spring joins two labels, which takes few rounds.
    """
    label = scene.first_of_weld.copy()
    a, b = scene.particle_a, scene.particle_b
    while True:
        a, b = label[a], label[b]
        apart = a != b
        a, b = a[apart], b[apart]
        if not len(a):
            return label
        np.minimum.at(label, np.maximum(a, b), np.minimum(a, b))
        yield None
        while True:
            lower = label[label]
            if np.array_equal(lower, label):
                break
            label = lower
        yield None


def falling_particles(level: Level, scene: Scene) -> Generator[None, None, tuple[Slots, NDArray[np.bool_]]]:
    """The part that each particle belongs to (n,), and whether it falls away (n,): nothing holds or catches it.

    What lies above something that is held falls on that, where the two touch.
    """
    part = yield from connected_parts(scene)
    held = np.zeros(len(part), dtype=np.bool_)
    held[part[scene.pinned]] = True
    pulled = np.zeros(len(part), dtype=np.bool_)
    pulled[part[_scales(level, scene) != 0.0]] = True
    if level.settings.gravity == (0.0, 0.0):
        pulled[:] = False
    falls = pulled & ~held
    if level.has_water and falls.any():
        yield None
        falls &= ~_over_water(level, scene, part)
    if level.has_contacts and falls.any():
        yield None
        falls &= ~_caught(level, scene, part)
        yield from _let_rest(level, scene, part, held, falls)
    return part, falls[part]


def _scales(level: Level, scene: Scene) -> NDArray[np.float64]:
    """Gravity as a factor at each particle (n,)."""
    scales = [part.gravity_scale for parts in (level.bodies, level.particles) for part in parts]
    return np.array(scales, dtype=np.float64)[scene.particle_item]


def _over_water(level: Level, scene: Scene, part: Slots) -> NDArray[np.bool_]:
    """Whether each part, by its label (n,), is in water or above some."""
    above = np.zeros(len(part), dtype=np.bool_)
    x, y = scene.position.T
    for zone in level.zones:
        if zone.water is not None and zone.box is not None:
            left, bottom, right, _ = zone.box
            above[part[(x > left) & (x < right) & (y > bottom)]] = True
    return above


def _caught(level: Level, scene: Scene, part: Slots) -> NDArray[np.bool_]:
    """Whether each part, by its label (n,), has walls around it, or terrain somewhere below it."""
    touches = scene.collision.touches & TERRAIN_GROUP != 0
    caught = np.zeros(len(part), dtype=np.bool_)
    if level.walls is not None:
        caught[part[touches]] = True
        return caught
    turned = _turned(level)
    low, high = _spans(scene.position[touches] @ turned, part[touches], len(part))
    corners = scene.corner @ turned
    for index in np.unique(scene.corner_item[scene.corner_item < scene.zone_start]).tolist():
        mine = corners[scene.corner_item == index]
        caught |= _is_above(low, high, mine.min(axis=0), mine.max(axis=0))
    return caught


def _let_rest(
    level: Level, scene: Scene, part: Slots, held: NDArray[np.bool_], falls: NDArray[np.bool_]
) -> Generator[None, None, None]:
    """Take from parts that fall, by their labels (n,), those that fall on a part that is held and that they touch."""
    low, high = _spans(scene.position @ _turned(level), part, len(part))
    for holder in np.flatnonzero(held).tolist():
        falling = np.flatnonzero(falls)
        if not len(falling):
            return
        rests = _is_above(low[falling], high[falling], low[holder], high[holder])
        falls[falling[rests & scene.collision.meet(falling, holder)]] = False
        yield None


def _turned(level: Level) -> Floats:
    """Matrix (2, 2) from places to their distances along the way that things fall, and across it."""
    x, y = np.array(level.settings.gravity) / np.hypot(*level.settings.gravity)
    return np.array([(x, -y), (y, x)])


def _spans(places: Floats, part: Slots, count: int) -> tuple[Floats, Floats]:
    """The least and the most of the places of each part, by its label (count, 2); none of what is empty."""
    low, high = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    np.minimum.at(low, part, places)
    np.maximum.at(high, part, places)
    return low, high


def _is_above(low: Floats, high: Floats, least: Floats, most: Floats) -> NDArray[np.bool_]:
    """Which of spans (k, 2) lie over another and begin no lower than it ends."""
    return np.asarray((low[:, 0] <= most[0]) & (low[:, 1] <= most[1]) & (high[:, 1] >= least[1]))


# Ground that is drawn below everything lies so far below the lowest thing, is so thick, and reaches so far beyond [m].
BELOW, THICKNESS, BEYOND = 0.5, 1.0, 4.0


def deletion(items: Selection) -> Remedy:
    """Delete items."""

    def of_all(chosen: Selection) -> Callable[[Document], Document]:
        return lambda document: delete(select(document, chosen))

    return Remedy("Delete it", of_all(items), ("Delete them", of_all))


def joint(a: str, b: str) -> Remedy:
    """The remedy that welds two particles."""
    return Remedy("Join them", lambda document: weld(document, a, b))


def draw_ground(document: Document) -> Document:
    """Draw ground below everything, and let things touch."""
    box = make_scene(document.level).bounds()
    if box is None:
        raise EditError("there is nothing to draw ground below")
    left, right, top = box[0] - BEYOND, box[2] + BEYOND, box[1] - BELOW
    corners = [(left, top - THICKNESS), (right, top - THICKNESS), (right, top), (left, top)]
    rounded = [(round(x, _DECIMALS), round(y, _DECIMALS)) for x, y in corners]
    if not document.level.has_contacts:
        document = set_level_field(document, "contacts", ContactsDef())
    return add_terrain(document, with_corners(TerrainDef(id="ground"), rounded, "solid"))


GROUND = Remedy("Draw ground below", draw_ground, ("Draw ground below", lambda _: draw_ground))


def _use_direct(document: Document) -> Document:
    return set_setting(document, "solver", "direct")


DIRECT = Remedy("Use the direct solver", _use_direct, ("Use the direct solver", lambda _: _use_direct))
