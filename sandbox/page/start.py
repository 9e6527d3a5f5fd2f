"""Start: the block of a world before its first tick, as a page is given it."""

from typing import Any, NamedTuple

from sandbox.level.assembly.level_world import LevelWorld
from sandbox.page.about import about
from sandbox.page.adding import kit_table
from sandbox.page.growth import growth_of, row_counts
from sandbox.page.image import Image, image_of
from sandbox.physics.pipeline.block_owner import block_of


class Start(NamedTuple):
    """The image of a world, and what a page must know of it."""

    image: Image
    about: dict[str, Any]


def start_of(world: LevelWorld) -> Start:
    """The start of a world."""
    block = block_of(world)
    block.begin(world)
    image = image_of(block.given)
    # Words follow each other as the arrays do.
    table = {path: [place.dtype, place.dimensions] for path, place in image.table.items()}
    known = about(world, block.pointer.nbytes // 8)
    rows = {"counts": row_counts(world), "grows": growth_of(), "kit": kit_table(world)}
    return Start(image, known | {"table": table, "copies": image.copies} | rows)
