"""The kinds of body, in the order in which they are explained: the one table that names them all.

A kind is a file beside this one, with its model and its `Expansion`, and a file of that name in the editor.
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
    """What a body becomes. Its arrays are those of a sound body alone: of one in which the check finds no fault."""
    return EXPANSIONS[body.type](body)
