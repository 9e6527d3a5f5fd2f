"""Direct: the article's spring solved for a whole network at once, with a test that bounds the energy.

spring_terms.py states what is solved. What contacts touch or joints act on is solved island by island
(island_solve.py), all else body by body (step_body.py): such a body is an island without contacts.
"""

from sandbox.physics.collision.types import Contacts
from sandbox.physics.equation import implicit_spring_constant
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.direct.families import load_rows
from sandbox.physics.solvers.direct.island_solve import solve_islands
from sandbox.physics.solvers.direct.islands import IslandWorkspace
from sandbox.physics.solvers.direct.step_body import step_bodies
from sandbox.physics.solvers.direct.system import System
from sandbox.physics.solvers.inputs import Inputs
from sandbox.physics.state import State

spring_constant = implicit_spring_constant


@inner_kernel
def solve(
    state: State, system: System, inputs: Inputs, contacts: Contacts, workspace: IslandWorkspace, has_islands: bool,
    auto_substeps: int, h: float,
) -> None:  # fmt: skip
    """Bring the velocities to the end of a substep of h [s]; slow_velocity, energy_bank and tension go with them.

    has_islands: contacts touch bodies, or joints act on them, and the islands are found. auto_substeps: how many the
    tick chose, 0: the settings give them.
    """
    load_rows(system, state, inputs, h)
    if has_islands:
        solve_islands(contacts, workspace, system, state, inputs, auto_substeps, h)
    step_bodies(system, state, inputs, workspace.ways, has_islands, auto_substeps, h)
