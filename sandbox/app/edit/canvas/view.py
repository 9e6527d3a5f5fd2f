"""View: the sheet as the editor shows it: canvas, marks of drives, links of rules, trails and rulers."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.draw.camera import GRID_STEP, Box, Camera, Point, grid_spacing
from sandbox.app.draw.colours import ACCENT, BACKGROUND, DRIVE, LINE, MUTED, SURFACE, TEXT, ZONE, mixed
from sandbox.app.edit.canvas.canvas import Part, ScenePainter, SelectionMasks, moved_by
from sandbox.app.edit.canvas.edited_shapes import Areas, Ground, draw_zone_names
from sandbox.app.edit.canvas.overlay import SPOT_SECONDS, draw_box, draw_cursor, draw_label, draw_spot
from sandbox.app.edit.canvas.pointer import SelectTool
from sandbox.app.edit.canvas.trails import draw_attempts, draw_trails
from sandbox.app.widgets.ui import Ui
from sandbox.editor.edits.grouping import groups_of
from sandbox.editor.items import PARTS, Item, Selection, keys
from sandbox.editor.panel.typed import number_text
from sandbox.editor.rule_text import acted_on, named_things, named_zones
from sandbox.editor.scene import Scene, SceneActuators, make_scene, scene_actuators
from sandbox.level.format.actuator_defs import HydraulicDef, MotorDef
from sandbox.level.rules.rule import RuleDef

# What will hang nearer than this [pixels] to where it is drawn is not shown again.
MOVED = 2.0
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
# Distance and radius of the dots [layout units].
STEP, DOT = 8.0, 2.0
# Thickness in layout units; lengths of marks as a part of it.
RULER = 20.0
SHORT, LONG = 0.25, 0.55
# Marks between two numbers.
RULER_PARTS = 5


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
        """The name of a loose spring or particle under the pointer, and of a particle its mass and radius."""
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

        def at(fraction: float, aside: float) -> Point:
            x, y = a[0] + fraction * (b[0] - a[0]), a[1] + fraction * (b[1] - a[1])
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
        """Draw caps of the keys that drive a spring or motor."""
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
    return camera.to_pixels(scene.place(slot))


def rules_of(scene: Scene, rule: int | None, zones: frozenset[str]) -> list[RuleDef]:
    """The rule that a panel shows, or else those of the zones that are selected."""
    rules = scene.level.rules
    if rule is not None:
        return list(rules[rule : rule + 1])
    return [each for each in rules if zones.intersection(named_zones(each.when))]


def draw_links(surface: pygame.Surface, camera: Camera, scene: Scene, rules: list[RuleDef], scale: float) -> None:
    """Draw dots from the zones of rules to what they are about; without zones from what is asked to what is done."""
    for rule in rules:
        zones, things, targets = named_zones(rule.when), named_things(rule.when), acted_on(rule)
        starts = zones or things[:1]
        ends = [*things, *targets] if zones else [*things[1:], *targets]
        for start in _places(scene, starts):
            for end in _places(scene, ends):
                _draw_dots(surface, camera.to_pixels(start), camera.to_pixels(end), scale)


def _places(scene: Scene, names: list[str]) -> list[Point]:
    places = [_place(scene, name) for name in dict.fromkeys(names)]
    return [place for place in places if place is not None]


def _place(scene: Scene, name: str) -> Point | None:
    """The middle of a thing [m], or the place of a particle; None = it has none, as walls."""
    known = frozenset(scene.items)
    items = [Item(kind, name) for kind in PARTS if Item(kind, name) in known][:1]
    if not items and "." not in name:
        items = [item for item, group in groups_of(scene.level).items() if group == name]
    box = scene.bounds(frozenset(items)) if items else None
    if box is not None:
        return (box[0] + box[2]) / 2.0, (box[1] + box[3]) / 2.0
    try:
        return scene.place(scene.slot(name))
    except LookupError:
        return None


def _draw_dots(surface: pygame.Surface, start: Point, end: Point, scale: float) -> None:
    steps = int(min(math.dist(start, end) / (STEP * scale), 2_000))
    for fraction in np.linspace(0.0, 1.0, steps + 1).tolist():
        at = (start[0] + fraction * (end[0] - start[0]), start[1] + fraction * (end[1] - start[1]))
        pygame.draw.aacircle(surface, ZONE, at, DOT * scale)
    pygame.draw.aacircle(surface, ZONE, end, 3.0 * DOT * scale, max(1, round(1.6 * scale)))


class Rulers:
    """Both rulers, around a camera's viewport; their marks are kept until the view changes."""

    def __init__(self, ui: Ui) -> None:
        self._ui = ui
        self._key: tuple[object, ...] = ()
        self._pictures: list[pygame.Surface] = []

    def draw(self, surface: pygame.Surface, camera: Camera, pointer: Point | None) -> None:
        """Draw both rulers; pointer: where it is [pixels], if it is over the canvas."""
        size = self._ui.px(RULER)
        left, top, width, height = camera.viewport
        key = (camera.centre, camera.zoom, camera.viewport)
        if key != self._key:
            self._key = key
            spacing = grid_spacing(camera.zoom, GRID_STEP * self._ui.scale)
            self._pictures = [self._horizontal(camera, spacing), self._vertical(camera, spacing)]
        surface.blit(self._pictures[0], (left, top - size))
        surface.blit(self._pictures[1], (left - size, top))
        surface.fill(SURFACE, (left - size, top - size, size, size))
        unit = self._ui.font(9).render("m", True, MUTED)
        surface.blit(unit, unit.get_rect(center=(left - size / 2, top - size / 2)))
        surface.fill(LINE, (left - size, top - 1, width + size, 1))
        surface.fill(LINE, (left - 1, top - size, 1, height + size))
        if pointer is not None:
            surface.fill(ACCENT, (round(pointer[0]), top - size, 1, size))
            surface.fill(ACCENT, (left - size, round(pointer[1]), size, 1))

    def _horizontal(self, camera: Camera, spacing: float) -> pygame.Surface:
        left, _, width, _ = camera.viewport
        ruler = pygame.Surface((width, self._ui.px(RULER)))
        start = camera.to_world((left, 0.0))[0]
        self._mark(ruler, start, spacing, lambda x: camera.to_pixels((x, 0.0))[0] - left)
        return ruler

    def _vertical(self, camera: Camera, spacing: float) -> pygame.Surface:
        _, top, _, height = camera.viewport
        ruler = pygame.Surface((height, self._ui.px(RULER)))
        bottom = camera.to_world((0.0, top + height))[1]
        self._mark(ruler, bottom, spacing, lambda y: top + height - camera.to_pixels((0.0, y))[1])
        return pygame.transform.rotate(ruler, 90)

    def _mark(self, ruler: pygame.Surface, start: float, spacing: float, place: Callable[[float], float]) -> None:
        """Draw marks and numbers along a ruler that begins at `start` [m]."""
        ruler.fill(SURFACE)
        length, size = ruler.get_size()
        thick = self._ui.px(1)
        index = math.floor(start / spacing) * RULER_PARTS
        while (x := round(place(index * spacing / RULER_PARTS))) < length:
            is_numbered = index % RULER_PARTS == 0
            tall = round(size * (LONG if is_numbered else SHORT))
            ruler.fill(MUTED if is_numbered else LINE, (x, size - tall, thick, tall))
            if is_numbered:
                number = self._ui.font(9).render(f"{index // RULER_PARTS * spacing:.6g}", True, MUTED)
                if x + 3 * thick + number.get_width() <= length:
                    ruler.blit(number, (x + 3 * thick, 0))
            index += 1
