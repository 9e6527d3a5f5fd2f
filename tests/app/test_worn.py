"""Pictures that bodies wear, in the window: they move, turn and deform with the body, and are chosen in the editor."""

import numpy as np
import pygame
import pytest

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.renderer import Renderer
from sandbox.app.widgets.property_widgets import OTHER_PICTURE
from sandbox.editor.items import Item
from sandbox.editor.storage.autosave import Autosave, orphans
from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.files import read_level
from sandbox.level.reading.pictures import pictures_of
from sandbox.physics.analysis.query import shares_crossed, springs_crossing
from sandbox.physics.snapshot import take
from sandbox.session.commands import CutSprings
from sandbox.session.session import Session
from tests.app.test_look_menus import form_of, look, pick
from tests.support.worn import BLUE, GREEN, NAME, RED, YELLOW, box, four, level_file

SIZE, ZOOM = (480, 360), 50.0
# Places of the middles of its colours in a box of 4 m by 2 m about the origin.
MIDDLES = {(-1.0, 0.5): RED, (1.0, 0.5): GREEN, (-1.0, -0.5): BLUE, (1.0, -0.5): YELLOW}
ROUND = {"segments": 16, "look": {"picture": NAME}}


def colours_at(level, state, places):
    """Colours of a picture of a state at places [m]."""
    surface, camera = pygame.Surface(SIZE, 0, 32), Camera((0.0, 0.0), ZOOM, (0, 0, *SIZE))
    Renderer(1.0, level).draw(surface, camera, state, state, 1.0)
    return [surface.get_at(tuple(map(round, camera.to_pixels(place))))[:3] for place in places]


@pytest.mark.parametrize(
    "moved",
    [
        lambda x, y: (x, y),
        lambda x, y: (0.5 - y, x - 0.25),
        lambda x, y: (0.9 * x, 1.5 * y),
        lambda x, y: (x + 0.4 * y, y),
    ],
    ids=["as it is", "moved and turned by 90 degrees", "stretched", "sheared"],
)
def test_a_picture_goes_with_the_body(tmp_path, moved):
    level = read_level(level_file(tmp_path))
    world = build_world(level)
    world.position[:] = np.stack(moved(*world.position.T), axis=1)
    state = take(world)
    assert colours_at(level, state, [moved(*place) for place in MIDDLES]) == list(MIDDLES.values())


@pytest.mark.parametrize(
    "body",
    [
        box(angle=np.pi / 2),
        box(shape={"circle": 1.5}, mesh="fitted", spacing=0.4, angle=np.pi / 2),
        {"type": "ring", "id": "ring", "radius": 1.5, "angle": 0.0, **ROUND},
        {"type": "wheel", "id": "wheel", "radius": 1.5, "thickness": 0.5, **ROUND},
    ],
    ids=["box", "disc", "ring", "wheel"],
)
def test_each_kind_wears_it_as_it_is_described_then_turned(tmp_path, body):
    level = read_level(level_file(tmp_path, body))
    is_turned = body["type"] == "jelly"
    places = [(-y, x) if is_turned else (x, y) for x in (-0.5, 0.5) for y in (-0.5, 0.5)]
    assert colours_at(level, Session(level).snapshot(), places) == [BLUE, RED, YELLOW, GREEN]


def test_pieces_of_a_cut_body_keep_their_parts_of_the_picture(tmp_path):
    level = read_level(level_file(tmp_path, box(spacing=0.5)))
    session = Session(level)
    ends = session.world.position[np.stack([session.world.particle_a, session.world.particle_b], axis=1)]
    across = np.flatnonzero((ends[:, :, 0].min(axis=1) < 0.25) & (ends[:, :, 0].max(axis=1) > 0.25))
    session.submit(CutSprings(tuple(across.tolist())))
    session.advance()
    position = session.world.position
    position[position[:, 0] > 0.25] += (0.5, 1.0)
    parted = take(session.world)
    places = [(x + 0.5, y + 1.0) if x > 0 else (x, y) for x, y in MIDDLES]
    assert colours_at(level, parted, places) == list(MIDDLES.values())
    assert colours_at(level, parted, [(0.5, 0.0)])[0] not in MIDDLES.values()


