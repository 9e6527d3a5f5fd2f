"""Small steps: the parts of a step in which what no spring or constraint holds falls and touches."""

from sandbox.physics.jit import inlined_kernel

# A small step is no longer than this [s]: 8 of them at 60 Hz. With a quarter of them, heaps of 50 layers sink into each
# other by a seventh of a radius; twice as many double the time.
SMALL_STEP = 1.0 / 480.0
# Small steps of a step at most, where an island would sink too deep.
MOST_SMALL_STEPS = 64


@inlined_kernel
def small_steps(h: float) -> int:
    """In how many small steps what nothing holds, and no load presses, goes through one of h [s]."""
    count = 1
    while count < MOST_SMALL_STEPS and h > SMALL_STEP * count * (1.0 + 1e-9):
        count *= 2
    return count
