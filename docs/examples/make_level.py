"""A level made in Python: a rope bridge over a gap, a jelly on it, a balloon tied to it; written, read back, played.

```sh
python docs/examples/make_level.py mind_the_gap.json
sandbox play mind_the_gap.json
```
"""

import sys

from sandbox import Level, Session, load_level
from sandbox.bodies import (
    FORMAT,
    VERSION,
    BoxShape,
    ContactsDef,
    JellyDef,
    NissenMaterial,
    RingDef,
    RopeDef,
    SpringDef,
    TerrainDef,
    write_level,
)


def cliff(name: str, edge: float, far: float) -> TerrainDef:
    """Solid ground from x = far [m] to the edge of the gap."""
    left, right = sorted((edge, far))
    return TerrainDef(id=name, polygon=((left, -6.0), (right, -6.0), (right, 0.0), (left, 0.0)))


def gap() -> Level:
    """Two cliffs, and what hangs and wobbles between them."""
    return Level(
        format=FORMAT,
        version=VERSION,
        name="Mind the gap",
        materials={
            "rope": NissenMaterial(stiffness=1.0, damping=1.0),
            "pudding": NissenMaterial(stiffness=0.3, damping=0.8),
        },
        contacts=ContactsDef(friction=0.8, restitution=0.2),
        terrain=(cliff("west", -4.0, -9.0), cliff("east", 4.0, 9.0)),
        bodies=(
            RopeDef(
                type="rope", id="bridge", start=(-4.2, 0.1), end=(4.2, 0.1), segments=28, pin=("start", "end"),
                rest_length=0.32, particle_mass=3.0, particle_radius=0.12, material="rope",
            ),
            JellyDef(
                type="jelly", id="pudding", shape=BoxShape(box=(1.2, 0.9)), position=(0.3, 2.0), angle=0.3, spacing=0.3,
                material="pudding",
            ),
            RingDef(
                type="ring", id="balloon", position=(-1.8, 1.6), radius=0.5, segments=16, particle_mass=0.05,
                inflation=1.2, gravity_scale=-4.0,
            ),
        ),
        springs=(SpringDef(a="bridge.8", b="balloon.12", material="rope"),),
    )  # fmt: skip


def main() -> None:
    """Write the level, read it back, and say where the pudding ends up."""
    path = sys.argv[1] if len(sys.argv) > 1 else "mind_the_gap.json"
    write_level(gap(), path)
    level = load_level(path)
    assert level == gap()
    session = Session(level)
    world = session.world
    pudding = [slot for slot, name in enumerate(world.particle_names) if name.startswith("pudding.")]
    for _ in range(3 * level.settings.tick_rate):
        session.advance()
    x, y = world.position[pudding].mean(axis=0)
    fate = "rests on the bridge" if y > -3.0 else "has fallen through the gap"
    print(f"{path}: {len(world.particle_names)} particles; after 3 s the pudding {fate}, at ({x:.2f}, {y:.2f}) m.")


if __name__ == "__main__":
    main()
