"""How large what a tool works with is, and how the person makes it larger or smaller."""

# A step of the wheel makes it this many times larger; sizes [m] that it may have.
SIZE_STEP, SMALLEST, LARGEST = 1.1, 0.02, 100.0


def resized(size: float, steps: float) -> float:
    """A size made larger by this many steps of the wheel."""
    return min(max(size * SIZE_STEP**steps, SMALLEST), LARGEST)
