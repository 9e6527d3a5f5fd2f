"""Property: a field that a panel shows and changes, of the selected items, of the level or of its checks."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import partial
from typing import Any, Final

from sandbox.editor.document import Document, EditError
from sandbox.editor.panel.field_info import DEGREES, FieldInfo, fields_of
from sandbox.editor.panel.typed import (
    DIGITS,
    line_text,
    list_text,
    number_text,
    read_integer,
    read_line,
    read_list,
    read_number,
    read_outlines,
    read_pairs,
    read_touched,
    read_words,
    stepped,
    touched_text,
)
from sandbox.level.format.quantities import Description, significant

# Makes a document in which a field is what the function makes of its value.
Change = Callable[[Document, Callable[[Any], Any]], Document]


def changing(change: Callable[..., Document], *where: Any) -> Callable[..., Document]:
    """A change of what lies at some place in a document, for the document and a value, if it takes one."""
    return lambda document, *value: change(document, *where, *value)


class Mixed(Enum):
    """Stands for the value where items differ."""

    MIXED = "mixed"


MIXED: Final = Mixed.MIXED
# Axes of a pair of numbers.
_AXES = ("x", "y")


@dataclass(frozen=True)
class Property:
    """A field with the value that all items have, or MIXED; of a `point`, of each axis; of `flags`, of each by name.

    write: makes a document with another value, or of a run the command that sets it; None where it is only shown.
    axes: names of the numbers of a point. remark: what to say of a value in a document that is taken otherwise than it
    was asked for; "" = nothing. remove: makes a document without the field, where it can be taken away.
    slides: it has a slider from 0 to 1. scrubs: its title can be dragged, where it is a number. label: what a change is
    called in the history; "" = as the field.
    """

    field: str
    about: FieldInfo
    value: Any
    write: Callable[[Any, Any], Any] | None = None
    axes: tuple[str, str] = _AXES
    remark: Callable[[Any, Any], str] | None = None
    remove: Callable[[Document], Document] | None = None
    slides: bool = False
    scrubs: bool = True
    label: str = ""

    @property
    def editable(self) -> bool:
        """Whether the property can be changed here."""
        return self.write is not None

    @property
    def texts(self) -> tuple[str, ...]:
        """The value as text to change: of a point two, else one; "" for null."""
        if self.about.kind == "point":
            return tuple(MIXED.value if part is MIXED else number_text(part) for part in self.value)
        return (MIXED.value if self.value is MIXED else _text(self.about, self.value),)

    @property
    def step(self) -> str:
        """Name of the property's change in the history."""
        return self.label or self.about.title

    def set(self, document: Any, value: Any) -> Any:
        """The document with another value; an axis that is None and a flag that is not given stay. Raises EditError.

        What is chosen from a menu a second time changes nothing.
        """
        if self.write is None:
            raise EditError(f"{self.about.title} cannot be changed here")
        if self.about.kind == "choice" and value == self.value and isinstance(document, Document):
            return document
        return self.write(document, value)

    def typed(self, text: str, axis: int = 0) -> Any:
        """The value that a typed text stands for. Raises EditError with one line."""
        about = self.about
        text = text.strip().removesuffix(about.unit) if about.kind in ("number", "integer", "point") else text
        if about.kind == "point":
            number = read_number(f"{about.title} {self.axes[axis]}", text)
            return (number, None) if axis == 0 else (None, number)
        if about.optional and not text.strip():
            return None
        read: dict[str, Callable[[str, str], Any]] = {
            "number": read_number, "integer": read_integer, "list": read_list, "pairs": read_pairs,
            "outlines": read_outlines, "words": read_words, "touches": read_touched,
        }  # fmt: skip
        if about.kind in read:
            value = read[about.kind](about.title, text)
            return math.radians(value) if about.unit == DEGREES else value
        return read_line(text)

    def stepped(self, steps: int) -> float | None:
        """The value some steps up or down, within its limits; None where it is no number, or not the same of all."""
        about = self.about
        if about.kind not in ("number", "integer") or self.value is None or self.value is MIXED:
            return None
        if not math.isfinite(self.value):
            return None
        if about.unit == DEGREES:
            return math.radians(stepped(_degrees(self.value), steps, None, None))
        value = stepped(self.value, steps, about.low, about.high, whole=about.kind == "integer")
        return self.value if about.above and value == about.low else value


