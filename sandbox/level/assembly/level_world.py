"""LevelWorld: a world that knows the level it was built from, and the levels of what joined it."""

from collections.abc import Iterable
from dataclasses import dataclass

from sandbox.level.document.model import Level, Material
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.physics.keeping.equipment import Joined
from sandbox.physics.settings import WorldSettings
from sandbox.physics.world import World


@dataclass(frozen=True, eq=False)
class JoinedLevel(Joined):
    """Bodies that joined a world together, and a level of them alone."""

    level: Level


class LevelWorld(World):
    """A world of a level, as `build_world` makes it.

    level: what it was built from. joined: what joined it since.
    """

    joined: tuple[JoinedLevel, ...]

    def __init__(self, level: Level) -> None:
        """Without particles yet."""
        materials = dict.fromkeys([DEFAULT_MATERIAL, *level.materials])
        super().__init__(WorldSettings(**dict(level.settings)), list(materials))
        self.level = level

    @property
    def materials(self) -> dict[str, Material]:
        """The materials of the level and of what joined it, by name; those that were there first go before."""
        known: dict[str, Material] = {}
        for level in (self.level, *(each.level for each in self.joined)):
            known = {**level.materials, **known}
        return known


def levels_of(joined: Iterable[Joined]) -> list[JoinedLevel]:
    """What joined a world of a level, as a snapshot keeps it."""
    return [each for each in joined if isinstance(each, JoinedLevel)]
