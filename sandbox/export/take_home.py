"""Take home: what a body's springs are in the article's loop and in other engines, as numbers."""

from dataclasses import dataclass

from sandbox.export.chosen_body import ChosenBody, choose_body
from sandbox.export.engines import EngineNumbers, engine_numbers
from sandbox.export.loops import LoopTrial, loop_trial
from sandbox.export.numbers import percent, short
from sandbox.export.proven import LoopRow, loop_rows
from sandbox.level.assembly.build_world import build_world
from sandbox.level.assembly.level_world import LevelWorld
from sandbox.level.document.model import Level
from sandbox.physics.analysis.stability import BOUND
from sandbox.physics.softness.body_motion import read_body, word_for


@dataclass(frozen=True)
class TakeHome:
    """All that is taken home of one body.

    level: its title. material: its name. springs: how many are of it. others: how many of the body's are not, as they
    have other numbers. stiffness, damping: Cs and Cd of a tick of h [s] under `solver`. hooke: whether k and c were
    given instead. n_eff: see stability.py; the loop is proven below demand = 4 / n_eff of Cs + 2 Cd, and holds says
    whether the level's own are. Other bodies that are joined to it must be within limits of their own. has_constraints:
    whether areas or bends hold it too. rows: of 1, 2, 4 and 8 substeps. trial: two particles and ten ticks. engines:
    by their names. firmness: one sentence.
    """

    level: str
    body: str
    material: str
    springs: int
    others: int
    solver: str
    h: float
    stiffness: float
    damping: float
    hooke: bool
    n_eff: float
    demand: float
    holds: bool
    has_constraints: bool
    rows: tuple[LoopRow, ...]
    trial: LoopTrial
    engines: dict[str, EngineNumbers]
    firmness: str


def take_home(source: Level | LevelWorld, body: str | None = None) -> TakeHome:
    """What a body of a level, or of a world as it is now, takes home; None: the first that has springs.

    Raises LevelError for a level that is not sound, NoSuchBody where there is no such body.
    """
    world = build_world(source) if isinstance(source, Level) else source
    chosen = choose_body(world, body)
    demand = BOUND / chosen.n_eff
    rows = loop_rows(chosen)
    return TakeHome(
        level=world.level.name,
        body=chosen.name,
        material=chosen.material,
        springs=len(chosen.springs),
        others=chosen.others,
        solver=world.settings.solver,
        h=chosen.tick,
        stiffness=chosen.stiffness,
        damping=chosen.damping,
        hooke=chosen.hooke,
        n_eff=chosen.n_eff,
        demand=demand,
        holds=chosen.stiffness + 2.0 * chosen.damping < demand,
        has_constraints=chosen.has_constraints,
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
