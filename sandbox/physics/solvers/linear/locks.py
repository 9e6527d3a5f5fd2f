"""Locks that compiled kernels wait for: the interpreter's own, which every platform has and which need no GIL."""

import ctypes

from sandbox.physics import jit
from sandbox.physics.jit import inner_kernel, interpreter_function

_NAMES = ("allocate_lock", "free_lock", "acquire_lock", "release_lock")
_acquire = interpreter_function("PyThread_acquire_lock", "intc", "voidptr", "intc")
_release = interpreter_function("PyThread_release_lock", "void", "voidptr")


def has_locks() -> bool:
    """Whether there are any: interpreted kernels never wait for one another."""
    return jit.COMPILED and all(hasattr(ctypes.pythonapi, f"PyThread_{name}") for name in _NAMES)


@inner_kernel
def take(lock: int, wait: int) -> bool:
    """Take a lock; wait for it if `wait` is 1. False: another thread has it."""
    return _acquire(lock, wait) == 1


@inner_kernel
def give(lock: int) -> None:
    """Release a lock, so that any thread can take it."""
    _release(lock)


class Lock:
    """A lock for `take` and `give`, taken at first.

    handle: its address, for kernels. It lasts as long as this object.
    """

    def __init__(self) -> None:
        allocate, acquire = ctypes.pythonapi.PyThread_allocate_lock, ctypes.pythonapi.PyThread_acquire_lock
        allocate.restype = ctypes.c_void_p
        self.handle: int = allocate()
        acquire(ctypes.c_void_p(self.handle), 0)

    def give(self) -> None:
        """As `give` in kernels."""
        ctypes.pythonapi.PyThread_release_lock(ctypes.c_void_p(self.handle))

    def __del__(self) -> None:
        ctypes.pythonapi.PyThread_free_lock(ctypes.c_void_p(self.handle))
