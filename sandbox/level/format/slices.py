"""Work in slices: generators that say after each slice how much is done, and give what they made in the end."""

import time
from collections.abc import Callable, Generator, Iterator
from typing import TypeVar

Said = TypeVar("Said")
Told = TypeVar("Told")
Made = TypeVar("Made")


def work_for(slices: Iterator[object], seconds: float) -> bool:
    """Go on with some work for about that long [s], at least one slice of it; whether it is done."""
    # The clock says when to pause, never what comes out.
    end = time.perf_counter() + seconds
    return all(time.perf_counter() < end for _ in slices)


def telling(slices: Generator[Said, None, Made], tell: Callable[[Said], Told]) -> Generator[Told, None, Made]:
    """The same work, which says after each slice what `tell` makes of what it says."""
    while True:
        try:
            said = next(slices)
        except StopIteration as end:
            made: Made = end.value
            return made
        yield tell(said)


def goes_on(_: object) -> bool:
    """Of whatever work says: that it goes on."""
    return True


def at_once(slices: Generator[object, None, Made]) -> Made:
    """The result of work that is done in slices, made without a pause."""
    while True:
        try:
            next(slices)
        except StopIteration as end:
            made: Made = end.value
            return made


def as_part(slices: Generator[float, None, Made], first: float, last: float) -> Generator[float, None, Made]:
    """Work that says how much of it is done, 0..1, as the part from `first` to `last` of a larger one."""
    return telling(slices, lambda done: first + (last - first) * done)
