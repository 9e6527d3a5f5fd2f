"""Each kernel alone, compiled, against its own source interpreted: on random arguments, every bit must be the same.

Run by hand: python -m tests.determinism.twins [--rounds 60] [--seed 1] [NAME ...]

Arguments are made from a kernel's annotations: arrays of a few items, indices that are mostly there, and numbers among
which are NaN, -0.0, infinities and the ends of integers. Where the interpreter meets an index that is out of range, a
division by zero or a loop that does not end, the arguments are thrown away. Exit code 1: a bit differs.
"""

import argparse
import ctypes
import math
import random
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from sandbox.physics.jit import KERNELS, Kernel, interpreted
from sandbox.physics.jit.library import Library
from sandbox.physics.jit.making.compiling import all_entries, compiled
from sandbox.physics.jit.making.platforms import this_machine
from sandbox.physics.jit.sources import file_digest
from sandbox.physics.jit.translate.cpp_types import Array, BundleType, Scalar, Several, Struct, Type
from sandbox.physics.jit.translate.program import Signature, Translation, words_of

# Lines of Python that a call may run, and tries of arguments for each round.
MOST_LINES, TRIES = 20_000, 12
ARENA = 20_000
# Rows that arrays have at times: a kernel may go by fixed places in one.
LONG = 48
SCALARS: dict[str, Any] = {"bool": ctypes.c_bool, "int64_t": ctypes.c_int64, "double": ctypes.c_double}
NUMBERS = (0.0, -0.0, 1.0, -1.0, 0.5, 1e-300, 1e300, math.inf, -math.inf, math.nan, 3.0, 1e-9)
WHOLE = (-1, 0, 1, 2, 3, 7, 2**31, -(2**31))


class Unending(Exception):
    """A call runs longer than is waited for."""


class Strict:
    """An array for the interpreter, in which no index counts from the end."""

    def __init__(self, array: Any) -> None:
        self.array, self.view, self.shape = array, memoryview(array), array.shape

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return self.array

    def __len__(self) -> int:
        return len(self.array)

    def _looked_at(self, index: Any) -> Any:
        for one in index if isinstance(index, tuple) else (index,):
            if isinstance(one, int) and one < 0:
                raise IndexError(one)
        return index

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            self._looked_at((index.start, index.stop))
            return Strict(self.array[index])
        return self.view[self._looked_at(index)]

    def __setitem__(self, index: Any, value: Any) -> None:
        self.view[self._looked_at(index)] = value


@dataclass
class Twin:
    """One kernel for one signature: its place in the library, and what makes its arguments."""

    kernel: Kernel
    signature: Signature
    symbol: str


def twins_and_text() -> tuple[list[Twin], str]:
    """Every kernel of the package, and the C++ of all with a function for each."""
    all_entries()
    kernels = [kernel for kernel in KERNELS if kernel.name.startswith("sandbox.")]
    translation = Translation(kernels)
    twins, lines = [], []
    for kernel in kernels:
        for signature in translation.signatures(kernel):
            twin = Twin(kernel, signature, f"twin_{len(twins)}")
            twins.append(twin)
            word, given = 0, []
            for _, kind in signature.takes:
                given.append(f"argument<{kind.cpp}>(block + {word})")
                word += words_of(kind)
            function = kernel.function
            call = f"{translation.name_of(function.__module__, '', function.__name__)}({', '.join(given)})"
            body = f"{call};" if signature.gives.cpp == "void" else f"const auto given = {call}; keep(result, given);"
            lines.append(f'extern "C" KERNELS_SHARED void {twin.symbol}(int64_t *block, void *result) {{ {body} }}')
    keep = "template <class T> static void keep(void *place, const T &value) { *(T *)place = value; }"
    return twins, "\n".join([translation.kernels_text(), keep, *lines, ""])


def c_type(kind: Type) -> Any:
    """The ctypes type that lies in memory as C++ lays it out."""
    if isinstance(kind, Scalar):
        return SCALARS[kind.cpp]
    if isinstance(kind, Array):
        return ctypes.c_int64 * words_of(kind)
    assert isinstance(kind, (Struct, Several))
    items = kind.items if isinstance(kind, Several) else [each for _, each in kind.fields]
    return type("Result", (ctypes.Structure,), {"_fields_": [(f"f{k}", c_type(item)) for k, item in enumerate(items)]})


