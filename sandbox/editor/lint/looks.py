"""Looks that show nothing: names that nobody knows count as automatic, and lines wear no picture."""

from collections.abc import Iterator

from sandbox.editor.items import Item
from sandbox.editor.lint.finding import Finding, Rule, called
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import shown, suggestion
from sandbox.level.format.look import BALLS, GROUNDS, LINES, SKINS
from sandbox.level.kinds.bodies import AnyBody
from sandbox.level.kinds.jelly import JellyDef
from sandbox.level.kinds.mesh import MeshDef
from sandbox.level.kinds.ring import RingDef
from sandbox.level.kinds.wheel import WheelDef

_KNOWN = {"skin": SKINS, "line": LINES, "ball": BALLS}


def unknown_looks(level: Level) -> Rule:
    """Names of skins, lines, balls and grounds that are none."""
    subjects: list[tuple[str, Item | None, object]] = [
        (f'the material "{name}"', None, material.look) for name, material in level.materials.items()
    ]
    subjects += [(called(level, item), item, body.look) for body in level.bodies for item in [Item("body", body.id)]]
    balls = [(called(level, item), item, ball.look) for ball in level.particles for item in [Item("particle", ball.id)]]
    for subject, item, look in [*subjects, *balls]:
        for field, name in _unknown(look):
            text = f"{subject} has the {field} {shown(name)}, which is none" + suggestion(name, _KNOWN[field])
            many = f"{{count}} things have a {field} that there is none of; choose it from the menu"
            yield Finding("warning", text, frozenset() if item is None else frozenset([item]), None, many=many)
    yield None
    for body in level.bodies:
        if body.look is not None and body.look.picture is not None and not _wears(body):
            item = Item("body", body.id)
            text = (
                f"{called(level, item)} shows no picture: jellies, meshes of triangles, rings and wheels wear one; "
                "take it out of its look"
            )
            yield Finding("hint", text, frozenset([item]), None, many="{count} things have a picture and show none")
    yield None
    for piece, ground in (level.look.ground if level.look is not None else {}).items():
        if ground not in GROUNDS:
            yield Finding("warning", f'"{piece}" is of {shown(ground)}, which is no ground', frozenset(), None)
        elif piece not in {each.id for each in level.terrain}:
            yield Finding("hint", f'the look of "{piece}" is of no terrain: none has that name', frozenset(), None)
    yield None


def _wears(body: AnyBody) -> bool:
    return isinstance(body, (JellyDef, RingDef, WheelDef)) or (isinstance(body, MeshDef) and bool(body.triangles))


def _unknown(look: object) -> Iterator[tuple[str, str]]:
    for field, known in _KNOWN.items():
        name = getattr(look, field, None)
        if name is not None and name not in known:
            yield field, name
