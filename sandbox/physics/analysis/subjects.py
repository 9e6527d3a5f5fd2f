"""Subjects: the bodies of a world of which one says how far they sag, and what measures each of them."""

from dataclasses import dataclass, replace

import numpy as np

from sandbox.physics.analysis.firm_bodies import firm_bodies
from sandbox.physics.analysis.firmness import LARGEST_READ, lowest_mode_of
from sandbox.physics.analysis.sag_meter import Pair, SagMeter
from sandbox.physics.analysis.stance import Stance, Support, stance_of
from sandbox.physics.jit import COMPILED
from sandbox.physics.keeping.forms import FirmBody, StiffForm
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.world import World

# Digits of lengths and masses by which bodies count as alike.
ALIKE = 9
# A rope or a net is set by its material, of whose springs at least this share is its own.
OWN = 0.9


@dataclass(frozen=True, eq=False)
class Subject:
    """A body by its name; slot: its place among `firm_bodies`, None: a rope or a net, which pins hold.

    lowest_mode: of its form; 0: it is not stiff without pins, or a net.
    """

    name: str
    body: FirmBody
    slot: int | None
    lowest_mode: float


def subjects_of(world: World) -> dict[str, Subject]:
    """The bodies that are stiff by their form, and the ropes and nets that pins hold from end to end, by name."""
    found = {}
    for slot, body in enumerate(firm_bodies(world)):
        mode = _mode_of(world, body)
        # What is held everywhere cannot sag.
        if mode > 0.0 and not stance_of(world, body).held.all():
            found[body.name] = Subject(body.name, body, slot, mode)
    for name, springs in _named(world).items():
        net = None if name in found else _net(world, name, springs)
        stance = None if net is None else stance_of(world, net)
        if net is not None and stance is not None and stance.support is Support.SPANNED and not stance.held.all():
            found[name] = Subject(name, net, None, 0.0)
    return found


def _mode_of(world: World, body: FirmBody) -> float:
    """The lowest mode of a body; while kernels are interpreted, which takes long, only where it is known."""
    is_whole = any(body is form for form in world.forms)
    known = float(world.lowest_mode[body.springs[0]]) if is_whole else 0.0
    if known > 0.0 or not COMPILED:
        return known
    return lowest_mode_of(body.shape) if len(body.shape.mass) <= LARGEST_READ else 0.0


def _named(world: World) -> dict[str, list[int]]:
    """Springs by the body that they are named after."""
    found: dict[str, list[int]] = {}
    for slot, name in enumerate(world.spring_names):
        body, colon, _ = name.rpartition(":")
        if body and colon and world.spring_active[slot] and world.law[slot] != LAW_HOOKE:
            found.setdefault(body, []).append(slot)
    return found


def _net(world: World, name: str, slots: list[int]) -> FirmBody | None:
    """A body of springs alone that has a material almost for itself; None: it is none."""
    springs = np.array(slots, np.int64)
    kinds = np.unique(world.material[springs])
    if len(kinds) != 1 or kinds[0] < 0 or OWN * np.count_nonzero(world.material == kinds[0]) > len(springs):
        return None
    ends = np.stack([world.particle_a[springs], world.particle_b[springs]], axis=1)
    particles, pairs = np.unique(ends, return_inverse=True)
    if not 3 <= len(particles) <= LARGEST_READ:
        return None
    none = np.zeros((0, 3), np.int64)
    shape = StiffForm(world.origin[particles], world.mass[particles], pairs.reshape(-1, 2), none, none)
    return FirmBody(name, shape, springs, np.zeros(0, np.int64))


class Meters:
    """The meters of the bodies of a run: those that are alike, and held alike, have one in common."""

    def __init__(self) -> None:
        self._stances: dict[str, tuple[tuple[object, ...], Stance]] = {}
        self._meters: dict[tuple[object, ...], SagMeter] = {}

    def of(self, world: World, subject: Subject) -> SagMeter:
        """The meter of a body as it is held now."""
        stance = self._stance(world, subject)
        settings = replace(world.settings, wind=(0.0, 0.0))
        places = stance.points - stance.points.min(axis=0)
        exact = (stance.held, stance.rests, stance.gravity_scale, stance.friction, stance.pairs)
        about = (places, stance.mass, stance.rest, stance.radius)
        key = (
            settings, stance.support, *(each.tobytes() for each in exact),
            *(np.round(each, ALIKE).tobytes() for each in about),
        )  # fmt: skip
        if key not in self._meters:
            self._meters[key] = SagMeter(stance, settings, subject.lowest_mode)
        return self._meters[key]

    def _stance(self, world: World, subject: Subject) -> Stance:
        made_of = (id(world), world.topology_version, subject.body.shape, world.settings.gravity)
        kept = self._stances.get(subject.name)
        if kept is None or kept[0] != made_of:
            kept = self._stances[subject.name] = made_of, stance_of(world, subject.body)
        return kept[1]

    @property
    def busy(self) -> list[SagMeter]:
        """Those that have work to go on with."""
        return [meter for meter in self._meters.values() if meter.is_busy]

    def advance(self, seconds: float) -> bool:
        """Work for so long at most; whether anything has come to be known."""
        busy = self.busy
        return any([meter.advance(seconds / len(busy)) for meter in busy])


def pair_of(world: World, body: FirmBody) -> Pair | None:
    """What the springs of a body have in common; None: they differ."""
    springs = body.springs[world.spring_active[body.springs]]
    if not len(springs):
        return None
    found = tuple(float(values[springs[0]]) for values in (world.stiffness, world.damping, world.lowest_mode))
    differ = any(np.ptp(values[springs]) for values in (world.stiffness, world.damping))
    return None if differ else found  # type: ignore[return-value]
