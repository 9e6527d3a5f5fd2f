"""Properties of a material: law and coefficients, frequency and damping ratio, when it breaks, and how it looks."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from pydantic import ValidationError

from sandbox.editor.document import Document, EditError, first_fault
from sandbox.editor.edits.materials import rename_material, set_material
from sandbox.editor.panel.field_info import FieldInfo, fields_of
from sandbox.editor.panel.property import MIXED, Property, Section, in_range, part_properties
from sandbox.level.document.model import HookeMaterial, Level, Material, MaterialDef, NissenMaterial
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.format.look import BodyLook
from sandbox.level.format.quantities import replaced, significant
from sandbox.physics.equation import coefficients_from_frequency, frequency_from_coefficients

TITLES = {"stiffness": "Cs  stiffness", "damping": "Cd  damping", "k": "k  stiffness", "c": "c  damping"}
# Of Cs and Cd, a part per tick, nobody misses the unit.
COEFFICIENTS = {
    name: replace(fields_of(NissenMaterial)[name], title=TITLES[name], unit="") for name in ("stiffness", "damping")
}
_NAME = FieldInfo("text", "Name", tooltip="What levels and files call it.")
_LAW = FieldInfo(
    "choice", "Law", choices=("nissen", "hooke"), labels=("Impulse", "Hooke"),
    tips=(
        "The impulse-based spring: Cs and Cd, the same behaviour for every mass",
        "The classic spring, F = -k x - c u, for comparison: it explodes where k or c is too large",
    ),
)  # fmt: skip
_FREQUENCY = FieldInfo("number", "Frequency", "Hz", 0.0, tooltip="Swings a second of one spring, undamped.")
_RATIO = FieldInfo(
    "number", "Damping ratio", low=0.0, tooltip="Below 1 one spring swings, at 1 and above it creeps back."
)
# Digits of readings.
DIGITS = 3
NO_FREQUENCY = "there is no one frequency to keep: type the frequency first"

# Frequency [Hz] and damping ratio; MIXED where things differ in it, None where there is none.
Swing = tuple[Any, Any]


def materials_of(level: Level) -> dict[str, Material]:
    """Every material that something in the level can be of."""
    return {DEFAULT_MATERIAL: NissenMaterial(), **level.materials}


def material_sections(level: Level, name: str) -> tuple[Section, ...]:
    """The properties of a material, in sections."""
    material = materials_of(level)[name]
    coefficients: list[Property] = []
    limits: list[Property] = []
    if name != DEFAULT_MATERIAL:
        rename = Property("name", _NAME, name, lambda document, new: rename_material(document, name, new))
        coefficients.append(replace(rename, label=f"{name}: rename"))
    law = "hooke" if isinstance(material, HookeMaterial) else "nissen"
    coefficients.append(Property("law", _LAW, law, partial(_set_law, name), label=f"{name}: law"))
    for field, about in fields_of(type(material)).items():
        if field in TITLES:
            about = COEFFICIENTS.get(field, replace(about, title=TITLES[field]))
        elif field not in MaterialDef.model_fields or field == "look":
            continue
        label = f"{name}: {TITLES[field].split()[0] if field in TITLES else about.title.lower()}"
        slides = field in TITLES and isinstance(material, NissenMaterial)
        each = Property(field, about, getattr(material, field), partial(_set, name, field), slides=slides, label=label)
        (coefficients if field in TITLES else limits).append(each)
    if isinstance(material, NissenMaterial):
        tick_time = 1.0 / level.settings.tick_rate
        swing = frequency_from_coefficients(material.stiffness, material.damping, tick_time)

        def put(document: Document, hz: float, ratio: float) -> Document:
            stiffness, damping = coefficients_for(hz, ratio, tick_time)
            changed = replaced(materials_of(document.level)[name], stiffness=stiffness, damping=damping)
            return set_material(document, name, changed)

        coefficients += [replace(each, label=f"{name}: frequency") for each in swing_properties(swing, put)]
    return (
        Section("", tuple(coefficients)),
        Section("Breaks and yields", tuple(limits)),
        Section("Look", tuple(look_properties(name, material))),
    )


def swing_properties(
    swing: Swing, put: Callable[[Any, float, float], Any], frequency: FieldInfo = _FREQUENCY, ratio: FieldInfo = _RATIO
) -> list[Property]:
    """Frequency and damping ratio of springs or of what they make up; each keeps the other when it is changed.

    put(target, hz, ratio): makes a change, as a property's `write` does.
    """
    old_hz, old_ratio = swing

    def with_frequency(target: Any, hz: float) -> Any:
        return put(target, in_range(frequency, hz), old_ratio if _is_known(old_ratio) else 1.0)

    def with_ratio(target: Any, new: float) -> Any:
        if not _is_known(old_hz):
            raise EditError(NO_FREQUENCY)
        return put(target, old_hz, in_range(ratio, new))

    def remark(target: Any, hz: float) -> str:
        return "" if _is_known(old_ratio) else "there was no one damping ratio to keep, so it is 1 now"

    shown = [significant(each, DIGITS) if isinstance(each, float) else each for each in swing]
    return [
        Property("frequency", frequency, shown[0], with_frequency, remark=remark),
        Property("ratio", ratio, shown[1], with_ratio),
    ]


def coefficients_for(hz: float, ratio: float, tick_time: float) -> tuple[float, float]:
    """Cs and Cd of a spring with that frequency [Hz] and damping ratio. Raises EditError where there are none."""
    try:
        return coefficients_from_frequency(hz, ratio, tick_time)
    except ValueError as error:
        raise EditError(str(error)) from None


def _is_known(value: Any) -> bool:
    return value is not None and value is not MIXED and math.isfinite(value)


def _set(name: str, field: str, document: Document, value: Any) -> Document:
    return set_material(document, name, replaced(materials_of(document.level)[name], **{field: value}))


def _set_law(name: str, document: Document, law: str) -> Document:
    old = materials_of(document.level)[name]
    if (law == "hooke") == isinstance(old, HookeMaterial):
        return document
    limits = {field: getattr(old, field) for field in MaterialDef.model_fields}
    return set_material(
        document, name, HookeMaterial(law="hooke", **limits) if law == "hooke" else NissenMaterial(**limits)
    )


def look_properties(name: str, material: Material) -> list[Property]:
    """Properties of the look of a material."""

    def change(document: Document, new: Callable[[Any], Any]) -> Document:
        now = document.level.materials.get(name, NissenMaterial())
        look = new(now.look)
        try:
            checked = None if look is None else BodyLook.model_validate(look)
        except ValidationError as error:
            raise EditError(first_fault(error, "look", 0)) from None
        return set_material(document, name, replaced(now, look=checked))

    def add(document: Document) -> Document:
        return change(document, lambda old: {} if old is None else old.__dict__)

    found = part_properties("look", fields_of(MaterialDef)["look"], [material.look], change, add)
    # Corners of a window are particles, of which a material has none.
    return [each for each in found if each.field != "look.window"]
