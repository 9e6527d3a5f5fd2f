"""Random zones, water, counters and rules, of every kind of question and action, for a random level."""

import random
from typing import Any

Part = dict[str, Any]

KEYS = ("g", "h")
MOST_RULES = 12


def answers(chance: random.Random, bodies: list[Part], particles: list[Part]) -> Part:
    """What makes a level of these bodies and particles answer."""
    zones = [_zone(chance, f"z{k}") for k in range(chance.randint(1, 4))]
    asks = _Asks(chance, bodies, particles, [zone["id"] for zone in zones])
    rules = [
        {"id": f"r{k}", "when": asks.question(2), "then": [asks.action() for _ in range(chance.randint(1, 3))],
         "once": chance.random() < 0.3, "for_seconds": chance.choice([0.0, 0.0, 0.05, 0.2])}
        for k in range(chance.randint(1, MOST_RULES))
    ]  # fmt: skip
    counters = [{"id": name, "start": chance.randint(-2, 2)} for name in ("c0", "c1")]
    return {"zones": zones, "counters": counters, "rules": rules}


def _number(chance: random.Random, low: float, high: float) -> float:
    return round(chance.uniform(low, high), 3)


def _zone(chance: random.Random, name: str) -> Part:
    x, y, size = _number(chance, -6.0, 5.0), _number(chance, -0.5, 6.0), _number(chance, 0.3, 4.0)
    box = {"id": name, "box": [x, y, x + size, y + _number(chance, 0.3, 4.0)]}
    if chance.random() < 0.5:
        flow = chance.choice([[0.0, 0.0], [_number(chance, -3.0, 3.0), _number(chance, -1.0, 1.0)]])
        drags = {"fast_drag": chance.choice([0.0, 1.0, 8.0]), "slow_drag": chance.choice([0.0, 0.5, 5.0])}
        return box | {"water": {"density": chance.choice([1.0, 10.0, 300.0]), "flow": flow} | drags}
    corners = [[x, y], [x + size, y + _number(chance, -0.2, 0.2)], [x + 0.4 * size, y + size]]
    return chance.choice([box, {"id": name, "circle": [x, y, size]}, {"id": name, "polygon": corners}])


class _Asks:
    """Questions and actions about the things of a level."""

    def __init__(self, chance: random.Random, bodies: list[Part], particles: list[Part], zones: list[str]) -> None:
        self.chance, self.zones = chance, zones
        self.bodies = [body["id"] for body in bodies]
        self.jellies = [body["id"] for body in bodies if body["type"] == "jelly"]
        self.wheels = [body["id"] for body in bodies if "motor" in body]
        # Every body has three particles at least.
        self.particles = [f"{body}.{k}" for body in self.bodies for k in range(3)] + [each["id"] for each in particles]
        self.things = self.bodies + [each["id"] for each in particles]

    def question(self, depth: int) -> Part:
        """A question; depth: how many groups may lie within one another."""
        chance = self.chance
        if depth and chance.random() < 0.25:
            members = [self.question(depth - 1) for _ in range(chance.randint(1, 3))]
            return {chance.choice(["all", "any", "none"]): members}
        return chance.choice([
            self._metric, self._metric, self._inside, self._touches, self._touches, self._crosses, self._breaks,
            self._counter, self._key, self._time,
        ])()  # fmt: skip

    def _owner(self) -> Part:
        return self.chance.choice([{"body": self.chance.choice(self.bodies)},
                                   {"particle": self.chance.choice(self.particles)}])  # fmt: skip

    def _bounds(self, low: float, high: float) -> Part:
        return {self.chance.choice(["at_least", "at_most"]): _number(self.chance, low, high)}

    def _metric(self) -> Part:
        body = {"body": self.chance.choice(self.bodies)}
        first, second = self.chance.sample(self.particles, 2)
        return self.chance.choice([
            {"metric": "x"} | self._owner() | self._bounds(-5.0, 5.0),
            {"metric": "y"} | self._owner() | self._bounds(0.0, 6.0),
            {"metric": "speed"} | self._owner() | self._bounds(0.0, 8.0),
            {"metric": "distance", "particle": first, "other": second} | self._bounds(0.0, 4.0),
            {"metric": "strain"} | body | self._bounds(0.0, 0.5), {"metric": "settled"} | body,
            {"metric": "broken_springs"} | body | self._bounds(0.0, 3.0),
            {"metric": "kinetic_energy"} | self._bounds(0.0, 100.0), {"metric": "max_speed"} | self._bounds(0.0, 20.0),
            {"metric": "non_finite", "at_most": 0.0},
        ])  # fmt: skip

    def _inside(self) -> Part:
        return {"metric": "inside", "zone": self.chance.choice(self.zones)} | self._owner()

    def _touches(self) -> Part:
        first = self.chance.choice(self.things)
        others = [each for each in self.things if each != first]
        return {"touches": [first, *self.chance.choice([[], [self.chance.choice(others)]] if others else [[]])]}

    def _crosses(self) -> Part:
        return {"crosses": self.chance.choice(self.zones)} | self._owner()

    def _breaks(self) -> Part:
        return {"breaks": self.chance.choice(self.bodies)}

    def _counter(self) -> Part:
        return {"counter": self.chance.choice(["c0", "c1"])} | self._bounds(-3.0, 5.0)

    def _key(self) -> Part:
        return {"key": self.chance.choice(KEYS)}

    def _time(self) -> Part:
        return {"time": _number(self.chance, 0.0, 1.0)}

    def action(self) -> Part:
        """Something to do."""
        chance = self.chance
        soft = [{"sag": _number(chance, 0.0, 0.3), "body": each, "during": 0.1} for each in self.jellies]
        driven = [{"drive": each, "value": chance.choice([-1.0, 0.0, 1.0])} for each in self.wheels]
        return chance.choice([
            {"win": "won"}, {"win": "counted", "stars": {"counter": "c0", "second": 1.0, "third": 3.0}},
            {"fail": "lost"}, {"say": "said"}, {"sound": "bell"}, {"checkpoint": True},
            {"count": chance.choice(["c0", "c1"]), "by": chance.choice([1.0, -2.0, 0.5])},
            {"cut": chance.choice(self.bodies)}, {"cut": f"{chance.choice(self.bodies)}:0"},
            {"pin": chance.choice(self.particles)}, {"unpin": chance.choice(self.particles)},
            {"gravity": [0.0, _number(chance, -12.0, 4.0)], "during": chance.choice([0.0, 0.3])},
            {"wind": [_number(chance, -6.0, 6.0), 0.0]}, *soft, *driven,
        ])  # fmt: skip
