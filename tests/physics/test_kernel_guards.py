"""Inner parts of numba that kernels use: where one is missing or does something else, the same bits without it."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from sandbox.physics import jit

pytestmark = [pytest.mark.whole_world, pytest.mark.skipif(not jit.COMPILED, reason="nothing is compiled here")]
ROOT = Path(__file__).resolve().parents[2]

# Parts of numba that a module of ours imports by name, or reads when it is imported.
IMPORTED = (
    "numba.core.codegen.JITCodeLibrary",
    "numba.core.environment.lookup_environment",
    "numba.core.compiler.Compiler",
    "numba.core.compiler_machinery.register_pass",
    "numba.core.typed_passes.NativeLowering",
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

# Runs files, a line of standard input each: in a copy of itself where the system can, which spares importing numba,
# else in itself, and ends. Answers a line of JSON: what the file calls `outcome`, or a text of what was raised.
PROGRAMME = """
import json, os, runpy, sys, traceback
import numpy as np
import numba, numba.core.caching, numba.core.serialize, numba.core.compiler, llvmlite.binding, llvmlite.ir

# A first kernel makes numba import what it needs itself.
numba.njit(lambda values: values[0] + 1.0)(np.zeros(1))
for line in sys.stdin:
    folder = line.rstrip("\\n")
    if hasattr(os, "fork") and os.fork():
        os.wait()
        continue
    numba.config.CACHE_DIR = folder
    try:
        answer = runpy.run_path(os.path.join(folder, "programme.py"))["outcome"]
    except BaseException:
        answer = traceback.format_exc()
    print(json.dumps(answer), flush=True)
    os._exit(0)
"""

KERNELS = """
import sys
from typing import NamedTuple
import numpy as np

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

whole = Whole(Part(np.array([0.1, 0.2, 0.7]), np.array([0.3])), np.zeros(3))
of_bundle(jit.bundle(whole), 1.1)
outcome = [whole.total.tobytes().hex()]
of_tuple(whole, 1.1)
outcome.append(whole.total.tobytes().hex())
"""


@pytest.fixture(scope="module")
def processes():
    """Processes that were started so far, of which the last may be at work."""
    started = []
    yield started
    for process in started:
        process.stdin.close()
        process.stdout.close()
        process.wait()


@pytest.fixture
def outcome(tmp_path, processes):
    """What kernels give in a process in which something was changed before physics was imported."""

    def run(change):
        (tmp_path / "programme.py").write_text(KERNELS.replace("{change}", change))
        if not processes or processes[-1].poll() is not None:
            environment = {**os.environ, "PYTHONPATH": str(ROOT), "SANDBOX_KERNELS": "numba"}
            pipe = subprocess.PIPE
            command = [sys.executable, "-c", PROGRAMME]
            processes.append(subprocess.Popen(command, env=environment, stdin=pipe, stdout=pipe, text=True))
        processes[-1].stdin.write(f"{tmp_path}\n")
        processes[-1].stdin.flush()
        answer = json.loads(processes[-1].stdout.readline())
        if not hasattr(os, "fork"):
            processes[-1].wait()
        return answer

    return run


def expected():
    return [np.array([1.1 * (value * 0.3) for value in (0.1, 0.2, 0.7)]).tobytes().hex()] * 2


@pytest.mark.parametrize("name", [*IMPORTED, *USED])
def test_without_an_inner_part_of_numba_kernels_give_the_same_bits(outcome, name):
    assert outcome(f"remove({name!r})") == expected()


@pytest.mark.parametrize("name", LIBRARY)
def test_where_a_code_library_lacks_what_ours_calls_kernels_give_the_same_bits(outcome, name):
    change = f"""
from sandbox.physics.jit import linking
def missing(self):
    raise AttributeError({name!r})
setattr(linking._EntryLibrary, {name!r}, property(missing, lambda self, value: None))
assert not linking.links_once()
"""
    assert outcome(change) == expected()


def test_an_index_below_0_counts_from_no_end_and_is_found_where_bounds_are_looked_at(outcome):
    change = """
import numba
numba.config.BOUNDSCHECK = 1
from sandbox.physics import jit

@jit.kernel
def write(values, k):
    values[k] = 1.0

for k in (-1, 3):
    try:
        write(np.zeros(3), k)
    except IndexError:
        continue
    raise AssertionError(k)
"""
    assert outcome(change) == expected()


@pytest.mark.parametrize("attribute", ["_cache", "get_call_template"])
def test_where_dispatchers_are_others_kernels_give_the_same_bits(outcome, attribute):
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
    assert outcome(change) == expected()


def test_with_all_of_them_parts_are_linked_once_and_tuples_lent(outcome):
    change = "from sandbox.physics.jit import linking, lending\nassert linking.links_once()"
    assert outcome(change) == expected()


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