class Maker:
    """Makes arguments: the same ones twice, as words of a block and for the interpreter."""

    def __init__(self, numbers: random.Random) -> None:
        self.numbers = numbers
        self.count = numbers.randint(1, 4)
        self.arrays: list[tuple[Any, Any]] = []
        self.arenas: list[Any] = []
        self.kept: list[Any] = []

    def scalar(self, cpp: str) -> Any:
        pick = self.numbers.random()
        if cpp == "bool":
            return pick < 0.5
        if cpp == "int64_t":
            return self.numbers.choice(WHOLE) if pick < 0.1 else self.numbers.randint(0, self.count)
        return self.numbers.choice(NUMBERS) if pick < 0.25 else self.numbers.uniform(-2.0, 2.0)

    def array(self, kind: Array, name: str) -> tuple[list[int], Strict]:
        if name == "arena":
            one = np.zeros(ARENA, np.int64)
            one[0] = 1
        else:
            wide = self.numbers.choice((2, 2, 14))
            rows = LONG if self.numbers.random() < 0.1 else self.count + self.numbers.randint(0, 2)
            shape = (rows, wide, wide)[: kind.dimensions]
            values = [self.scalar({"FLAG": "bool"}.get(kind.item.cpp, kind.item.cpp)) for _ in range(math.prod(shape))]
            if kind.dtype in ("int32", "int8", "uint32"):
                values = [min(max(value, 0), 100) for value in values]
            with np.errstate(all="ignore"):
                one = np.array(values, kind.dtype).reshape(shape)
        other = one.copy()
        if name == "arena":
            self.arenas.append(other)
        self.arrays.append((one, other))
        words = [0, 0, one.size, one.itemsize, one.ctypes.data, *one.shape, *one.strides]
        return words, Strict(other)

    def argument(self, kind: Type, name: str = "") -> tuple[list[int], Any]:
        """The words of an argument, and what the interpreter gets."""
        if isinstance(kind, Scalar):
            value = self.scalar(kind.cpp)
            return [int(np.float64(value).view(np.int64)) if kind.cpp == "double" else int(value)], value
        if isinstance(kind, Array):
            return self.array(kind, name)
        if isinstance(kind, BundleType):
            words, items = self.argument(kind.items)
            block = np.array(words, np.int64)
            self.kept.append(block)
            bundle: Any = interpreted.Bundle(())
            bundle.items = items
            return [0, 0, 1, block.nbytes, block.ctypes.data, 1, block.nbytes], bundle
        named = kind.fields if isinstance(kind, Struct) else [(f"item{k}", item) for k, item in enumerate(kind.items)]
        parts = [self.argument(each, field) for field, each in named]
        words = [word for part, _ in parts for word in part]
        values = [value for _, value in parts]
        if isinstance(kind, Several):
            return words, tuple(values)
        plain = all(isinstance(each, Scalar) for _, each in kind.fields)
        return words, kind.kind(*values) if plain else interpreted.LentTuple(kind.kind, values)


def interpreted_call(function: Callable[..., Any], arguments: list[Any]) -> Any:
    """What a kernel's source gives. Raises Unending, and whatever it raises."""
    left = MOST_LINES

    def trace(_frame: Any, event: str, _argument: Any) -> Any:
        nonlocal left
        left -= event == "line"
        if left < 0:
            raise Unending
        return trace

    # What kernels lay out themselves counts from no end either.
    vars(interpreted)["memoryview"] = Strict
    modules = [vars(module) for name, module in list(sys.modules.items()) if name.startswith("sandbox.")]
    counting = [module for module in modules if module.get("math") is math]
    for module in modules:
        module["int"] = whole
    for module in counting:
        module["math"] = MATH
    sys.settrace(trace)
    try:
        return function(*arguments)
    finally:
        sys.settrace(None)
        del vars(interpreted)["memoryview"]
        for module in modules:
            del module["int"]
        for module in counting:
            module["math"] = math


