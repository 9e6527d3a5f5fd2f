"""Moving, turning, scaling, mirroring and lining up what is selected."""

from typing import Literal

from sandbox.editor.document import Document

Point = tuple[float, float]


def move(document: Document, dx: float, dy: float) -> Document:
    raise NotImplementedError


def rotate(document: Document, angle: float, centre: Point) -> Document:
    raise NotImplementedError


def scale(document: Document, sx: float, sy: float, centre: Point) -> Document:
    raise NotImplementedError


def mirror(document: Document, axis: Literal["x", "y"], centre: Point) -> Document:
    raise NotImplementedError


def align(document: Document, edge: Literal["left", "right", "top", "bottom", "centre_x", "centre_y"]) -> Document:
    raise NotImplementedError


def distribute(document: Document, axis: Literal["x", "y"]) -> Document:
    raise NotImplementedError


def can_scale_unevenly(document: Document) -> bool:
    raise NotImplementedError
