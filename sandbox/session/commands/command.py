"""The base of commands: a frozen value, checked strictly, with a name in files, that is carried out on a world."""

from abc import ABC
from collections.abc import Hashable
from dataclasses import replace
from typing import Any, ClassVar

from pydantic import ConfigDict, TypeAdapter, ValidationError

from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.format.level_error import shown
from sandbox.level.rules.player_limits import thing_of, words_of
from sandbox.physics.commands.command import BEYOND_REACH, EXHAUSTED, FORBIDDEN, HAND, RULE, UNTOUCHABLE
from sandbox.physics.commands.command_table import WORDS, RefusedCommand
from sandbox.physics.keeping.equipment import Firmness
from sandbox.physics.softness.firmness import words_of_reach
from sandbox.physics.world import World
from sandbox.session.commands.faults import CommandError as CommandError
from sandbox.session.commands.faults import plain_fault
from sandbox.session.commands.named import PARTICLES, SPRINGS, namespaces

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

    def __init_subclass__(cls) -> None:
        if "type" in vars(cls):
            assert cls.type not in COMMAND_TYPES, f"two commands are called {cls.type}"
            COMMAND_TYPES[cls.type] = cls

    def carry_out(self, world: LevelWorld, giver: int) -> None:
        """Do it, for a hand or a rule. Raises CommandError, IndexError, ValueError or RefusedCommand where it cannot be
        done; nothing is changed then.
        """
        world.command(self.type, giver, **vars(self))

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


def apply(world: LevelWorld, command: Command) -> Command:
    """Carry out a command that hands give, and return it with slots in place of names.

    Raises CommandError and changes nothing where it cannot be.
    """
    command = _validated(world, command)
    _carry_out(world, command, HAND)
    return command


def act(world: LevelWorld, command: Command) -> None:
    """Carry out a command of a rule, whatever hands may do. Raises CommandError, with nothing changed, where it cannot
    be.
    """
    _carry_out(world, _validated(world, command), RULE)


def _validated(world: World, command: Command) -> Command:
    command = with_slots(world, command)
    try:
        adapter(type(command)).validate_python(command)
    except ValidationError as error:
        raise CommandError(plain_fault(error)) from None
    return command


def _carry_out(world: LevelWorld, command: Command, giver: int) -> None:
    try:
        command.carry_out(world, giver)
    except CommandError:
        raise
    except RefusedCommand as refused:
        raise CommandError(_words(world, command, refused)) from None
    except (IndexError, ValueError) as error:
        _check_names(world, command)
        raise CommandError(str(error)) from None


def _check_names(world: World, command: Command) -> None:
    """Whether all that a command names is there and in use. Raises CommandError."""
    for field, names in namespaces(type(command)).items():
        value = getattr(command, field)
        for slot in value if isinstance(value, tuple) else () if value is None else (value,):
            names.check(world, slot)


# What other kernels call things, of which commands may name others.
_THINGS = {"particle": PARTICLES, "spring": SPRINGS}


def _words(world: World, command: Command, refused: RefusedCommand) -> str:
    """Why a command is refused, with the names of things."""
    doing, counted = words_of(command.type)
    named = namespaces(type(command)).get(refused.field, _THINGS.get(refused.field))
    name = refused.value
    if named is not None and isinstance(name, int):
        name = named.names(world)[name]
    what = {FORBIDDEN: doing, EXHAUSTED: counted, UNTOUCHABLE: shown(thing_of(str(name)))}
    further: tuple[str, ...] = ()
    if refused.reason == BEYOND_REACH:
        asked = Firmness(*(getattr(command, field) for field in ("sag", "hz", "ratio")))
        further, _ = words_of_reach(asked, refused.numbers[-2:], world.settings.tick_rate)
    return WORDS[refused.reason].format(what.get(refused.reason, name), *further)
