"""Spring Sandbox: particles and damped springs in 2D, to play, to build and to replay bit for bit.

The public names load on first use, so `import sandbox` and `sandbox --help` stay cheap.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_HOME = {
    "Level": "sandbox.level.format.model",
    "load_level": "sandbox.level.format.files",
    "build_world": "sandbox.level.build.build_world",
    "World": "sandbox.physics.world",
    "step": "sandbox.physics.step",
    "Session": "sandbox.session.session",
    "Replay": "sandbox.session.replay.recording",
}
__all__ = ["Level", "Replay", "Session", "World", "__version__", "build_world", "load_level", "step"]

if TYPE_CHECKING:
    from sandbox.level.build.build_world import build_world
    from sandbox.level.format.files import load_level
    from sandbox.level.format.model import Level
    from sandbox.physics.step import step
    from sandbox.physics.world import World
    from sandbox.session.replay.recording import Replay
    from sandbox.session.session import Session


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'sandbox' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
