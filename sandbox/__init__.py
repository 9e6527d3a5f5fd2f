"""Spring Sandbox: particles and damped springs in 2D, to play, to build and to replay bit for bit.

The public names load on first use, so `import sandbox` and `sandbox --help` stay cheap. `sandbox.commands`,
`sandbox.replay` and `sandbox.bodies` hold the rest of what programs use; nothing deeper is promised to stay.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from sandbox.version import __version__

_HOME = {
    "Level": "sandbox.level.document.model",
    "LevelError": "sandbox.level.format.level_error",
    "load_level": "sandbox.level.reading.files",
    "build_world": "sandbox.level.assembly.build_world",
    "Contact": "sandbox.level.things.contacts",
    "ContactEvents": "sandbox.level.things.contacts",
    "ContactListener": "sandbox.level.things.contacts",
    "contacts": "sandbox.level.things.contacts",
    "ThingOutline": "sandbox.level.things.outlines",
    "outlines": "sandbox.level.things.outlines",
    "Snapshot": "sandbox.physics.snapshot",
    "World": "sandbox.physics.world",
    "WorldSettings": "sandbox.physics.settings",
    "state_hash": "sandbox.physics.snapshot",
    "step": "sandbox.physics.step",
    "Session": "sandbox.session.session",
    "use_threads": "sandbox.physics.jit",
    "run_checks": "sandbox.session.check_run",
    "Replay": "sandbox.session.replay.recording",
}
__all__ = [
    "Contact",
    "ContactEvents",
    "ContactListener",
    "Level",
    "LevelError",
    "Replay",
    "Session",
    "Snapshot",
    "ThingOutline",
    "World",
    "WorldSettings",
    "__version__",
    "build_world",
    "contacts",
    "load_level",
    "outlines",
    "run_checks",
    "state_hash",
    "step",
    "use_threads",
]

if TYPE_CHECKING:
    from sandbox.level.assembly.build_world import build_world
    from sandbox.level.document.model import Level
    from sandbox.level.format.level_error import LevelError
    from sandbox.level.reading.files import load_level
    from sandbox.level.things.contacts import Contact, ContactEvents, ContactListener, contacts
    from sandbox.level.things.outlines import ThingOutline, outlines
    from sandbox.physics.jit import use_threads
    from sandbox.physics.settings import WorldSettings
    from sandbox.physics.snapshot import Snapshot, state_hash
    from sandbox.physics.step import step
    from sandbox.physics.world import World
    from sandbox.session.check_run import run_checks
    from sandbox.session.replay.recording import Replay
    from sandbox.session.session import Session


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'sandbox' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
