"""Properties: what can be changed of the selected items, of the level and of its checks, field by field."""

import json
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import partial
from typing import Any, Final

from sandbox.editor.abouts import About, abouts
from sandbox.editor.document import Document, EditError
from sandbox.editor.fields import change_field, set_field, set_level_field, set_setting
from sandbox.editor.items import Definition, Item, Selection, chosen_bodies, chosen_particles, chosen_springs
from sandbox.editor.materials import set_checks
from sandbox.editor.names import owner_of
from sandbox.editor.typed import (
    line_text,
    list_text,
    number_text,
    read_integer,
    read_line,
    read_list,
    read_number,
    read_pairs,
    read_words,
)
from sandbox.level.bodies import SHAPES, AnyBody, BoxShape, CircleShape, JellyDef, PolygonShape, Shape, file_order
from sandbox.level.checks import PARTICLE_METRICS, CheckDef
from sandbox.level.model import Level, ParticleDef, Settings, SpringDef
from sandbox.level.quantities import replaced
from sandbox.level.schema import TITLES
from sandbox.level.shapes import count


class Mixed(Enum):
    """What stands for a value where the items differ."""

    MIXED = "mixed"


MIXED: Final = Mixed.MIXED
# Axes of a pair of numbers.
_AXES = ("x", "y")
# Sections of the fields that are not of a body's form, in their order.
_SECTIONS = {
    "Mass": ("mass", "particle_mass", "end_mass", "hub_mass", "masses"),
    "Springs": ("material", "rest_length", "cut"),
    "Start": ("pin", "pinned", "velocity", "velocities", "pose"),
    "Other": ("group", "extras"),
}
_LEVEL_FIELDS = ("name", "description", "author", "licence", "tags", "view")


@dataclass(frozen=True)
class Property:
    """A field with the value that all items have, or MIXED; of a `point`, of each axis; of `flags`, of each by name.

    write: makes a document with another value; None where it is only shown. axes: names of the numbers of a point.
    """

    field: str
    about: About
    value: Any
    write: Callable[[Document, Any], Document] | None = None
    axes: tuple[str, str] = _AXES

    @property
    def editable(self) -> bool:
        """Whether it can be changed here."""
        return self.write is not None

    @property
    def texts(self) -> tuple[str, ...]:
        """The value as text to change: of a point two, else one; "" for null."""
        if self.about.kind == "point":
            return tuple(MIXED.value if part is MIXED else number_text(part) for part in self.value)
        return (MIXED.value if self.value is MIXED else _text(self.about, self.value),)

    def set(self, document: Document, value: Any) -> Document:
        """The document with another value; an axis that is None and a flag that is not given stay. Raises EditError."""
        if self.write is None:
            raise EditError(f"{self.about.title} cannot be changed here")
        return self.write(document, value)

    def typed(self, text: str, axis: int = 0) -> Any:
        """The value that a typed text stands for. Raises EditError with one line."""
        about = self.about
        if about.kind == "point":
            number = read_number(f"{about.title} {self.axes[axis]}", text)
            return (number, None) if axis == 0 else (None, number)
        if about.optional and not text.strip():
            return None
        read: dict[str, Callable[[str, str], Any]] = {
            "number": read_number, "integer": read_integer, "list": read_list, "pairs": read_pairs,
            "words": read_words,
        }  # fmt: skip
        if about.kind in read:
            return read[about.kind](about.title, text)
        return read_line(text)


@dataclass(frozen=True)
class Section:
    """Properties that belong together."""

    title: str
    properties: tuple[Property, ...]


def _text(about: About, value: Any) -> str:
    if value is None:
        return ""
    if about.kind in ("number", "integer"):
        return number_text(value)
    if about.kind in ("list", "pairs", "words"):
        return list_text(value)
    if about.kind == "extras":
        return json.dumps(value, ensure_ascii=False)
    return line_text(str(value))


# What is selected.


def properties(document: Document) -> tuple[Section, ...]:
    """What can be changed of the selected items: the fields that all of them have; () where nothing is selected."""
    level, selection = document.level, document.selection
    parts: list[Definition] = [
        *chosen_bodies(level, selection), *chosen_particles(level, selection), *chosen_springs(level, selection),
    ]  # fmt: skip
    if not parts:
        return ()
    kinds = dict.fromkeys(map(type, parts))
    made = [made for name, about in _common(kinds, len(parts)).items() for made in _made(selection, parts, name, about)]
    if len(parts) == 1:
        facts = _facts(level, next(iter(selection)), parts[0])
        made = [*facts, *made] if isinstance(parts[0], SpringDef) else [*made, *facts]
    by_section: dict[str, list[Property]] = {"": [], **{title: [] for title in _SECTIONS}}
    for each in made:
        by_section[_section_of(each.field)].append(each)
    by_section[_summary(kinds, parts)] = by_section.pop("")
    titles = [_summary(kinds, parts), *_SECTIONS]
    return tuple(Section(title, tuple(by_section[title])) for title in titles if by_section[title])


