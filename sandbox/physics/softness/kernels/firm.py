"""Makes a body of a world, or a piece of one that was cut, soft as a whole.

Bodies that may be stiff by their form have numbers, and their pieces have: the largest piece takes the number of its
body, the others come after all bodies, so that a cut moves no number of what it does not touch. Pieces that keep no
area, crumbs and threads, are none.
"""

from typing import Annotated, NamedTuple

import numpy as np

from sandbox.physics.arena import (
    FIRST_ARENA,
    Arena,
    begin,
    give_back,
    is_full,
    lay_out,
    mark,
    new_flags,
    new_floats,
    new_slots,
    new_tuple,
)
from sandbox.physics.arrays import Flags, Floats, SlotRows, Slots, empty, with_empty
from sandbox.physics.constraints import AREA
from sandbox.physics.equation import of_springs
from sandbox.physics.jit import Bundle, bundle, inner_kernel, items_of, kernel, set_field, unpack
from sandbox.physics.keeping.equipment import FirmBody, StiffForm, design_gravity, height_along
from sandbox.physics.ramps import set_constraint, set_spring
from sandbox.physics.softness.kernels.lowest_mode import CORNERS, NO_MODE, lowest_mode_in
from sandbox.physics.softness.kernels.reach import FIRMED, NO_BODY, NO_ROOM, NOT_STIFF, Asked, Reach, share_out
from sandbox.physics.state import GoodValues, State, StateArrays, good_of, state_of
from sandbox.physics.topology.sorting import place_among, sort_by_value

# Columns of `first`: where the rows of a body begin.
POINTS, SPRINGS, CONSTRAINTS, AREAS, BENDS, KINDS_OF_ROWS = range(6)
# In place of a mode that is kept: it was not looked for yet; the form is not stiff.
UNKNOWN, NONE = 0.0, -1.0


class Forms(NamedTuple):
    """The forms of b bodies that may be stiff without pins, whose rows lie one after another: bodies with more join.

    first (b + 1, 5): see POINTS. shapes: their points, and pairs, areas and bends by numbers of points of the body.
    spring, constraint: slots, the latter of what has three corners.
    """

    first: SlotRows
    shapes: StiffForm
    spring: Slots
    constraint: Slots


class FormModes(NamedTuple):
    """Measures kept of forms, which are no state: lowest modes, see UNKNOWN, of bodies (b,) and of their pieces.

    piece (n,): the k-th of a body is that of its k-th piece. point (n,), spring (m,), constraint (k,): the piece that
    each of its rows was of then, -1: of none.
    """

    body: Floats
    piece: Floats
    point: Slots
    spring: Slots
    constraint: Slots


class Pieces(NamedTuple):
    """The pieces of a body: which piece each point (n,), spring (m,) and constraint (k,) is of, -1: of none.

    slot: particle of each point, and behind those the particles that cuts have added. owner: of each piece. total (1,):
    pieces. is_split (1,): whether a cut has added anything to the body, which is no row of its form.
    """

    point: Annotated[Slots, "points"]
    spring: Annotated[Slots, "springs"]
    constraint: Annotated[Slots, "constraints"]
    slot: Annotated[Slots, "members"]
    owner: Annotated[Slots, "members"]
    total: Annotated[Slots, "1"]
    is_split: Annotated[Flags, "1"]


class Owners(NamedTuple):
    """Scratch: of_point (n,); then the owners of a body's points, ascending.

    fewer: points of each, counted below 0; piece: its number as a piece, -1: none.
    """

    of_point: Annotated[Slots, "points"]
    owner: Annotated[Slots, "points"]
    fewer: Annotated[Slots, "points"]
    piece: Annotated[Slots, "points"]
    order: Annotated[Slots, "points"]
    merge_buffer: Annotated[Slots, "points"]


class FormPiece(NamedTuple):
    """A body or a piece: its form, and the slots of its springs and constraints."""

    form: StiffForm
    spring: Annotated[Slots, "springs"]
    constraint: Annotated[Slots, "triangles + turns"]


