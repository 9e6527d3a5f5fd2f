"""Parts that join a running level, and a person who plays with them at random, the same every time."""

import json
import random

import numpy as np

from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.session.commands import (
    AddBody,
    AddParticle,
    CutSprings,
    Grab,
    MoveGrab,
    Pin,
    Push,
    Release,
    Remove,
    SetAir,
    SetCoefficients,
    SetDrive,
    SetFirmness,
    SetInflation,
    SetSolver,
    Shake,
)

# A body of each kind, small, at the origin or from it on.
BODIES = {
    "rope": {"type": "rope", "start": [0, 0], "end": [1, 0.2], "segments": 4},
    "bridge": {"type": "bridge", "start": [0, 0], "end": [2, 0], "segments": 3, "height": 0.5},
    "girder": {"type": "girder", "start": [0, 0], "end": [2, 0], "segments": 3, "height": 0.4},
    "web": {"type": "web", "position": [0, 0], "radius": 0.7, "rings": 2, "spokes": 5},
    "wheel": {"type": "wheel", "position": [0, 0], "radius": 0.4, "thickness": 0.15, "segments": 6},
    "ring": {"type": "ring", "position": [0, 0], "radius": 0.4, "segments": 8, "inflation": 1.1},
    "jelly": {"type": "jelly", "position": [0, 0], "shape": {"box": [0.6, 0.6]}, "spacing": 0.3,
              "firmness": {"sag": 0.1}},
    "mesh": {"type": "mesh", "particles": [[0, 0], [0.6, 0], [0.3, 0.5]], "springs": [[0, 1], [1, 2], [2, 0]]},
}  # fmt: skip
SKIN = {"skin": {"stiffness": 0.8, "damping": 0.95, "tension_limit": 0.5}}
# A cart: a chassis and two wheels with motors, welded to its ends by their hubs.
_WHEEL = BODIES["wheel"] | {"particle_mass": 0.3, "touches_mount": False,
                            "motor": {"speed": 8.0, "torque": 40.0, "key": "d", "reverse_key": "a"}}  # fmt: skip
CART = {
    "body": {"type": "mesh", "id": "frame", "particles": [[-0.8, 0], [0.8, 0], [0, 0.5]],
             "springs": [[0, 1], [1, 2], [2, 0]], "material": "skin"},
    "others": ({**_WHEEL, "id": "back", "position": [-0.8, 0]}, {**_WHEEL, "id": "front", "position": [0.8, 0]}),
    "welds": (("frame.0", "back.hub"), ("frame.1", "front.hub")),
    "materials": SKIN,
}  # fmt: skip


def placed(body, x, y, velocity=(0.0, 0.0)):
    """A body moved by (x, y) [m], of a start velocity [m/s]."""
    moved = dict(body) | {"velocity": list(velocity)}
    for name in ("start", "end", "position"):
        if name in body:
            moved[name] = [body[name][0] + x, body[name][1] + y]
    if "particles" in body:
        moved["particles"] = [[px + x, py + y] for px, py in body["particles"]]
    return moved


def placed_cart(x, y):
    """The fields of an AddBody that adds a cart."""
    others = tuple(placed(other, x, y) for other in CART["others"])
    return CART | {"body": placed(CART["body"], x, y), "others": others}


def room(solver="direct", *bodies, **changes):
    """A level with a floor, walls and these bodies."""
    level = {
        "format": "spring-sandbox/level", "version": 4, "name": "room", "contacts": {},
        "settings": {"solver": solver}, "walls": {"box": [-4, 0, 4, 6]}, "bodies": list(bodies),
    } | changes  # fmt: skip
    return parse_level(json.dumps(level).encode(), "room")


def furnished(solver="direct"):
    """The room with a body to grab, a rope with a pin, and a motor."""
    return room(
        solver,
        placed(BODIES["jelly"], -2, 0.5) | {"id": "cube"},
        placed(BODIES["rope"], 0.5, 4) | {"id": "rope", "pin": ["start"]},
        placed(BODIES["wheel"], 2.5, 3) | {"id": "mill", "pin": ["hub"], "motor": {"speed": 5, "torque": 20}},
        particles=[{"id": "ball", "position": [3, 1], "radius": 0.2}],
    )


