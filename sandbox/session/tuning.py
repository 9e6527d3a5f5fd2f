"""Tuning: what was set of a run's materials, bodies, air and solver, which another run of its level can begin with."""

from collections.abc import Collection
from dataclasses import asdict, replace
from typing import Any

from sandbox.session.commands import Command, SetAir, SetCoefficients, SetFirmness, SetGravity, SetInflation, SetSolver
from sandbox.session.session import Session

TUNING: tuple[type[Command], ...] = (SetCoefficients, SetFirmness, SetInflation, SetGravity, SetAir, SetSolver)
# What such a command is about, where it is not about all.
SUBJECTS = ("material", "body")


def tuning_of(session: Session, kinds: Collection[type[Command]] = TUNING) -> list[Command]:
    """The commands of these kinds that count at the present tick, each at once, without what a later one sets too."""
    found: dict[tuple[Any, ...], Command] = {}
    for entry in session.history.timeline:
        if entry.in_effect and entry.tick <= session.tick and type(entry.command) in kinds:
            command: Any = entry.command
            command = replace(command, duration=0)
            values = {name: value for name, value in asdict(command).items() if value is not None}
            if len(values) == 1:
                continue
            key = type(command), frozenset(values), *(values.get(name) for name in SUBJECTS)
            found.pop(key, None)
            found[key] = command
    return list(found.values())
