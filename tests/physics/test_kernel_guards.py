"""Inner parts of numba that kernels use: where one is missing or does something else, the same bits without it."""

import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from sandbox.physics import jit

pytestmark = pytest.mark.skipif(not jit.COMPILED, reason="nothing is compiled here")
ROOT = Path(__file__).resolve().parents[2]

# Parts of numba that a module of ours imports by name, or reads when it is imported.
IMPORTED = (
    "numba.core.codegen.JITCodeLibrary",
    "numba.core.environment.lookup_environment",
    "numba.core.compiler.Compiler",
    "numba.core.caching.NullCache",
    "numba.core.datamodel.default_manager",
    "numba.core.typing.templates.AttributeTemplate",
    "numba.core.cgutils",
    "numba.extending.lower_cast",
    "numba.extending.lower_getattr_generic",
    "numba.core.caching",
)
# Those that are used when a kernel is compiled, kept or loaded.
USED = (
    "numba.core.compiler.CompileResult._reduce",
    "numba.core.compiler.CompileResult._rebuild",
)
# Methods and fields of numba's code library that ours calls; numba itself goes on having them.
LIBRARY = (
    "_raise_if_finalized", "_codegen", "_linking_libraries", "_final_module", "_optimize_final_module",
    "_finalize_final_module",
)  # fmt: skip

PROGRAMME = """
import importlib, sys
from typing import NamedTuple
import numpy as np
import numba, numba.core.caching, numba.core.serialize, numba.core.compiler, llvmlite.binding, llvmlite.ir

def remove(name):
    owner, _, last = name.rpartition(".")
    parts = owner.split(".")
    for k in range(len(parts), 0, -1):
        if ".".join(parts[:k]) in sys.modules:
            holder = sys.modules[".".join(parts[:k])]
            break
    for part in parts[k:]:
        holder = getattr(holder, part)
    delattr(holder, last)
    if name in sys.modules:
        sys.modules[name] = None

class Part(NamedTuple):
    values: np.ndarray
    factor: np.ndarray

class Whole(NamedTuple):
    part: Part
    total: np.ndarray

# A first kernel makes numba import what it needs itself.
numba.njit(lambda values: values[0] + 1.0)(np.zeros(1))
{change}
from sandbox.physics import jit

@jit.inner_kernel
def product(part, k):
    return part.values[k] * part.factor[0]

@jit.inner_kernel
def fill(whole, share):
    for k in range(whole.total.shape[0]):
        whole.total[k] = share * product(whole.part, k)

@jit.kernel
def of_bundle(numbers, share):
    fill(jit.contents(numbers), share)

@jit.kernel
def of_tuple(whole, share):
    fill(whole, share)

assert jit.COMPILED
whole = Whole(Part(np.array([0.1, 0.2, 0.7]), np.array([0.3])), np.zeros(3))
of_bundle(jit.bundle(whole), 1.1)
first = whole.total.tobytes().hex()
of_tuple(whole, 1.1)
print(first, whole.total.tobytes().hex())
"""


def outcome(tmp_path, change):
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "NUMBA_CACHE_DIR": str(tmp_path)}
    (tmp_path / "programme.py").write_text(PROGRAMME.replace("{change}", change))
    command = [sys.executable, str(tmp_path / "programme.py")]
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout.split()


def expected():
    return [np.array([1.1 * (value * 0.3) for value in (0.1, 0.2, 0.7)]).tobytes().hex()] * 2


@pytest.mark.parametrize("name", [*IMPORTED, *USED])
def test_without_an_inner_part_of_numba_kernels_give_the_same_bits(tmp_path, name):
    assert outcome(tmp_path, f"remove({name!r})") == expected()


@pytest.mark.parametrize("name", LIBRARY)
def test_where_a_code_library_lacks_what_ours_calls_kernels_give_the_same_bits(tmp_path, name):
    change = f"""
from sandbox.physics.jit import linking
def missing(self):
    raise AttributeError({name!r})
setattr(linking._EntryLibrary, {name!r}, property(missing, lambda self, value: None))
assert not linking.links_once()
"""
    assert outcome(tmp_path, change) == expected()


@pytest.mark.parametrize("attribute", ["_cache", "get_call_template"])
def test_where_dispatchers_are_others_kernels_give_the_same_bits(tmp_path, attribute):
    change = f"""
from sandbox.physics.jit import cache, lending
for module, name in ((cache, "keep"), (lending, "lend_to")):
    given = getattr(module, name)
    def guarded(dispatcher, *others, given=given):
        class Other:
            def __getattr__(self, attribute):
                if attribute == {attribute!r}:
                    raise AttributeError(attribute)
                return getattr(dispatcher, attribute)
            def __setattr__(self, attribute, value):
                setattr(dispatcher, attribute, value)
        return given(Other(), *others)
    setattr(module, name, guarded)
"""
    assert outcome(tmp_path, change) == expected()


def test_with_all_of_them_parts_are_linked_once_and_tuples_lent(tmp_path):
    change = "from sandbox.physics.jit import linking, lending\nassert linking.links_once()"
    assert outcome(tmp_path, change) == expected()


class Mixed(NamedTuple):
    values: np.ndarray
    flag: bool


def test_a_lent_tuple_with_what_is_no_word_is_refused():
    @jit.inner_kernel
    def first(mixed):
        return mixed.values[0]

    @jit.kernel
    def call(mixed):
        return first(mixed)

    with pytest.raises(TypeError, match="holds arrays, named tuples, int64 and float64, not bool"):
        call(Mixed(np.zeros(1), True))


@pytest.mark.parametrize("items", [(1.0,), (np.zeros((4, 4))[::2],), ([np.zeros(1)],)])
def test_a_bundle_of_what_kernels_cannot_point_to_is_refused(items):
    with pytest.raises(TypeError, match="bundle"):
        jit.bundle(items)
