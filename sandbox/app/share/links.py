"""Links: a run in an address, for the page of its level, with all that a page must be told of it."""

from collections.abc import Generator
from dataclasses import replace
from typing import Any

import numpy as np

from sandbox.app.draw.scene import joined_scene
from sandbox.app.share.recorded import recorded
from sandbox.level.document.model import Level
from sandbox.level.plan.actuators import actuators as driven_parts
from sandbox.page.about import is_done_by_pages
from sandbox.page.adding import is_done_without_kernel
from sandbox.page.room import Counts
from sandbox.physics.world import World
from sandbox.session.commands.command import CommandError
from sandbox.session.commands.records import ScriptLine
from sandbox.session.link.scene_link import fragment_of, level_record
from sandbox.session.replay.recording import Replay, ReplayError

# What a command of a link is told beside its record.
_TOLD = ("changes", "counts", "names", "scene")


def link_to(replay: Replay, site: str, at: int) -> Generator[float, None, str]:
    """A link to a recorded run on a site, which its page shows from a tick on; each slice gives the part done, 0..1.

    site: the address of the folder that `write_site` wrote; "": the fragment alone. What was undone is left out. Pages
    are told nothing of what they cannot be given while they run, such as motors. Raises ReplayError.
    """
    told: dict[int, Any] = {}
    if not all(_is_known_to_pages(line.record) for line in replay.script):
        script, told = yield from _told(replay)
        replay = replace(replay, script=script)
    return f"{page_address(replay.level, site)}#{fragment_of(replay, at, told)}"


def _is_known_to_pages(record: dict[str, Any]) -> bool:
    """Whether a page carries out a command by itself."""
    return is_done_by_pages(record["type"]) or is_done_without_kernel(record)


def _told(replay: Replay) -> Generator[float, None, tuple[tuple[ScriptLine, ...], dict[int, Any]]]:
    """The commands of a run without what was undone; what pages are told of some, by place. Raises ReplayError."""
    level = replay.level

    def beside(before: Counts, world: World) -> dict[str, Any]:
        if not _grows_in_pages(level, before, world):
            return {}
        return {"names": _names(before, world), "scene": joined_scene(level, world, before)}

    try:
        played = yield from recorded(level, replay.script, replay.ticks, beside, hash_of=lambda _: "")
    except CommandError as error:
        raise ReplayError(f"{replay.source}: {error}") from None
    told = {
        place: {name: done[name] for name in _TOLD if name in done}
        for place, done in enumerate(played.commands)
        if "changes" in done and ("counts" in done) == ("names" in done) and not is_done_without_kernel(done["record"])
    }
    return tuple(played.script), told


def page_address(level: Level, site: str) -> str:
    """The address of a level's page on a site, where it is a shipped level; else that of the site."""
    site, name = site.partition("#")[0], level_record(level)["level"]
    return f"{site.rstrip('/')}/levels/{name}.html" if site and isinstance(name, str) else site


def _grows_in_pages(level: Level, before: Counts, world: World) -> bool:
    """Whether a world has nothing of late but rows: no springs that break, no driven parts, nothing that floats."""
    limits = [getattr(world.limits, name)[before["material"] :] for name in ("tension", "compression", "yielding")]
    is_driven = len(world.actuators.names) > len(driven_parts(level))
    return not (np.isfinite(limits).any() or is_driven or (level.has_water and before["spring"] < world.spring_count))


def _names(before: Counts, world: World) -> dict[str, list[str]]:
    """The names of the rows that were added, by their kind."""
    return {
        "particle": list(world.particle_names[before["particle"] :]),
        "spring": list(world.spring_names[before["spring"] :]),
        "material": list(world.material_names[before["material"] :]),
    }
