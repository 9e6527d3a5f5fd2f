"""Groups, and the order in which things are drawn."""

from typing import Literal

from sandbox.editor.document import Document
from sandbox.editor.items import Selection
from sandbox.level.model import Level


def group(document: Document) -> Document:
    raise NotImplementedError


def ungroup(document: Document) -> Document:
    raise NotImplementedError


def reorder(document: Document, to: Literal["front", "back", "forward", "backward"]) -> Document:
    raise NotImplementedError


def with_groups(level: Level, selection: Selection) -> Selection:
    raise NotImplementedError
