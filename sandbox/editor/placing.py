"""Putting things into a level: bodies, particles, springs, welds, pins and cuts."""

from collections.abc import Iterable

from sandbox.editor.document import Document
from sandbox.level.bodies import AnyBody
from sandbox.level.model import ParticleDef


def add_body(document: Document, body: AnyBody) -> Document:
    raise NotImplementedError


def add_particle(document: Document, particle: ParticleDef) -> Document:
    raise NotImplementedError


def add_spring(
    document: Document, a: str, b: str, material: str | None = None, rest_length: float | None = None
) -> Document:
    raise NotImplementedError


def weld(document: Document, a: str, b: str) -> Document:
    raise NotImplementedError


def unweld(document: Document, name: str) -> Document:
    raise NotImplementedError


def set_pinned(document: Document, names: Iterable[str], pinned: bool) -> Document:
    raise NotImplementedError


def cut_springs(document: Document, names: Iterable[str]) -> Document:
    raise NotImplementedError
