"""How large what a tool works with is, and how the person makes it larger or smaller."""

# A step of the wheel makes it this many times larger; sizes [m] that it may have.
SIZE_STEP, SMALLEST, LARGEST = 1.1, 0.02, 100.0
# The part of the view's height that it is at first.
SIZE_SHARE = 0.12


def usual_size(height: float) -> float:
    """How large [m] things are at first in a view of a height [m]."""
    return float(f"{SIZE_SHARE * height:.2g}")


class Sized:
    """A tool that works at a size [m], which it hands on to the next such tool."""

    size: float

    def take_up(self, size: float, height: float) -> None:
        """Begin at a size that the view has room for."""
        self.size = size

    @property
    def size_to_share(self) -> float | None:
        """The size [m]."""
        return self.size

    def resize(self, steps: float) -> bool:
        """Make it larger, by steps of the wheel."""
        self.size = resized(self.size, steps)
        return True


def resized(size: float, steps: float) -> float:
    """A size made larger by this many steps of the wheel."""
    return min(max(size * SIZE_STEP**steps, SMALLEST), LARGEST)
