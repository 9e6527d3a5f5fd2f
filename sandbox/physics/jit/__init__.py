"""The only place that knows how kernels run: from a library, or interpreted.

Kernels run from the library of this platform. Where their sources were edited, or there is none, zig compiles them once
and keeps them; where zig is not installed, or does not take them, they are interpreted. One line says so.
SANDBOX_KERNELS chooses: library; generic, which any processor of this kind runs; checked, which is compiled here and
ends the process at an index out of range and at what C++ leaves undefined; interpreted. COMPILED says whether they are
not interpreted.

A kernel costs nothing until it is called: before the first call of one, or the first question for COMPILED, nothing is
made of any, and no library is opened.
"""

import importlib
import os
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass
from types import BuiltinFunctionType, FunctionType, ModuleType
from typing import Any, TypeVar, cast

from sandbox.physics.jit import interpreted
from sandbox.processors import cores

Function = TypeVar("Function", bound=Callable[..., Any])

COMPILED: bool
# In kernels: the items of a bundle, as they were given to it.
unpack = interpreted.unpack
Bundle = interpreted.Bundle
# In kernels: set a field of a named tuple in a bundle to another array, or named tuple of arrays.
set_field: Any = interpreted.set_field
# In kernels: the head of a loop whose items threads may share, parallel(items, work). Its body is one call of a kernel,
# which writes what is its item's alone; what items find together is summed afterwards. work: about as many
# multiplications as there are in all, which alone decide whether a loop is worth sharing.
parallel: Any = interpreted.parallel
# In kernels: arrays in the memory of another, an int64 array, from an item on; (memory, first, rows) or, for rows of
# some width, (memory, first, rows, width).
slots_in: Any = interpreted.slots_in
slot_rows_in: Any = interpreted.slot_rows_in
floats_in: Any = interpreted.floats_in
float_rows_in: Any = interpreted.float_rows_in
float_tables_in: Any = interpreted.float_tables_in
flags_in: Any = interpreted.flags_in
int32s_in: Any = interpreted.int32s_in
ArenaLayout = interpreted.ArenaLayout

# Functions, of which it is looked up which kernel they run.
_PLAIN = (FunctionType, BuiltinFunctionType)
_WAYS = ("library", "generic", "checked", "interpreted")
_WISH = "SANDBOX_KERNELS"
_THREADS = "SANDBOX_THREADS"
MOST_THREADS = 8
# Multiplications of a loop that threads share: with fewer, to hand them out costs more than it saves.
WORTH_SHARING = 300_000
# The module that makes kernels, and how they run.
_maker: Any = None
_way = ""
# Threads that share loops, 0: not chosen yet; and of how many multiplications.
_threads, _worth = 0, WORTH_SHARING
_making = threading.RLock()


@dataclass(eq=False)
class Kernel:
    """One kernel of this process.

    held: what modules hold of it: an `Entry`, or what runs it; of what only kernels call, the function itself.
    """

    role: str
    function: Callable[..., Any]
    held: Any = None

    @property
    def name(self) -> str:
        """Module and function."""
        return f"{self.function.__module__}.{self.function.__qualname__}"

    def ready(self) -> Any:
        """The function that runs it, made at the first call; modules that hold the kernel by its name hold this from
        now on.
        """
        with _making:
            if isinstance(self.held, Entry):
                made = _chosen().make(self)
                if type(made) in _PLAIN:
                    _BY_FUNCTION[made] = self
                for module in _modules(self.function.__module__):
                    if vars(module).get(self.function.__name__) is self.held:
                        setattr(module, self.function.__name__, made)
                self.held = made
        return self.held


class Entry:
    """The object that modules hold in place of a kernel, until Python first calls it."""

    def __init__(self, kernel: Kernel) -> None:
        self._kernel = kernel

    def __call__(self, *arguments: Any) -> Any:
        return self._kernel.ready()(*arguments)


KERNELS: list[Kernel] = []
_BY_FUNCTION: dict[Any, Kernel] = {}


def kernel_of(held: Any) -> Kernel | None:
    """The kernel behind a function that modules hold, or the kernel itself; None for anything else."""
    return _BY_FUNCTION.get(held) if type(held) in _PLAIN else getattr(held, "_kernel", None)


def _modules(*homes: str) -> list[ModuleType]:
    """Modules of this package that are imported, or being imported, and others by name."""
    package = __name__.partition(".")[0]
    names = [name for name in list(sys.modules) if name.startswith(package) and name.partition(".")[0] == package]
    return [one for one in map(sys.modules.get, {*names, *homes}) if type(one) is ModuleType]


def _wish() -> str:
    """How kernels are to run."""
    wish = os.environ.get(_WISH, "") or "library"
    if wish not in _WAYS:
        say(f"{_WISH} is {', '.join(_WAYS[:-1])} or {_WAYS[-1]}, not {wish!r}: library is taken")
        return "library"
    return wish


