"""Deeds: what a person did in a run, as happenings, by the records of the commands."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from sandbox.level.things.names import thing_of, thing_of_spring
from sandbox.session.commands.records import ScriptLine
from sandbox.session.events.happening import Happening, listed

Record = dict[str, Any]


def deeds_in(script: Iterable[ScriptLine]) -> Iterator[Happening]:
    """What was done, in order. Alike commands of one gesture, such as a slider that is dragged, are one."""
    held: dict[Any, str] = {}
    going: dict[tuple[int, str], tuple[int, int, Record]] = {}
    for line in script:
        kind = str(line.record.get("type"))
        if kind == "grab":
            held[line.record.get("grab")] = particle = str(line.record.get("particle"))
            yield Happening(line.tick, line.tick, kind, (thing_of(particle),), f"{particle} was grabbed")
        elif kind == "release":
            particle = held.pop(line.record.get("grab"), "")
            if particle:
                yield Happening(line.tick, line.tick, kind, (thing_of(particle),), f"{particle} was let go")
        elif kind in _EACH:
            names, text = _EACH[kind](line.record)
            yield Happening(line.tick, line.tick, _KINDS.get(kind, kind), names, text)
        elif kind not in _PASSED_OVER:
            first, _, _ = going.get((line.gesture, kind), (line.tick, 0, line.record))
            going[line.gesture, kind] = first, line.tick, line.record
    for (_, kind), (first, last, record) in going.items():
        yield Happening(first, last, kind, _named(record), _told(record))


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
}


def _named(record: Record) -> tuple[str, ...]:
    name = record.get("body") or record.get("particle") or record.get("material")
    return (thing_of(str(name)),) if isinstance(name, str) else ()


def _told(record: Record) -> str:
    kind = str(record["type"])
    words, names = _WORDS[kind], _named(record)
    if not names:
        return words
    return f"{words} of {names[0]}" if kind == "set_coefficients" else f"{names[0]} {words}"
