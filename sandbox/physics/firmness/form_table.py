"""The forms of a world's bodies as kernels take them, which follow what joins the world; and kernels called on them."""

from typing import Any

import numpy as np

from sandbox.physics.arena import FIRST_ARENA, lay_out
from sandbox.physics.arrays import empty, with_empty
from sandbox.physics.firmness.firm import (
    KINDS_OF_ROWS,
    NONE,
    Firmable,
    FormModes,
    FormPiece,
    Forms,
    take_piece,
)
from sandbox.physics.jit import bundle, items_of
from sandbox.physics.keeping.forms import FirmBody, StiffForm
from sandbox.physics.state import StateArrays, good_of, state_of


class FormTable:
    """The forms of a world, and what was found of them."""

    forms: Forms
    modes: FormModes
    _bodies: tuple[FirmBody, ...] | None = None

    def __init__(self, _world: StateArrays) -> None:
        self.follow(())

    def follow(self, bodies: tuple[FirmBody, ...]) -> None:
        """Follow what joined the world, or left it."""
        if self._bodies is not bodies:
            self._bodies = bodies
            self.forms = forms_of(bodies)
            points, springs, constraints = self.forms.first[-1, :3].tolist()
            numbers = np.zeros((3, points + springs + constraints), np.int64)
            self.modes = FormModes(
                np.zeros(len(bodies)), np.zeros(points), numbers[0, :points].copy(),
                numbers[1, :springs].copy(), numbers[2, :constraints].copy(),
            )  # fmt: skip

    def know(self, body: int, lowest_mode: float) -> None:
        """Keep the lowest mode of a body, which was found already."""
        self.modes.body[body] = lowest_mode or NONE

    def piece(self, world: StateArrays, body: int, number: int) -> FormPiece:
        """A piece of a body that was cut."""
        pointer = self._lend(world)
        lay_out(take_piece, pointer, np.zeros(FIRST_ARENA, np.int64), body, number)
        piece: FormPiece = items_of(pointer, ("piece",))
        return piece

    def _lend(self, world: StateArrays) -> Any:
        return bundle(Firmable(state_of(world), good_of(world), self.forms, self.modes, empty(FormPiece)))


def forms_of(bodies: tuple[FirmBody, ...]) -> Forms:
    """Bodies as kernels take them."""
    first = np.zeros((len(bodies) + 1, KINDS_OF_ROWS), np.int64)
    if not bodies:
        # Rows have their width also where there are none: a page adds some when a body joins.
        pair, triple = np.zeros((0, 2), np.int64), np.zeros((0, 3), np.int64)
        none = StiffForm(np.zeros((0, 2)), np.zeros(0), pair, triple, triple)
        return with_empty(Forms, first=first, shapes=none)
    for number, body in enumerate(bodies):
        shape = body.shape
        counts = len(shape.points), len(body.springs), len(body.constraints), len(shape.areas), len(shape.bends)
        first[number + 1] = first[number] + counts
    shapes = [np.concatenate(arrays) for arrays in zip(*(body.shape for body in bodies), strict=True)]
    springs, constraints = ([getattr(body, name) for body in bodies] for name in ("springs", "constraints"))
    return Forms(first, StiffForm(*shapes), np.concatenate(springs), np.concatenate(constraints))
