"""Where numba compiles kernels, it does so before the first test, once, and the person is told."""

import sys
import time
from collections.abc import Callable

from sandbox.app.kernels import compiling
from sandbox.physics import jit

# From one line of progress to the next, where lines stay [s].
EVERY = 10.0
BEGINS = "Compiling the physics, once: later runs load it from a cache."


def wants_kernels(config) -> bool:
    """Whether a run of pytest will let numba compile kernels: not one that only lists tests."""
    is_worker, only_lists = hasattr(config, "workerinput"), config.option.collectonly
    return not (is_worker or only_lists) and jit.way() == "numba"


def compile_once(write: Callable[[str], object], rewrite: Callable[[str], object] | None = None) -> None:
    """Compile what is not in the cache. write: prints a line; rewrite: prints over the last one, on a terminal."""
    write(BEGINS)
    last = time.monotonic()

    def report(done: int, total: int) -> None:
        nonlocal last
        text = f"{done} of {total} kernels" if total else "looking for kernels"
        if rewrite is not None:
            rewrite(text)
        elif time.monotonic() - last >= EVERY:
            last = time.monotonic()
            write(text)

    began = time.monotonic()
    if compiling.compile_all(compiling.usual_processes(), report):
        write(f"Compiled in {time.monotonic() - began:.0f} s.")
    else:
        write("Not everything could be compiled: tests compile the rest when they need it.")


def compile_before_tests(config) -> None:
    """What `pytest_sessionstart` does, before workers begin."""
    if not wants_kernels(config):
        return
    terminal = config.pluginmanager.get_plugin("terminalreporter")
    rewrite = None
    if sys.stdout.isatty():
        rewrite = lambda text: terminal.rewrite(f"  {text}", erase=True)  # noqa: E731
    capture = config.pluginmanager.get_plugin("capturemanager")
    with capture.global_and_fixture_disabled():
        compile_once(terminal.write_line, rewrite)
