"""Start: the block of a level's world before its first tick, with room for what its ticks will want."""

from typing import Any, NamedTuple

import numpy as np

from sandbox.level.document.model import Level
from sandbox.page.about import about
from sandbox.page.image import Image, image_of
from sandbox.physics.pipeline.making import Block, block_of
from sandbox.session.session import Session

# Ticks of a trial that shows how much room is wanted, and how many times that there is then.
TRIAL, SPARE, LEAST = 600, 4, 64


class Start(NamedTuple):
    """The image of a world, and what a page must know of it."""

    image: Image
    about: dict[str, Any]


def start_of(level: Level, script: Any = (), ticks: int = TRIAL) -> Start:
    """The start of a level's run; script, ticks: the commands and length of one that there is to be room for."""
    trial = Session(level, script)
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(ticks):
            trial.advance()
    world = Session(level).world
    block = Block(world)
    wanted = block_of(trial.world)
    block.wanted = SPARE * wanted.wanted + LEAST
    block._room = type(wanted._room)(*(SPARE * (each + LEAST * LEAST) for each in wanted._room))
    block._make(world)
    block.begin(world)
    image = image_of(block.arrays)
    # Words follow each other as the arrays do.
    table = {path: [place.dtype, place.dimensions] for path, place in image.table.items()}
    return Start(image, about(world, block.pointer.nbytes // 8) | {"table": table, "copies": image.copies})