def say(line: str) -> None:
    """Tell a line to whoever started this process."""
    if sys.stderr is not None:  # a program without a console has none
        print(line, file=sys.stderr)


def _choose(wish: str) -> Any:
    global _maker, _way, COMPILED
    if wish != "interpreted":
        library = importlib.import_module(f"{__name__}.library")
        try:
            library.open_library(wish)
        except library.NoLibrary as fault:
            say(f"{fault}: kernels are interpreted, a hundred times slower")
            wish = "interpreted"
    _way = wish
    _maker = importlib.import_module(f"{__name__}.{'interpreted' if wish == 'interpreted' else 'library'}")
    _maker.use_threads(threads(), _worth)
    COMPILED = _maker.COMPILED
    return _maker


def _chosen() -> Any:
    return _maker or _choose(_wish())


def way() -> str:
    """How kernels run in this process: "library", "generic", "checked" or "interpreted"."""
    _chosen()
    return _way


def threads() -> int:
    """How many threads share the loops of a tick."""
    global _threads
    if not _threads:
        _threads = usual_threads()
    return _threads


def usual_threads() -> int:
    """How many share them until another number is chosen: by SANDBOX_THREADS, or one less than there are cores."""
    wish = os.environ.get(_THREADS, "")
    if wish.isdecimal() and 1 <= int(wish) <= MOST_THREADS:
        return int(wish)
    if wish:
        say(f"{_THREADS} is a number from 1 to {MOST_THREADS}, not {wish!r}: it is left out")
    return max(1, min(cores() - 1, MOST_THREADS))


def work_beside_others() -> None:
    """Share no loop in this process, one of several that work at once, unless SANDBOX_THREADS says so."""
    os.environ.setdefault(_THREADS, "1")
    use_threads(usual_threads())


def use_threads(count: int, worth: int = WORTH_SHARING) -> None:
    """Choose how many threads share the loops of a tick; the bits are the same with any number.

    worth: multiplications of a loop that is shared.

    Raises:
        ValueError: for a number that is not from 1 to MOST_THREADS.
    """
    global _threads, _worth
    if not 1 <= count <= MOST_THREADS:
        raise ValueError(f"{count} threads: a number from 1 to {MOST_THREADS} is wanted")
    _threads, _worth = count, worth
    if _maker is not None:
        _maker.use_threads(count, worth)


def threads_started() -> int:
    """Threads beside those of Python that were started in this process."""
    return int(_chosen().threads_started())


def __getattr__(name: str) -> Any:
    if name == "COMPILED":
        return _chosen().COMPILED
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def entries() -> list[Kernel]:
    """The kernels that Python calls."""
    return [kernel for kernel in KERNELS if kernel.role == "kernel"]


def _made(role: str, function: Function) -> Function:
    kernel = Kernel(role, function)
    kernel.held = Entry(kernel) if role == "kernel" else function
    KERNELS.append(kernel)
    _BY_FUNCTION[function] = kernel
    return cast(Function, kernel.held)


def kernel(function: Function) -> Function:
    """Make `function` a kernel: scalars, contiguous arrays, named tuples of arrays, bundles in; same bits both ways."""
    return _made("kernel", function)


def inner_kernel(function: Function) -> Function:
    """Make `function` a part of kernels, compiled with each that calls it: sooner, with no entry for Python."""
    return _made("inner_kernel", function)


def inlined_kernel(function: Function) -> Function:
    """Make `function` a part of kernels that is written into them: no call, which copies every array's shape."""
    return _made("inlined_kernel", function)


def scalar_kernel(function: Function) -> Function:
    """Make `function`, which takes and gives scalars alone, a part of kernels that Python calls too, interpreted."""
    return _made("scalar_kernel", function)


def bundle(items: tuple[Any, ...], like: Any = None) -> Any:
    """One argument for kernels in place of many that stay: arrays, and named tuples of them, there its unpack.

    like: a bundle that is much the same; what is in both costs nothing again.

    Otherwise a kernel unwraps each array at every call: 60 of them take 8 us, as long as 80 links of a rope. The bundle
    holds what it was made of; a copy of it would not.

    Raises:
        TypeError: for what is neither array nor tuple, and for arrays that are not contiguous.
    """
    return _chosen().bundle(items, like)


def hold(bundle: Any, memory: Any) -> None:
    """Keep an array alive as long as a bundle: kernels lay out in it what they set in the bundle."""
    _chosen().hold(bundle, memory)


def items_of(bundle: Any, path: tuple[str, ...] = ()) -> Any:
    """The items of a bundle as they are now, which kernels may have put others in place of.

    path: names of fields that lead to the tuple that is wanted.
    """
    return _chosen().items_of(bundle, path)
