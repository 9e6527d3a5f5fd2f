"""Worker pool: processes that do work for this one, and end with it."""

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import connection
from typing import Any, TypeVar

from sandbox.physics.jit import work_beside_others

Result = TypeVar("Result")


@contextmanager
def worker_pool(processes: int) -> Iterator[ProcessPoolExecutor]:
    """Processes that what is submitted `interrupts_ignored` runs in; left by an exception, they are ended at once.

    They end with this process too, whatever ends it. Raises OSError where a process cannot be started, or is gone
    before it has answered.
    """
    # A new interpreter each: one that is copied would have threads that are not running any more.
    spawn = multiprocessing.get_context("spawn")
    others = set(multiprocessing.active_children())
    workers = ProcessPoolExecutor(processes, spawn, initializer=_begin)
    try:
        with _termination_raised():
            yield workers
            workers.shutdown()
    except BaseException as error:
        workers.shutdown(wait=False, cancel_futures=True)
        for child in set(multiprocessing.active_children()) - others:
            child.terminate()
        # Its threads find their pipes closed, and would print so as the process ends.
        workers.shutdown()
        if isinstance(error, BrokenProcessPool):
            raise OSError(0, "a process has ended before it has answered; is there memory for all?") from None
        raise


def done_in_order(
    task: Callable[..., Result], tasks: Sequence[Sequence[Any]], processes: int
) -> Generator[Result, None, None]:
    """What a task gives for each of these arguments, in order, as soon as it is known; with one process, in this one.

    Close it if not all of them are wanted: processes would work on otherwise.
    Raises OSError where a process cannot be started, or is gone before it has answered.
    """
    if processes == 1:
        yield from (task(*each) for each in tasks)
        return
    with worker_pool(processes) as workers:
        with interrupts_ignored():
            waiting = [workers.submit(task, *each) for each in tasks]
        yield from (each.result() for each in waiting)


@contextmanager
def _termination_raised() -> Iterator[None]:
    """Being asked to terminate leaves this as an exception, so that everything is put away; others keep their way."""
    if threading.current_thread() is not threading.main_thread() or signal.getsignal(signal.SIGTERM) != signal.SIG_DFL:
        yield
        return
    signal.signal(signal.SIGTERM, lambda number, _: sys.exit(128 + number))
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _begin() -> None:
    """Begin as a worker: interrupts are for its parent, and it ends when that has."""
    work_beside_others()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        # The system closes the other end of what this waits for, however the parent ends. A worker has nothing to save.
        connection.wait([parent.sentinel])
        os._exit(1)


@contextmanager
def interrupts_ignored() -> Iterator[None]:
    """An interrupt goes to all processes: those that are started in here leave it to this one."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    previous = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, previous)
