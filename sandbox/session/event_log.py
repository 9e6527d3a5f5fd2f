"""The event log of a run: what happened and when, by name, a line each; many alike soon after each other share one.

It is made of the commands, which are what a person did, of the events that a run keeps of its ticks, and of what a
`TouchWatch` saw: who touched whom, and who was in which zone.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any, assert_never

import numpy as np
from numpy.typing import NDArray

from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.document.model import Level, ZoneDef
from sandbox.level.plan.rules import zones_of
from sandbox.level.plan.run_rules import run_rules
from sandbox.level.rules.rule import ActionDef
from sandbox.level.things.contacts import ContactListener
from sandbox.level.things.names import ThingNames, thing_of, thing_of_spring
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.arrays import Floats, Slots, empty
from sandbox.physics.ways import Ways, followed, rows_of
from sandbox.session.commands.records import ScriptLine, script_of
from sandbox.session.log import TickEvents
from sandbox.session.outcome import outcome
from sandbox.session.session import Session

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
# Two things that are apart for no longer than this are still in touch [s].
APART = 0.25
# Pairs that are remembered; of more it is said how many they are.
MOST_PAIRS = 2_000

Record = dict[str, Any]


@dataclass(frozen=True)
class Event:
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
        """The event as a dict, ready for JSON."""
        return {
            **asdict(self),
            "names": list(self.names),
            "seconds": self.tick / rate,
            "last_seconds": self.last / rate,
        }


@dataclass
class Meeting:
    """The time of two things together, from the first tick to the last; times: how often they came together.

    is_over: whether they are apart since `last`.
    """

    first: int
    last: int
    times: int = 1
    is_over: bool = False

    def begin(self) -> None:
        """Together again."""
        self.times += 1
        self.is_over = False

    def end(self, tick: int) -> None:
        """Apart, since that tick."""
        self.last, self.is_over = tick, True


class TouchWatch:
    """Told of every tick by `watch`.

    touches: by the ids of both; insides: by the ids of a thing and a zone that all of it was in at once, if only for a
    part of a tick. unlisted: pairs that there was no more room for. Its memory grows with the pairs, not with time.
    """

    def __init__(self, zones: Iterable[ZoneDef]) -> None:
        self.touches: dict[tuple[str, str], Meeting] = {}
        self.insides: dict[tuple[str, str], Meeting] = {}
        self.unlisted = 0
        self._zones = tuple(zones)
        self._inside: set[tuple[str, str]] | None = None
        self._ways = ZoneWays(self._zones)
        self._listener: ContactListener | None = None

    def following(self, states: Iterable[LevelWorld]) -> Iterator[LevelWorld]:
        """Pass states on, each watched before."""
        for world in states:
            self.watch(world)
            yield world

    def watch(self, world: LevelWorld) -> None:
        """Take in the world after a tick. Ticks come in order, none left out."""
        if self._listener is None:
            self._listener = ContactListener(round(APART * world.settings.tick_rate))
        events = self._listener.update(world)
        for contact in events.begin:
            self._begin(self.touches, contact.pair, world.tick)
        for pair in events.end:
            self._end(self.touches, pair, self._listener.last_touch(world.tick))
        if self._zones:
            self._watch_zones(world)

    def _watch_zones(self, world: LevelWorld) -> None:
        now = things_inside(world, self._zones)
        # What is there from the start has not entered.
        before = now if self._inside is None else self._inside
        # What came and went within the tick.
        passed = self._ways.passed(world) - before - now
        for pair in sorted((now - before) | passed):
            self._begin(self.insides, pair, world.tick)
        for pair in sorted((before - now) | passed):
            self.insides.setdefault(pair, Meeting(0, 0, 0))
            self._end(self.insides, pair, world.tick)
        self._inside = now

    def _begin(self, meetings: dict[tuple[str, str], Meeting], pair: tuple[str, str], tick: int) -> None:
        known = meetings.get(pair)
        if known is not None:
            known.begin()
        elif len(meetings) < MOST_PAIRS:
            meetings[pair] = Meeting(tick, tick)
        else:
            self.unlisted += 1

    def _end(self, meetings: dict[tuple[str, str], Meeting], pair: tuple[str, str], tick: int) -> None:
        if pair in meetings:
            meetings[pair].end(tick)


class ZoneWays:
    """The ways of all particles of a world through the zones of its level, which its ticks follow from `passed` on."""

    def __init__(self, zones: Sequence[ZoneDef]) -> None:
        self._zones = zones
        self._followed: tuple[LevelWorld, int] | None = None
        self._ways = empty(Ways)
        # The first row of each thing and zone, and their ids.
        self._first: Slots = np.zeros(0, np.int64)
        self._pairs: list[tuple[str, str]] = []

    def passed(self, world: LevelWorld) -> set[tuple[str, str]]:
        """Things with the zones that all their particles were in at once at some time of the last tick."""
        found = set()
        if self._pairs and world.ways is self._ways:
            span = world.ways.span[len(world.probe_position) :]
            first, last = np.maximum.reduceat(span[:, 0], self._first), np.minimum.reduceat(span[:, 1], self._first)
            found = {self._pairs[k] for k in np.flatnonzero(first <= last).tolist()}
        if self._followed != (world, world.topology_version):
            self._follow(world)
            self._followed = world, world.topology_version
        return found

    def _follow(self, world: LevelWorld) -> None:
        things, shown = ThingNames.of(world), shown_particles(world)
        owner = things.of_particle[shown]
        order = np.argsort(owner, kind="stable")
        slots, present = np.arange(world.particle_count)[shown][order], np.unique(owner)
        starts = np.searchsorted(owner[order], present)
        rows = [np.stack((slots, np.full(len(slots), k)), axis=1) for k in range(len(self._zones))]
        self._first = np.concatenate([starts + k * len(slots) for k in range(len(self._zones))])
        self._pairs = [(things.names[thing], zone.id) for zone in self._zones for thing in present.tolist()]
        of_rules = rows_of(world.ways)[: len(world.probe_position)]
        self._ways = followed(zones_of(self._zones), np.concatenate([of_rules, *rows]), world.particle_count)
        world.ways = self._ways


def things_inside(world: LevelWorld, zones: Iterable[ZoneDef]) -> set[tuple[str, str]]:
    """Things with the zones that all their particles are in, as the metric `inside` asks."""
    things, shown = ThingNames.of(world), shown_particles(world)
    count = len(things.names)
    owner = things.of_particle[shown]
    whole, position = np.bincount(owner, minlength=count), world.position[shown]
    found = set()
    for zone in zones:
        inside = np.bincount(owner[_in_zone(zone, position)], minlength=count)
        found |= {(things.names[thing], zone.id) for thing in np.flatnonzero((inside == whole) & (whole > 0)).tolist()}
    return found


def _in_zone(zone: ZoneDef, position: Floats) -> NDArray[np.bool_]:
    """Which places (n, 2) [m] lie in a zone."""
    x, y = position[:, 0], position[:, 1]
    with np.errstate(all="ignore"):
        if zone.box is not None:
            left, bottom, right, top = zone.box
            return np.asarray((x >= left) & (x <= right) & (y >= bottom) & (y <= top))
        if zone.circle is not None:
            middle_x, middle_y, radius = zone.circle
            return np.asarray((x - middle_x) ** 2 + (y - middle_y) ** 2 <= radius**2)
        inside = np.zeros(len(x), dtype=np.bool_)
        corners = zone.polygon or ()
        for (ax, ay), (bx, by) in zip(corners, (*corners[1:], *corners[:1]), strict=True):
            if ay != by:
                inside ^= ((ay > y) != (by > y)) & (x < (bx - ax) * (y - ay) / (by - ay) + ax)
        return inside


def events_of(run: Session, watch: TouchWatch | None = None) -> list[Event]:
    """The events of a run until its present tick, one by one, in the order of time, without undone ones.

    watch: one that watched all its ticks; None: without who touched whom and who was in which zone.
    """
    entries = [entry for entry in run.history.timeline if entry.in_effect and entry.tick <= run.tick]
    found = [*user_actions(script_of(entries, run.world)), *tick_events_of(run, run.tick)]
    if watch is not None:
        found += _of_watch(watch, run.tick)
    return in_order(found)


def event_log_of(run: Session, watch: TouchWatch | None = None) -> list[Event]:
    """The event log of a run as a person reads it: one line for many that are alike."""
    return grouped(events_of(run, watch), run.level.settings.tick_rate)


def watched_event_log(
    run: Session, ticks: int, on_tick: Callable[[], None] | None = None, watch: TouchWatch | None = None
) -> list[Event]:
    """The event_log_of of a run that goes on until a tick; on_tick: called after each. Raises CommandError."""
    watch = watch or TouchWatch(run.level.zones)
    watch.watch(run.world)
    while run.tick < ticks:
        run.advance()
        watch.watch(run.world)
        if on_tick is not None:
            on_tick()
    run.apply_pending()
    return event_log_of(run, watch)


def in_order(events_of: Iterable[Event]) -> list[Event]:
    """Events in the order of time, and of causes within a tick."""
    return sorted(events_of, key=_when)


def _when(event: Event) -> tuple[int, int, int]:
    """Sort key: the tick; in one tick deeds before what came of them, and questions of rules before actions."""
    kind = event.kind
    return event.tick, KINDS.index(kind) if kind in KINDS else -1, event.last


def shortened(events_of: Sequence[Event], most: int = MOST_LINES) -> tuple[list[Event], int]:
    """At most so many events, and how many were left out: the last of those of touching, and no others."""
    touches = [each for each in events_of if each.kind in _OF_TOUCHES]
    dropped = touches[max(0, most - (len(events_of) - len(touches))) :]
    left_out = set(dropped)
    return [each for each in events_of if each not in left_out], len(dropped)


def tick_events_of(run: Session, last: int) -> Iterator[Event]:
    """The events that a run itself keeps until a tick, which may lie ahead of the present one, in order."""
    names, known = run.world.spring_names, outcome(run.level, run.world)
    end = None if known is None else known.tick
    for tick, kept in sorted(run.history.tick_events.items()):
        if tick > last:
            break
        for slot in kept.broken:
            yield Event(tick, tick, "break", (thing_of_spring(names[slot]),), f"{names[slot]} broke")
        for name in kept.frozen:
            yield Event(tick, tick, "freeze", (name,), f"{name} went out of bounds and was frozen")
        for each in _of_rules(run.level, tick, kept):
            if each.kind in ("win", "lose"):
                # What ended first counts, and of one tick what stands first.
                if end is not None and end != tick:
                    continue
                end = tick - 1
            yield each


def _of_rules(level: Level, tick: int, kept: TickEvents) -> Iterator[Event]:
    """Events of the rules that fired in a tick."""
    values = dict(zip(level.counter_names, kept.counters, strict=False))
    for number in kept.rules:
        rule = run_rules(level)[number]
        for action in rule.then:
            if action.count is not None:
                values[action.count] = values.get(action.count, 0.0) + action.by
                text = f"{action.count} is {values[action.count]:g}"
                yield Event(tick, tick, "count", (action.count, rule.id), text)
            elif action.win is not None or action.fail is not None:
                kind, words = ("win", "won") if action.win is not None else ("lose", "lost")
                yield Event(tick, tick, kind, (rule.id,), f"{words}: {action.win or action.fail or rule.id}")
            elif action.checkpoint:
                yield Event(tick, tick, "checkpoint", (rule.id,), f"checkpoint ({rule.id})")
            else:
                yield Event(tick, tick, "rule", (rule.id,), f"rule {rule.id}: {_action_text(action)}")


def _action_text(action: ActionDef) -> str:
    (does,) = action.done
    value = getattr(action, does)
    match does:
        case "say" | "sound" | "cut" | "pin" | "unpin":
            return f"{does} {value}"
        case "gravity" | "wind":
            return f"{does} {', '.join(f'{each:g}' for each in value)}"
        case "sag":
            return f"{action.body} sags by {value:.0%}"
        case "drive":
            return f"drive {value} {action.value:g}"
        case "count":
            return f"count {value}"
        case "win" | "fail" | "checkpoint":
            return does
        case _:
            assert_never(does)


def _of_watch(watch: TouchWatch, end: int) -> Iterator[Event]:
    for (a, b), met in watch.touches.items():
        touched, parted = (f"{a} and {b} touched", f"{a} and {b} parted") if a != b else (
            f"{a} touched itself", f"{a} no longer touched itself"
        )  # fmt: skip
        yield Event(met.first, met.first, "touch", (a, b), touched + _times(met))
        if met.is_over:
            yield Event(met.last, met.last, "part", (a, b), parted)
    for (thing, zone), met in watch.insides.items():
        if met.times:
            yield Event(met.first, met.first, "enter", (zone, thing), f"{thing} entered {zone}{_times(met)}")
        if met.is_over:
            yield Event(met.last, met.last, "leave", (zone, thing), f"{thing} left {zone}")
    if watch.unlisted:
        yield Event(end, end, "unlisted", (), f"{watch.unlisted:,} more times things touched that are not listed")


def _times(met: Meeting) -> str:
    return f" ({met.times} times in all)" if met.times > 1 else ""


def user_actions(script: Iterable[ScriptLine]) -> Iterator[Event]:
    """The user's actions, in order. Alike commands of one gesture, such as a slider that is dragged, are one."""
    held: dict[Any, str] = {}
    going: dict[tuple[int, str], tuple[int, int, Record]] = {}
    for line in script:
        kind = str(line.record.get("type"))
        if kind == "grab":
            held[line.record.get("grab")] = particle = str(line.record.get("particle"))
            yield Event(line.tick, line.tick, kind, (thing_of(particle),), f"{particle} was grabbed")
        elif kind == "release":
            particle = held.pop(line.record.get("grab"), "")
            if particle:
                yield Event(line.tick, line.tick, kind, (thing_of(particle),), f"{particle} was let go")
        elif kind in _EACH:
            names, text = _EACH[kind](line.record)
            yield Event(line.tick, line.tick, _KINDS.get(kind, kind), names, text)
        elif kind not in _PASSED_OVER:
            first, _, _ = going.get((line.gesture, kind), (line.tick, 0, line.record))
            going[line.gesture, kind] = first, line.tick, line.record
    for (_, kind), (first, last, record) in going.items():
        yield Event(first, last, kind, _named(record), _record_text(record))