@dataclass(frozen=True)
class Section:
    """Properties that belong together; is_rare: they are folded away until somebody wants them."""

    title: str
    properties: tuple[Property, ...]
    is_rare: bool = False


def named(properties: Iterable[Property], owner: str) -> tuple[Property, ...]:
    """Properties whose changes the history calls by what they are of."""
    return tuple(replace(each, label=f"{owner}: {each.step.lower()}") for each in properties)


def toggled(names: Sequence[str], value: Any) -> tuple[str, ...]:
    """A list of names with a picked one that joins it, or leaves it; another list takes its place."""
    if not isinstance(value, str):
        return tuple(value)
    rest = tuple(name for name in names if name != value)
    return rest if len(rest) < len(names) else (*names, value)


def found_sections(sections: Iterable[Section], query: str) -> tuple[Section, ...]:
    """The sections with those properties alone that have some words, in any case, in their title or their tooltip.

    A word of a section's title finds all of it.
    """
    words = query.casefold().split()
    found = []
    for section in sections:
        chosen = [
            each for each in section.properties
            if all(word in f"{section.title} {each.about.title} {each.about.tooltip}".casefold() for word in words)
        ]  # fmt: skip
        if chosen:
            found.append(Section(section.title, tuple(chosen)))
    return tuple(found)


def _text(about: FieldInfo, value: Any) -> str:
    if value is None:
        return ""
    if about.unit == DEGREES:
        return number_text(_degrees(value))
    if about.kind in ("number", "integer"):
        return number_text(value)
    if about.kind in ("list", "pairs", "outlines", "words"):
        return list_text(value)
    if about.kind == "touches":
        return touched_text(value)
    return line_text(str(value))


def _degrees(angle: float) -> float:
    """An angle [rad] in degrees, without the dust of having been one in radians."""
    return significant(math.degrees(angle), DIGITS)


def same(values: Iterable[Any]) -> Any:
    """The value that all items share, else MIXED."""
    found = list(values)
    return found[0] if found.count(found[0]) == len(found) else MIXED


def in_range(about: FieldInfo, value: float) -> float:
    """A number that is within the limits of a field, for what has no others. Raises EditError."""
    low, high = about.limits
    if not low <= value <= high:
        limits = f"outside {low:g} to {high:g}" if high < math.inf else f"below {low:g}"
        raise EditError(f"{about.title}: {value:g} is {limits}; the old value stays")
    return value


def with_axes(value: Sequence[float | None], old: Sequence[float]) -> tuple[float, ...]:
    """A pair of numbers in which those that are None stay as they were."""
    return tuple(before if new is None else new for new, before in zip(value, old, strict=True))


def part_properties(
    name: str,
    about: FieldInfo,
    values: Sequence[Description | None],
    change: Change,
    add: Callable[[Document], Document],
) -> list[Property]:
    """Whether there is an object that a field may hold, and where all have one the fields of that.

    add: makes a document in which those have one that had none.
    """

    def write(document: Document, is_there: bool) -> Document:
        return add(document) if is_there else change(document, lambda _: None)

    is_there = same(value is not None for value in values)
    found = [Property(name, about, is_there, write)]
    objects = [value.__dict__ for value in values if value is not None]
    if is_there is True and about.model is not None:
        found += [
            Property(f"{name}.{field}", each, same(o[field] for o in objects), partial(_set_inside, change, field))
            for field, each in fields_of(about.model).items()
            # What is by name in a file is written there.
            if not isinstance(objects[0][field], dict)
        ]
    return found


def _set_inside(change: Change, field: str, document: Document, value: Any) -> Document:
    return change(document, lambda old: {**old.__dict__, field: value})