def test_a_clean_cut_leaves_the_picture_where_it_was(tmp_path):
    level = read_level(level_file(tmp_path, box(spacing=0.5)))
    session, stroke = Session(level), ((-1.8, 1.5), (1.3, -1.5))
    springs = springs_crossing(session.world, *stroke)
    shares = shares_crossed(session.world, springs, *stroke)
    session.submit(CutSprings(tuple(springs.tolist()), tuple(shares.tolist())))
    session.advance()
    places = [(share * x, share * y) for share in (0.2, 0.3, 0.5) for x, y in MIDDLES]
    assert colours_at(level, session.snapshot(), places) == 3 * list(MIDDLES.values())


def test_where_a_picture_is_transparent_the_colour_shows(tmp_path):
    clear = pygame.Surface((8, 8), pygame.SRCALPHA)
    clear.fill((*GREEN, 255), (0, 0, 4, 8))
    pygame.image.save(clear, tmp_path / "clear.png")
    body = box(look={"colour": "#102030", "picture": NAME})
    level = read_level(level_file(tmp_path, body, picture=(tmp_path / "clear.png").read_bytes()))
    assert colours_at(level, Session(level).snapshot(), [(-1.0, 0.0), (1.0, 0.0)]) == [GREEN, (16, 32, 48)]


@pytest.fixture
def worn(edit, tmp_path):
    path = level_file(tmp_path, box(look={}))
    driver = edit()
    driver.app.documents.open(path)
    driver.frames(2)
    driver.editor.select(frozenset([Item("body", "box")]))
    driver.frames(2)
    return driver


def test_a_picture_beside_the_level_is_chosen_undone_and_taken_away(worn):
    rows = [row.text for row in form_of(worn).pickers["look.picture"].rows]
    assert rows == ["none", NAME, OTHER_PICTURE]
    pick(worn, "look.picture", NAME)
    assert look(worn).picture == NAME and look(worn).picture.data == four()
    pick(worn, "look.picture", "none")
    assert look(worn).picture is None
    worn.key(pygame.K_z, pygame.KMOD_CTRL)
    assert look(worn).picture.data == four()


def test_a_picture_from_elsewhere_is_typed_and_copied_beside_the_level_when_it_is_saved(worn, tmp_path):
    (elsewhere := tmp_path / "elsewhere").mkdir()
    (elsewhere / "b.png").write_bytes(four((8, 8)))
    pick(worn, "look.picture", OTHER_PICTURE)
    worn.type(str(elsewhere / "no.png"))
    worn.key(pygame.K_RETURN)
    assert worn.app.ui.has_sheet and look(worn).picture is None
    worn.key(pygame.K_a, pygame.KMOD_CTRL)
    worn.type(str(elsewhere / "b.png"))
    worn.key(pygame.K_RETURN)
    worn.frames(2)
    assert look(worn).picture == "b.png"
    worn.key(pygame.K_s, pygame.KMOD_CTRL)
    worn.frames(2)
    assert (tmp_path / "b.png").read_bytes() == four((8, 8))
    assert pictures_of(read_level(tmp_path / "worn.json"))["b.png"].data == four((8, 8))


def test_a_png_that_is_dropped_is_worn_by_what_is_selected(worn, tmp_path):
    (tmp_path / "c.png").write_bytes(four((8, 8)))
    worn.post(pygame.DROPFILE, file=str(tmp_path / "c.png"))
    worn.frames(2)
    for key in (pygame.K_TAB, pygame.K_TAB, pygame.K_RETURN):
        worn.key(key)
    worn.frames(2)
    assert look(worn).picture == "c.png"


def test_an_autosave_keeps_the_picture(tmp_path):
    level = read_level(level_file(tmp_path))
    autosave = Autosave(tmp_path / "kept")
    autosave.note(level, None, "Picture")
    autosave.close()
    (kept,) = orphans(tmp_path / "kept")
    assert pictures_of(kept.level())[NAME].data == four()
