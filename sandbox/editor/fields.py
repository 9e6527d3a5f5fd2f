"""Changing fields of items, of the level and of its settings."""

from collections.abc import Iterable
from typing import Any

from sandbox.editor.document import Document
from sandbox.editor.items import Item


def set_field(document: Document, items: Iterable[Item], field: str, value: Any) -> Document:
    raise NotImplementedError


def rename(document: Document, item: Item, new_id: str) -> Document:
    raise NotImplementedError


def set_level_field(document: Document, field: str, value: Any) -> Document:
    raise NotImplementedError


def set_setting(document: Document, field: str, value: Any) -> Document:
    raise NotImplementedError
