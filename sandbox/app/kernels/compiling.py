"""Compiling into the cache, in child processes of low priority.

Each child takes its share of the kernels that Python calls, divided so that those which call the same parts come
together, as a process types a part once. A child changes nothing but the cache, whose files are written in one go: two
may write at once, and any may be ended at any time.
"""

import contextlib
import gc
import hashlib
import json
import os
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import platformdirs

from sandbox.physics import jit

# How much nicer than others a child is: the window and other programs come first.
NICENESS = 10
# What is compiled, in this order: all that levels need in which nothing touches, with the drawing, and the rest.
GROUPS = ("basics", "contacts")
# Typing and lowering a part against optimising it once more in another entry, each in proportion to its length.
TYPING, LINKING = 2.4, 1.0
# More processes would slow other programs down, and the longest share gets no shorter.
MOST_PROCESSES = 4
# A child looks for garbage after this many new objects, in place of 700: compiling makes many that stay, a tenth of it.
SEARCH_AFTER = 50_000
# How often children are looked after where nothing else is to be done [s].
POLL = 0.05
# The package that children import is this one, wherever they are started.
_HOME = Path(__file__).resolve().parents[3]


def divide(kernels: Sequence[jit.Kernel], count: int) -> list[list[jit.Kernel]]:
    """Kernels in `count` shares that take about the same time, those of earlier groups first in each."""
    parts = {kernel: _parts(kernel) for kernel in kernels}

    def linking(kernel: jit.Kernel) -> float:
        return LINKING * sum(map(_length, parts[kernel]))

    shares: list[list[jit.Kernel]] = [[] for _ in range(count)]
    typed: list[set[jit.Kernel]] = [set() for _ in range(count)]
    loads = [0.0] * count
    for group in GROUPS:
        for kernel in sorted((one for one in kernels if one.group == group), key=lambda one: (-linking(one), one.name)):
            costs = [linking(kernel) + TYPING * sum(map(_length, parts[kernel] - known)) for known in typed]
            place = min(range(count), key=lambda k: loads[k] + costs[k])
            shares[place].append(kernel)
            typed[place] |= parts[kernel]
            loads[place] += costs[place]
    # Each one's order is free, but for the groups: what is soon done comes first, so that a bar moves.
    return [sorted(share, key=lambda one: (GROUPS.index(one.group), linking(one), one.name)) for share in shares]


def _length(kernel: jit.Kernel) -> int:
    return len(kernel.function.__code__.co_code)


def _parts(entry: jit.Kernel) -> set[jit.Kernel]:
    """A kernel and all that it calls, directly or not."""
    by_held = {id(kernel.held): kernel for kernel in jit.KERNELS}
    found: set[jit.Kernel] = set()
    waiting = [entry]
    while waiting:
        kernel = waiting.pop()
        if kernel not in found:
            found.add(kernel)
            named = (kernel.function.__globals__.get(name) for name in kernel.function.__code__.co_names)
            waiting += [by_held[id(value)] for value in named if id(value) in by_held]
    return found


def needed_kernels(groups: Iterable[str], solvers: Sequence[str] | None) -> list[jit.Kernel]:
    """Kernels of these groups, with the types that they are called with; solvers: None = all of them.

    Raises:
        RuntimeError: where kernels are compiled already: only interpreted ones are listened to.
    """
    jit.start_interpreted()
    from sandbox.physics.solvers import SOLVERS
    from sandbox.physics.warm_up import warm_up

    names = tuple(SOLVERS) if solvers is None else tuple(solvers)
    with jit.recorded("basics"):
        warm_up(names, contacts=False)
        warm_up_rest()
    if "contacts" in groups:
        with jit.recorded("contacts"):
            warm_up(names)
    return [kernel for kernel in jit.entries() if kernel.group in groups]


def _stamp() -> Path:
    """The file that says that all kernels of these very sources are in the cache."""
    digest = hashlib.blake2b(digest_size=10)
    package = Path(__file__).resolve().parents[2]
    for file in sorted([*(package / "physics").rglob("*.py"), *(package / "app" / "draw" / "raster").glob("*.py")]):
        digest.update(file.read_bytes())
    versions = [sys.implementation.cache_tag, *map(version, ("numba", "numpy", "llvmlite"))]
    settings = [os.environ.get(name, "") for name in ("NUMBA_CACHE_DIR", "NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES")]
    digest.update(repr((str(package), versions, settings)).encode())
    return Path(platformdirs.user_cache_dir("spring-sandbox", appauthor=False)) / f"prepared-{digest.hexdigest()}"


def is_prepared() -> bool:
    """Whether all kernels are in the cache, as far as can be told without numba."""
    try:
        folders = json.loads(_stamp().read_text(encoding="utf-8"))
        return all(len(list(Path(folder).glob("*.kernel"))) >= count for folder, count in folders.items())
    except (OSError, ValueError, AttributeError, PackageNotFoundError):
        return False


def note_prepared() -> None:
    """Note that all kernels are in the cache, where that can be written; after `switch_to_compiled`."""
    from sandbox.physics.jit.cache import cache_folders

    folders = {str(folder): len(list(folder.glob("*.kernel"))) for folder in cache_folders() if folder.is_dir()}
    with contextlib.suppress(OSError):
        stamp = _stamp()
        stamp.parent.mkdir(parents=True, exist_ok=True)
        stamp.write_text(json.dumps(folders), encoding="utf-8")


