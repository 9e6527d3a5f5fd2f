"""Preparation: kernels are interpreted at first; the app switches to compiled ones as soon as they are ready.

Nothing is compiled on the thread that draws. What is not in the cache is compiled by child processes, or on a thread of
its own where they cannot; what is in it is loaded on that thread, while the window goes on drawing.
"""

import importlib
import threading
from collections.abc import Callable, Iterator
from functools import cache

from sandbox.app.kernels.compiling import GROUPS, Crew, is_prepared, note_prepared, usual_processes, warm_up_rest
from sandbox.app.kernels.pace import Pace
from sandbox.level.document.model import Level
from sandbox.physics import jit
from sandbox.physics.warm_up import warm_up


class Preparation:
    """Gets kernels ready, a step at each `update`; switched: called between two ticks, once kernels are compiled.

    Runs go on with the same bits, but what their worlds have derived until then has to be dropped.
    """

    def __init__(self, switched: Callable[[], object] = lambda: None) -> None:
        self._switched = switched
        self._ready: set[str] = set()
        self._crew: Crew | None = None
        self._thread: threading.Thread | None = None
        self._error: BaseException | None = None
        self._has_contacts = False
        self._wants_contacts = False
        self._pace: Pace | None = None
        self._trials: list[Pace] = []
        self._steps = self._prepare()

    # What the app asks.

    def update(self, level: Level | None = None, contacts: bool = False) -> None:
        """Go on a step, between two ticks of the run of a level; contacts: one in which things touch."""
        self._has_contacts = contacts
        self._wants_contacts = self._wants_contacts or contacts
        # Where kernels are only to be loaded, they are there before a trial with contacts is over.
        is_worth_it = not jit.COMPILED and (self._crew is not None or not contacts)
        if level is not None and is_worth_it and (self._pace is None or self._pace.level is not level):
            self._pace = Pace(level)
            self._trials.append(self._pace)
        next(self._steps, None)
        if self._error is not None:
            raise self._error

    def is_ready(self, contacts: bool) -> bool:
        """Whether kernels are; contacts: those too that only things that touch need, which are loaded from then on."""
        self._wants_contacts = self._wants_contacts or contacts
        return set(GROUPS if contacts else GROUPS[:1]) <= self._ready

    def may_play(self, contacts: bool) -> bool:
        """Whether the run of the level that `update` was told of can go on, if need be with interpreted kernels."""
        return self.is_ready(contacts) or (not jit.COMPILED and self._pace is not None and self._pace.holds)

    def note(self, ticks: int, seconds: float) -> None:
        """Take into account that this many ticks of that run took this many seconds."""
        if not jit.COMPILED and self._pace is not None:
            self._pace.note(ticks, seconds)

    @property
    def progress(self) -> tuple[int, int]:
        """How many kernels are compiled, and how many are to be; 0 of 0 where that is not known."""
        return (0, 0) if self._crew is None else self._crew.progress

    def finish(self, contacts: bool = False) -> None:
        """Wait until kernels are ready."""
        while not self.is_ready(contacts):
            self.update(contacts=contacts)
            if self._thread is not None:
                self._thread.join()

    # What it does.

    def _prepare(self) -> Iterator[None]:
        if not jit.COMPILED:
            yield from self._compile()
            while self._is_tried_out:
                yield
            yield from self._on_thread(_import_numba)
            while not self._may_switch():
                yield
            if not jit.switch_to_compiled():
                self._ready.update(GROUPS)
                return
            self._switched()
        for group, load in zip(GROUPS, (_load_basics, _load_contacts), strict=True):
            while group == "contacts" and not self._wants_contacts:
                yield
            while self._crew is not None and not self._crew.has([group]):
                yield
            yield from self._on_thread(load)
            self._ready.add(group)
        if self._crew is not None and not self._crew.has_failed:
            note_prepared()

    def _compile(self) -> Iterator[None]:
        """Let children compile, until all is there that the run on the screen needs."""
        yield from self._on_thread(self._hire)
        while self._crew is not None and not self._crew.has(GROUPS if self._has_contacts else GROUPS[:1]):
            yield

    def _hire(self) -> None:
        if not is_prepared():
            self._crew = Crew(usual_processes())

    @property
    def _is_tried_out(self) -> bool:
        """Whether a run is about to begin interpreted, unless what is done beside it holds it up."""
        return self._pace is not None and not self._has_contacts and not self._pace.is_known

    def _may_switch(self) -> bool:
        """Whether no trial is in the midst of a tick."""
        self._trials = [trial for trial in self._trials if not trial.end()]
        return not self._trials

    def _on_thread(self, work: Callable[[], object]) -> Iterator[None]:
        def run() -> None:
            try:
                work()
            except BaseException as error:
                self._error = error

        self._thread = threading.Thread(target=run, daemon=True)
        self._thread.start()
        while self._thread.is_alive():
            yield
        self._thread = None


def _import_numba() -> None:
    # What the switch would import, on the thread that draws; where it cannot be, the switch says so.
    try:
        importlib.import_module("sandbox.physics.jit.compiled")
    except ImportError:
        return


# What is loaded stays in the process, whichever app comes next.
@cache
def _load_basics() -> None:
    warm_up(contacts=False)
    warm_up_rest()


@cache
def _load_contacts() -> None:
    warm_up()
