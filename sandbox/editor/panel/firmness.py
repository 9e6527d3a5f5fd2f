"""How soft bodies are as a whole, as a panel shows it: in words, by sag, by frequency and damping ratio."""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import partial
from typing import Any

from sandbox.editor.document import Document, EditError, validated
from sandbox.editor.edits.fields import change_items
from sandbox.editor.items import Definition, Item
from sandbox.editor.panel.field_info import PERCENT, RATIO, SAG, WOBBLE, FieldInfo
from sandbox.editor.panel.property import Property, same
from sandbox.level.document.model import Level, NissenMaterial
from sandbox.level.format.level_error import shown
from sandbox.level.format.limits import FREQUENCY_RANGE
from sandbox.level.format.quantities import replaced, significant
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import BodyDef, FirmnessDef
from sandbox.physics.equation import of_body
from sandbox.physics.keeping.equipment import Firmness
from sandbox.physics.softness.firmness import LARGEST_READ, WORDS, FirmnessRange, OutOfReach

# What the menu of words says of a body that is as its material is, and of one whose firmness has no word.
OF_MATERIAL = "as material"
NUMBERS = "by numbers"
# Digits of readings.
DIGITS = 3
# Decimals of a sag in per cent.
SAG_DECIMALS = 4

# The firmness that a body is to have instead of the one that it has; None = that of its material.
Asked = Callable[[FirmnessRange, FirmnessDef | None], Firmness | None]


def firmness_properties(level: Level, parts: Mapping[Item, Definition]) -> list[Property]:
    """The properties of the firmness of those bodies whose form may be stiff without pins; none where none is."""
    bodies = {item: part for item, part in parts.items() if isinstance(part, BodyDef) and _may_be_firm(level, part)}
    if not bodies:
        return []
    readings = [_reading(level, body) for body in bodies.values()]
    sag, hz, ratio = (same(reading[place] for reading in readings) for place in range(3))
    word = same(_word(body.firmness) for body in bodies.values())
    tip = (
        "How soft the whole body is, for any grid, size and mass: set it here, or let Cs and Cd of its material decide."
    )
    about = FieldInfo("choice", "Firmness", tooltip=tip, choices=(OF_MATERIAL, *WORDS, NUMBERS))

    def made(field: str, about: FieldInfo, value: Any, asked: Callable[[Any], Asked]) -> Property:
        return Property(
            field, about, value, lambda document, new: _with_firmness(document, bodies, asked(new)),
            remark=lambda document, new: _remark(document.level, bodies, asked(new)),
        )  # fmt: skip

    return [
        made("firmness", about, word, lambda new: partial(_by_word, new)),
        made("firmness.sag", SAG, sag, lambda value: lambda *_: Firmness(sag=value / PERCENT)),
        made("firmness.hz", WOBBLE, hz, lambda value: partial(_by_frequency, value)),
        made("firmness.ratio", RATIO, ratio, lambda value: partial(_by_ratio, value)),
    ]  # fmt: skip


def _may_be_firm(level: Level, body: BodyDef) -> bool:
    if body.firmness is not None:
        return True
    return isinstance(level.material(body.material), NissenMaterial) and expansion(body).may_be_stiff


def _reach(level: Level, body: BodyDef) -> FirmnessRange:
    return FirmnessRange.of(expansion(body).stiff_form, level.settings.gravity, level.settings.tick_rate)


def _reading(level: Level, body: BodyDef) -> tuple[Any, Any, Any]:
    """Sag [%], frequency [Hz] and damping ratio that a body has, by its firmness or its material; None: no such."""
    # Of a large body that nobody has given a firmness, finding its slowest wobble takes a person's time.
    if body.firmness is None and expansion(body).form_count[0] > LARGEST_READ:
        return None, None, None
    reach = _reach(level, body)
    if reach.lowest_mode == 0.0:
        return None, None, None
    if body.firmness is None:
        material = level.material(body.material)
        assert isinstance(material, NissenMaterial)
        pair = of_body(material.stiffness, material.damping, reach.lowest_mode)
    else:
        pair = reach.coefficients(body.firmness.asked)
    sag, hz, ratio = reach.reading(*pair)
    # A ten-thousandth of a per cent is nothing that anybody sees.
    seen = (round(PERCENT * sag, SAG_DECIMALS) if sag < float("inf") else sag, hz, ratio)
    return tuple(significant(value, DIGITS) if value < float("inf") else None for value in seen)  # type: ignore[return-value]


def _word(firmness: FirmnessDef | None) -> str:
    if firmness is None:
        return OF_MATERIAL
    return next((word for word, sag in WORDS.items() if sag == firmness.sag), NUMBERS)


def _by_word(word: str, reach: FirmnessRange, present: FirmnessDef | None) -> Firmness | None:
    if word == OF_MATERIAL:
        return None
    if word in WORDS:
        return Firmness(sag=WORDS[word])
    # By the numbers that it has now.
    _, hz, ratio = reach.reading(*reach.coefficients(Firmness(sag=WORDS["soft"]) if present is None else present.asked))
    return Firmness(hz=significant(min(hz, FREQUENCY_RANGE[1]), DIGITS), ratio=significant(min(ratio, 1.0), DIGITS))


def _by_frequency(hz: float, reach: FirmnessRange, present: FirmnessDef | None) -> Firmness:
    return Firmness(hz=hz, ratio=None if present is None else present.ratio)


def _by_ratio(ratio: float, reach: FirmnessRange, present: FirmnessDef | None) -> Firmness:
    if present is None:
        raise EditError("its material decides that now; choose a firmness first")
    hz = reach.reading(*reach.coefficients(present.asked))[1] if present.hz is None else present.hz
    return Firmness(hz=significant(min(hz, FREQUENCY_RANGE[1]), DIGITS), ratio=ratio)


def _reached(level: Level, body: BodyDef, asked: Asked) -> tuple[Firmness | None, Firmness | None]:
    """The firmness that is asked of a body, and the nearest in reach. Raises EditError where nothing is."""
    reach = _reach(level, body)
    if reach.lowest_mode == 0.0:
        raise EditError(f"the form of {shown(body.id)} is not stiff without pins, so it has no firmness")
    target = asked(reach, body.firmness)
    if target is None:
        return None, None
    validated(replaced(body, firmness=asdict(target)))
    try:
        return target, reach.nearest(target)
    except OutOfReach as error:
        raise EditError(f"{shown(body.id)}: {error}") from None


def _with_firmness(document: Document, bodies: Mapping[Item, BodyDef], asked: Asked) -> Document:
    level = document.level

    def change(part: Definition) -> Any:
        assert isinstance(part, BodyDef)
        _, nearest = _reached(level, part, asked)
        return None if nearest is None else asdict(nearest)

    return change_items(document, frozenset(bodies), "firmness", change)


def _remark(level: Level, bodies: Mapping[Item, BodyDef], asked: Asked) -> str:
    for body in bodies.values():
        try:
            target, nearest = _reached(level, body, asked)
        except EditError:
            return ""
        if nearest != target:
            return f"{shown(body.id)}: {target} is not possible here. It has the nearest value now: {nearest}"
    return ""
