"""The world block: all arrays of a world and of its steps as one structure, which kernels take as one pointer."""

from typing import NamedTuple

from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.breaking import MaterialLimits
from sandbox.physics.driving import Drives
from sandbox.physics.flight import Flight
from sandbox.physics.joints.joint_set import JointSet
from sandbox.physics.joints.limited_springs import SpringForces
from sandbox.physics.joints.motors import DrivenWheels, MotorSides
from sandbox.physics.pipeline.collide import Collisions
from sandbox.physics.solvers.direct.islands import IslandWorkspace
from sandbox.physics.solvers.direct.system import System
from sandbox.physics.solvers.iterative import Iteration
from sandbox.physics.solvers.linear.elimination import Tuning
from sandbox.physics.solvers.single_pass import ExplicitPass
from sandbox.physics.state import GoodValues, State
from sandbox.physics.untangling.triangle_clamp import WorldTriangles

# Places in `plan`: the first particle and the first spring of a hand, or -1; then what topology decides: whether
# anything can touch, whether the solver's system has Hooke springs beside it, whether there are areas of more than
# three corners.
GRAB_PARTICLE, GRAB_SPRING, HAS_CONTACTS, HAS_HOOKE, HAS_RINGS, PLANNED = range(6)
# Places in `progress`: the number of the tick, whether any particle may be unmoved; its substeps, 0 before they
# are chosen, and how many are done; springs that broke; whether what it begins with was looked at.
TICK, MAY_FLY, COUNT, DONE, BROKEN, CHECKED, PROGRESS = range(7)


class Coefficients(NamedTuple):
    """Cs and Cd of springs (m,) and constraints (t,) in a substep, where they are not those of a tick."""

    stiffness: Floats
    damping: Floats
    constraint_stiffness: Floats
    constraint_damping: Floats


class WorldBlock(NamedTuple):
    """A world as kernels take it.

    Given: state, good: its arrays; numbers, choices: its settings, see settings.py; drives, wheels, limits; tuning, see
    elimination.py. plan, progress: see above. wanted: the most of each that a step has asked for, see derive.py; counts
    of the collisions: what there is in the present step; ways of the workspace: see energy_bank.py.

    Derived, see derive.py: start [m/s] (n, 2): velocities before anything acted in a substep; start_length [m] (m,):
    rest lengths before drives; shortest (GRAB_COUNT,): scratch; body_label (n,): see hands.py. All else is of one phase
    or solver each, and empty where that has nothing to do.
    """

    state: State
    good: GoodValues
    numbers: Floats
    choices: Slots
    plan: Slots
    progress: Slots
    wanted: Slots
    drives: Drives
    wheels: DrivenWheels
    limits: MaterialLimits
    tuning: Tuning
    start: FloatRows
    start_length: Floats
    shortest: Floats
    body_label: Slots
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
