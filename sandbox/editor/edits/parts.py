"""Parts of the catalogue: a level put into another as one group, and what is selected made such a level.

The origin of a part is what the pointer holds it by; of what is kept that is the middle of its lower edge.
"""

import numpy as np

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.copying import fragment, inserted, shifted
from sandbox.editor.edits.grouping import group as grouped
from sandbox.editor.edits.moving import mirror
from sandbox.editor.items import items_of
from sandbox.editor.scene import make_scene
from sandbox.editor.tools.snap import PLACE_DECIMALS
from sandbox.level.document.model import ContactsDef, Level
from sandbox.level.format.limits import TEXT_LIMIT
from sandbox.level.format.quantities import Point, replaced


def place_part(document: Document, part: Level, at: Point, mirrored: bool = False) -> Document:
    """Add a part with its origin at a point [m], as one group, and select it; mirrored: left for right.

    Names become free ones; materials of the same name and values are shared, others get a name of their own. Where
    nothing touches anything yet and the part is made to touch, things do from now on. Raises EditError.
    """
    whole = Document(part, frozenset(items_of(part)))
    if not whole.selection:
        raise EditError("there is nothing in this part")
    if mirrored:
        whole = mirror(whole, "x", (0.0, 0.0))
    if len(whole.selection) > 1:
        whole = grouped(whole, part.name)
    level = document.level
    if part.contacts is not None and not level.has_contacts:
        level = replaced(level, contacts=part.contacts)
    return Document(*inserted(level, [shifted(whole.level, *at)]))


def part_of(document: Document, name: str) -> Level:
    """What is selected as a part of that name. Raises EditError where that is nothing, or the name none."""
    name = name.strip()
    if not 0 < len(name) <= TEXT_LIMIT:
        raise EditError(f"a name has 1 to {TEXT_LIMIT} characters")
    part, level = fragment(document), document.level
    scene = make_scene(part)
    box = scene.bounds()
    assert box is not None
    left, bottom, right, _ = box
    # Particles stand on their rims.
    bottom = min(bottom, float(np.min(scene.position[:, 1] - scene.radius, initial=np.inf)))
    part = shifted(part, -round((left + right) / 2.0, PLACE_DECIMALS), -round(bottom, PLACE_DECIMALS))
    contacts = (level.contacts or ContactsDef()) if level.has_contacts else None
    return replaced(part, name=name, description="", contacts=contacts)