class Firmable(NamedTuple):
    """The arrays that `firm` changes and reads, and the piece that `take_piece` lays out."""

    state: State
    good: GoodValues
    forms: Forms
    modes: FormModes
    piece: FormPiece


class Firming(NamedTuple):
    """A request to make a body soft: the values, under gravity [m/s^2] at a tick rate [1/s], in so many ticks."""

    asked: Asked
    gravity_x: float
    gravity_y: float
    tick_rate: float
    duration: int


@inner_kernel
def _rows_of(forms: Forms, body: int, kind: int) -> int:
    return forms.first[body + 1, kind] - forms.first[body, kind]


@inner_kernel
def _new_pieces(state: State, forms: Forms, body: int, arena: Arena) -> Pieces:
    # The pieces of a body as it is now.
    points, springs = _rows_of(forms, body, POINTS), _rows_of(forms, body, SPRINGS)
    constraints = _rows_of(forms, body, CONSTRAINTS)
    is_own = new_flags(arena, state.owner.shape[0])
    first, members = forms.first[body, SPRINGS], points
    if not is_full(arena):
        for row in range(first, first + springs):
            is_own[state.particle_a[forms.spring[row]]] = is_own[state.particle_b[forms.spring[row]]] = True
        for p in range(state.owner.shape[0]):
            members += int(_is_added_to(state, is_own, p))
    made = new_tuple(Pieces, arena, points=points, springs=springs, constraints=constraints, members=members)
    scratch = mark(arena)
    owners = new_tuple(Owners, arena, points=members)
    if is_full(arena):
        return made
    made.total[0] = 1
    made.is_split[0] = members > points
    is_cut = False
    for p in range(state.owner.shape[0]):
        if _is_added_to(state, is_own, p):
            members -= 1
            made.slot[members] = p
    for row in range(first, first + springs):
        s = forms.spring[row]
        made.slot[forms.shapes.pairs[row, 0]] = state.particle_a[s]
        made.slot[forms.shapes.pairs[row, 1]] = state.particle_b[s]
        is_cut = is_cut or not state.spring_active[s]
    if is_cut:
        count = _list_owners(state, made.slot, owners)
        pieces = _number_pieces(state, forms, body, count, owners)
        if pieces > 1 or (pieces == 1 and made.is_split[0]):
            made.total[0] = pieces
            for at in range(count):
                if owners.piece[at] >= 0:
                    made.owner[owners.piece[at]] = owners.owner[at]
            _part(state, forms, body, count, owners, made)
    give_back(arena, scratch)
    return made


@inner_kernel
def _is_added_to(state: State, is_own: Flags, p: int) -> bool:
    # Whether a cut has added a particle to a body.
    return 0 <= state.split_from[p] < is_own.shape[0] and is_own[state.split_from[p]]


@inner_kernel
def _list_owners(state: State, slot: Slots, owners: Owners) -> int:
    # The owners of the points of a body; how many.
    points, count = slot.shape[0], 0
    for i in range(points):
        owners.of_point[i], owners.order[i] = state.owner[slot[i]], i
    sort_by_value(owners.of_point, owners.order, 0, points, owners.merge_buffer)
    for at in range(points):
        owner = owners.of_point[owners.order[at]]
        if count == 0 or owners.owner[count - 1] != owner:
            owners.owner[count], owners.fewer[count], owners.piece[count] = owner, 0, -1
            count += 1
        owners.fewer[count - 1] -= 1
    return count


