"""Edits that mend what the linter finds."""

from collections.abc import Callable

from sandbox.editor.document import Document, EditError, select
from sandbox.editor.edits.deleting import delete
from sandbox.editor.edits.fields import set_level_field, set_setting
from sandbox.editor.edits.placing import weld
from sandbox.editor.edits.terrain import add_terrain, with_corners
from sandbox.editor.items import Selection
from sandbox.editor.lint.finding import Remedy
from sandbox.editor.scene import make_scene
from sandbox.level.document.model import ContactsDef, TerrainDef

# Ground that is drawn below everything lies so far below the lowest thing, is so thick, and reaches so far beyond [m].
BELOW, THICKNESS, BEYOND = 0.5, 1.0, 4.0
_DECIMALS = 2


def deletion(items: Selection) -> Remedy:
    """Delete items."""

    def of_all(chosen: Selection) -> Callable[[Document], Document]:
        return lambda document: delete(select(document, chosen))

    return Remedy("Delete it", of_all(items), ("Delete them", of_all))


def joint(a: str, b: str) -> Remedy:
    """Make one of two particles."""
    return Remedy("Join them", lambda document: weld(document, a, b))


def draw_ground(document: Document) -> Document:
    """Draw ground below everything, and let things touch."""
    box = make_scene(document.level).bounds()
    if box is None:
        raise EditError("there is nothing to draw ground below")
    left, right, top = box[0] - BEYOND, box[2] + BEYOND, box[1] - BELOW
    corners = [(left, top - THICKNESS), (right, top - THICKNESS), (right, top), (left, top)]
    rounded = [(round(x, _DECIMALS), round(y, _DECIMALS)) for x, y in corners]
    if not document.level.has_contacts:
        document = set_level_field(document, "contacts", ContactsDef())
    return add_terrain(document, with_corners(TerrainDef(id="ground"), rounded, "solid"))


GROUND = Remedy("Draw ground below", draw_ground, ("Draw ground below", lambda _: draw_ground))


def _use_direct(document: Document) -> Document:
    return set_setting(document, "solver", "direct")


DIRECT = Remedy("Use the direct solver", _use_direct, ("Use the direct solver", lambda _: _use_direct))
