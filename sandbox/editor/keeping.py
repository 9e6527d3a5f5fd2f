"""What a played world leaves in its level, where the maker wants to keep it."""

from sandbox.editor.document import Document
from sandbox.physics.world import World


def keep_coefficients(document: Document, world: World) -> Document:
    raise NotImplementedError


def keep_pose(document: Document, world: World) -> Document:
    raise NotImplementedError


def keep_cuts(document: Document, world: World) -> Document:
    raise NotImplementedError


def keep_pins(document: Document, world: World) -> Document:
    raise NotImplementedError
