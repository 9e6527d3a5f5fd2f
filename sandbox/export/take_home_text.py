"""Take home, as text for a person: short lines, each of which stands for itself."""

from sandbox.export.engines import EngineNumbers
from sandbox.export.loops import LISTINGS, expected, listing
from sandbox.export.numbers import percent, short
from sandbox.export.proven import LoopPair, LoopRow
from sandbox.export.take_home import TakeHome, take_home
from sandbox.level.assembly.level_world import LevelWorld
from sandbox.level.document.model import Level

ENGINES = ("box2d", "unity", "godot", "rapier", "pymunk", "chipmunk")
# What text can be had for; "all" is everything but the programs.
TARGETS = ("all", "article", *LISTINGS, *ENGINES)
# Lines of k and c that are shown, at most: of bodies whose particles all weigh differently there are many.
MOST_MASSES = 6
# Engines whose springs take frequency and damping ratio, not k and c.
BY_FREQUENCY = ("Box2D 3", "Unity 2D")
# Engines that cut a step into substeps by themselves.
WITH_SUBSTEPS = ("Box2D 3", "Rapier 2D")


def take_home_text(source: Level | LevelWorld, body: str | None = None, to: str = "all") -> str:
    """What a body takes home, as text: for a button, from a running world, or from a level; see `take_home`.

    Raises NoSuchBody, LevelError, and KeyError for a name that is none of TARGETS.
    """
    return as_text(take_home(source, body), to)


def as_text(take: TakeHome, to: str = "all") -> str:
    """The text for one of TARGETS, which ends with a newline. Raises KeyError for another."""
    lines = [*_head(take)]
    if to in ENGINES:
        lines += ["", *_engine(take, to)]
    else:
        lines += ["", *_loop(take)]
        if to == "all":
            for name in ENGINES:
                lines += ["", *_engine(take, name)]
            lines += ["", f"The loop as a program, and ten ticks to try it by: --to {', '.join(LISTINGS)}."]
        else:
            for language in LISTINGS if to == "article" else [to]:
                lines += ["", f"---- {language}", "", *listing(take.trial, language).splitlines()]
            lines += ["", *_trial(take)]
    return "\n".join(lines) + "\n"


def _head(take: TakeHome) -> list[str]:
    title = f' of "{take.level}"' if take.level else ""
    count = f"{take.springs} spring" + "s" * (take.springs != 1)
    more = f"; {take.others} more have other numbers" if take.others else ""
    rate = f"a tick of 1/{_rate(take.h)} s"
    law = " (Hooke's springs, as they amount to for the lightest ends)" if take.hooke else ""
    solver = take.solver.replace("_", " ")
    return [
        f'"{take.body}"{title}: {count} of {take.material}{more}.',
        f"Here: Cs {short(take.stiffness)}, Cd {short(take.damping)} in {rate}, {solver} solver{law}.",
        take.firmness,
    ]


def _loop(take: TakeHome) -> list[str]:
    demand = f"Cs + 2 Cd below {short(take.demand)} in each step (4 / n_eff, n_eff {short(take.n_eff)})"
    if take.holds:
        verdict = "the level's own numbers are inside."
    elif take.solver == "direct":
        verdict = "the level's own hold for the direct solver alone and may explode in a single pass."
    else:
        verdict = "the level's own are beyond and may explode in a single pass."
    areas = "Its areas and bends count as springs here; the programs have springs alone, and are softer without them."
    return [
        "The article's loop, all springs in a single pass:",
        f"Proven: {demand}; {verdict}",
        *([areas] if take.has_constraints else []),
        *(_row(row) for row in take.rows),
    ]


def _row(row: LoopRow) -> str:
    steps = f"{row.substeps} substep" + "s" * (row.substeps != 1)
    own = "" if row.own == row.equal else f"; at the level's ratio {_pair(row.own)}"
    return f"  {steps}, h 1/{_rate(row.h)} s: {_pair(row.equal)}{own}"


def _rate(h: float) -> str:
    """How many steps of h [s] are in a second, which is a whole number."""
    return str(round(1.0 / h))


def _pair(pair: LoopPair) -> str:
    numbers = f"Cs {short(pair.stiffness)}, Cd {short(pair.damping)}"
    if pair.sag is None:
        return f"{numbers}: one spring under the whole weight stretches by {percent(pair.stretch)}"
    flat = " (it lies flat)" if pair.sag >= 1.0 else ""
    return (
        f"{numbers}: sags by {percent(pair.sag)}{flat}, {short(pair.frequency)} Hz, ratio {short(pair.damping_ratio)}"
    )


def _engine(take: TakeHome, name: str) -> list[str]:
    numbers = take.engines[name]
    softer = ". It has no areas and no bends, so this body is softer there" if take.has_constraints else ""
    differs = f"  Differs: {numbers.difference}{softer}."
    if numbers.rigid:
        return [f"{numbers.engine}: too stiff for its springs; use rigid joints, or a softer material.", differs]
    if numbers.engine in WITH_SUBSTEPS:
        rate = f"{_rate(numbers.step * numbers.steps)} steps a second of {numbers.steps} substeps"
    else:
        rate = f"{_rate(numbers.step)} steps a second" + (f", {numbers.steps} a tick" if numbers.steps > 1 else "")
    least = " (the least; it damps more by itself)" if numbers.negative else ""
    return [
        f"{numbers.engine}, {rate}: frequency {short(numbers.frequency)} Hz, damping ratio "
        f"{short(numbers.damping_ratio)}{least}, whatever the masses.",
        *([] if numbers.engine in BY_FREQUENCY else _masses(numbers)),
        differs,
    ]


def _masses(numbers: EngineNumbers) -> list[str]:
    lines = []
    for mass in numbers.masses[:MOST_MASSES]:
        count = f"{mass.springs} spring" + "s" * (mass.springs != 1)
        lines.append(
            f"  reduced mass {short(mass.reduced_mass)} kg ({count}): k {short(mass.k)} N/m, c {short(mass.c)} N s/m"
        )
    if len(numbers.masses) > MOST_MASSES:
        first = numbers.masses[0]
        per = f"k = {short(first.k / first.reduced_mass)} m_r, c = {short(first.c / first.reduced_mass)} m_r"
        lines.append(f"  and {len(numbers.masses) - MOST_MASSES} heavier ones; all: {per}, m_r the reduced mass in kg")
    return lines


def _trial(take: TakeHome) -> list[str]:
    return [
        "What it prints, tick x y x y; yours should agree to nine digits.",
        "(The sandbox gives the first tick half of gravity, so that what falls is at g t^2 / 2; this loop does not.)",
        *("  " + line for line in expected(take.trial)),
    ]
