"""Records the solutions of shipped levels: python -m tests.solutions [LEVEL ... | --flips]    (default: all of them)

Each is what a person does in the window, by times [s] and places [m]. Record them again after a change of what a tick
computes (a new physics version), or of a level.
"""

import random
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

from sandbox.app.share.page import so_far
from sandbox.level.format.slices import at_once
from sandbox.level.plan.actuators import driving_keys
from sandbox.level.reading.files import load_level, shipped_levels
from sandbox.physics.analysis.query import grip_radius
from sandbox.session.commands import AddBody
from sandbox.session.commands.records import from_record
from sandbox.session.outcome import MOST_STARS, outcome
from sandbox.session.session import Session
from sandbox.session.solution import keep_solution
from sandbox.tools.dropping import PARTS

# Records of commands, each with its time [s], that are one gesture.
Gesture = list[tuple[float, dict[str, Any]]]
# From one move of a hand to the next, how long the window takes to make a body softer or firmer, and how long a run
# goes on that nobody wins [s].
MOVE, RAMP, LONGEST = 0.05, 1.25, 300.0
# How long a flipper stays up, and when the last flip is [s].
FLIP, LAST_FLIP = 0.2, 24.0


def drag(particle: str, *path: tuple[float, float, float], strength: float = 100.0) -> Gesture:
    """Take a particle at the first of the points (time, x, y), pull it from each straight to the next, and let go."""
    (start, *place), end = path[0], path[-1][0]
    found: Gesture = [(start, {"type": "grab", "grab": 0, "particle": particle, "target": place, "strength": strength})]
    for (begin, *here), (then, *there) in pairwise(path):
        steps = max(round((then - begin) / MOVE), 1)
        for share in ((step + 1) / steps for step in range(steps)):
            target = [round(a + share * (b - a), 4) for a, b in zip(here, there, strict=True)]
            found.append((begin + share * (then - begin), {"type": "move_grab", "grab": 0, "target": target}))
    return [*found, (end, {"type": "release", "grab": 0})]


def drive(part: str, value: float, start: float, end: float) -> Gesture:
    """Hold the key of a motor or a hydraulic."""
    return [(time, {"type": "set_drive", "part": part, "value": one}) for time, one in ((start, value), (end, 0.0))]


def ahead(*spans: tuple[float, float]) -> list[Gesture]:
    """Hold the key that drives both wheels of a truck, from one time to another, each time."""
    return [drive(f"{wheel} wheel", 1.0, *span) for span in spans for wheel in ("rear", "front")]


def block(time: float, x: float, y: float, width: float, height: float) -> Gesture:
    """Put a box as the strip of parts has it, as wide and high as that."""
    part = PARTS["box"].make(height, (x, y), (0.0, 0.0), "")
    assert isinstance(part, AddBody)
    return [(time, {"type": "add_body", "body": {**part.body, "shape": {"box": [width, height]}}})]


def press(key: str, start: float, end: float) -> Gesture:
    """Hold a key that a rule asks for."""
    return [(time, {"type": "hold_key", "key": key, "down": down}) for time, down in ((start, True), (end, False))]


def flips(seed: int) -> list[Gesture]:
    """Let the first ball of `pinball_score` go, and flip now and then; `--flips` finds seeds that earn three stars."""
    chance, time = random.Random(seed), 1.0
    found = [drive("left flipper", 1.0, 0.5, 0.6)]
    while time < LAST_FLIP:
        side, time = chance.choice(("left", "right")), round(time, 2)
        found.append(drive(f"{side} flipper", 1.0, time, time + FLIP))
        time += chance.uniform(0.6, 1.6)
    return found


def firmness(time: float, body: str, hz: float) -> Gesture:
    """Make a body softer or firmer by a word of the panel, which sends what the body then wobbles at."""
    return [(time, {"type": "set_firmness", "body": body, "hz": hz, "duration": round(60 * RAMP)})]


def material(time: float, name: str, **coefficients: float) -> Gesture:
    """Type Cs or Cd of a material."""
    return [(time, {"type": "set_coefficients", "material": name, **coefficients, "duration": round(60 * RAMP)})]


def lift(particle: str, start: float, x: float, over: float) -> Gesture:
    """Carry a crate of `ferry` from its place to another, high enough over what lies between."""
    times = (start + share for share in (0.0, 1.0, 2.5, 3.5))
    places = ((x, 1.05), (x, 2.6), (over, 2.6), (over, 1.2))
    return drag(particle, *((time, *place) for time, place in zip(times, places, strict=True)))