def whole(value: Any) -> int:
    """An integer of a number. Raises OverflowError where no 64 bits hold it: machine code may make anything of that."""
    made = int(value)
    if not -(2**63) <= made < 2**63:
        raise OverflowError
    return made


# The same of what rounds to whole numbers.
MATH = SimpleNamespace(
    **vars(math) | {"floor": lambda value: whole(math.floor(value)), "ceil": lambda value: whole(math.ceil(value))}
)


def same(one: Any, other: Any) -> bool:
    """Whether two results are the same to the bit; a NaN is a NaN."""
    if isinstance(one, ctypes.Structure):
        fields = [getattr(one, name) for name, _ in one._fields_]
        others = list(other) if isinstance(other, tuple) else list(vars(other).values())
        return all(map(same, fields, others))
    if isinstance(one, ctypes.Array):
        shape = getattr(other, "shape", ())
        return tuple(one[5 : 5 + len(shape)]) == tuple(shape)
    if isinstance(one, float):
        return (math.isnan(one) and math.isnan(other)) or (np.float64(one).tobytes() == np.float64(other).tobytes())
    return bool(one == other)


def same_arrays(one: Any, other: Any) -> bool:
    """Whether two arrays are the same to the bit; a NaN is a NaN."""
    if one.dtype.kind != "f":
        return bool(one.tobytes() == other.tobytes())
    bits = f"i{one.itemsize}"
    return bool(((one.view(bits) == other.view(bits)) | (np.isnan(one) & np.isnan(other))).all())


def tried(twin: Twin, run: Any, numbers: random.Random) -> bool | None:
    """Whether a kernel gives the bits of its source for some arguments; None: they are no arguments for it."""
    maker = Maker(numbers)
    given = [maker.argument(kind, name) for name, kind in twin.signature.takes]
    before = [one.copy() for one, _ in maker.arrays]
    try:
        wanted = interpreted_call(twin.kernel.function, [value for _, value in given])
    except Exception:
        return None
    if any(not 0 <= arena[0] <= ARENA for arena in maker.arenas):
        return None
    for (one, _), content in zip(maker.arrays, before, strict=True):
        one[...] = content
    block = np.array([word for words, _ in given for word in words] or [0], np.int64)
    gives = twin.signature.gives
    result = None if gives.cpp == "void" else c_type(gives)()
    run(block.ctypes.data, ctypes.byref(result) if result is not None else None)
    equal = all(same_arrays(one, other) for one, other in maker.arrays)
    if result is None:
        return equal
    return equal and same(result.value if isinstance(gives, Scalar) else result, wanted)


def compare(rounds: int, seed: int, names: list[str]) -> tuple[list[str], list[str], int]:
    """Names of kernels that differ, of those for which no arguments were found, and how many calls were compared."""
    twins, text = twins_and_text()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        content = compiled({"twins.cpp": text}, [], this_machine(), folder / "kept", True)
        path = folder / f"{file_digest(content)}.so"
        path.write_bytes(content)
        Library(path, {})  # tells it where to end the process
        library, differ, never, calls = ctypes.CDLL(str(path)), [], [], 0
        for twin in twins:
            if names and twin.kernel.name not in names:
                continue
            run = getattr(library, twin.symbol)
            run.argtypes, run.restype = (ctypes.c_void_p, ctypes.c_void_p), None
            numbers, found = random.Random(f"{seed} {twin.symbol} {twin.kernel.name}"), 0
            for _ in range(rounds * TRIES):
                equal = tried(twin, run, numbers)
                if equal is False:
                    differ.append(twin.kernel.name)
                    break
                found += equal is True
                if found == rounds:
                    break
            calls += found
            if not found and twin.kernel.name not in differ:
                never.append(twin.kernel.name)
    return differ, never, calls


def main() -> int:
    """Compare, and say what differs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=60, help="calls of each kernel")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("names", nargs="*", metavar="NAME", help="kernels; default: all")
    given = parser.parse_args()
    differ, never, calls = compare(given.rounds, given.seed, given.names)
    print(*(f"{name} DIFFERS" for name in differ), *(f"{name}: no arguments were found" for name in never), sep="\n")
    print(f"{calls:,} calls compared, {len(differ)} kernels differ, {len(never)} were not called")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
