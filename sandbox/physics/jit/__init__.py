"""The only place that knows libraries of kernels, and numba.

Kernels run from the library of this platform. Where there is none, or the sources of kernels were edited, numba
compiles them, with a disk cache; where numba is missing or does not work with this Python or numpy, they are
interpreted. One line says so. SANDBOX_KERNELS chooses: library, numba or interpreted; where NUMBA_DISABLE_JIT is set,
and after `start_interpreted`, they are interpreted. COMPILED says whether they are not.

A kernel costs nothing until it is called: before the first call of one, or the first question for COMPILED, nothing is
made of any, and neither a library nor numba is opened.
"""

import importlib
import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import BuiltinFunctionType, FunctionType, ModuleType
from typing import Any, TypeVar, cast

from sandbox.physics.jit import interpreted

Function = TypeVar("Function", bound=Callable[..., Any])

COMPILED: bool
# Turns an index that is never negative into one that loops are vectorised for: of a signed one numba first asks whether
# it counts from the end. Never mix the two in one sum: that makes a float.
unsigned: Any = interpreted.unsigned
# In kernels: the items of a bundle, as they were given to it.
contents: Any = interpreted.contents
# In kernels: write an array, or a named tuple of arrays, in place of what a lent named tuple has by that name.
put: Any = interpreted.put
# In kernels: arrays in the memory of another, an int64 array, from an item on; (memory, first, rows) or, for rows of
# some width, (memory, first, rows, width).
slots_in: Any = interpreted.slots_in
slot_rows_in: Any = interpreted.slot_rows_in
floats_in: Any = interpreted.floats_in
float_rows_in: Any = interpreted.float_rows_in
float_tables_in: Any = interpreted.float_tables_in
flags_in: Any = interpreted.flags_in
int32s_in: Any = interpreted.int32s_in

# Functions, of which it is looked up which kernel they run.
_PLAIN = (FunctionType, BuiltinFunctionType)
# Which way kernels are made, by its name for people, and the module that makes them.
_WAYS = {"library": "library", "numba": "compiled", "interpreted": "interpreted"}
_WISH = "SANDBOX_KERNELS"
_way: Any = None
_recording = False
_making = threading.RLock()


@dataclass(eq=False)
class Kernel:
    """One kernel of this process.

    held: what modules hold of it: an `Entry`, or what runs it; of what only kernels call, the function itself.
    signatures: types of arguments, by their text, that calls were noted with, of an interpreted one. part: what other
    kernels are compiled with, once one is that calls it.
    """

    role: str
    function: Callable[..., Any]
    held: Any = None
    signatures: dict[str, tuple[Any, ...]] = field(default_factory=dict)
    part: Any = None

    @property
    def name(self) -> str:
        """Module and function."""
        return f"{self.function.__module__}.{self.function.__qualname__}"

    def note(self, *arguments: Any) -> None:
        """While calls are recorded: remember the types of these arguments."""
        if _recording:
            types = importlib.import_module(f"{__name__}.compiled").types_of(arguments)
            self.signatures[str(types)] = types

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
    """The kernel that this is, or what runs it; None for anything else."""
    return _BY_FUNCTION.get(held) if type(held) in _PLAIN else getattr(held, "_kernel", None)


def _modules(*homes: str) -> list[ModuleType]:
    """Those of this package that are imported, or being imported, and others by name."""
    package = __name__.partition(".")[0]
    names = [name for name in list(sys.modules) if name.startswith(package) and name.partition(".")[0] == package]
    return [one for one in map(sys.modules.get, {*names, *homes}) if type(one) is ModuleType]


def _can_compile() -> bool:
    try:
        importlib.import_module(f"{__name__}.lending")
    except (ImportError, AttributeError):  # also of a numba that is too old for this numpy, or has other inner parts
        return False
    return True


def _best() -> str:
    """The way that is wished for; else the best that there is, with one line if that is no library."""
    wish = os.environ.get(_WISH, "")
    if wish == "interpreted" or os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        return "interpreted"
    if wish and wish not in _WAYS:
        _say(f"{_WISH} is {', '.join(_WAYS)}, not {wish!r}")
    why = f"{_WISH} is {wish}"
    if wish != "numba":
        library = importlib.import_module(f"{__name__}.library")
        try:
            library.open_library()
        except library.NoLibrary as fault:
            why = str(fault)
        else:
            return "library"
    way = "numba" if _can_compile() else "interpreted"
    if way != wish:
        does = "numba compiles kernels, once" if way == "numba" else "kernels are interpreted, a hundred times slower"
        _say(f"{why}: {does}")
    return way


def _say(line: str) -> None:
    if sys.stderr is not None:  # a program without a console has none
        print(line, file=sys.stderr)


def _choose(way: str) -> Any:
    global _way, COMPILED
    _way = importlib.import_module(f"{__name__}.{_WAYS[way]}")
    COMPILED = _way.COMPILED
    return _way


def _chosen() -> Any:
    return _way or _choose(_best())


def way() -> str:
    """How kernels run in this process: "library", "numba" or "interpreted"."""
    chosen = _chosen().__name__.rpartition(".")[2]
    return next(name for name, module in _WAYS.items() if module == chosen)


def __getattr__(name: str) -> Any:
    if name == "COMPILED":
        return _chosen().COMPILED
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def start_interpreted() -> None:
    """Interpret kernels in this process.

    Raises:
        RuntimeError: where they run in another way already.
    """
    if _way is not None and _way.COMPILED:
        raise RuntimeError("kernels are compiled already")
    _choose("interpreted")


@contextmanager
def recorded() -> Iterator[None]:
    """While this lasts, interpreted kernels that are called note the types of their arguments."""
    global _recording
    _recording = True
    try:
        yield
    finally:
        _recording = False


def entries() -> list[Kernel]:
    """The kernels that Python calls."""
    return [kernel for kernel in KERNELS if kernel.role == "kernel"]


def precompile(held: Any, *arguments: Any) -> None:
    """Compile a kernel for such arguments, or load it, as a call would, which is not made."""
    _chosen().precompile(cast(Kernel, kernel_of(held)), arguments)


def compile_entry(kernel: Kernel, signature: tuple[Any, ...]) -> None:
    """Let numba compile an entry for some types of arguments and keep it in its cache, however kernels run here."""
    importlib.import_module(f"{__name__}.compiled").make(kernel).compile(signature)


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
    """One argument for kernels in place of many that stay: arrays, and named tuples of them, there its `contents`.

    like: a bundle that is much the same; what is in both costs nothing again.

    Otherwise a kernel unwraps each array at every call: 60 of them take 8 us, as long as 80 links of a rope. The bundle
    holds what it was made of; a copy of it would not.

    Raises:
        TypeError: for what is neither array nor tuple, and for arrays that are not contiguous.
    """
    return _chosen().bundle(items, like)


def hold(bundle: Any, memory: Any) -> None:
    """Let an array live as long as a bundle: kernels lay out in it what they put there."""
    _chosen().hold(bundle, memory)


def items_of(bundle: Any, path: tuple[str, ...] = ()) -> Any:
    """The items of a bundle as they are now, which kernels may have put others in place of.

    path: names of fields that lead to the tuple that is wanted.
    """
    return _chosen().items_of(bundle, path)
