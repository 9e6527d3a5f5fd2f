"""Runs of a text: pieces of one direction, in the order in which they are seen from left to right.

Of Unicode Standard Annex 9, in a line that begins at the left: letters of right-to-left scripts with what lies between
them are one stretch, whose pieces are seen last to first; numbers within it stay as they are.
"""

import unicodedata
from itertools import groupby
from typing import NamedTuple

_RIGHT_TO_LEFT = ("R", "AL")
_NUMBERS = ("EN", "AN")


class TextRun(NamedTuple):
    """A piece of a text; turned: its letters go from right to left."""

    text: str
    turned: bool


def runs(text: str) -> list[TextRun]:
    """The runs of a text without line breaks."""
    kinds = [unicodedata.bidirectional(char) for char in text]
    turned = [k for k, kind in enumerate(kinds) if kind in _RIGHT_TO_LEFT]
    if not turned:
        return [TextRun(text, False)]
    result: list[TextRun] = []
    done = 0
    for first, last in _stretches(kinds, turned):
        if first > done:
            result.append(TextRun(text[done:first], False))
        pieces = groupby(range(first, last), lambda k: kinds[k] not in _NUMBERS)
        found = [TextRun("".join(text[k] for k in places), is_turned) for is_turned, places in pieces]
        result += reversed(found)
        done = last
    if done < len(text):
        result.append(TextRun(text[done:], False))
    return result


def _stretches(kinds: list[str], turned: list[int]) -> list[tuple[int, int]]:
    # From a right-to-left letter to the last before one that goes from left to right, with the marks upon that.
    found = [(turned[0], turned[0] + 1)]
    for k in turned[1:]:
        first, last = found[-1]
        if "L" in kinds[last:k]:
            found.append((k, k + 1))
        else:
            found[-1] = first, k + 1
    return [(first, _with_marks(kinds, last)) for first, last in found]


def _with_marks(kinds: list[str], last: int) -> int:
    while last < len(kinds) and kinds[last] == "NSM":
        last += 1
    return last
