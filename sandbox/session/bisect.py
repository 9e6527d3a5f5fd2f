"""Bisecting: which edits, or which value of a setting, decide whether a level keeps its checks or a recording."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.quantities import replaced
from sandbox.session.check_run import checks_as_they_end
from sandbox.session.compare.comparison import verify
from sandbox.session.level_edits import Edit, edited, level_edits, with_value
from sandbox.session.replay.recording import Replay, ReplayError

# Halvings of an interval of values that are not whole, at most, and the part of it that is near enough.
MOST_HALVINGS, NEAR = 40, 1e-6

# Whether a level does what it should.
Trial = Callable[[Level], bool]


class BisectError(ValueError):
    """Two ends between which nothing can be sought; one line."""


@dataclass(frozen=True)
class Tried:
    """A level that was tried, and whether it passed; None: it is no valid level."""

    what: str
    holds: bool | None


def checks_hold(names: Sequence[str]) -> Trial:
    """Whether a level keeps its checks, or those of these names. The trial raises BisectError where there are none."""

    def holds(level: Level) -> bool:
        chosen = tuple(check for check in level.checks if not names or check.name in names)
        if not chosen or (names and {check.name for check in chosen} != set(names)):
            known = ", ".join(f'"{check.name}"' for check in level.checks) or "none"
            raise BisectError(f"{level.name}: there is no such check; it has {known}")
        # What fails early needs no more.
        results = checks_as_they_end(replaced(level, checks=chosen))
        return all(found[1].passed for found in results if found is not None)

    return holds


def recording_holds(replay: Replay) -> Trial:
    """Whether a recording runs on a level with every bit as it was; a command that fails there is no."""

    def holds(level: Level) -> bool:
        try:
            return verify(replay, level=level) is None
        except ReplayError:
            return False

    return holds


def deciding_edits(good: Level, bad: Level, holds: Trial) -> Iterator[Tried | list[Edit]]:
    """Find a least set of the edits from a good level to a bad one that make it fail; each trial, and last the set.

    Delta debugging after Zeller and Hildebrandt 2002: without any one of the edits that are found it holds. The checks
    are those of the bad level throughout. Raises BisectError where the good one fails or the bad one holds.
    """
    good = replaced(good, checks=bad.checks)
    edits = level_edits(good, bad)
    if not edits:
        raise BisectError("the two levels do not differ in anything that runs")
    yield from _ends(good, bad, holds, "the first level", "the second level")
    parts = 2
    while len(edits) > 1:
        size = -(-len(edits) // parts)
        chunks = [edits[k : k + size] for k in range(0, len(edits), size)]
        rests = [[edit for edit in edits if edit not in chunk] for chunk in chunks]
        candidates = [*chunks, *(rests if parts > 2 else [])]
        for number, chosen in enumerate(candidates):
            tried = _tried(good, chosen, holds)
            yield tried
            if tried.holds is False:
                edits, parts = chosen, 2 if number < len(chunks) else max(2, parts - 1)
                break
        else:
            if parts >= len(edits):
                break
            parts = min(len(edits), 2 * parts)
    yield edits


def deciding_value(
    level: Level, path: str, good: float, bad: float, holds: Trial
) -> Iterator[Tried | tuple[float, float]]:
    """Find where between two values of a field a level begins to fail; each trial, and last the two values around it.

    Whole numbers stay whole. Raises BisectError where the good value fails or the bad one holds, and LevelError where
    there is no such field.
    """
    is_whole = isinstance(good, int) and isinstance(bad, int)
    ends = [with_value(level, path, value) for value in (good, bad)]
    yield from _ends(ends[0], ends[1], holds, f"{path} = {good:g}", f"{path} = {bad:g}")
    least = 1 if is_whole else NEAR * abs(bad - good)
    for _ in range(MOST_HALVINGS):
        if abs(bad - good) <= least:
            break
        middle = (good + bad) // 2 if is_whole else 0.5 * (good + bad)
        try:
            held = holds(with_value(level, path, middle))
        except LevelError as error:
            raise BisectError(f"{path} = {middle:g}: {error.faults[0]}") from None
        yield Tried(f"{path} = {middle:g}", held)
        good, bad = (middle, bad) if held else (good, middle)
    yield good, bad


def _ends(good: Level, bad: Level, holds: Trial, first: str, second: str) -> Iterator[Tried]:
    for level, name, expected in ((good, first, True), (bad, second, False)):
        held = holds(level)
        yield Tried(name, held)
        if held is not expected:
            raise BisectError(f"{name} {'fails' if expected else 'holds'} already: give one that {_DOES[expected]}")


_DOES = {True: "holds", False: "fails"}


def _tried(good: Level, edits: Sequence[Edit], holds: Trial) -> Tried:
    what = f"with {len(edits)} edit{'s' if len(edits) > 1 else ''}: " + "; ".join(map(str, edits[:2]))
    try:
        return Tried(what, holds(edited(good, edits)))
    except (LevelError, KeyError, IndexError, TypeError):
        return Tried(what, None)
