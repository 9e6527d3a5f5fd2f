"""The base of commands: a frozen value, checked strictly, with a name in files, that is carried out on a world."""

from abc import ABC, abstractmethod
from collections.abc import Hashable
from dataclasses import replace
from typing import Any, ClassVar

from pydantic import ConfigDict, TypeAdapter, ValidationError

from sandbox.level.assembly.by_hand import hands_of, refusal_of, spend
from sandbox.level.format.level_error import shown
from sandbox.level.rules.hands import UNTOUCHED
from sandbox.physics.world import World
from sandbox.session.commands.conditions import Condition, faults_of
from sandbox.session.commands.faults import CommandError as CommandError
from sandbox.session.commands.faults import plain_fault
from sandbox.session.commands.named import namespaces

# Every command by the name that files use.
COMMAND_TYPES: dict[str, type["Command"]] = {}
_adapters: dict[type["Command"], TypeAdapter[Any]] = {}


class Command(ABC):
    """Something to do to a world. A command is a frozen dataclass of this base.

    Its fields are checked by their annotations, also where it was made without; a slot is annotated with the namespace
    by whose names files call it (named.py), so that nothing else is needed to write and read it as JSON. A program may
    give the name itself: Pin(particle="rope.5").
    """

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(
        strict=True, extra="forbid", revalidate_instances="always", allow_inf_nan=False
    )
    type: ClassVar[str]
    # What must hold of a world, beside that all it names is there; and the fault where there is nothing to act on.
    conditions: ClassVar[tuple[Condition, ...]] = ()
    nothing: ClassVar[str] = ""

    def __init_subclass__(cls) -> None:
        if "type" in vars(cls):
            assert cls.type not in COMMAND_TYPES, f"two commands are called {cls.type}"
            COMMAND_TYPES[cls.type] = cls

    @abstractmethod
    def carry_out(self, world: World) -> None:
        """Do it. Raises CommandError and changes nothing where it cannot be done."""

    def begins(self) -> Hashable | None:
        """A key for the process that it begins, such as the hold of one hand; None: it is over at once. A later
        command with the same key takes the process over.
        """
        return None

    def ending(self, world: World) -> "Command | None":
        """The command that ends the process that this one began, if it still goes on: an undo must leave nothing
        going.
        """
        return None


def adapter(kind: type[Command]) -> TypeAdapter[Any]:
    """The strict validator of one command type, made when it is first needed."""
    if kind not in _adapters:
        _adapters[kind] = TypeAdapter(kind)
    return _adapters[kind]


def with_slots(world: World, command: Command) -> Command:
    """The command with slots in place of the names that it was made with. Raises CommandError."""
    found: dict[str, Any] = {}
    for field, names in namespaces(type(command)).items():
        value = getattr(command, field)
        if isinstance(value, str):
            found[field] = names.slot(world, value)
        elif isinstance(value, tuple) and any(isinstance(each, str) for each in value):
            found[field] = tuple(names.slot(world, each) if isinstance(each, str) else each for each in value)
    return replace(command, **found) if found else command  # type: ignore[type-var]


def apply(world: World, command: Command) -> Command:
    """Carry out a command that hands give, and return it with slots in place of names.

    Raises CommandError and changes nothing where it cannot be.
    """
    command = _validated(world, command)
    refusal = not_for_hands(world, command)
    if refusal:
        raise CommandError(refusal)
    _carry_out(world, command)
    spend(world, command)
    return command


def act(world: World, command: Command) -> None:
    """Carry out a command, whatever hands may do. Raises CommandError and changes nothing where it cannot be."""
    _carry_out(world, _validated(world, command))


def not_for_hands(world: World, command: Command) -> str:
    """Why the level does not let hands give a command now, in words; nothing where it does."""
    return refusal_of(world, command) or _untouched(world, command)


def _validated(world: World, command: Command) -> Command:
    command = with_slots(world, command)
    try:
        adapter(type(command)).validate_python(command)
    except ValidationError as error:
        raise CommandError(plain_fault(error)) from None
    return command


def _untouched(world: World, command: Command) -> str:
    """What is said where a command is about something that hands may not touch; nothing where it is not."""
    hands = hands_of(world)
    if hands is None or hands.bodies is None:
        return ""
    # Of what is taken out, a body goes by its name.
    found = [body] if isinstance(body := getattr(command, "body", None), str) else []
    for field, named in namespaces(type(command)).items():
        value, names = getattr(command, field), named.names(world)
        slots = value if isinstance(value, tuple) else () if value is None else (value,)
        found += [names[slot] for slot in slots if named.is_thing and slot < len(names)]
    thing = next(filter(None, map(hands.untouched, found)), "")
    return UNTOUCHED.format(shown(thing)) if thing else ""


def _carry_out(world: World, command: Command) -> None:
    for field, names in namespaces(type(command)).items():
        value = getattr(command, field)
        for slot in value if isinstance(value, tuple) else () if value is None else (value,):
            names.check(world, slot)
    for condition, row in faults_of(command.conditions, command, world):
        named = namespaces(type(command)).get(condition.field)
        raise CommandError(condition.words.format(named.names(world)[row] if named else row))
    command.carry_out(world)
