"""What is seen and heard of a jelly that was cut: a skin and a face for each piece that is large enough."""

from itertools import pairwise

import numpy as np
import pytest

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import THEMES
from sandbox.app.draw.picture import draw_picture, view_of
from sandbox.app.draw.raster.painter import Painter
from sandbox.app.draw.textures import Tiles
from sandbox.app.draw.things.drawables import Drawables
from sandbox.app.draw.things.faces import LEAST_OWN
from sandbox.app.draw.things.level_slots import Frame, level_slots_of, strain_of, whole_triangles
from sandbox.app.draw.things.soft import FLAT
from sandbox.app.sound.sound_events import SoundEvents, timbres_of
from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.physics.geometry.segment import winding_number
from sandbox.session.commands import CutSprings
from tests.support.cutting import SOFT_LEVELS, STROKES, actor_of, advance, begun, crossed, cut, level_with

SIZE = (1280, 720)
# Of rubber and of wood.
FACELESS = ("jelly_wheel", "balloons")
# Eyes and mouth lie within this part of a face's size around its centre.
ROUND_FACE = 0.33


def drawn(session):
    """What is drawn of a run now, and the frame it is drawn in."""
    state, camera = session.snapshot(), Camera(viewport=(0, 0, *SIZE))
    camera.fit(view_of(session.level, state))
    theme = THEMES["dark"]
    at = camera.project(state.position)
    frame = Frame(state, at, np.zeros(len(at)), strain_of(state, state.position), camera.zoom, 1.0, theme, Tiles(theme))
    particles, springs, whole = shown_particles(state), shown_springs(state), whole_triangles(state)
    things = Drawables(level_slots_of(session.level), state, particles, springs, whole)
    things.soft.trace(Painter(), frame)
    return things, frame


def loops_of(things):
    """Corners [pixels] of every outline that is drawn."""
    point, start = things.soft.outlines.point, things.soft.outlines.start
    return [point[first:last] for first, last in pairwise(start.tolist())]


def holds(loop, place):
    return winding_number(place, loop, np.roll(loop, -1, axis=0)) != 0


@pytest.mark.parametrize("stroke", STROKES)
@pytest.mark.parametrize("name", [name for name in SOFT_LEVELS if name not in FACELESS])
def test_after_a_cut_each_face_lies_inside_an_outline(name, stroke):
    session = begun(level_with(name, "direct"))
    for body in SOFT_LEVELS[name]:
        cut(session, body, stroke)
    for ticks in (1, 30, 150):
        advance(session, ticks)
        things, frame = drawn(session)
        centre, turn, size = things.faces.placed(frame)
        loops = loops_of(things)
        for at, (cosine, sine), wide in zip(centre, turn, size, strict=True):
            marks = [at + ROUND_FACE * wide * np.array([cosine * x - sine * y, sine * x + cosine * y])
                     for x, y in ((0, 0), (1, -0.3), (-1, -0.3), (0, 0.6))]  # fmt: skip
            assert any(all(holds(loop, mark) for mark in marks) for loop in loops)


@pytest.mark.parametrize("stroke", STROKES)
def test_one_face_stays_with_the_piece_it_was_on_and_the_other_piece_has_its_own_only_if_it_is_large(stroke):
    session = begun(level_with("jelly_pile", "direct"))
    before = len(drawn(session)[0]._faces)
    actor = cut(session, "cube 1", stroke)
    session.advance()
    things, _ = drawn(session)
    own = [face for face in things._faces if set(face.slots.tolist()) <= set(actor.slots.tolist())]
    whole = max(face.radius for face in things._faces)
    assert 1 <= len(own) <= 2 and len(things._faces) == before - 1 + len(own)
    assert all(face.radius <= whole for face in own)
    if len(own) == 2:
        assert not set(own[0].slots.tolist()) & set(own[1].slots.tolist())
        assert min(face.radius for face in own) >= LEAST_OWN * 0.75


def test_a_crumb_has_the_colour_of_its_body_and_neither_skin_nor_face():
    session = begun(level_with("jelly_pile", "direct"), 0)
    actor = actor_of(session.level, "cube 1")
    corner = int(actor.slots[0])
    ends = np.stack([session.world.particle_a, session.world.particle_b], axis=1)
    cell = actor.slots[[0, 1, 5]]
    inside = np.isin(ends, cell).sum(axis=1)
    session.world.cut(np.flatnonzero((inside == 1) & shown_springs(session.world)))
    things, _ = drawn(session)
    (crumb,) = [shape for shape in things.soft.shapes if corner in shape.loops[0]]
    (rest,) = [shape for shape in things.soft.shapes if int(actor.slots[12]) in shape.flushed_slots]
    assert (crumb.skin, crumb.colour, crumb.flushed) == (FLAT, rest.colour, None)
    assert rest.skin == actor.look.skin
    assert not any(corner in face.slots for face in things._faces)


def test_undo_gives_one_skin_and_one_face_again():
    session = begun(level_with("jelly_pile", "direct"))
    first = draw_picture(session.level, session.snapshot(), (640, 360)).get_buffer().raw
    cut(session, "cube 1", "across")
    session.apply_pending()
    assert draw_picture(session.level, session.snapshot(), (640, 360)).get_buffer().raw != first
    session.undo()
    session.apply_pending()
    assert draw_picture(session.level, session.snapshot(), (640, 360)).get_buffer().raw == first


def test_pieces_sound_like_their_body_and_higher_and_the_cut_itself_is_heard():
    session = begun(level_with("jelly_pile", "direct"))
    events = SoundEvents()
    events.hear(session.world)
    whole = timbres_of(session.world)
    number = int(np.flatnonzero(whole.owner == 0)[0])
    actor = cut(session, "cube 1", "across")
    session.advance()
    events.hear(session.world)
    assert any(sounding.note.kind == "snap" for sounding in events.heard)
    parted = timbres_of(session.world)
    numbers = np.unique(parted.body[actor.slots])
    assert len(numbers) == 2
    for piece in numbers.tolist():
        assert parted.stuff[piece] == whole.stuff[number] == "jelly"
        assert parted.mass[piece] < whole.mass[number] and parted.pitch[piece] > whole.pitch[number]


def test_cutting_twice_leaves_three_skins():
    session = begun(level_with("jelly_wheel", "iterative"), 0)
    actor = cut(session, "wheel", "across")
    session.advance()
    session.submit(CutSprings(crossed(session, actor, "along")))
    session.advance()
    things, _ = drawn(session)
    assert len([shape for shape in things.soft.shapes if shape.skin != FLAT]) >= 3
