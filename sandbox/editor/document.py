"""Document: a level in work, and what of it is selected."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from pydantic import ValidationError

from sandbox.editor.items import PARTS, Item, Kind, Selection, keys
from sandbox.level.document.canonical import level_text
from sandbox.level.document.messages import worded
from sandbox.level.document.model import ContactsDef, Level, NissenMaterial, TerrainDef, WallsDef
from sandbox.level.faults.validate import check_level
from sandbox.level.format.level_error import LevelError, shown
from sandbox.level.format.limits import FILE_LIMIT, FORMAT, VERSION
from sandbox.level.format.quantities import Described, Description, replaced
from sandbox.level.kinds.bodies import AnyBody, expansion

# Below this many definitions and listed points, 209 bytes of a file's limit each, the text of a level is not measured.
MEASURED_SIZE = 40_000

_PLACE = re.compile(r"(bodies|particles|springs|terrain|zones|counters|rules|checks)\.(\d+)(?:\.|: |$)(.*)", re.DOTALL)


class EditError(ValueError):
    """An edit that cannot be made; its text is one line for the person, and nothing has changed."""


@dataclass(frozen=True)
class Document:
    """A level and the selected items, all of which it has."""

    level: Level
    selection: Selection = frozenset()


# Half of the width, and the height above its ground, of a place to play in [m].
PLACE_HALF, PLACE_HEIGHT = 8.0, 11.0
# What a level is called that nobody has named.
UNTITLED = "Untitled"


def empty_level() -> Level:
    """A level to begin with: nothing in it but materials ready to use."""
    return Level(
        format="spring-sandbox/level",
        version=VERSION,
        name=UNTITLED,
        materials={
            "steel": NissenMaterial(stiffness=1.0, damping=1.0),
            "rubber": NissenMaterial(stiffness=0.2, damping=0.3),
            "jelly": NissenMaterial(stiffness=0.02, damping=0.1),
        },
    )


def new_level() -> Level:
    """A place to play in: ground between walls, and things that touch."""
    (left, top, right), far = (-PLACE_HALF, PLACE_HEIGHT, PLACE_HALF), 3.0 * PLACE_HALF
    ground = ((-far, -far), (far, -far), (far, 0.0), (-far, 0.0))
    return replaced(
        empty_level(),
        view=(left - 0.5, -1.5, right + 0.5, top + 0.5),
        contacts=ContactsDef(),
        walls=WallsDef(box=(left, -right, right, top)),
        terrain=(TerrainDef(id="ground", polygon=ground),),
    )


def select(document: Document, selection: Selection) -> Document:
    """Select items, as far as the level has them."""
    level = document.level
    known: dict[Kind, Sequence[str | int]] = {
        kind: range(len(level.springs)) if kind == "spring" else [part.id for part in getattr(level, parts)]
        for kind, parts in PARTS.items()
    }
    if sum(sum(map(keys(selection, kind).__contains__, known[kind])) for kind in known) < len(selection):
        selection = selection.intersection(Item(kind, key) for kind in known for key in known[kind])
    return replace(document, selection=selection)


def checked(level: Level) -> Level:
    """A level that can be saved and read again. Raises EditError with its first fault."""
    try:
        check_level(level, "")
    except LevelError as error:
        raise EditError(_named(level, error.faults[0])) from None
    if _size(level) > MEASURED_SIZE and len(level_text(level).encode()) > FILE_LIMIT:
        raise EditError(f"the level would be larger than {FILE_LIMIT // 1024 // 1024} MiB; make it smaller")
    return level


def check_bodies(level: Level, bodies: Iterable[AnyBody]) -> None:
    """Raise EditError where one of the bodies, were it alone in the level, could not be saved."""
    checked(
        replaced(
            level,
            bodies=tuple(bodies),
            particles=(),
            springs=(),
            welds=(),
            counters=(),
            rules=(),
            hands=None,
            checks=(),
            terrain=(),
            zones=(),
        )
    )


def check_terrain(level: Level) -> None:
    """Raise EditError where the terrain and zones of a level, were they alone, could not be saved."""
    checked(
        replaced(level, bodies=(), particles=(), springs=(), welds=(), counters=(), rules=(), hands=None, checks=())
    )


def check_places(bodies: Iterable[AnyBody]) -> None:
    """Raise EditError where one of the bodies, sound but for where it lies, reaches beyond the world."""
    for body in bodies:
        for path, fault in expansion(body).outline_faults(""):
            raise EditError(f"{subject(body)}: {path.removeprefix('.')}: {fault}")


def validated(definition: Described) -> Described:
    """A definition whose fields have been changed unseen, read again. Raises EditError where one is out of range."""
    return all_validated([definition])[0]


def all_validated(definitions: Sequence[Described]) -> tuple[Described, ...]:
    """As `validated`, of many definitions of one kind."""
    rows = []
    for definition in definitions:
        fields = definition.__dict__.items()
        # An object inside would be taken over unseen.
        rows.append({name: dict(value.__dict__) if isinstance(value, Description) else value for name, value in fields})
    first = rows[0] if rows else {}
    marks = {"bodies": "type", "terrain": "polyline", "zones": "circle", "particles": "id", "springs": "a"}
    part = next((part for part, mark in marks.items() if mark in first), "springs")
    try:
        level = Level.model_validate({"format": FORMAT, "version": VERSION, "name": "-", part: tuple(rows)})
    except ValidationError as error:
        index = int(error.errors(include_url=False)[0]["loc"][1])
        raise EditError(first_fault(error, subject(definitions[index]))) from None
    result: tuple[Described, ...] = getattr(level, part)
    return result


def subject(definition: Description) -> str:
    """The name of a definition in messages: its id in quotes, or what a spring joins."""
    name = getattr(definition, "id", None) or getattr(definition, "name", None)
    return shown(name) if name is not None else "the spring"


def first_fault(error: ValidationError, name: str, depth: int = 2) -> str:
    """One line for the first thing that validation has found of what `name` says, `depth` parts deep in a level."""
    errors: list[Any] = error.errors(include_url=False)
    path, text = next(worded(errors))
    return ": ".join(part for part in (name, ".".join(path.split(".")[depth:]), text) if part)


def _named(level: Level, fault: str) -> str:
    """A fault with the name of what it is about in place of an index."""
    match = _PLACE.fullmatch(fault)
    if match is None:
        return fault
    about = getattr(level, match[1])[int(match[2])]
    spring = match[1] == "springs" and about.name is None
    name = f"the spring :{match[2]}" if spring else shown(getattr(about, "id", None) or about.name)
    return f"{name}: {match[3]}"


def _size(level: Level) -> int:
    listed = sum(len(getattr(body, "particles", ())) + len(body.pose or ()) + len(body.cut) for body in level.bodies)
    listed += sum(len(piece.polyline or piece.polygon or ()) for piece in level.terrain)
    listed += sum(len(zone.polygon or ()) for zone in level.zones) + len(level.zones)
    return listed + len(level.bodies) + len(level.particles) + len(level.springs) + len(level.welds)
