"""Springs of a level as flat data: Cs and Cd as the level has them, k and c for engines that add forces."""

import math

import numpy as np

from sandbox.export.chosen_body import SLOW, as_in_solver
from sandbox.export.engines import MOST_STEPS
from sandbox.export.flat_model import FlatSpring
from sandbox.level.document.model import Level
from sandbox.physics.analysis.energy import reduced_masses
from sandbox.physics.analysis.stability import BOUND, effective_count
from sandbox.physics.arrays import Floats
from sandbox.physics.collision.filter import NO_EDGE
from sandbox.physics.equation import HIGHEST_COEFFICIENT
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.softness.firmness import LARGEST_READ, lowest_mode_of
from sandbox.physics.substeps import substep_time
from sandbox.physics.world import World


def flat_springs(world: World, level: Level) -> tuple[int, tuple[FlatSpring, ...]]:
    """Steps of a tick with which k and c can be added, and the springs of a level in the order of their slots."""
    count = world.grab_spring if world.grab_spring >= 0 else world.spring_count
    k, c = _constants(world, count)
    tick, reduced = 1.0 / world.settings.tick_rate, reduced_masses(world)[:count]
    share = np.divide(k * tick * tick, reduced, out=np.zeros(count), where=reduced > 0.0)
    steps = np.floor(np.sqrt(share * effective_count(world)[:count] / BOUND)).astype(np.int64) + 1
    nissen = world.law[:count] != LAW_HOOKE
    rods = nissen & ((steps > MOST_STEPS) | (world.damping[:count] > HIGHEST_COEFFICIENT))
    loose = {f":{number}": spring.extras for number, spring in enumerate(level.springs)}
    edges = world.edge[:count] != NO_EDGE if level.has_contacts else np.zeros(count, dtype=np.bool_)
    # That of a muscle is where its wave has put it already.
    lengths = world.rest_length[:count].copy()
    muscles = world.actuators.muscles.spring
    lengths[muscles] = world.natural_length[muscles]
    springs = tuple(
        FlatSpring(
            name=name,
            a=int(world.particle_a[slot]),
            b=int(world.particle_b[slot]),
            rest_length=float(lengths[slot]),
            Cs=float(world.stiffness[slot]) if nissen[slot] else None,
            Cd=float(world.damping[slot]) if nissen[slot] else None,
            k=_rounded(k[slot]),
            c=_rounded(c[slot]),
            rod=bool(rods[slot]),
            edge=bool(edges[slot]),
            belt=float(world.belt[slot]),
            material=world.material_names[world.material[slot]],
            extras=loose.get(name, {}),
        )
        for slot, name in enumerate(world.spring_names[:count])
    )
    return int(steps[~rods].max(initial=1)), springs


def _rounded(value: np.float64) -> float:
    # Logarithms differ in their last digits between machines; files do not.
    return float(f"{value:.12g}")


def _constants(world: World, count: int) -> tuple[Floats, Floats]:
    """k [N/m] and c [N s/m] of the first this many springs (count,)."""
    modes = np.zeros(world.spring_count)
    for body in world.forms:
        if len(body.shape.mass) <= LARGEST_READ:
            modes[body.springs] = lowest_mode_of(body.shape)
    alone = effective_count(world) <= 1.0
    known: dict[tuple[float, ...], tuple[float, float]] = {}
    reduced, h = reduced_masses(world), substep_time(world.settings)
    k, c = world.hooke_stiffness[:count].copy(), world.hooke_damping[:count].copy()
    for slot in np.flatnonzero(world.law[:count] != LAW_HOOKE).tolist():
        single = bool(alone[slot])
        eigenvalue = float(modes[slot]) or (1.0 if single else SLOW)
        key = (
            float(world.stiffness[slot]),
            float(world.damping[slot]),
            eigenvalue,
            float(world.lowest_mode[slot]),
            single,
        )
        if key not in known:
            known[key] = as_in_solver(world, slot, eigenvalue, single)
        restoring, decay = known[key]
        k[slot], c[slot] = restoring * reduced[slot] / (h * h), decay * reduced[slot] / h
    assert all(map(math.isfinite, (*k.tolist(), *c.tolist())))
    return k, c
