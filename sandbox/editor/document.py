"""Document: a level in work, and what of it is selected."""

from dataclasses import dataclass, replace
from typing import Any, TypeVar

from sandbox.editor.items import Item, Selection, items_of
from sandbox.level.canonical import level_text
from sandbox.level.faults import LevelError
from sandbox.level.limits import FILE_LIMIT, FORMAT, VERSION
from sandbox.level.model import Level, NissenMaterial
from sandbox.level.quantities import Description
from sandbox.level.validate import check_level

# Below this many definitions and listed points a level cannot outgrow its file, whose text is then not measured.
MEASURED_SIZE = 20_000

Model = TypeVar("Model", bound=Description)


class EditError(ValueError):
    """An edit that cannot be made; its text is one line for the person, and nothing has changed."""


@dataclass(frozen=True)
class Document:
    """A level and the selected items, all of which it has."""

    level: Level
    selection: Selection = frozenset()


def empty_level() -> Level:
    """A level to begin with: nothing in it but materials ready to use."""
    return Level(
        format=FORMAT,
        version=VERSION,
        name="Untitled",
        materials={
            "steel": NissenMaterial(stiffness=1.0, damping=1.0),
            "rubber": NissenMaterial(stiffness=0.2, damping=0.3),
            "jelly": NissenMaterial(stiffness=0.02, damping=0.1),
        },
    )


def select(document: Document, selection: Selection) -> Document:
    """Select those of the items that the level has."""
    return replace(document, selection=present(document.level, selection))


def present(level: Level, selection: Selection) -> Selection:
    """Those of the items that a level has."""
    if len(selection) > 100:
        return selection.intersection(items_of(level))
    wanted = {item for item in selection if item.kind == "spring" and 0 <= int(item.key) < len(level.springs)}
    bodies = {item.key for item in selection if item.kind == "body"}
    particles = {item.key for item in selection if item.kind == "particle"}
    wanted |= {Item("body", body.id) for body in level.bodies if bodies and body.id in bodies}
    if particles:
        wanted |= {Item("particle", particle.id) for particle in level.particles if particle.id in particles}
    return frozenset(wanted)


def replaced(model: Model, **changes: Any) -> Model:
    """A copy of a definition with other values, which the caller has checked: they are taken as they are."""
    # The pickle protocol makes a copy in a third of the time of model_copy, which counts with 20,000 particles.
    copy = object.__new__(type(model))
    state = model.__getstate__()
    copy.__setstate__({**state, "__dict__": {**model.__dict__, **changes}})
    return copy


def checked(level: Level) -> Level:
    """A level that can be saved and read again. Raises EditError with its first fault."""
    try:
        check_level(level, "")
    except LevelError as error:
        raise EditError(error.faults[0]) from None
    if _size(level) > MEASURED_SIZE and len(level_text(level).encode()) > FILE_LIMIT:
        raise EditError(f"the level would be larger than {FILE_LIMIT // 1024 // 1024} MiB; make it smaller")
    return level


def _size(level: Level) -> int:
    listed = sum(len(getattr(body, "particles", ())) + len(body.pose or ()) + len(body.cut) for body in level.bodies)
    return listed + len(level.bodies) + len(level.particles) + len(level.springs) + len(level.welds)
