"""Problems: what goes wrong in a run is found, said, and mended by buttons that are there as long as there is need."""

from collections import Counter
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
import pygame

from sandbox.app.base.shortcuts import tip_of
from sandbox.app.contracts.application import Application
from sandbox.app.draw.camera import Box, Camera
from sandbox.app.draw.colours import WARNING
from sandbox.app.play.stage import Stage
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.dialogs import show_lines
from sandbox.app.widgets.ui import Ui
from sandbox.level.assembly.build_world import LevelWorld
from sandbox.physics.analysis.applied_forces import overlapping
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.arrays import Slots
from sandbox.physics.components import body_of, label_bodies
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import World
from sandbox.session.commands import Free, MoveBody


class Problems:
    """Bodies that are stuck or left the picture, values out of bounds and breaks in the run of a stage.

    say: shows a line about the run. brings_back: whether what left the picture can be had back.
    """

    def __init__(
        self, app: Application, stage: Callable[[], Stage], say: Callable[[str], None], brings_back: bool
    ) -> None:
        self._app, self._stage, self._say, self._brings_back = app, stage, say, brings_back
        self.begin()
        self.actions: dict[str, Callable[[], object]] = {
            "free": self._free, "bring_back": self._bring_back, "details": self._show_details
        }  # fmt: skip

    def begin(self) -> None:
        """Forget all of the run before, and look at another."""
        self.stuck, self.out_of_view = StuckBodies(), OutOfView()
        # What was last said of what broke, and of what went out of bounds.
        self._last_said = ["", ""]

    def build(self, ui: Ui, left: float, top: float) -> None:
        """Make the buttons, from a place on [layout units]."""
        self._ui = ui
        self.quick_fixes = QuickFixes(ui, self._app.act, tuple(self.actions), left, top)

    def update(self) -> None:
        """Look at the run after its ticks."""
        self._look_for_stuck()
        self._look_for_lost()
        self._tell()
        words = {}
        if self.stuck.particles:
            words["free"] = "Free it"
        if self.out_of_view.lost_count and self._brings_back:
            words["bring_back"] = f"Bring back {self.out_of_view.lost_count}"
        if self._details:
            words["details"] = "Details"
        self.quick_fixes.show(words)

    def draw(self, surface: pygame.Surface) -> None:
        """Mark bodies that are stuck."""
        stage = self._stage()
        self.stuck.draw(surface, self._ui, stage.camera, stage.playback.current)

    def _look_for_stuck(self) -> None:
        before = len(self.stuck.particles)
        self.stuck.update(self._stage().playback.session.world)
        found = len(self.stuck.particles)
        if found > before:
            self._say(STUCK)
        elif before and not found:
            self._app.take_back(STUCK)

    def _free(self) -> None:
        """Free all stuck bodies in one gesture."""
        self._app.take_back(STUCK)
        if not self.stuck.free(self._stage().playback):
            self._say("Nothing is stuck.")

    @property
    def _pictures(self) -> list[Box]:
        """The boxes [m] that are seen at first, and now."""
        camera = self._stage().camera
        return [camera.picture_of(self._stage().first_box), camera.picture]

    def _look_for_lost(self) -> None:
        was_over = self.out_of_view.is_over
        session, said = self._stage().playback.session, LEFT_VIEW if self._brings_back else LEFT_GAME
        self.out_of_view.update(session.world, self._pictures, session.history.keyframes.first.snapshot)
        if self.out_of_view.is_over and not was_over:
            self._say(said)
        elif was_over and not self.out_of_view.is_over:
            self._app.take_back(said)

    def _bring_back(self) -> None:
        """Put bodies that left the picture back into it, at rest."""
        stage = self._stage()
        if not self._brings_back:
            self._say(NOTHING_BACK)
            return
        count = put_back(stage.playback, stage.first_box, self._pictures)
        self.out_of_view = OutOfView()
        self._app.take_back(LEFT_VIEW)
        verb = "is" if count == 1 else "are"
        self._say(f"{count} {verb} back in the picture." if count else "Nothing has left the picture.")

    def _tell(self) -> None:
        """Say what broke, and what was stopped; a line that has grown takes the place of what it was."""
        playback = self._stage().playback
        lines = [playback.breaks.text, playback.stopped.text(playback.session.tick)]
        for text, before in zip(lines, self._last_said, strict=True):
            if text != before:
                self._app.take_back(before)
                if text:
                    self._say(text)
        self._last_said = lines

    @property
    def _details(self) -> list[str]:
        playback = self._stage().playback
        return playback.stopped.details(playback.session.tick)

    def _show_details(self) -> None:
        """Show what went out of bounds, with ticks and names of slots."""
        if self._details:
            show_lines(self._ui, "What went out of bounds", self._details)
        else:
            self._say("Nothing went out of bounds.")


# Size of a button, and how far it is from the next [layout units].
_WIDTH, _HEIGHT, _GAP = 124.0, 34.0, 6.0


