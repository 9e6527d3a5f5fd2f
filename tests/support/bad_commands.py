"""Commands of every kind with arguments that are not there or make no sense, and what comes of each.

Run as a program it prints what comes of all, as JSON, by whatever way kernels run.
"""

import json
import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from sandbox.physics.commands.command_table import KINDS, RefusedCommand
from sandbox.physics.constraints import AREA
from sandbox.physics.driving import Actuators
from sandbox.physics.jit import way
from sandbox.physics.keeping.equipment import FirmBody, StiffForm
from sandbox.physics.keeping.growing import grow
from sandbox.physics.kits.removing import remove_particles
from sandbox.physics.snapshot import state_hash
from sandbox.physics.state import COLUMNS, Family
from sandbox.physics.world import World

NAN, INF = math.nan, math.inf
# Of a world of `made`: particles 0 to 3, of which 3 was removed, cursors of hands from 4 on; springs 0 to 2, of which 2
# was cut, and those of hands from 3 on.
_NO_WHOLE_NUMBER = (1.5, NAN, INF, "0", None, True, [0])
_BEYOND = (-1, -2, 10**6, 2**31, 10**30, -(10**30))
PARTICLES = (3, 4, 13, 14, *_BEYOND, *_NO_WHOLE_NUMBER)
HANDS = (10, 11, *_BEYOND, *_NO_WHOLE_NUMBER)
PARTS = (1, 2, *_BEYOND, *_NO_WHOLE_NUMBER)
_NO_SPRINGS = (2, 3, 12, 13, *_BEYOND, 1.5, NAN, "0", None, True)
# The bad one is also the last of a list.
LISTS = (*([0, 1, each] for each in _NO_SPRINGS), [-1], [[0]], 0, None, "01", NAN, np.array([0.0]))
_NO_NUMBERS = (NAN, INF, -INF, 10**400, "1", None, True, [1.0])
NUMBERS = (*_NO_NUMBERS, np.array([1.0]))
NOT_BELOW_0 = (*NUMBERS, -1.0, -1e-300)
SHARES = (*(each for each in NOT_BELOW_0 if each is not None), 1.5)
DRIVES = (*NUMBERS, 1.5, -1.0000001)
POINTS = (
    *((0.0, each) for each in _NO_NUMBERS), *((each, 0.0) for each in _NO_NUMBERS), (0.0,), (0.0, 1.0, 2.0), (), 1.0,
    None, "ab", np.zeros((2, 2)), NAN,
)  # fmt: skip
KEYS = (1, 2, *_BEYOND, *_NO_WHOLE_NUMBER)
DURATIONS = (-1, 1_000_001, 10**30, *_NO_WHOLE_NUMBER)
FACTORS = (*(each for each in NUMBERS if each is not None), 1e30, -1.0)
SOLVERS = ("none", "", 3, -1, True, [0], 1.5, 10**6)
ITERATIONS = ("none", "", 1001, 0, -1, True, [0], 1.5)
SUBSTEPS = ("none", "", 3, -1, 128, True, [0], 1.5)
_GIVEN_POINTS, _GIVEN_NUMBERS = (tuple(each for each in values if each is not None) for values in (POINTS, NOT_BELOW_0))


def part_bodies(world: World, springs: Any) -> None:
    """Divide the bodies of springs."""
    world.command("part_bodies", springs=springs)


def hold_key(world: World, key: Any, down: Any) -> None:
    """Press a key, or let it go."""
    world.command("hold_key", key=key, down=down)


def inflate(world: World, body: Any, value: Any, duration: Any = 0) -> None:
    """Inflate a body's areas."""
    world.command("set_inflation", body=body, value=value, duration=duration)


def move_body(world: World, particle: Any, by: Any) -> None:
    """Move what hangs together."""
    world.command("move_body", particle=particle, by=by, at_rest=False)


def free(world: World, particle: Any) -> None:
    """Free a body, unless something holds it."""
    try:
        world.command("free", particle=particle)
    except RefusedCommand as refused:
        assert "is pinned" in str(refused)


def scale_mass(world: World, particle: Any, factor: Any) -> None:
    """Make a body so many times as heavy."""
    world.command("scale_mass", particle=particle, factor=factor)


def set_solver(world: World, solver: Any, iterations: Any, substeps: Any, warm_start: Any, duration: Any) -> None:
    """Solve by another solver."""
    world.command(
        "set_solver", solver=solver, iterations=iterations, substeps=substeps, warm_start=warm_start, duration=duration
    )


def set_firmness(world: World, body: Any, sag: Any, duration: Any) -> None:
    """Set how soft a body is by its sag."""
    world.command("set_firmness", body=body, sag=sag, hz=None, ratio=None, duration=duration)


def soften(world: World, body: Any, value: Any, gravity: Any, duration: Any) -> None:
    """Let all of a body sag."""
    given = {"whole": True, "way": 0, "second": 0.0}
    world.command("soften", body=body, value=value, gravity=gravity, duration=duration, **given)


