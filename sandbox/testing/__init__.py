"""For tests of levels and recordings: a plugin of pytest, loaded wherever the package is installed, and the Driver.

The names load on first use, as pytest loads this package at every start.
"""

from typing import TYPE_CHECKING, Any

__all__ = ["Driver", "NotReached", "SandboxSession"]

if TYPE_CHECKING:
    from sandbox.testing.driver import Driver, NotReached, SandboxSession


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'sandbox.testing' has no attribute {name!r}")
    from sandbox.testing import driver

    return getattr(driver, name)


def __dir__() -> list[str]:
    return sorted(__all__)
