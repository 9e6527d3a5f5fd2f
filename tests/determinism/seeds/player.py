"""Who gives random commands to a running level, all by the names of files, and records what the level made of them."""

import random
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.level.format.look import PALETTE
from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.physics.settings import AUTO
from sandbox.physics.softness.firmness import firm_bodies
from sandbox.session.commands import CommandError
from sandbox.session.commands.records import from_record
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import Replay
from sandbox.session.session import Session
from tests.determinism.seeds.levels import EXPLICIT, number, random_level
from tests.support.parts import BODIES, placed, placed_cart

Record = dict[str, Any]

# How likely a hand that holds something moves in a tick.
MOVES = 0.5
# How likely what was undone is redone in the next tick.
REDOES = 0.4
# Stored states of a recording, from which it can be verified.
STATES = 4


def recording(seed: int, ticks: int, folder: Path) -> Replay:
    """Play the level of a seed for a number of ticks, record it, and read the recording.

    The first ticks of a longer recording are those of a shorter one.
    """
    path = folder / f"{seed}.replay.gz"
    session = Session(random_level(seed))
    session.record_to(path, max(ticks // STATES, 1))
    player = Player(session, seed)
    while session.tick < ticks:
        player.act()
        session.advance()
    assert session.stop_recording() == path, session.messages
    return read_replay(path)


class Player:
    """Gives a session a command in every second tick or so; what it refuses is left out of its recording."""

    def __init__(self, session: Session, seed: int) -> None:
        self.session = session
        self.chance = random.Random(f"commands {seed}")
        # The hands that hold something: the gesture of each.
        self.hands: dict[int, int] = {}

    def act(self) -> None:
        """Do what comes to mind before the next tick; now and then that is only to redo what was undone before."""
        if self.session.can_redo and self.chance.random() < REDOES:
            self._do({"type": "redo"})
            return
        for hand, gesture in list(self.hands.items()):
            if self.chance.random() < MOVES:
                self._do({"type": "move_grab", "grab": hand, "target": self._place()}, gesture)
        acts = (
            (0.08, self._grab), (0.06, self._release), (0.05, self._pin), (0.03, self._unpin), (0.04, self._cut),
            (0.05, self._coefficients), (0.03, self._firmness), (0.03, self._inflation), (0.06, self._drive),
            (0.06, self._push), (0.03, self._shake), (0.03, self._move), (0.02, self._remove), (0.02, self._free),
            (0.03, self._add_particle), (0.03, self._add_spring), (0.03, self._add_body), (0.03, self._weather),
            (0.04, self._solver), (0.05, self._undo), (0.08, self._key), (0.02, self._weigh),
            (0.05, self._paint),
        )  # fmt: skip
        for share, act in acts:
            if self.chance.random() < share:
                act()

    def _do(self, record: Record, gesture: int | None = None) -> bool:
        """Carry a command out, of a gesture of its own where none is given; whether it was not refused."""
        session, before = self.session, len(self.session.messages)
        try:
            command = from_record(record, session.world)
        except CommandError:
            return False
        session.submit(command, session.new_gesture() if gesture is None else gesture)
        session.apply_pending()
        return len(session.messages) == before

    def _place(self) -> list[float]:
        return [number(self.chance, -6.0, 6.0), number(self.chance, 0.5, 8.5)]

    def _pair(self, most: float) -> list[float]:
        return [number(self.chance, -most, most), number(self.chance, -most, most)]

    def _particle(self, pinned: bool | None = None) -> str:
        """The name of a particle, of a pinned or a free one where that is asked for; no name where there is none."""
        world = self.session.world
        found = shown_particles(world)
        if pinned is not None:
            found &= (world.inverse_mass == 0.0) == pinned
        slots = np.flatnonzero(found).tolist()
        return world.particle_names[self.chance.choice(slots)] if slots else ""

    def _chosen(self, names: Any) -> str:
        return self.chance.choice(list(names)) if names else ""

    def _grab(self) -> None:
        hand, gesture = self.chance.randrange(10), self.session.new_gesture()
        strength = self.chance.choice([30.0, 100.0, 100.0, 1e4])
        record = {"type": "grab", "grab": hand, "particle": self._particle(False), "target": self._place()}
        reach = self.chance.choice([0.0, 0.5, 1.5])
        if hand not in self.hands and self._do(record | {"strength": strength, "radius": reach}, gesture):
            self.hands[hand] = gesture

    def _release(self) -> None:
        if self.hands:
            hand = self.chance.choice(list(self.hands))
            self._do({"type": "release", "grab": hand}, self.hands.pop(hand))

    def _pin(self) -> None:
        self._do({"type": "pin", "particle": self._particle(False)})

    def _unpin(self) -> None:
        self._do({"type": "unpin", "particle": self._particle(True)})

    def _cut(self) -> None:
        world = self.session.world
        slots = np.flatnonzero(shown_springs(world)).tolist()
        chosen = self.chance.sample(slots, min(self.chance.randint(1, 3), len(slots)))
        self._do({"type": "cut_springs", "springs": [world.spring_names[slot] for slot in chosen]})

    def _coefficients(self) -> None:
        world = self.session.world
        record: Record = {"type": "set_coefficients"}
        damping = number(self.chance, 0.0, EXPLICIT if world.settings.solver == "single_pass" else 1.0)
        record |= self.chance.choice([{"stiffness": damping * number(self.chance, 0.0, 1.0)}, {"damping": damping}])
        self._do(record | self.chance.choice([{}, {"material": self._chosen(world.material_names)}]))

    def _firmness(self) -> None:
        record = {"type": "set_firmness", "body": self._chosen([form.name for form in firm_bodies(self.session.world)])}
        softness = {"sag": number(self.chance, 0.0, 0.35)}
        self._do(record | self.chance.choice([softness, {"hz": number(self.chance, 0.5, 6.0)}]))

    def _weigh(self) -> None:
        self._do({"type": "scale_mass", "particle": self._particle(), "factor": number(self.chance, 0.5, 2.0)})

    def _paint(self) -> None:
        joined = {body for each in self.session.world.joined if "kit" not in each.definition for body in each.names}
        names = [name for name in self.session.world.particle_names if name.partition(".")[0] in joined]
        self._do({"type": "set_colour", "particle": self._chosen(names), "colour": self._chosen(PALETTE)})

    def _inflation(self) -> None:
        name = self._chosen(self.session.world.area_names)
        self._do({"type": "set_inflation", "body": name, "value": number(self.chance, 0.6, 1.6)})

    def _drive(self) -> None:
        name = self._chosen(self.session.world.actuators.names)
        self._do({"type": "set_drive", "part": name, "value": self.chance.choice([0.0, 1.0, -1.0, 0.3])})

    def _key(self) -> None:
        keys = self.session.world.rule_keys
        if keys:
            key = self.chance.choice(keys)
            self._do({"type": "hold_key", "key": key, "down": self.chance.random() < 0.5})

    def _push(self) -> None:
        record = {"type": "push", "position": self._place(), "radius": number(self.chance, 0.3, 3.0)}
        self._do(record | {"impulse": self._pair(40.0), "outward": number(self.chance, 0.0, 20.0)})

    def _shake(self) -> None:
        self._do({"type": "shake", "acceleration": self._pair(60.0)})

    def _move(self) -> None:
        at_rest = self.chance.random() < 0.5
        self._do({"type": "move_body", "particle": self._particle(), "by": self._pair(1.0), "at_rest": at_rest})

    def _remove(self) -> None:
        name = self._particle()
        body = name.rpartition(".")[0]
        what = {"body": body} if body and self.chance.random() < 0.5 else {"particle": name}
        self._do({"type": "remove", **what})

    def _free(self) -> None:
        self._do({"type": "free", "particle": self._particle()})

    def _add_particle(self) -> None:
        record = {"type": "add_particle", "position": self._place(), "mass": number(self.chance, 0.1, 20.0)}
        pinned = self.chance.random() < 0.1
        self._do(record | {"radius": self.chance.choice([0.05, 0.25]), "velocity": self._pair(6.0), "pinned": pinned})

    def _add_spring(self) -> None:
        record = {"type": "add_spring", "particle_a": self._particle(), "particle_b": self._particle()}
        self._do(record | {"stiffness": 0.02, "damping": 0.04})

    def _add_body(self) -> None:
        x, y = self._place()
        kind = self._chosen([*BODIES, "cart"])
        fields = placed_cart(x, y) if kind == "cart" else {"body": placed(BODIES[kind], x, y, self._pair(4.0))}
        listed = {name: list(value) if isinstance(value, tuple) else value for name, value in fields.items()}
        if "welds" in listed:
            listed["welds"] = [list(pair) for pair in listed["welds"]]
        self._do({"type": "add_body", **listed})

    def _weather(self) -> None:
        gravity = {"type": "set_gravity", "gravity": self.chance.choice([[0.0, -9.81], self._pair(10.0)])}
        air = {"type": "set_air", "wind": self._pair(9.0), "drag": number(self.chance, 0.0, 1.5)}
        self._do(self.chance.choice([gravity, air]))

    def _solver(self) -> None:
        solver = self.chance.choice(["direct", "direct", "iterative", "single_pass"])
        gesture = self.session.new_gesture()
        if solver == "single_pass":
            self._do({"type": "set_coefficients", "stiffness": EXPLICIT, "damping": EXPLICIT}, gesture)
        substeps, warm_start = self.chance.choice([1, 2, 4, AUTO]), self.chance.choice([0.0, 0.5, 1.0])
        record = {"type": "set_solver", "solver": solver, "substeps": substeps, "warm_start": warm_start}
        self._do(record | {"iterations": self.chance.randint(1, 15)}, gesture)

    def _undo(self) -> None:
        # The undone gesture may be one of these: what is left of it would have no effect.
        if self._do({"type": "undo"}):
            self.hands.clear()
