"""Rows of the panel that say how soft bodies are as a whole, in words and numbers, and change it."""

import math
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

from sandbox.app.play.playback import Playback
from sandbox.app.widgets.fields import Choice, Field, typed_number
from sandbox.app.widgets.ui import Ui
from sandbox.level.format.limits import FREQUENCY_RANGE, RATIO_LIMIT, SAG_LIMIT
from sandbox.level.format.quantities import significant
from sandbox.physics import jit
from sandbox.physics.firmness import LARGEST_READ, WORDS, OutOfReach, Reach, coefficients_of, lowest_mode_of, word_of
from sandbox.physics.forms import Firmness
from sandbox.session.commands import SetFirmness

ALL_BODIES = "All bodies"
DASH = "–"
MIXED = "mixed"
# Digits of readings.
DIGITS = 3


class FirmnessRows:
    """What the rows show and do; the panel builds them, where `shown`.

    Bodies that are large are left to the level's field and the command.
    """

    menu: Any
    words: Choice
    fields: list[Field]

    def __init__(self, playback: Playback, say: Callable[[str], None]) -> None:
        self.playback, self._say = playback, say
        self._body = ALL_BODIES
        self._find_bodies()
        # A panel that was laid out without bodies has no rows.
        self.shown = bool(self._slots)
        self._shown_of: tuple[object, ...] = ()

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies whose firmness can be set here."""
        return list(self._slots)

    def _find_bodies(self) -> None:
        forms = self.playback.session.world.forms
        self._slots = {body.name: k for k, body in enumerate(forms) if len(body.shape.mass) <= LARGEST_READ}
        if self._body not in self._slots:
            self._body = ALL_BODIES

    def offer_bodies(self, ui: Ui) -> None:
        """Let the menu offer what there is at the moment: bodies join a run, and go again."""
        self._find_bodies()
        if self.shown:
            ui.offer(self.menu, [ALL_BODIES, *self.bodies], self._body)

    def choose_body(self, name: str) -> None:
        """Show and change that body, or all."""
        self._body = name
        self.refresh(True)

    def refresh(self, look: bool) -> None:
        """Show what the bodies have now; look: also where no command of the person's has changed them."""
        if not self.shown:
            return
        key = (self.playback.revision, self._body, jit.COMPILED)
        if key == self._shown_of and not look:
            return
        self._shown_of = key
        found = {self._reading(slot) for slot in self._chosen()}
        readings = found.pop() if len(found) == 1 else None
        several = MIXED if found and None not in found else DASH
        texts = [several] * 3 if readings is None else [_text(100.0 * readings[0]), *map(_text, readings[1:])]
        for field, text in zip(self.fields, texts, strict=True):
            field.show(text)
        self.words.show((word_of(readings[0]) or "") if readings is not None else "")

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
        return hz is not None and self._set(lambda slot: Firmness(hz=hz, ratio=self._kept(slot, 2)))

    def type_ratio(self, text: str) -> bool:
        """The damping ratio of that wobble; each keeps its frequency."""
        ratio = typed_number(self._say, text, "Ratio", 0.0, RATIO_LIMIT)
        if ratio is None:
            return False
        if any(self._kept(slot, 1) is None for slot in self._chosen()):
            self._say("There is no frequency to keep: type the frequency first.")
            return False
        return self._set(lambda slot: Firmness(hz=self._kept(slot, 1), ratio=ratio))

    def _chosen(self) -> list[int]:
        slots = list(self._slots.values()) if self._body == ALL_BODIES else [self._slots[self._body]]
        return [slot for slot in slots if self._mode(slot) > 0.0]

    def _mode(self, slot: int) -> float:
        """The lowest mode of a body; while kernels are interpreted, which takes long, only where it is known."""
        world = self.playback.session.world
        body = world.forms[slot]
        known = float(world.lowest_mode[body.springs[0]])
        return known if known > 0.0 or not jit.COMPILED else lowest_mode_of(body.shape)

    def _reach(self, slot: int) -> Reach:
        world = self.playback.session.world
        return Reach.of(world.forms[slot].shape, world.settings.gravity, world.settings.tick_rate)

    def _reading(self, slot: int) -> tuple[float, float, float] | None:
        """Sag, frequency [Hz] and damping ratio of a body, to the digits that are shown; None where it has several."""
        pair = coefficients_of(self.playback.session.world, slot, self._mode(slot))
        if pair is None:
            return None
        sag, hz, ratio = (significant(value, DIGITS) for value in self._reach(slot).reading(*pair))
        return sag, hz, ratio

    def _kept(self, slot: int, place: int) -> float | None:
        reading = self._reading(slot)
        if reading is None or not math.isfinite(reading[place]):
            return None
        return min(reading[place], RATIO_LIMIT) if place == 2 else reading[place]

    def _set(self, asked: Callable[[int], Firmness]) -> bool:
        """Give the chosen bodies what is asked of each, or the nearest in reach, and say so."""
        chosen, gesture = self._chosen(), self.playback.session.new_gesture()
        if not chosen:
            self._say("There is no body here whose form is stiff without pins.")
            return False
        for slot in chosen:
            wanted = asked(slot)
            name = self.playback.session.world.forms[slot].name
            try:
                given = self._reach(slot).nearest(wanted)
            except OutOfReach as error:
                self._say(f"{name}: {error}.")
                continue
            if given != wanted:
                self._say(f"{name}: {wanted} is out of reach; it has the nearest now, {given}.")
            self.playback.submit(SetFirmness(slot, **asdict(given)), gesture)
        return True


def _text(value: float) -> str:
    return "infinite" if math.isinf(value) else f"{value:.3g}"