class QuickFixes:
    """Buttons by the names of what they do, from a place on [layout units]; `press` does that."""

    def __init__(self, ui: Ui, press: Callable[[str], None], names: tuple[str, ...], left: float, top: float) -> None:
        self._ui, self._left, self._top = ui, left, top
        self.buttons = {
            name: ui.button(self._place(0), "", partial(press, name), tip=tip_of(name, "play")) for name in names
        }
        for button in self.buttons.values():
            button.visible = False

    def _place(self, row: int) -> pygame.Rect:
        return self._ui.rect(self._left, self._top + row * (_HEIGHT + _GAP), _WIDTH, _HEIGHT)

    def show(self, words: Mapping[str, str]) -> None:
        """Show those that there are words for, one below the other, and no others."""
        for row, (name, text) in enumerate(words.items()):
            self.buttons[name].show_text(text)
            self.buttons[name].move_to(self._place(row).topleft)
        for name, button in self.buttons.items():
            button.visible = name in words


# What overlaps for so long is stuck [s]; what parts takes less than two. For so long it may be apart in between.
STUCK_SECONDS = 4.0
APART_SECONDS = 0.5
STUCK = "Something is stuck inside another. J frees it; Ctrl+Z undoes that."
# Sizes of a mark in layout units: how far from the body, and how thick.
_ROUND, _THICK = 10.0, 2.0


class StuckBodies:
    """The pairs of bodies of a run that have overlapped for long, by a particle of each."""

    def __init__(self) -> None:
        self._since: dict[tuple[int, int], tuple[int, int]] = {}
        self._tick, self._count = -1, 0
        self.particles: list[int] = []

    def update(self, world: World) -> None:
        """Look at a world after its ticks; one that went back in time, or has lost particles, is looked at afresh."""
        if world.tick < self._tick or world.particle_count < self._count:
            self._since.clear()
            self.particles = []
        self._count = world.particle_count
        if world.tick == self._tick:
            return
        self._tick, rate = world.tick, world.settings.tick_rate
        found = overlapping(world)
        for pair in found:
            self._since[pair] = (self._since.get(pair, (world.tick, 0))[0], world.tick)
        self._since = {
            pair: (first, last)
            for pair, (first, last) in self._since.items()
            if world.tick - last <= APART_SECONDS * rate
        }
        stuck = [pair for pair, (first, last) in self._since.items() if last - first >= STUCK_SECONDS * rate]
        chosen = [_to_be_moved(world, pair) for pair in stuck]
        self.particles = sorted({particle for particle in chosen if particle >= 0})

    def free(self, playback: Playback) -> bool:
        """Free all stuck bodies in one gesture; whether there were any."""
        gesture, found = playback.session.new_gesture(), self.particles
        for particle in found:
            playback.submit(Free(particle), gesture)
        self._since.clear()
        self.particles = []
        return bool(found)

    def draw(self, surface: pygame.Surface, ui: Ui, camera: Camera, current: Snapshot) -> None:
        """Draw a ring round each body that is stuck."""
        for particle in self.particles:
            if particle >= len(current.mass):
                continue
            body = current.position[current.owner == current.owner[particle]]
            middle = body.mean(axis=0)
            if not np.isfinite(body).all():
                continue
            radius = float(np.sqrt(np.max(np.sum((body - middle) ** 2, axis=1)))) * camera.zoom + ui.px(_ROUND)
            at = camera.to_pixels((float(middle[0]), float(middle[1])))
            pygame.draw.aacircle(surface, WARNING, at, round(radius), max(1, ui.px(_THICK)))


def _to_be_moved(world: World, pair: tuple[int, int]) -> int:
    """The particle of a pair whose body is to be moved, the lighter one; -1: both are pinned."""
    bodies = [body_of(world, particle) for particle in pair]
    masses = [float(world.mass[body].sum()) if (world.inverse_mass[body] > 0.0).all() else np.inf for body in bodies]
    return -1 if min(masses) == np.inf else pair[masses.index(min(masses))]


LEFT_VIEW = "Nearly everything has left the picture. Shift+J brings it back; R restarts."
LEFT_GAME = "Nearly everything has left the picture. R begins again."
NOTHING_BACK = "In a level with a goal nothing is brought back. R begins again."
# A run is over once this part of the mass that moves has left; stubs may stay where something broke.
GONE = 0.75
# Ticks between two looks; after each step back in time there is one.
_EVERY = 20
# A body has left once it has been out for so long [s]: one above the picture, where it falls back from, for longer.
_AWAY, _ABOVE = 1.0, 5.0
# What is brought back is put so far below the top of its box, as a part of that height.
FROM_TOP = 0.2


