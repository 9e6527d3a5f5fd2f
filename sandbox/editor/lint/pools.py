"""Water that lies in other water, where both lift."""

import itertools

from sandbox.editor.lint.finding import Finding, Rule
from sandbox.level.document.model import Level


def water_in_water(level: Level) -> Rule:
    """Pairs of zones with water whose boxes overlap."""
    pools = [(zone.id, zone.box) for zone in level.zones if zone.water is not None and zone.box is not None]
    for (one, a), (other, b) in itertools.combinations(pools, 2):
        left, bottom, right, top = max(a[0], b[0]), max(a[1], b[1]), min(a[2], b[2]), min(a[3], b[3])
        if left < right and bottom < top:
            text = f'the water of "{one}" and "{other}" overlaps, and lifts twice there; part them'
            middle = 0.5 * (left + right), 0.5 * (bottom + top)
            many = "{count} pairs of zones with water overlap, and lift twice there; part them"
            yield Finding("warning", text, frozenset(), middle, many=many)
    yield None
