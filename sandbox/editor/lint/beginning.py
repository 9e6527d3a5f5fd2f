"""What the beginning of a run shows: what overlaps, and what sinks in water. A world of the level says so."""

from sandbox.editor.items import Selection
from sandbox.editor.lint.finding import Finding, Rule
from sandbox.editor.scene import Scene
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level
from sandbox.level.plan.surfaces import zones_with_water
from sandbox.physics.analysis.beginning import overlap_text, overlaps, sinking, sinking_text
from sandbox.physics.step import step

# A world of more particles takes so long to make that drawing waits for it; `sandbox check` looks at any.
LARGEST = 2_000


def beginnings(level: Level, scene: Scene) -> Rule:
    """Parts that sink in the water that they lie in or above, and what overlaps so little that it comes apart."""
    if len(scene.position) > LARGEST or not (level.has_water or level.has_contacts):
        return
    world = build_world(level)
    yield None

    def items_at(slots: list[int]) -> Selection:
        return frozenset(scene.items[index] for index in world.owner[slots].tolist())

    def place_at(slot: int) -> tuple[float, float]:
        x, y = world.position[slot].tolist()
        return x, y

    pools = zones_with_water(level)
    for sinks in sinking(world):
        if sinks is None:
            yield None
            continue
        slots, found = sinks[0].tolist(), sinks[1]
        text = f"{sinking_text(world, sinks[0], found, pools[found.pool].id)}; make it lighter"
        many = "{count} things would sink in the water below them; make them lighter"
        yield Finding("hint", text, items_at(slots), place_at(slots[0]), many=many)
    # Outlines that cross are found by pair.
    step(world)
    near = [each for each in overlaps(world) if each.depth < float("inf")]
    if near:
        slots = [slot for each in near for slot in (each.one, each.other)]
        yield Finding("hint", overlap_text(world, near), items_at(slots), place_at(slots[0]))