class OutOfView:
    """Looks at a world after its ticks.

    lost_count: how many bodies have left the picture. is_over: whether they are nearly all that moves.
    """

    def __init__(self) -> None:
        self.lost_count, self.is_over = 0, False
        self._tick = -_EVERY
        # Since which tick a body is out of the picture, by its first particle.
        self._since: dict[int, int] = {}

    def update(self, world: LevelWorld, pictures: list[Box], first: Snapshot) -> None:
        """Look at a world; pictures [m]: what is seen at first, and what is seen now; first: how the run began."""
        if 0 <= world.tick - self._tick < _EVERY:
            return
        if world.tick < self._tick:
            self._since.clear()
        self._tick, rate = world.tick, world.settings.tick_rate
        bodies = {int(body[0]): body for body in bodies_beyond(world, pictures, first)}
        self._since = {first: self._since.get(first, world.tick) for first in bodies}
        gone = [
            body for first, body in bodies.items()
            if world.tick - self._since[first] >= rate * (_ABOVE if _falls_back(world, body, pictures[0]) else _AWAY)
        ]  # fmt: skip
        self.lost_count = len(gone)
        moving = float(world.mass[shown_particles(world) & (world.inverse_mass > 0.0)].sum())
        self.is_over = sum(float(world.mass[body].sum()) for body in gone) > GONE * moving


def put_back(playback: Playback, box: Box, pictures: list[Box]) -> int:
    """Put every body that is beyond the pictures [m] into a box [m], in one gesture; how many there are."""
    world, gesture = playback.session.world, playback.session.new_gesture()
    bodies = bodies_beyond(world, pictures, playback.session.history.keyframes.first.snapshot)
    left, bottom, right, top = box
    for number, body in enumerate(bodies):
        # Side by side near the top, at rest.
        target = left + (right - left) * (number + 1) / (len(bodies) + 1), top - FROM_TOP * (top - bottom)
        x, y = world.position[body].mean(axis=0).tolist()
        playback.submit(MoveBody(int(body[0]), (target[0] - x, target[1] - y), at_rest=True), gesture)
    if world.has_contacts:
        # Where another body or the ground is, they are put beside it.
        for body in bodies:
            playback.submit(Free(int(body[0])), gesture)
    return len(bodies)


def bodies_beyond(world: LevelWorld, pictures: list[Box], first: Snapshot) -> list[Slots]:
    """The bodies, by their particles, that move freely and whose middle is in none of the pictures [m].

    What hangs on something that is pinned stays where it is, and so do stubs, which are less than half of what they
    were cut from, and what was out in the first state of the run.
    """
    moving = shown_particles(world) & (world.inverse_mass > 0.0)
    if not _is_beyond(world.position[moving], pictures).any():
        return []
    joined = np.flatnonzero(world.spring_active & (world.material >= 0))
    label = np.arange(len(world.particle_active))
    label_bodies(world.particle_a[joined].astype(np.int64), world.particle_b[joined].astype(np.int64), label)
    shown = np.flatnonzero(shown_particles(world))
    order = shown[np.argsort(label[shown], kind="stable")]
    bodies = np.split(order, np.flatnonzero(np.diff(label[order])) + 1)
    free = [body for body in bodies if moving[body].all() and np.isfinite(world.position[body]).all()]
    return [body for body in free if _has_left(world, body, pictures, first) and not _is_stub(world, body)]


def _has_left(world: World, body: Slots, pictures: list[Box], first: Snapshot) -> bool:
    """Whether the middle of a body is beyond the pictures [m] and was not so in the first state of a run."""
    is_new = body[-1] >= len(first.position)
    places = [world.position, *([] if is_new else [first.position])]
    beyond = [bool(_is_beyond(place[body].mean(axis=0)[None], pictures)[0]) for place in places]
    return beyond[0] and not any(beyond[1:])


def _is_stub(world: LevelWorld, body: Slots) -> bool:
    """Whether a body is a strand, and less than half of the thing that it was cut from, by mass."""
    holds = world.spring_active & (world.material >= 0)
    if np.isin(world.particle_a[holds], body).sum() >= len(body):
        return False
    things = [name.rpartition(".")[0] or name for name in world.particle_names]
    counts = Counter(things[slot] for slot in body)
    thing = counts.most_common(1)[0][0]
    whole = [slot for slot, name in enumerate(things) if name == thing and world.particle_active[slot]]
    return float(world.mass[body].sum()) < 0.5 * float(world.mass[whole].sum())


def _is_beyond(points: np.ndarray, pictures: list[Box]) -> np.ndarray:
    """Which points [m] (n, 2) are in none of the pictures (n,)."""
    inside = [((points >= box[:2]) & (points <= box[2:])).all(axis=1) for box in pictures]
    return ~np.logical_or.reduce(inside)


def _falls_back(world: World, body: Slots, picture: Box) -> bool:
    """Whether gravity pulls a body back into a picture [m]: it is on the side that gravity comes from, and no other."""
    gravity, at = np.array(world.settings.gravity), world.position[body].mean(axis=0)
    along = int(np.argmax(np.abs(gravity)))
    low, high = np.array(picture[:2]), np.array(picture[2:])
    across = 1 - along
    is_before = at[along] > high[along] if gravity[along] < 0.0 else at[along] < low[along]
    return bool(gravity[along] != 0.0 and is_before and low[across] <= at[across] <= high[across])
