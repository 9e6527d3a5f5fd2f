"""SoftnessReading: how soft bodies of a run are, in words and figures, which play and the editor say alike."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.app.base.sag_map import Pairs, subject_words, word_pairs
from sandbox.app.panel.readings import motion_words, per_cent, sag_words
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.field import DASH, MIXED
from sandbox.editor.panel.material_properties import Swing
from sandbox.editor.panel.property import MIXED as MIXED_VALUE
from sandbox.editor.panel.property import same
from sandbox.level.format.quantities import significant
from sandbox.physics import jit
from sandbox.physics.analysis.stability import BOUND, spring_loads
from sandbox.physics.arrays import Floats
from sandbox.physics.softness.body_motion import (
    BodyMotion,
    SagCurve,
    SpringMotion,
    common_pair,
    present_coefficients,
    read_body,
    word_for,
)
from sandbox.physics.softness.sag_meter import MeasuredBody, SagMeter, SagMeters, measured_bodies
from sandbox.physics.solvers import SOLVERS

ALL_BODIES = "All bodies"
TOO_STIFF = "Too stiff for the single pass: it melts or explodes."
MEASURING = "Measuring how far it sags ..."
# Particles of the largest body whose sags, where it stands, are worked out within a frame.
PROMPT = 300
# Significant digits of a sag, and of a wobble.
DIGITS, SWING_DIGITS = 2, 3


class Reading(NamedTuple):
    """The softness of a body: its sag, None: not measured yet, NaN: it cannot be; its wobble, None: it has none."""

    subject: MeasuredBody
    sag: float | None
    motion: SpringMotion | None
    is_rigid: bool


class Said(NamedTuple):
    """The words for bodies: one word, "" where none fits all, their sag [%] as a text, a sentence."""

    word: str
    sag: str
    text: str


class SoftnessReading:
    """Measures the bodies of a run, or the one that is chosen, a little at a time."""

    def __init__(self, playback: Playback) -> None:
        self.playback = playback
        self.body = ALL_BODIES
        # Whether it says how bodies swing, too.
        self.tells_motion = True
        # Frequency [Hz] and damping ratio of the chosen bodies' slowest wobble.
        self.swing: Swing = (None, None)
        self._read_of: tuple[object, ...] = ()
        self._meters = SagMeters()
        self._seen: dict[str, object] = {}
        self._text_read = ""
        self._find_bodies()

    @property
    def is_measuring(self) -> bool:
        """Whether runs still tell of the bodies."""
        return bool(self._meters.busy)

    def read(self, seconds: float, look: bool) -> Said | None:
        """The words for the chosen bodies after so much work; None: the same as before.

        look: also where no command of the person's has changed them.
        """
        news = self._meters.advance(seconds)
        key = (self.playback.revision, self.body, jit.COMPILED)
        if key == self._read_of and not look and not news:
            return None
        self._read_of = key
        present = present_coefficients(self.playback.session.world)
        found = [self._reading(subject, present) for subject in self._chosen()]
        readings = [reading for reading in found if reading is not None]
        sags = [reading.sag for reading in readings if reading.sag is not None and math.isfinite(reading.sag)]
        whole = len(readings) == len(found) and len(sags) == len(readings) and bool(found)
        motions = [reading.motion for reading in readings if reading.motion is not None]
        pairs = [[significant(value, SWING_DIGITS) for value in (each.hz, each.ratio)] for each in motions]
        if len(motions) == len(found) and pairs:
            self.swing = same(pair[0] for pair in pairs), same(pair[1] for pair in pairs)
        else:
            self.swing = (MIXED_VALUE, MIXED_VALUE) if pairs else (None, None)
        words = {word_for(each.sag, each.is_rigid) for each in readings if each.sag is not None}
        explodes = self._may_explode()
        self._text_read = TOO_STIFF if explodes else self._text(readings, sags, whole)
        word = words.pop() if whole and len(words) == 1 and not explodes else ""
        texts = {per_cent(sag, DIGITS).removesuffix(" %") for sag in sags}
        return Said(word, (texts.pop() if whole and len(texts) == 1 else MIXED) if texts else DASH, self._text_read)

    def _is_waited_for(self) -> bool:
        return not self._read_of or self._text_read == MEASURING

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies whose firmness can be set here."""
        return list(self._subjects)

    def _find_bodies(self) -> None:
        self._subjects = measured_bodies(self.playback.session.world)
        if self.body not in self._subjects:
            self.body = ALL_BODIES

    def _chosen(self) -> list[MeasuredBody]:
        return list(self._subjects.values()) if self.body == ALL_BODIES else [self._subjects[self.body]]

    def material_of(self, name: str) -> int | None:
        """The material (index) of a body's springs; None: of all bodies, or of none that is known."""
        subject = self._subjects.get(name)
        return None if subject is None else int(self.playback.session.world.material[subject.body.springs[0]])

    def body_at(self, particle: int) -> str | None:
        """The name of the body of which a particle is; None: of none that is offered."""
        world = self.playback.session.world
        for name, subject in self._subjects.items():
            springs = subject.body.springs
            if particle in world.particle_a[springs] or particle in world.particle_b[springs]:
                return name
        return None

    def springs_of(self, name: str) -> NDArray[np.bool_]:
        """The springs (m,) of a body, or of all."""
        chosen = np.zeros(self.playback.session.world.spring_count, np.bool_)
        for subject in self._subjects.values() if name == ALL_BODIES else [self._subjects[name]]:
            chosen[subject.body.springs] = True
        return chosen

    def body_of(self, material: int | None) -> str | None:
        """The body that stands for a material: the chosen one, else the largest of the material."""
        if self.body in self._subjects and material in (None, self.material_of(self.body)):
            return self.body
        names = [name for name in self._subjects if material in (None, self.material_of(name))]
        return max(names, key=lambda name: len(self._subjects[name].body.springs), default=None)

    def curve_of(self, material: int | None) -> SagCurve | None:
        """How a body sags at every firmness, as far as runs have told by now; what is missing is asked for."""
        name = self.body_of(material)
        meter = None if name is None else self._meter(self._subjects[name])
        if meter is None:
            return None
        meter.trace()
        return meter.curve

    def motion_of(self, name: str) -> BodyMotion | None:
        """How a body sags and wobbles by its Cs and Cd, as far as runs have told by now; None: not known."""
        world, subject = self.playback.session.world, self._subjects[name]
        meter = self._meter(subject)
        curve = None if meter is None else meter.curve
        if curve is None and (subject.slot is None or len(subject.body.shape.mass) > PROMPT):
            return None
        # A net moves as its springs do.
        motion = BodyMotion.of(subject.body.shape, world.settings, subject.lowest_mode or 1.0)
        return replace(motion, curve=curve)

    def word_pairs(self, name: str, body: BodyMotion) -> Pairs:
        """Cs and Cd of each word for a body, where runs have told."""
        meter = self._meter(self._subjects[name])
        return {} if meter is None or meter.curve is None else word_pairs(meter, body)

    def word_of(self, material: int | None) -> str:
        """The word for the body that stands for a material, as the row has it; "" where its sag is not known."""
        name = self.body_of(material)
        if name is None:
            return ""
        found = self._reading(self._subjects[name], present_coefficients(self.playback.session.world))
        if found is None or found.sag is None or math.isnan(found.sag):
            return ""
        return word_for(found.sag, found.is_rigid)

    def subject_of(self, name: str) -> str:
        """The part of a body that the words are about, as a sentence has it: "the girder's end"."""
        return subject_words(name, self._meters.of(self.playback.session.world, self._subjects[name]).body.support)

    def _may_explode(self) -> bool:
        """Whether springs of a chosen body are past what a single pass is proven to bear."""
        world = self.playback.session.world
        if not SOLVERS[world.settings.solver].proven_limit:
            return False
        loads = spring_loads(world)
        return any(bool(np.any(loads[subject.body.springs] >= BOUND)) for subject in self._chosen())

    def _text(self, readings: list[Reading], sags: list[float], whole: bool) -> str:
        if not self._chosen():
            return "There is no body here whose firmness can be set."
        if not readings:
            return "The springs of a body differ in Cs or Cd."
        if any(reading.sag is None for reading in readings) and jit.COMPILED:
            return MEASURING
        if not sags:
            return "How far it sags cannot be measured here: it does not come to rest, or is too large."
        world = self.playback.session.world
        supports = {self._meters.of(world, reading.subject).body.support for reading in readings}
        name = readings[0].subject.name if len(readings) == 1 else None
        sag = sag_words(min(sags), max(sags), name, supports)
        found = (reading.motion for reading in readings if reading.motion is not None)
        motions = {motion_words(motion) for motion in found} if self.tells_motion else set()
        return f"{sag}; {motions.pop()}." if whole and len(motions) == 1 else f"{sag}."

    def _meter(self, subject: MeasuredBody) -> SagMeter | None:
        """The meter of a body; None while kernels are interpreted, which takes too long."""
        return self._meters.of(self.playback.session.world, subject) if jit.COMPILED else None

    def _reading(self, subject: MeasuredBody, present: tuple[Floats, Floats]) -> Reading | None:
        """The reading of a body that the rows show; None where its springs differ."""
        world = self.playback.session.world
        pair, meter = common_pair(world, subject.body), self._meter(subject)
        if pair is None:
            return None
        found = None if subject.slot is None else read_body(world, subject.body, subject.lowest_mode, present)
        motion = None if found is None else found.motion
        is_rigid = pair[:2] == (1.0, 1.0)
        if meter is None:
            return Reading(subject, None if found is None else found.sag, motion, is_rigid)
        # What changes from tick to tick is not measured again each time.
        is_steady, self._seen[subject.name] = self._seen.get(subject.name) in (None, pair), pair
        sag = meter.sag_known(pair)
        if sag is None and is_steady:
            sag = meter.sag(pair)
        if sag is None:
            sag = meter.estimate(pair)
        return Reading(subject, sag, motion, is_rigid)
