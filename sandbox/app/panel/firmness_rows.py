"""Rows of the panel that say how soft bodies are as a whole, in words and numbers, and change it."""

import math
from collections.abc import Callable
from dataclasses import asdict, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.app.base.sag_map import Pairs, subject_words, word_pairs
from sandbox.app.base.sentences import capitalised
from sandbox.app.panel.readings import motion_words, per_cent, sag_words
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.button import Choice
from sandbox.app.widgets.field import DASH, MIXED, Field, typed_number
from sandbox.app.widgets.picker import WordPicker
from sandbox.app.widgets.texts import TextBlock
from sandbox.editor.document import EditError
from sandbox.editor.panel.field_info import FieldInfo
from sandbox.editor.panel.material_properties import NO_FREQUENCY, Swing
from sandbox.editor.panel.property import MIXED as MIXED_VALUE
from sandbox.editor.panel.property import Property, in_range, same
from sandbox.level.format.limits import FREQUENCY_RANGE, RATIO_LIMIT, SAG_LIMIT
from sandbox.level.format.quantities import significant
from sandbox.physics import jit
from sandbox.physics.analysis.stability import BOUND, spring_loads
from sandbox.physics.arrays import Floats
from sandbox.physics.keeping.equipment import Firmness
from sandbox.physics.softness.body_motion import (
    BodyMotion,
    SagCurve,
    SpringMotion,
    common_pair,
    present_coefficients,
    read_body,
    word_for,
)
from sandbox.physics.softness.firmness import WORDS, FirmnessRange, OutOfReach
from sandbox.physics.softness.sag_meter import MeasuredBody, SagMeter, SagMeters, measured_bodies
from sandbox.physics.solvers import SOLVERS
from sandbox.session.commands import SetCoefficients, SetFirmness

ALL_BODIES = "All bodies"
# Seconds of work on what is measured: in a frame; in one while somebody waits for it; and at once.
WORK, HASTE, AT_ONCE = 0.006, 0.02, 0.1
# What is reached of an asked sag within this share is as asked.
AS_ASKED = 0.1
# What is so many times as much or as little as asked is not set in its place.
FAR = 10.0
TOO_STIFF = "Too stiff for the single pass: it melts or explodes."
# Significant digits of a sag.
DIGITS = 2


# Of a wobble.
SWING_DIGITS = 3
_WOBBLE = FieldInfo(
    "number", "Wobble", "Hz", *FREQUENCY_RANGE, tooltip="Swings a second of the body's slowest wobble, undamped."
)
_RATIO = FieldInfo(
    "number", "Damping ratio", low=0.0, high=RATIO_LIMIT, tooltip="Below 1 the body swings, above 1 it creeps back."
)


class Reading(NamedTuple):
    """What is shown of a body: its sag, None: not measured yet, NaN: it cannot be; its wobble, None: it has none."""

    subject: MeasuredBody
    sag: float | None
    motion: SpringMotion | None
    is_rigid: bool


