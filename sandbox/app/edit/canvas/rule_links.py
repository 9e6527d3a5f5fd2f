"""Dotted lines from the zone of a rule to the things that it asks for and acts on."""

import math

import numpy as np
import pygame

from sandbox.app.draw.camera import Camera, Point
from sandbox.app.draw.colours import ZONE
from sandbox.editor.items import PARTS, Item
from sandbox.editor.rule_text import acted_on, named_things, named_zones
from sandbox.editor.scene import Scene
from sandbox.level.rules.rule import RuleDef

# Distance and radius of the dots [layout units].
STEP, DOT = 8.0, 2.0


def rules_of(scene: Scene, rule: int | None, zones: frozenset[str]) -> list[RuleDef]:
    """The rule that a panel shows, or else those of the zones that are selected."""
    rules = scene.level.rules
    if rule is not None:
        return list(rules[rule : rule + 1])
    return [each for each in rules if zones.intersection(named_zones(each.when))]


def draw_links(surface: pygame.Surface, camera: Camera, scene: Scene, rules: list[RuleDef], scale: float) -> None:
    """Draw dots from the zones of rules to what they are about; without zones from what is asked to what is done."""
    for rule in rules:
        zones, things, targets = named_zones(rule.when), named_things(rule.when), acted_on(rule)
        starts = zones or things[:1]
        ends = [*things, *targets] if zones else [*things[1:], *targets]
        for start in _places(scene, starts):
            for end in _places(scene, ends):
                _draw_dots(surface, camera.to_pixels(start), camera.to_pixels(end), scale)


def _places(scene: Scene, names: list[str]) -> list[Point]:
    places = [_place(scene, name) for name in dict.fromkeys(names)]
    return [place for place in places if place is not None]


def _place(scene: Scene, name: str) -> Point | None:
    """The middle of a thing [m], or the place of a particle; None = it has none, as walls."""
    known = frozenset(scene.items)
    item = next((Item(kind, name) for kind in PARTS if Item(kind, name) in known), None)
    box = None if item is None else scene.bounds(frozenset([item]))
    if box is not None:
        return (box[0] + box[2]) / 2.0, (box[1] + box[3]) / 2.0
    try:
        x, y = scene.position[scene.slot(name)].tolist()
    except LookupError:
        return None
    return x, y


def _draw_dots(surface: pygame.Surface, start: Point, end: Point, scale: float) -> None:
    steps = int(min(math.dist(start, end) / (STEP * scale), 2_000))
    for share in np.linspace(0.0, 1.0, steps + 1).tolist():
        at = (start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1]))
        pygame.draw.aacircle(surface, ZONE, at, DOT * scale)
    pygame.draw.aacircle(surface, ZONE, end, 3.0 * DOT * scale, max(1, round(1.6 * scale)))
