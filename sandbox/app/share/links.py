"""Links: a run in an address, for the page of its level, with all that a page must be told of it."""

from collections.abc import Generator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.scene import joined_scene
from sandbox.app.share.recorded import recorded
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level
from sandbox.level.plan.actuators import driving_keys
from sandbox.page.about import is_done_by_pages
from sandbox.page.adding import is_done_without_kernel
from sandbox.page.image import arrays_of
from sandbox.page.room import Counts
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.world import World
from sandbox.session.commands.command import CommandError
from sandbox.session.commands.records import ScriptLine
from sandbox.session.link.scene_link import fragment_of, level_record
from sandbox.session.replay.recording import Replay, ReplayError

# What a command of a link is told beside its record.
_TOLD = ("changes", "counts", "names", "scene", "equipment", "keys")
# Groups of arrays that are constant until something joins.
_EQUIPMENT = ("drives.", "wheels.", "limits.", "water.hull")


def link_to(replay: Replay, site: str, at: int) -> Generator[float, None, str]:
    """A link to a recorded run on a site, which its page shows from a tick on; each slice gives the part done, 0..1.

    site: the address of the folder that `write_site` wrote; "": the fragment alone. What was undone is left out, where
    pages are told of anything. Raises ReplayError.
    """
    told: dict[int, Any] = {}
    if not all(_is_known_to_pages(line.record, replay.level) for line in replay.script):
        script, told = yield from _told(replay)
        replay = replace(replay, script=script)
    return f"{page_address(replay.level, site)}#{fragment_of(replay, at, told)}"


def _is_known_to_pages(record: dict[str, Any], level: Level) -> bool:
    """Whether a page carries out a command by itself. What floats it has to be told of."""
    floats = level.has_water and record["type"] == "add_body"
    return is_done_by_pages(record["type"]) or (is_done_without_kernel(record) and not floats)


def _told(replay: Replay) -> Generator[float, None, tuple[tuple[ScriptLine, ...], dict[int, Any]]]:
    """The commands of a run without what was undone; what pages are told of some, by place. Raises ReplayError."""
    level = replay.level
    last = _equipment(build_world(level))

    def beside(before: Counts, world: World) -> dict[str, Any]:
        present = _equipment(world)
        changed = {path: _plain(values) for path, values in present.items() if not _is_same(values, last[path])}
        last.update(present)
        told = {"names": _names(before, world), "scene": joined_scene(level, world, before)}
        return told | ({"equipment": changed, "keys": _keys(before, world)} if changed else {})

    try:
        played = yield from recorded(level, replay.script, replay.ticks, beside, hash_of=lambda _: "")
    except CommandError as error:
        raise ReplayError(f"{replay.source}: {error}") from None
    told = {
        place: {name: done[name] for name in _TOLD if name in done}
        for place, done in enumerate(played.commands)
        if "changes" in done and not _is_known_to_pages(done["record"], level)
    }
    return tuple(played.script), told


def page_address(level: Level, site: str) -> str:
    """The address of a level's page on a site, where it is a shipped level; else that of the site."""
    site, name = site.partition("#")[0], level_record(level)["level"]
    return f"{site.rstrip('/')}/levels/{name}.html" if site and isinstance(name, str) else site


def _equipment(world: World) -> dict[str, NDArray[Any]]:
    """Arrays of driven parts, limits and hulls, by their paths, as copies."""
    arrays = arrays_of(block_of(world).given)
    return {path: array.copy() for path, array in arrays if path.startswith(_EQUIPMENT)}


def _is_same(one: NDArray[Any], other: NDArray[Any]) -> bool:
    return one.shape == other.shape and one.tobytes() == other.tobytes()


def _plain(values: NDArray[Any]) -> list[Any]:
    """The numbers of an array as JSON takes them."""
    return [value if np.isfinite(value) else "Infinity" for value in (values.reshape(-1) + 0).tolist()]


def _keys(before: Counts, world: World) -> dict[str, list[list[Any]]]:
    """What keys drive of what joined last, by their names."""
    joined = [each for each in world.joined if each.first_part >= before["actuator"]]
    found: dict[str, list[list[Any]]] = {}
    for each in joined:
        for key, parts in driving_keys(each.source).items():
            found.setdefault(key, []).extend([part + each.first_part, value] for part, value in parts)
    return found


def _names(before: Counts, world: World) -> dict[str, list[str]]:
    """The names of the rows that were added, by their kind."""
    return {
        "particle": list(world.particle_names[before["particle"] :]),
        "spring": list(world.spring_names[before["spring"] :]),
        "material": list(world.material_names[before["material"] :]),
        "part": list(world.actuators.names[before["actuator"] :]),
    }
