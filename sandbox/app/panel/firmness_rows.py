"""Rows of the panel that say how soft bodies are as a whole, in words and numbers, and change it."""

import math
from collections.abc import Callable
from dataclasses import asdict

from sandbox.app.base.sentences import capitalised
from sandbox.app.panel.readings import per_cent, seen
from sandbox.app.panel.softness_reading import ALL_BODIES, SoftnessReading
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.button import Choice
from sandbox.app.widgets.field import Field, typed_number
from sandbox.app.widgets.picker import WordPicker
from sandbox.app.widgets.texts import TextBlock
from sandbox.editor.document import EditError
from sandbox.editor.panel.field_info import RATIO, WOBBLE
from sandbox.editor.panel.material_properties import NO_FREQUENCY
from sandbox.editor.panel.property import Property, in_range
from sandbox.level.format.limits import RATIO_LIMIT, SAG_LIMIT
from sandbox.physics import jit
from sandbox.physics.keeping.equipment import Firmness
from sandbox.physics.softness.body_motion import read_body
from sandbox.physics.softness.firmness import WORDS, FirmnessRange, OutOfReach
from sandbox.physics.softness.sag_meter import MeasuredBody, SagMeter
from sandbox.session.commands import SetCoefficients, SetFirmness

# Seconds of work on what is measured: in a frame; in one while somebody waits for it; and at once.
WORK, HASTE, AT_ONCE = 0.006, 0.02, 0.1
# What is reached of an asked sag within this share is as asked.
AS_ASKED = 0.1
# What is so many times as much or as little as asked is not set in its place.
FAR = 10.0


class FirmnessRows(SoftnessReading):
    """What the rows show and do; the panel builds them, where `shown`, and `engineers`' further down.

    Bodies that are large are left to the level's field and the command.
    """

    menu: WordPicker
    words: Choice
    text: TextBlock
    sag: Field

    def __init__(self, playback: Playback, say: Callable[[str], None], is_plain: bool = False) -> None:
        super().__init__(playback)
        self._say, self.tells_motion = say, not is_plain
        hands = playback.level.hands
        self.may = hands is None or hands.allows("firmness")
        # A panel that was laid out without bodies has no rows.
        self.shown = self.may and bool(self._subjects)
        # Sags that were asked for and are looked for, by the name of the body, and the gesture that asked.
        self._asked: dict[str, tuple[float, int]] = {}
        # Those of them that have about that by now.
        self._answered: set[str] = set()

    def offer_bodies(self) -> None:
        """Offer the present bodies in the menu: bodies join a run, and go again."""
        self._find_bodies()
        if self.shown:
            self.menu.offer(self.offered, self.body)

    @property
    def offered(self) -> list[str]:
        """The names that the menu offers: one body that hands may touch alone stands for all."""
        return self.bodies if self.bodies == [self.body] else [ALL_BODIES, *self.bodies]

    def _find_bodies(self) -> None:
        super()._find_bodies()
        hands = self.playback.level.hands
        if hands is not None and hands.bodies is not None:
            self._subjects = {name: each for name, each in self._subjects.items() if hands.lets_touch(name)}
            self.body = next(iter(self._subjects)) if len(self._subjects) == 1 else ALL_BODIES

    def speak_of(self, material: int | None) -> None:
        """Choose the one body of several that is of a material, as the level's text speaks of it, if there is one."""
        names = [name for name in self._subjects if self.material_of(name) == material]
        if len(names) == 1 < len(self._subjects):
            self.body = names[0]

    def choose_body(self, name: str) -> None:
        """Show and change that body, or all."""
        self.body = name
        self.refresh(True)

    def refresh(self, look: bool) -> None:
        """Show what the bodies have now; look: also where no command of the person's has changed them."""
        if not self.shown:
            return
        if self._asked:
            self._settle(HASTE)
        said = self.read(HASTE if self._is_waited_for() else WORK, look)
        if said is not None:
            self.sag.show(said.sag if self.tells_motion else seen(said.sag))
            self.words.show(said.word)
            self.text.show_text(said.text)

    @property
    def is_measuring(self) -> bool:
        """Whether something that was asked for is not set yet, or runs still tell of the bodies."""
        return bool(self._asked) or super().is_measuring

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
            Property("wobble", WOBBLE, self.swing[0], self._set_wobble),
            Property("wobble_ratio", RATIO, self.swing[1], self._set_ratio),
        ]

    def _set_wobble(self, playback: Playback, hz: float) -> None:
        in_range(WOBBLE, hz)
        self._set(lambda subject: Firmness(hz=hz, ratio=self._kept(subject)[1]))

    def _set_ratio(self, playback: Playback, ratio: float) -> None:
        in_range(RATIO, ratio)
        if any(self._kept(subject)[0] is None for subject in self._chosen()):
            raise EditError(NO_FREQUENCY)
        self._set(lambda subject: Firmness(hz=self._kept(subject)[0], ratio=ratio))

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

    def _set_one(self, subject: MeasuredBody, target: Firmness, gesture: int) -> None:
        settings = self.playback.session.world.settings
        reach = FirmnessRange.of(subject.body.shape, settings.gravity, settings.tick_rate)
        try:
            nearest = reach.nearest(target)
        except OutOfReach as error:
            self._say(f"{subject.name}: {error}.")
            return
        if nearest != target:
            self._say(f"{subject.name}: {target} is not possible here. It has the nearest value now: {nearest}.")
        assert subject.slot is not None
        self.playback.submit(SetFirmness(subject.slot, **asdict(reach.as_wobble(nearest))), gesture)
