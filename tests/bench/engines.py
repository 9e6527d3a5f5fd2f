"""The bench scenes in this project and in other engines, behind one small interface."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.physics.arrays import Floats
from sandbox.physics.step import step
from tests.bench.scenes import GRAVITY, Scene

FRAME = 1.0 / 60.0
# Moment of inertia [kg m^2] of bodies that are points here and turn about nothing.
MOMENT = 1.0


@dataclass(frozen=True)
class Running:
    """A scene in an engine: one frame of 1/60 s, and its positions [m] and velocities [m/s] (n, 2)."""

    frame: Callable[[], None]
    state: Callable[[], tuple[Floats, Floats]]


@dataclass(frozen=True)
class Setting:
    """An engine with the settings that a row of the table is about; method: what of it solves the links."""

    engine: str
    name: str
    build: Callable[[Scene], Running]
    method: str
    substeps: int
    iterations: int = 1

    def works_as_much_as(self, other: "Setting") -> bool:
        """Whether a frame does at least what one of the other setting does."""
        alike = (self.engine, self.method) == (other.engine, other.method)
        return alike and self.substeps >= other.substeps and self.iterations >= other.iterations


def sandbox_setting(
    substeps: int, solver: str = "direct", *, stiffness: float = 1.0, damping: float = 1.0
) -> Setting:  # fmt: skip
    """This project; coefficients of 1 are not changed by substeps."""

    def build(scene: Scene) -> Running:
        world = scene.world(substeps=substeps, solver=solver, stiffness=stiffness, damping=damping)
        return Running(lambda: step(world), lambda: (world.position, world.velocity))

    softer = "" if stiffness == damping == 1.0 else f", Cs {stiffness:g}, Cd {damping:g}"
    return Setting("Spring Sandbox", f"{solver}, substeps {substeps}{softer}", build, solver, substeps)


def pymunk_setting(substeps: int, iterations: int, spring: float | None = None) -> Setting:
    """pymunk with pin joints, or damped springs of `spring` times m_r / h^2 and as much damping as is critical."""
    import pymunk

    def build(scene: Scene) -> Running:
        space = pymunk.Space()
        space.gravity = (0.0, -GRAVITY)
        space.iterations = iterations
        bodies = []
        for position, mass, pinned in zip(scene.position.tolist(), scene.mass.tolist(), scene.pinned, strict=True):
            kind = pymunk.Body.STATIC if pinned else pymunk.Body.DYNAMIC
            body = pymunk.Body(mass, MOMENT, body_type=kind)
            body.position = position
            bodies.append(body)
        space.add(*bodies)
        h = FRAME / substeps
        for a, b in scene.links.tolist():
            if scene.pinned[a] and scene.pinned[b]:
                continue
            length = float(np.sqrt(np.sum((scene.position[b] - scene.position[a]) ** 2)))
            if spring is None:
                space.add(pymunk.PinJoint(bodies[a], bodies[b]))
            else:
                inverse = sum(0.0 if scene.pinned[end] else 1.0 / scene.mass[end] for end in (a, b))
                stiffness = spring / (inverse * h * h)
                damping = 2.0 * np.sqrt(stiffness / inverse)
                space.add(pymunk.DampedSpring(bodies[a], bodies[b], (0, 0), (0, 0), length, stiffness, damping))

        def frame() -> None:
            for _ in range(substeps):
                space.step(h)

        return Running(frame, lambda: _state([(tuple(b.position), tuple(b.velocity)) for b in bodies]))

    method = "PinJoint" if spring is None else "DampedSpring"
    kind = method if spring is None else f"{method} {spring:g} m/h²"
    name = f"{kind}, substeps {substeps}, iterations {iterations}"
    return Setting("pymunk", name, build, method, substeps, iterations)


def box2d_setting(substeps: int, hertz: float | None = None, threads: int = 1) -> Setting:
    """Box2D v3 with rigid distance joints, or soft ones of `hertz` times the substep rate, critically damped."""
    import pyb2d3

    def build(scene: Scene) -> Running:
        pool = pyb2d3.ThreadPool(threads) if threads > 1 else None
        world = pyb2d3.World(thread_pool=pool, gravity=(0.0, -GRAVITY))
        world.sleeping_enabled = False
        mass_data = pyb2d3.MassData()
        mass_data.rotational_inertia = MOMENT
        bodies: list[Any] = []
        for position, mass, pinned in zip(scene.position.tolist(), scene.mass.tolist(), scene.pinned, strict=True):
            make = world.create_static_body if pinned else world.create_dynamic_body
            body = make(position=tuple(position))
            if not pinned:
                mass_data.mass = mass
                body.mass_data = mass_data
            bodies.append(body)
        soft = {} if hertz is None else {"enable_spring": True, "hertz": hertz * 60 * substeps, "damping_ratio": 1.0}
        for a, b in scene.links.tolist():
            if scene.pinned[a] and scene.pinned[b]:
                continue
            length = float(np.sqrt(np.sum((scene.position[b] - scene.position[a]) ** 2)))
            joint = world.create_distance_joint(
                bodies[a], bodies[b], length=length, local_anchor_a=(0.0, 0.0), local_anchor_b=(0.0, 0.0), **soft
            )
            del joint
        return Running(
            lambda: world.step(FRAME, substeps),
            lambda: _state(
                [((b.position.x, b.position.y), (b.linear_velocity.x, b.linear_velocity.y)) for b in bodies]
            ),
        )

    method = "rigid" if hertz is None else "soft"
    kind = method if hertz is None else f"{method} {hertz:g} of the substep rate"
    return Setting("Box2D v3", f"{kind}, substeps {substeps}", build, method, substeps)


def _state(rows: list[tuple[tuple[float, float], tuple[float, float]]]) -> tuple[Floats, Floats]:
    values = np.array(rows)
    return values[:, 0], values[:, 1]
