"""Names: the names of the slots of one kind, and the slot of each name."""

import bisect
from collections.abc import Sequence


class Names:
    """Names of slots from 0 on, each given once; in_order: by slot. A slot may have second names to be found by."""

    def __init__(self) -> None:
        self.in_order: list[str] = []
        self._slots: dict[str, int] = {}
        self._second: list[str] = []

    @property
    def second(self) -> list[tuple[str, int]]:
        """The second names, with their slots, as they were given."""
        return [(name, self._slots[name]) for name in self._second]

    def slot(self, name: str) -> int:
        """The slot of that name. Raises KeyError."""
        return self._slots[name]

    def unused(self, prefix: str, count: int) -> list[str]:
        """Names of that prefix and a number each, the next that are free where they are given in order from 0 on."""
        beyond = 1
        while f"{prefix}{beyond - 1}" in self._slots:
            beyond *= 2
        first = bisect.bisect_left(range(beyond), True, key=lambda number: f"{prefix}{number}" not in self._slots)
        return [f"{prefix}{number}" for number in range(first, first + count)]

    def append(self, names: Sequence[str]) -> None:
        """Name the next slots. Raises ValueError for a name that is taken."""
        fresh = {name: len(self.in_order) + index for index, name in enumerate(names)}
        taken = next((name for name in names if name in self._slots), None)
        if taken is not None or len(fresh) != len(names):
            raise ValueError(f"the name {taken or 'of two new slots'!r} is taken")
        self._slots.update(fresh)
        self.in_order.extend(names)

    def add_second(self, slot: int, name: str) -> None:
        """Give a slot a second name. Raises ValueError where that is taken."""
        if name in self._slots:
            raise ValueError(f"the name {name!r} is taken")
        self._slots[name] = slot
        self._second.append(name)

    def forget_beyond(self, count: int) -> None:
        """Drop the names of all slots but the first `count`, second names given since included."""
        while self._second and self._slots[self._second[-1]] >= count:
            del self._slots[self._second.pop()]
        for name in self.in_order[count:]:
            del self._slots[name]
        del self.in_order[count:]
