"""Meshes in the editor; none is drawn, they come from breaking and importing."""

from typing import Any

from sandbox.editor.kinds.editing import BodyEditing, PlaneMap, mapped_velocity
from sandbox.level.kinds.mesh import MeshDef


class MeshEditing(BodyEditing[MeshDef]):
    """Edits a mesh, which is placed by its particles."""

    formless = frozenset({"masses", "velocities", "bending"})
    stretches = True

    def mapped(self, motion: PlaneMap) -> dict[str, Any]:
        """The places of all particles, their velocities and triangles, after a motion."""
        body = self.body
        velocities = body.velocities and tuple(mapped_velocity(velocity, motion) for velocity in body.velocities)
        mapped = {"particles": motion.points(body.particles), "velocities": velocities}
        # A mirror turns triangles round.
        return mapped | ({"triangles": tuple(each[::-1] for each in body.triangles)} if motion.is_mirror else {})
