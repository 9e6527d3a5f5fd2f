"""Curves: how a thing comes back, as the tools of those who design motion take it.

Each in one of two forms: the curve as it was measured, in points, or the single spring that comes nearest.
"""

import html
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from sandbox.export.feel import Feel, sentence
from sandbox.export.numbers import percent, short
from sandbox.export.policy import policy
from sandbox.physics.analysis.step_response import thin_curve
from sandbox.physics.arrays import Floats

CSS = "transition: transform {milliseconds}ms linear({stops});"
TEMPLATE = Path(__file__).with_name("feel.html")
MEASURED, NEAREST = "the curve as it was measured", "the single spring that comes nearest"


def points_of(feel: Feel, form: str = MEASURED) -> Floats:
    """As few points (p, 2) of time [s] and progress as come near enough to a curve; from 0, 0 to 1 in the end."""
    curve = feel.curve if form == MEASURED else feel.spring_curve
    kept = np.zeros(len(curve))
    ticks = kept[: thin_curve(1.0 - curve, kept)]
    values = curve[ticks.astype(int)]
    values[0], values[-1] = 0.0, 1.0
    return np.stack([feel.released.tick * ticks, values], axis=1)


def _natural(feel: Feel) -> tuple[float, float]:
    # Natural frequency [rad/s], and damping ratio, of the nearest spring.
    if not math.isfinite(feel.hz) or feel.hz <= 0.0:
        raise ValueError("it comes back within one tick: no spring of those tools is as quick")
    return 2.0 * math.pi * feel.hz, feel.ratio


def _css(points: Floats) -> str:
    last = points[-1, 0]
    stops = [f"{_n(value)} {_n(100.0 * time / last)}%" for time, value in points[1:-1].tolist()]
    return CSS.format(milliseconds=round(1000.0 * last), stops=", ".join(["0", *stops, "1"]))


def _unity(points: Floats) -> str:
    keys = [f"    new Keyframe({_n(time)}f, {_n(value)}f)" for time, value in points.tolist()]
    return (
        "var curve = new AnimationCurve(\n" + ",\n".join(keys) + ");\n"
        "for (int i = 0; i < curve.length; i++) {\n"
        "    AnimationUtility.SetKeyLeftTangentMode(curve, i, AnimationUtility.TangentMode.Linear);\n"
        "    AnimationUtility.SetKeyRightTangentMode(curve, i, AnimationUtility.TangentMode.Linear);\n"
        "}"
    )


def _godot(points: Floats) -> str:
    low, high = float(points[:, 1].min()), float(points[:, 1].max())
    head = [
        f"# seconds: {_n(points[-1, 0])}", "var curve := Curve.new()", f"curve.min_value = {_n(low)}",
        f"curve.max_value = {_n(high)}",
    ]  # fmt: skip
    linear = "0.0, 0.0, Curve.TANGENT_LINEAR, Curve.TANGENT_LINEAR"
    return "\n".join(
        head
        + [f"curve.add_point(Vector2({_n(t / points[-1, 0])}, {_n(value)}), {linear})" for t, value in points.tolist()]
    )


def _swiftui(omega: float, ratio: float) -> str:
    bounce = 1.0 - ratio if ratio <= 1.0 else 1.0 / ratio - 1.0
    return f".animation(.spring(duration: {_n(2.0 * math.pi / omega)}, bounce: {_n(bounce)}), value: value)"


def _flutter(omega: float, ratio: float) -> str:
    return f"SpringDescription(mass: 1, stiffness: {_n(omega * omega)}, damping: {_n(2.0 * ratio * omega)})"


def _motion(omega: float, ratio: float) -> str:
    return f'{{ type: "spring", mass: 1, stiffness: {_n(omega * omega)}, damping: {_n(2.0 * ratio * omega)} }}'


def _react_spring(omega: float, ratio: float) -> str:
    return f"config: {{ mass: 1, tension: {_n(omega * omega)}, friction: {_n(2.0 * ratio * omega)} }}"


def _n(value: float) -> str:
    return f"{value:.4f}".rstrip("0").rstrip(".")


