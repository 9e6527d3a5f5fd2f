"""Happenings: what happened in a run and when, by name, a line each; many alike soon after each other share one."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

# Of so many alike and more, each so soon after the one before [s], one line tells.
MANY, SOON = 4, 0.5
# Names that such a line has.
NAMED = 3
# What happens by itself.
KINDS = (
    "touch", "part", "break", "enter", "leave", "count", "win", "lose", "checkpoint", "rule", "freeze", "unlisted"
)  # fmt: skip
_OF_TOUCHES = ("touch", "part")
# Lines of a list that is to be read.
MOST_LINES = 60


@dataclass(frozen=True)
class Happening:
    """Something that happened: at a tick, or several times until `last`.

    kind: one of KINDS, or what a person did: "grab", "release", "pin", "unpin", "cut" or the type of another command.
    names: of the things it is about; but for touches, the first is what it is grouped by.
    """

    tick: int
    last: int
    kind: str
    names: tuple[str, ...]
    text: str

    def line(self, rate: int) -> str:
        """The time [s] and what happened; rate: ticks in a second."""
        until = f", until {self.last / rate:.2f} s" if self.last > self.tick else ""
        return f"{self.tick / rate:8.2f} s  {self.text}{until}"

    def data(self, rate: int) -> dict[str, Any]:
        """The same for programs, ready for JSON."""
        return {
            **asdict(self),
            "names": list(self.names),
            "seconds": self.tick / rate,
            "last_seconds": self.last / rate,
        }


def listed(names: Iterable[str]) -> str:
    """Names in a sentence: the first ones, and how many more."""
    known = list(dict.fromkeys(names))
    more = len(known) - NAMED
    # The name of one more is no longer than saying so.
    shown = known if more == 1 else known[:NAMED]
    if more > 1:
        return f"{', '.join(shown)} and {more} more"
    return shown[0] if len(shown) == 1 else f"{', '.join(shown[:-1])} and {shown[-1]}"


def grouped(happenings: Sequence[Happening], rate: int) -> list[Happening]:
    """In the order of time, many that are alike and soon after each other as one; rate: ticks in a second."""
    gap = round(SOON * rate)
    by_kind: dict[str, list[Happening]] = {}
    for each in in_order(happenings):
        by_kind.setdefault(each.kind, []).append(each)
    told: list[Happening] = []
    for kind, those in by_kind.items():
        many = _MANY.get(kind)
        told += those if many is None else _joined(those, gap, many)
    return in_order(told)


def in_order(happenings: Iterable[Happening]) -> list[Happening]:
    """In the order of time, and of causes within a tick."""
    return sorted(happenings, key=_when)


def shortened(happenings: Sequence[Happening], most: int = MOST_LINES) -> tuple[list[Happening], int]:
    """So many of a list, and how many were left out: the last ones of who touched whom, and nothing else."""
    touches = [each for each in happenings if each.kind in _OF_TOUCHES]
    dropped = touches[max(0, most - (len(happenings) - len(touches))) :]
    left_out = set(dropped)
    return [each for each in happenings if each not in left_out], len(dropped)


def _when(happening: Happening) -> tuple[int, int, int]:
    """By the tick; in one tick what was done before what came of it, and what rules ask before what they do."""
    kind = happening.kind
    return happening.tick, KINDS.index(kind) if kind in KINDS else -1, happening.last


def _joined(those: list[Happening], gap: int, many: Callable[[str, list[Happening]], str]) -> Iterator[Happening]:
    """Those of one kind, in the order of time, joined by what most of them share a name of."""
    left = dict.fromkeys(those)
    counts = Counter(name for each in those for name in dict.fromkeys(_keys(each)))
    for name, count in counts.most_common():
        if count < MANY:
            break
        for burst in _bursts([each for each in left if name in _keys(each)], gap):
            if len(burst) >= MANY:
                for each in burst:
                    del left[each]
                names = (name, *dict.fromkeys(other for each in burst for other in each.names if other != name))
                last = max(each.last for each in burst)
                yield Happening(burst[0].tick, last, burst[0].kind, names, many(name, burst))
    yield from left


def _keys(happening: Happening) -> tuple[str, ...]:
    """The names that others may share with it."""
    return happening.names if happening.kind in _OF_TOUCHES else happening.names[:1]


def _bursts(those: list[Happening], gap: int) -> Iterator[list[Happening]]:
    burst: list[Happening] = []
    for each in those:
        if burst and each.tick - burst[-1].tick > gap:
            yield burst
            burst = []
        burst.append(each)
    if burst:
        yield burst


def _others(name: str, burst: list[Happening]) -> list[str]:
    return list(dict.fromkeys(other for each in burst for other in each.names if other != name))


def _many_touch(name: str, burst: list[Happening]) -> str:
    others = _others(name, burst)
    return f"{name} began to touch {len(others)} things: {listed(others)}"


def _many_part(name: str, burst: list[Happening]) -> str:
    others = _others(name, burst)
    return f"{name} parted from {len(others)} things: {listed(others)}"


def _many_break(name: str, burst: list[Happening]) -> str:
    return f"{len(burst)} springs of {name} broke"


def _many_count(name: str, burst: list[Happening]) -> str:
    return f"{name} was counted {len(burst)} times; {burst[-1].text}"


def _many_zone(name: str, burst: list[Happening]) -> str:
    verb = "entered" if burst[0].kind == "enter" else "left"
    things = _others(name, burst)
    return f"{len(things)} things {verb} {name}: {listed(things)}"


def _many_alike(name: str, burst: list[Happening]) -> str:
    return f"{burst[0].text}, {len(burst)} times in all"


_MANY: dict[str, Callable[[str, list[Happening]], str]] = {
    "touch": _many_touch, "part": _many_part, "break": _many_break, "count": _many_count, "enter": _many_zone,
    "leave": _many_zone, "rule": _many_alike, "pin": _many_alike, "unpin": _many_alike, "set_drive": _many_alike,
    "hold_key": _many_alike,
}  # fmt: skip
