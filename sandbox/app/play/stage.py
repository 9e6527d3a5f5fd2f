"""Stage: the world on the screen: pointer and keyboard cursor to tools, pan and zoom, and the drawing of it."""

import math
from typing import Literal

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.base.idle import RestTimer
from sandbox.app.base.loop import Profile
from sandbox.app.draw.camera import FIT_MARGIN, Box, Camera, bounds
from sandbox.app.draw.picture import PartGhost, particles_of, view_of
from sandbox.app.draw.renderer import Detail, Overlay, Renderer
from sandbox.app.film.film import Film
from sandbox.app.run.followers import StabilityPaint
from sandbox.app.run.playback import Playback
from sandbox.editor.edits.joining import joining_commands, sized
from sandbox.level.document.model import Level
from sandbox.physics.analysis.applied_forces import Pull, pulls_of
from sandbox.physics.analysis.query import nearest_particle, particle_at, shown_particles
from sandbox.physics.arrays import Slots
from sandbox.physics.components import body_of
from sandbox.physics.geometry.segment import lengths
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import World
from sandbox.session.commands import Command
from sandbox.session.session import Session
from sandbox.tools.drag import DRAG, DragTool
from sandbox.tools.dropping import CatalogueTool, in_own_groups
from sandbox.tools.play_tools import PLAY_TOOLS
from sandbox.tools.tool import PointerEvent, Tool, usual_size

# How far off a particle a press still hits it, and a step of the keyboard cursor [layout units].
PICK_RADIUS = 14.0
CURSOR_STEP, CURSOR_LEAP = 4.0, 24.0

# What is above of the height that a view has to spare, where there is ground; what stays free round a level's view.
SKY, VIEW_MARGIN = 0.8, 0.03

# A run in which nothing is seen to move for so long [s] is at rest.
AT_REST_AFTER = 1.0

Pixel = tuple[float, float]
# The tool that is in use at first, and the one that has a part of the catalogue in hand.
HAND_TOOL, CATALOGUE = DRAG.name, "part"


