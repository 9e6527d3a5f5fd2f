"""The form of what hands may do: ticks, how often they may, and what they may do it to."""

from dataclasses import replace
from functools import partial
from typing import Any

from sandbox.editor.document import Document
from sandbox.editor.edits.fields import set_level_field
from sandbox.editor.panel.field_info import FieldInfo, fields_of
from sandbox.editor.panel.property import Property, in_range, named, toggled
from sandbox.level.document.model import Level
from sandbox.level.rules.player_limits import DEEDS, MEANINGS, BudgetDef, PlayerLimits

# What a tick says beside it; its tooltip has the words of play.
_TITLES = {
    "grab": "Grab", "pin": "Pin", "cut": "Cut", "add": "Add parts", "remove": "Take out", "move": "Move at once",
    "push": "Push", "shake": "Shake", "firmness": "Firmness", "mass": "Weight", "material": "Cs and Cd",
    "inflation": "Pump up", "air": "Gravity and air", "solver": "Solver",
}  # fmt: skip
_READY: dict[str, tuple[str, ...] | None] = {"all": None, "grab": ("grab",), "nothing": ()}
_MAY = FieldInfo(
    "choice", "They may", choices=tuple(_READY), tooltip="What hands may do.",
    tips=("Everything", "Only grab and pull", "Nothing: keys alone count"),
)  # fmt: skip


def hands_properties(level: Level) -> tuple[Property, ...]:
    """Properties of what hands may do in a level."""
    hands = level.hands or PlayerLimits()
    ready = next((name for name, may in _READY.items() if may == hands.may), None)
    made = [Property("hands.may", _MAY, ready, lambda document, value: _with(document, may=_READY[value]))]
    budgets = fields_of(BudgetDef)
    for deed in DEEDS:
        tick = FieldInfo("yes_no", _TITLES[deed], tooltip=f"Whether they may {MEANINGS[deed].words}.")
        made.append(Property(f"hands.may.{deed}", tick, hands.allows(deed), partial(_set_deed, deed)))
        if deed in budgets and hands.allows(deed):
            most = replace(budgets[deed], title="\N{MIDDLE DOT} at most")
            value = getattr(hands.at_most, deed)
            label = f"{_TITLES[deed]} at most"
            made.append(Property(f"hands.at_most.{deed}", most, value, partial(_set_budget, deed), label=label))
    about = replace(fields_of(PlayerLimits)["bodies"], kind="words", title="Only these", pick="mover")
    made.append(Property("hands.bodies", about, hands.bodies, _set_bodies))
    return named(made, "Hands")


def _with(document: Document, **fields: Any) -> Document:
    """The level with other limits; without any it has none."""
    hands = {**(document.level.hands or PlayerLimits()).__dict__, **fields}
    budgets = {
        deed: most
        for deed, most in dict(hands["at_most"]).items()
        if most is not None and (hands["may"] is None or deed in hands["may"])
    }
    has_any = hands["may"] is not None or hands["bodies"] is not None or budgets
    return set_level_field(document, "hands", {**hands, "at_most": budgets} if has_any else None)


def _set_deed(deed: str, document: Document, is_allowed: bool) -> Document:
    hands = document.level.hands or PlayerLimits()
    may = tuple(each for each in DEEDS if (is_allowed if each == deed else hands.allows(each)))
    return _with(document, may=None if may == DEEDS else may)


def _set_budget(deed: str, document: Document, most: int | None) -> Document:
    if most is not None:
        in_range(replace(fields_of(BudgetDef)[deed], title=f"{_TITLES[deed]} at most"), most)
    hands = document.level.hands or PlayerLimits()
    return _with(document, at_most={**dict(hands.at_most), deed: most})


def _set_bodies(document: Document, value: Any) -> Document:
    hands = document.level.hands or PlayerLimits()
    return _with(document, bodies=None if value is None else toggled(hands.bodies or (), value))
