"""Overlays: particles, contacts, forces, velocities, stability, zones and strain, over the things; they only read."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import Colour, Theme, packed
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.things.level_slots import Frame, Seen
from sandbox.editor.scene import outline_of as zone_outline
from sandbox.level.document.model import Level, ZoneDef
from sandbox.physics.analysis.applied_forces import contact_points
from sandbox.physics.analysis.energy import spring_forces
from sandbox.physics.snapshot import Snapshot

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]
Mask = NDArray[np.bool_]

# Those that can be shown, each with a key; "lattice" is drawn by the renderer, in place of faces, and so is "zones", in
# levels that have some.
ZONES = "zones"
NAMES = ("lattice", "particles", "contacts", "forces", "velocities", "stability", ZONES)


def names_for(level: Level) -> tuple[str, ...]:
    """The overlays that show something in a level."""
    return tuple(name for name in NAMES if name != ZONES or level.zones)


# Sizes [pixels at scale 1]: of dots, normals, the arrow and the bar that stand for the scale, what surrounds them.
DOT, NORMAL, HEAD, HALO = 2.4, 15.0, 6.5, 1.3
ARROW, LONGEST_ARROW = 40.0, 120.0
BAR, WIDEST_BAR = 8.0, 16.0
THINNEST_BAR = 0.8
# Dots, marks of contacts and bars are at most these parts of the distance between particles, or of a spring.
DOT_PART, POINT_PART, NORMAL_PART, BAR_PART = 0.19, 0.2, 0.9, 0.2
POINT = 3.0
# Of arrows and contact points nearer to each other than this [pixels at scale 1] one is drawn.
CELL = 11.0
# Of springs no more are drawn as bars with a rim, and of particles as dots: those beyond are plain.
MOST = 6_000
# A scale stays until what it shows is this many times as large, or as small: arrows that grow must grow on the screen.
TOO_LARGE, TOO_SMALL = 2.0, 0.25
# No scale is finer [m/s, N]: mere rounding, which is left of what rests, would fill the screen with arrows.
LEAST_SPEED, LEAST_FORCE = 0.01, 1e-6
# The dashes of springs past the limit of stability.
DASHES = 5


@dataclass
class Scale:
    """The value of the legend's arrow or bar: 1, 2 or 5 times a power of ten, `least` at least; 0 = unknown."""

    value: float = 0.0
    least: float = 0.0

    def follow(self, sizes: Floats) -> float:
        """Fit the value to the sizes that are shown now, and give it."""
        known = sizes[np.isfinite(sizes) & (sizes > 0.0)]
        if len(known):
            typical = max(float(np.quantile(known, 0.9)), self.least)
            if not TOO_SMALL <= typical / max(self.value, 1e-300) <= TOO_LARGE:
                power = 10.0 ** math.floor(math.log10(typical))
                self.value = next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= typical * 0.999)
        return self.value or 1.0


