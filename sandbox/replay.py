"""Replays: recordings read back, verified bit for bit, and searched for failures.

`Session.record_to(path)` writes one; `docs/determinism.md` says what is promised of them.
"""

from sandbox.session.compare.comparison import Comparison, compare, verify
from sandbox.session.compare.divergence import Divergence
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.shrink.failures import (
    CheckFails,
    Crashes,
    Diverges,
    EnergyGrows,
    Failure,
    FailureError,
    FailureSeen,
    FailureWatch,
    Freezes,
    IsLost,
    Leaves,
)
from sandbox.session.shrink.shrinker import find_failure

__all__ = [
    "CheckFails",
    "Comparison",
    "Crashes",
    "Divergence",
    "Diverges",
    "EnergyGrows",
    "Failure",
    "FailureError",
    "FailureSeen",
    "FailureWatch",
    "Freezes",
    "IsLost",
    "Leaves",
    "Replay",
    "ReplayError",
    "compare",
    "find_failure",
    "read_replay",
    "verify",
]
