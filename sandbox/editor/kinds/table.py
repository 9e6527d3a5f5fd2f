"""The kinds of body in the editor: the one table that names them all, beside that of their models."""

from typing import Any

from sandbox.editor.kinds.bridge import BridgeEditing
from sandbox.editor.kinds.editing import BodyEditing
from sandbox.editor.kinds.girder import GirderEditing
from sandbox.editor.kinds.jelly import JellyEditing
from sandbox.editor.kinds.mesh import MeshEditing
from sandbox.editor.kinds.ring import RingEditing
from sandbox.editor.kinds.rope import RopeEditing
from sandbox.editor.kinds.web import WebEditing
from sandbox.editor.kinds.wheel import WheelEditing
from sandbox.level.kinds.body_def import BodyDef

EDITING: dict[str, type[BodyEditing[Any]]] = {
    "rope": RopeEditing,
    "bridge": BridgeEditing,
    "girder": GirderEditing,
    "web": WebEditing,
    "jelly": JellyEditing,
    "wheel": WheelEditing,
    "ring": RingEditing,
    "mesh": MeshEditing,
}
# Tools of all kinds, in the order of the palette.
BODY_TOOLS = tuple(tool for each in EDITING.values() for tool in each.tools)


def editing(body: BodyDef) -> BodyEditing[Any]:
    """The editing object of a body, by its kind."""
    return EDITING[body.type](body)