@dataclass
class Overlays:
    """Which overlays are on, and the scales of their arrows."""

    shown: set[str] = field(default_factory=set)
    velocity: Scale = field(default_factory=lambda: Scale(least=LEAST_SPEED))
    contact: Scale = field(default_factory=lambda: Scale(least=LEAST_FORCE))
    spring: Scale = field(default_factory=lambda: Scale(least=LEAST_FORCE))

    def mark(
        self, marks: MarkList, frame: Frame, state: Snapshot, camera: Camera, particles: Mask, springs: Mask,
        stability: Floats | None,
    ) -> None:  # fmt: skip
        """Draw what is shown of a state; particles (n,) and springs (m,) that are there.

        stability (m,): see stability_shares; None = not known.
        """
        pen = _RimPen(marks, frame)
        if "stability" in self.shown and stability is not None:
            self._mark_stability(pen, np.flatnonzero(springs & (np.arange(len(springs)) < len(stability))), stability)
        if "forces" in self.shown:
            self._mark_spring_forces(pen, state, np.flatnonzero(springs))
        if "particles" in self.shown:
            self._mark_particles(pen, state, particles)
        if self.shown & {"contacts", "forces"}:
            self._mark_contacts(pen, state, camera)
        if "velocities" in self.shown:
            self._mark_velocities(pen, state, particles)

    def _mark_particles(self, pen: "_RimPen", state: Snapshot, particles: Mask) -> None:
        slots = pen.seen(np.flatnonzero(particles))
        frame, theme = pen.frame, pen.frame.theme
        at, held = frame.at[slots], state.inverse_mass[slots] == 0.0
        ring = np.clip(state.radius[slots] * frame.zoom, 0.0, 400.0)
        large = ring > 2.0 * DOT * frame.scale
        if len(slots) <= MOST:
            pen.marks.discs(at[large], ring[large], packed(theme.card), 0.35)
        size = np.where(held, 1.5, 1.0) * np.clip(DOT_PART * pen.spacing[slots], 0.8, DOT * frame.scale)
        pen.discs(at, size, np.where(held, packed(theme.accent), packed(theme.text)), rim=len(slots) <= MOST)
        # What is held has a cross as well: colour is not all that tells it.
        arm = 2.0 * DOT * frame.scale
        for dx, dy in ((arm, 0.0), (0.0, arm)):
            ends = np.concatenate([at[held] - (dx, dy), at[held] + (dx, dy)], axis=1)
            pen.strokes(ends, 0.7 * frame.scale, packed(theme.accent))

    def _mark_contacts(self, pen: "_RimPen", state: Snapshot, camera: Camera) -> None:
        frame, theme = pen.frame, pen.frame.theme
        found = contact_points(state)
        size = np.sqrt(np.sum(found.force * found.force, axis=1))
        # The points follow their particles between two ticks.
        at = camera.project(found.point) + frame.at[found.particle] - camera.project(state.position[found.particle])
        chosen = pen.apart(at, size)
        at, size, normal, force = at[chosen], size[chosen], found.normal[chosen], found.force[chosen]
        spacing = pen.spacing[found.particle[chosen]]
        pushing = size > 0.0
        if "contacts" in self.shown:
            length = np.minimum(NORMAL_PART * spacing, NORMAL * frame.scale)[:, None] * np.array([1.0, -1.0])
            radius = np.clip(POINT_PART * spacing, 1.2, POINT * frame.scale)
            pen.strokes(np.concatenate([at, at + length * normal], axis=1), 0.28 * radius, packed(theme.contact))
            pen.discs(at, radius, packed(theme.contact))
            pen.marks.discs(at[~pushing], 0.55 * radius[~pushing], packed(theme.card))
        if "forces" in self.shown:
            full = self.contact.follow(size)
            pen.arrows(at[pushing], force[pushing] / full, packed(theme.force), closed=True)

    def _mark_velocities(self, pen: "_RimPen", state: Snapshot, particles: Mask) -> None:
        slots = pen.seen(np.flatnonzero(particles))
        velocity = state.velocity[slots]
        speed = np.sqrt(np.sum(velocity * velocity, axis=1))
        full = self.velocity.follow(speed)
        chosen = pen.apart(pen.frame.at[slots], speed)
        chosen = chosen[speed[chosen] > 0.02 * full]
        pen.arrows(pen.frame.at[slots[chosen]], velocity[chosen] / full, packed(pen.frame.theme.velocity))

    def _mark_spring_forces(self, pen: "_RimPen", state: Snapshot, springs: Slots) -> None:
        frame, theme = pen.frame, pen.frame.theme
        force = np.nan_to_num(spring_forces(state)[springs], nan=0.0, posinf=1e300, neginf=-1e300)
        full = self.spring.follow(np.abs(force))
        ends = frame.ends(_pairs(state, springs))
        length = np.nan_to_num(np.hypot(ends[:, 2] - ends[:, 0], ends[:, 3] - ends[:, 1]))
        wide = np.minimum(np.minimum(BAR * np.abs(force) / full, WIDEST_BAR) * frame.scale, BAR_PART * length)
        half = 0.5 * wide
        order = np.argsort(half, kind="stable")
        order = order[half[order] >= 0.5 * THINNEST_BAR * frame.scale]
        half, pulls, ends = half[order], force[order] > 0.0, ends[order]
        squeezed, _, stretched = theme.strain
        pen.strokes(ends, half, np.where(pulls, packed(stretched), packed(squeezed)))
        # What pushes is hollow: colour is not all that tells it.
        hollow = ~pulls & (half > 1.2 * frame.scale)
        pen.marks.strokes(ends[hollow], 0.45 * half[hollow], packed(theme.card))

    def _mark_stability(self, pen: "_RimPen", springs: Slots, shares: Floats) -> None:
        frame = pen.frame
        order = springs[np.argsort(shares[springs], kind="stable")]
        ends, ratios = frame.ends(_pairs(frame.state, order)), shares[order]
        half = (0.7 + 1.3 * np.clip(ratios, 0.0, 1.0)) * frame.scale
        tones = stability_tones(ratios, frame.theme)
        past = ratios > 1.0
        pen.strokes(ends[~past], half[~past], tones[~past])
        pen.marks.strokes(ends[past], half[past] + HALO * frame.scale, packed(frame.theme.card))
        for k in range(0, DASHES, 2):
            pen.marks.strokes(part_of(ends[past], k / DASHES, (k + 1) / DASHES), half[past], tones[past])


