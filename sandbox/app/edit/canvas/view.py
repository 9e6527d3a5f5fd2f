"""View: what the canvas of the editor shows: the scene, ghosts of what would be, and marks over them."""

from dataclasses import replace

import numpy as np
import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.draw.camera import Box, Point
from sandbox.app.draw.colours import ACCENT
from sandbox.app.edit.canvas.canvas import Part, ScenePainter, SelectionMasks, moved_by
from sandbox.app.edit.canvas.edited_terrain import Ground
from sandbox.app.edit.canvas.edited_zones import Areas, draw_zone_names
from sandbox.app.edit.canvas.marks import DriveMarks
from sandbox.app.edit.canvas.overlay import SPOT_SECONDS, draw_box, draw_cursor, draw_label, draw_spot
from sandbox.app.edit.canvas.pointer import SelectTool
from sandbox.app.edit.canvas.rule_links import draw_links, rules_of
from sandbox.app.edit.canvas.trails import draw_attempts, draw_trails
from sandbox.editor.items import Item, Selection, keys
from sandbox.editor.panel.typed import number_text
from sandbox.editor.scene import Scene, make_scene

# What will hang nearer than this [pixels] to where it is drawn is not shown again.
MOVED = 2.0


class View:
    """Draws the canvas of a screen, and keeps what is worth keeping from frame to frame."""

    def __init__(self, screen: Editing) -> None:
        self._screen = screen
        self._painter = ScenePainter(screen.scale)
        self._marks = DriveMarks(screen)
        self._chosen: tuple[Scene, Selection, Selection, SelectionMasks] | None = None
        self._ghost: Scene | None = None
        self._hanging: tuple[Scene, object, Scene] | None = None
        self._spot: tuple[Point, float] | None = None
        # The box [m] of what a panel shows, and the items that are pointed at in it.
        self.shown_box: Box | None = None
        self.pointed: Selection = frozenset()
        # The rule that a panel shows, by its index.
        self.shown_rule: int | None = None
        # Of the values that are tried the one whose way stands out.
        self.chosen_attempt: int | None = None

    def point_out(self, place: Point) -> None:
        """Circle a place [m] for a moment."""
        self._spot = (place, 0.0)

    @property
    def moves(self) -> bool:
        """Whether a place is circled for a moment, or a smooth picture is being made."""
        return self._spot is not None or self._painter.moves

    def update(self, frame_time: float) -> None:
        """Let frame_time [s] pass."""
        self._painter.scale = self._screen.scale
        self._painter.lattice, self._painter.grid_step = self._screen.shows_lattice, self._screen.grid_step
        if self._spot is not None:
            place, age = self._spot
            self._spot = (place, age + frame_time) if age < SPOT_SECONDS else None

    def draw(self, surface: pygame.Surface) -> None:
        """Draw everything inside the rulers."""
        self._draw_scene(surface)
        self._draw_forecast(surface)
        screen = self._screen
        if screen.watch.range_trial is None:
            draw_trails(surface, screen.ui, screen.camera, screen.watch.shown_trails, screen.document.selection)
        else:
            draw_attempts(surface, screen.ui, screen.camera, screen.watch.range_trial, self.chosen_attempt)
        self._draw_ghost(surface)
        self._draw_marks(surface)

    def _draw_scene(self, surface: pygame.Surface) -> None:
        screen = self._screen
        scene, selection, matrix = screen.scene, screen.document.selection, screen.pointer_tool.transform
        hidden = screen.visibility.hidden
        now = (scene, selection, hidden)
        if self._chosen is None or any(old is not new for old, new in zip(self._chosen, now, strict=False)):
            self._chosen = (scene, selection, hidden, SelectionMasks.of(scene, selection, hidden))
        chosen = self._chosen[3]
        self._painter.draw(surface, screen.camera, scene, chosen, matrix is not None)
        if matrix is not None:
            scene = moved_by(scene, chosen, matrix)
            self._painter.paint_moved(surface, screen.camera, scene, chosen)
        self._marks.draw(surface, screen.camera, scene, chosen)
        draw_zone_names(surface, screen.ui, screen.camera, Areas(scene, ~chosen.hidden_items))

    def _draw_forecast(self, surface: pygame.Surface) -> None:
        scene, position = self._screen.scene, self._screen.watch.hanging
        if position is None:
            return
        if self._hanging is None or self._hanging[0] is not scene or self._hanging[1] is not position:
            self._hanging = (scene, position, replace(scene, position=position))
        # What stays where it is would only lie over itself.
        moved = np.abs(position - scene.position).max(axis=1) * self._screen.camera.zoom > MOVED
        springs = moved[scene.particle_a] | moved[scene.particle_b]
        assert self._chosen is not None
        away = self._chosen[3]
        moved, springs = moved & ~away.hidden_particles, springs & ~away.hidden_springs
        self._painter.paint(surface, self._screen.camera, Part(self._hanging[2], moved, springs, ghost=True))

    def _draw_ghost(self, surface: pygame.Surface) -> None:
        screen = self._screen
        ghost = screen.pointer_tool.ghost()
        if ghost is None or ghost.level is screen.document.level:
            return
        if self._ghost is None or self._ghost.level is not ghost.level:
            self._ghost = make_scene(ghost.level, screen.scene)
        drawn, new = self._ghost, ghost.selection
        walls = ghost.level.walls
        if walls is not None and walls is not screen.document.level.walls:
            self._painter.paint_walls(surface, screen.camera, walls.box, ACCENT)
        self._painter.paint_zones(surface, screen.camera, Areas(drawn, drawn.chosen(new), ACCENT))
        self._painter.paint_ground(surface, screen.camera, Ground(drawn, drawn.chosen(new), ghost=True))
        self._painter.paint_ghost(surface, screen.camera, Part(drawn, drawn.particles_of(new), drawn.springs_of(new)))

    def _name_of(self, item: Item | None) -> str:
        """What a loose spring or particle under the pointer is called, and of a particle its mass and radius."""
        level = self._screen.document.level
        if item is None or item.kind not in ("spring", "particle"):
            return ""
        if item.kind == "spring":
            return level.springs[int(item.key)].name or ""
        particle = next(part for part in level.particles if part.id == item.key)
        return f"{particle.id}: {number_text(particle.mass)} kg, radius {number_text(particle.radius)} m"

    def _draw_marks(self, surface: pygame.Surface) -> None:
        screen, tool = self._screen, self._screen.pointer_tool
        under = tool.hovered if isinstance(tool, SelectTool) and tool.transform is None else None
        pointed = self.pointed if under is None else frozenset({under})
        if pointed and not pointed <= screen.document.selection and pointed <= frozenset(screen.scene.items):
            self._painter.paint_hovered(surface, screen.camera, screen.scene, pointed)
        if self.shown_box is not None:
            draw_box(surface, screen.camera, self.shown_box)
        if tool.transform is None:
            zones = frozenset(str(key) for key in keys(screen.document.selection, "zone"))
            rules = rules_of(screen.scene, self.shown_rule, zones)
            draw_links(surface, screen.camera, screen.scene, rules, screen.scale)
        tool.draw(surface)
        named = self._name_of(under)
        if named and screen.pointer is not None and not tool.measure:
            draw_label(surface, screen.ui, screen.pointer, named, screen.camera.viewport)
        if screen.cursor is not None:
            draw_cursor(surface, screen.camera.to_pixels(screen.cursor), screen.scale)
        if self._spot is not None:
            draw_spot(surface, screen.camera.to_pixels(self._spot[0]), self._spot[1], screen.scale)
        if tool.measure and screen.pointer is not None:
            draw_label(surface, screen.ui, screen.pointer, tool.measure, screen.camera.viewport)
