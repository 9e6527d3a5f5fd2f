"""Pieces of bodies whose firmness can be set: each as a body with a form and a name of its own."""

from typing import Any

import numpy as np

from sandbox.physics.arena import FIRST_ARENA, answer_of
from sandbox.physics.commands.command import count_pieces
from sandbox.physics.firmness.form_table import FormTable
from sandbox.physics.keeping.forms import FirmBody, StiffForm
from sandbox.physics.world import World


def firm_bodies(world: World) -> tuple[FirmBody, ...]:
    """The bodies of `World.forms` as they are now, by the numbers of firm.py: of one that was cut its pieces,
    "cube, 1 of 2".
    """
    found: tuple[FirmBody, ...] = world.derived(_find_bodies, of_hands=False)
    return found


def _find_bodies(world: World) -> tuple[FirmBody, ...]:
    table = world.form_table
    counts = np.zeros(len(world.forms), np.int64)
    answer_of(count_pieces, FIRST_ARENA, world.lent, counts)
    pieces = [
        (body,) if count == 1 else tuple(_piece(world, table, number, place, count) for place in range(count))
        for number, (body, count) in enumerate(zip(world.forms, counts.tolist(), strict=True))
    ]
    return (*(each[0] for each in pieces), *(piece for each in pieces for piece in each[1:]))


def _piece(world: World, table: FormTable, number: int, place: int, count: int) -> FirmBody:
    piece = table.piece(world, number, place)
    shape: list[Any] = [np.array(rows) for rows in piece.form]
    name = f"{world.forms[number].name}, {place + 1} of {count}"
    return FirmBody(name, StiffForm(*shape), np.array(piece.spring), np.array(piece.constraint))
