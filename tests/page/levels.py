"""Pages of shipped levels, made once for all tests of a process."""

from functools import cache

from sandbox import load_level
from sandbox.app.share.playing import page_of

# One of each kind: ropes, bars, balls, motors with terrain, muscles, bumpers, jellies, cloth.
LEVELS = (
    "rope", "truss_bridge", "newtons_cradle", "suspension_car", "walker", "pinball", "jelly_wheel", "curtain",
)  # fmt: skip


@cache
def level_page(name: str) -> str:
    """The page of a shipped level."""
    return page_of(load_level(name))
