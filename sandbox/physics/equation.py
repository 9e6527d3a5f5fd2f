"""THE equation: the damped spring whose stiffness and damping are fractions of complete rigidity (Nissen 2019).

    J = -(Cs x / h + Cd u) m_r          impulse along the spring [N s]

with distance error x [m], velocity error u [m/s], reduced mass m_r [kg], time step h [s], Cs and Cd in 0..1.

That is its explicit form, on the velocity error u before the step. For 0 < Cd < 1 it is, for one spring, identical to
the implicit form, on the velocity error u' after the step, in which springs of a network can be solved together:

    J = -K (u' + beta x / h),   K = m_r Cd / (1 - Cd) [kg],   beta = Cs / Cd

Areas, bends, contacts and the grab obey the same equation: C(x) with gradient g has dC/dt for u, and 1 / (g W g^T) for
m_r.
"""

import math
from decimal import ROUND_FLOOR, Context
from typing import Any

import numpy as np

from sandbox.physics.geometry.elementary import arc_cosine, cosine, exponential, logarithm_beside_one
from sandbox.physics.geometry.segment import SHORTEST
from sandbox.physics.jit import scalar_kernel

# The implicit form caps Cd here, and Cs with it: nearer to 1 springs stretch less, but steps are rejected more often
# and damp more.
HIGHEST_COEFFICIENT = 1.0 - 1e-7
TURN = 2.0 * math.pi


@scalar_kernel
def reduced_mass(inverse_a: float, inverse_b: float) -> float:
    """Reduced mass [kg] of two particles from their inverse masses [1/kg]; 0 where both are pinned."""
    # m_r = 1 / (w_a + w_b)
    total = inverse_a + inverse_b
    if total > 0.0:
        return 1.0 / total
    return 0.0


@scalar_kernel
def spring_impulse(
    stiffness: float, damping: float, distance_error: float, velocity_error: float, mass: float, h: float
) -> float:
    """Impulse [N s] of one spring along its direction (Nissen 2019, impulse-based spring)."""
    # J = -(Cs x / h + Cd u) m_r  (1)
    return -(stiffness * distance_error / h + damping * velocity_error) * mass


@scalar_kernel
def capped(stiffness: float, damping: float, highest: float) -> tuple[float, float]:
    """Cs and Cd, with both at most `highest` where Cd is above it: so Cs = Cd = 1 keeps beta = 1."""
    if damping > highest:
        return min(stiffness, highest), highest
    return stiffness, damping


@scalar_kernel
def implicit_masses(stiffness: float, damping: float, mass: float) -> tuple[float, float]:
    """K and K beta [kg] of a spring whose effective mass is `mass` [kg]; K beta needs no division by Cd."""
    # K = m Cd / (1 - Cd);  K beta = m Cs / (1 - Cd)  (7)
    stiffness, damping = capped(stiffness, damping, HIGHEST_COEFFICIENT)
    return mass * damping / (1.0 - damping), mass * stiffness / (1.0 - damping)


@scalar_kernel
def implicit_impulse(stiff: float, restoring: float, growth: float, error: float, h: float) -> float:
    """Impulse [N s] of the implicit form; stiff: K, restoring: K beta [kg], growth: the step's velocity error [m/s]."""
    # J = -(K (x' - x) / h + K beta x / h)  (7)
    return -(stiff * growth + restoring * error / h)


@scalar_kernel
def implicit_update(impulse: float, velocity_error: float, response: float, softness: float) -> float:
    """The impulse [N s] after a sweep: velocity_error [m/s] after it, its bias added; see `gauss_seidel`.

    response [1/kg] = J W J^T; softness [1/kg] = response (1 - Cd) / Cd = 1 / K.
    """
    # J - (u + b + J / K) / (W + 1 / K)  (27)
    return impulse - (velocity_error + softness * impulse) / (response + softness)


def explicit_spring_constant(stiffness: Any, damping: Any, mass: Any, h: float) -> Any:
    """k [N/m] of springs under the explicit form: Cs m_r / h^2."""
    return stiffness * mass / (h * h)


