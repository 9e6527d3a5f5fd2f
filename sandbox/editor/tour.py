"""Tour: six steps to a first level, a rope bridge that carries a weight; what each asks for, and when it is done."""

from collections.abc import Callable
from dataclasses import dataclass

from sandbox.editor.kinds.rope import RopeOptions
from sandbox.editor.scene import Scene
from sandbox.editor.tools.drawing_options import Options
from sandbox.editor.tools.drawing_particles import ParticleOptions
from sandbox.level.format.quantities import Point
from sandbox.level.kinds.rope import RopeDef

# From this slack on a rope hangs visibly, and from this mass on its weight bends it [kg].
ENOUGH_SLACK = 0.1
ENOUGH_MASS = 10.0


@dataclass(frozen=True)
class Situation:
    """The state of the editor in the tour: the level, the tool in hand with its options, and whether it is played."""

    scene: Scene
    tool: str = "select"
    options: Options | None = None
    playing: bool = False


# What a step points at: a place in the level [m], or the name of an action, of an option of the tool, or "canvas".
Target = Point | str


@dataclass(frozen=True)
class Step:
    """A step of the tour: its text, its target on the screen, and whether it is done."""

    title: str
    text: str
    target: Callable[[Situation], Target]
    done: Callable[[Situation], bool]


def _slack_rope(situation: Situation) -> RopeDef | None:
    """The rope that was drawn last and is longer than the way from end to end."""
    ropes = (body for body in reversed(situation.scene.level.bodies) if isinstance(body, RopeDef))
    return next((rope for rope in ropes if rope.rest_length is not None), None)


def _held(situation: Situation, name: str) -> bool:
    return bool(situation.scene.pinned[situation.scene.slot(name)])


def _point(situation: Situation, name: str) -> Point:
    return situation.scene.place(situation.scene.slot(name))


def _is_slack(situation: Situation) -> bool:
    options = situation.options
    return isinstance(options, RopeOptions) and options.slack >= ENOUGH_SLACK


def _is_held(situation: Situation) -> bool:
    rope = _slack_rope(situation)
    return rope is not None and all(_held(situation, f"{rope.id}.{end}") for end in ("start", "end"))


def _to_hold(situation: Situation) -> Target:
    rope = _slack_rope(situation)
    if situation.tool != "pin" or rope is None:
        return "tool_pin"
    return _point(situation, f"{rope.id}.{'start' if _held(situation, f'{rope.id}.end') else 'end'}")


def _is_heavy(situation: Situation) -> bool:
    options = situation.options
    return isinstance(options, ParticleOptions) and options.mass >= ENOUGH_MASS


def _carries(situation: Situation) -> bool:
    level = situation.scene.level
    heavy = {particle.id for particle in level.particles if particle.mass >= ENOUGH_MASS}
    ropes = {body.id for body in level.bodies if isinstance(body, RopeDef)}
    pairs = [{name.partition(".")[0] for name in pair} for pair in level.welds]
    return any(pair & heavy and pair & ropes for pair in pairs)


def _to_load(situation: Situation) -> Target:
    rope = _slack_rope(situation)
    if situation.tool != "particle" or rope is None:
        return "tool_particle"
    return _point(situation, f"{rope.id}.{rope.segments // 2}") if _is_heavy(situation) else "mass"


STEPS = (
    Step(
        "A rope",
        "Take the rope tool: click it, or press R.",
        lambda _: "tool_rope",
        lambda situation: situation.tool == "rope" or _slack_rope(situation) is not None,
    ),
    Step(
        "Some slack",
        "A bridge sags. Turn the wheel over “slack” to 0.1 or more, or type it there and press Enter.",
        lambda situation: "slack" if situation.tool == "rope" else "tool_rope",
        lambda situation: _is_slack(situation) or _slack_rope(situation) is not None,
    ),
    Step(
        "Across",
        "Drag from left to right, as far as the bridge should reach. Its start is pinned already.",
        lambda situation: "canvas" if situation.tool == "rope" else "tool_rope",
        lambda situation: _slack_rope(situation) is not None,
    ),
    Step(
        "A pin",
        "Take the pin tool (P), and click the loose end of the rope.",
        _to_hold,
        _is_held,
    ),
    Step(
        "A weight",
        "Take the particle tool (A), turn the wheel over “mass” to 10 kg or more, and click the middle of the rope.",
        _to_load,
        _carries,
    ),
    Step(
        "Play",
        "Your bridge is complete. Play it: click the triangle, or press E.",
        lambda _: "play",
        lambda situation: situation.playing,
    ),
)

END = Step(
    "It carries its weight",
    "Pull at it with the mouse. E brings you back to the sheet, Ctrl+S there saves it, and F1 shows all keys.",
    lambda _: "canvas",
    lambda _: False,
)


class Tour:
    """A walk through the steps; `index` is the one that is shown, len(STEPS) the end.

    stays: the person went back to it, and it stays until they go on.
    """

    def __init__(self) -> None:
        self.index = 0
        self.stays = False

    @property
    def step(self) -> Step:
        """The present step."""
        return STEPS[self.index] if self.index < len(STEPS) else END

    @property
    def is_over(self) -> bool:
        """Whether all steps are done."""
        return self.index == len(STEPS)

    def follow(self, situation: Situation) -> None:
        """Go on to the first step that is not done yet."""
        while not self.stays and self.step.done(situation):
            self.index += 1

    def back(self) -> None:
        """Show the step before again, done or not."""
        self.index, self.stays = max(self.index - 1, 0), True

    def next(self) -> None:
        """Go on from a step that was gone back to."""
        self.index, self.stays = min(self.index + 1, len(STEPS)), False