def _section_of(field: str) -> str:
    return next((title for title, fields in _SECTIONS.items() if field in fields), "")


def _summary(kinds: Iterable[type], parts: Sequence[Definition]) -> str:
    """What is selected, in words."""
    counts = Counter(map(type, parts))
    words = []
    for kind, number in counts.items():
        noun = TITLES[kind.__name__]
        plural = f"{noun[:-1]}ies" if noun.endswith("y") else f"{noun}es" if noun.endswith("sh") else f"{noun}s"
        words.append(noun if len(parts) == 1 else f"{number:,} {(noun if number == 1 else plural).lower()}")
    return ", ".join(words)


def _common(kinds: Iterable[Any], number: int) -> dict[str, About]:
    """The fields that all kinds have alike, with the limits that hold for all."""
    first, *others = (abouts(kind) for kind in kinds)
    found = {}
    for name in file_order(first):
        if name == "type" or (name == "id" and number > 1):
            continue
        same = [other[name] for other in others if name in other and _alike(other[name], first[name])]
        if len(same) == len(others):
            found[name] = first[name]
    return found


def _alike(one: About, other: About) -> bool:
    return (one.kind, one.unit, one.choices, one.optional) == (other.kind, other.unit, other.choices, other.optional)


def _made(selection: Selection, parts: Sequence[Definition], name: str, about: About) -> list[Property]:
    """The properties of a field: more than one of a shape."""
    if about.kind == "form":
        return _shape_properties(selection, [part.shape for part in parts if isinstance(part, JellyDef)])
    if about.kind == "point":
        value: Any = tuple(map(_same, zip(*[part.__dict__[name] for part in parts], strict=True)))
        return [Property(name, about, value, partial(_set_axes, selection, name))]
    if about.kind == "flags":
        lists = [part.__dict__[name] for part in parts]
        states = {choice: _same(choice in chosen for chosen in lists) for choice in about.choices}
        return [Property(name, about, states, partial(_set_flags, selection, name, about.choices))]
    value = _same([part.__dict__[name] for part in parts])
    if about.kind == "extras":
        return [Property(name, about, value)] if value else []

    def write(document: Document, value: Any) -> Document:
        return set_field(document, selection, name, value)

    return [Property(name, about, value, write)]


def _same(values: Iterable[Any]) -> Any:
    """The value that all of them are, else MIXED."""
    found = list(values)
    return found[0] if found.count(found[0]) == len(found) else MIXED


def _set_axes(selection: Selection, field: str, document: Document, value: Any) -> Document:
    return change_field(document, selection, field, partial(_with_axes, value))


def _set_flags(
    selection: Selection, field: str, choices: Sequence[str], document: Document, value: dict[str, bool]
) -> Document:
    def change(old: Sequence[str]) -> list[str]:
        return [choice for choice in choices if value.get(choice, choice in old)]

    return change_field(document, selection, field, change)


def _with_axes(value: Sequence[float | None], old: Sequence[float]) -> tuple[float, ...]:
    """A pair of numbers with those of a value that are given."""
    return tuple(before if new is None else new for new, before in zip(value, old, strict=True))


def _facts(level: Level, item: Item, part: Definition) -> list[Property]:
    """What a single item is that its fields do not say."""
    facts = []
    if isinstance(part, SpringDef):
        facts.append(("name", "Name", f":{item.key}", "Name of the spring."))
    elif not isinstance(part, ParticleDef):
        particles, springs = count(part)
        facts.append(
            (
                "size",
                "Made of",
                f"{_counted(particles, 'particle')}, {_counted(springs, 'spring')}",
                "What it expands to.",
            )
        )
    joints = [f"{a} = {b}" for a, b in level.welds if item.key in (owner_of(a), owner_of(b))]
    if joints and item.kind != "spring":
        facts.append(("welds", "Joined", ", ".join(joints), "Particles that are one with another's."))
    return [Property(name, About("text", title, tooltip=tip), text) for name, title, text, tip in facts]


def _counted(number: int, noun: str) -> str:
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"