@inner_kernel
def _number_pieces(state: State, forms: Forms, body: int, count: int, owners: Owners) -> int:
    # Owners that keep an area are pieces, those of more points first, then by owner; how many.
    for k in range(state.constraint_kind.shape[0] if forms.first[body, POINTS] < forms.first[body + 1, POINTS] else 0):
        is_area = state.constraint_kind[k] == AREA and state.constraint_corners[k] == CORNERS
        if state.constraint_active[k] and is_area:
            at = _place_of(state, state.corner_particle[state.constraint_first[k]], owners, count)
            if at >= 0:
                owners.piece[at] = 0
    pieces = 0
    for at in range(count):
        if owners.piece[at] == 0:
            owners.order[pieces] = at
            pieces += 1
    sort_by_value(owners.fewer, owners.order, 0, pieces, owners.merge_buffer)
    for number in range(pieces):
        owners.piece[owners.order[number]] = number
    return pieces


@inner_kernel
def _place_of(state: State, p: int, owners: Owners, count: int) -> int:
    # Where the owner of a particle is among those of a body; -1: nowhere.
    at = place_among(state.owner[p], owners.owner, 0, count)
    return at if at < count and owners.owner[at] == state.owner[p] else -1


@inner_kernel
def _piece_of(state: State, p: int, owners: Owners, count: int) -> int:
    at = _place_of(state, p, owners, count)
    return owners.piece[at] if at >= 0 else -1


@inner_kernel
def _part(state: State, forms: Forms, body: int, count: int, owners: Owners, made: Pieces) -> None:
    # What of a body is of which piece.
    for i in range(made.point.shape[0]):
        made.point[i] = _piece_of(state, made.slot[i], owners, count)
    for row in range(made.spring.shape[0]):
        s = forms.spring[forms.first[body, SPRINGS] + row]
        one = _piece_of(state, state.particle_a[s], owners, count)
        is_whole = state.spring_active[s] and one == _piece_of(state, state.particle_b[s], owners, count)
        made.spring[row] = one if is_whole else -1
    for row in range(made.constraint.shape[0]):
        k = forms.constraint[forms.first[body, CONSTRAINTS] + row]
        first = state.constraint_first[k]
        one = _piece_of(state, state.corner_particle[first], owners, count)
        is_whole = state.constraint_active[k]
        for c in range(first + 1, first + CORNERS):
            is_whole = is_whole and one == _piece_of(state, state.corner_particle[c], owners, count)
        made.constraint[row] = one if is_whole else -1


@inner_kernel
def _whole(forms: Forms, body: int) -> FormPiece:
    begins, ends, shapes = forms.first[body : body + 1], forms.first[body + 1 : body + 2], forms.shapes
    return FormPiece(
        StiffForm(
            shapes.points[begins[0, POINTS] : ends[0, POINTS]],
            shapes.mass[begins[0, POINTS] : ends[0, POINTS]],
            shapes.pairs[begins[0, SPRINGS] : ends[0, SPRINGS]],
            shapes.areas[begins[0, AREAS] : ends[0, AREAS]],
            shapes.bends[begins[0, BENDS] : ends[0, BENDS]],
        ),
        forms.spring[begins[0, SPRINGS] : ends[0, SPRINGS]],
        forms.constraint[begins[0, CONSTRAINTS] : ends[0, CONSTRAINTS]],
    )


@inner_kernel
def _new_piece(state: State, forms: Forms, body: int, number: int, pieces: Pieces, arena: Arena) -> FormPiece:
    # A piece of a body that was cut: what of its rows is of it, and behind that what cuts have added.
    whole, owner = _whole(forms, body), pieces.owner[number]
    index, is_listed = new_slots(arena, state.owner.shape[0]), new_flags(arena, state.constraint_kind.shape[0])
    if is_full(arena):
        return whole
    points, springs, areas, bends = 0, 0, 0, 0
    for i in range(pieces.point.shape[0]):
        index[pieces.slot[i]] = -1
        points += int(pieces.point[i] == number)
    for row in range(pieces.spring.shape[0]):
        springs += int(pieces.spring[row] == number)
    for row in range(pieces.constraint.shape[0]):
        is_listed[whole.constraint[row]] = True
        if pieces.constraint[row] == number:
            is_area = state.constraint_kind[whole.constraint[row]] == AREA
            areas, bends = areas + int(is_area), bends + int(not is_area)
    if pieces.is_split[0]:
        for p in range(state.owner.shape[0]):
            points += int(index[p] == 0 and state.particle_active[p] and state.owner[p] == owner)
        for s in range(state.law.shape[0]):
            springs += int(_is_added(state, s, owner))
        for k in range(state.constraint_kind.shape[0]):
            areas += int(not is_listed[k] and _is_area_of(state, k, owner))
    made = new_tuple(FormPiece, arena, particles=points, springs=springs, triangles=areas, turns=bends)
    if not is_full(arena):
        _fill_points(state, whole, number, pieces, index, made.form)
        _fill_piece(state, whole, number, pieces, index, made)
        if pieces.is_split[0]:
            _fill_added(state, owner, index, is_listed, made)
    return made