def implicit_spring_constant(stiffness: Any, damping: Any, mass: Any, h: float) -> Any:
    """k [N/m] of springs under the implicit form: Cs m_r / ((1 - Cd) h^2), Cs and Cd capped as in that form."""
    highest = np.where(damping > HIGHEST_COEFFICIENT, np.minimum(stiffness, HIGHEST_COEFFICIENT), stiffness)
    return highest * mass / ((1.0 - np.minimum(damping, HIGHEST_COEFFICIENT)) * h * h)  # (8)


@scalar_kernel
def direction(dx: float, dy: float, du: float, dv: float) -> tuple[float, float, float]:
    """Unit vector and length [m] of the separation (dx, dy) between particles of relative velocity (du, dv).

    Coincident particles take the direction in which they separate, or +x when they do not move apart at all.
    """
    # l = |d|, n = d / l
    length = math.sqrt(dx * dx + dy * dy)
    if length > SHORTEST:
        return dx / length, dy / length, length
    speed = math.sqrt(du * du + dv * dv)
    if speed > SHORTEST:
        return du / speed, dv / speed, 0.0
    return 1.0, 0.0, 0.0


@scalar_kernel
def half_step(stiffness: float, damping: float) -> tuple[float, float]:
    """Cs and Cd of half the time step that leave the spring's motion from tick to tick as it was.

    The map keeps 0..1, Cs <= Cd, and (1, 1); it preserves the eigenvalues of one spring's step.
    """
    # e = sqrt(1 - Cd);  Cd' = 1 - e;  Cs' = 1 + e - sqrt(2 - Cs - Cd + 2 e)  (15)
    # written as quotients: the differences lose the digits of small coefficients and can fall below 0.
    e = math.sqrt(max(0.0, 1.0 - damping))
    return stiffness / (1.0 + e + math.sqrt(max(0.0, 2.0 - stiffness - damping + 2.0 * e))), damping / (1.0 + e)


@scalar_kernel
def of_body(stiffness: float, damping: float, lowest_mode: float) -> tuple[float, float]:
    """Cs and Cd of the one spring that a body is in its slowest wobble, from those of its springs.

    lowest_mode: the least eigenvalue a > 0 of the body's form (lowest_mode.py).
    """
    # Cd_a = a / (a + (1 - Cd) / Cd),  Cs_a = Cs / Cd Cd_a, in the implicit form  (21)
    share = lowest_mode / (lowest_mode * damping + (1.0 - damping))
    return stiffness * share, damping * share


@scalar_kernel
def of_springs(stiffness: float, damping: float, lowest_mode: float) -> tuple[float, float]:
    """Cs and Cd of a body's springs, areas and bends, from those of its slowest wobble: the inverse of `of_body`."""
    # Cd = Cd_a / (Cd_a + a (1 - Cd_a)),  Cs = Cs_a / Cd_a Cd  (22)
    whole = damping + lowest_mode * (1.0 - damping)
    return stiffness / whole, damping / whole


@scalar_kernel
def half_step_of_network(stiffness: float, damping: float, lowest_mode: float) -> tuple[float, float]:
    """`half_step` of a spring among many: of the body's slowest wobble, where lowest_mode is above 0.

    One spring keeps its motion, but a network's is that of k = Cs m_r / ((1 - Cd) h^2), which halving stiff springs one
    by one makes up to ten times less.
    """
    if lowest_mode > 0.0:
        stiffness, damping = of_body(stiffness, damping, lowest_mode)
        stiffness, damping = half_step(stiffness, damping)
        return of_springs(stiffness, damping, lowest_mode)
    return half_step(stiffness, damping)


