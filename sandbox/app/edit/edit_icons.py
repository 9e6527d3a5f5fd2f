"""Icons of the editor: its tools and what is done with the selection."""

from collections.abc import Callable
from math import cos, pi, sin, tau

from sandbox.app.widgets.pen import Pen


def _select(pen: Pen) -> None:
    pen.shape((6, 3), (6, 18.5), (10, 15), (12.5, 21), (15.2, 19.8), (12.6, 14), (18, 13.4))


def _lasso(pen: Pen) -> None:
    for turn in range(0, 360, 45):
        a, b = turn * pi / 180, (turn + 27) * pi / 180
        pen.line((12 + 8.5 * cos(a), 9.5 + 6 * sin(a)), (12 + 8.5 * cos(b), 9.5 + 6 * sin(b)))
    pen.line((6.5, 14.5), (5, 18), (7, 21))


def _particle(pen: Pen) -> None:
    pen.disc(12, 12, 5)


def _rope(pen: Pen) -> None:
    points = [(4 + 4 * k, 6 + 11 * (1 - ((k - 2) / 2) ** 2)) for k in range(5)]
    pen.line(*points)
    for x, y in points:
        pen.disc(x, y, 2.3)


def _bridge(pen: Pen) -> None:
    pen.line((3, 8), (21, 8))
    pen.line((3, 16), (21, 16))
    for x in (3, 12, 21):
        pen.line((x, 8), (x, 16))
    for x in (3, 12):
        pen.line((x, 8), (x + 9, 16), width=1.3)
        pen.line((x, 16), (x + 9, 8), width=1.3)


def _girder(pen: Pen) -> None:
    pen.line((2.5, 7), (21.5, 7))
    pen.line((7, 17), (17, 17))
    pen.line((2.5, 7), (7, 17), (12, 7), (17, 17), (21.5, 7))


def _web(pen: Pen) -> None:
    for radius in (4.5, 9.5):
        pen.line(*[(12 + radius * cos(tau * k / 6), 12 + radius * sin(tau * k / 6)) for k in range(7)], width=1.6)
    for k in range(6):
        pen.line((12, 12), (12 + 9.5 * cos(tau * k / 6), 12 + 9.5 * sin(tau * k / 6)), width=1.3)


def _box(pen: Pen) -> None:
    for at in (4, 12, 20):
        pen.line((at, 4), (at, 20), width=1.7)
        pen.line((4, at), (20, at), width=1.7)


def _circle(pen: Pen) -> None:
    pen.disc(12, 12, 9, 2)
    pen.line((12, 3.5), (12, 20.5), width=1.4)
    pen.line((3.5, 12), (20.5, 12), width=1.4)


def _polygon(pen: Pen) -> None:
    corners = ((4, 9), (12, 3.5), (20, 8), (17.5, 19), (7, 20), (4, 9))
    pen.line(*corners)
    for x, y in corners:
        pen.disc(x, y, 2.2)


def _wheel(pen: Pen) -> None:
    pen.disc(12, 12, 9.5, 2.6)
    pen.disc(12, 12, 2.6)
    for k in range(6):
        pen.line((12, 12), (12 + 8 * cos(tau * k / 6), 12 + 8 * sin(tau * k / 6)), width=1.4)


def _ground(pen: Pen) -> None:
    pen.shape((3, 20), (3, 13), (8, 8.5), (12, 12), (17, 6), (21, 11), (21, 20))


def _line(pen: Pen) -> None:
    points = ((3, 8), (8, 13), (15, 11), (21, 6))
    pen.line(*points)
    for x, y in ((5, 12.5), (9.5, 15), (14, 14), (18.5, 11)):
        pen.line((x, y), (x - 2.4, y + 4), width=1.4)


def _walls(pen: Pen) -> None:
    pen.line((6.5, 6.5), (17.5, 6.5), (17.5, 17.5), (6.5, 17.5), (6.5, 6.5))
    for at in (8, 12, 16):
        for a, b in (((at, 4.5), (at - 2, 2.5)), ((at, 19.5), (at + 2, 21.5))):
            pen.line(a, b, width=1.4)
            pen.line(a[::-1], b[::-1], width=1.4)


def _ring(pen: Pen) -> None:
    pen.disc(12, 12, 9.5, 2.2)
    for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        pen.line((12 + 1.5 * dx, 12 + 1.5 * dy), (12 + 5.2 * dx, 12 + 5.2 * dy), width=1.5)
        tip = (12 + 5.6 * dx, 12 + 5.6 * dy)
        for side in (-1, 1):
            pen.line(tip, (tip[0] - 1.7 * dx + 1.5 * side * dy, tip[1] - 1.7 * dy + 1.5 * side * dx), width=1.5)


