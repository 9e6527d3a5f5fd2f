"""Start: the block of a level's world before its first tick, as a page is given it."""

from typing import Any, NamedTuple

from sandbox.level.document.model import Level
from sandbox.page.about import about
from sandbox.page.image import Image, image_of
from sandbox.physics.pipeline.making import block_of
from sandbox.session.session import Session


class Start(NamedTuple):
    """The image of a world, and what a page must know of it."""

    image: Image
    about: dict[str, Any]


def start_of(level: Level) -> Start:
    """The start of a level's run."""
    world = Session(level).world
    block = block_of(world)
    block.begin(world)
    image = image_of(block.given)
    # Words follow each other as the arrays do.
    table = {path: [place.dtype, place.dimensions] for path, place in image.table.items()}
    return Start(image, about(world, block.pointer.nbytes // 8) | {"table": table, "copies": image.copies})
