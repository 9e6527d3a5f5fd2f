"""The tools that draw bodies."""

from math import cos, sin, tau

from sandbox.editor.tools.drawing_bodies import (
    BridgeDrawing,
    GirderDrawing,
    RingDrawing,
    RopeDrawing,
    WebDrawing,
    WheelDrawing,
)
from sandbox.editor.tools.drawing_jelly import BoxDrawing, CircleDrawing, PolygonDrawing
from sandbox.editor.tools.editor_tool import EditorTool
from sandbox.editor.tools.icons import IconPen


def _draw_rope(pen: IconPen) -> None:
    points = [(4 + 4 * k, 6 + 11 * (1 - ((k - 2) / 2) ** 2)) for k in range(5)]
    pen.line(*points)
    for x, y in points:
        pen.disc(x, y, 2.3)


def _draw_bridge(pen: IconPen) -> None:
    pen.line((3, 8), (21, 8))
    pen.line((3, 16), (21, 16))
    for x in (3, 12, 21):
        pen.line((x, 8), (x, 16))
    for x in (3, 12):
        pen.line((x, 8), (x + 9, 16), width=1.3)
        pen.line((x, 16), (x + 9, 8), width=1.3)


def _draw_girder(pen: IconPen) -> None:
    pen.line((2.5, 7), (21.5, 7))
    pen.line((7, 17), (17, 17))
    pen.line((2.5, 7), (7, 17), (12, 7), (17, 17), (21.5, 7))


def _draw_web(pen: IconPen) -> None:
    for radius in (4.5, 9.5):
        pen.line(*[(12 + radius * cos(tau * k / 6), 12 + radius * sin(tau * k / 6)) for k in range(7)], width=1.6)
    for k in range(6):
        pen.line((12, 12), (12 + 9.5 * cos(tau * k / 6), 12 + 9.5 * sin(tau * k / 6)), width=1.3)


def _draw_box(pen: IconPen) -> None:
    for at in (4, 12, 20):
        pen.line((at, 4), (at, 20), width=1.7)
        pen.line((4, at), (20, at), width=1.7)


def _draw_circle(pen: IconPen) -> None:
    pen.disc(12, 12, 9, 2)
    pen.line((12, 3.5), (12, 20.5), width=1.4)
    pen.line((3.5, 12), (20.5, 12), width=1.4)


def _draw_polygon(pen: IconPen) -> None:
    corners = ((4, 9), (12, 3.5), (20, 8), (17.5, 19), (7, 20), (4, 9))
    pen.line(*corners)
    for x, y in corners:
        pen.disc(x, y, 2.2)


def _draw_wheel(pen: IconPen) -> None:
    pen.disc(12, 12, 9.5, 2.6)
    pen.disc(12, 12, 2.6)
    for k in range(6):
        pen.line((12, 12), (12 + 8 * cos(tau * k / 6), 12 + 8 * sin(tau * k / 6)), width=1.4)


def _draw_ring(pen: IconPen) -> None:
    pen.disc(12, 12, 9.5, 2.2)
    for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        pen.line((12 + 1.5 * dx, 12 + 1.5 * dy), (12 + 5.2 * dx, 12 + 5.2 * dy), width=1.5)
        tip = (12 + 5.6 * dx, 12 + 5.6 * dy)
        for side in (-1, 1):
            pen.line(tip, (tip[0] - 1.7 * dx + 1.5 * side * dy, tip[1] - 1.7 * dy + 1.5 * side * dx), width=1.5)


BODY_TOOLS = (
    EditorTool("rope", "R", "Rope", _draw_rope, RopeDrawing),
    EditorTool("bridge", "B", "Bridge", _draw_bridge, BridgeDrawing),
    EditorTool("girder", "G", "Girder", _draw_girder, GirderDrawing),
    EditorTool("web", "W", "Web", _draw_web, WebDrawing),
    EditorTool("box", "J", "Jelly: a box", _draw_box, BoxDrawing, word="jelly"),
    EditorTool("circle", "O", "Jelly: a disc", _draw_circle, CircleDrawing),
    EditorTool("polygon", "Y", "Jelly: freehand or corner by corner", _draw_polygon, PolygonDrawing),
    EditorTool("wheel", "Q", "Wheel with a hub", _draw_wheel, WheelDrawing),
    EditorTool("ring", "Shift+O", "Ring with air inside: a balloon", _draw_ring, RingDrawing),
)
