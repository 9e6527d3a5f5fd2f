"""The energy budget of bodies: what their earlier losses still allow them (passivity), and what a step may have.

A step is taken if its energy H' = KE + PE stays within what a body or an island had plus its budget. A stiff spring
counts with far more than it can give back: lengths that miss by 10 um are 1e4 J, and mend with 1e-3 J of motion. So
where lengths are nearly right, and further solves bring them no nearer, PE may be replaced by what can come back,

    U(x') = min over D of |D|^2_M / 2 + PE(x' + h D),      at most PE, and what a step from rest has left

and the rest, PE - U, is noted as unreturnable: the next step begins with U. What still has too much loses what it moves
beside the motion that nothing outside holds, V, by as little as that asks for:

    v' = V + r (v' - V),      r = 1 - MARGIN (H' - H* - B) / (2 T) at first,      T = 1/2 |v' - V|^2_M
"""

from sandbox.physics.arrays import Floats
from sandbox.physics.collision.types import Contacts
from sandbox.physics.geometry.rigid import RigidMotion
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.marks import BANK_UNOPENED
from sandbox.physics.solvers.direct.constraint_terms import constraint_potential
from sandbox.physics.solvers.direct.network import potential, returnable, start_potential
from sandbox.physics.solvers.direct.rigid_turn import kinetic_at_end
from sandbox.physics.solvers.direct.spring_terms import restore_springs
from sandbox.physics.solvers.direct.system import Span, System, kinetic
from sandbox.physics.state import State
from sandbox.physics.untangling.overlaps import DEEP

# A body's budget holds at most this share of its energy: where every spring has Cs <= Cd, and where one has not (its
# energy in this norm swings by up to 3 within a period). 0 would reject most steps at Cs = Cd = 1.
BUDGET_SHARE = 0.05
UNDERDAMPED_BUDGET_SHARE = 3.0
# Relative error of an energy summed over a large body; less rejects steps for rounding alone.
ENERGY_ROUNDING = 1e-12
# What a body loses beyond what its budget may hold is kept for its depenetration (depenetration.py), at most so much a
# mass [J/kg]: enough to be lifted by a metre. Less leaves heavy bodies in each other, more is never spent.
LARGEST_RESERVE = 10.0
# Linear solves of a step at most, while each leaves less than FALLING of what is too much: lengths come right; or else
# changes it by more than SETTLED, and what springs can give back is too much as well.
MORE_SOLVES = 12
FALLING = 0.5
SETTLED = 0.01
# Springs give back less than they count only where none is wrong by more than this share of its length.
CLOSE = 0.003
# So much of what is too much is taken off what moves: with 1 a step would fail again by what is of second order.
MARGIN = 1.25
# Rounds in which ever more is taken off: all of what moves beside the motion to keep, then all of what that turns.
ROUNDS = 16
SLOWING_ROUNDS = 2 * ROUNDS


@inner_kernel
def body_energy(body: int, span: Span, system: System, h: float) -> float:
    """Energy of one body after the step [J]: kinetic at `v`, and that of its springs and constraints."""
    # H = KE(v') + PE(x + h v')
    rows = system.rows
    return kinetic_at_end(body, span, system, h) + potential(span, system, rows.position, rows.v, h, h)


@inner_kernel
def open_budget(body: int, span: Span, system: System, budget: Floats, moved: float, h: float) -> float:
    """The energy in a body's budget before the step [J]; moved: energy of its springs after pins and drives have
    moved.
    """
    rows, bodies = system.rows, system.bodies
    lowest = bodies.lowest[body]
    # After any change from outside.
    begun = True
    for r in range(span.first_row, span.last_row):
        if budget[system.rows.particle[r]] < 0.0:
            begun = False
    # A body that broke off begins with none: what is saved stays with the particle that was the lowest, once.
    for r in range(span.first_row, span.last_row):
        p = rows.particle[r]
        if p != lowest:
            budget[p] = 0.0
    saved = budget[lowest] if begun else 0.0
    if not bodies.underdamped[body]:
        return saved
    kinetic_after = kinetic(span, rows.mass, rows.v_star)
    kinetic0 = kinetic(span, rows.mass, rows.start)
    present = start_potential(span, system, h)
    if not begun:
        saved += UNDERDAMPED_BUDGET_SHARE * (kinetic0 + present)
    # Work done by forces, grabs and drives since then counts as energy of the start.
    return max(0.0, saved + UNDERDAMPED_BUDGET_SHARE * (kinetic_after - kinetic0 + moved - present))


@inner_kernel
def is_new(span: Span, system: System, budget: Floats) -> bool:
    """Whether every particle of a body asks for a new budget (-1): at the start of a run, not after a hand let go
    (-2).
    """
    new = True
    for r in range(span.first_row, span.last_row):
        new = new and budget[system.rows.particle[r]] == BANK_UNOPENED
    return new


@inner_kernel
def budget_limit(body: int, system: System) -> float:
    """The most that a body's budget may hold after the step [J]."""
    ratio = UNDERDAMPED_BUDGET_SHARE if system.bodies.underdamped[body] else BUDGET_SHARE
    return ratio * system.bodies.energy0[body]


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


@inner_kernel
def is_deep(c: int, contacts: Contacts, state: State) -> bool:
    """Whether what touches at a contact overlaps deeply."""
    return contacts.gap[c] < -DEEP * state.radius[contacts.particle[c]]


@inner_kernel
def unreturnable(body: int, span: Span, system: System, keeps: bool, h: float) -> float:
    """What of the energy of a body's springs after the step cannot come back [J]; noted for the next step.

    keeps: the step keeps all lengths, so that this is what it was.
    """
    # Where some Cs is above its Cd, k is no larger than what moves; and what is far from its lengths is no linear body.
    kept = system.bodies.unreturnable0[body] if keeps else 0.0
    if not (keeps or system.bodies.underdamped[body]):
        full, strain = restore_springs(span, system, h)
        if strain < CLOSE:
            full += constraint_potential(span, system, system.rows.position, system.rows.v, h, h)
            kept = max(0.0, full - returnable(span, system, h))
    system.bodies.unreturnable[body] = kept
    return kept


@inlined_kernel
def first_ratio(excess: float, moves: float) -> float:
    """What is left at first of what moves beside the motion to keep, whose energy [J] is `moves`, for an excess [J]."""
    return 1.0 - 0.5 * MARGIN * excess / moves if MARGIN * excess < moves else 0.5  # (30)


@inlined_kernel
def next_ratio(ratio: float, done: int) -> float:
    """What is left in the next round, where that was too much; done: how many rounds there were before it."""
    return 0.0 if keeps_lengths(done) else max(2.0 * ratio - 1.0, 0.5 * ratio)


@inlined_kernel
def keeps_lengths(done: int) -> bool:
    """Whether a round of slowing down, after so many, leaves the motion to keep alone."""
    return done % ROUNDS == ROUNDS - 1


@inlined_kernel
def without_turn(motion: RigidMotion) -> RigidMotion:
    """A rigid motion that turns nothing."""
    return RigidMotion(motion.x, motion.y, motion.u, motion.v, 0.0, 0.0)