def _edit(pen: Pen) -> None:
    pen.line((5, 19), (6, 14.5), (16, 4.5), (19.5, 8), (9.5, 18), (5, 19))
    pen.line((13.5, 7), (17, 10.5))


def _new(pen: Pen) -> None:
    pen.line((6, 3.5), (14, 3.5), (18.5, 8), (18.5, 20.5), (6, 20.5), (6, 3.5))
    pen.line((13.5, 4), (13.5, 8.5), (18, 8.5), width=1.6)


def _open(pen: Pen) -> None:
    pen.line((3.5, 19), (3.5, 5.5), (9, 5.5), (11, 8), (18.5, 8), (18.5, 11))
    pen.line((3.5, 19), (7, 11.5), (21.5, 11.5), (18, 19), (3.5, 19))


def _duplicate(pen: Pen) -> None:
    pen.line((8.5, 8.5), (20, 8.5), (20, 20), (8.5, 20), (8.5, 8.5))
    pen.line((15, 4), (4, 4), (4, 15))


def _delete(pen: Pen) -> None:
    pen.line((4, 6.5), (20, 6.5))
    pen.line((9, 6), (9.6, 3.5), (14.4, 3.5), (15, 6))
    pen.line((6, 7), (7, 20.5), (17, 20.5), (18, 7))
    pen.line((10.2, 10.5), (10.6, 17), width=1.5)
    pen.line((13.8, 10.5), (13.4, 17), width=1.5)


def _mirror(pen: Pen) -> None:
    pen.shape((9.5, 5), (9.5, 19), (2.5, 19))
    pen.line((14.5, 5), (14.5, 19), (21.5, 19), (14.5, 5), width=1.6)
    pen.line((12, 3), (12, 21), width=1.4)


def _array(pen: Pen) -> None:
    for x in (3, 9.5, 16):
        pen.shape((x, 9.5), (x + 5, 9.5), (x + 5, 14.5), (x, 14.5))


def _group(pen: Pen) -> None:
    for x, dx in ((3.5, 4), (20.5, -4)):
        for y, dy in ((3.5, 4), (20.5, -4)):
            pen.line((x + dx, y), (x, y), (x, y + dy))
    pen.shape((7.5, 7.5), (13, 7.5), (13, 13), (7.5, 13))
    pen.disc(14.5, 14.5, 3.2)


def _align(pen: Pen) -> None:
    pen.line((4, 3.5), (4, 20.5))
    pen.shape((7, 6), (20, 6), (20, 10.5), (7, 10.5))
    pen.shape((7, 13.5), (15, 13.5), (15, 18), (7, 18))


def _order(pen: Pen) -> None:
    pen.line((10, 10), (20.5, 10), (20.5, 20.5), (10, 20.5), (10, 10))
    pen.shape((3.5, 3.5), (14, 3.5), (14, 14), (3.5, 14))


def _snap(pen: Pen) -> None:
    pen.arc(12, 12, 7, 180, 360)
    pen.line((5, 12), (5, 5), width=3.4)
    pen.line((19, 12), (19, 5), width=3.4)
    pen.line((5, 12.5), (5.6, 15), width=3.4)
    pen.line((19, 12.5), (18.4, 15), width=3.4)
    pen.arc(12, 12.5, 6.6, 190, 350)


def _forecast(pen: Pen) -> None:
    pen.line((3.5, 5), (20.5, 5), width=1.8)
    points = [(4 + 2 * k, 5 + 13 * (1 - ((k - 4) / 4) ** 2)) for k in range(9)]
    for a, b in zip(points[::2], points[1::2], strict=False):
        pen.line(a, b)
    pen.disc(12, 18, 3)


def _keep(pen: Pen) -> None:
    pen.line((6.5, 3.5), (17.5, 3.5), (17.5, 20.5), (12, 15.5), (6.5, 20.5), (6.5, 3.5))


def _menu(pen: Pen) -> None:
    for y in (6, 12, 18):
        pen.line((4, y), (20, y), width=2.2)


EDIT_DRAWINGS: dict[str, Callable[[Pen], None]] = {
    "select": _select, "lasso": _lasso, "particle": _particle, "rope": _rope, "bridge": _bridge, "girder": _girder,
    "web": _web, "box": _box, "circle": _circle, "polygon": _polygon, "wheel": _wheel, "edit": _edit, "new": _new,
    "open": _open, "duplicate": _duplicate, "delete": _delete, "mirror": _mirror, "array": _array, "group": _group,
    "align": _align, "order": _order, "snap": _snap, "forecast": _forecast, "keep": _keep, "menu": _menu,
    "ring": _ring, "ground": _ground, "line": _line, "walls": _walls,
}  # fmt: skip
