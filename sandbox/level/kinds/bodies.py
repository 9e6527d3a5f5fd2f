"""The table of the kinds of body, in the order of the reference.

Each kind is one file in this folder, with a model and an `Expansion`, and one file in the editor.
"""

from typing import TYPE_CHECKING, Annotated, Any, Union

from pydantic import Field

from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.kinds.bridge import Bridge
from sandbox.level.kinds.expansion import Expansion
from sandbox.level.kinds.girder import Girder
from sandbox.level.kinds.jelly import Jelly
from sandbox.level.kinds.mesh import Mesh
from sandbox.level.kinds.ring import Ring
from sandbox.level.kinds.rope import Rope
from sandbox.level.kinds.web import Web
from sandbox.level.kinds.wheel import Wheel

EXPANSIONS: dict[str, type[Expansion[Any]]] = {
    each.kind(): each for each in (Rope, Bridge, Girder, Web, Wheel, Ring, Jelly, Mesh)
}
# Models by the name that a file gives their kind.
KINDS: dict[str, type[BodyDef]] = {name: each.model for name, each in EXPANSIONS.items()}

if TYPE_CHECKING:
    AnyBody = BodyDef
else:
    AnyBody = Annotated[Union[tuple(KINDS.values())], Field(discriminator="type")]  # noqa: UP007


def expansion(body: BodyDef) -> Expansion[Any]:
    """The expansion of a body. Only a body without faults has arrays."""
    return EXPANSIONS[body.type](body)