@inner_kernel
def _is_added(state: State, s: int, owner: int) -> bool:
    a, b = state.owner[state.particle_a[s]], state.owner[state.particle_b[s]]
    return state.is_split[s] and state.spring_active[s] and a == owner and b == owner


@inner_kernel
def _is_area_of(state: State, k: int, owner: int) -> bool:
    if state.constraint_kind[k] != AREA or state.constraint_corners[k] != CORNERS or not state.constraint_active[k]:
        return False
    return state.owner[state.corner_particle[state.constraint_first[k]]] == owner


@inner_kernel
def _fill_points(state: State, whole: FormPiece, number: int, pieces: Pieces, index: Slots, form: StiffForm) -> None:
    # index: by particle, -1 of those of the body; 1 + the number of its point from then on.
    count = 0
    for i in range(pieces.point.shape[0]):
        if pieces.point[i] == number:
            index[pieces.slot[i]] = count + 1
            form.points[count, 0], form.points[count, 1] = whole.form.points[i, 0], whole.form.points[i, 1]
            form.mass[count] = whole.form.mass[i]
            count += 1
    for p in range(state.owner.shape[0] if pieces.is_split[0] else 0):
        if index[p] == 0 and state.particle_active[p] and state.owner[p] == pieces.owner[number]:
            count += 1
            index[p] = count
    # What a cut has moved is where the corners of areas are at rest, and as heavy as it is now.
    for k in range(state.constraint_kind.shape[0] if pieces.is_split[0] else 0):
        if _is_area_of(state, k, pieces.owner[number]):
            for c in range(state.constraint_first[k], state.constraint_first[k] + CORNERS):
                at = index[state.corner_particle[c]] - 1
                form.points[at, 0], form.points[at, 1] = state.corner_form[c, 0], state.corner_form[c, 1]
                form.mass[at] = state.mass[state.corner_particle[c]]


@inner_kernel
def _fill_added(state: State, owner: int, index: Slots, is_listed: Flags, made: FormPiece) -> None:
    springs, areas = made.spring.shape[0], made.form.areas.shape[0]
    for back in range(state.law.shape[0]):
        s = state.law.shape[0] - 1 - back
        if _is_added(state, s, owner):
            springs -= 1
            made.spring[springs] = s
            made.form.pairs[springs, 0] = index[state.particle_a[s]] - 1
            made.form.pairs[springs, 1] = index[state.particle_b[s]] - 1
    last = made.constraint.shape[0]
    for back in range(state.constraint_kind.shape[0]):
        k = state.constraint_kind.shape[0] - 1 - back
        if not is_listed[k] and _is_area_of(state, k, owner):
            areas -= 1
            last -= 1
            made.constraint[last] = k
            for i in range(CORNERS):
                made.form.areas[areas, i] = index[state.corner_particle[state.constraint_first[k] + i]] - 1


