"""Take home: what a body's springs are in the article's loop and in other engines.

As numbers (take_home), as text for a person in short lines (as_text), and as lines of code to paste (pasted).
"""

from dataclasses import dataclass

from sandbox.export.engines import ChosenBody, EngineNumbers, choose_body, engine_numbers
from sandbox.export.loops import LISTINGS, LoopPair, LoopRow, LoopTrial, expected, listing, loop_rows, loop_trial
from sandbox.export.numbers import percent, short
from sandbox.level.assembly.build_world import LevelWorld, build_world
from sandbox.level.document.model import Level
from sandbox.physics.analysis.stability import BOUND
from sandbox.physics.softness.body_motion import read_body, word_for

ENGINES = ("box2d", "unity", "godot", "rapier", "pymunk", "chipmunk")
# What text can be had for; "all" is everything but the programs.
TARGETS = ("all", "article", *LISTINGS, *ENGINES)
# Lines of k and c that are shown, at most: of bodies whose particles all weigh differently there are many.
MOST_MASSES = 6
# Engines whose springs take frequency and damping ratio, not k and c.
BY_FREQUENCY = ("Box2D 3", "Unity 2D")
# Engines that cut a step into substeps by themselves.
WITH_SUBSTEPS = ("Box2D 3", "Rapier 2D")
# Masses of which there are lines; what is said below them tells of the others.
PASTED_MASSES = 3
# By the names of engines: what begins a remark, and the lines, with numbers by their names.
_BY_FREQUENCY = {
    "box2d": (
        "b2DistanceJointDef def = b2DefaultDistanceJointDef();\n"
        "def.enableSpring = true;\n"
        "def.hertz = {frequency}f;\n"
        "def.dampingRatio = {damping_ratio}f;"
    ),
    "unity": (
        "SpringJoint2D joint = body.AddComponent<SpringJoint2D>();\n"
        "joint.autoConfigureDistance = false;\n"
        "joint.frequency = {frequency}f;\n"
        "joint.dampingRatio = {damping_ratio}f;"
    ),
}  # fmt: skip
_BY_MASS = {
    "godot": ("#", "var joint := DampedSpringJoint2D.new()\njoint.stiffness = {k}\njoint.damping = {c}"),
    "rapier": ("//", "RAPIER.JointData.spring(restLength, {k}, {c}, {{ x: 0, y: 0 }}, {{ x: 0, y: 0 }});"),
    "pymunk": ("#", "pymunk.DampedSpring(a, b, (0, 0), (0, 0), rest_length, stiffness={k}, damping={c})"),
    "chipmunk": ("//", "cpDampedSpringNew(a, b, cpvzero, cpvzero, rest_length, {k}, {c});"),
}


@dataclass(frozen=True)
class TakeHome:
    """The numbers of one body that another engine needs, and what to know about them.

    level: its title. chosen: the body, with Cs and Cd of a tick under `solver`. The loop is proven below demand = 4 /
    n_eff of Cs + 2 Cd, and holds says whether the level's own are. Other bodies that are joined to it must be within
    limits of their own. rows: of 1, 2, 4 and 8 substeps. trial: two particles and ten ticks. engines: by their names.
    firmness: one sentence.
    """

    level: str
    solver: str
    chosen: ChosenBody
    demand: float
    holds: bool
    rows: tuple[LoopRow, ...]
    trial: LoopTrial
    engines: dict[str, EngineNumbers]
    firmness: str


def take_home(source: Level | LevelWorld, body: str | None = None) -> TakeHome:
    """The numbers of a body of a level, or of a world as it is now; None: the first that has springs.

    Raises LevelError for a level that is not sound, NoSuchBody where there is no such body.
    """
    world = build_world(source) if isinstance(source, Level) else source
    chosen = choose_body(world, body)
    demand = BOUND / chosen.n_eff
    rows = loop_rows(chosen)
    return TakeHome(
        level=world.level.name,
        solver=world.settings.solver,
        chosen=chosen,
        demand=demand,
        holds=chosen.stiffness + 2.0 * chosen.damping < demand,
        rows=rows,
        trial=loop_trial(chosen, rows[0].equal.stiffness, rows[0].equal.damping),
        engines=engine_numbers(chosen),
        firmness=_firmness(chosen),
    )


