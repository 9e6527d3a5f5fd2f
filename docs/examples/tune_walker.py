"""A creature learns to walk faster: a loop turns its two knobs, the swing of its muscles and their period.

```sh
python docs/examples/tune_walker.py 5        # seconds that it walks; 5 unless told otherwise
```
"""

import sys

from sandbox import Level, Session, load_level
from sandbox.bodies import MuscleDef


def tuned(level: Level, amplitude: float, period: int) -> Level:
    """The level with every muscle swinging so far [share of its length], so often [ticks]; phases stay."""
    legs = [
        leg.model_copy(update={"drive": MuscleDef(amplitude=amplitude, period=period, phase=leg.drive.phase)})
        for leg in level.springs
        if leg.drive is not None
    ]
    return level.model_copy(update={"springs": tuple(legs)})


def distance(level: Level, seconds: float) -> float:
    """How far [m] the creature gets to the right in this time; nothing where it has fallen over."""
    session = Session(level)
    position, nose, back = session.world.position, *map(session.world.particle_slot, ("body.4", "body.6"))
    start, height = position[nose, 0], position[back, 1]
    for _ in range(round(seconds * level.settings.tick_rate)):
        session.advance()
    position = session.world.position
    return float(position[nose, 0] - start) if position[back, 1] > 0.5 * height else 0.0


def main() -> None:
    """Try the neighbours of the best setting so far, as long as one is better."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 5.0
    level = load_level("walker")
    muscle = next(leg.drive for leg in level.springs if leg.drive is not None)
    born = muscle.amplitude, muscle.period
    tried = {born: distance(level, seconds)}
    best = born
    while True:
        amplitude, period = best
        for knobs in (
            (amplitude, period - 10), (round(amplitude + 0.04, 2), period), (amplitude, period + 10),
            (round(amplitude - 0.04, 2), period),
        ):  # fmt: skip
            if knobs not in tried and 0.0 < knobs[0] <= 0.4 and knobs[1] >= 20:
                tried[knobs] = distance(tuned(level, *knobs), seconds)
                print(f"swing {knobs[0]:.2f}, period {knobs[1]:3} ticks: {tried[knobs]:6.2f} m")
        if tried[best] >= max(tried.values()):
            break
        best = max(tried, key=lambda knobs: tried[knobs])
    print(f"In {seconds:g} s it was born to walk {tried[born]:.2f} m, and has learnt to walk {tried[best]:.2f} m.")


if __name__ == "__main__":
    main()
