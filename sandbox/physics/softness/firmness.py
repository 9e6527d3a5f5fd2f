"""Firmness of bodies, for who sets it: which bodies have one, what of it is in reach, and setting it.

It is asked for as a sag, or a frequency and damping ratio. What sags so far where it stands, standing.py says, and
kernels/reach.py what Cs and Cd that is.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.physics.arena import FIRST_ARENA, MORE, answer_of
from sandbox.physics.commands import command_table
from sandbox.physics.commands.command import BEYOND_REACH, FLAT, NO_FIRMNESS, count_pieces
from sandbox.physics.equation import frequency_from_coefficients
from sandbox.physics.keeping import arguments
from sandbox.physics.keeping.equipment import FirmBody, Firmness, StiffForm, design_gravity
from sandbox.physics.softness.kernels.lowest_mode import NO_MODE, find_lowest_mode
from sandbox.physics.softness.kernels.reach import (
    BY_FREQUENCY,
    BY_PAIR,
    BY_SAG,
    BY_WOBBLE,
    FIRMED,
    NO_HEIGHT,
    OUT_OF_REACH,
    STANDING,
    coefficients_within,
    sag_of,
)
from sandbox.physics.softness.standing import StandingForm
from sandbox.physics.world import World

# Sags by their words, from soft to hard.
WORDS = {"jelly": 0.25, "soft": 0.1, "firm": 0.02, "hard": 0.003, "rigid": 0.0}
# What is said after a nearest sag that is above 0.
BUT_RIGID = ", but for 0, which is rigid"
# Particles of the largest body whose firmness panels read where nothing has asked for it; it takes some 0.2 s.
LARGEST_READ = 2_000
# Frequencies [Hz] and the highest damping ratio that a wobble may have, and digits of both, where they are worked out.
FREQUENCIES, MOST_RATIO, WOBBLE_DIGITS = (0.01, 1_000.0), 1.0, 6
# Forms whose lowest mode is kept; those of a level, edited one by one, need no more.
KEPT = 256
# Forms whose sags are kept, each with a run that may go on.
KEPT_FORMS = 64

_REASONS = {NO_HEIGHT: FLAT, OUT_OF_REACH: BEYOND_REACH}
_kept: dict[bytes, float] = {}
_standing: dict[tuple[bytes, tuple[float, float]], StandingForm] = {}


class OutOfReach(ValueError):
    """No Cs and Cd give that firmness; nearest: the nearest that some give. Its text is one line for a person."""

    def __init__(self, text: str, nearest: Firmness | None) -> None:
        super().__init__(text)
        self.nearest = nearest


@dataclass(frozen=True)
class FirmnessRange:
    """The range of firmness of a body whose form has this lowest mode, and this height [m] that it sags by.

    Under gravity [m/s^2], and in ticks of h [s]. form: what says how far it sags; None: it does as a square.
    """

    lowest_mode: float
    height: float
    gravity: float
    h: float
    form: StandingForm | None = None

    @classmethod
    def of(cls, shape: StiffForm, gravity: tuple[float, float], tick_rate: float) -> "FirmnessRange":
        """The firmness that a form can have."""
        form = standing_form(shape, gravity)
        return cls(lowest_mode_of(shape), form.length, design_gravity(*gravity), 1.0 / tick_rate, form)

    def coefficients(self, firmness: Firmness) -> tuple[float, float]:
        """Cs and Cd of the body as a whole. Raises OutOfReach."""
        if not self.lowest_mode > 0.0:
            raise _out_of_reach(NO_FIRMNESS, firmness, (), 1.0 / self.h)
        found, gravity = np.zeros(2), self.gravity
        if firmness.sag and self.form is not None:
            # The kernel is told of a square that sags so far under as much more gravity.
            gravity *= self.form.constant(firmness.sag) / STANDING
        code = coefficients_within(self.lowest_mode, self.height, gravity, self.h, *_asked(firmness), found)
        if code != FIRMED:
            raise _out_of_reach(_REASONS[code], firmness, found.tolist(), 1.0 / self.h)
        return float(found[0]), float(found[1])

    def nearest(self, firmness: Firmness) -> Firmness:
        """The firmness itself, or the nearest one in reach. Raises OutOfReach where none is."""
        try:
            self.coefficients(firmness)
        except OutOfReach as error:
            if error.nearest is None:
                raise
            # What sags otherwise may be in reach otherwise.
            return self.nearest(error.nearest)
        return firmness

    def as_wobble(self, firmness: Firmness) -> Firmness:
        """A firmness as commands have it: what sags by the numbers of its wobble. Raises OutOfReach."""
        return self.wobble_of(*self.coefficients(firmness)) if firmness.sag else firmness

    def wobble_of(self, stiffness: float, damping: float) -> Firmness:
        """The firmness, by its wobble, that is nearest to these Cs and Cd of a body as a whole."""
        hz, ratio = frequency_from_coefficients(stiffness, damping, self.h)
        hz, ratio = (float(f"{value:.{WOBBLE_DIGITS}g}") for value in (min(hz, FREQUENCIES[1]), min(ratio, MOST_RATIO)))
        return self.nearest(Firmness(hz=hz, ratio=ratio))

    def reading(self, stiffness: float, damping: float) -> tuple[float, float, float]:
        """Sag, frequency [Hz] and damping ratio of a body of these Cs and Cd as a whole."""
        return self.sag_of(stiffness, damping), *frequency_from_coefficients(stiffness, damping, self.h)

    def sag_of(self, stiffness: float, damping: float) -> float:
        """The sag of a body of these Cs and Cd as a whole; inf where Cs is 0."""
        sag = sag_of(self.height, self.gravity, self.h, stiffness, damping)
        return sag if self.form is None else float(self.form.sags(np.array([sag / STANDING]))[0])


def standing_form(shape: StiffForm, gravity: tuple[float, float]) -> StandingForm:
    """What a form sags by where it stands under gravity [m/s^2] of this direction; kept, as its lowest mode is."""
    strength = design_gravity(*gravity)
    key = _key_of(shape), (gravity[0] / strength, gravity[1] / strength)
    if key not in _standing:
        while len(_standing) >= KEPT_FORMS:
            del _standing[next(iter(_standing))]
        _standing[key] = StandingForm(shape, gravity, lowest_mode_of(shape))
    return _standing[key]


def lowest_mode_of(shape: StiffForm) -> float:
    """The lowest eigenvalue of a form, without unit; 0 where it is not stiff without pins."""
    key = _key_of(shape)
    if key not in _kept:
        while len(_kept) >= KEPT:
            del _kept[next(iter(_kept))]
        arrays: list[Any] = [np.ascontiguousarray(rows) for rows in shape]
        form, arena = StiffForm(*arrays), np.zeros(FIRST_ARENA, np.int64)
        while (found := find_lowest_mode(form, arena)) == NO_MODE:
            arena = np.zeros(MORE * int(arena[0]), np.int64)
        _kept[key] = found
    return _kept[key]


def _key_of(shape: StiffForm) -> bytes:
    digest = hashlib.blake2b(digest_size=16)
    for array in shape:
        digest.update(f"{array.shape}".encode() + array.tobytes())
    return digest.digest()


def _asked(firmness: Firmness) -> tuple[int, float, float]:
    if firmness.sag is not None:
        return BY_SAG, firmness.sag, 0.0
    assert firmness.hz is not None
    return (BY_FREQUENCY, firmness.hz, 0.0) if firmness.ratio is None else (BY_WOBBLE, firmness.hz, firmness.ratio)


def words_of_reach(asked: Firmness, nearest: Sequence[float], tick_rate: float) -> tuple[tuple[str, ...], Firmness]:
    """What is asked for out of reach, at which rate, the nearest and what is said after it; and the nearest.

    nearest (2,): a sag, or frequency [Hz] and damping ratio.
    """
    found = Firmness(hz=nearest[0], ratio=nearest[1]) if asked.sag is None else Firmness(sag=nearest[0])
    return (str(asked), f"{tick_rate:g}", str(found), BUT_RIGID if found.sag else ""), found


def _out_of_reach(reason: int, asked: Firmness, nearest: Sequence[float], tick_rate: float) -> OutOfReach:
    text = command_table.WORDS[reason].removeprefix("{}: ")
    if reason != BEYOND_REACH:
        return OutOfReach(text, None)
    words, found = words_of_reach(asked, nearest, tick_rate)
    return OutOfReach(text.format(*words), found)


def give_firmness(
    world: World, body: int, firmness: Firmness, gravity: tuple[float, float], duration: int = 0
) -> None:  # fmt: skip
    """Give all of a body, by its place among `World.forms`, a firmness under gravity [m/s^2], in so many ticks.

    Raises OutOfReach.
    """
    asked = softening(world, body, firmness, gravity)
    world.command("soften", **asked, duration=duration)


def softening(world: World, body: int, firmness: Firmness, gravity: tuple[float, float]) -> dict[str, Any]:
    """What `soften` takes for that, but for its duration. Raises OutOfReach."""
    reach = FirmnessRange.of(world.forms[body].shape, gravity, world.settings.tick_rate)
    stiffness, damping = reach.coefficients(firmness)
    return {
        "body": body, "whole": True, "way": BY_PAIR, "value": stiffness, "second": damping, "gravity": (0.0, 0.0),
    }  # fmt: skip


def set_firmness(world: World, body: int, stiffness: float, damping: float, duration: int = 0) -> None:
    """Give a body, by its place among `firm_bodies`, Cs and Cd as a whole: those of its slowest wobble, Cs <= Cd.

    They are shared out over its springs, areas and bends, in force in so many ticks (ramps.py); 0: at once.
    Raises IndexError, ValueError, and RefusedCommand where its form is not stiff without pins.
    """
    stiffness = arguments.number("stiffness", stiffness, 0.0, 1.0)
    damping = arguments.number("damping", damping, 0.0, 1.0)
    world.command(
        "soften", body=body, whole=False, way=BY_PAIR, value=stiffness, second=damping, gravity=(0.0, 0.0),
        duration=duration,
    )  # fmt: skip


def firm_bodies(world: World) -> tuple[FirmBody, ...]:
    """The bodies of `World.forms` as they are now, by the numbers of firm.py: of one that was cut its pieces,
    "cube, 1 of 2".
    """
    found: tuple[FirmBody, ...] = world.derived(_find_bodies, of_hands=False)
    return found


def _find_bodies(world: World) -> tuple[FirmBody, ...]:
    counts = np.zeros(len(world.forms), np.int64)
    answer_of(count_pieces, FIRST_ARENA, world.lent, counts)
    pieces = [
        (body,) if count == 1 else tuple(_piece(world, number, place, count) for place in range(count))
        for number, (body, count) in enumerate(zip(world.forms, counts.tolist(), strict=True))
    ]
    return (*(each[0] for each in pieces), *(piece for each in pieces for piece in each[1:]))


def _piece(world: World, number: int, place: int, count: int) -> FirmBody:
    piece = world.form_table.piece(world, number, place)
    shape: list[Any] = [np.array(rows) for rows in piece.form]
    name = f"{world.forms[number].name}, {place + 1} of {count}"
    return FirmBody(name, StiffForm(*shape), np.array(piece.spring), np.array(piece.constraint))
