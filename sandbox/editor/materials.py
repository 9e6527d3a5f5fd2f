"""Materials and checks of a level."""

from collections.abc import Iterable

from sandbox.editor.document import Document
from sandbox.level.checks import CheckDef
from sandbox.level.model import Material


def add_material(document: Document, name: str, material: Material) -> Document:
    raise NotImplementedError


def rename_material(document: Document, name: str, new_name: str) -> Document:
    raise NotImplementedError


def delete_material(document: Document, name: str) -> Document:
    raise NotImplementedError


def set_material(document: Document, name: str, material: Material) -> Document:
    raise NotImplementedError


def assign(document: Document, material: str) -> Document:
    raise NotImplementedError


def set_checks(document: Document, checks: Iterable[CheckDef]) -> Document:
    raise NotImplementedError