class _RimPen:
    """Draws on marks with a rim in the colour of a card, so that it is seen on whatever lies below."""

    def __init__(self, marks: MarkList, frame: Frame) -> None:
        self.marks, self.frame = marks, frame
        self._rim = packed(frame.theme.card)
        # How far apart particles (n,) are [pixels]: discs by their radius, those of bodies by a usual spring.
        state = frame.state
        usual = float(np.median(state.rest_length[state.spring_active])) if state.spring_active.any() else 1.0
        by_radius = np.where(state.radius > 0.4 * usual, 2.0 * state.radius, usual)
        self.spacing = np.minimum(by_radius, usual if state.spring_active.any() else np.inf) * frame.zoom

    def seen(self, slots: Slots) -> Slots:
        """Which particles lie at a finite place."""
        return slots[np.isfinite(self.frame.at[slots]).all(axis=1)]

    def apart(self, at: Floats, size: Floats) -> Slots:
        """Indices of places (k, 2) [pixels]: in each cell of a grid that of the largest size (k,)."""
        finite = np.flatnonzero((np.abs(at) < 1e6).all(axis=1))
        order = finite[np.argsort(-size[finite], kind="stable")]
        cells = np.floor(at[order] / (CELL * self.frame.scale)).astype(np.int64)
        _, first = np.unique(cells[:, 0] * 4_000_003 + cells[:, 1], return_index=True)
        return order[np.sort(first)]

    def strokes(self, ends: Floats, half: ArrayLike, colour: ArrayLike) -> None:
        """Lines (k, 4)."""
        if len(ends) <= MOST:
            self.marks.strokes(ends, np.add(half, HALO * self.frame.scale), self._rim, 0.75)
        self.marks.strokes(ends, half, colour)

    def discs(self, at: Floats, radius: ArrayLike, colour: ArrayLike, rim: bool = True) -> None:
        """Draw discs at (k, 2)."""
        if rim:
            self.marks.discs(at, np.add(radius, HALO * self.frame.scale), self._rim, 0.85)
        self.marks.discs(at, radius, colour)

    def arrows(self, at: Floats, way: Floats, colour: int, closed: bool = False) -> None:
        """Draw arrows from (k, 2) [pixels] along ways (k, 2), y up, of which 1 is as long as the legend's."""
        k = self.frame.scale
        ways = np.nan_to_num(way * np.array([1.0, -1.0]), posinf=1e9, neginf=-1e9) * ARROW * k
        length = np.sqrt(np.sum(ways * ways, axis=1))
        shown = length > 1.5 * k
        at, ways, length = at[shown], ways[shown], length[shown]
        ways = ways * np.minimum(1.0, LONGEST_ARROW * k / length)[:, None]
        length = np.minimum(length, LONGEST_ARROW * k)
        tip = at + ways
        along = ways / length[:, None]
        across = np.stack([-along[:, 1], along[:, 0]], axis=1)
        head = np.minimum(HEAD * k, 0.6 * length)[:, None]
        back = tip - head * along
        sides = [back + side * 0.5 * head * across for side in (-1.0, 1.0)]
        lines = [np.concatenate([at, tip], axis=1)] + [np.concatenate([side, tip], axis=1) for side in sides]
        if closed:
            lines.append(np.concatenate(sides, axis=1))
        ends = np.concatenate(lines)
        self.strokes(ends, 0.95 * k, colour)