def _pinned(record: Record) -> tuple[tuple[str, ...], str]:
    particle = str(record.get("particle"))
    return (thing_of(particle),), f"{particle} was {record['type']}ned"


def _cut(record: Record) -> tuple[tuple[str, ...], str]:
    springs = [str(spring) for spring in record.get("springs") or ()]
    things = list(dict.fromkeys(map(thing_of_spring, springs)))
    if len(springs) == 1:
        return tuple(things), f"{springs[0]} was cut"
    return tuple(things), f"{len(springs)} springs of {listed(things)} were cut" if things else "nothing was cut"


def _driven(record: Record) -> tuple[tuple[str, ...], str]:
    part, value = str(record.get("part")), float(record.get("value") or 0.0)
    way = "stopped" if value == 0.0 else f"driven {'forward' if value > 0.0 else 'backward'}"
    return (part,), f"{part} was {way}" + (f" at {abs(value):.0%}" if 0.0 < abs(value) < 1.0 else "")


def _key(record: Record) -> tuple[tuple[str, ...], str]:
    key = str(record.get("key"))
    return (key,), f'the key "{key}" was {"pressed" if record.get("down") else "let go"}'


def _removed(record: Record) -> tuple[tuple[str, ...], str]:
    name = str(record.get("body") or thing_of(str(record.get("particle"))))
    return (name,), f"{name} was taken out"


