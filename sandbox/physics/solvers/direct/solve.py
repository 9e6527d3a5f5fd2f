"""Direct: the article's spring solved for a whole network at once, with a test that bounds the energy.

spring_terms.py states what is solved. What contacts touch or joints act on is solved island by island
(island_solve.py), all else body by body (step_body.py): such a body is an island without contacts.
"""

from operator import attrgetter
from typing import Any

from sandbox.physics.collision.types import NO_CONTACTS, Contacts
from sandbox.physics.equation import implicit_spring_constant
from sandbox.physics.integrate import follow
from sandbox.physics.jit import bundle, contents, kernel
from sandbox.physics.joints.joint_set import joints_of
from sandbox.physics.settings import AUTO
from sandbox.physics.solvers.direct.families import load_rows
from sandbox.physics.solvers.direct.layout import layout_of
from sandbox.physics.solvers.direct.step_body import open_body, step_body
from sandbox.physics.solvers.direct.system import Inputs, State, span_of
from sandbox.physics.solvers.single_pass import apply_explicit
from sandbox.physics.substeps import Substep
from sandbox.physics.world import Floats, World

_STATE = attrgetter(*State._fields)


@kernel
def _solve_bodies(
    lent_system: Any, lent_state: Any, stiffness: Floats, damping: Floats, constraint_stiffness: Floats,
    constraint_damping: Floats, start: Floats, start_length: Floats, touched: bool, parts: int, h: float,
) -> None:  # fmt: skip
    # What nothing touches, and s += 0.3 (v' - s) of all; touched: some bodies are, and rows are loaded.
    (system,) = contents(lent_system)
    (state,) = contents(lent_state)
    inputs = Inputs(stiffness, damping, constraint_stiffness, constraint_damping, start, start_length)
    bodies, rows, springs = system.bodies, system.rows, system.springs
    if not touched:
        load_rows(system, state, inputs, h)
    for body in range(bodies.lowest.shape[0]):
        if touched and bodies.touched[body]:
            continue
        span = span_of(system, body)
        open_body(body, span, system, state, inputs, parts, h)
        step_body(body, span, system, state, h)
        for r in range(span.first_row, span.last_row):
            state.velocity[rows.particle[r], 0] = rows.trial[r, 0]
            state.velocity[rows.particle[r], 1] = rows.trial[r, 1]
        for k in range(span.first_spring, span.last_spring):
            state.tension[springs.slot[k]] = springs.tension[k]
    follow(state.velocity, state.slow_velocity, state.particle_active)


def _lent_state(world: World) -> Any:
    return bundle((State._make(_STATE(world)),))


spring_constant = implicit_spring_constant


def solve(world: World, substep: Substep, contacts: Contacts | None) -> None:
    """Bring the velocities to the end of a substep; slow_velocity, energy_bank and tension go with them.

    contacts: what touches, with the impulses that it brings along and then has; None: nothing can.
    """
    layout = layout_of(world)
    if layout.has_hooke:
        apply_explicit(world, layout.hooke, substep.springs, substep.h)
    state = world.derived(_lent_state)
    joints = joints_of(world)
    touched = (contacts is not None and len(contacts.particle) > 0) or (joints is not None and joints.on)
    inputs = (*substep.springs, *substep.constraints, *substep.before)
    parts = substep.substeps if world.settings.substeps == AUTO else 0
    if touched:
        from sandbox.physics.solvers.direct.island_solve import solve_touched

        solve_touched(NO_CONTACTS if contacts is None else contacts, world, layout, state, inputs, parts, substep.h)
    _solve_bodies(layout.lent, state, *inputs, touched, parts, substep.h)