@inner_kernel
def _fill_piece(state: State, whole: FormPiece, number: int, pieces: Pieces, index: Slots, made: FormPiece) -> None:
    # index: 1 + the point of each particle.
    form, count = made.form, 0
    for row in range(pieces.spring.shape[0]):
        if pieces.spring[row] == number:
            s = whole.spring[row]
            form.pairs[count, 0], form.pairs[count, 1] = index[state.particle_a[s]] - 1, index[state.particle_b[s]] - 1
            made.spring[count] = s
            count += 1
    areas, bends = 0, 0
    for row in range(pieces.constraint.shape[0]):
        if pieces.constraint[row] != number:
            continue
        k = whole.constraint[row]
        made.constraint[areas + bends] = k
        is_area = state.constraint_kind[k] == AREA
        for i in range(CORNERS):
            corner = index[state.corner_particle[state.constraint_first[k] + i]] - 1
            if is_area:
                form.areas[areas, i] = corner
            else:
                form.bends[bends, i] = corner
        areas, bends = areas + int(is_area), bends + int(not is_area)


@inner_kernel
def body_of_number(state: State, forms: Forms, number: int, arena: Arena) -> tuple[int, int]:
    """The body of a number, and which piece of it; -1: none; where the arena is full, any."""
    bodies = forms.first.shape[0] - 1
    if number < bodies:
        return max(number, -1), 0
    after = number - bodies
    for body in range(bodies):
        scratch = mark(arena)
        pieces = _new_pieces(state, forms, body, arena)
        if is_full(arena):
            return -1, 0
        count = pieces.total[0]
        give_back(arena, scratch)
        if after < count - 1:
            return body, after + 1
        after -= count - 1
    return -1, 0


@inner_kernel
def _follow(pieces: Pieces, forms: Forms, body: int, modes: FormModes) -> None:
    # Forget the modes of pieces that are others now.
    point, spring = forms.first[body, POINTS], forms.first[body, SPRINGS]
    constraint = forms.first[body, CONSTRAINTS]
    is_same = _take_over(pieces.point, modes.point, point)
    is_same = _take_over(pieces.spring, modes.spring, spring) and is_same
    is_same = _take_over(pieces.constraint, modes.constraint, constraint) and is_same
    if not is_same:
        for i in range(pieces.point.shape[0]):
            modes.piece[point + i] = UNKNOWN


@inner_kernel
def _take_over(now: Slots, kept: Slots, first: int) -> bool:
    # Whether they are the same already.
    is_same = True
    for i in range(now.shape[0]):
        is_same = is_same and kept[first + i] == now[i]
        kept[first + i] = now[i]
    return is_same


@inner_kernel
def _mode_of(form: StiffForm, kept: Floats, at: int, arena: Arena) -> float:
    # The lowest mode, which is kept there; NO_MODE: the arena is too small.
    if kept[at] == UNKNOWN:
        found = lowest_mode_in(form, arena)
        if found == NO_MODE:
            return NO_MODE
        kept[at] = found if found > 0.0 else NONE
    return max(kept[at], 0.0)


