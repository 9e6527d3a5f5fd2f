"""The menu of the right button in play: what can be made of the thing under the pointer, each by commands."""

from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from typing import NamedTuple

from sandbox.app.contracts.screen import Pixel
from sandbox.app.draw.colours import DISABLED, TEXT, unpacked
from sandbox.app.play.stage import PICK_RADIUS, Stage
from sandbox.app.widgets.picker import open_menu_at
from sandbox.app.widgets.rows import Row
from sandbox.app.widgets.ui import Ui
from sandbox.editor.document import EditError
from sandbox.editor.edits.joining import copying_commands
from sandbox.level.format.look import PALETTE
from sandbox.physics.analysis.query import particle_at
from sandbox.physics.keeping.equipment import Firmness
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.softness.firmness import LARGEST_READ, WORDS, FirmnessRange, OutOfReach, firm_bodies
from sandbox.physics.world import World
from sandbox.session.commands import Command, Pin, Remove, ScaleMass, SetColour, SetFirmness, Unpin
from sandbox.tools.axle import Axle, axle_at, refitted, taken_out
from sandbox.tools.clearance import lift
from sandbox.tools.click import freezing
from sandbox.tools.dropping import in_own_groups
from sandbox.tools.tool import Loop

WIDTH = 190.0
NO_MOTOR, MOTOR, TAKE_OUT = "Loose, without its motor", "With a motor: A and D", "Take the axle out"
COLOUR, FEEL = "Colour ...", "Feel ..."
NO_FEEL = "It has no springs whose feel could be measured."
HOLD, LET_GO = "Hold it in the air", "Let it go from the air"
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
    within, place = PICK_RADIUS * stage.renderer.scale / stage.camera.zoom, stage.camera.to_world(pixel)
    particle, axle = particle_at(playback.current, place, within), axle_at(playback.current, place, within)
    if particle is None:
        return False
    entries = _entries(stage, particle) if axle is None else _axle_entries(playback.current, axle)
    hands = playback.level.hands

    def paint(index: int) -> None:
        playback.submit(SetColour(particle, list(PALETTE)[index]))

    def take(index: int) -> None:
        if entries[index].text == COLOUR:
            colours = [Row(name.capitalize(), swatch=unpacked(tone)) for name, tone in PALETTE.items()]
            open_menu_at(ui, pixel, ui.px(WIDTH), colours, paint, stage.camera.viewport)
            return
        if entries[index].text == FEEL and particle is not None:
            _show_feel(ui, stage, particle, say)
            return
        gesture = playback.session.new_gesture()
        try:
            commands = entries[index].make()
        except (EditError, OutOfReach) as error:
            say(f"{error}.".replace("..", "."))
            return
        for command in commands:
            playback.submit(command, gesture)

    rows = [Row(each.text, colour=TEXT if hands is None or hands.allows(each.deed) else DISABLED) for each in entries]
    open_menu_at(ui, pixel, ui.px(WIDTH), rows, take, stage.camera.viewport)
    return True


def cursor_actions(
    ui: Callable[[], Ui], stage: Stage, open_menu: Callable[[Pixel], None], say: Say
) -> dict[str, Callable[[], object]]:
    """Where keys take the cursor, and menu and feel of the thing at it, or under the mouse where there is no cursor."""

    def with_thing(do: Callable[[int], object]) -> None:
        particle = stage.pointed if stage.cursor is None else stage.at_cursor
        if particle is None:
            say("There is no thing at the cursor. N takes it to the next one.")
        else:
            do(particle)

    def open_at(particle: int) -> None:
        x, y = stage.playback.current.position[particle].tolist()
        open_menu(stage.camera.to_pixels((x, y)))

    return {
        "thing_menu": lambda: with_thing(open_at),
        "feel": lambda: with_thing(lambda particle: _show_feel(ui(), stage, particle, say)),
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
        entries = [_Offer(f"Make it {word}", "firmness", partial(_softened, world, form, word)) for word in WORDS]
    entries += [_Offer(text, "mass", partial(_weighed, particle, factor)) for text, factor in WEIGHTS]
    body = world.particle_names[particle].partition(".")[0]
    if any(body in joined.names and "kit" not in joined.definition for joined in world.joined):
        entries.append(_Offer(COLOUR, "", list))
    if (world.spring_active & ((world.particle_a == particle) | (world.particle_b == particle))).any():
        entries.append(_Offer(FEEL, "", list))
    is_fixed = not (state.inverse_mass[state.owner == state.owner[particle]] > 0.0).any()
    return [
        *entries,
        _Offer("Let it move" if is_fixed else "Fix it here", "pin", lambda: freezing(particle, playback.current)),
        _Offer("Copy it", "add", lambda: _copied(stage, particle)),
        _Offer("Delete it, with what hangs on it", "remove", lambda: [Remove(particle=particle)]),
    ]


def _show_feel(ui: Ui, stage: Stage, particle: int, say: Say) -> None:
    """Show how the body of a particle feels."""
    # What measures, which a window does without until then.
    from sandbox.app.panel.feel.feel_page import show_feel
    from sandbox.export.engines import body_at

    stage.playback.apply_pending()
    body = body_at(stage.playback.session.world, particle)
    if body is None:
        say(NO_FEEL)
    else:
        show_feel(ui, stage.playback, say, body)


def _axle_entries(state: Snapshot, axle: Axle) -> list[_Offer]:
    """Entries of the menu for an axle."""
    hub, other = int(axle.slots[0]), NO_MOTOR if axle.has_motor else MOTOR
    return [
        _Offer(other, "add", lambda: refitted(state, axle, not axle.has_motor)),
        _Offer(LET_GO, "pin", lambda: [Unpin(hub)]) if axle.is_pinned else _Offer(HOLD, "pin", lambda: [Pin(hub)]),
        _Offer(TAKE_OUT, "remove", lambda: taken_out(axle)),
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
            world, way = playback.session.world, (dx, dy + by)
            return list(in_own_groups(copying_commands(playback.level, world, particle, way)))
    raise EditError(NO_ROOM)
