"""The world block: all arrays of a world and of its steps as one structure, which kernels take as one pointer."""

from typing import Annotated, NamedTuple

from sandbox.physics.arrays import FloatRows, Floats, SlotRows, Slots
from sandbox.physics.breaking import MaterialLimits
from sandbox.physics.driving import Drives
from sandbox.physics.integrate import Flight
from sandbox.physics.joints.joint_set import DrivenWheels, JointSet, MotorSides, SpringForces
from sandbox.physics.pipeline.collide import Collisions
from sandbox.physics.rules import Rules
from sandbox.physics.softness.kernels.firm import FormModes, Forms
from sandbox.physics.solvers.direct.islands import IslandWorkspace
from sandbox.physics.solvers.direct.system import System
from sandbox.physics.solvers.iterative import Iteration
from sandbox.physics.solvers.linear.elimination import Tuning
from sandbox.physics.solvers.single_pass import ExplicitPass
from sandbox.physics.state import GoodValues, Ranges, State
from sandbox.physics.untangling.triangle_clamp import WorldTriangles
from sandbox.physics.water.displacers import Water
from sandbox.physics.ways import Ways

# Places in `plan`: the first particle and the first spring of a hand, or -1; then what topology decides: whether
# anything can touch, whether the solver's system has Hooke springs beside it, whether there are areas of more than
# three corners, whether any surface runs.
GRAB_PARTICLE, GRAB_SPRING, HAS_CONTACTS, HAS_HOOKE, HAS_RINGS, HAS_BELTS, PLANNED = range(7)
# Places in `progress`: the number of the tick, whether any particle may be unmoved; its substeps, 0 before they
# are chosen, and how many are done; springs that broke; whether what it begins with was looked at.
TICK, MAY_FLY, COUNT, DONE, BROKEN, CHECKED, PROGRESS = range(7)


class Coefficients(NamedTuple):
    """Cs and Cd of springs (m,) and constraints (t,) in a substep, where they are not those of a tick."""

    stiffness: Annotated[Floats, "springs"]
    damping: Annotated[Floats, "springs"]
    constraint_stiffness: Annotated[Floats, "constraints"]
    constraint_damping: Annotated[Floats, "constraints"]


class WorldBlock(NamedTuple):
    """A world as kernels take it: what Python gives, then, from start on, what is derived (derive.py).

    Of the collisions and the workspace, counts and ways are given too. What is below body_label is of one phase or
    solver each, and empty where that has nothing to do.
    """

    state: State
    good: GoodValues
    numbers: Floats  # numbers, choices: the settings (settings.py)
    choices: Slots
    areas: SlotRows  # areas, forms, modes: see Commanded
    forms: Forms
    modes: FormModes
    drives: Drives  # up to water: what a kit changes (kit_kernels.py)
    wheels: DrivenWheels
    limits: MaterialLimits
    water: Water  # pools and hulls; the rest is derived
    plan: Slots  # plan, progress: see above
    progress: Slots
    demand: Slots  # the most of each that a step has asked for (derive.py)
    tuning: Tuning  # see elimination.py
    rules: Rules
    ways: Ways
    ranges: Ranges
    start: FloatRows  # [m/s] (n, 2): velocities before anything acted in a substep
    start_length: Floats  # [m] (m,): rest lengths before drives
    shortest: Floats  # (GRAB_COUNT,): scratch
    body_label: Slots  # (n,): see hands.py
    coefficients: Coefficients
    forces: SpringForces
    sides: MotorSides
    flight: Flight
    collisions: Collisions
    joints: JointSet
    triangles: WorldTriangles
    system: System
    workspace: IslandWorkspace
    iteration: Iteration
    explicit: ExplicitPass
