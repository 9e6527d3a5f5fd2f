"""The menu of the right button in play: what can be made of the thing under the pointer, each by commands."""

from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from typing import NamedTuple

from sandbox.app.contracts.screen import Pixel
from sandbox.app.draw.colours import DISABLED, TEXT
from sandbox.app.play.stage import PICK_RADIUS, Stage
from sandbox.app.widgets.picker import open_menu_at
from sandbox.app.widgets.rows import Row
from sandbox.app.widgets.ui import Ui
from sandbox.editor.document import EditError
from sandbox.editor.edits.joining import copying_commands
from sandbox.physics.analysis.query import particle_at
from sandbox.physics.keeping.equipment import Firmness
from sandbox.physics.softness.firmness import LARGEST_READ, WORDS, FirmnessRange, OutOfReach, firm_bodies
from sandbox.physics.world import World
from sandbox.session.commands import Command, Remove, ScaleMass, SetFirmness
from sandbox.tools.clearance import lift
from sandbox.tools.click import freezing
from sandbox.tools.tool import Loop

WIDTH = 190.0
SOFTNESSES = ("jelly", "soft", "firm")
WEIGHTS = (("Half as heavy", 0.5), ("Twice as heavy", 2.0))
NO_ROOM = "There is no room for a copy beside it."
Say = Callable[[str], None]


class _Offer(NamedTuple):
    """A row: its words, the deed that a level may keep away, and the commands that it gives, one gesture."""

    text: str
    deed: str
    make: Callable[[], list[Command]]


def open_thing_menu(ui: Ui, stage: Stage, pixel: Pixel, say: Say) -> bool:
    """Offer what can be made of the thing under a pixel; whether there is one."""
    playback = stage.playback
    playback.apply_pending()
    within = PICK_RADIUS * stage.renderer.scale / stage.camera.zoom
    particle = particle_at(playback.current, stage.camera.to_world(pixel), within)
    if particle is None:
        return False
    entries = _entries(stage, particle)
    hands = playback.level.hands

    def take(index: int) -> None:
        gesture = playback.session.new_gesture()
        try:
            commands = entries[index].make()
        except (EditError, OutOfReach) as error:
            say(f"{error}.".replace("..", "."))
            return
        for command in commands:
            playback.submit(command, gesture)

    rows = [Row(each.text, colour=TEXT if hands is None or hands.allows(each.deed) else DISABLED) for each in entries]
    open_menu_at(ui, pixel, ui.px(WIDTH), rows, take)
    return True


def cursor_actions(stage: Stage, open_menu: Callable[[Pixel], None], say: Say) -> dict[str, Callable[[], object]]:
    """Where keys take the cursor, and the menu of the thing at it, or under the mouse where there is no cursor."""

    def open_here() -> None:
        particle = stage.pointed if stage.cursor is None else stage.at_cursor
        if particle is None:
            say("There is no thing at the cursor. N takes it to the next one.")
        else:
            x, y = stage.playback.current.position[particle].tolist()
            open_menu(stage.camera.to_pixels((x, y)))

    return {
        "thing_menu": open_here,
        "next_thing": lambda: stage.visit_thing(1),
        "previous_thing": lambda: stage.visit_thing(-1),
        "next_particle": lambda: stage.visit_particle(1),
        "previous_particle": lambda: stage.visit_particle(-1),
    }


def _entries(stage: Stage, particle: int) -> list[_Offer]:
    """Entries of the menu for the body of a particle."""
    playback = stage.playback
    world, state = playback.session.world, playback.current
    form, entries = _form_of(world, particle), list[_Offer]()
    if form is not None:
        entries = [_Offer(f"Make it {word}", "firmness", partial(_softened, world, form, word)) for word in SOFTNESSES]
    entries += [_Offer(text, "mass", partial(_weighed, particle, factor)) for text, factor in WEIGHTS]
    is_fixed = not (state.inverse_mass[state.owner == state.owner[particle]] > 0.0).any()
    return [
        *entries,
        _Offer("Let it move" if is_fixed else "Fix it here", "pin", lambda: freezing(particle, playback.current)),
        _Offer("Copy it", "add", lambda: _copied(stage, particle)),
        _Offer("Delete it, with what hangs on it", "remove", lambda: [Remove(particle=particle)]),
    ]


def _form_of(world: World, particle: int) -> int | None:
    """The number of the body of a particle among those whose firmness can be set; None: it has none."""
    for number, body in enumerate(firm_bodies(world)):
        springs = body.springs
        if particle in world.particle_a[springs] or particle in world.particle_b[springs]:
            return number if len(body.shape.points) <= LARGEST_READ else None
    return None


def _softened(world: World, form: int, word: str) -> list[Command]:
    """The command that makes a body so soft, or as nearly so as can be. Raises OutOfReach."""
    settings = world.settings
    reach = FirmnessRange.of(firm_bodies(world)[form].shape, settings.gravity, settings.tick_rate)
    if reach.lowest_mode == 0.0:
        raise EditError("its form is not stiff without pins: it has no softness of its own")
    return [SetFirmness(form, **asdict(reach.as_wobble(reach.nearest(Firmness(sag=WORDS[word])))))]


def _weighed(particle: int, factor: float) -> list[Command]:
    return [ScaleMass(particle, factor)]


def _copied(stage: Stage, particle: int) -> list[Command]:
    """The commands that add a copy of a body beside it, where it has room. Raises EditError."""
    playback = stage.playback
    state = playback.current
    own = state.position[state.particle_active & (state.owner == state.owner[particle])]
    radius = float(state.radius[particle])
    low, high = own.min(axis=0) - radius, own.max(axis=0) + radius
    width, height = (1.1 * (high - low)).tolist()
    for dx, dy in ((width, 0.0), (-width, 0.0), (0.0, height)):
        left, bottom, right, top = low[0] + dx, low[1] + dy, high[0] + dx, high[1] + dy
        box: Loop = [(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)]
        by = lift([box], state) if playback.level.has_contacts else 0.0
        if by is not None:
            return list(copying_commands(playback.level, playback.session.world, particle, (dx, dy + by)))
    raise EditError(NO_ROOM)
