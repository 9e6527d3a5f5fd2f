"""Styles of an SVG: attributes, style attributes and simple rules of a style sheet; what paints say."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from xml.etree.ElementTree import Element

from sandbox.bring.sketch import LeftOut
from sandbox.bring.xml_tree import local_name

_RULE = re.compile(r"([^{}]+)\{([^{}]*)\}")
_SIMPLE = re.compile(r"[.#]?[A-Za-z_][\w-]*")
_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
_PAINT_SERVER = re.compile(r"url\(\s*['\"]?#([^'\")]*)['\"]?\s*\)")
READ = ("fill", "stroke", "stroke-width", "fill-rule", "display", "visibility", "fill-opacity", "opacity", "color")
# What an element says that changes how it is seen, and is not followed.
UNFOLLOWED = {"clip-path": "clip path", "mask": "mask", "filter": "filter"}
RULE_LIMIT = 10_000

Sheet = dict[str, dict[str, str]]


@dataclass(frozen=True)
class Style:
    """What an element inherits: paints as they are written, and whether it is seen."""

    fill: str = "black"
    stroke: str = "none"
    stroke_width: str = "1"
    fill_rule: str = "nonzero"
    visibility: str = "visible"
    fill_opacity: str = "1"
    color: str = "black"


def style_sheet(root: Element, left_out: LeftOut) -> Sheet:
    """What the style elements of a drawing say, by ".class", "#id" or the name of elements."""
    found: Sheet = {}
    for element in root.iter():
        if local_name(element) != "style" or not element.text:
            continue
        for count, rule in enumerate(_RULE.finditer(_COMMENT.sub("", element.text))):
            if count > RULE_LIMIT:
                left_out.add(f"style sheet too long (its first {RULE_LIMIT:,} rules came in)")
                break
            for selector in rule[1].split(","):
                if _SIMPLE.fullmatch(selector.strip()):
                    found.setdefault(selector.strip(), {}).update(declarations(rule[2]))
                elif not selector.strip().startswith("@"):
                    left_out.add("style rule")
    return found


def declarations(text: str) -> dict[str, str]:
    """The properties of "fill: red; stroke: none"."""
    pairs = (part.partition(":") for part in text.split(";"))
    return {key.strip(): value.replace("!important", "").strip() for key, _, value in pairs if value.strip()}


def own_properties(element: Element, sheet: Sheet) -> dict[str, str]:
    """What an element says of itself; its style attribute counts most, then its id, its classes and its name."""
    found = {key: value.strip() for key, value in element.attrib.items() if key in READ or key in UNFOLLOWED}
    classes = element.get("class", "").split()[:20]
    for selector in (local_name(element), *(f".{name}" for name in classes), f"#{element.get('id', '')}"):
        found.update(sheet.get(selector, {}))
    return found | declarations(element.get("style", ""))


def inherited(style: Style, own: Mapping[str, str]) -> Style:
    """The style of an element in one of another."""
    given = {key.replace("-", "_"): value for key, value in own.items() if value != "inherit"}
    return replace(style, **{key: value for key, value in given.items() if key in Style.__dataclass_fields__})


def is_seen(style: Style, own: Mapping[str, str]) -> bool:
    """Whether an element is drawn at all."""
    return style.visibility not in ("hidden", "collapse") and not _is_zero(own.get("opacity", "1"))


def paint_server(paint: str) -> str | None:
    """The id of the gradient or pattern that a paint names; None for a colour."""
    found = _PAINT_SERVER.match(paint)
    return found[1] if found else None


def colour(paint: str, style: Style) -> str | None:
    """A paint as "#RRGGBB"; None for one that is no colour."""
    from svgelements import Color

    if paint.lower() == "currentcolor":
        paint = style.color
    if len(paint) > 100:
        return None
    try:
        found = Color(paint)
        value = None if found.value is None else (found.red, found.green, found.blue)
    except (ValueError, TypeError, IndexError, AttributeError, OverflowError):
        return None
    return None if value is None else "#" + "".join(f"{min(255, max(0, part)):02X}" for part in value)


def is_painted(paint: str, opacity: str) -> bool:
    """Whether a paint is seen."""
    return paint.lower() not in ("none", "transparent", "") and not _is_zero(opacity)


def _is_zero(text: str) -> bool:
    try:
        return float(text.removesuffix("%")) == 0.0
    except ValueError:
        return False
