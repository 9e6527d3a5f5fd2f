"""Marks on what is driven: a wave on muscles, a cylinder on hydraulics, an arrow about the hub of a motor, and keys."""

import math

import numpy as np
import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.draw.camera import Camera, Point
from sandbox.app.draw.colours import BACKGROUND, DRIVE, TEXT, mixed
from sandbox.app.edit.canvas.canvas import SelectionMasks
from sandbox.app.widgets.ui import Ui
from sandbox.editor.scene import Scene, SceneActuators, scene_actuators
from sandbox.level.format.actuator_defs import HydraulicDef, MotorDef

# Sizes in layout units: a badge, the shortest spring and the smallest wheel with a mark, the arrow of a motor.
BADGE = 8.0
SHORTEST = 20.0
SMALLEST = 6.0
CYLINDER = 4.5
# Keys of smaller wheels are left out.
ROOM_FOR_KEYS = 14.0
ARROW = (8.0, 44.0)
WIDTH = 2.6
# The arrow goes round by this angle [degrees], its head is that long.
SWEEP = 250
HEAD = 6.0
# More marks than this are not told apart.
MOST = 500


class DriveMarks:
    """Draws the marks of a scene, and keeps what it found of it while nothing that is driven changes."""

    def __init__(self, screen: Editing) -> None:
        self._screen = screen
        self._of: tuple[object, object] | None = None
        self._actuators = SceneActuators([], [], [])

    @property
    def _ui(self) -> Ui:
        # The layout of now: one that was left would be kept, and all that it showed.
        return self._screen.ui

    def draw(self, surface: pygame.Surface, camera: Camera, scene: Scene, masks: SelectionMasks) -> None:
        """Draw the marks where the scene's particles are, but for those of what is hidden."""
        level = scene.level
        if self._of is None or self._of[0] is not level.bodies or self._of[1] is not level.springs:
            self._of, self._actuators = (level.bodies, level.springs), scene_actuators(scene)
        muscles, hydraulics, motors = self._actuators
        for spring in [spring for spring in muscles if not masks.hidden_springs[spring]][:MOST]:
            self._draw_muscle(surface, *self._ends(camera, scene, spring))
        for spring, hydraulic in [each for each in hydraulics if not masks.hidden_springs[each[0]]][:MOST]:
            self._draw_hydraulic(surface, *self._ends(camera, scene, spring), hydraulic)
        for hub, radius, motor in [each for each in motors if not masks.hidden_particles[each[0]]]:
            self._draw_motor(surface, _pixel(camera, scene, hub), radius * camera.zoom, motor)

    def _ends(self, camera: Camera, scene: Scene, spring: int) -> tuple[Point, Point]:
        a, b = int(scene.particle_a[spring]), int(scene.particle_b[spring])
        return _pixel(camera, scene, a), _pixel(camera, scene, b)

    def _draw_muscle(self, surface: pygame.Surface, a: Point, b: Point) -> None:
        """Draw a wave in a badge."""
        scale = self._ui.scale
        if math.dist(a, b) < SHORTEST * scale:
            return
        x, y, radius = (a[0] + b[0]) / 2, (a[1] + b[1]) / 2, BADGE * scale
        pygame.draw.aacircle(surface, BACKGROUND, (x, y), radius + scale)
        pygame.draw.aacircle(surface, mixed(BACKGROUND, DRIVE, 0.3), (x, y), radius)
        pygame.draw.aacircle(surface, DRIVE, (x, y), radius, max(1, round(scale)))
        turns = np.linspace(-1.0, 1.0, 17).tolist()
        wave = [(x + 0.62 * radius * t, y - 0.38 * radius * math.sin(math.pi * t)) for t in turns]
        pygame.draw.lines(surface, TEXT, False, wave, max(1, round(1.6 * scale)))

    def _draw_hydraulic(self, surface: pygame.Surface, a: Point, b: Point, hydraulic: HydraulicDef) -> None:
        """Draw a cylinder on the first part of the spring, with its piston, and an arrow back where it returns."""
        scale, length = self._ui.scale, math.dist(a, b)
        if length < SHORTEST * scale:
            return
        along = ((b[0] - a[0]) / length, (b[1] - a[1]) / length)
        half = CYLINDER * scale

        def at(share: float, aside: float) -> Point:
            x, y = a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])
            return x - along[1] * aside, y + along[0] * aside

        outline = [at(0.15, -half), at(0.62, -half), at(0.62, half), at(0.15, half)]
        pygame.draw.polygon(surface, mixed(BACKGROUND, DRIVE, 0.3), outline)
        pygame.draw.aalines(surface, DRIVE, True, outline)
        piston = [at(0.46, -half), at(0.5, -half), at(0.5, half), at(0.46, half)]
        pygame.draw.polygon(surface, DRIVE, piston)
        pygame.draw.line(surface, DRIVE, at(0.5, 0.0), at(0.85, 0.0), max(1, round(WIDTH * scale)))
        if hydraulic.returns:
            # An arrow back along the cylinder.
            tip, tail = at(0.15, -2.4 * half), at(0.4, -2.4 * half)
            pygame.draw.line(surface, DRIVE, tail, tip, max(1, round(WIDTH * scale)))
            head = 1.8 * half
            sides = [(tip[0] + head * (along[0] - side * along[1]), tip[1] + head * (along[1] + side * along[0]))
                     for side in (-0.7, 0.7)]  # fmt: skip
            pygame.draw.polygon(surface, DRIVE, [tip, *sides])
        self._draw_keys(surface, at(0.5, 4.2 * half), hydraulic)

    def _draw_motor(self, surface: pygame.Surface, hub: Point, rim: float, motor: MotorDef) -> None:
        """Draw an arrow about the hub, the way that the motor turns it; a bare ring where it holds it still."""
        scale = self._ui.scale
        if rim < SMALLEST * scale:
            return
        radius = min(max(0.5 * rim, ARROW[0] * scale), ARROW[1] * scale)
        width = max(1, round(WIDTH * scale))
        if motor.speed == 0.0:
            pygame.draw.aacircle(surface, DRIVE, hub, radius, width)
            return
        way = math.copysign(1.0, motor.speed)
        turns = [math.radians(way * (SWEEP * k / 40 - 55)) for k in range(41)]
        # Pixels count downwards.
        points = [(hub[0] + radius * math.cos(t), hub[1] - radius * math.sin(t)) for t in turns]
        pygame.draw.lines(surface, BACKGROUND, False, points, 3 * width)
        pygame.draw.lines(surface, DRIVE, False, points, width)
        (x, y), turn, head = points[-1], turns[-1], HEAD * scale
        ahead = (-math.sin(turn) * way, -math.cos(turn) * way)
        tip = (x + ahead[0] * head, y + ahead[1] * head)
        sides = [(x - side * ahead[1] * 0.75 * head, y + side * ahead[0] * 0.75 * head) for side in (-1, 1)]
        pygame.draw.polygon(surface, DRIVE, [tip, *sides])
        if rim >= ROOM_FOR_KEYS * scale:
            self._draw_keys(surface, (hub[0], hub[1] + radius + 12 * scale), motor)

    def _draw_keys(self, surface: pygame.Surface, at: Point, drive: HydraulicDef | MotorDef) -> None:
        """Draw caps of the keys that drive it."""
        ui = self._ui
        keys = [key.upper() for key in (drive.key, drive.reverse_key) if key is not None]
        size = ui.px(15)
        left = at[0] - (len(keys) * size + (len(keys) - 1) * ui.px(3)) / 2
        for key in keys:
            cap = pygame.Rect(round(left), round(at[1] - size / 2), size, size)
            pygame.draw.rect(surface, mixed(BACKGROUND, DRIVE, 0.25), cap, border_radius=ui.px(3))
            pygame.draw.rect(surface, DRIVE, cap, 1, border_radius=ui.px(3))
            picture = ui.font(10.5).render(key, True, TEXT)
            surface.blit(picture, picture.get_rect(center=cap.center))
            left += size + ui.px(3)


def _pixel(camera: Camera, scene: Scene, slot: int) -> Point:
    x, y = scene.position[slot].tolist()
    return camera.to_pixels((x, y))
