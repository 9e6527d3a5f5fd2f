"""Flesh of the scene that is edited: what its parts will look like, faintly, under the springs that are worked on."""

from dataclasses import dataclass

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import Theme, theme_now
from sandbox.app.draw.raster.painter import Painter
from sandbox.app.draw.textures import Tiles
from sandbox.app.draw.things.drawables import Drawables
from sandbox.app.draw.things.level_slots import Frame, LevelSlots, level_slots_of
from sandbox.editor.scene import Scene

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Scenes of more particles and springs than this show their springs alone: each edit makes all of it again.
MOST = 4_000
# How much of it shows, of 255.
ALPHA = 190


@dataclass(eq=False)
class _State:
    """A scene as drawing reads a world's state."""

    position: Floats
    velocity: Floats
    mass: Floats
    inverse_mass: Floats
    radius: Floats
    particle_active: Mask
    particle_a: NDArray[np.int32]
    particle_b: NDArray[np.int32]
    rest_length: Floats
    stiffness: Floats
    spring_active: Mask


class Flesh:
    """Draws what the parts of a scene will look like."""

    def __init__(self) -> None:
        self._painter = Painter()
        self._tiles: tuple[Theme, Tiles] | None = None
        self._level_slots: tuple[Scene, LevelSlots] | None = None

    def paint(
        self, layer: pygame.Surface, camera: Camera, scene: Scene, particles: Mask, springs: Mask, scale: float,
        compiled: bool, alpha: int = ALPHA,
    ) -> bool:  # fmt: skip
        """Draw those particles (n,) and springs (m,) of a scene on a layer; whether that would not take too long."""
        if not 0 < len(scene.position) + len(scene.particle_a) <= MOST:
            return False
        if self._level_slots is None or self._level_slots[0] is not scene:
            self._level_slots = (scene, level_slots_of(scene.level, is_welded=False))
        if self._tiles is None or self._tiles[0] is not theme_now():
            self._tiles = theme_now(), Tiles(theme_now())
        state = _state_of(scene, particles, springs)
        upright, still = np.zeros(len(scene.position)), np.zeros(len(scene.particle_a))
        frame = Frame(state, camera.project(scene.position), upright, still, camera.zoom, scale, *self._tiles)
        picture = layer.copy()
        picture.set_clip(layer.get_clip())
        self._painter.compiled = compiled
        self._painter.begin(picture)
        drawables = Drawables(self._level_slots[1], state, particles, springs)
        drawables.soft.trace(self._painter, frame)
        drawables.draw(self._painter, frame, False)
        picture.set_alpha(alpha)
        layer.blit(picture, (0, 0))
        return True


def _state_of(scene: Scene, particles: Mask, springs: Mask) -> _State:
    return _State(
        scene.position,
        np.zeros_like(scene.position),
        scene.mass,
        np.where(scene.pinned, 0.0, 1.0),
        scene.radius,
        particles,
        scene.particle_a.astype(np.int32),
        scene.particle_b.astype(np.int32),
        scene.rest_length,
        np.zeros_like(scene.rest_length),
        springs,
    )
