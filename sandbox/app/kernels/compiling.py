"""Compiling for numba, in processes of low priority, where kernels were edited: into its cache, before tests.

Each takes its share of the kernels that Python calls, divided so that those which call the same parts come together,
as a process types a part once. It changes nothing but the cache, whose files are written in one go: two may write at
once, and any may be ended at any time.
"""

import contextlib
import gc
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from sandbox.physics import jit

# How much nicer than others a process is: other programs come first.
NICENESS = 10
# Typing and lowering a part against optimising it once more in another entry, each in proportion to its length.
TYPING, LINKING = 2.4, 1.0
# More processes would slow other programs down, and the longest share gets no shorter.
MOST_PROCESSES = 4
# Garbage is looked for after this many new objects, in place of 700: compiling makes many that stay, a tenth of it.
SEARCH_AFTER = 50_000
# How often processes are looked after [s].
POLL = 0.05
# The package that they import is this one, wherever they are started.
_HOME = Path(__file__).resolve().parents[3]


def divide(kernels: Sequence[jit.Kernel], count: int) -> list[list[jit.Kernel]]:
    """Kernels in `count` shares that take about the same time, in each what is soon done first."""
    parts = {kernel: _parts(kernel) for kernel in kernels}

    def linking(kernel: jit.Kernel) -> float:
        return LINKING * sum(map(_length, parts[kernel]))

    shares: list[list[jit.Kernel]] = [[] for _ in range(count)]
    typed: list[set[jit.Kernel]] = [set() for _ in range(count)]
    loads = [0.0] * count
    for kernel in sorted(kernels, key=lambda one: (-linking(one), one.name)):
        costs = [linking(kernel) + TYPING * sum(map(_length, parts[kernel] - known)) for known in typed]
        place = min(range(count), key=lambda k: loads[k] + costs[k])
        shares[place].append(kernel)
        typed[place] |= parts[kernel]
        loads[place] += costs[place]
    return [sorted(share, key=lambda one: (linking(one), one.name)) for share in shares]


def _length(kernel: jit.Kernel) -> int:
    return len(kernel.function.__code__.co_code)


def _parts(entry: jit.Kernel) -> set[jit.Kernel]:
    """A kernel and all that it calls, directly or not."""
    found: set[jit.Kernel] = set()
    waiting = [entry]
    while waiting:
        kernel = waiting.pop()
        if kernel not in found:
            found.add(kernel)
            named = (kernel.function.__globals__.get(name) for name in kernel.function.__code__.co_names)
            waiting += [one for one in map(jit.kernel_of, filter(callable, named)) if one is not None]
    return found


def needed_kernels() -> list[jit.Kernel]:
    """All kernels that Python calls, with the types that they are called with.

    Raises:
        RuntimeError: where kernels are not interpreted: only interpreted ones are listened to.
    """
    jit.start_interpreted()
    from sandbox.physics.every_kernel import call_every_kernel

    with jit.recorded():
        call_every_kernel()
        _call_the_rest()
    return [kernel for kernel in jit.entries() if kernel.signatures]


def _call_the_rest() -> None:
    """What the app needs beside ticks: measures, drawing, Cs and Cd of substeps."""
    import numpy as np

    from sandbox.app.draw.raster.painter import precompile_painting
    from sandbox.physics import substeps
    from sandbox.physics.analysis.energy import total_energy
    from sandbox.physics.constraints import AREA
    from sandbox.physics.settings import WorldSettings
    from sandbox.physics.world import World

    world = World(WorldSettings())
    world.add_particles(["a", "b", "c"], np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    world.add_springs(["s"], [0], [1])
    world.add_constraints(AREA, [[0, 1, 2]])
    total_energy(world)
    substeps.turned(np.zeros(1), np.zeros(1), np.zeros(1), 2)
    precompile_painting()


class Compiler:
    """One process that compiles a share: the one of this number among so many."""

    def __init__(self, number: int, processes: int) -> None:
        options: dict[str, Any] = {"start_new_session": True}
        if sys.platform == "win32":
            options = {"creationflags": subprocess.BELOW_NORMAL_PRIORITY_CLASS}
        path = os.pathsep.join(filter(None, (str(_HOME), os.environ.get("PYTHONPATH"))))
        self._process = subprocess.Popen(
            [sys.executable, "-m", "sandbox.app.kernels.compiling", str(number), str(processes)],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
            env={**os.environ, "PYTHONPATH": path, "PYGAME_HIDE_SUPPORT_PROMPT": "1"}, **options,
        )  # fmt: skip
        # How many kernels there are to be, and how many there are.
        self.wanted = self.done = 0
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self.wanted += line == "wanted\n"
            self.done += line == "done\n"

    @property
    def result(self) -> bool | None:
        """Whether all was compiled; None while it is being done."""
        code = self._process.poll()
        return None if code is None or self._reader.is_alive() else code == 0

    def end(self) -> None:
        """End it at once; what it has finished stays in the cache."""
        self._process.kill()
        self._process.wait()


def usual_processes() -> int:
    """How many processes compile where nobody has said."""
    return min(os.cpu_count() or 1, MOST_PROCESSES)


def compile_all(processes: int, report: Callable[[int, int], object]) -> bool:
    """Compile in so many processes, which end with this one; whether all of them could.

    report: told now and then how many kernels are there, and how many are to be; 0 of 0 until that is known.
    """
    compilers: list[Compiler] = []

    def tell() -> None:
        is_known = all(one.wanted or one.result is not None for one in compilers)
        report(sum(one.done for one in compilers), sum(one.wanted for one in compilers) if is_known else 0)

    try:
        for number in range(processes):
            compilers.append(Compiler(number, processes))
        while None in (one.result for one in compilers):
            tell()
            time.sleep(POLL)
    except OSError:  # no more processes, or no memory for one
        return False
    finally:
        for one in compilers:
            one.end()
    tell()
    return all(one.result for one in compilers)


def _main(number: str, processes: str) -> None:
    """Compile one share of this many, and say so on standard output, to whoever listens."""
    if sys.platform != "win32":
        os.nice(NICENESS)
    gc.set_threshold(SEARCH_AFTER)
    share = divide(needed_kernels(), int(processes))[int(number)]
    for _ in share:
        _say("wanted")
    for kernel in share:
        for signature in kernel.signatures.values():
            jit.compile_entry(kernel, signature)
        _say("done")


def _say(word: str) -> None:
    # Whoever listened may have ended.
    with contextlib.suppress(OSError):
        print(word, flush=True)


if __name__ == "__main__":
    _main(*sys.argv[1:])