class Stage:
    """One run on the screen, in the viewport (left, top, width, height) [pixels] of its camera."""

    def __init__(self, playback: Playback, viewport: tuple[int, int, int, int], scale: float) -> None:
        self.playback = playback
        self.camera = Camera(viewport=viewport)
        self.renderer = Renderer(scale, playback.level)
        self.cursor: tuple[float, float] | None = None
        # The particle that the cursor goes along with; None: it stays where arrows took it.
        self._marked: int | None = None
        self.pressed_by_key = False
        self._hovered: int | None = None
        # An earlier run at the same tick, which is seen behind this one; None: none is.
        self.earlier: Snapshot | None = None
        # Springs (m,) that are pointed at in a panel; None: nothing is.
        self.lit: NDArray[np.bool_] | None = None
        # What the wheel made of the parts and the ring [m]; 0: nothing yet.
        self.size = 0.0
        # The part of the catalogue that is in hand, or was last.
        self.part: Level | None = None
        self._paint = StabilityPaint()
        self.following = Following()
        self._ghost = PartGhost()
        self.detail = Detail()
        self.rest_timer = RestTimer()
        # What is drawn however long frames take; None: as `detail` has it.
        self.fixed_detail: int | None = None
        self._make_tools("normal")
        self._follow_as_the_level_says()
        self.first_box = view_of(playback.level, playback.current)
        self._fit(self.first_box)

    def _make_tools(self, strength: str) -> None:
        new_gesture = self.playback.session.new_gesture
        # The hand is there whichever tool is in use.
        self.drag = DragTool(new_gesture, strength)
        self.tools: dict[str, Tool] = {name: tool.make(new_gesture) for name, tool in PLAY_TOOLS.items()}
        self.tools[HAND_TOOL] = self.drag
        for tool in self.tools.values():
            if tool.adds:
                tool.touches = self.playback.level.has_contacts
        self.tool_name = HAND_TOOL
        if self.part is not None:
            self.tools[CATALOGUE] = self._catalogue_tool(self.part)

    def _catalogue_tool(self, part: Level) -> CatalogueTool:
        left, bottom, right, top = particles_of(Session(part).snapshot())
        size = right - left, top - bottom

        def make(place: tuple[float, float], velocity: tuple[float, float], times: float) -> tuple[Command, ...]:
            # The pointer is in the middle of what it throws.
            at = place[0] - times * (left + right) / 2, place[1] - times * (bottom + top) / 2
            return in_own_groups(joining_commands(sized(part, times), self.playback.session.world, at, velocity))

        tool = CatalogueTool(self.playback.session.new_gesture, part, make, size)
        tool.touches = self.playback.level.has_contacts
        return tool

    def take_part(self, part: Level) -> None:
        """Take a part of the catalogue in hand."""
        self.part = part
        self.tools[CATALOGUE] = self._catalogue_tool(part)
        self.choose_tool(CATALOGUE)

    @property
    def tool(self) -> Tool:
        """The tool in use."""
        return self.tools[self.tool_name]

    def choose_tool(self, name: str) -> None:
        """Take another tool up; what is held stays held. What has a size begins with one that the view has room for."""
        if self.tool is not self.drag:
            self.playback.respond(self.tool.cancel())
        self.tool_name = name
        self.pressed_by_key = False
        height = self.camera.viewport[3] / self.camera.zoom
        self.tool.take_up(self.size or usual_size(height), height)

    def resize(self, steps: float) -> bool:
        """Make larger what the tool drops or reaches; whether it has a size."""
        has_size = self.tool.resize(steps)
        self.size = self.tool.size_to_share or self.size
        return has_size

    def _follow_as_the_level_says(self) -> None:
        look, names = self.playback.level.look, self.playback.session.world.particle_names
        if look is None or look.follow is None:
            return
        of_it = (k for k, name in enumerate(names) if name == look.follow or name.startswith(f"{look.follow}."))
        self.following.begin(next(of_it, None))

    def follow_with_camera(self, picked: int | None) -> str:
        """Follow with the camera what is held, pointed at, picked or driven, or stop; gives a line that says so."""
        if self.following.particle is not None:
            self.following.begin(None)
            return "The camera stands still."
        held = [hold.particle for hold in self.drag.holds.values()]
        found = [*held[-1:], self.pointed, picked, driven_particle(self.playback.session.world)]
        self.following.begin(next((particle for particle in found if particle is not None), None))
        if self.following.particle is None:
            return "Point at something, or hold it, and press Shift+F: the camera follows it."
        return "The camera follows. Shift+F stops it."

    def replace_playback(self, playback: Playback) -> None:
        """Show another run of the same level, with the same camera and tool."""
        name = self.tool_name
        self.playback = playback
        self.pressed_by_key = False
        self._make_tools(self.drag.strength)
        self.choose_tool(name)

    def fit(self) -> None:
        """Show the level's view, or all of its particles; asked for again, all particles wherever they are.

        Where an explosion has carried them farther than any zoom shows, the view that the run began with.
        """
        snapshot = self.playback.current
        box = view_of(self.playback.level, snapshot)
        if self._is_fitted and self._box == box:
            box = bounds(snapshot.position[shown_particles(snapshot)])
        if not self.camera.can_show(box):
            box = self.first_box
            self.playback.messages.append("Some particles are too far away to be shown. Ctrl+Z or R brings them back.")
        self._fit(box)

    def _fit(self, box: Box) -> None:
        level = self.playback.level
        # There is more to see above ground than in it, and a view of the level's own has its margins.
        margin = VIEW_MARGIN if box == level.view else FIT_MARGIN
        self.camera.fit(box, SKY if level.terrain else 0.5, margin)
        self._box, self._fitted_at = box, (self.camera.centre, self.camera.zoom)

    @property
    def fitted_box(self) -> Box | None:
        """The box [m] of the last fit, while the camera is as it left it."""
        return self._box if self._is_fitted else None

    @property
    def _is_fitted(self) -> bool:
        """Whether the camera is as the last fit left it."""
        return self._fitted_at == (self.camera.centre, self.camera.zoom)

    def place(self, viewport: tuple[int, int, int, int], scale: float) -> None:
        """Move to another part of the window and keep showing about the same."""
        before, fitted = self.camera.viewport, self._is_fitted
        self.camera.viewport = viewport
        self.renderer.scale = scale
        if fitted:
            self._fit(self._box)
        else:
            # By areas, so that a window made smaller and larger again shows what it showed.
            self.camera.zoom *= math.sqrt(viewport[2] * viewport[3] / max(before[2] * before[3], 1))

    def contains(self, pixel: Pixel) -> bool:
        """Whether a pixel shows the world."""
        return pygame.Rect(self.camera.viewport).collidepoint(pixel)

    def share_tools(self, other: "Stage") -> None:
        """Use the tools, the hand and the overlays of another stage."""
        self.tools, self.tool_name = other.tools, other.tool_name
        self.drag = other.drag
        self.renderer.overlays.shown = other.renderer.overlays.shown

    def point(
        self, kind: Literal["down", "move", "up"], pixel: Pixel, modifiers: int, button: int = 1,
        among: Snapshot | None = None,
    ) -> None:  # fmt: skip
        """Hand a pointer event to the tool; among: what it picks from, if not from the present state."""
        if self.playback.has_pending:
            self.playback.apply_pending()
        event = PointerEvent(
            kind,
            self.camera.to_world(pixel),
            self._within,
            button,
            bool(modifiers & pygame.KMOD_SHIFT),
            bool(modifiers & pygame.KMOD_CTRL),
            pygame.time.get_ticks() / 1000.0,
            self.playback.clock.paused,
        )
        self.playback.respond(self.tool.handle(event, self.playback.current if among is None else among))

    def toggle_view(self, name: str) -> None:
        """Switch an overlay on or off: one of views.overlays.NAMES."""
        self.renderer.overlays.shown ^= {name}

    def let_go(self) -> None:
        """Release all that tools hold, and cancel their gestures."""
        for tool in self.tools.values():
            self.playback.respond(tool.cancel())
        self.tool_name = HAND_TOOL
        self.pressed_by_key = False
        self.cursor = None

    # Keyboard cursor.

    def move_cursor(self, dx: int, dy: int, modifiers: int) -> None:
        """Move the keyboard cursor, which appears in the middle at first; dy is upward."""
        self._marked = None
        step = (CURSOR_LEAP if modifiers & pygame.KMOD_SHIFT else CURSOR_STEP) * self.renderer.scale
        x, y = self._cursor_pixel()
        left, top, width, height = self.camera.viewport
        moved = (min(max(x + dx * step, left), left + width), min(max(y - dy * step, top), top + height))
        self._cursor_to(moved, modifiers)

    def press_cursor(self, modifiers: int) -> None:
        """Press the tool at the keyboard cursor, or release it, if it is one that is held."""
        pixel = self._cursor_pixel()
        self._cursor_to(pixel, modifiers)
        self.point("up" if self.pressed_by_key else "down", pixel, modifiers)
        self.pressed_by_key = not self.pressed_by_key and self.tool.is_held

    def visit_thing(self, by: int) -> None:
        """Move the keyboard cursor into the next thing, or the one before, where its middle is."""
        snapshot, slots, here = self.playback.current, self._visited, self._here
        if not len(slots):
            return
        things, first = np.unique(snapshot.owner[slots], return_index=True)
        things = things[np.argsort(first)]
        # Without a cursor the first one comes, or the last one.
        now = min(-by, 0) if here is None else int(np.flatnonzero(things == snapshot.owner[here])[0])
        own = slots[snapshot.owner[slots] == things[(now + by) % len(things)]]
        middle = snapshot.position[own].mean(axis=0)
        self._mark(int(own[np.argmin(lengths(snapshot.position[own] - middle))]))

    def visit_particle(self, by: int) -> None:
        """Move the keyboard cursor to the next particle of its thing, or the one before."""
        snapshot, slots, here = self.playback.current, self._visited, self._here
        if here is None:
            self.visit_thing(by)
            return
        own = slots[snapshot.owner[slots] == snapshot.owner[here]]
        self._mark(int(own[(int(np.searchsorted(own, here)) + by) % len(own)]))

    @property
    def _visited(self) -> NDArray[np.intp]:
        """The particles that the keyboard cursor goes to."""
        snapshot = self.playback.current
        return np.flatnonzero(shown_particles(snapshot) & np.isfinite(snapshot.position).all(axis=1))

    @property
    def _here(self) -> int | None:
        """The particle at the keyboard cursor, or next to it; None: there is no cursor, or nothing."""
        if self.cursor is None:
            return None
        return nearest_particle(self.playback.current, self.cursor, np.inf) if self._marked is None else self._marked

    def _mark(self, particle: int) -> None:
        self._marked = particle
        x, y = self.playback.current.position[particle].tolist()
        self._cursor_to(self.camera.to_pixels((x, y)), 0)

    def _go_along(self) -> None:
        """Move the keyboard cursor with its particle, unless it holds something."""
        if self._marked is not None and self._marked not in self._visited:
            self._marked = None
        if self._marked is not None and self.cursor is not None and not self.pressed_by_key:
            x, y = self.playback.current.position[self._marked].tolist()
            self.cursor = x, y

    def _cursor_pixel(self) -> Pixel:
        return self.camera.middle if self.cursor is None else self.camera.to_pixels(self.cursor)

    def _cursor_to(self, pixel: Pixel, modifiers: int) -> None:
        self.cursor = self.camera.to_world(pixel)
        if self.pressed_by_key:
            self.point("move", pixel, modifiers)

    @property
    def pointed(self) -> int | None:
        """The particle under the mouse, or else at the keyboard cursor."""
        return self.at_cursor if self._hovered is None else self._hovered

    @property
    def at_cursor(self) -> int | None:
        """The particle at the keyboard cursor; None: there is no cursor, or nothing at it."""
        if self.cursor is None:
            return None
        return nearest_particle(self.playback.current, self.cursor, self._within)

    def at_pixel(self, pixel: Pixel) -> int | None:
        """The particle of the thing at a pixel; None: there is nothing."""
        return particle_at(self.playback.current, self.camera.to_world(pixel), self._within)

    @property
    def _within(self) -> float:
        """How far off [m] a press still hits a particle."""
        return PICK_RADIUS * self.renderer.scale / self.camera.zoom

    # A frame.

    def pulls(self) -> list[Pull]:
        """How hard each hand pulls, and where."""
        world = self.playback.session.world
        return pulls_of(world) if world.any_held() else []

    @property
    def rests(self) -> bool:
        """Whether nothing has been seen to move for a while, nothing flies about, and no hand holds anything."""
        has_stood = self.rest_timer.lasted >= AT_REST_AFTER and self.renderer.effects.is_at_rest
        return has_stood and not self.playback.session.world.any_held()

    def update(self, frame_time: float, pointer: Pixel | None, profile: Profile, passed: float = 0.0) -> None:
        """Apply what is due and let time pass; pointer: where the mouse is over the world, if it is.

        passed [s]: what of the same frame the run has gone on already.
        """
        if frame_time > 0.0:
            # What stands is drawn rarely, which says nothing of how long drawing takes.
            if not (self.playback.clock.paused or self.rests):
                self.detail.note(frame_time)
            self.renderer.detail = self.detail.level if self.fixed_detail is None else self.fixed_detail
        with profile.part("commands"):
            self.playback.apply_pending()
            for tool in self.tools.values():
                tool.reconcile(self.playback.current)
        with profile.part("ticks"):
            self.playback.advance(frame_time)
        if not self.drag.dragging:
            # A hand at the edge of the picture would else drag the picture along, and itself.
            self.following.update(self.camera, self.playback.session.world, self.playback.current, frame_time)
        self._go_along()
        self.playback.activity.note(self.playback.current)
        self.rest_timer.follow(self.playback.current, self.camera.zoom, frame_time + passed)
        at = None if pointer is None else self.camera.to_world(pointer)
        self.tool.hover(at if self.cursor is None else self.cursor)
        self._hovered = None if at is None else self.tool.target(at, self._within, self.playback.current)

    def film(self, span: tuple[int, int]) -> Film:
        """A film of some ticks of the run as the stage shows it."""
        return Film(self.playback.session, self.camera, self.renderer, span, self.fitted_box)

    def draw(self, surface: pygame.Surface, profile: Profile) -> None:
        """Draw the world into the viewport."""
        surface.set_clip(self.camera.viewport)
        playback = self.playback
        tool = self.tool
        overlay = Overlay(self._hovered, tool.trail, self.cursor, self.pulls(), lit=self.lit)
        overlay.ghost, overlay.is_refused, overlay.earlier = tool.ghost, not tool.fits, self.earlier
        if tool.place is not None and tool.preview is not None:
            picture = self._ghost.picture(tool.preview, self.camera.zoom, self.renderer)
            if picture is not None:
                overlay.ghost_picture = picture, tool.landing or tool.place
                overlay.ghost = [] if tool.preview.replaces_ghost and tool.fits else overlay.ghost
        if "stability" in self.renderer.overlays.shown:
            overlay.stability = self._paint.shares(playback.session.world, playback.revision)
        alpha = playback.clock.alpha(playback.session.world.settings.tick_rate)
        self.renderer.draw(surface, self.camera, playback.previous, playback.current, alpha, overlay, profile)
        surface.set_clip(None)


