"""Where the window stood, and how large it was, from start to start."""

from sandbox.editor.storage.preferences import preference, set_preference

# Under what it is remembered.
KEPT = "window"


def kept_window() -> list[int] | None:
    """Left, top, width and height of the window of the last time [pixels]; None where nothing usable is remembered."""
    kept = preference(KEPT)
    is_place = isinstance(kept, list) and len(kept) == 4 and all(type(side) is int for side in kept)
    return kept if is_place and abs(kept[0]) + abs(kept[1]) < 1 << 20 and min(kept[2:]) > 0 else None


def keep_window(place: list[int] | None) -> None:
    """Remember left, top, width and height of the window; None leaves what was remembered."""
    if place is not None:
        set_preference(KEPT, place)
