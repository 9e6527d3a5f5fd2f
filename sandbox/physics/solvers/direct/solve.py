"""Direct: the article's spring solved for a whole network at once, with a test that bounds the energy.

spring_terms.py states what is solved. What contacts touch or joints act on is solved island by island
(island_solve.py), all else body by body (step_body.py): such a body is an island without contacts.
"""

from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any

from sandbox.physics.collision.types import LentContacts
from sandbox.physics.equation import implicit_spring_constant
from sandbox.physics.integrate import advance, turn
from sandbox.physics.jit import bundle, contents, kernel
from sandbox.physics.joints.joint_set import joints_of
from sandbox.physics.settings import AUTO
from sandbox.physics.solvers.direct.families import load_rows
from sandbox.physics.solvers.direct.layout import layout_of
from sandbox.physics.solvers.direct.rigid_turn import end_turns
from sandbox.physics.solvers.direct.step_body import step_bodies
from sandbox.physics.solvers.direct.system import Inputs, State
from sandbox.physics.solvers.lent_substep import LentSubstep
from sandbox.physics.solvers.single_pass import apply_explicit
from sandbox.physics.substeps import Substep
from sandbox.physics.world import Floats, World

_STATE = attrgetter(*State._fields)


@kernel
def _solve_bodies(
    lent_system: Any, lent_state: Any, lent_inputs: Any, start_length: Floats, ease: float, auto_substeps: int, h: float
) -> None:  # fmt: skip
    # Bring all bodies to the end of a step of h [s], where nothing touches any.
    (system,) = contents(lent_system)
    (state,) = contents(lent_state)
    (given,) = contents(lent_inputs)
    inputs = Inputs(
        given.stiffness, given.damping, given.constraint_stiffness, given.constraint_damping, given.start, start_length,
        ease,
    )  # fmt: skip
    load_rows(system, state, inputs, h)
    step_bodies(system, state, inputs, False, auto_substeps, h)


@dataclass(eq=False)
class LentArrays:
    """The arrays of a world, and those of its substeps, each as one argument for kernels."""

    state: Any
    substep: LentSubstep = field(default_factory=LentSubstep)


def _lent(world: World) -> LentArrays:
    return LentArrays(bundle((State._make(_STATE(world)),)))


@kernel
def _end_turns(lent_system: Any, lent_state: Any, moves: bool, h: float) -> None:
    (system,) = contents(lent_system)
    (state,) = contents(lent_state)
    if moves:
        advance(state.position, state.velocity, state.particle_active, h)
        turn(state.angle, state.spin, h)
    end_turns(system, state, h)


def settle(world: World, moves: bool, h: float) -> None:
    """Bring velocities from the chords of a step of h [s] to its end; moves: positions first."""
    _end_turns(layout_of(world).lent, world.derived(_lent).state, moves, h)


spring_constant = implicit_spring_constant


def precompute(world: World) -> None:
    """Order and lay out the system that this solver makes of a world."""
    layout_of(world)
    world.derived(_lent)


def solve(world: World, substep: Substep, contacts: LentContacts | None) -> None:
    """Bring the velocities to the end of a substep; slow_velocity, energy_bank and tension go with them.

    contacts: the contacts of the substep, with impulses to start from, which the solver replaces; None: nothing
    touches.
    """
    layout, lent, joints = layout_of(world), world.derived(_lent), joints_of(world)
    if layout.has_hooke:
        apply_explicit(world, layout.hooke, substep)
    inputs, start_length = lent.substep.lend(substep), substep.step_start.rest_length
    auto_substeps = substep.substeps if world.settings.substeps == AUTO else 0
    if contacts is not None or (joints is not None and joints.on):
        from sandbox.physics.solvers.direct.island_solve import solve_islands

        solve_islands(
            contacts, world, layout.lent, lent.state, inputs, start_length, substep.ease, auto_substeps, substep.h
        )
    else:
        _solve_bodies(layout.lent, lent.state, inputs, start_length, substep.ease, auto_substeps, substep.h)