def _added(record: Record) -> tuple[tuple[str, ...], str]:
    others = len(record.get("others") or ())
    what = str((record.get("body") or {}).get("type"))
    more = f" and {others} more {'body' if others == 1 else 'bodies'}" if others else ""
    return (), f"a {what}{more} joined"


_EACH: dict[str, Callable[[Record], tuple[tuple[str, ...], str]]] = {
    "pin": _pinned,
    "unpin": _pinned,
    "cut_springs": _cut,
    "set_drive": _driven,
    "hold_key": _key,
    "remove": _removed,
    "add_body": _added,
    "add_particle": lambda record: ((), "a particle joined"),
    "add_spring": lambda record: ((), f"a spring joined {record.get('particle_a')} and {record.get('particle_b')}"),
}
_KINDS = {"cut_springs": "cut"}
# What moves on what went before, and what takes things back: the timeline has what counts.
_PASSED_OVER = frozenset({"move_grab", "undo", "redo"})
_WORDS = {
    "free": "was freed",
    "move_body": "was moved",
    "push": "a push",
    "shake": "a shake",
    "set_gravity": "gravity was set",
    "set_air": "wind or drag was set",
    "set_solver": "the solver was set",
    "set_coefficients": "Cs and Cd were set",
    "set_firmness": "became softer or firmer",
    "set_inflation": "was pumped up",
    "scale_mass": "became lighter or heavier",
    "set_colour": "was painted",
}