# What writes the points of a curve, and what writes a natural frequency [rad/s] and a damping ratio, for a tool.
_BY_POINTS: dict[str, Callable[[Floats], str]] = {"css": _css, "unity": _unity, "godot": _godot}
_BY_SPRING: dict[str, Callable[[float, float], str]] = {
    "swiftui": _swiftui, "flutter": _flutter, "motion": _motion, "react-spring": _react_spring,
}  # fmt: skip
# Every tool by its name, with the forms that there are for it, the better one first.
TOOLS = {**dict.fromkeys(_BY_POINTS, (MEASURED, NEAREST)), **dict.fromkeys(_BY_SPRING, (NEAREST,))}


def curve_for(feel: Feel, tool: str, form: str | None = None) -> tuple[str, str]:
    """What a text for a tool of TOOLS is, with how far it is from what was measured, and the text itself.

    form: one of the tool's; None: the first. Raises KeyError, and ValueError where the tool has no such spring.
    """
    form = form or TOOLS[tool][0]
    text = _BY_POINTS[tool](points_of(feel, form)) if tool in _BY_POINTS else _BY_SPRING[tool](*_natural(feel))
    return (form if form == MEASURED else f"{form}; {percent(feel.difference)} of the way from what was measured"), text


def card_text(feel: Feel) -> str:
    """The card of a thing as text for a person."""
    numbers, released = feel.numbers, feel.released
    swings = f"{numbers.swings} time{'s' * (numbers.swings != 1)}"
    spring = (
        f"{short(feel.hz)} Hz, damping ratio {short(feel.ratio)}"
        if math.isfinite(feel.hz)
        else "quicker than one tick shows"
    )
    return "\n".join(
        [
            f'"{feel.name}", pulled and let go. {sentence(feel)}',
            f"  overshoot {percent(numbers.overshoot)}, settles in {short(numbers.settling)} s, seen to pass its place "
            f"{swings}",
            f"  nearest single spring: {spring} (Cs {short(feel.stiffness)}, Cd {short(feel.damping)} in a tick of "
            f"1/{round(1.0 / released.tick)} s), {percent(feel.difference)} of the way apart at most",
        ]
    )


def card_picture(feel: Feel) -> str:
    """The curve, and that of the nearest spring, as a picture (SVG)."""
    width, height, left, bottom = 480.0, 240.0, 44.0, 30.0
    points, spring = points_of(feel), feel.spring_curve
    last, top = float(points[-1, 0]), max(1.05, float(points[:, 1].max()) + 0.05)

    def place(time: float, value: float) -> str:
        x, y = left + (width - left - 12) * time / last, height - bottom - (height - bottom - 12) * value / top
        return f"{x:.1f},{y:.1f}"

    count = min(len(spring), round(last / feel.released.tick) + 1)
    measured = " ".join(place(time, value) for time, value in points.tolist())
    single = " ".join(place(k * feel.released.tick, float(spring[k])) for k in range(count))
    one = place(0.0, 1.0).split(",")[1]
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" font-family="sans-serif" '
        f'font-size="11"><title>{html.escape(sentence(feel))}</title><rect width="{width:g}" height="{height:g}" '
        f'fill="#fff"/><path d="M{left:g} {one}H{width - 12:g}" stroke="#bbb"/>'
        f'<polyline points="{single}" fill="none" stroke="#0e7490" stroke-dasharray="4 3"/>'
        f'<polyline points="{measured}" fill="none" stroke="#c2410c" stroke-width="2"/>'
        f'<text x="{width - 12:g}" y="{height - 10:g}" text-anchor="end">{short(last)} s</text>'
        f'<text x="4" y="{one}">1</text></svg>\n'
    )


def card_page(feel: Feel, form: str = MEASURED) -> str:
    """A page of its own that plays the curve in a form by CSS: a box that goes there and back with it."""
    parts = {
        "@TITLE@": html.escape(feel.name), "@TRANSITION@": _css(points_of(feel, form)),
        "@CARD@": html.escape(card_text(feel)), "@PICTURE@": card_picture(feel),
    }  # fmt: skip
    text = TEMPLATE.read_text(encoding="utf-8")
    for place, content in parts.items():
        text = text.replace(place, content)
    return text.replace("@POLICY@", policy(text, img="data:"))