# The camera makes up all but a third of what it is behind in so long [s].
LAG = 0.25


def driven_particle(world: World) -> int | None:
    """A particle of the first thing that a motor, a hydraulic or a muscle drives; None: nothing is driven."""
    actuators = world.actuators
    if len(actuators.motors.hub):
        return int(actuators.motors.hub[0])
    for springs in (actuators.hydraulics.spring, actuators.muscles.spring):
        if len(springs):
            return int(world.particle_a[springs[0]])
    return None


class Following:
    """The body that a camera follows, by one of its particles (None: nothing)."""

    def __init__(self) -> None:
        self.particle: int | None = None
        self._body: Slots | None = None
        self._of: object = None

    def begin(self, particle: int | None) -> None:
        """Go along with the body of a particle from now on; None: with nothing."""
        self.particle, self._of = particle, None

    def update(self, camera: Camera, world: World, shown: Snapshot, frame_time: float) -> None:
        """Move a camera on by a frame; what is gone or nowhere is not followed."""
        if self.particle is None:
            return
        if self.particle >= len(shown.position) or not shown.particle_active[self.particle]:
            self.begin(None)
            return
        key = (world, world.topology_version)
        if key != self._of:
            self._of, self._body = key, body_of(world, self.particle)
        assert self._body is not None
        body = self._body[self._body < len(shown.position)]
        free = body[shown.inverse_mass[body] > 0.0]
        places = shown.position[free if len(free) else body]
        middle = places[np.isfinite(places).all(axis=1)]
        if not len(middle):
            return
        x, y = middle.mean(axis=0).tolist()
        gain = 1.0 - math.exp(-frame_time / LAG)
        across, up = camera.centre
        camera.centre = across + gain * (x - across), up + gain * (y - up)
