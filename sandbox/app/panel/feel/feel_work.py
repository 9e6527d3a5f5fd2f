"""FeelWork: how a thing of a run feels, measured beside it in slices; and the search for Cs and Cd that feel so."""

from collections.abc import Generator, Iterator

from sandbox.app.base.sentences import capitalised, sentence
from sandbox.app.run.playback import Playback
from sandbox.export.engines import body_names
from sandbox.export.feel import Feel, Sought, feel_in_slices, material_of, sought_in_slices
from sandbox.export.release import NoCurve
from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.format.slices import telling, work_for
from sandbox.session.commands import SetCoefficients

# Wall time [s] of a frame for the work, for which the person waits.
BUDGET = 0.03
WAYS = ("down", "aside")
MEASURING = "Measuring it: pulled in a copy of the run, held, and let go."
LOOKING = "Looking for Cs and Cd."
HINT = "Drag the peak or the end of the curve, or type: then Cs and Cd are looked for."
NO_HANDS = "Hands may not change springs in this level."


class FeelWork:
    """The card of a body, pulled one way: `feel` as it is now, `found` what was found for what is `wanted`.

    wanted: overshoot [1] and settling [s]; None until something was measured. done: how much of the present work is,
    0..1; None: there is none. note: what there is to say of all that. refusal: why nothing can be sought, "" where it
    can.
    """

    def __init__(self, playback: Playback, body: str | None = None) -> None:
        self.playback = playback
        self.names = body_names(self._world)
        self.body = body if body in self.names else self.names[0]
        self.way = WAYS[0]
        self.feel: Feel | None = None
        self.found: Sought | None = None
        self.wanted: tuple[float, float] | None = None
        self.done: float | None = None
        self.note = self.refusal = ""
        self._work: Iterator[None] | None = None
        self.choose()

    @property
    def _world(self) -> LevelWorld:
        return self.playback.session.world

    @property
    def shown(self) -> Feel | None:
        """The card that is shown: what was found, or else as it is now."""
        return self.feel if self.found is None else self.found.feel

    @property
    def tick(self) -> float:
        """The length of a tick [s]."""
        return 1.0 / self._world.settings.tick_rate

    def choose(self, body: str | None = None, way: str | None = None) -> None:
        """Measure a body that is pulled one way; None: those of before."""
        self.body, self.way = body or self.body, way or self.way
        self.feel = self.found = self.wanted = None
        self.refusal = self._refusal()
        self._begin(self._measured(self._world), MEASURING)

    def _refusal(self) -> str:
        hands = self.playback.level.hands
        if hands is not None and not hands.allows("material"):
            return NO_HANDS
        try:
            material_of(self._world, self.body)
        except NoCurve as error:
            return sentence(error)
        return ""

    def _measured(self, world: LevelWorld) -> Generator[float, None, Feel]:
        return feel_in_slices(world, self.body, None, self.way)

    def _begin(self, work: Generator[float, None, Feel | Sought], note: str) -> None:
        self._work, self.done, self.note = self._carry_out(work), 0.0, note

    def want(self, overshoot: float | None = None, settling: float | None = None) -> None:
        """Want another overshoot [1], settling [s] or both."""
        if self.wanted is not None:
            before = self.wanted
            self.wanted = before[0] if overshoot is None else overshoot, before[1] if settling is None else settling

    def seek(self) -> None:
        """Look for Cs and Cd with which the body feels as is wanted."""
        if self.wanted is not None and not self.refusal:
            self.found, world = None, self._world
            work = sought_in_slices(world, *self.wanted, self._measured, material_of(world, self.body))
            self._begin(work, LOOKING)

    def cancel(self) -> None:
        """Give the present work up."""
        self._end("Cancelled.")
        self._want_shown()

    def _want_shown(self) -> None:
        numbers = None if self.shown is None else self.shown.numbers
        self.wanted = None if numbers is None else (numbers.overshoot, numbers.settling)

    def step(self) -> bool:
        """Work for a moment; whether all is done."""
        try:
            if self._work is not None:
                work_for(self._work, BUDGET)
        except ValueError as error:
            self._end(sentence(error))
        return self._work is None

    def _carry_out(self, work: Generator[float, None, Feel | Sought]) -> Iterator[None]:
        self._take((yield from telling(work, self._show)))

    def _show(self, done: float) -> None:
        self.done = done

    def _take(self, made: Feel | Sought) -> None:
        if isinstance(made, Sought):
            self.found = made
            self._end(f"{capitalised(made.pair_text(self._world))}: {made.nearness}.")
        else:
            self.feel = made
            self._end(self.refusal or HINT)
            self._want_shown()

    def _end(self, note: str) -> None:
        self._work, self.done, self.note = None, None, note

    def use(self) -> None:
        """Set what was found, by one command of the run, which undo takes back."""
        if self.found is None:
            return
        made, playback = self.found, self.playback
        before = len(playback.messages)
        playback.submit(
            SetCoefficients(stiffness=made.stiffness, damping=made.damping, material=made.material),
            playback.session.new_gesture(),
        )
        playback.apply_pending()
        self.feel, self.found = made.feel, None
        self._want_shown()
        refused = playback.messages[before:]
        self.note = refused[0] if refused else f"Set: {made.pair_text(self._world)}. Ctrl+Z takes it back."
