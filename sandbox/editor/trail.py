"""Trail: where the things of a level go in the seconds after its beginning, or went in a run of it.

Nobody presses a key but those that the first check holds that holds some.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.edits.grouping import groups_of
from sandbox.editor.forecast import LARGEST
from sandbox.editor.items import Item, Selection
from sandbox.editor.scene import Scene, make_scene
from sandbox.editor.slices import work_for
from sandbox.level.document.model import Level
from sandbox.session.check_run import HeldKeys
from sandbox.session.session import Session

Floats = NDArray[np.float64]

# How far ahead it looks [s], and how often it notes the places in a second.
SECONDS = 5.0
NOTES = 30


class Trail:
    """A run in work, a slice at a time; it changes nothing but its own session.

    places: of each note the mean place [m] (k, 2) of each item that has particles, NaN of others; per_second: notes in
    a second. fault: why there is none; "" = there is.
    """

    def __init__(self, level: Level, run: Session | None = None) -> None:
        self.level = level
        self.scene: Scene = make_scene(level)
        self.places: list[Floats] = []
        self.per_second = 0.0
        self.is_done = False
        self.fault = ""
        self._work = self._run(run)
        self._found: tuple[object, list[Floats]] = (None, [])

    def advance(self, seconds: float) -> bool:
        """Work for about that long, at least one tick; whether it is done."""
        self.is_done = work_for(self._work, seconds)
        return self.is_done

    def _run(self, run: Session | None) -> Iterator[None]:
        scene = self.scene
        if len(scene.position) > LARGEST:
            self.fault = f"{len(scene.position):,} particles are too many for a trail ({LARGEST:,})"
            return
        # Of welded particles the world has the first alone.
        is_first = scene.first_of_weld == np.arange(len(scene.position))
        slots = (np.cumsum(is_first) - 1)[scene.first_of_weld]
        count = np.bincount(scene.particle_item, minlength=len(scene.items))
        session = run if run is not None else Session(self.level)
        rate = session.world.settings.tick_rate
        every = max(1, rate // NOTES)
        self.per_second = rate / every
        # A level that waits for keys says in its checks which ones to hold.
        held = HeldKeys(self.level, next((check.hold for check in self.level.checks if check.hold), ()))
        last = round(SECONDS * rate) if run is None else min(round(SECONDS * rate), session.last_tick)
        for tick in range(last + 1):
            if tick % every == 0:
                self.places.append(_means(session.world.position[slots], scene.particle_item, count))
            if tick < last:
                if run is None:
                    held.press(session)
                session.advance()
            yield None

    def lines(self, selection: Selection, most: int) -> list[Floats]:
        """The ways [m] (notes, 2) of what is selected, a group's as one, of no more than `most` things.

        They are kept until more is known or something else is asked for: each frame draws them.
        """
        asked = (selection, most, len(self.places))
        if self._found[0] != asked:
            self._found = asked, self._lines(selection)[:most] if self.places else []
        return self._found[1]

    def _lines(self, selection: Selection) -> list[Floats]:
        index = {item: number for number, item in enumerate(self.scene.items)}
        groups = groups_of(self.level)
        units: dict[object, list[Item]] = {}
        for item in sorted(selection.intersection(index), key=index.__getitem__):
            units.setdefault(groups.get(item, item), []).append(item)
        places = np.stack(self.places)
        found = [_middle(places, [index[item] for item in items]) for items in units.values()]
        return [line for line in found if line is not None]


def _means(position: Floats, owner: NDArray[np.int64], count: NDArray[np.int64]) -> Floats:
    with np.errstate(invalid="ignore", divide="ignore"):
        sums = [np.bincount(owner, position[:, axis], len(count)) / count for axis in (0, 1)]
    return np.stack(sums, axis=1)


def _middle(places: Floats, items: Sequence[int]) -> Floats | None:
    chosen = places[:, items]
    known = chosen[:, ~np.isnan(chosen[0, :, 0])]
    return known.mean(axis=1) if known.shape[1] else None
