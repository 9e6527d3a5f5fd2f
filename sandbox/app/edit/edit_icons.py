"""Icons of the editor's bar: what is done with files and with the selection."""

from itertools import pairwise

from sandbox.app.widgets.icons import ICONS
from sandbox.editor.tools.icons import Icon, IconPen


def _new(pen: IconPen) -> None:
    pen.line((6, 3.5), (14, 3.5), (18.5, 8), (18.5, 20.5), (6, 20.5), (6, 3.5))
    pen.line((13.5, 4), (13.5, 8.5), (18, 8.5), width=1.6)


def _open(pen: IconPen) -> None:
    pen.line((3.5, 19), (3.5, 5.5), (9, 5.5), (11, 8), (18.5, 8), (18.5, 11))
    pen.line((3.5, 19), (7, 11.5), (21.5, 11.5), (18, 19), (3.5, 19))


def _duplicate(pen: IconPen) -> None:
    pen.line((8.5, 8.5), (20, 8.5), (20, 20), (8.5, 20), (8.5, 8.5))
    pen.line((15, 4), (4, 4), (4, 15))


def _delete(pen: IconPen) -> None:
    pen.line((4, 6.5), (20, 6.5))
    pen.line((9, 6), (9.6, 3.5), (14.4, 3.5), (15, 6))
    pen.line((6, 7), (7, 20.5), (17, 20.5), (18, 7))
    pen.line((10.2, 10.5), (10.6, 17), width=1.5)
    pen.line((13.8, 10.5), (13.4, 17), width=1.5)


def _mirror(pen: IconPen) -> None:
    pen.shape((9.5, 5), (9.5, 19), (2.5, 19))
    pen.line((14.5, 5), (14.5, 19), (21.5, 19), (14.5, 5), width=1.6)
    pen.line((12, 3), (12, 21), width=1.4)


def _array(pen: IconPen) -> None:
    for x in (3, 9.5, 16):
        pen.shape((x, 9.5), (x + 5, 9.5), (x + 5, 14.5), (x, 14.5))


def _group(pen: IconPen) -> None:
    for x, dx in ((3.5, 4), (20.5, -4)):
        for y, dy in ((3.5, 4), (20.5, -4)):
            pen.line((x + dx, y), (x, y), (x, y + dy))
    pen.shape((7.5, 7.5), (13, 7.5), (13, 13), (7.5, 13))
    pen.disc(14.5, 14.5, 3.2)


def _align(pen: IconPen) -> None:
    pen.line((4, 3.5), (4, 20.5))
    pen.shape((7, 6), (20, 6), (20, 10.5), (7, 10.5))
    pen.shape((7, 13.5), (15, 13.5), (15, 18), (7, 18))


def _order(pen: IconPen) -> None:
    pen.line((10, 10), (20.5, 10), (20.5, 20.5), (10, 20.5), (10, 10))
    pen.shape((3.5, 3.5), (14, 3.5), (14, 14), (3.5, 14))


def _snap(pen: IconPen) -> None:
    pen.arc(12, 12, 7, 180, 360)
    pen.line((5, 12), (5, 5), width=3.4)
    pen.line((19, 12), (19, 5), width=3.4)
    pen.line((5, 12.5), (5.6, 15), width=3.4)
    pen.line((19, 12.5), (18.4, 15), width=3.4)
    pen.arc(12, 12.5, 6.6, 190, 350)


def _forecast(pen: IconPen) -> None:
    pen.line((3.5, 5), (20.5, 5), width=1.8)
    points = [(4 + 2 * k, 5 + 13 * (1 - ((k - 4) / 4) ** 2)) for k in range(9)]
    for a, b in zip(points[::2], points[1::2], strict=False):
        pen.line(a, b)
    pen.disc(12, 18, 3)


def _rest(pen: IconPen) -> None:
    pen.line((3.5, 5), (20.5, 5), width=1.8)
    pen.line((4, 5), (12, 15), (20, 5))
    pen.disc(12, 15, 3)
    pen.line((6, 21), (18, 21), width=1.8)


def _trail(pen: IconPen) -> None:
    points = [(3.5 + 2.4 * k, 5 + 14 * ((k - 2.6) / 4.4) ** 2 if k > 2.6 else 5 + 10 * ((2.6 - k) / 2.6) ** 2)
              for k in range(8)]  # fmt: skip
    for a, b in pairwise(points[:-1]):
        pen.line(a, b, width=1.8)
    for k in (0, 3, 5):
        pen.disc(*points[k], 2)
    pen.disc(*points[-1], 3.2)


def _menu(pen: IconPen) -> None:
    for y in (6, 12, 18):
        pen.line((4, y), (20, y), width=2.2)


EDIT_ICONS: dict[str, Icon] = {
    **ICONS,
    "new": _new,
    "open": _open, "duplicate": _duplicate, "delete": _delete, "mirror": _mirror, "array": _array, "group": _group,
    "align": _align, "order": _order, "snap": _snap, "forecast": _forecast, "trail": _trail, "rest": _rest,
    "menu": _menu,
}  # fmt: skip
