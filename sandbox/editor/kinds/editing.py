"""BodyEditing: what the editor adds to a kind of body; each kind has a file of its own beside this one."""

from typing import Any, ClassVar, Generic, TypeVar

from sandbox.editor.kinds.motion import Motion
from sandbox.editor.tools.editor_tool import EditorTool
from sandbox.level.kinds.body_def import BodyDef

Body = TypeVar("Body", bound=BodyDef)


class BodyEditing(Generic[Body]):
    """One body of a kind in the editor: where it goes when the plane is moved, and how its kind is drawn."""

    # Tools that draw such a body, in the order of the palette.
    tools: ClassVar[tuple[EditorTool, ...]] = ()
    # Fields that its form does not depend on, beside those of every body.
    formless: ClassVar[frozenset[str]] = frozenset()

    def __init__(self, body: Body) -> None:
        self.body = body

    @property
    def noun(self) -> str:
        """What messages call a body of the kind that cannot be stretched."""
        return self.body.type

    def can_stretch(self) -> bool:
        """Whether the body can be made longer without being made higher as much."""
        return False

    def mapped(self, motion: Motion) -> dict[str, Any]:
        """The fields that a motion changes, other than pose and velocity.

        motion: even where the body cannot be stretched.
        """
        raise NotImplementedError

    def lies_askew(self, motion: Motion) -> bool:
        """Whether no fields can say where a motion takes it, so that it needs a pose."""
        return False

    def with_field(self, field: str, value: Any) -> dict[str, Any]:
        """The fields that change where one of them gets a new value."""
        return {field: value}


def mapped_centre(body: Any, motion: Motion) -> dict[str, Any]:
    """Place and angle of a round body after a motion."""
    return {"position": motion.point(body.position), "angle": motion.turned(body.angle)}
