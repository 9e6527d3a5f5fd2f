"""Checks that no run of their level can pass, or none can fail."""

from sandbox.editor.items import Item, Selection
from sandbox.editor.lint.finding import Finding, Rule, Severity
from sandbox.editor.scene import Scene
from sandbox.level.checks import CheckDef, bounds_of, window_of
from sandbox.level.document.model import Level
from sandbox.level.plan.actuators import actuators, driving_keys

# Metrics that are sums of squares, sizes or counts.
NEVER_NEGATIVE = frozenset(
    [
        "max_strain",
        "rms_strain",
        "strain",
        "kinetic_energy",
        "max_speed",
        "speed",
        "non_finite",
        "broken_springs",
        "distance",
        "settled",
        "held",
    ]
)
# What is known of a pinned particle.
PINNED_METRICS = frozenset(["x", "y", "speed"])
# Metrics that are 0 where nothing can move.
STILL_WHERE_ALL_IS_PINNED = frozenset(["max_strain", "rms_strain", "strain", "kinetic_energy", "max_speed"])


def hopeless_checks(level: Level, scene: Scene) -> Rule:
    """Checks whose bounds cannot be met, contradict each other, or say nothing."""
    bounds: dict[tuple[object, ...], tuple[float, float, str]] = {}
    for index, check in enumerate(level.checks):
        yield None
        slot = None if check.particle is None else scene.slot(check.particle)
        fault = _fault(check, scene, slot)
        low, high = bounds_of(check)
        # What must hold at one of many ticks contradicts nothing.
        key = (check.metric, check.particle, check.other, check.body, check.box, window_of(check),
               index if check.eventually else -1)  # fmt: skip
        least, most, other = bounds.get(key, (low, high, ""))
        if fault is None and max(low, least) > min(high, most):
            fault = "warning", f'contradicts check "{other}", so one of them fails; change a bound'
        bounds[key] = max(low, least), min(high, most), check.name
        if fault is None and round(window_of(check)[1] * level.settings.tick_rate) == 0:
            fault = "hint", "is measured before the first tick, when nothing has happened yet; let it wait longer"
        if fault is not None:
            items: Selection = frozenset() if slot is None else frozenset([scene.items[int(scene.particle_item[slot])]])
            place = None if slot is None else scene.place(slot)
            yield Finding(fault[0], f'Check "{check.name}" {fault[1]}', items, place)


def checks_without_hands(level: Level, scene: Scene) -> Rule:
    """Checks of a level that keys drive, in which nobody presses one."""
    keys = driving_keys(level)
    waiting = [check.name for check in level.checks if not check.hold]
    if not keys or len(waiting) < len(level.checks) or not waiting:
        return
    yield None
    driven = {part for parts in keys.values() for part, _ in parts}
    name = actuators(level)[min(driven)].name
    key = next(key for key in sorted(keys) if any(part == min(driven) for part, _ in keys[key])).upper()
    checks = "The check runs" if len(waiting) == 1 else f"All {len(waiting)} checks run"
    text = f"{checks} without hands: {name} waits for {key}; hold a key in a check to drive it"
    item = Item("spring", int(name[1:])) if name.startswith(":") else Item("body", name)
    box = scene.bounds(frozenset([item]))
    place = None if box is None else ((box[0] + box[2]) / 2, (box[1] + box[3]) / 2)
    yield Finding("hint", text, frozenset([item]), place)


def _can_break(level: Level) -> bool:
    limits = ((material.tension_limit, material.compression_limit) for material in level.materials.values())
    return any(limit is not None for pair in limits for limit in pair)


def _fault(check: CheckDef, scene: Scene, slot: int | None) -> tuple[Severity, str] | None:
    """What is wrong with one check by itself."""
    low, high = bounds_of(check)
    if check.metric in NEVER_NEGATIVE and high < 0.0:
        return "warning", f"can never hold: {check.metric} is never below 0; raise at_most"
    if check.metric == "broken_springs" and low > 0.0 and not _can_break(scene.level):
        return "warning", "can never hold: no spring breaks by itself; give a material a tension limit"
    if check.metric in STILL_WHERE_ALL_IS_PINNED and low > 0.0 and scene.pinned.all():
        return "warning", "can never hold: every particle is pinned, so nothing moves; unpin some"
    if slot is None or check.metric not in PINNED_METRICS or not scene.pinned[slot]:
        return None
    x, y = scene.place(slot)
    value = {"x": x, "y": y, "speed": 0.0}[check.metric]
    so = f"{check.metric} stays {value:g}, because {check.particle} is pinned"
    if low <= value <= high:
        return "hint", f"says nothing: {so}; take a particle that moves"
    return "warning", f"can never hold: {so}; unpin it or change the bound"
