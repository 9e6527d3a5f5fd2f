"""How long the editor takes on 20,000 particles: `python -m tests.bench.editor`, a table in milliseconds and frames.

One frame at 60 Hz is 16.7 ms. Selecting, moving and undoing should take two of them at most, the scene included.
"""

import time
from collections.abc import Callable

from sandbox.editor.document import Document, empty_level
from sandbox.editor.history import History
from sandbox.editor.items import items_of
from sandbox.editor.moving import move
from sandbox.editor.scene import make_scene
from sandbox.level.bodies import BoxShape, JellyDef
from sandbox.level.model import Level, ParticleDef

FRAME = 1000.0 / 60.0  # [ms]
REPEATS = 7


def jelly(name: str, columns: int, rows: int, x: float, y: float) -> JellyDef:
    shape = BoxShape(box=(0.25 * (columns - 1), 0.25 * (rows - 1)))
    return JellyDef(type="jelly", id=name, shape=shape, spacing=0.25, position=(x, y))


def levels() -> dict[str, Level]:
    """Levels of 20,000 particles, by what they are made of."""
    cubes = tuple(jelly(f"cube {k}", 4, 4, 2.0 * (k % 50), 2.0 * (k // 50)) for k in range(1250))
    loose = tuple(ParticleDef(id=f"p {k}", position=(0.5 * (k % 200), 0.5 * (k // 200))) for k in range(20_000))
    return {
        "one jelly": empty_level().model_copy(update={"bodies": (jelly("jelly", 200, 100, 0.0, 0.0),)}),
        "1,250 cubes": empty_level().model_copy(update={"bodies": cubes}),
        "20,000 loose": empty_level().model_copy(update={"particles": loose}),
    }


def timed(action: Callable[[], object]) -> float:
    """Median processor time of an action [ms], which other programs disturb less."""
    times = []
    for _ in range(REPEATS):
        start = time.process_time()
        action()
        times.append(1000.0 * (time.process_time() - start))
    return sorted(times)[REPEATS // 2]


def measure(level: Level) -> dict[str, float]:
    """Times [ms] of what a maker does to a whole level."""
    history = History(Document(level))
    scene = make_scene(level)

    def select_all() -> None:
        history.select(frozenset(items_of(history.document.level)))
        make_scene(history.document.level, scene).particles_of(history.document.selection)

    def moved() -> None:
        history.apply("Move", move(history.document, 0.5, 0.25))
        make_scene(history.document.level, scene)

    def undone() -> None:
        history.undo()
        make_scene(history.document.level, scene)

    figures = {"first scene": timed(lambda: make_scene(level)), "select all": timed(select_all), "move": timed(moved)}
    scene = make_scene(history.document.level, scene)
    figures["undo"] = timed(undone)
    figures["nothing changed"] = timed(lambda: make_scene(history.document.level, make_scene(level, scene)))
    return figures


def main() -> None:
    for name, level in levels().items():
        row = "  ".join(f"{what} {ms:6.1f} ms {ms / FRAME:4.1f} frames" for what, ms in measure(level).items())
        print(f"{name:14} {row}")


if __name__ == "__main__":
    main()