class RandomPlayer:
    """Submits a few commands a tick to a session; seed: of what it does."""

    def __init__(self, session, seed):
        self.session, self.random, self.held = session, random.Random(seed), None
        self.shaken = None

    def act(self):
        """Do what comes to mind before the next tick."""
        deeds = (
            (0.06, self._add), (0.03, self._remove), (0.05, self._push), (0.06, self._drag), (0.02, self._cut),
            (0.03, self._set), (0.04, self.session.undo), (0.03, self.session.redo), (0.02, self._drop_ball),
            (0.05, self._shake),
        )  # fmt: skip
        for chance, deed in deeds:
            if self.random.random() < chance:
                deed()
        if self.held is not None:
            self.session.submit(MoveGrab(0, self._place()), self.held)

    def _place(self):
        return self.random.uniform(-3.5, 3.5), self.random.uniform(0.8, 5.5)

    def _particle(self):
        found = np.flatnonzero(shown_particles(self.session.world)).tolist()
        return self.random.choice(found) if found else None

    def _add(self):
        kind = self.random.choice([*BODIES, "cart"])
        x, y = self._place()
        if kind == "cart":
            self.session.submit(AddBody(**placed_cart(x, y)))
            return
        body = placed(BODIES[kind], x, y, (self.random.uniform(-5, 5), 0.0))
        more = {"materials": SKIN} if self.random.random() < 0.5 else {}
        self.session.submit(AddBody(body | ({"material": "skin"} if more else {}), **more))

    def _drop_ball(self):
        self.session.submit(AddParticle(self._place(), radius=0.2, mass=2.0, velocity=(1.0, -2.0)))

    def _remove(self):
        particle = self._particle()
        if particle is None:
            return
        name = self.session.world.particle_names[particle]
        body = name.partition(".")[0]
        if "." in name and body != "+" and self.random.random() < 0.5:
            self.session.submit(Remove(body=body))
        else:
            self.session.submit(Remove(particle=particle))

    def _push(self):
        impulse = self.random.uniform(-20, 20), self.random.uniform(-20, 20)
        self.session.submit(Push(self._place(), self.random.uniform(0.3, 2.0), impulse, self.random.uniform(0, 10)))

    def _shake(self):
        if self.shaken is None or self.random.random() < 0.3:
            self.shaken = self.session.new_gesture()
        self.session.submit(Shake((self.random.uniform(-80, 80), self.random.uniform(-80, 80))), self.shaken)

    def _drag(self):
        if self.held is not None:
            self.session.submit(Release(0), self.held)
            self.held = None
        elif (particle := self._particle()) is not None:
            self.held = self.session.new_gesture()
            self.session.submit(Grab(0, particle, self._place(), 100.0, self.random.choice([0.0, 0.5])), self.held)

    def _cut(self):
        springs = np.flatnonzero(shown_springs(self.session.world)).tolist()
        if springs:
            self.session.submit(CutSprings(tuple(self.random.sample(springs, min(3, len(springs))))))

    def _set(self):
        world, roll = self.session.world, self.random.random()
        material = self.random.randrange(len(world.material_names))
        commands = [
            SetCoefficients(roll, max(roll, 0.9), material),
            SetSolver(self.random.choice(["direct", "iterative", "single_pass"])),
            SetAir((5 * roll, 0.0), 0.3),
        ]
        if world.actuators.names:
            commands.append(SetDrive(self.random.randrange(len(world.actuators.names)), 2 * roll - 1))
        if world.area_names:
            commands.append(SetInflation(self.random.randrange(len(world.area_names)), 0.5 + roll))
        if world.forms:
            commands.append(SetFirmness(self.random.randrange(len(world.forms)), sag=0.05 + 0.2 * roll))
        if (particle := self._particle()) is not None:
            commands.append(Pin(particle))
        self.session.submit(self.random.choice(commands))
