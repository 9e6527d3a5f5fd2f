"""Rows of the panel that say how soft bodies are as a whole, in words and numbers, and change it."""

import math
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.app.panel.readings import DIGITS, motion_words, number, per_cent, sag_words
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.fields import DASH, MIXED, Choice, Field, typed_number
from sandbox.app.widgets.painted import TextBlock
from sandbox.app.widgets.ui import Ui
from sandbox.level.format.limits import FREQUENCY_RANGE, RATIO_LIMIT, SAG_LIMIT
from sandbox.physics import jit
from sandbox.physics.analysis.body_motion import BodyMotion, BodyReading, present_coefficients, read_body, word_for
from sandbox.physics.analysis.firmness import LARGEST_READ, WORDS, FirmnessRange, OutOfReach, lowest_mode_of
from sandbox.physics.analysis.stability import BOUND, spring_loads
from sandbox.physics.analysis.standing import StandingRun
from sandbox.physics.keeping.forms import Firmness
from sandbox.physics.solvers import SOLVERS
from sandbox.session.commands import SetFirmness

ALL_BODIES = "All bodies"
# Where only a run tells how far a body sags: ticks of it in a frame, and particles of the largest body that has one.
TICKS_A_FRAME, LARGEST_RUN = 12, 400
TOO_STIFF = "Too stiff for the single pass: it melts or explodes."