class FirmnessRows:
    """What the rows show and do; the panel builds them, where `shown`, and `engineers`' further down.

    Bodies that are large are left to the level's field and the command.
    """

    menu: WordPicker
    words: Choice
    text: TextBlock
    sag: Field

    def __init__(self, playback: Playback, say: Callable[[str], None]) -> None:
        self.playback, self._say = playback, say
        self.body = ALL_BODIES
        self._find_bodies()
        # A panel that was laid out without bodies has no rows.
        self.shown = bool(self._subjects)
        self._shown_of: tuple[object, ...] = ()
        self._meters = SagMeters()
        # Sags that were asked for and are looked for, by the name of the body, and the gesture that asked.
        self._asked: dict[str, tuple[float, int]] = {}
        # Those of them that have about that by now.
        self._answered: set[str] = set()
        self._seen: dict[str, object] = {}
        # Frequency [Hz] and damping ratio of the chosen bodies' slowest wobble.
        self.swing: Swing = (None, None)

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies whose firmness can be set here."""
        return list(self._subjects)

    def _find_bodies(self) -> None:
        self._subjects = measured_bodies(self.playback.session.world)
        if self.body not in self._subjects:
            self.body = ALL_BODIES

    def offer_bodies(self) -> None:
        """Let the menu offer what there is at the moment: bodies join a run, and go again."""
        self._find_bodies()
        if self.shown:
            self.menu.offer([ALL_BODIES, *self.bodies], self.body)

    def speak_of(self, material: int | None) -> None:
        """Choose the one body of several that is of a material, as the level's text speaks of it, if there is one."""
        names = [name for name in self._subjects if self.material_of(name) == material]
        if len(names) == 1 < len(self._subjects):
            self.body = names[0]

    def choose_body(self, name: str) -> None:
        """Show and change that body, or all."""
        self.body = name
        self.refresh(True)

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
        if curve is None and subject.slot is None:
            return None
        # A net moves as its springs do.
        motion = BodyMotion.of(subject.body.shape, world.settings, subject.lowest_mode or 1.0)
        return replace(motion, curve=curve)

    def word_pairs(self, name: str, body: BodyMotion) -> Pairs:
        """Cs and Cd of each word for a body, where runs have told."""
        meter = self._meter(self._subjects[name])
        return {} if meter is None or meter.curve is None else word_pairs(meter, body)

    def subject_of(self, name: str) -> str:
        """The part of a body that the words are about, as a sentence has it: "the girder's end"."""
        return subject_words(name, self._meters.of(self.playback.session.world, self._subjects[name]).body.support)

    def refresh(self, look: bool) -> None:
        """Show what the bodies have now; look: also where no command of the person's has changed them."""
        if not self.shown:
            return
        if self._asked:
            self._settle(HASTE)
        news = self._meters.advance(HASTE if self._is_waited_for() else WORK)
        key = (self.playback.revision, self.body, jit.COMPILED)
        if key == self._shown_of and not look and not news:
            return
        self._shown_of = key
        present = present_coefficients(self.playback.session.world)
        found = [self._read(subject, present) for subject in self._chosen()]
        readings = [reading for reading in found if reading is not None]
        sags = [reading.sag for reading in readings if reading.sag is not None and math.isfinite(reading.sag)]
        whole = len(readings) == len(found) and len(sags) == len(readings) and bool(found)
        self.sag.show(self._one([per_cent(sag, DIGITS).removesuffix(" %") for sag in sags], whole))
        motions = [reading.motion for reading in readings if reading.motion is not None]
        whole_swing = len(motions) == len(found) and bool(found)
        pairs = [[significant(value, SWING_DIGITS) for value in (each.hz, each.ratio)] for each in motions]
        hz, ratio = (
            None if not pairs else same([pair[place] for pair in pairs]) if whole_swing else MIXED_VALUE
            for place in (0, 1)
        )
        self.swing = hz, ratio
        words = {word_for(each.sag, each.is_rigid) for each in readings if each.sag is not None}
        explodes = self._may_explode()
        self.words.show(words.pop() if whole and len(words) == 1 and not explodes else "")
        self.text.show_text(TOO_STIFF if explodes else self._text(readings, sags, whole))

    @property
    def is_measuring(self) -> bool:
        """Whether something that was asked for is not set yet, or runs still tell of the bodies."""
        return bool(self._asked or self._meters.busy)

    def _is_waited_for(self) -> bool:
        return not self._shown_of or self.text.text.startswith("Measuring")

    def _may_explode(self) -> bool:
        """Whether springs of a chosen body are past what a single pass is proven to bear."""
        world = self.playback.session.world
        if not SOLVERS[world.settings.solver].proven_limit:
            return False
        loads = spring_loads(world)
        return any(bool(np.any(loads[subject.body.springs] >= BOUND)) for subject in self._chosen())

    def _one(self, texts: list[str], whole: bool) -> str:
        return DASH if not texts else texts[0] if whole and len(set(texts)) == 1 else MIXED

    def _text(self, readings: list[Reading], sags: list[float], whole: bool) -> str:
        if not self._chosen():
            return "There is no body here whose firmness can be set."
        if not readings:
            return "The springs of a body differ in Cs or Cd."
        if any(reading.sag is None for reading in readings) and jit.COMPILED:
            return "Measuring how far it sags ..."
        if not sags:
            return "How far it sags cannot be measured here: it does not come to rest, or is too large."
        world = self.playback.session.world
        supports = {self._meters.of(world, reading.subject).body.support for reading in readings}
        name = readings[0].subject.name if len(readings) == 1 else None
        sag = sag_words(min(sags), max(sags), name, supports)
        motions = {motion_words(reading.motion) for reading in readings if reading.motion is not None}
        return f"{sag}; {motions.pop()}." if whole and len(motions) == 1 else f"{sag}."

    # Measuring.

    def _meter(self, subject: MeasuredBody) -> SagMeter | None:
        """The meter of a body; None while kernels are interpreted, which takes too long."""
        return self._meters.of(self.playback.session.world, subject) if jit.COMPILED else None

    def _read(self, subject: MeasuredBody, present: tuple[Floats, Floats]) -> Reading | None:
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

    # Changing.

    def choose_word(self, word: str) -> None:
        """Make the chosen bodies as soft as the word says."""
        self._ask(WORDS[word])

    def type_sag(self, text: str) -> bool:
        """Set the sag of the chosen bodies to a typed one [%]; whether it could be."""
        sag = typed_number(self._say, text, "Sag", 0.0, 100.0 * SAG_LIMIT, unit="%")
        return sag is not None and self._ask(sag / 100.0)

    def _ask(self, sag: float) -> bool:
        """Make the chosen bodies sag so far as runs tell, at once or as soon as it is known."""
        if not self._can_set():
            return False
        gesture = self.playback.session.new_gesture()
        self._asked = {subject.name: (sag, gesture) for subject in self._chosen()}
        self._answered = set()
        if jit.COMPILED and sag > 0.0:
            self._settle(AT_ONCE)
        else:
            for subject in self._chosen():
                self._give(subject, Firmness(sag=sag), gesture)
            self._asked = {}
        return True

    def _settle(self, seconds: float) -> None:
        """Set what is known by now of the sags that were asked for, after so much work on them."""
        self._asked = {name: asked for name, asked in self._asked.items() if name in self._subjects}
        for name, (sag, _) in self._asked.items():
            self._meters.of(self.playback.session.world, self._subjects[name]).firmness(sag)
        self._meters.advance(seconds)
        others: dict[str, list[str]] = {}
        for name, (sag, gesture) in list(self._asked.items()):
            subject = self._subjects[name]
            meter = self._meters.of(self.playback.session.world, subject)
            is_known, firmness = meter.firmness(sag)
            if not is_known:
                self._answer_first(subject, meter, sag, gesture)
                continue
            del self._asked[name]
            self._answered.discard(name)
            fault = self._take(subject, meter, sag, firmness, gesture)
            if fault:
                others.setdefault(fault, []).append(name)
        for fault, names in others.items():
            more = f" and {len(names) - 1} more" if len(names) > 1 else ""
            self._say(f"{capitalised(names[0])}{more}: {fault}")

    def _answer_first(self, subject: MeasuredBody, meter: SagMeter, sag: float, gesture: int) -> None:
        """Give a large body, once, about the firmness that is looked for, before the search has ended."""
        firmness = meter.first_answer(sag)
        if firmness is not None and subject.name not in self._answered:
            self._answered.add(subject.name)
            self._give(subject, firmness, gesture)

    def _take(self, subject: MeasuredBody, meter: SagMeter, sag: float, firmness: Firmness | None, gesture: int) -> str:
        """Give a body the firmness found for a sag; gives what to say where that is not the sag."""
        if firmness is None:
            return f"a sag of {per_cent(sag)} cannot be had or measured here. Set Cs and Cd."
        reached = meter.sag_known(meter.springs_of(firmness))
        if reached is not None and not sag / FAR <= reached <= sag * FAR:
            return f"a sag of {per_cent(sag)} is far out of reach here; {per_cent(reached)} is the nearest."
        self._give(subject, firmness, gesture)
        if reached is None or abs(reached / sag - 1.0) <= AS_ASKED:
            return ""
        return f"a sag of {per_cent(sag)} is not possible here. It has the nearest value now: {per_cent(reached)}."

    def _give(self, subject: MeasuredBody, firmness: Firmness, gesture: int) -> None:
        if subject.slot is not None:
            self._set_one(subject, firmness, gesture)
            return
        stiffness, damping, _ = self._meters.of(self.playback.session.world, subject).springs_of(firmness)
        material = self.material_of(subject.name)
        self.playback.submit(SetCoefficients(stiffness=stiffness, damping=damping, material=material), gesture)

    def swing_properties(self) -> list[Property]:
        """Frequency and damping ratio of the chosen bodies' slowest wobble; each body keeps its own other one."""
        return [
            Property("wobble", _WOBBLE, self.swing[0], self._set_wobble),
            Property("wobble_ratio", _RATIO, self.swing[1], self._set_ratio),
        ]

    def _set_wobble(self, playback: Playback, hz: float) -> None:
        in_range(_WOBBLE, hz)
        self._set(lambda subject: Firmness(hz=hz, ratio=self._kept(subject)[1]))

    def _set_ratio(self, playback: Playback, ratio: float) -> None:
        in_range(_RATIO, ratio)
        if any(self._kept(subject)[0] is None for subject in self._chosen()):
            raise EditError(NO_FREQUENCY)
        self._set(lambda subject: Firmness(hz=self._kept(subject)[0], ratio=ratio))

    def _chosen(self) -> list[MeasuredBody]:
        return list(self._subjects.values()) if self.body == ALL_BODIES else [self._subjects[self.body]]

    def _kept(self, subject: MeasuredBody) -> tuple[float | None, float | None]:
        """Frequency [Hz] and damping ratio that a body has now, to be set again; None where it has none."""
        world = self.playback.session.world
        reading = None if subject.slot is None else read_body(world, subject.body, subject.lowest_mode)
        if reading is None or not math.isfinite(reading.motion.hz):
            return None, None
        hz, ratio = (float(f"{value:.3g}") for value in (reading.motion.hz, reading.motion.ratio))
        return hz, min(ratio, RATIO_LIMIT)

    def _can_set(self) -> bool:
        if not self._chosen():
            self._say("No body here can have a firmness: each collapses without its pins.")
        return bool(self._chosen())

    def _set(self, asked: Callable[[MeasuredBody], Firmness]) -> bool:
        """Give the chosen bodies what is asked of each, or the nearest in reach, and say so."""
        if not self._can_set():
            return False
        gesture = self.playback.session.new_gesture()
        for subject in self._chosen():
            if subject.slot is not None:
                self._set_one(subject, asked(subject), gesture)
        return True

    def _set_one(self, subject: MeasuredBody, wanted: Firmness, gesture: int) -> None:
        settings = self.playback.session.world.settings
        reach = FirmnessRange.of(subject.body.shape, settings.gravity, settings.tick_rate)
        try:
            given = reach.nearest(wanted)
        except OutOfReach as error:
            self._say(f"{subject.name}: {error}.")
            return
        if given != wanted:
            self._say(f"{subject.name}: {wanted} is not possible here. It has the nearest value now: {given}.")
        assert subject.slot is not None
        self.playback.submit(SetFirmness(subject.slot, **asdict(given)), gesture)
