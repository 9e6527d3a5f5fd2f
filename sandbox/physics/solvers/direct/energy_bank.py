"""The energy test of one body, and its energy bank: what its earlier losses still allow it."""

from sandbox.physics.arrays import Floats
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import BANK_UNOPENED
from sandbox.physics.solvers.direct.families import potential, start_potential
from sandbox.physics.solvers.direct.motion import kinetic
from sandbox.physics.solvers.direct.rigid_turn import kinetic_at_end
from sandbox.physics.solvers.direct.system import Span, System
from sandbox.physics.state import State

# A body's bank holds at most this share of its energy: where every spring has Cs <= Cd, and where one has not (its
# energy in this norm swings by up to 3 within a period). 0 would reject most steps at Cs = Cd = 1.
BANK_SHARE = 0.05
UNDERDAMPED_BANK_SHARE = 3.0
# Relative error of an energy summed over a large body; less rejects steps for rounding alone.
ENERGY_ROUNDING = 1e-12
# What a body loses beyond what its bank may hold is kept for its parting from others (parting.py), at most so much a
# mass [J/kg]: enough to be lifted by a metre. Less leaves heavy bodies in each other, more is never spent.
LARGEST_RESERVE = 10.0
# Halvings of the velocities before a body is stopped.
LAST_HALVINGS = 60
# The ways through the test. The last one that a substep of a body alone or of an island needed is counted, which no
# tick reads. The first linear solve passed; one more did; one for a lower target did; one whose contacts only hold, or
# the minimum of f; velocities were reduced until they passed. Counted beside them: bodies that answered to contacts by
# the masses of their particles, see islands.py.
PASSED, SOLVED_ON, GAVE_WAY, MINIMISED, SLOWED_DOWN, BY_MASS, WAYS = range(7)


@inner_kernel
def body_energy(body: int, span: Span, system: System, h: float) -> float:
    """Energy of one body after the step [J]: kinetic at `v`, and that of its springs and constraints."""
    # H = KE(v') + PE(x + h v')
    rows = system.rows
    return kinetic_at_end(body, span, system, h) + potential(span, system, rows.position, rows.v, h, h)


@inner_kernel
def is_open(span: Span, system: System, bank: Floats) -> bool:
    """Whether a body's bank continues from the last step: no particle of the body asks for a new one (-1 or -2)."""
    # After any change from outside.
    begun = True
    for r in range(span.first_row, span.last_row):
        if bank[system.rows.particle[r]] < 0.0:
            begun = False
    return begun


@inner_kernel
def is_new(span: Span, system: System, bank: Floats) -> bool:
    """Whether every particle of a body asks for a new bank (-1): at the start of a run, not after a hand let go
    (-2).
    """
    new = True
    for r in range(span.first_row, span.last_row):
        new = new and bank[system.rows.particle[r]] == BANK_UNOPENED
    return new


@inner_kernel
def open_bank(body: int, span: Span, system: System, bank: Floats, moved: float, h: float) -> float:
    """The energy in a body's bank before the step [J]; moved: energy of its springs after pins and drives have
    moved.
    """
    rows, bodies = system.rows, system.bodies
    lowest = bodies.lowest[body]
    begun = is_open(span, system, bank)
    # A body that broke off begins with none: what is saved stays with the particle that was the lowest, once.
    for r in range(span.first_row, span.last_row):
        p = rows.particle[r]
        if p != lowest:
            bank[p] = 0.0
    saved = bank[lowest] if begun else 0.0
    if not bodies.underdamped[body]:
        return saved
    kinetic_after = kinetic(span, rows.mass, rows.v_star)
    kinetic0 = kinetic(span, rows.mass, rows.start)
    present = start_potential(span, system, h)
    if not begun:
        saved += UNDERDAMPED_BANK_SHARE * (kinetic0 + present)
    # Work done by forces, grabs and drives since then counts as energy of the start.
    return max(0.0, saved + UNDERDAMPED_BANK_SHARE * (kinetic_after - kinetic0 + moved - present))


@inner_kernel
def bank_limit(body: int, system: System) -> float:
    """The most that a body's bank may hold after the step [J]."""
    share = UNDERDAMPED_BANK_SHARE if system.bodies.underdamped[body] else BANK_SHARE
    return share * system.bodies.energy0[body]


@inner_kernel
def reserve(body: int, span: Span, system: System, state: State, excess: float) -> float:
    """Put an excess [J], which a body has lost, into its parting reserve up to its limit; the rest of the excess."""
    # Where some Cs is above its Cd, energy in this norm comes and goes, and is no loss.
    lowest = system.bodies.lowest[body]
    if not excess > 0.0 or system.bodies.underdamped[body] or state.collides[lowest] == 0:
        return excess
    mass = 0.0
    for r in range(span.first_row, span.last_row):
        mass += system.rows.mass[r]
    kept = min(excess, max(0.0, LARGEST_RESERVE * mass - state.parting_reserve[lowest]))
    state.parting_reserve[lowest] += kept
    return excess - kept
