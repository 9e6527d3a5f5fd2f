"""Where a single definition goes when the plane is moved, turned, scaled or mirrored."""

from typing import Any, TypeVar

import numpy as np

from sandbox.editor.document import EditError, subject
from sandbox.editor.kinds.motion import Motion, mapped_velocity
from sandbox.editor.kinds.table import editing
from sandbox.level.document.model import ParticleDef, TerrainDef
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import AnyBody, expansion
from sandbox.level.kinds.geometry import Points

Placed = TypeVar("Placed", AnyBody, TerrainDef)


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
