"""The tools that select, and move what is selected."""

from math import cos, pi, sin

from sandbox.editor.tools.editor_tool import EditorTool
from sandbox.editor.tools.icons import IconPen


def _draw_arrow(pen: IconPen) -> None:
    pen.shape((6, 3), (6, 18.5), (10, 15), (12.5, 21), (15.2, 19.8), (12.6, 14), (18, 13.4))


def _draw_lasso(pen: IconPen) -> None:
    for turn in range(0, 360, 45):
        a, b = turn * pi / 180, (turn + 27) * pi / 180
        pen.line((12 + 8.5 * cos(a), 9.5 + 6 * sin(a)), (12 + 8.5 * cos(b), 9.5 + 6 * sin(b)))
    pen.line((6.5, 14.5), (5, 18), (7, 21))


SELECT = EditorTool("select", "V", "Select and move", _draw_arrow)
LASSO = EditorTool("lasso", "L", "Select by a lasso", _draw_lasso)