def _firmness(body: ChosenBody) -> str:
    """How soft the body is as a whole, in the words and numbers of the panel."""
    if body.form is None or not body.mode > 0.0:
        return "Its form is not stiff without pins, so it has no firmness of its own."
    reading = read_body(body.world, body.world.forms[body.form], body.mode)
    if reading is None:
        return "Its springs have several Cs and Cd, so it has no one firmness."
    wobble = f"wobbles at {short(reading.motion.hz)} Hz with a damping ratio of {short(reading.motion.ratio)}"
    if reading.sag is None:
        return f"It {wobble}; how far it sags in the iterative solver only a run tells."
    word = word_for(reading.sag, reading.is_rigid)
    if word == "rigid":
        return "It is rigid: it does not sag."
    return f"It sags by {percent(reading.sag)} of its height where it stands ({word}), and {wobble}."


def take_home_text(source: Level | LevelWorld, body: str | None = None, to: str = "all") -> str:
    """The numbers of a body as text: for a button, from a running world, or from a level; see `take_home`.

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
            lines += [
                "", "What it prints, tick x y x y; yours should agree to nine digits.",
                "(The sandbox gives the first tick half of gravity, so that what falls is at g t^2 / 2; this loop does "
                "not.)",
                *("  " + line for line in expected(take.trial)),
            ]  # fmt: skip
    return "\n".join(lines) + "\n"


def _head(take: TakeHome) -> list[str]:
    title = f' of "{take.level}"' if take.level else ""
    chosen = take.chosen
    count = f"{len(chosen.springs)} spring" + "s" * (len(chosen.springs) != 1)
    more = f"; {chosen.others} more have other numbers" if chosen.others else ""
    rate = f"a tick of 1/{_rate(chosen.tick)} s"
    law = " (Hooke's springs, as they amount to for the lightest ends)" if chosen.hooke else ""
    solver = take.solver.replace("_", " ")
    return [
        f'"{chosen.name}"{title}: {count} of {chosen.material}{more}.',
        f"Here: Cs {short(chosen.stiffness)}, Cd {short(chosen.damping)} in {rate}, {solver} solver{law}.",
        take.firmness,
    ]


def _loop(take: TakeHome) -> list[str]:
    demand = f"Cs + 2 Cd below {short(take.demand)} in each step (4 / n_eff, n_eff {short(take.chosen.n_eff)})"
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
        *([areas] if take.chosen.has_constraints else []),
        *(_row(row) for row in take.rows),
    ]


def _row(row: LoopRow) -> str:
    steps = f"{row.substeps} substep" + "s" * (row.substeps != 1)
    own = "" if row.own == row.equal else f"; at the level's ratio {_row_pair(row.own)}"
    return f"  {steps}, h 1/{_rate(row.h)} s: {_row_pair(row.equal)}{own}"


def _row_pair(pair: LoopPair) -> str:
    numbers = f"Cs {short(pair.stiffness)}, Cd {short(pair.damping)}"
    if pair.sag is None:
        return f"{numbers}: one spring under the whole weight stretches by {percent(pair.stretch)}"
    flat = " (it lies flat)" if pair.sag >= 1.0 else ""
    return (
        f"{numbers}: sags by {percent(pair.sag)}{flat}, {short(pair.frequency)} Hz, ratio {short(pair.damping_ratio)}"
    )


def _rate(h: float) -> str:
    """How many steps of h [s] are in a second, which is a whole number."""
    return str(round(1.0 / h))


def _engine(take: TakeHome, name: str) -> list[str]:
    numbers = take.engines[name]
    softer = ". It has no areas and no bends, so this body is softer there" if take.chosen.has_constraints else ""
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


def pasted(take: TakeHome, to: str) -> str:
    """The lines for an engine or a language, by its name in `--to`; "" where the engine's springs are too soft for it.

    Raises KeyError for another name.
    """
    if to in LISTINGS:
        return listing(take.trial, to)
    numbers = take.engines[to]
    if numbers.rigid:
        return ""
    if to in _BY_FREQUENCY:
        ratio, frequency = _decimal(numbers.damping_ratio), _decimal(numbers.frequency)
        return _BY_FREQUENCY[to].format(frequency=frequency, damping_ratio=ratio)
    return _for_masses(numbers, *_BY_MASS[to])


def _for_masses(numbers: EngineNumbers, remark: str, lines: str) -> str:
    shown = numbers.masses[:PASTED_MASSES]
    parts = []
    for mass in shown:
        about = f"{remark} the {mass.springs} with a reduced mass of {short(mass.reduced_mass)} kg\n"
        code = lines.format(k=_decimal(mass.k), c=_decimal(mass.c))
        parts.append(about + code if len(numbers.masses) > 1 else code)
    return "\n".join(parts)


def _decimal(value: float) -> str:
    """A number with three digits that every language takes as a float."""
    text = short(value)
    return text if "." in text or "e" in text else f"{text}.0"