@scalar_kernel
def part_of_network(stiffness: float, damping: float, lowest_mode: float, substeps: int) -> tuple[float, float]:
    """Cs and Cd of one substep of a tick, a power of two, that leave k = Cs m_r / ((1 - Cd) h^2) as it was.

    So the energy of a network does not depend on the substeps. Damping is the greater of what `half_step_of_network`
    makes of it and of c = (Cd - Cs) m_r / ((1 - Cd) h) as it was. Cs <= Cd stays so.
    """
    # S = Cs / (1 - Cd), D = Cd / (1 - Cd):  k = S m_r / h^2,  c = (D - S) m_r / h,  1 + a D = 1 / (1 - Cd_a)
    stiffness, damping = capped(stiffness, damping, HIGHEST_COEFFICIENT)
    mode = lowest_mode if lowest_mode > 0.0 else 1.0
    restoring = stiffness / (1.0 - damping)
    stiff = damping / (1.0 - damping)
    while substeps > 1:
        halved = stiff / (1.0 + math.sqrt(1.0 + mode * stiff))  # (16)
        # Of Cs > Cd, c is below 0, and no less than a quarter of D is kept: Cs / Cd never rises.
        stiff = max(halved, 0.25 * max(stiff, 2.0 * stiff - restoring))
        restoring *= 0.25
        substeps //= 2
    return restoring / (1.0 + stiff), stiff / (1.0 + stiff)


def whole_of_parts(stiffness: float, damping: float, substeps: int) -> tuple[float, float]:
    """Cs and Cd of a tick of which `part_of_network` makes these of a substep, for a spring of its own: Cd < 1.

    The inverse of the map, but for digits: of three lines that all rise the greatest counts there, so here the least of
    their inverses.
    """
    # One doubling: S = 4 S';  D = min(D'^2 + 2 D', 4 D', 2 D' + S / 2)
    restoring, stiff = stiffness / (1.0 - damping), damping / (1.0 - damping)
    while substeps > 1:
        restoring *= 4.0
        stiff = min(stiff * (stiff + 2.0), 4.0 * stiff, 2.0 * stiff + 0.5 * restoring)
        substeps //= 2
    return restoring / (1.0 + stiff), stiff / (1.0 + stiff)


def coefficients_from_frequency(frequency: float, damping_ratio: float, h: float) -> tuple[float, float]:
    """Cs and Cd that give one spring the frequency [Hz] and damping ratio at time step h [s], exactly.

    Raises ValueError, naming the highest frequency possible, where Cs would leave 0..1.
    Source: the pole match of x'' + 2 z w x' + w^2 x = 0 with the spring's own two-term recurrence.
    """
    if not (frequency >= 0.0 and damping_ratio >= 0.0 and h > 0.0 and math.isfinite(frequency + damping_ratio + h)):
        raise ValueError("frequency and damping ratio are finite numbers of 0 or more, and the time step is above 0")
    stiffness, damping = pole_match(frequency, damping_ratio, h)
    if not is_reachable(frequency, damping_ratio, h):
        # Rounded down: the frequency that is named can be had.
        highest = float(Context(prec=3, rounding=ROUND_FLOOR).create_decimal(highest_frequency(damping_ratio, h)))
        raise ValueError(
            f"{frequency:g} Hz at damping ratio {damping_ratio:g} needs Cs = {stiffness:.3g}, above 1; "
            f"the highest frequency here is {highest:g} Hz"
        )
    return min(max(stiffness, 0.0), 1.0), damping


@scalar_kernel
def pole_match(frequency: float, damping_ratio: float, h: float) -> tuple[float, float]:
    """Cs and Cd of `coefficients_from_frequency`, whatever they are."""
    phase = TURN * frequency * h
    decay = exponential(-damping_ratio * phase)  # (3)
    damping = 1.0 - decay * decay
    if damping_ratio < 1.0:
        turn = phase * math.sqrt(1.0 - damping_ratio * damping_ratio)
        return 2.0 - damping - 2.0 * decay * cosine(turn), damping
    # e cosh(y) as two decaying exponentials: cosh alone overflows for strongly damped springs.
    root = phase * math.sqrt(damping_ratio * damping_ratio - 1.0)
    fall = damping_ratio * phase
    return 2.0 - damping - exponential(root - fall) - exponential(-root - fall), damping


