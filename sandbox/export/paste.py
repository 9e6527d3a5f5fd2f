"""What is pasted into another engine, or a loop of one's own: lines of its language with a body's numbers in them."""

from sandbox.export.engines import EngineNumbers
from sandbox.export.loops import LISTINGS, listing
from sandbox.export.numbers import short
from sandbox.export.take_home import TakeHome

# Masses of which there are lines; what is said below them tells of the others.
MOST_MASSES = 3
# By the names of engines: what begins a remark, and the lines, with numbers by their names.
_BY_FREQUENCY = {
    "box2d": (
        "b2DistanceJointDef def = b2DefaultDistanceJointDef();\n"
        "def.enableSpring = true;\n"
        "def.hertz = {frequency}f;\n"
        "def.dampingRatio = {damping_ratio}f;"
    ),
    "unity": (
        "SpringJoint2D joint = body.AddComponent<SpringJoint2D>();\n"
        "joint.autoConfigureDistance = false;\n"
        "joint.frequency = {frequency}f;\n"
        "joint.dampingRatio = {damping_ratio}f;"
    ),
}  # fmt: skip
_BY_MASS = {
    "godot": ("#", "var joint := DampedSpringJoint2D.new()\njoint.stiffness = {k}\njoint.damping = {c}"),
    "rapier": ("//", "RAPIER.JointData.spring(restLength, {k}, {c}, {{ x: 0, y: 0 }}, {{ x: 0, y: 0 }});"),
    "pymunk": ("#", "pymunk.DampedSpring(a, b, (0, 0), (0, 0), rest_length, stiffness={k}, damping={c})"),
    "chipmunk": ("//", "cpDampedSpringNew(a, b, cpvzero, cpvzero, rest_length, {k}, {c});"),
}


def pasted(take: TakeHome, to: str) -> str:
    """The lines for an engine or a language, by its name in `--to`; "" where the engine's springs are too soft for it.

    Raises KeyError for another name.
    """
    if to in LISTINGS:
        return listing(take.trial, to)
    numbers = take.engines[to]
    if numbers.rigid:
        return ""
    if to in _BY_FREQUENCY:
        ratio, frequency = _decimal(numbers.damping_ratio), _decimal(numbers.frequency)
        return _BY_FREQUENCY[to].format(frequency=frequency, damping_ratio=ratio)
    return _for_masses(numbers, *_BY_MASS[to])


def _for_masses(numbers: EngineNumbers, remark: str, lines: str) -> str:
    shown = numbers.masses[:MOST_MASSES]
    parts = []
    for mass in shown:
        about = f"{remark} the {mass.springs} with a reduced mass of {short(mass.reduced_mass)} kg\n"
        code = lines.format(k=_decimal(mass.k), c=_decimal(mass.c))
        parts.append(about + code if len(numbers.masses) > 1 else code)
    return "\n".join(parts)


def _decimal(value: float) -> str:
    """A number with three digits that every language takes as a float."""
    text = short(value)
    return text if "." in text or "e" in text else f"{text}.0"