# The shape of a jelly.


def _shape_properties(selection: Selection, shapes: Sequence[Shape]) -> list[Property]:
    kind = _same(_shape_kind(shape) for shape in shapes)
    about = About("choice", "Shape", tooltip="The outline that is filled.", choices=SHAPES)

    def choose(document: Document, wanted: str) -> Document:
        return change_field(document, selection, "shape", partial(_as_shape, wanted))

    found = [Property("shape", about, kind, choose)]
    if kind is MIXED:
        return found
    about = abouts(type(shapes[0]))[kind]
    if kind == "box":
        pairs = [shape.box for shape in shapes if isinstance(shape, BoxShape)]

        def write_box(document: Document, value: Any) -> Document:
            return change_field(
                document, selection, "shape", lambda old: {"box": _with_axes(value, old.__dict__["box"])}
            )

        value: Any = tuple(_same(pair[axis] for pair in pairs) for axis in (0, 1))
        about = replace(about, title="Size")
        return [*found, Property("shape.box", about, value, write_box, ("width", "height"))]

    def write(document: Document, value: Any) -> Document:
        return set_field(document, selection, "shape", {kind: value})

    about = replace(about, title="Radius" if kind == "circle" else "Corners")
    return [*found, Property(f"shape.{kind}", about, _same(shape.__dict__[kind] for shape in shapes), write)]


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
    return {"polygon": tuple((a * x / 2.0, b * y / 2.0) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)))}


# The level.


def level_properties(document: Document) -> tuple[Section, ...]:
    """What can be changed of the level itself and of how its time passes."""
    level = document.level
    about = abouts(Level)
    of_level = [Property(name, about[name], getattr(level, name), partial(_set_level, name)) for name in _LEVEL_FIELDS]
    if level.extras:
        of_level.append(Property("extras", about["extras"], level.extras))
    settings = []
    for name, each in abouts(Settings).items():
        value = getattr(level.settings, name)
        settings.append(Property(name, each, str(value) if each.kind == "choice" else value, partial(_set_time, name)))
    return Section("Level", tuple(of_level)), Section("Time and solver", tuple(settings))


def _set_level(field: str, document: Document, value: Any) -> Document:
    return set_level_field(document, field, value)


def _set_time(field: str, document: Document, value: Any) -> Document:
    old = getattr(document.level.settings, field)
    if field in ("gravity", "wind"):
        value = _with_axes(value, old)
    elif field == "substeps" and str(value).isdecimal():
        value = int(value)
    return set_setting(document, field, value)


# Checks.


def check_properties(document: Document, index: int) -> tuple[Section, ...]:
    """What can be changed of a check of the level, by its index; () where there is none."""
    if not 0 <= index < len(document.level.checks):
        return ()
    check = document.level.checks[index]
    made = [
        Property(name, about, getattr(check, name), partial(_set_check, index, name))
        for name, about in abouts(CheckDef).items()
        if name != "particle" or check.metric in PARTICLE_METRICS
    ]
    return (Section("Check", tuple(made)),)


def _set_check(index: int, field: str, document: Document, value: Any) -> Document:
    checks = list(document.level.checks)
    check = replaced(checks[index], **{field: value})
    if field == "metric" and value in PARTICLE_METRICS and check.particle is None:
        check = replaced(check, particle=_some_particle(document))
    elif field == "metric" and value not in PARTICLE_METRICS:
        check = replaced(check, particle=None)
    checks[index] = check
    return set_checks(document, checks)


def _some_particle(document: Document) -> str | None:
    """A particle to measure: of what is selected, else of the level."""
    level, selection = document.level, document.selection
    loose = [*chosen_particles(level, selection), *(() if selection else level.particles)]
    bodies: Sequence[AnyBody] = [*chosen_bodies(level, selection), *(() if selection else level.bodies)]
    if loose:
        return loose[0].id
    return f"{bodies[0].id}.{count(bodies[0])[0] - 1}" if bodies else None


def add_check(document: Document) -> Document:
    """Add a check that holds of every sound level. Raises EditError where it has too many."""
    taken = {check.name for check in document.level.checks}
    number = next(k for k in range(1, len(taken) + 2) if f"check {k}" not in taken)
    check = CheckDef(name=f"check {number}", metric="non_finite", at_most=0.0)
    return set_checks(document, [*document.level.checks, check])


def delete_check(document: Document, index: int) -> Document:
    """Delete a check by its index."""
    return set_checks(document, [check for k, check in enumerate(document.level.checks) if k != index])