class FirmnessRows:
    """What the rows show and do; the panel builds them, where `shown`, and `engineers`' further down.

    Bodies that are large are left to the level's field and the command.
    """

    menu: Any
    words: Choice
    text: TextBlock
    sag: Field
    frequency: Field
    ratio: Field

    def __init__(self, playback: Playback, say: Callable[[str], None]) -> None:
        self.playback, self._say = playback, say
        self.body = ALL_BODIES
        self._find_bodies()
        # A panel that was laid out without bodies has no rows.
        self.shown = bool(self._slots)
        self._shown_of: tuple[object, ...] = ()
        # Runs that measure sags, by body and by what it is made of.
        self._runs: dict[tuple[object, ...], StandingRun] = {}

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies whose firmness can be set here."""
        return list(self._slots)

    def _find_bodies(self) -> None:
        forms = self.playback.session.world.forms
        self._slots = {body.name: k for k, body in enumerate(forms) if len(body.shape.mass) <= LARGEST_READ}
        if self.body not in self._slots:
            self.body = ALL_BODIES

    def offer_bodies(self, ui: Ui) -> None:
        """Let the menu offer what there is at the moment: bodies join a run, and go again."""
        self._find_bodies()
        if self.shown:
            ui.offer(self.menu, [ALL_BODIES, *self.bodies], self.body)

    def choose_body(self, name: str) -> None:
        """Show and change that body, or all."""
        self.body = name
        self.refresh(True)

    def material_of(self, name: str) -> int | None:
        """The material (index) of a body's springs; None: of all bodies, or of none that is known."""
        slot = self._slots.get(name)
        world = self.playback.session.world
        return None if slot is None else int(world.material[world.forms[slot].springs[0]])

    def body_at(self, particle: int) -> str | None:
        """The name of the body of which a particle is; None: of none that is offered."""
        world = self.playback.session.world
        for name, slot in self._slots.items():
            springs = world.forms[slot].springs
            if particle in world.particle_a[springs] or particle in world.particle_b[springs]:
                return name
        return None

    def springs_of(self, name: str) -> NDArray[np.bool_]:
        """The springs (m,) of a body, or of all."""
        world = self.playback.session.world
        chosen = np.zeros(world.spring_count, np.bool_)
        for slot in self._slots.values() if name == ALL_BODIES else [self._slots[name]]:
            chosen[world.forms[slot].springs] = True
        return chosen

    def body_of(self, material: int | None) -> int | None:
        """The body of which what is said of a material is said: the chosen one, else the largest of the material."""
        world = self.playback.session.world
        if self.body in self._slots and material in (None, self.material_of(self.body)):
            slots = [self._slots[self.body]]
        else:
            slots = [slot for name, slot in self._slots.items() if material in (None, self.material_of(name))]
        slots = [slot for slot in slots if self._mode(slot) > 0.0]
        return max(slots, key=lambda slot: len(world.forms[slot].springs), default=None)

    def motion_of(self, slot: int) -> BodyMotion:
        """What a body, by its place in the world's `forms`, makes of Cs and Cd."""
        world = self.playback.session.world
        return BodyMotion.of(world.forms[slot].shape, world.settings, self._mode(slot))

    def refresh(self, look: bool) -> None:
        """Show what the bodies have now; look: also where no command of the person's has changed them."""
        if not self.shown:
            return
        key = (self.playback.revision, self.body, jit.COMPILED)
        if key == self._shown_of and not look and not self._advance():
            return
        self._shown_of = key
        world = self.playback.session.world
        present = present_coefficients(world)
        found = {slot: read_body(world, slot, self._mode(slot), present) for slot in self._chosen()}
        readings = {slot: reading for slot, reading in found.items() if reading is not None}
        sags = {slot: self._sag(slot, reading) for slot, reading in readings.items()}
        known = [sag for sag in sags.values() if sag is not None]
        whole = len(readings) == len(found) and len(known) == len(sags) and bool(found)
        self.sag.show(self._one([per_cent(sag, DIGITS).removesuffix(" %") for sag in known], whole))
        self.frequency.show(self._one([number(each.motion.hz) for each in readings.values()], whole))
        self.ratio.show(self._one([number(each.motion.ratio) for each in readings.values()], whole))
        words = {word_for(sag, readings[slot].is_rigid) for slot, sag in sags.items() if sag is not None}
        explodes = self._may_explode()
        self.words.show(words.pop() if whole and len(words) == 1 and not explodes else "")
        self.text.show_text(TOO_STIFF if explodes else self._text(list(readings.values()), known, whole))

    def _may_explode(self) -> bool:
        """Whether springs of a chosen body are past what a single pass is proven to bear."""
        world = self.playback.session.world
        if not SOLVERS[world.settings.solver].proven_limit:
            return False
        loads = spring_loads(world)
        return any(bool(np.any(loads[world.forms[slot].springs] >= BOUND)) for slot in self._chosen())

    def _one(self, texts: list[str], whole: bool) -> str:
        return DASH if not texts else texts[0] if whole and len(set(texts)) == 1 else MIXED

    def _text(self, readings: list[BodyReading], sags: list[float], whole: bool) -> str:
        if not self._chosen():
            return "No body here keeps its form without pins."
        if not readings:
            return "The springs of a body differ in Cs or Cd."
        if not sags:
            return "Measuring how far it sags ..."
        sag = sag_words(min(sags), max(sags))
        motions = {motion_words(reading.motion) for reading in readings}
        return f"{sag}; {motions.pop()}." if whole and len(motions) == 1 else f"{sag}."

    # Where only a run can tell.

    def _sag(self, slot: int, reading: BodyReading) -> float | None:
        """How far a body sags; None while it is measured."""
        if reading.sag is not None:
            return reading.sag
        world = self.playback.session.world
        body = world.forms[slot]
        if len(body.shape.mass) > LARGEST_RUN:
            return None
        pair = float(world.stiffness[body.springs[0]]), float(world.damping[body.springs[0]])
        key = (body.shape, world.settings, *pair)
        if key not in self._runs:
            self._runs = {each: run for each, run in self._runs.items() if run.sag is not None}
            self._runs[key] = StandingRun(body.shape, world.settings, *pair)
        return self._runs[key].sag

    def _advance(self) -> bool:
        """Go on with a run that is not at its end; whether one came to it."""
        run = next((run for run in self._runs.values() if run.sag is None), None)
        return run is not None and run.advance(TICKS_A_FRAME)

    # Changing.

    def choose_word(self, word: str) -> None:
        """Make the chosen bodies as soft as the word says."""
        self._set(lambda slot: Firmness(sag=WORDS[word]))

    def type_sag(self, text: str) -> bool:
        """The sag of the chosen bodies [%]."""
        sag = typed_number(self._say, text, "Sag", 0.0, 100.0 * SAG_LIMIT, unit="%")
        return sag is not None and self._set(lambda slot: Firmness(sag=sag / 100.0))

    def type_frequency(self, text: str) -> bool:
        """The frequency of their slowest wobble [Hz]; each keeps its damping ratio."""
        hz = typed_number(self._say, text, "Wobble", *FREQUENCY_RANGE)
        return hz is not None and self._set(lambda slot: Firmness(hz=hz, ratio=self._kept(slot)[1]))

    def type_ratio(self, text: str) -> bool:
        """The damping ratio of that wobble; each keeps its frequency."""
        ratio = typed_number(self._say, text, "Ratio", 0.0, RATIO_LIMIT)
        if ratio is None:
            return False
        if any(self._kept(slot)[0] is None for slot in self._chosen()):
            self._say("These bodies have no frequency to keep. Set the frequency first.")
            return False
        return self._set(lambda slot: Firmness(hz=self._kept(slot)[0], ratio=ratio))

    def _chosen(self) -> list[int]:
        slots = list(self._slots.values()) if self.body == ALL_BODIES else [self._slots[self.body]]
        return [slot for slot in slots if self._mode(slot) > 0.0]

    def _mode(self, slot: int) -> float:
        """The lowest mode of a body; while kernels are interpreted, which takes long, only where it is known."""
        world = self.playback.session.world
        body = world.forms[slot]
        known = float(world.lowest_mode[body.springs[0]])
        return known if known > 0.0 or not jit.COMPILED else lowest_mode_of(body.shape)

    def _kept(self, slot: int) -> tuple[float | None, float | None]:
        """Frequency [Hz] and damping ratio of a body, those that can be asked for again."""
        reading = read_body(self.playback.session.world, slot, self._mode(slot))
        if reading is None or not math.isfinite(reading.motion.hz):
            return None, None
        hz, ratio = (float(f"{value:.3g}") for value in (reading.motion.hz, reading.motion.ratio))
        return hz, min(ratio, RATIO_LIMIT)

    def _set(self, asked: Callable[[int], Firmness]) -> bool:
        """Give the chosen bodies what is asked of each, or the nearest in reach, and say so."""
        chosen, gesture = self._chosen(), self.playback.session.new_gesture()
        if not chosen:
            self._say("No body here can have a firmness: each collapses without its pins.")
            return False
        for slot in chosen:
            wanted, world = asked(slot), self.playback.session.world
            name = world.forms[slot].name
            reach = FirmnessRange.of(world.forms[slot].shape, world.settings.gravity, world.settings.tick_rate)
            try:
                given = reach.nearest(wanted)
            except OutOfReach as error:
                self._say(f"{name}: {error}.")
                continue
            if given != wanted:
                self._say(f"{name}: {wanted} is not possible here. It has the nearest value now: {given}.")
            self.playback.submit(SetFirmness(slot, **asdict(given)), gesture)
        return True
