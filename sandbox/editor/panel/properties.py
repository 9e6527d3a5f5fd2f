"""Properties of the selection: what can be changed of the items, field by field."""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from sandbox.editor.document import Document
from sandbox.editor.edits.additions import add_object
from sandbox.editor.edits.fields import change_field, set_field, with_tuples
from sandbox.editor.edits.names import owner_of
from sandbox.editor.edits.terrain import FORMS, Form, corners_of, form_of, outlined, with_corners
from sandbox.editor.items import Definition, Item, Selection, chosen_definitions, chosen_items
from sandbox.editor.panel.extra_values import extras_properties
from sandbox.editor.panel.field_info import FieldInfo, Pick, fields_of
from sandbox.editor.panel.firmness import firmness_properties
from sandbox.editor.panel.property import MIXED, Property, Section, changing, part_properties, same, with_axes
from sandbox.editor.panel.typed import number_text
from sandbox.editor.panel.weights import weight_properties
from sandbox.level.document.model import Level, ParticleDef, SpringDef, TerrainDef, ZoneDef
from sandbox.level.document.schema import TITLES
from sandbox.level.format.quantities import Point
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import file_order
from sandbox.level.kinds.jelly import SHAPES, BoxShape, CircleShape, JellyDef, PolygonShape, Shape

# Fields of terrain and of zones of which one has the outline.
_OUTLINES = ("polyline", "polygon", "box", "circle")
# Sections of the fields that are not of a body's form, in their order.
_SECTIONS = {
    "Mass": ("weight", "mass", "particle_mass", "end_mass", "hub_mass"),
    "Springs": ("material", "firmness", "rest_length"),
    "Drive": ("drive", "hydraulic", "motor"),
    "Water": ("water",),
    "Look": ("look",),
    "Contact": (
        "particle_radius",
        "friction",
        "restitution",
        "belt",
        "collides",
        "collision_group",
        "rolls",
        "rolling",
    ),
    "Start": ("pin", "pinned", "velocity", "spin"),
    "Shape": ("area", "inflation", "bending"),
    "More": ("masses", "gravity_scale", "cut", "velocities", "pose", "touches_mount", "group", "extras"),
}
# What few people look for.
_RARE = ("More",)


def properties(document: Document) -> tuple[Section, ...]:
    """Properties of the selected items; () where nothing is selected.

    Fields of their forms are those that all of them have. What some have, such as a mass, is there for those.
    """
    level, selection = document.level, document.selection
    parts = chosen_definitions(level, selection)
    if not parts:
        return ()
    kinds = dict.fromkeys(map(type, parts))
    common = _common(kinds, len(parts))
    made = [made for name, about in common.items() for made in _made(selection, parts, name, about)]
    if len(kinds) > 1:
        items = chosen_items(level, selection)
        for name, about in _of_some(kinds, common).items():
            some = {item: part for item, part in items.items() if name in part.__dict__}
            made += _made(frozenset(some), list(some.values()), name, about)
    objects = _objects(kinds)
    if objects:
        items = chosen_items(level, selection)
        made += [made for name, about in objects.items() for made in _object_properties(level, items, name, about)]
    if len(parts) == 1:
        facts = _facts(level, next(iter(selection)), parts[0])
        made = [*facts, *made] if isinstance(parts[0], SpringDef) else [*made, *facts]
    if all(isinstance(part, TerrainDef) for part in parts):
        made += _outline_properties(selection, [part for part in parts if isinstance(part, TerrainDef)])
    if len(parts) == 1 and isinstance(parts[0], ZoneDef):
        made += _zone_properties(selection, parts[0])
    made = [*weight_properties(level, chosen_items(level, selection)), *made]
    by_section: dict[str, list[Property]] = {"": [], **{title: [] for title in _SECTIONS}}
    for each in made:
        by_section[_section_of(each.field)].append(each)
    rest = (Section(title, tuple(by_section[title]), title in _RARE) for title in _SECTIONS if by_section[title])
    return (Section(_summary(kinds, parts), tuple(by_section[""])), *rest)


def _section_of(field: str) -> str:
    name = field.partition(".")[0]
    return next((title for title, fields in _SECTIONS.items() if name in fields), "")


def _summary(kinds: Iterable[type], parts: Sequence[Definition]) -> str:
    """The selection in words."""
    counts = Counter(map(type, parts))
    words = []
    for kind, number in counts.items():
        noun = TITLES[kind.__name__]
        plural = f"{noun[:-1]}ies" if noun.endswith("y") else f"{noun}es" if noun.endswith("sh") else f"{noun}s"
        words.append(noun if len(parts) == 1 else f"{number:,} {(noun if number == 1 else plural).lower()}")
    return ", ".join(words)


