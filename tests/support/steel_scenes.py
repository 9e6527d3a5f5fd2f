"""Random scenes of steel that springs tie, and what each tick of theirs does to momentum and energy."""

import itertools
import math
from typing import Any, NamedTuple

import numpy as np

from sandbox.physics.analysis.energy import kinetic_energy, spring_forces, spring_lengths
from sandbox.physics.arrays import Floats
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.world import World
from sandbox.session.session import Session
from tests.support.contacts import last_contacts
from tests.support.situations import order, session_of, slots_of

PLACES = ("air", "touching air", "ice", "slope of ice", "rough", "belt")
RATES = (30, 60, 120, 240)
AIR, ROUGH, COILS = PLACES[:2], PLACES[4:], ("coil", "undamped coil")
G, RADIUS = 9.81, 0.02
# Starts, and what coils give [m/s].
FASTEST = 3.0
# A tie of this Cs or more is no damper.
STEEL = 0.9999
# Ticks over which an impact takes its energy.
IMPACT = 3
# Energy [J/kg] of what is as good as still.
LITTLE = 0.01
# Slots of terrain in pairs of what touches.
TERRAIN = -1


def _body(generator: np.random.Generator, name: str, mass: float, supple: bool) -> tuple[dict[str, Any], float]:
    """A body of steel about the origin, with the masses of its particles to be shared out; and half its width [m]."""
    body: dict[str, Any] = {"id": name, "particle_radius": RADIUS, "material": "m"}
    width, height = generator.uniform(0.4, 1.6), generator.uniform(0.25, 1.0)
    kind = generator.choice(["box", "box", "box", "ball", "girder", "braced", "rod", *(["rope"] if supple else [])])
    if kind == "box":
        body |= {"type": "jelly", "shape": {"box": [width, height]}, "spacing": float(generator.choice([0.25, 0.4]))}
    elif kind == "ball":
        body |= {"type": "jelly", "shape": {"circle": width / 2.0}, "spacing": width / 4.0, "mesh": "fitted"}
    elif kind == "girder":
        segments = int(generator.integers(2, 6))
        body |= {"type": "girder", "segments": segments, "height": height / 2.0}
        body |= {"start": [-width / 2.0, 0.0], "end": [width / 2.0, 0.0]}
    elif kind == "rope":
        body |= {"type": "rope", "segments": int(generator.integers(1, 7))}
        body |= {"start": [-width / 2.0, 0.0], "end": [width / 2.0, 0.0]}
    else:
        count = int(generator.integers(3, 7))
        turns = (np.arange(count) + generator.uniform(-0.3, 0.3, count)) * math.tau / count
        points = 0.5 * np.stack([width * np.cos(turns), height * np.sin(turns)], axis=1)
        if kind == "rod":
            points = np.stack([np.linspace(-0.5, 0.5, count) * width, np.zeros(count)], axis=1)
        pairs = [[i, j] for i in range(count) for j in range(i + 1, count)]
        return body | {
            "type": "mesh", "particles": points.tolist(), "springs": pairs, "masses": [mass / count] * count,
        }, width / 2.0  # fmt: skip
    return body | {"particle_mass": mass}, width / 2.0


class _End(NamedTuple):
    """A body that ties hold: the beginning of its particles' names, how many they are, and its mass [kg]."""

    name: str
    particles: int
    mass: float