def warm_up_rest() -> None:
    """Compile what the app needs beside ticks: measures, drawing, Cs and Cd of substeps; or load it."""
    import numpy as np

    from sandbox.app.draw.raster.painter import precompile_painting
    from sandbox.physics.analysis.energy import total_energy
    from sandbox.physics.constraints import AREA
    from sandbox.physics.settings import WorldSettings
    from sandbox.physics.step import constraint_coefficients, substep_coefficients
    from sandbox.physics.world import World

    world = World(WorldSettings())
    world.add_particles(["a", "b", "c"], np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    world.add_springs(["s"], [0], [1])
    world.add_constraints(AREA, [[0, 1, 2]])
    total_energy(world)
    for keeps_constant in (False, True):
        substep_coefficients(world, 2, keeps_constant=keeps_constant)
        constraint_coefficients(world, 2, keeps_constant=keeps_constant)
    precompile_painting()


class Child:
    """One process that compiles a share; it goes on where this program ends, since the next start gains by it."""

    def __init__(self, arguments: Sequence[str]) -> None:
        options: dict[str, Any] = {"start_new_session": True}
        if sys.platform == "win32":
            options = {"creationflags": subprocess.BELOW_NORMAL_PRIORITY_CLASS}
        path = os.pathsep.join(filter(None, (str(_HOME), os.environ.get("PYTHONPATH"))))
        self._process = subprocess.Popen(
            [sys.executable, "-m", "sandbox.app.kernels.compiling", *arguments],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
            env={**os.environ, "PYTHONPATH": path, "PYGAME_HIDE_SUPPORT_PROMPT": "1"}, **options,
        )  # fmt: skip
        # Kernels by their group: how many there are to be, and how many there are.
        self.wanted: Counter[str] = Counter()
        self.done: Counter[str] = Counter()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            what, group = line.split()
            (self.wanted if what == "wanted" else self.done)[group] += 1

    @property
    def result(self) -> bool | None:
        """Whether all was compiled; None while it is being done."""
        code = self._process.poll()
        return None if code is None or self._reader.is_alive() else code == 0

    def end(self) -> None:
        """End it at once; what it has finished stays in the cache."""
        self._process.kill()
        self._process.wait()


class Crew:
    """Children that compile kernels of some groups, and how far they are."""

    def __init__(
        self,
        processes: int,
        groups: Sequence[str] = GROUPS,
        solvers: Sequence[str] | None = None,
        start: Callable[[Sequence[str]], Child] = Child,
    ) -> None:
        self.has_failed = False
        self._children: list[Child] = []
        for number in range(processes):
            arguments = [str(number), str(processes), ",".join(groups), ",".join(solvers or ())]
            try:
                self._children.append(start(arguments))
            except OSError:  # no more processes, or no memory for one
                self.has_failed = True

    @property
    def progress(self) -> tuple[int, int]:
        """How many kernels are there, and how many are to be; 0 of 0 until that is known."""
        known = all(child.wanted or child.result is not None for child in self._children)
        total = sum(child.wanted.total() for child in self._children) if known else 0
        return sum(child.done.total() for child in self._children), total

    @property
    def is_busy(self) -> bool:
        """Whether a child is at work; what those that have ended did not compile is left to others."""
        results = [child.result for child in self._children]
        self.has_failed = self.has_failed or False in results
        return None in results

    def has(self, groups: Iterable[str]) -> bool:
        """Whether all kernels of these groups are there, or nobody is at work on them any more."""
        if not self.is_busy:
            return True
        return all(
            child.result is not None or (child.wanted and child.done[group] == child.wanted[group])
            for child in self._children
            for group in groups
        )

    def end(self) -> None:
        """End all that is being done."""
        for child in self._children:
            child.end()


def usual_processes() -> int:
    """How many processes compile where nobody has said."""
    return min(os.cpu_count() or 1, MOST_PROCESSES)


def compile_all(
    processes: int, groups: Sequence[str], solvers: Sequence[str] | None, report: Callable[[int, int], object]
) -> bool:
    """Compile in child processes, which end with this one; whether all of them could.

    report: told now and then how many kernels are there, and how many are to be.
    """
    crew = Crew(processes, groups, solvers)
    try:
        while crew.is_busy:
            report(*crew.progress)
            time.sleep(POLL)
    finally:
        crew.end()
    report(*crew.progress)
    return not crew.has_failed


def _main(number: str, processes: str, groups: str, solvers: str) -> None:
    """Compile one share of this many, and say so on standard output, to whoever listens."""
    if sys.platform != "win32":
        os.nice(NICENESS)
    gc.set_threshold(SEARCH_AFTER)
    kernels = needed_kernels(groups.split(","), solvers.split(",") if solvers else None)
    share = divide(kernels, int(processes))[int(number)]
    for kernel in share:
        _say("wanted", kernel.group)
    if not jit.switch_to_compiled():
        sys.exit(1)
    for kernel in share:
        for signature in kernel.signatures.values():
            jit.compile_entry(kernel, signature)
        _say("done", kernel.group)


def _say(*words: str) -> None:
    # The window may be closed long before the work is done.
    with contextlib.suppress(OSError):
        print(*words, flush=True)


if __name__ == "__main__":
    _main(*sys.argv[1:])
