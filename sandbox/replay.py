"""Replays: recordings read back, and verified bit for bit.

`Session.record_to(path)` writes one; `docs/determinism.md` says what is promised of them.
"""

from sandbox.session.replay.divergence import Divergence
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.replay.verify import Comparison, compare, verify

__all__ = ["Comparison", "Divergence", "Replay", "ReplayError", "compare", "read_replay", "verify"]
