"""Worker pool: processes that do work for this one, and end with it."""

import multiprocessing
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager


@contextmanager
def worker_pool(processes: int) -> Iterator[ProcessPoolExecutor]:
    """Processes that what is submitted `interrupts_ignored` runs in; left by an exception, they are ended at once.

    Raises OSError where a process cannot be started, or is gone before it has answered.
    """
    # A new interpreter each: one that is copied would have threads that are not running any more.
    spawn = multiprocessing.get_context("spawn")
    others = set(multiprocessing.active_children())
    workers = ProcessPoolExecutor(processes, spawn, initializer=signal.signal, initargs=(signal.SIGINT, signal.SIG_IGN))
    try:
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
