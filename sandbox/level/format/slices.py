"""Work in slices: generators that say after each slice how much is done, and give what they made in the end."""

from collections.abc import Generator
from typing import TypeVar

Made = TypeVar("Made")


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
    while True:
        try:
            done = next(slices)
        except StopIteration as end:
            made: Made = end.value
            return made
        yield first + (last - first) * done
