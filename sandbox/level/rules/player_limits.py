"""PlayerLimits: what hands may do in a level, and how often, by words that each stand for commands."""

from collections.abc import Collection, Iterator
from typing import Annotated, Literal, NamedTuple, get_args

from pydantic import Field

from sandbox.level.format.level_error import Fault, shown, suggestion
from sandbox.level.format.quantities import Description, Name, empty

Deed = Literal[
    "grab", "pin", "cut", "add", "remove", "move", "push", "shake", "firmness", "mass", "material", "inflation", "air",
    "solver",
]  # fmt: skip
DEEDS: tuple[str, ...] = get_args(Deed)
MOST = 1000


class Meaning(NamedTuple):
    """The meaning of a word: types of commands; in words; those of them that a budget counts, and what it counts."""

    commands: tuple[str, ...]
    words: str
    counting: tuple[str, ...] = ()
    remaining_words: str = ""


_ADDING = ("add_particle", "add_spring", "add_body")
# Commands that no word stands for are always allowed: keys of motors, hydraulics and rules, undo and redo.
MEANINGS = {
    "grab": Meaning(("grab", "move_grab", "release"), "grab things", ("grab",), "Grabs"),
    "pin": Meaning(("pin", "unpin"), "pin things or let them go", ("pin",), "Pins"),
    "cut": Meaning(("cut_springs",), "cut", ("cut_springs",), "Cuts"),
    "add": Meaning(_ADDING, "add parts", _ADDING, "Parts"),
    "remove": Meaning(("remove",), "take things out"),
    "move": Meaning(("move_body", "free"), "move things at once"),
    "push": Meaning(("push",), "push"),
    "shake": Meaning(("shake",), "shake the world"),
    "firmness": Meaning(("set_firmness",), "make bodies softer or firmer"),
    "mass": Meaning(("scale_mass",), "make things heavier or lighter"),
    "material": Meaning(("set_coefficients",), "change Cs and Cd"),
    "inflation": Meaning(("set_inflation",), "pump things up"),
    "air": Meaning(("set_gravity", "set_air"), "change gravity or air"),
    "solver": Meaning(("set_solver",), "change the solver"),
}


Count = Annotated[int, Field(ge=0, le=MOST)]


class BudgetDef(Description):
    """How often hands may do something. Players see how many are left; undo gives back."""

    grab: Count | None = Field(
        default=None, description="How often they may grab.", json_schema_extra=empty("as often as they like")
    )
    pin: Count | None = Field(
        default=None, description="How many particles they may pin.", json_schema_extra=empty("as many as they like")
    )
    cut: Count | None = Field(
        default=None, description="How many springs they may cut.", json_schema_extra=empty("as many as they like")
    )
    add: Count | None = Field(
        default=None, description="How many parts they may add.", json_schema_extra=empty("as many as they like")
    )


class PlayerLimits(Description):
    """What hands may do while the level runs. Keys, undo and redo always work, and rules do what they like."""

    may: Annotated[tuple[Deed, ...], Field(max_length=len(DEEDS))] | None = Field(
        default=None, description="What they may do.", json_schema_extra=empty("everything")
    )
    bodies: Annotated[tuple[Name, ...], Field(max_length=MOST)] | None = Field(
        default=None,
        description="Bodies and loose particles that they may do it to, beside what hands add.",
        json_schema_extra=empty("all"),
    )
    at_most: BudgetDef = Field(default=BudgetDef(), description="How often they may do it.")

    def refuses(self, kind: str) -> bool:
        """Whether hands may not give a command of that type."""
        return any(kind in meaning.commands and not self.allows(deed) for deed, meaning in MEANINGS.items())

    def lets_touch(self, name: str) -> bool:
        """Whether hands may touch what has that name: a particle, spring or body."""
        return self.bodies is None or name.startswith("+") or thing_of(name) in self.bodies

    def allows(self, deed: str) -> bool:
        """Whether hands may do that."""
        return not deed or self.may is None or deed in self.may

    @property
    def budgets(self) -> dict[str, int]:
        """How often hands may do what is counted, in the order of their counters, which are the last of a world."""
        return {deed: most for deed, most in self.at_most if most is not None}

    @property
    def counter_names(self) -> tuple[str, ...]:
        """The names of the counters of budgets, in their order."""
        return tuple(f"{MEANINGS[deed].remaining_words} left" for deed in self.budgets)

    def budget_of(self, kind: str) -> str:
        """The budget that a command of that type needs; nothing where it needs none."""
        return next((deed for deed in self.budgets if kind in MEANINGS[deed].counting), "")

    def row(self, deed: str, count: int) -> int:
        """The counter's row of a budget, behind `count` others."""
        return count - len(self.budgets) + list(self.budgets).index(deed)


def thing_of(name: str) -> str:
    """The body, or loose particle or spring, that a particle, spring or body of that name belongs to."""
    return name.partition(":")[0].partition(".")[0] or name


def words_of(kind: str) -> tuple[str, str]:
    """The effect of a type of commands, and what a budget of it counts, in words."""
    for meaning in MEANINGS.values():
        if kind in meaning.commands:
            return meaning.words, meaning.remaining_words.lower()
    return kind, ""


def left_of(hands: PlayerLimits | None, count: int) -> list[tuple[int, str, int]]:
    """Of each budget the counter's row behind `count` others, its name for players, and its amount at the start."""
    if hands is None:
        return []
    return [(hands.row(deed, count), MEANINGS[deed].remaining_words, most) for deed, most in hands.budgets.items()]


def hand_faults(hands: PlayerLimits | None, things: Collection[str]) -> Iterator[Fault]:
    """Faults of what is listed twice or is not there, and of budgets of what hands may not do.

    things: the names of bodies and loose particles.
    """
    if hands is None:
        return
    may = hands.may or ()
    for k, twice in enumerate(may):
        if twice in may[:k]:
            yield f"hands.may.{k}", f"{shown(twice)} is listed twice"
    for k, name in enumerate(hands.bodies or ()):
        if name not in things:
            found = f"there is no body or particle {shown(name)}{suggestion(name, things)}"
            yield f"hands.bodies.{k}", found
    for deed in hands.budgets:
        if not hands.allows(deed):
            yield f"hands.at_most.{deed}", f"hands may not do that here; add {shown(deed)} to may, or take this out"