@inner_kernel
def firm(
    state: State, good: GoodValues, forms: Forms, modes: FormModes, arena: Arena, body: int, is_whole: bool,
    firming: Firming, found: Floats,
) -> int:  # fmt: skip
    """Make a body soft by its number, or a piece; whether it is done, see `FIRMED`; of others nothing is changed.

    is_whole: all of a body, whatever was cut of it. found (2,): what `share_out` says.
    """
    begin(arena)
    b, number = body_of_number(state, forms, body, arena)
    if is_full(arena):
        return NO_ROOM
    if b < 0 or (is_whole and body >= forms.first.shape[0] - 1):
        return NO_BODY
    piece, kept, at = _whole(forms, b), modes.body, b
    if not is_whole:
        pieces = _new_pieces(state, forms, b, arena)
        if is_full(arena):
            return NO_ROOM
        if pieces.total[0] > 1 or pieces.is_split[0]:
            _follow(pieces, forms, b, modes)
            piece = _new_piece(state, forms, b, number, pieces, arena)
            kept, at = modes.piece, forms.first[b, POINTS] + number
            if pieces.is_split[0]:
                # What a cut has added is kept nowhere.
                kept, at = new_floats(arena, 1), 0
            if is_full(arena):
                return NO_ROOM
    mode = _mode_of(piece.form, kept, at, arena)
    if mode == NO_MODE:
        return NO_ROOM
    if mode == 0.0:
        return NOT_STIFF
    height = height_along(piece.form.points, firming.gravity_x, firming.gravity_y)
    gravity = design_gravity(firming.gravity_x, firming.gravity_y)
    code = share_out(Reach(mode, height, gravity, 1.0 / firming.tick_rate), firming.asked, found)
    if code != FIRMED:
        return code
    if found[0] == 1.0 and found[1] == 1.0:
        # All of them rigid, which they are alone as well.
        stiffness, damping, mode = 1.0, 1.0, 0.0
    else:
        stiffness, damping = of_springs(found[0], found[1], mode)
    for row in range(piece.spring.shape[0]):
        set_spring(state, good, piece.spring[row], stiffness, damping, mode, firming.duration)
    for row in range(piece.constraint.shape[0]):
        set_constraint(state, good, piece.constraint[row], stiffness, damping, mode, firming.duration)
    return FIRMED


@inner_kernel
def count_pieces_of(state: State, forms: Forms, arena: Arena, count: Slots) -> int:
    """How many pieces each body (b,) is; NO_ROOM: the arena is too small."""
    begin(arena)
    for body in range(count.shape[0]):
        scratch = mark(arena)
        pieces = _new_pieces(state, forms, body, arena)
        if is_full(arena):
            return NO_ROOM
        count[body] = pieces.total[0]
        give_back(arena, scratch)
    return 0


@inner_kernel
def number_of_spring(state: State, forms: Forms, arena: Arena, spring: int) -> int:
    """The number of the body or piece that has a spring; -1: none; where the arena is full, any."""
    begin(arena)
    bodies = forms.first.shape[0] - 1
    after = bodies
    for body in range(bodies):
        scratch = mark(arena)
        pieces = _new_pieces(state, forms, body, arena)
        if is_full(arena):
            return -1
        first = forms.first[body, SPRINGS]
        for row in range(pieces.spring.shape[0]):
            if forms.spring[first + row] == spring and pieces.spring[row] >= 0:
                return body if pieces.spring[row] == 0 else after + pieces.spring[row] - 1
        for number in range(pieces.total[0] if pieces.is_split[0] else 0):
            if 0 <= spring < state.law.shape[0] and _is_added(state, spring, pieces.owner[number]):
                return body if number == 0 else after + number - 1
        after += pieces.total[0] - 1
        give_back(arena, scratch)
    return -1


@kernel
def take_piece(pointer: Bundle[Firmable], arena: Arena, body: int, number: int) -> None:
    """Lay out a piece of a body that was cut."""
    begin(arena)
    made = unpack(pointer)
    pieces = _new_pieces(made.state, made.forms, body, arena)
    if is_full(arena):
        return
    piece = _new_piece(made.state, made.forms, body, number, pieces, arena)
    set_field(made, "piece", piece)


class FormTable:
    """The forms of a world's bodies, with the measures kept of them."""

    forms: Forms
    modes: FormModes
    _bodies: tuple[FirmBody, ...] | None = None

    def __init__(self, _world: StateArrays) -> None:
        self.follow(())

    def follow(self, bodies: tuple[FirmBody, ...]) -> None:
        """Take over bodies that joined the world, or left it."""
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
        pointer = bundle(Firmable(state_of(world), good_of(world), self.forms, self.modes, empty(FormPiece)))
        lay_out(take_piece, pointer, np.zeros(FIRST_ARENA, np.int64), body, number)
        piece: FormPiece = items_of(pointer, ("piece",))
        return piece


def forms_of(bodies: tuple[FirmBody, ...]) -> Forms:
    """Forms of bodies in the arrays of kernels."""
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