def _common(kinds: Iterable[Any], number: int) -> dict[str, FieldInfo]:
    """The fields that all kinds have alike, with the limits that hold for all."""
    first, *others = (fields_of(kind) for kind in kinds)
    found = {}
    for name in file_order(first):
        if name in ("type", *_OUTLINES) or (name in ("id", "name") and number > 1) or first[name].kind == "part":
            continue
        same = [other[name] for other in others if name in other and _alike(other[name], first[name])]
        if len(same) == len(others):
            found[name] = first[name]
    return found


def _of_some(kinds: Iterable[Any], common: dict[str, FieldInfo]) -> dict[str, FieldInfo]:
    """The fields, of how things are and not of their form, that only some of the kinds have, and those alike."""
    found: dict[str, FieldInfo] = {}
    unlike = set(common)
    for kind in kinds:
        for name, about in fields_of(kind).items():
            if not _section_of(name) or about.kind == "part" or (name in found and not _alike(found[name], about)):
                unlike.add(name)
            found.setdefault(name, about)
    return {name: about for name, about in found.items() if name not in unlike}


def _objects(kinds: Iterable[Any]) -> dict[str, FieldInfo]:
    """The fields of any of the kinds that hold an object or none, the same object in all that have it."""
    known = [about for kind in kinds for about in fields_of(kind).items() if about[1].kind == "part"]
    models = {(name, about.model) for name, about in known}
    return {name: about for name, about in known if sum(name == other for other, _ in models) == 1}


def _object_properties(level: Level, items: dict[Item, Definition], name: str, about: FieldInfo) -> list[Property]:
    """The properties of an object that some items may have."""
    holders = {item: part for item, part in items.items() if name in part.__dict__}
    if name == "firmness":
        return firmness_properties(level, holders)
    chosen = frozenset(holders)

    def change(document: Document, new: Any) -> Document:
        return change_field(document, chosen, name, new)

    def add(document: Document) -> Document:
        return add_object(document, chosen, name)

    found = part_properties(name, about, [part.__dict__[name] for part in holders.values()], change, add)
    return [each for made in found for each in (made, *_in_seconds(level, made))]


def _in_seconds(level: Level, made: Property) -> list[Property]:
    """A read-only property that says in seconds what another says in ticks."""
    if made.about.unit != "ticks" or not isinstance(made.value, int):
        return []
    text = number_text(float(f"{made.value / level.settings.tick_rate:.4g}"))
    tip = f"The same at the level's {level.settings.tick_rate:g} ticks a second."
    return [Property(f"{made.field}.seconds", FieldInfo("text", made.about.title, "s", tooltip=tip), text)]


def _alike(one: FieldInfo, other: FieldInfo) -> bool:
    return (one.kind, one.unit, one.choices, one.optional) == (other.kind, other.unit, other.choices, other.optional)


def _made(selection: Selection, parts: Sequence[Definition], name: str, about: FieldInfo) -> list[Property]:
    """The properties of a field: more than one of a shape."""
    if about.kind == "form":
        return _shape_properties(selection, [part.shape for part in parts if isinstance(part, JellyDef)])
    if about.kind == "point":
        value: Any = tuple(map(same, zip(*[part.__dict__[name] for part in parts], strict=True)))
        return [Property(name, about, value, partial(_set_axes, selection, name))]
    if about.kind == "flags":
        lists = [part.__dict__[name] for part in parts]
        states = {choice: same(choice in chosen for chosen in lists) for choice in about.choices}
        return [Property(name, about, states, partial(_set_flags, selection, name, about.choices))]
    value = same([part.__dict__[name] for part in parts])
    if name == "rest_length":
        about = _with_its_start(about, parts)
    if about.kind == "extras":
        return extras_properties(about, [part.extras for part in parts], partial(_change_extras, selection))
    return [Property(name, about, value, changing(set_field, selection, name))]


def _with_its_start(about: FieldInfo, parts: Sequence[Definition]) -> FieldInfo:
    """A rest length that says what a hydraulic begins at where it has none."""
    shortest = {part.hydraulic.shortest for part in parts if isinstance(part, SpringDef) and part.hydraulic is not None}
    if not shortest:
        return about
    each = number_text(shortest.pop()) if len(shortest) == 1 else "of each"
    return replace(about, empty=f"shortest: {each}")


def _change_extras(
    selection: Selection, document: Document, change: Callable[[dict[str, Any]], dict[str, Any]]
) -> Document:
    return change_field(document, selection, "extras", change)


def _set_axes(selection: Selection, field: str, document: Document, value: Any) -> Document:
    return change_field(document, selection, field, partial(with_axes, value))


def _set_flags(
    selection: Selection, field: str, choices: Sequence[str], document: Document, value: dict[str, bool]
) -> Document:
    def change(old: Sequence[str]) -> list[str]:
        return [choice for choice in choices if value.get(choice, choice in old)]

    return change_field(document, selection, field, change)


