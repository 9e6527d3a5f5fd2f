"""RangeTrial: one number of a level tried with several values: where things go, and which checks hold."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from sandbox.editor.document import Document, EditError
from sandbox.editor.forecast import Trail
from sandbox.editor.items import chosen_bodies, chosen_springs
from sandbox.editor.panel.level_properties import level_properties
from sandbox.editor.panel.material_properties import material_sections
from sandbox.editor.panel.properties import properties
from sandbox.editor.panel.property import MIXED, Property
from sandbox.level.checks import CheckResult
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.quantities import significant
from sandbox.level.format.slices import work_for
from sandbox.session.check_run import checks_as_they_end

# Values that are tried at a time, at most.
MOST_VALUES = 40
# Digits that the values between the ends of a range have.
DIGITS = 6


@dataclass(frozen=True)
class Number:
    """A number that can be tried: a property, the axis of one that is a point, and what it is called, with its unit."""

    about: Property
    axis: int | None
    title: str

    @property
    def value(self) -> float:
        """The present value as it is typed: angles in degrees."""
        return float(self.about.texts[self.axis or 0])

    def set(self, document: Document, value: float) -> Document:
        """The document with another value. Raises EditError."""
        typed = self.about.typed(f"{value:.17g}", self.axis or 0)
        return self.about.set(document, typed)


@dataclass
class Attempt:
    """A value, and what came of it: the level, results of its checks by place, its trail, or the reason for none."""

    value: float
    level: Level | None = None
    results: dict[int, CheckResult] = field(default_factory=dict)
    trail: Trail | None = None
    fault: str = ""

    @property
    def failed(self) -> int:
        """How many checks do not hold."""
        return sum(not result.passed for result in self.results.values())


class RangeTrial:
    """Tries values one after the other, a slice of time at a time; the document stays as it is."""

    def __init__(self, document: Document, number: Number, values: Sequence[float]) -> None:
        self.document, self.number = document, number
        self.attempts = [Attempt(value) for value in values]
        self.done = 0
        self._work = self._run()

    @property
    def is_done(self) -> bool:
        """Whether all values have been tried."""
        return self.done == len(self.attempts)

    def advance(self, seconds: float) -> None:
        """Work for about that long, at least one tick."""
        work_for(self._work, seconds)

    def _run(self) -> Iterator[None]:
        for attempt in self.attempts:
            try:
                attempt.level = self.number.set(self.document, attempt.value).level
                trail = Trail(attempt.level)
                while not trail.advance(0.0):
                    yield None
                attempt.trail = trail
                for found in checks_as_they_end(attempt.level):
                    if found is not None:
                        attempt.results[found[0]] = found[1]
                    yield None
            except EditError as error:
                attempt.fault = str(error)
            except LevelError as error:
                attempt.fault = error.faults[0]
            self.done += 1
            yield None


def numbers(document: Document) -> list[Number]:
    """Every number that can be tried of what is selected and of its materials; of nothing, of the level itself."""
    sections = properties(document) if document.selection else level_properties(document)
    found = [number for section in sections for each in section.properties for number in _numbers(each)]
    level, selection = document.level, document.selection
    names = [body.material for body in chosen_bodies(level, selection)]
    names += [spring.material for spring in chosen_springs(level, selection)]
    for name in dict.fromkeys(names):
        *numeric, _look = material_sections(level, name)
        found += [number for part in numeric for each in part.properties for number in _numbers(each, f" of {name}")]
    return found


def _numbers(each: Property, of: str = "") -> list[Number]:
    about = each.about
    unit = f" [{about.unit}]" if about.unit else ""
    if not each.editable or each.value is None or each.value is MIXED:
        return []
    if about.kind == "point":
        axes = [axis for axis in (0, 1) if each.value[axis] is not MIXED]
        return [Number(each, axis, f"{about.title} {each.axes[axis]}{of}{unit}") for axis in axes]
    return [Number(each, None, f"{about.title}{of}{unit}")] if about.kind in ("number", "integer") else []


def between(low: float, high: float, count: int, *, whole: bool) -> list[float]:
    """`count` values from low to high, both included, at even distances. Raises EditError."""
    if low == high:
        raise EditError("from and to are the same; give a range")
    if not 2 <= count <= MOST_VALUES:
        raise EditError(f"how many: give a whole number from 2 to {MOST_VALUES}")
    values = [low + (high - low) * k / (count - 1) for k in range(count)]
    return list(dict.fromkeys(float(round(value)) if whole else significant(value, DIGITS) for value in values))