# Of every kind: the method of World, or a function of one, arguments that are right, and for each of these what is
# wrong in its place.
CALLS: dict[str, tuple[str | Callable[..., Any], tuple[Any, ...], tuple[tuple[Any, ...], ...]]] = {
    "grab": ("hold", (1, 0, (0.0, 1.0), 100.0, 0.1), (HANDS, PARTICLES, POINTS, NOT_BELOW_0, NOT_BELOW_0)),
    "move_grab": ("move_grab", (0, (0.0, 1.0)), (HANDS, POINTS)),
    "release": ("release", (0,), (HANDS,)),
    "pin": ("pin", (0,), (PARTICLES,)),
    "unpin": ("unpin", (1,), (PARTICLES,)),
    "cut_springs": ("cut", ([0, 1],), (LISTS,)),
    "break_springs": ("break_springs", ([0, 1],), (LISTS,)),
    "part_bodies": (part_bodies, ([0, 1],), (LISTS,)),
    "set_coefficients": (
        "set_coefficients", (0.5, 0.5, 0, 3),
        (SHARES, SHARES, tuple(each for each in PARTS if each is not None), DURATIONS),
    ),
    "set_gravity": ("set_gravity", ((1.0, 0.0), 3), (POINTS, DURATIONS)),
    "set_air": ("set_air", ((1.0, 0.0), 0.5, 3), (_GIVEN_POINTS, _GIVEN_NUMBERS, DURATIONS)),
    "set_drive": ("drive", (0, 0.5), (PARTS, DRIVES)),
    "set_firmness": (set_firmness, (0, 0.1, 3), (PARTS, _GIVEN_NUMBERS, DURATIONS)),
    "soften": (soften, (0, 0.1, (0.0, -9.81), 3), (PARTS, NUMBERS, POINTS, DURATIONS)),
    "hold_key": (hold_key, (0, True), (KEYS,)),
    "push": ("push", ((0.0, 0.0), (1.0, 0.0), 1.0, 2.0), (POINTS, POINTS, NUMBERS, NOT_BELOW_0)),
    "shake": ("shake", ((1.0, 0.0),), (POINTS,)),
    "set_inflation": (inflate, (0, 1.5, 3), (PARTS, NOT_BELOW_0, DURATIONS)),
    "scale_mass": (scale_mass, (0, 2.0), (PARTICLES, FACTORS)),
    "free": (free, (2,), (PARTICLES,)),
    "move_body": (move_body, (0, (1.0, 0.0)), (PARTICLES, POINTS)),
    "set_solver": (set_solver, ("iterative", 5, 4, 0.5, 3), (SOLVERS, ITERATIONS, SUBSTEPS, SHARES, DURATIONS)),
}  # fmt: skip
assert CALLS.keys() == KINDS.keys()


def made(has_hands: bool = True) -> World:
    """A world with particles, springs and a part that are in use, and with some that are not any more."""
    world = World()
    world.add_particles(["a", "b", "c", "d"], [(0, 0), (1, 0), (0, 1), (5, 5)], pinned=[False, True, False, False],
                        collides=2)  # fmt: skip
    world.add_springs(["s", "t", "u"], [0, 1, 0], [1, 2, 2])
    world.add_constraints(AREA, [[0, 1, 2]])
    world.name_areas("abc", range(1))
    shape = StiffForm(
        world.position[:3].copy(), world.mass[:3].copy(), np.array([[0, 1], [1, 2], [0, 2]]), np.array([[0, 1, 2]]),
        np.zeros((0, 3), np.int64),
    )  # fmt: skip
    world.forms = (FirmBody("abc", shape, np.arange(3), np.arange(1)),)
    world.fit(Actuators(("engine",)), [0.25])
    grow(world, Family.KEY, 1, {})
    if has_hands:
        world.reserve_grabs()
        world.hold(0, 2, (0.5, 1.5))
    remove_particles(world, np.array([3]))
    world.cut([2])
    return world


def wrong_calls(kind: str) -> Iterator[tuple[str, Callable[[World], Any]]]:
    """Calls of a kind, each with one argument that is wrong, by what it says."""
    method, right, wrong = CALLS[kind]
    for place, values in enumerate(wrong):
        for value in values:
            given = (*right[:place], value, *right[place + 1 :])
            label = f"{kind} {place}: {value!r}"
            yield label, lambda world, given=given: call(world, method, given)


def call(world: World, method: str | Callable[..., Any], given: tuple[Any, ...]) -> Any:
    """Call a method of a world, or a function of one."""
    return getattr(world, method)(*given) if isinstance(method, str) else method(world, *given)


def memory_of(world: World) -> list[bytes]:
    """Everything that a world holds, also rows that wait for their use."""
    arrays = [getattr(world, column.name) for column in COLUMNS] + list(world.good.values())
    whole = [array if array.base is None else array.base for array in arrays]
    names = (
        world.particle_names,
        world.spring_names,
        world.topology_version,
        world.hand_version,
        world.broken.tolist(),
    )
    return [*(array.tobytes() for array in whole), *(array.tobytes() for array in arrays), repr(names).encode()]


def outcome(world: World, act: Callable[[World], Any]) -> str:
    """The fault that a call raises; more where anything of the world has changed."""
    before, hashed = memory_of(world), state_hash(world)
    try:
        act(world)
        text = "taken"
    except (IndexError, ValueError) as error:
        text = f"{type(error).__name__}: {error}"
    return text if memory_of(world) == before and state_hash(world) == hashed else f"{text}; and the world has changed"


def outcomes() -> dict[str, str]:
    """What comes of all wrong calls, in a world with hands and in one without."""
    found = {}
    for has_hands in (True, False):
        world = made(has_hands)
        for kind in CALLS:
            for label, act in wrong_calls(kind):
                found[f"{label}{'' if has_hands else ', no hands'}"] = outcome(world, act)
    return found


if __name__ == "__main__":
    print(json.dumps({"way": way(), "outcomes": outcomes()}))