def _pairs(state: Seen, springs: Slots) -> Slots:
    return np.stack([state.particle_a[springs], state.particle_b[springs]], axis=1).astype(np.int64)


def part_of(ends: Floats, first: float, last: float) -> Floats:
    """The part of lines (k, 4) from one share of their length to another."""
    way = ends[:, 2:] - ends[:, :2]
    return np.concatenate([ends[:, :2] + first * way, ends[:, :2] + last * way], axis=1)


def stability_tones(ratios: Floats, theme: Theme) -> NDArray[np.int64]:
    """Colours (m,) of shares of what is proven stable: from grey to that of what is stretched, and one for beyond 1."""
    rest, near = theme.strain[1], theme.strain[2]
    place = np.clip(np.nan_to_num(ratios, nan=9.0), 0.0, 1.0)
    red, green, blue = (np.interp(place, (0.0, 1.0), (rest[k], near[k])).astype(np.int64) for k in range(3))
    return np.where(ratios > 1.0, packed(theme.past), red << 16 | green << 8 | blue)


# Sizes [pixels at scale 1]: half width of a dash and of what surrounds it, length of a dash and of the gap behind it.
_ZONE_HALF, _ZONE_HALO, _DASH, _SPACE = 0.9, 1.2, 8.0, 5.0
# Of an outline at most so many dashes, longer ones where it is long.
_MOST_DASHES = 400


def name_place(zone: ZoneDef) -> tuple[float, float]:
    """Where the name of a zone stands [m]: at the middle of its top."""
    corners = zone_outline(zone)
    return float(corners[:, 0].min() + corners[:, 0].max()) / 2, float(corners[:, 1].max())


def mark_zones(marks: MarkList, zones: Sequence[ZoneDef], camera: Camera, theme: Theme, scale: float) -> None:
    """Draw the outlines of zones; scale: pixels per layout unit."""
    dashes = [_dashes(camera.project(zone_outline(zone)), scale) for zone in zones]
    if dashes:
        ends = np.concatenate(dashes)
        marks.strokes(ends, (_ZONE_HALF + _ZONE_HALO) * scale, packed(theme.card), 0.6)
        marks.strokes(ends, _ZONE_HALF * scale, packed(theme.accent))


def _dashes(corners: Floats, scale: float) -> Floats:
    """Dashes (m, 4) [pixels] along the closed line through corners (k, 2) [pixels]."""
    closed = np.concatenate([corners, corners[:1]])
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    count = min(max(int(along[-1] / ((_DASH + _SPACE) * scale)), 4), _MOST_DASHES)
    first = np.arange(count) * along[-1] / count
    last = first + _DASH / (_DASH + _SPACE) * along[-1] / count
    points = [np.interp(place, along, closed[:, axis]) for place in (first, last) for axis in range(2)]
    return np.ascontiguousarray(np.stack(points, axis=1))


# The colour goes with the logarithm of the strain: from this strain on it shows, at FULL_STRAIN it is at its end.
# Larger: the load in stiff bodies stays grey.
SLIGHT_STRAIN = 0.004
FULL_STRAIN = 1.0

# Where a theme's colours are at their end, on that scale.
_FULL_PLACE = 0.62


def strain_place(strain: NDArray[np.float64]) -> NDArray[np.float64]:
    """Places (m,) of signed strains on the scale, -1..1 up to FULL_STRAIN."""
    finite = np.nan_to_num(strain, nan=0.0, posinf=1e9, neginf=-1e9)
    place = np.sign(finite) * np.log1p(np.abs(finite) / SLIGHT_STRAIN) / np.log1p(FULL_STRAIN / SLIGHT_STRAIN)
    return np.asarray(np.clip(place, -1.0, 1.0))


def strain_tones(strain: NDArray[np.float64], colours: tuple[Colour, Colour, Colour]) -> NDArray[np.int64]:
    """Colours (m,) of signed strains between those of a theme: squeezed, at rest, stretched."""
    place, stops = strain_place(strain), (-_FULL_PLACE, 0.0, _FULL_PLACE)
    red, green, blue = (np.interp(place, stops, [colour[k] for colour in colours]).astype(np.int64) for k in range(3))
    return np.asarray(red << 16 | green << 8 | blue)
