"""The way `web`: a session whose calls of kernels a machine without Python makes again; see elsewhere.py."""

import re
from typing import NamedTuple

import numpy as np

from sandbox.physics.analysis.query import slot_name
from sandbox.physics.state import BY_STORED
from sandbox.physics.world import World
from sandbox.session.compare.comparison import recorded_run
from sandbox.session.compare.divergence import Divergence
from sandbox.session.replay.recording import Replay
from sandbox.session.session import Session
from tests.determinism.elsewhere import Image, Machine, watched
from tests.determinism.seeds.difference import Differs, Watch, arrays_of

_PLACE = re.compile(r"(?P<what>.*) differs(?:, call (?P<call>\d+) at (?P<at>\d+): (?P<wanted>\w+) (?P<found>\w+))?")
_WORD = 8  # bytes


class _Lying(NamedTuple):
    """Where a state array lay in the image after a tick: at `at`, of `size` bytes, in rows of `width` numbers."""

    array: str
    at: int
    size: int
    width: int


class _Tick(NamedTuple):
    """A tick that was run: calls of kernels until its end, and where its state lay."""

    tick: int
    calls: int
    lying: list[_Lying]


def run_elsewhere(watch: Watch, machine: Machine) -> None:
    """Run a recording while a machine makes the same calls, and compare all memory. Raises Differs.

    Raises Missing where the machine is not installed.
    """
    machine.command()
    image, ticks = Image(machine), []
    session = Session(watch.replay.level, watch.replay.script)
    with watched([image]) as call_again:
        while session.tick < watch.replay.ticks:
            session.advance()
            call_again()
            _spoil(watch, session.world, image)
            ticks.append(_Tick(session.tick, image.calls, _lying(session.world, image)))
    said = image.differences().splitlines()
    watch.checks += int(said[-1].split()[0]) if said[-1].endswith("differ") else 0
    if not said[-1].endswith(", 0 differ"):
        raise Differs(_divergence(watch.replay, said[0], ticks))


def _spoil(watch: Watch, world: World, image: Image) -> None:
    """Plant the fault on the machine alone."""
    value = None if watch.plant is None or watch.put else watch.plant.place(world)
    if value is not None and image.where(value) is not None:
        image.spoil(value, np.nextafter(value, np.inf))
        watch.put = True


def _lying(world: World, image: Image) -> list[_Lying]:
    places = []
    for stored, array in arrays_of(world).items():
        at = image.where(array) if array.size else None
        if at is not None:
            width = array.shape[1] if array.ndim > 1 else 1
            places.append(_Lying(stored, at, array.nbytes, width))
    return places


def _divergence(replay: Replay, line: str, ticks: list[_Tick]) -> Divergence:
    """The difference that a line of the machine tells: in a state array where it lies in one."""
    place = _PLACE.fullmatch(line)
    if place is None or place["call"] is None:
        return Divergence(0, line, None, "0 differ", "a difference", note="the machine says no more")
    call, at = int(place["call"]), int(place["at"])
    tick = next((each for each in ticks if each.calls >= call), ticks[-1])
    found = next((each for each in tick.lying if each.at <= at < each.at + each.size), None)
    words = place["wanted"], place["found"]
    if found is None:
        return Divergence(tick.tick, place["what"], None, *words, note="in what solvers keep from step to step")
    dtype = np.dtype(BY_STORED[found.array].dtype)
    number, within = (at - found.at) // dtype.itemsize, at % _WORD // dtype.itemsize
    wanted, actual = (np.frombuffer(bytes.fromhex(word), dtype)[within].item() for word in words)
    row = number // found.width
    index = row if found.width == 1 else (row, number % found.width)
    here = recorded_run(replay, tick.tick)
    name = slot_name(here.world, found.array, row) if here is not None else ""
    return Divergence(tick.tick, found.array, index, wanted, actual, name)
