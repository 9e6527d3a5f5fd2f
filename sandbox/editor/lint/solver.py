"""Springs past what can be proven, or was published, of the level's solver."""

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.lint.finding import DIRECT, Finding, Rule, called, called_spring, middle_of
from sandbox.editor.scene import Scene
from sandbox.level.document.model import Level, NissenMaterial
from sandbox.level.plan.materials import add_constraints, add_forms, coefficients
from sandbox.physics.analysis.stability import BOUND, spring_loads
from sandbox.physics.marks import LAW_NISSEN
from sandbox.physics.settings import WorldSettings
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.state import BY_NAME, FAMILIES, Family
from sandbox.physics.world import World


def springs_past_limits(level: Level, scene: Scene) -> Rule:
    """Springs past the proven limit of the single pass; of the iterative solver, past the article's 1/(n+1).

    Areas and angles count where they make springs give way, and are found themselves in the single pass.
    """
    solver = SOLVERS[level.settings.solver]
    if solver.bounded or not len(scene.particle_a):
        return
    world = _network(level, scene)
    yield None
    if solver.proven_limit:
        load, count = spring_loads(world), len(scene.rest_length)
        yield from _past_proven(level, scene, load[:count])
        yield from _constraints_past_proven(level, scene, world, load[count:])
    else:
        yield from _past_published(level, scene, world)


def _network(level: Level, scene: Scene) -> World:
    """The springs and masses of a scene as a world, as far as limits depend on them."""
    # Without names: to register those of 100,000 springs takes longer than all the rest.
    world = World(WorldSettings(**dict(level.settings)), scene.materials)
    first, count = scene.first_of_weld, len(scene.mass)
    mass = np.bincount(first, scene.mass, count).astype(np.float64)
    world.mass = mass
    world.inverse_mass = np.divide(1.0, mass, out=np.zeros(count), where=~scene.pinned & (mass > 0.0))
    world.particle_a = first[scene.particle_a].astype(np.int32)
    world.particle_b = first[scene.particle_b].astype(np.int32)
    world.rest_length = scene.rest_length
    world.spring_active = np.ones(len(scene.rest_length), dtype=np.bool_)
    materials = {name: level.materials.get(name, NissenMaterial()) for name in scene.materials}
    for name, values in coefficients(scene.material, materials).items():
        setattr(world, name, values.astype(BY_NAME[name].dtype))
    for column in FAMILIES[Family.SPRING]:
        if column.sparse:
            setattr(world, column.name, np.full(len(scene.rest_length), column.usual, column.dtype))
    world.position, world.energy_bank, world.spin = scene.position, *np.zeros((2, count))
    made = scene.parts.bodies.made
    firsts = add_constraints(world, scene.parts.names.layout, level, made, first, materials)
    world.trust()
    add_forms(world, level, made, materials, firsts)
    return world


def _constraints_past_proven(level: Level, scene: Scene, world: World, load: NDArray[np.float64]) -> Rule:
    """Bodies whose areas or angles are past the proven limit, where their springs are not."""
    past = np.flatnonzero(load >= BOUND)
    owner = scene.particle_item[world.corner_particle[world.constraint_first[past]]]
    for index in np.unique(owner).tolist():
        mine = past[owner == index]
        worst = int(mine[np.argmax(load[mine])])
        item = scene.items[index]
        text = (
            f"areas or angles of {called(level, item)} are past what the {level.settings.solver} solver is proven "
            f"to hold: Cs + 2 Cd add up to {load[worst]:.3g}, stable is below {BOUND:g}; lower the coefficients or use "
            "the direct solver"
        )
        slot = int(world.corner_particle[world.constraint_first[worst]])
        many = "areas or angles of {count} bodies are past what the solver is proven to hold; use the direct solver"
        yield Finding("warning", text, frozenset([item]), scene.place(slot), DIRECT, many)
        yield None


def _past_proven(level: Level, scene: Scene, load: NDArray[np.float64]) -> Rule:
    yield None
    past = np.flatnonzero(load >= BOUND)
    # The worst of each item, items in order.
    past = past[np.lexsort((-load[past], scene.spring_item[past]))]
    yield None
    owner = scene.spring_item[past]
    counts = np.bincount(owner, minlength=len(scene.items))
    for spring in past[np.flatnonzero(np.diff(owner, prepend=-1))].tolist():
        index = int(scene.spring_item[spring])
        item = scene.items[index]
        springs = (
            f"{counts[index]} springs of {called(level, item)} are"
            if counts[index] > 1
            else f"{called(level, item)} is"
        )
        text = (
            f"{springs} past what the {level.settings.solver} solver is proven to hold: Cs + 2 Cd add up to "
            f"{load[spring]:.3g} at {called_spring(scene, spring)}, stable is below {BOUND:g}; lower the coefficients "
            f'of material "{scene.materials[int(scene.material[spring])]}", use more substeps or the direct solver'
        )
        many = "springs of {count} things are past what the solver is proven to hold; use the direct solver"
        yield Finding("warning", text, frozenset([item]), middle_of(scene, spring), DIRECT, many)
        yield None


def _past_published(level: Level, scene: Scene, world: World) -> Rule:
    degree = np.bincount(world.particle_a, minlength=len(world.mass))
    degree += np.bincount(world.particle_b, minlength=len(world.mass))
    limit = 1.0 / (1.0 + np.maximum(degree[world.particle_a], degree[world.particle_b]))
    yield None
    coefficient = np.maximum(world.stiffness, world.damping)
    excess = np.where(world.law == LAW_NISSEN, coefficient / limit, 0.0)
    past = np.flatnonzero(excess > 1.0)
    if not len(past):
        return
    worst = int(past[np.argmax(excess[past])])
    items = frozenset(scene.items[index] for index in np.unique(scene.spring_item[past]).tolist())
    text = (
        f"{len(past)} springs are above the published limit 1/(n+1), such as {called_spring(scene, worst)} with "
        f"{coefficient[worst]:g} above {limit[worst]:.2g}; the {level.settings.solver} solver often holds them and "
        "cannot promise it, the direct solver can"
    )
    yield Finding("hint", text, items, middle_of(scene, worst), DIRECT)