# What wins each level.
SOLUTIONS: dict[str, list[Gesture]] = {
    # The words are jelly and firm. Jelly passes the gap and stays where it falls; firm again, it rolls.
    "squeeze": [firmness(3.0, "ball", 1.317), firmness(12.0, "ball", 5.69)],
    "trampoline_basket": [material(1.0, "bed", stiffness=0.4), press("d", 3.0, 3.2)],
    "basket_throw": [drag("ball", (1.0, -5.0, 0.4), (2.0, -6.5, 1.0), (2.5, -6.5, 1.0), (3.0, -1.75, 6.0))],
    "chain_of_events": [drag("marble", (1.0, -8.85, 6.15), (1.3, -8.4, 6.3), (1.5, -7.9, 6.2))],
    # The first press lets the crates go; then the flap is up while blue crates pass.
    "sorting_belt": [
        drive(":0", 1.0, 1.0, 1.2), drive(":0", 1.0, 5.9, 11.4), drive(":0", 1.0, 14.4, 17.6),
    ],
    # The crates go in from the far end of the boat, and out from the near one.
    "ferry": [
        lift("crate 3.4", 1.0, -6.6, -3.8), lift("crate 2.4", 5.0, -7.9, -2.65), lift("crate 1.4", 9.0, -9.2, -1.5),
        drag("boat.21", (13.0, -2.7, 0.5), (21.0, 2.6, 0.5), (21.5, 2.6, 0.5)),
        lift("crate 1.4", 22.0, 3.4, 9.2), lift("crate 2.4", 26.0, 2.3, 7.9), lift("crate 3.4", 30.0, 1.2, 6.5),
    ],
    "egg_drop": [firmness(1.0, "cushion", 1.279), press("d", 3.5, 3.7)],
    "low_door": [material(1.0, "deck", stiffness=0.25), *ahead((3.0, 11.0))],
    "catapult_practice": [material(1.0, "thread", stiffness=0.16), drive(":0", 1.0, 3.0, 5.0)],
    "bridge_budget": [block(1.0, 0.0, -1.0, 6.0, 1.9), *ahead((3.0, 10.0))],
    # Slowly over the crests.
    "truck_course": ahead((0.3, 1.65), (2.25, 3.75), (4.8, 7.05), (7.95, 13.2)),
    # Up, over the wall, down once it hardly swings, and let go.
    "crane": [
        drive(":1", -1.0, 1.0, 5.0), drive(":0", -1.0, 4.0, 6.6), drive(":1", 1.0, 9.2, 10.5), press("c", 12.5, 12.7),
    ],
    "pinball_score": flips(149),
}  # fmt: skip


def play(session: Session, gestures: list[Gesture], longest: float = LONGEST) -> None:
    """Do all of it, until the level is won or lost, or for so long [s]."""
    rate = session.level.settings.tick_rate
    lines = sorted(
        ((round(time * rate), number, record) for number, each in enumerate(gestures) for time, record in each),
        key=lambda line: line[:2],
    )
    numbers = [session.new_gesture() for _ in gestures]
    while outcome(session.level, session.world) is None and session.tick < longest * rate:
        while lines and lines[0][0] == session.tick:
            _, number, record = lines.pop(0)
            if record["type"] == "grab":
                slot = session.world.particle_slot(record["particle"])
                record = {**record, "radius": grip_radius(session.world, slot)}
            for each in (record, *rule_keys_of(record, session)):
                session.submit(from_record(each, session.world), numbers[number])
        session.advance()


def rule_keys_of(record: dict[str, Any], session: Session) -> list[dict[str, Any]]:
    """What the key that drives a part tells rules that ask for it too."""
    if record["type"] != "set_drive":
        return []
    world, down = session.world, record["value"] != 0.0
    part = world.actuators.names.index(record["part"])
    driven = driving_keys(session.level)
    keys = [key for key in world.rule_keys if any(part == number for number, _ in driven.get(key, []))]
    return [
        {"type": "hold_key", "key": key, "down": down}
        for key in keys
        if down != bool(world.key_down[world.rule_keys.index(key)])
    ]


def record(path: Path, gestures: list[Gesture]) -> str:
    """Record a level's solution beside its file; how it ended, in words. Raises ValueError if it does not win."""
    session = Session(load_level(path.stem))
    play(session, gestures)
    # That a spring breaks is no fault.
    faults = [line for line in session.messages if not line.endswith(" broke")]
    kept = None if faults else at_once(keep_solution(path, so_far(session).script, session.tick))
    if kept is None or not kept.passed:
        raise ValueError(f"{path.stem}: not won: {[*faults, kept and kept.text]}")
    return kept.text


def seeds_of_flips() -> None:
    """Print which seeds of `flips` earn three stars, and how many points."""
    for seed in range(200):
        session = Session(load_level("pinball_score"))
        play(session, flips(seed))
        found = outcome(session.level, session.world)
        if found is not None and found.stars == MOST_STARS:
            print(seed, session.world.counter[0], flush=True)


def main(names: list[str]) -> None:
    """Record the solutions of the levels of these names, of all where there are none; or look for flips."""
    if names == ["--flips"]:
        seeds_of_flips()
        return
    paths = {path.stem: path for path in shipped_levels()}
    for name in names or SOLUTIONS:
        print(name, record(paths[name], SOLUTIONS[name]), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
