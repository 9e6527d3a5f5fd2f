"""Where a single definition goes when the plane is moved, turned, scaled or mirrored."""

from typing import Any, TypeVar

import numpy as np

from sandbox.editor.document import EditError, subject
from sandbox.editor.kinds.motion import Motion, mapped_velocity
from sandbox.editor.kinds.table import editing
from sandbox.editor.panel.field_info import DEGREES, fields_of
from sandbox.level.document.model import ParticleDef, TerrainDef
from sandbox.level.format.quantities import Description, replaced
from sandbox.level.kinds.bodies import AnyBody, expansion
from sandbox.level.kinds.geometry import Points

Placed = TypeVar("Placed", AnyBody, TerrainDef)
Described = TypeVar("Described", bound=Description)
# Lengths, angles and speeds that an edit works out are rounded to 1e-12, far below what is seen, so that
# a file holds 2.28 and not 2.2800000000000002.
DECIMALS = 12
_MEASURES = ("m", "rad", "m/s")


def _rounded(value: Any) -> Any:
    """A number, or all in a tuple of tuples of them, without the dust of arithmetic."""
    if isinstance(value, tuple):
        return tuple(map(_rounded, value))
    return round(value, DECIMALS) + 0.0 if isinstance(value, float) else value


def without_dust(part: Described) -> Described:
    """A body, particle, spring or piece of terrain, its lengths, angles and speeds rounded, in what it holds too."""
    changes: dict[str, Any] = {}
    about = fields_of(type(part))
    for name, value in part.__dict__.items():
        if isinstance(value, Description):
            changes[name] = without_dust(value)
        elif isinstance(value, float | tuple) and (about[name].unit in _MEASURES or about[name].unit == DEGREES):
            new = _rounded(value)
            # What would be nothing is left: a size is above 0.
            changes[name] = new if new or not value else value
    changes = {name: new for name, new in changes.items() if new != part.__dict__[name]}
    return replaced(part, **changes) if changes else part


def shifted(body: Placed, dx: float, dy: float) -> Placed:
    """A body or piece of terrain moved by dx, dy [m]."""
    changes: dict[str, Any] = {}
    for name in ("start", "end", "position"):
        if name in body.__dict__:
            x, y = body.__dict__[name]
            changes[name] = (x + dx, y + dy)
    for name in ("particles", "pose", "polyline", "polygon"):
        points = body.__dict__.get(name)
        if points is not None:
            changes[name] = tuple([(x + dx, y + dy) for x, y in points])
    return replaced(body, **changes)


def mapped_particle(particle: ParticleDef, motion: Motion) -> ParticleDef:
    """A loose particle, its place and start motion mapped; its disc grows with a scale."""
    return replaced(
        particle,
        position=motion.point(particle.position),
        radius=particle.radius * motion.factor,
        velocity=mapped_velocity(particle.velocity, motion),
        spin=-particle.spin if motion.is_mirror else particle.spin,
    )


def mapped_terrain(piece: TerrainDef, motion: Motion) -> TerrainDef:
    """A piece of terrain with its corners mapped."""
    polyline, polygon = (corners and motion.points(corners) for corners in (piece.polyline, piece.polygon))
    return replaced(piece, polyline=polyline, polygon=polygon)


def mapped_body(body: AnyBody, motion: Motion) -> tuple[AnyBody, Points]:
    """A body mapped, and where the particles of its old form lie in the new one [m] (n, 2).

    Where the parameters of its kind cannot say what becomes of it, its pose does. Raises EditError for a stretch that
    bends it.
    """
    form = expansion(body).form
    image = np.array(motion.points(map(tuple, form.tolist())))
    pose = None if body.pose is None else motion.points(body.pose)
    edited = editing(body)
    if edited.lies_askew(motion):
        middle = tuple(((form.min(axis=0) + form.max(axis=0)) / 2.0).tolist())
        goes = motion.point(middle)
        aside = shifted(replaced(body, pose=None), goes[0] - middle[0], goes[1] - middle[1])
        start = pose if pose is not None else tuple(map(tuple, image.tolist()))
        return replaced(aside, pose=start, velocity=mapped_velocity(body.velocity, motion)), expansion(aside).form
    if not motion.is_even and not edited.can_stretch():
        raise EditError(f"{subject(body)}: a {edited.noun} can only be scaled evenly")
    changes = edited.mapped(motion)
    if pose is not None:
        changes["pose"] = pose
    return replaced(body, velocity=mapped_velocity(body.velocity, motion), **changes), image