def _named(record: Record) -> tuple[str, ...]:
    name = record.get("body") or record.get("particle") or record.get("material")
    return (thing_of(str(name)),) if isinstance(name, str) else ()


def _record_text(record: Record) -> str:
    kind = str(record["type"])
    words, names = _WORDS[kind], _named(record)
    if not names:
        return words
    return f"{words} of {names[0]}" if kind == "set_coefficients" else f"{names[0]} {words}"


def grouped(events_of: Sequence[Event], rate: int) -> list[Event]:
    """Events in the order of time, many that are alike and soon after each other as one; rate: ticks in a second."""
    gap = round(SOON * rate)
    by_kind: dict[str, list[Event]] = {}
    for each in in_order(events_of):
        by_kind.setdefault(each.kind, []).append(each)
    events: list[Event] = []
    for kind, those in by_kind.items():
        many = _MANY.get(kind)
        events += those if many is None else _joined(those, gap, many)
    return in_order(events)


def listed(names: Iterable[str]) -> str:
    """Names in a sentence: the first ones, and how many more."""
    known = list(dict.fromkeys(names))
    more = len(known) - NAMED
    # The name of one more is no longer than saying so.
    shown = known if more == 1 else known[:NAMED]
    if more > 1:
        return f"{', '.join(shown)} and {more} more"
    return shown[0] if len(shown) == 1 else f"{', '.join(shown[:-1])} and {shown[-1]}"