def _facts(level: Level, item: Item, part: Definition) -> list[Property]:
    """Facts about a single item beside its fields."""
    facts = []
    if isinstance(part, SpringDef):
        facts.append(("number", "Number", f":{item.key}", "The spring's name in commands and recordings."))
    elif not isinstance(part, ParticleDef | TerrainDef | ZoneDef):
        particles, springs = expansion(part).count
        facts.append(
            (
                "size",
                "Made of",
                f"{_counted(particles, 'particle')}, {_counted(springs, 'spring')}",
                "Particles and springs it consists of.",
            )
        )
    joints = [f"{a} = {b}" for a, b in level.welds if item.key in (owner_of(a), owner_of(b))]
    if joints and item.kind != "spring":
        facts.append(("welds", "Joined", ", ".join(joints), "Particles joined to those of others."))
    return [Property(name, FieldInfo("text", title, tooltip=tip), text) for name, title, text, tip in facts]


def _counted(number: int, noun: str) -> str:
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"


# The outline of terrain.


def _outline_properties(selection: Selection, pieces: Sequence[TerrainDef]) -> list[Property]:
    """Whether it is a line or solid, and its corners."""
    kind = FieldInfo("choice", "Kind", tooltip="An open line, or solid ground.", choices=FORMS)

    def choose(document: Document, form: Form) -> Document:
        return outlined(document, selection, lambda piece: with_corners(piece, corners_of(piece), form))

    def write(document: Document, corners: Sequence[Point]) -> Document:
        points = with_tuples(corners)
        return outlined(document, selection, lambda piece: with_corners(piece, points))

    about = replace(fields_of(TerrainDef)["polygon"], title="Corners", optional=False, tooltip="Corners in order.")
    return [
        Property("form", kind, same(form_of(piece) for piece in pieces), choose),
        Property("corners", about, same(corners_of(piece) for piece in pieces), write),
    ]


def _zone_properties(selection: Selection, zone: ZoneDef) -> list[Property]:
    """Where a zone is."""
    name = next(name for name in ("box", "circle", "polygon") if getattr(zone, name) is not None)
    titles = {"box": "Box", "circle": "Circle", "polygon": "Corners"}
    tips = {
        "box": "Left, bottom, right, top.", "circle": "x and y of its centre, and its radius.",
        "polygon": "Corners in order.",
    }  # fmt: skip
    pick: Pick = "box" if name == "box" else ""
    about = replace(fields_of(ZoneDef)[name], title=titles[name], tooltip=tips[name], optional=False, pick=pick)
    return [Property(name, about, getattr(zone, name), changing(set_field, selection, name))]


# The shape of a jelly.


def _shape_properties(selection: Selection, shapes: Sequence[Shape]) -> list[Property]:
    kind = same(_shape_kind(shape) for shape in shapes)
    about = FieldInfo("choice", "Shape", tooltip="The outline of the jelly.", choices=tuple(SHAPES))

    def choose(document: Document, shape: str) -> Document:
        return change_field(document, selection, "shape", partial(_as_shape, shape))

    found = [Property("shape", about, kind, choose)]
    if kind is MIXED:
        return found
    about = fields_of(type(shapes[0]))[kind]
    if kind == "box":
        pairs = [shape.box for shape in shapes if isinstance(shape, BoxShape)]

        def write_box(document: Document, value: Any) -> Document:
            return change_field(
                document, selection, "shape", lambda old: {"box": with_axes(value, old.__dict__["box"])}
            )

        value: Any = tuple(same(pair[axis] for pair in pairs) for axis in (0, 1))
        about = replace(about, title="Size")
        return [*found, Property("shape.box", about, value, write_box, ("width", "height"))]

    def write(document: Document, value: Any) -> Document:
        return set_field(document, selection, "shape", {kind: value})

    about = replace(about, title={"circle": "Radius", "polygon": "Corners"}[kind])
    return [*found, Property(f"shape.{kind}", about, same(shape.__dict__[kind] for shape in shapes), write)]


def _shape_kind(shape: Shape) -> str:
    return next(name for name in SHAPES if hasattr(shape, name))


def _as_shape(kind: str, shape: Shape) -> dict[str, Any]:
    """A shape of another kind, as large."""
    if kind == _shape_kind(shape):
        return dict(shape.__dict__)
    if isinstance(shape, PolygonShape):
        x, y = (2.0 * max(abs(corner[axis]) for corner in shape.polygon) for axis in (0, 1))
    else:
        x, y = shape.box if isinstance(shape, BoxShape) else (2.0 * shape.circle, 2.0 * shape.circle)
    if kind == "circle":
        return {"circle": max(x, y) / 2.0 if isinstance(shape, CircleShape) else min(x, y) / 2.0}
    if kind == "box":
        return {"box": (x, y)}
    if kind != "polygon":
        raise ValueError(f"a jelly has no shape {kind!r}")
    return {"polygon": tuple((a * x / 2.0, b * y / 2.0) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)))}
