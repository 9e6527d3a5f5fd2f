"""The base of commands: a frozen value, checked strictly, with a name in files, that is carried out on a world."""

from abc import ABC, abstractmethod
from collections.abc import Hashable
from typing import Any, ClassVar

from pydantic import ConfigDict, TypeAdapter, ValidationError

from sandbox.physics.world import World


class CommandError(ValueError):
    """A command that cannot be carried out; its text is one line for a person, of a definition one line per fault."""

    @property
    def faults(self) -> list[str]:
        """The lines, one for each fault."""
        return str(self).splitlines()


# Every command by the name that files use.
COMMAND_TYPES: dict[str, type["Command"]] = {}
_adapters: dict[type["Command"], TypeAdapter[Any]] = {}


class Command(ABC):
    """Something to do to a world. A command is a frozen dataclass of this base.

    Its fields are checked by their annotations, also where it was made without; a slot is annotated with the namespace
    by whose names files call it (named.py), so that nothing else is needed to write and read it as JSON.
    """

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(
        strict=True, extra="forbid", revalidate_instances="always", allow_inf_nan=False
    )
    type: ClassVar[str]

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


def plain_fault(error: ValidationError) -> str:
    """The first fault of a validation as `field: fault`, in one line."""
    fault = error.errors(include_url=False, include_context=False, include_input=False)[0]
    place = ".".join(part if part.isprintable() else repr(part) for part in map(str, fault["loc"]))[:80]
    text = fault["msg"].replace("Input should be", "must be").splitlines()[0]
    return f"{place}: {text}" if place else text


def apply(world: World, command: Command) -> None:
    """Carry a command out. Raises CommandError and changes nothing where it cannot be."""
    try:
        adapter(type(command)).validate_python(command)
    except ValidationError as error:
        raise CommandError(plain_fault(error)) from None
    command.carry_out(world)