def _joined(those: list[Event], gap: int, many: Callable[[str, list[Event]], str]) -> Iterator[Event]:
    """Events of one kind, in the order of time, joined by the name that most of them share."""
    remaining = dict.fromkeys(those)
    counts = Counter(name for each in those for name in dict.fromkeys(_keys(each)))
    for name, count in counts.most_common():
        if count < MANY:
            break
        for burst in _bursts([each for each in remaining if name in _keys(each)], gap):
            if len(burst) >= MANY:
                for each in burst:
                    del remaining[each]
                names = (name, *dict.fromkeys(other for each in burst for other in each.names if other != name))
                last = max(each.last for each in burst)
                yield Event(burst[0].tick, last, burst[0].kind, names, many(name, burst))
    yield from remaining


def _keys(event: Event) -> tuple[str, ...]:
    """The names in an event that others may share."""
    return event.names if event.kind in _OF_TOUCHES else event.names[:1]


def _bursts(those: list[Event], gap: int) -> Iterator[list[Event]]:
    burst: list[Event] = []
    for each in those:
        if burst and each.tick - burst[-1].tick > gap:
            yield burst
            burst = []
        burst.append(each)
    if burst:
        yield burst


def _others(name: str, burst: list[Event]) -> list[str]:
    return list(dict.fromkeys(other for each in burst for other in each.names if other != name))


def _many_touch(name: str, burst: list[Event]) -> str:
    others = _others(name, burst)
    return f"{name} began to touch {len(others)} things: {listed(others)}"


def _many_part(name: str, burst: list[Event]) -> str:
    others = _others(name, burst)
    return f"{name} parted from {len(others)} things: {listed(others)}"


def _many_break(name: str, burst: list[Event]) -> str:
    return f"{len(burst)} springs of {name} broke"


def _many_count(name: str, burst: list[Event]) -> str:
    return f"{name} was counted {len(burst)} times; {burst[-1].text}"


def _many_zone(name: str, burst: list[Event]) -> str:
    verb = "entered" if burst[0].kind == "enter" else "left"
    things = _others(name, burst)
    return f"{len(things)} things {verb} {name}: {listed(things)}"


def _many_alike(name: str, burst: list[Event]) -> str:
    return f"{burst[0].text}, {len(burst)} times in all"


_MANY: dict[str, Callable[[str, list[Event]], str]] = {
    "touch": _many_touch, "part": _many_part, "break": _many_break, "count": _many_count, "enter": _many_zone,
    "leave": _many_zone, "rule": _many_alike, "pin": _many_alike, "unpin": _many_alike, "set_drive": _many_alike,
    "hold_key": _many_alike,
}  # fmt: skip
