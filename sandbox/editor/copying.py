"""Copies: as text, pasted, duplicated, in a row and in a circle."""

from sandbox.editor.document import Document

Point = tuple[float, float]


def paste(document: Document, text: str, at: Point | None = None) -> Document:
    raise NotImplementedError


def duplicate(document: Document, dx: float, dy: float) -> Document:
    raise NotImplementedError


def array_line(document: Document, count: int, dx: float, dy: float) -> Document:
    raise NotImplementedError


def array_circle(document: Document, count: int, centre: Point, angle: float) -> Document:
    raise NotImplementedError


def copy_text(document: Document) -> str:
    raise NotImplementedError
