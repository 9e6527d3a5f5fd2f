"""Splits triangles along a polyline: its points lie on their sides, and every triangle between two of them is divided.

A point on the line becomes two vertices, one for each side of it, but for its ends inside of the mesh. Then short sides
collapse, while that turns no triangle over, makes none too thin and moves no border: a vertex of the mesh that is near
the line moves onto it, and of new ones that are near each other one is left. So no sliver stays, and few vertices are
new. All of it happens in two places at once: in the form at rest, and where the mesh is now.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arrays import Flags, FloatRows, Floats, SlotRows, Slots
from sandbox.physics.jit import inner_kernel

# Entries of `counts`.
VERTICES, TRIANGLES, OPENINGS = range(3)
# Sides collapse that are shorter than this share of the spacing. Longer ones leave as few new vertices, and bend the
# mesh about the line more.
SHORT = 0.7
# What a triangle has of the square of its longest side, at least, where a collapse changed it: an even one has 0.43,
# half a square 0.25. Higher leaves more short sides, lower leaves thinner triangles.
# A thinner one may become thinner by this factor.
LEAST_SHARE, THINNER = 0.1, 0.9
# How far from straight a line may be where a point of it goes [spacings]: of the line, before both sides of it part;
# and of a border, which keeps the area inside.
STRAIGHT, AS_STRAIGHT = 0.01, 1e-9
# The same in the form, which bends where the mesh is deformed.
STRAIGHT_AT_REST = 0.1


class SplitMesh(NamedTuple):
    """Triangles about a line. The first vertices are those of the mesh; of a new one row is -1.

    one, other, share: it lies there on the side between two particles, as its place in the mesh was before.
    """

    row: Annotated[Slots, "vertices"]  # particle
    one: Annotated[Slots, "vertices"]
    other: Annotated[Slots, "vertices"]
    share: Annotated[Floats, "vertices"]
    spring: Annotated[Slots, "vertices"]  # along the side that it lies on; -1: it has not moved
    at: Annotated[FloatRows, "vertices, 2"]  # [m] where it is now
    form: Annotated[FloatRows, "vertices, 2"]  # [m] where it is at rest
    inward: Annotated[FloatRows, "vertices, 2"]  # from the line
    is_fixed: Annotated[Flags, "vertices"]
    corner: Annotated[SlotRows, "triangles, 3"]  # vertices, counter-clockwise at rest
    joined: Annotated[SlotRows, "triangles, 3"]  # the same, before points of the line became two
    source: Annotated[Slots, "triangles"]  # the constraint that it is, or is a part of
    is_part: Annotated[Flags, "triangles"]
    is_there: Annotated[Flags, "triangles"]
    opening: Annotated[SlotRows, "triangles, 2"]  # pieces of the line, between two vertices
    counts: Annotated[Slots, "3"]
    mark: Annotated[Slots, "vertices"]
    fan: Annotated[Slots, "triangles"]
    label: Annotated[Slots, "triangles"]


@inner_kernel
def add_vertex(
    mesh: SplitMesh, row: int, one: int, other: int, share: float, spring: int, is_fixed: bool
) -> int:  # fmt: skip
    """Add a vertex, whose places are to be filled in; its number."""
    v = mesh.counts[VERTICES]
    mesh.counts[VERTICES] = v + 1
    mesh.row[v], mesh.one[v], mesh.other[v], mesh.share[v] = row, one, other, share
    mesh.spring[v], mesh.is_fixed[v] = spring, is_fixed
    return v


@inner_kernel
def _add(mesh: SplitMesh, a: int, b: int, c: int, source: int, is_part: bool) -> None:
    t = mesh.counts[TRIANGLES]
    mesh.counts[TRIANGLES] = t + 1
    mesh.corner[t, 0], mesh.corner[t, 1], mesh.corner[t, 2] = a, b, c
    mesh.joined[t, 0], mesh.joined[t, 1], mesh.joined[t, 2] = a, b, c
    mesh.source[t], mesh.is_part[t], mesh.is_there[t] = source, is_part, True


@inner_kernel
def add_triangle(mesh: SplitMesh, a: int, b: int, c: int, p: int, q: int, r: int, source: int) -> None:
    """Add a triangle a b c, divided by the vertices p, q and r on a b, b c and c a, of which -1 is none."""
    count = int(p >= 0) + int(q >= 0) + int(r >= 0)
    for _turn in range(2):
        if (count == 1 and p < 0) or (count == 2 and q >= 0):
            a, b, c = b, c, a
            p, q, r = q, r, p
    if count == 0:
        _add(mesh, a, b, c, source, False)
        return
    if count == 1:
        _add(mesh, a, p, c, source, True)
        _add(mesh, p, b, c, source, True)
        return
    _add(mesh, a, p, r, source, True)
    if count == 3:
        # The line comes by more than once: it ends at each side.
        _add(mesh, p, b, q, source, True)
        _add(mesh, q, c, r, source, True)
        _add(mesh, p, q, r, source, True)
        return
    # Of the two ways to halve what is left that whose worst triangle is better.
    one = min(_share(p, b, c, mesh.form), _share(p, c, r, mesh.form))
    if one > min(_share(p, b, r, mesh.form), _share(b, c, r, mesh.form)):
        _add(mesh, p, b, c, source, True)
        _add(mesh, p, c, r, source, True)
    else:
        _add(mesh, p, b, r, source, True)
        _add(mesh, b, c, r, source, True)
    k = mesh.counts[OPENINGS]
    mesh.counts[OPENINGS] = k + 1
    mesh.opening[k, 0], mesh.opening[k, 1] = p, r


@inner_kernel
def _squared(v: int, w: int, place: FloatRows) -> float:
    x, y = place[w, 0] - place[v, 0], place[w, 1] - place[v, 1]
    return x * x + y * y


@inner_kernel
def open_line(mesh: SplitMesh) -> None:
    """Part the triangles on both sides of the line: of its vertices each side gets its own."""
    for v in range(mesh.counts[VERTICES]):
        if mesh.row[v] < 0:
            _part_fans(mesh, v, _list_fans(mesh, v))


@inner_kernel
def _list_fans(mesh: SplitMesh, v: int) -> int:
    # List the triangles at a vertex, those that hang together by sides under one label; how many.
    count = 0
    for t in range(mesh.counts[TRIANGLES]):
        if mesh.is_there[t] and v in (mesh.joined[t, 0], mesh.joined[t, 1], mesh.joined[t, 2]):
            mesh.fan[count], mesh.label[count] = t, count
            count += 1
    changes = True
    while changes:
        changes = False
        for i in range(count):
            for j in range(count):
                if mesh.label[i] < mesh.label[j] and _hang_together(mesh, v, mesh.fan[i], mesh.fan[j]):
                    mesh.label[j] = mesh.label[i]
                    changes = True
    return count


@inner_kernel
def _hang_together(mesh: SplitMesh, v: int, one: int, other: int) -> bool:
    for k in range(3):
        w = mesh.joined[one, k]
        if w != v and w in (mesh.joined[other, 0], mesh.joined[other, 1], mesh.joined[other, 2]):
            is_open = False
            for o in range(mesh.counts[OPENINGS]):
                first, last = mesh.opening[o, 0], mesh.opening[o, 1]
                is_open = is_open or (first == v and last == w) or (first == w and last == v)
            if not is_open:
                return True
    return False


@inner_kernel
def _part_fans(mesh: SplitMesh, v: int, count: int) -> None:
    # All fans at a vertex but the first get a vertex of their own.
    for i in range(1, count):
        if mesh.label[i] != i:
            continue
        own = add_vertex(mesh, -1, mesh.one[v], mesh.other[v], mesh.share[v], mesh.spring[v], False)
        for axis in range(2):
            mesh.at[own, axis], mesh.form[own, axis] = mesh.at[v, axis], mesh.form[v, axis]
        for j in range(i, count):
            for k in range(3):
                if mesh.label[j] == i and mesh.joined[mesh.fan[j], k] == v:
                    mesh.corner[mesh.fan[j], k] = own


@inner_kernel
def collapse_short(mesh: SplitMesh, spacing: float) -> None:
    """Collapse short sides of what is divided, the shortest first, while there is one that may."""
    while True:
        shortest, x, y = SHORT * SHORT * spacing * spacing, -1, -1
        for t in range(mesh.counts[TRIANGLES]):
            for k in range(6 if mesh.is_there[t] and mesh.is_part[t] else 0):
                v, w = mesh.corner[t, k % 3], mesh.corner[t, (k % 3 + 1 + k // 3) % 3]
                squared = _squared(v, w, mesh.form)
                if squared < shortest and _may_collapse(mesh, v, w, spacing):
                    shortest, x, y = squared, v, w
        if x < 0:
            return
        if mesh.row[x] >= 0:
            mesh.row[y] = mesh.row[x]
        _collapse(mesh, x, y)


@inner_kernel
def smooth_line(mesh: SplitMesh, spacing: float) -> None:
    """Leave out points of the line that are near others and as good as straight between two, before it is open."""
    k = 0
    while k < 2 * mesh.counts[OPENINGS]:
        x, y = mesh.opening[k // 2, k % 2], mesh.opening[k // 2, 1 - k % 2]
        z = _beyond(mesh, x, y)
        is_near = _squared(x, y, mesh.form) < SHORT * SHORT * spacing * spacing
        if z >= 0 and is_near and _lies_between(x, y, z, STRAIGHT * spacing, mesh.at) and _may_move(mesh, x, y, 0):
            last = mesh.counts[OPENINGS] - 1
            for axis in range(2):
                mesh.opening[k // 2, axis] = mesh.opening[last, axis]
            mesh.counts[OPENINGS] = last
            for o in range(last):
                for axis in range(2):
                    mesh.opening[o, axis] = y if mesh.opening[o, axis] == x else mesh.opening[o, axis]
            _collapse(mesh, x, y)
            k = 0
        else:
            k += 1


@inner_kernel
def set_back(mesh: SplitMesh, way: float) -> None:
    """Move the border along the line inwards by a way [m], in the form and as it is now."""
    for now in range(2):
        place = mesh.at if now == 1 else mesh.form
        for v in range(mesh.counts[VERTICES]):
            mesh.inward[v, 0] = mesh.inward[v, 1] = 0.0
        for t in range(mesh.counts[TRIANGLES]):
            for k in range(3 if mesh.is_there[t] else 0):
                v, w = mesh.corner[t, k], mesh.corner[t, (k + 1) % 3]
                # Two points of one side that was cut lie on the old border.
                if mesh.spring[v] >= 0 and mesh.spring[w] >= 0 and _along(mesh, v, w) == 1:
                    x, y = place[w, 0] - place[v, 0], place[w, 1] - place[v, 1]
                    length = math.sqrt(x * x + y * y)
                    for end in range(2 if length > 0.0 else 0):
                        p = v if end == 0 else w
                        mesh.inward[p, 0] -= y / length
                        mesh.inward[p, 1] += x / length
        for v in range(mesh.counts[VERTICES]):
            x, y = mesh.inward[v, 0], mesh.inward[v, 1]
            length = math.sqrt(x * x + y * y)
            if length > 0.0:
                place[v, 0] += way * x / length
                place[v, 1] += way * y / length


@inner_kernel
def _along(mesh: SplitMesh, v: int, w: int) -> int:
    # How many triangles have a side from v to w, either way.
    count = 0
    for t in range(mesh.counts[TRIANGLES]):
        count += int(mesh.is_there[t] and _has(mesh, t, v) and _has(mesh, t, w))
    return count


@inner_kernel
def _beyond(mesh: SplitMesh, x: int, y: int) -> int:
    # Where the line goes on that comes from y to x, inside of the mesh; -1: nowhere, or there are several.
    count, beyond = 0, -1
    for o in range(mesh.counts[OPENINGS]):
        for axis in range(2):
            if mesh.opening[o, axis] == x:
                count += 1
                beyond = mesh.opening[o, 1 - axis] if mesh.opening[o, 1 - axis] != y else beyond
    return beyond if count == 2 else -1


@inner_kernel
def _collapse(mesh: SplitMesh, x: int, y: int) -> None:
    for t in range(mesh.counts[TRIANGLES]):
        if mesh.is_there[t] and _has(mesh, t, x):
            mesh.is_there[t] = not _has(mesh, t, y)
            for k in range(3):
                if mesh.corner[t, k] == x:
                    mesh.corner[t, k] = y
                if mesh.joined[t, k] == x:
                    mesh.joined[t, k] = y


@inner_kernel
def _has(mesh: SplitMesh, t: int, v: int) -> bool:
    return v in (mesh.corner[t, 0], mesh.corner[t, 1], mesh.corner[t, 2])


@inner_kernel
def _list_star(mesh: SplitMesh, v: int, w: int, first: int) -> int:
    # List the triangles at a vertex but not at w, from a place of `fan` on; the place behind them.
    for t in range(mesh.counts[TRIANGLES]):
        if mesh.is_there[t] and _has(mesh, t, v) and (w < 0 or not _has(mesh, t, w)):
            mesh.fan[first] = t
            first += 1
    return first


@inner_kernel
def _may_collapse(mesh: SplitMesh, x: int, y: int, spacing: float) -> bool:
    # Whether vertex x may go to where y is: one of them is new, and the border runs as before.
    if mesh.row[x] >= 0 and (mesh.row[y] >= 0 or mesh.is_fixed[x]):
        return False
    count = _list_star(mesh, x, -1, 0)
    rims, beyond, along = 0, -1, False
    for i in range(count):
        for k in range(3):
            w = mesh.corner[mesh.fan[i], k]
            if w != x and _beside(mesh, w, count) == 1:
                rims += 1
                along = along or w == y
                beyond = w if w != y else beyond
    if rims > 0:
        if rims != 2 or not along or not _lies_between(x, y, beyond, AS_STRAIGHT * spacing, mesh.at):
            return False
        if not _lies_between(x, y, beyond, (STRAIGHT_AT_REST if mesh.row[x] < 0 else AS_STRAIGHT) * spacing, mesh.form):
            return False
    return _may_move(mesh, x, y, count)


@inner_kernel
def _beside(mesh: SplitMesh, w: int, count: int) -> int:
    beside = 0
    for i in range(count):
        beside += int(_has(mesh, mesh.fan[i], w))
    return beside


@inner_kernel
def _may_move(mesh: SplitMesh, x: int, y: int, count: int) -> bool:
    # Whether what hangs together still does with x where y is, and is as good as before. count: triangles at x, which
    # are listed; 0: they are not.
    count = count if count > 0 else _list_star(mesh, x, -1, 0)
    last = _list_star(mesh, y, x, count)
    shared, common = 0, 0
    worst, worst_now, after, after_now = 1.0, 1.0, 1.0, 1.0
    for i in range(count):
        t = mesh.fan[i]
        worst = min(worst, _share_of(mesh, t, x, x, mesh.form))
        worst_now = min(worst_now, _share_of(mesh, t, x, x, mesh.at))
        if _has(mesh, t, y):
            shared += 1
        else:
            after = min(after, _share_of(mesh, t, x, y, mesh.form))
            after_now = min(after_now, _share_of(mesh, t, x, y, mesh.at))
        for k in range(3):
            mesh.mark[mesh.corner[t, k]] = 1
    for i in range(count):
        for k in range(3):
            w = mesh.corner[mesh.fan[i], k]
            if w not in (x, y) and mesh.mark[w] == 1 and _is_beside(mesh, y, w, count, last):
                mesh.mark[w] = 2
                common += 1
    for i in range(count):
        for k in range(3):
            mesh.mark[mesh.corner[mesh.fan[i], k]] = 0
    if common != shared or shared == count:
        return False
    if not after > 0.0 or after < min(LEAST_SHARE, THINNER * worst):
        return False
    # What is turned over now may stay so.
    return after_now >= min(LEAST_SHARE, THINNER * worst_now if worst_now > 0.0 else worst_now)


@inner_kernel
def _is_beside(mesh: SplitMesh, y: int, w: int, count: int, last: int) -> bool:
    # Whether a triangle has both y and w, of those at x, and those at y alone.
    for i in range(last):
        t = mesh.fan[i]
        if _has(mesh, t, w) and (i >= count or _has(mesh, t, y)):
            return True
    return False


@inner_kernel
def _lies_between(x: int, y: int, z: int, allowed: float, place: FloatRows) -> bool:
    # Whether x is no farther than allowed [m] from the line between y and z, and between them.
    ux, uy = place[z, 0] - place[y, 0], place[z, 1] - place[y, 1]
    vx, vy = place[x, 0] - place[y, 0], place[x, 1] - place[y, 1]
    along, squared = ux * vx + uy * vy, ux * ux + uy * uy
    return 0.0 <= along <= squared and abs(ux * vy - uy * vx) <= allowed * math.sqrt(squared)


@inner_kernel
def _share_of(mesh: SplitMesh, t: int, x: int, y: int, place: FloatRows) -> float:
    # `_share` of a triangle with its corner x at the place of y.
    a, b, c = mesh.corner[t, 0], mesh.corner[t, 1], mesh.corner[t, 2]
    return _share(y if a == x else a, y if b == x else b, y if c == x else c, place)


@inner_kernel
def _share(a: int, b: int, c: int, place: FloatRows) -> float:
    # What a triangle has of the square of its longest side.
    ux, uy = place[b, 0] - place[a, 0], place[b, 1] - place[a, 1]
    vx, vy = place[c, 0] - place[a, 0], place[c, 1] - place[a, 1]
    longest = max(max(ux * ux + uy * uy, vx * vx + vy * vy), _squared(b, c, place))
    return 0.5 * (ux * vy - uy * vx) / longest if longest > 0.0 else 0.0
