"""Strokes as a hand draws them around something: more or less round, more or less rough, and some that run over."""

import math
import random


def rough_stroke(generator: random.Random) -> list[float]:
    """Numbers of the mesher of strokes: tolerance [m], least area [m^2], and places [m]."""
    count, size, rough = generator.randint(8, 60), generator.uniform(0.1, 2.0), generator.uniform(0.0, 0.8)
    x, y, flat = generator.uniform(-4.0, 4.0), generator.uniform(0.0, 3.0), generator.uniform(0.2, 1.0)
    numbers = [0.03 * size, 0.01]
    for k in range(count + generator.randint(0, 2)):
        turn, radius = math.tau * k / count, size * (1.0 - rough * generator.random())
        numbers += [x + radius * math.cos(turn), y + flat * radius * math.sin(turn)]
    return numbers
