"""What speeds are called."""


def words_of(speed: float) -> str:
    """A speed for a button: 1/2x, 4x, -1x."""
    return f"{speed:g}x" if abs(speed) >= 1.0 else f"1/{round(1 / speed)}x"


def state_of(speed: float) -> str:
    """A speed in words, for the status line."""
    if speed < 0.0:
        return "backwards" if speed == -1.0 else f"backwards {-speed:g}x"
    if speed == 1.0:
        return "playing"
    return f"fast {speed:g}x" if speed > 1.0 else f"slow motion 1/{round(1 / speed)}"
