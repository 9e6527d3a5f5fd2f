"""What jelly comes back from: seven abuses of a box of 20 x 10 particles, or of another shape.

Run by hand: python -m tests.bench.jelly_abuse --help. Prints, per abuse, the highest energy after the release as a
multiple of that at the release, and the shape error at the end of each second: the RMS distance from the rest shape,
placed and turned to fit, as a share of the shape's RMS radius.
"""

import argparse
import math
from collections.abc import Callable

import numpy as np

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level, NissenMaterial, Settings
from sandbox.level.kinds.jelly import BoxShape, CircleShape, JellyDef, PolygonShape, Shape
from sandbox.physics.analysis.energy import total_energy
from sandbox.physics.arrays import Floats
from sandbox.physics.settings import AUTO
from sandbox.physics.step import step
from sandbox.physics.world import World
from sandbox.session.commands import Grab, MoveGrab, Release
from sandbox.session.session import Session

SPACING = 0.1
SECONDS = 5
RATE = 60


# A circle, and a polygon with a notch on each side: as many particles as the box, nearly.
SHAPES: dict[str, Shape] = {
    "circle": CircleShape(circle=0.75),
    "polygon": PolygonShape(
        polygon=((-1.0, -0.6), (0.0, -0.2), (1.0, -0.6), (0.6, 0.0), (1.0, 0.6), (0.0, 0.2), (-1.0, 0.6), (-0.6, 0.0))
    ),
}


def jelly_level(
    columns: int = 20, rows: int = 10, *, stiffness: float = 0.9, damping: float = 0.99, area: bool = True,
    shape: Shape | None = None, **settings,
) -> Level:  # fmt: skip
    """A jelly without gravity: a box of that many particles, or one of another shape."""
    shape = shape or BoxShape(box=(SPACING * (columns - 1), SPACING * (rows - 1)))
    body = JellyDef(type="jelly", id="box", shape=shape, spacing=SPACING, material="jelly", area=area)
    return Level(
        format="spring-sandbox/level", version=4, name="Jelly", bodies=(body,),
        settings=Settings(gravity=(0.0, 0.0), tick_rate=RATE, **settings),
        materials={"jelly": NissenMaterial(stiffness=stiffness, damping=damping)},
    )  # fmt: skip


def jelly(columns: int = 20, rows: int = 10, **options) -> World:
    """The world of `jelly_level`."""
    return build_world(jelly_level(columns, rows, **options))


def shape_error(world: World) -> float:
    """RMS distance from the rest shape, fitted by a move and a turn alone, as a share of its RMS radius."""
    body = world.particle_active
    form, place = world.origin[body], world.position[body]
    form, place = form - form.mean(axis=0), place - place.mean(axis=0)
    cosine = float(np.sum(form * place))
    sine = float(np.sum(form[:, 0] * place[:, 1] - form[:, 1] * place[:, 0]))
    length = math.hypot(cosine, sine) or 1.0
    turn = np.array([[cosine, sine], [-sine, cosine]]) / length
    return math.sqrt(float(np.sum((place - form @ turn) ** 2)) / float(np.sum(form**2)))


def drag(world: World, seconds: float = SECONDS) -> None:
    """Drag a corner round a circle of 20 m at 0.9 rad a frame, then let go."""
    world.pin(0)
    for tick in range(round(seconds * RATE)):
        angle = 0.9 * (tick + 1)
        target = world.origin[0] + 20.0 * np.array([math.cos(angle) - 1.0, math.sin(angle)])
        world.velocity[0] = (target - world.position[0]) * RATE
        step(world)
    world.velocity[0] = 0.0
    world.unpin(0)


def drag_by_hand(level: Level, seconds: float = SECONDS) -> World:
    """The same with a hand, by commands of a session."""
    session = Session(level)
    start = session.world.position[0].copy()
    session.submit(Grab(0, 0, tuple(start)))
    for tick in range(round(seconds * RATE)):
        angle = 0.9 * (tick + 1)
        session.submit(MoveGrab(0, tuple(start + 20.0 * np.array([math.cos(angle) - 1.0, math.sin(angle)]))))
        session.advance()
    session.submit(Release(0))
    session.apply_pending()
    return session.world


def _placed(change: Callable[[Floats], Floats]) -> Callable[[World], None]:
    def abuse(world: World) -> None:
        body = world.particle_active
        world.position[body] = change(world.position[body])

    return abuse


def tangle(seed: int) -> Callable[[World], None]:
    """Every particle anywhere in a box of the shape's size."""
    half = np.array([1.0, 0.5])
    return _placed(lambda place: np.random.default_rng(seed).uniform(-half, half, place.shape))


ABUSES: dict[str, Callable[[World], None]] = {
    "flattened": _placed(lambda place: place * [1.0, 0.01]),
    "on a line": _placed(lambda place: place * [1.0, 0.0]),
    "in one point": _placed(lambda place: place * 0.0),
    "randomised": tangle(1),
    "inverted": _placed(lambda place: place * [-1.0, 1.0]),
    "scaled x1000": _placed(lambda place: place * 1000.0),
    "dragged round": drag,
}


def recover(world: World, seconds: float = SECONDS) -> tuple[float, list[float]]:
    """Highest energy as a multiple of that at the start and the shape error after each second.

    Where there was none at the start: itself. inf where it is not finite.
    """
    start, highest, errors = total_energy(world), 0.0, []
    for tick in range(1, round(seconds * RATE) + 1):
        step(world)
        energy = total_energy(world)
        highest = max(highest, energy if math.isfinite(energy) else math.inf)
        if tick % RATE == 0:
            errors.append(shape_error(world))
    return highest / start if start > 0.0 else highest, errors


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--solver", default="direct")
    parser.add_argument("--stiffness", type=float, default=0.9)
    parser.add_argument("--damping", type=float, default=0.99)
    parser.add_argument("--substeps", default="1")
    parser.add_argument("--shape", choices=SHAPES)
    parser.add_argument("--without-area", action="store_true")
    parser.add_argument("--tangles", type=int, default=0, metavar="N", help="random tangles instead of the abuses")
    given = parser.parse_args()
    substeps = given.substeps if given.substeps == AUTO else int(given.substeps)
    abuses = {f"tangle {seed}": tangle(seed) for seed in range(given.tangles)} or ABUSES
    print(f"| abuse | energy | shape error after 1..{SECONDS} s |\n|---|---|---|")
    back = 0
    for name in (*abuses, *(["dragged by hand"] if abuses is ABUSES else [])):
        level = jelly_level(
            stiffness=given.stiffness, damping=given.damping, area=not given.without_area, solver=given.solver,
            substeps=substeps, shape=SHAPES.get(given.shape),
        )  # fmt: skip
        if name in abuses:
            world = build_world(level)
            abuses[name](world)
        else:
            world = drag_by_hand(level)
        energy, errors = recover(world)
        back += errors[-1] < 0.01
        print(f"| {name} | {energy:.3f} | {' '.join(f'{error:.2%}' for error in errors)} |", flush=True)
    print(f"\n{back} below 1 %")


if __name__ == "__main__":
    main()