def at_other_step(stiffness: float, damping: float, times: float) -> tuple[float, float]:
    """Cs and Cd at a time step so many times as long that leave one spring's motion per second as it was, exactly.

    Raises ValueError where Cs would have to be above 1, or the spring would swing more than once in two such steps.
    Source: the roots r of r^2 - (2 - Cs - Cd) r + (1 - Cd) = 0, its motion from step to step, become r^times.
    """
    # 1 - r are the roots s of s^2 - (Cs + Cd) s + Cs = 0; so written, small coefficients keep their digits.
    total = stiffness + damping
    apart = total * total - 4.0 * stiffness
    if apart >= 0.0:
        quick = 0.5 * (total + math.sqrt(apart))
        slow = stiffness / quick if quick > 0.0 else 0.0
        quick, slow = _fallen(quick, times), _fallen(slow, times)
        return quick * slow, quick + slow - quick * slow
    # Both are e exp(+-i turn), with Cs = (1 - e)^2 + 4 e sin(turn / 2)^2.
    fall = 0.5 * math.log1p(-damping)
    e = math.exp(fall)
    turn = 2.0 * math.asin(min(1.0, math.sqrt(max(0.0, stiffness - (damping / (1.0 + e)) ** 2) / (4.0 * e))))
    new = math.exp(times * fall)
    found = math.expm1(times * fall) ** 2 + 4.0 * new * math.sin(0.5 * times * turn) ** 2
    if found > 1.0 or times * turn > math.pi:
        raise ValueError(f"Cs = {stiffness:g}, Cd = {damping:g} swing too fast for a step {times:g} times as long")
    return found, -math.expm1(2.0 * times * fall)


def _fallen(part: float, times: float) -> float:
    """1 - (1 - part)^times."""
    return 1.0 if part >= 1.0 else -math.expm1(times * math.log1p(-part))


@scalar_kernel
def is_reachable(frequency: float, damping_ratio: float, h: float) -> bool:
    """Whether Cs is in 0..1 and the frequency is not an alias beyond half the tick rate."""
    phase = TURN * frequency * h
    if damping_ratio < 1.0 and phase * math.sqrt(1.0 - damping_ratio * damping_ratio) > 0.5 * TURN:
        return False
    stiffness, _ = pole_match(frequency, damping_ratio, h)
    return stiffness <= 1.0


@scalar_kernel
def highest_frequency(damping_ratio: float, h: float) -> float:
    """Highest frequency [Hz] that Cs <= 1 can give at this damping ratio and time step [s]; inf where there is none."""
    low, high = 0.0, 1.0 / h
    while is_reachable(high, damping_ratio, h):
        high *= 2.0
        if high > 1e9 / h:
            return math.inf
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if is_reachable(middle, damping_ratio, h) else (low, middle)
    return low


@scalar_kernel
def frequency_from_coefficients(stiffness: float, damping: float, h: float) -> tuple[float, float]:
    """Frequency [Hz] and damping ratio of one spring with these Cs and Cd at time step h [s].

    Cd = 1 leaves a mode that dies within one step, which no finite frequency describes: both are inf.
    """
    if damping >= 1.0:
        return math.inf, math.inf
    # The roots r of r^2 - trace r + product = 0 are exp(h times the poles).  (2)
    fall = -0.5 * logarithm_beside_one(-damping) + 0.0
    middle = 0.5 * (2.0 - stiffness - damping) / math.sqrt(1.0 - damping)
    if middle >= 1.0:
        beyond = middle - 1.0
        turn = logarithm_beside_one(beyond + math.sqrt(beyond * (middle + 1.0)))
        turn_squared = -(turn * turn)
    elif middle > -1.0:
        turn = arc_cosine(middle)
        turn_squared = turn * turn
    else:
        return math.inf, math.inf
    natural = math.sqrt(max(0.0, turn_squared + fall * fall))
    if natural == 0.0:
        return 0.0, 0.0 if fall == 0.0 else math.inf
    return natural / (TURN * h), fall / natural