def _turned(points: Floats, angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


def _placed(body: dict[str, Any], shift: Floats, angle: float) -> dict[str, Any]:
    """The body turned about the origin by an angle after a shift [m]."""

    def to(point: Any) -> Any:
        return _turned(np.asarray(point, dtype=float) + shift, angle).tolist()

    if body["type"] == "jelly":
        return body | {"position": to([0.0, 0.0]), "angle": angle}
    if body["type"] == "mesh":
        return body | {"particles": [to(point) for point in body["particles"]]}
    return body | {"start": to(body["start"]), "end": to(body["end"])}


def _bodies(generator: np.random.Generator, place: str, angle: float, supple: bool) -> tuple[list[Any], list[_End]]:
    """Bodies side by side, on the ground or in the air, and what ties need to know of each."""
    in_air = place in AIR
    bodies: list[Any] = []
    ends, x = [], 0.0
    for k in range(int(generator.integers(2, 6))):
        mass = float(10.0 ** generator.uniform(-0.5, 1.5))
        body, half = _body(generator, f"b{k}", mass, supple)
        probe = session_of(bodies=[body])
        own = slots_of(probe, body["id"])
        count = len(own)
        if "masses" not in body:
            body["particle_mass"] = mass / count
        low = float(probe.world.position[own, 1].min())
        x += half + 0.05
        shift = np.array([x, float(generator.uniform(-0.3, 0.3)) if in_air else RADIUS - low])
        x += half + float(generator.uniform(0.05, 0.6))
        speed = generator.uniform(-FASTEST, FASTEST, 2)
        body["velocity"] = _turned(speed if in_air else speed * [1.0, 0.0], angle).tolist()
        if place == "air":
            body["collides"] = False
        elif not in_air:
            body["collides"] = True if generator.random() < 0.5 else ["terrain"]
        bodies.append(_placed(body, shift, angle))
        ends.append(_End(f"b{k}.", count, mass))
    if generator.random() < 0.4:
        radius, mass = float(generator.uniform(0.1, 0.3)), float(10.0 ** generator.uniform(-0.5, 1.5))
        spot = _turned(np.array([x + radius, 0.0 if in_air else radius]), angle).tolist()
        disc = {"id": "disc", "mass": mass, "radius": radius, "position": spot, "collides": place != "air"}
        return [*bodies, disc], [*ends, _End("disc", 1, mass)]
    return bodies, ends


def _law(generator: np.random.Generator, kind: str, both: tuple[_End, _End], distance: float, h: float) -> Any:
    """The material of a spring that ties two bodies, and by how much [m] it is longer or shorter than at rest."""
    if kind == "nissen":
        damping = float(generator.uniform(0.3, 1.0))
        stretch = distance * float(generator.uniform(-0.2, 0.2))
        return {"stiffness": damping * float(generator.uniform(0.05, 0.9)), "damping": damping}, stretch
    light, whole = min(end.mass / end.particles for end in both), min(end.mass for end in both)
    stretch = float(generator.uniform(0.05, 0.3)) * distance * float(generator.choice([-1.0, 1.0]))
    # What it holds gives a body no more than FASTEST.
    k = min(whole * (FASTEST / stretch) ** 2, float(generator.uniform(0.02, 0.3)) * light / (h * h))
    c = 0.0 if kind == "undamped coil" else float(generator.uniform(0.0, 0.05)) * light / h
    return {"law": "hooke", "k": k, "c": c}, stretch


def _tie(generator: np.random.Generator, parts: Any, ends: list[_End], supple: bool) -> None:
    """Add ties between neighbours to the parts of a level."""
    discs = parts["particles"]
    at = session_of(bodies=parts["bodies"], particles=discs).world
    kinds = (*COILS, "nissen", "rod", *(["rope"] if supple else []))
    for k, both in enumerate(itertools.pairwise(ends)):
        for again in range(1 + int(generator.random() < 0.3)):
            names = [
                f"{end.name}{generator.integers(end.particles)}" if end.name[-1] == "." else end.name for end in both
            ]
            a, b = (at.position[at.particle_slot(name)] for name in names)
            distance = float(np.hypot(*(b - a)))
            kind = str(generator.choice(kinds[:3] if again else kinds))
            if kind == "rope":
                rope = {
                    "type": "rope", "id": f"rope{k}", "start": a.tolist(), "end": b.tolist(), "material": "m",
                    "segments": int(generator.integers(2, 5)), "collides": False,
                    "particle_mass": 0.1 * both[0].mass / both[0].particles,
                }  # fmt: skip
                parts["bodies"].append(rope)
                parts["welds"] += [[names[0], f"rope{k}.start"], [f"rope{k}.end", names[1]]]
                continue
            spring = {"a": names[0], "b": names[1], "material": "m", "rest_length": distance}
            if kind != "rod":
                law, stretch = _law(generator, kind, both, distance, 1.0 / parts["settings"]["tick_rate"])
                spring |= {"material": f"tie{k}{again}", "rest_length": distance - stretch}
                parts["materials"][spring["material"]] = law
            parts["springs"].append(spring)


def random_steel_scene(seed: int) -> tuple[str, dict[str, Any]]:
    """Where the scene is, of PLACES, and the parts of its level."""
    generator = np.random.default_rng(seed)
    place, rate = PLACES[seed % len(PLACES)], RATES[seed // len(PLACES) % len(RATES)]
    angle = float(generator.uniform(-0.5, 0.5)) if place == "slope of ice" else 0.0
    friction = 0.5 if place in ROUGH or (place == "touching air" and generator.random() < 0.5) else 0.0
    supple = bool(generator.random() < 0.3)
    bodies, ends = _bodies(generator, place, angle, supple)
    ground = {"id": "ground", "polyline": _turned(np.array([[-400.0, 0.0], [400.0, 0.0]]), angle).tolist()}
    if place == "belt":
        ground["belt"] = float(generator.uniform(-2.0, 2.0))
    parts = {
        "settings": {"tick_rate": rate, "gravity": [0.0, 0.0 if place in AIR else -G]},
        "contacts": {"friction": friction, "restitution": 0.0}, "materials": {"m": {"stiffness": 1.0, "damping": 1.0}},
        "bodies": [body for body in bodies if "type" in body],
        "particles": [body for body in bodies if "type" not in body], "springs": [], "welds": [],
        "terrain": [] if place in AIR else [ground],
    }  # fmt: skip
    _tie(generator, parts, ends, supple)
    return place, parts


def is_supple(parts: dict[str, Any]) -> bool:
    """Whether something in it is a chain: as it comes taut, its links take energy as impacts do."""
    return any(body["type"] == "rope" and body["segments"] > 1 for body in parts["bodies"])


def scene(parts: dict[str, Any], pulls: bool) -> Session:
    """A run of it; pulls: after a hand has pulled at it for a fifth of a second, and let go."""
    session = session_of(**parts)
    if pulls:
        world = session.world
        x, y = world.position[0]
        order(session, type="grab", grab=0, particle=world.particle_names[0], target=[x + 0.3, y])
        for _ in range(world.settings.tick_rate // 5):
            session.advance()
        order(session, type="release", grab=0)
        session.advance()
    return session


class Tick(NamedTuple):
    """What a tick did.

    push [N s] (2,): the change of momentum but for gravity's; turn [N m s]: that of angular momentum, about the origin,
    but for what contacts turn whose normals are not along the way between what touches; bend: what friction may turn
    there; lost [J]; most_lost, most_gained [J]: what dampers, friction, impacts and belts can take and give at most;
    inner [J]: the energy of motion about the centre of mass, and of ties, after it.
    """

    push: Floats
    turn: float
    bend: float
    lost: float
    most_lost: float
    most_gained: float
    inner: float


class Ledger:
    """Reads a world tick by tick."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.h = 1.0 / world.settings.tick_rate
        self.free = world.particle_active & (world.inverse_mass > 0.0)
        self.mass = np.where(self.free, world.mass, 0.0)
        self.hooke = world.law == LAW_HOOKE
        self.soft = ~self.hooke & (world.damping < STEEL) | ~self.hooke & (world.stiffness < STEEL)
        self.body = self._rigid_parts()
        self.body_mass = np.bincount(self.body, self.mass)[self.body]
        self.touching: dict[tuple[int, int], int] = {}
        self._read()

    def _rigid_parts(self) -> Any:
        """Which rigid part each particle is of."""
        world, part = self.world, np.arange(self.world.particle_count)
        steel = ~self.hooke & ~self.soft
        for _ in range(world.particle_count):
            before = part.copy()
            for a, b in zip(world.particle_a[steel], world.particle_b[steel], strict=True):
                part[a] = part[b] = min(part[a], part[b])
            if np.array_equal(part, before):
                break
        return part

    def _read(self) -> None:
        world = self.world
        self.x, self.v, self.spin = world.position.copy(), world.velocity.copy(), world.spin.copy()
        self.kinetic = kinetic_energy(world)
        stretch = spring_lengths(world) - world.rest_length
        held = 0.5 * spring_forces(world) * stretch
        self.stored, self.coiled = float(held[self.soft].sum()), float(held[self.hooke].sum())
        self.damped = held

    def _forces(self) -> tuple[Floats, float]:
        """Gravity's and Hooke springs' forces [N] (n, 2) without dampers, and the power [W] that dampers take."""
        world = self.world
        force = (self.mass * world.gravity_scale)[:, None] * np.asarray(world.settings.gravity)
        a, b = world.particle_a, world.particle_b
        along = (world.position[b] - world.position[a]) / np.maximum(spring_lengths(world), 1e-12)[:, None]
        parting = np.sum((world.velocity[b] - world.velocity[a]) * along, axis=1)
        pull = np.where(self.hooke, spring_forces(world), 0.0)[:, None] * along
        np.add.at(force, a, pull)
        np.add.at(force, b, -pull)
        return force, float(np.sum(np.where(self.hooke, world.hooke_damping * parting * parting, 0.0)))

    def _energy(self) -> float:
        """Energy [J] that symplectic Euler keeps: velocities stand half a tick behind."""
        force, _ = self._forces()
        at_rest = -np.sum((self.mass * self.world.gravity_scale)[:, None] * self.x * self.world.settings.gravity)
        return float(self.kinetic + self.stored + self.coiled + at_rest + 0.5 * self.h * np.sum(force * self.v))

    def inner(self) -> float:
        """Energy [J] of motion about the centre of mass, and of ties."""
        drift = np.average(self.v, axis=0, weights=self.mass)
        return float(0.5 * np.sum(self.mass[:, None] * (self.v - drift) ** 2)) + self.stored + self.coiled

    def angular(self) -> float:
        """Angular momentum [kg m^2/s] about the origin, that of discs that turn included."""
        turning = np.sum(self.mass * (self.x[:, 0] * self.v[:, 1] - self.x[:, 1] * self.v[:, 0]))
        return float(turning + np.sum(0.5 * self.mass * self.world.radius**2 * self.spin))

    def _dampers(self) -> float:
        world = self.world
        a, b = world.particle_a[self.soft], world.particle_b[self.soft]
        mass_a, mass_b = self.body_mass[a], self.body_mass[b]
        reduced = mass_a * mass_b / np.maximum(mass_a + mass_b, 1e-12)
        u = np.sum((self.v[b] - self.v[a]) ** 2, axis=1)
        return float(np.sum(0.5 * reduced * u)) + self.stored

    def _contacts(self, before: Floats, place: Floats) -> tuple[float, float, bool, float, float]:
        """What friction and impacts can take and belts can give [J], and whether a contact began."""
        world, contacts = self.world, last_contacts(self.world)
        touching, taken, given, begins, twist, bend = {}, 0.0, 0.0, False, 0.0, 0.0
        g = float(np.hypot(*world.settings.gravity)) * self.h
        for c in range(len(contacts.particle)):
            push = float(contacts.impulse[c, 0] + contacts.impact[c])
            if not push > 0.0:
                continue
            p, ends = contacts.particle[c], [e for e in (contacts.end_a[c], contacts.end_b[c]) if e >= 0]
            key = (int(p), int(self.body[ends[0]]) if ends else TERRAIN)
            touching[key] = self.touching.get(key, 0) + 1
            normal, s = contacts.normal[c], contacts.share[c]
            arm = place[p].copy()
            if ends:
                arm -= (1.0 - s) * place[ends[0]] + s * place[ends[1]] if len(ends) == 2 else place[ends[0]]
            twist += push * float(arm[0] * normal[1] - arm[1] * normal[0])
            bend += abs(float(contacts.impulse[c, 1])) * float(np.hypot(*arm)) * float(contacts.gap[c] > 0.0)
            speeds = []
            for v in (before, world.velocity):
                other = np.zeros(2)
                if len(ends) == 2:
                    other = (1.0 - s) * v[ends[0]] + s * v[ends[1]]
                elif ends:
                    other = v[ends[0]]
                speeds.append(v[p] - other)
            tangent = np.array([normal[1], -normal[0]])
            slip = max(abs(float(u @ tangent)) for u in speeds) + abs(float(contacts.belt[c]))
            slip += sum(abs(float(world.spin[e])) * float(world.radius[e]) for e in [p, *ends])
            taken += float(contacts.friction[c]) * push * slip
            given += float(contacts.friction[c]) * push * abs(float(contacts.belt[c]))
            # What comes near is stopped in one tick by as much as it would overlap, and the rest in the next ones.
            if touching[key] <= IMPACT or contacts.gap[c] > 0.0:
                begins = True
                closing = max(0.0, -float(speeds[0] @ normal)) + g
                taken += self.body_mass[p] * closing * closing
        self.touching = touching
        return taken, given, begins, twist, bend

    def tick(self, session: Session) -> Tick:
        """Advance by a tick and say what it did."""
        before, place, energy, turned = self.v, self.x, self._energy(), self.angular()
        explained = self._dampers() + self.h * self._forces()[1]
        session.advance()
        self._read()
        explained += self.h * self._forces()[1]
        weight = (self.mass * self.world.gravity_scale)[:, None] * np.asarray(self.world.settings.gravity)
        taken, given, begins, twist, bend = self._contacts(before, place)
        explained += taken + self.h * self.h * float(np.sum(weight * weight / np.maximum(self.mass, 1e-12)[:, None]))
        unread = 0.0
        if begins:
            unread = 0.5 * self.h * float(np.sum(np.abs(weight * (self.v - before))))
        push = np.sum(self.mass[:, None] * (self.v - before) - self.h * weight, axis=0)
        lost = energy - self._energy()
        most_lost, most_gained = explained + given + unread, given + unread
        return Tick(push, self.angular() - turned - twist, bend, lost, most_lost, most_gained, self.inner())


class Account(NamedTuple):
    """The worst of a run's ticks: shares of all that moves, and of the energy that moves within [J] and its ties.

    momentum: along what is smooth, or any way in the air; angular: in the air; lost, gained: beyond what explains it;
    grown: the most that energy grows over any number of ticks.
    """

    momentum: float
    angular: float
    lost: float
    gained: float
    grown: float


def account(parts: dict[str, Any], seconds: float, pulls: bool = False) -> Account:
    """Run a scene and keep account of it. In its first two ticks what is tied with other speeds meets."""
    session = scene(parts, pulls)
    ledger, world, worst = Ledger(session.world), session.world, np.zeros(5)
    ways = np.eye(2)
    if parts["terrain"]:
        start, end = np.array(parts["terrain"][0]["polyline"])
        ways = (end - start)[None, :] / np.hypot(*(end - start))
    scale = ledger.inner() + LITTLE * float(ledger.mass.sum())
    moving, most, balance, highest = 1e-9, 1e-9, 0.0, 0.0
    for tick in range(round(seconds * world.settings.tick_rate)):
        speed, reach = np.hypot(*ledger.v.T), np.hypot(*ledger.x.T) + 1.0
        moving = max(moving, float(np.sum(ledger.mass * speed)))
        most = max(most, float(np.sum(ledger.mass * speed * reach)))
        done = ledger.tick(session)
        scale = max(scale, done.inner)
        balance += done.lost + done.most_gained
        highest = max(highest, balance)
        now = [
            float(np.abs(ways @ done.push).max()) / moving, max(0.0, abs(done.turn) - done.bend) / most,
            (done.lost - done.most_lost) / scale, -(done.lost + done.most_gained) / scale, (highest - balance) / scale,
        ]  # fmt: skip
        worst = np.maximum(worst, now if tick > 1 else [*now[:2], 0.0, 0.0, 0.0])
    return Account(*worst.tolist())
