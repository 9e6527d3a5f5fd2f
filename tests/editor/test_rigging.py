"""Many at once: hangers between two ropes, a phase wave through muscles, everything begun at rest."""

import numpy as np
import pytest

from sandbox.editor.document import Document, EditError, empty_level
from sandbox.editor.edits.additions import wave_along, wave_in_order
from sandbox.editor.edits.bake import begin_at_rest
from sandbox.editor.forecast import Forecast
from sandbox.editor.items import Item
from sandbox.editor.scene import make_scene
from sandbox.editor.tools.palette import TOOLS
from sandbox.editor.tools.snap import snap
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import ParticleDef, SpringDef, TerrainDef
from sandbox.level.format.actuator_defs import MuscleDef
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bridge import BridgeDef
from sandbox.level.kinds.mesh import MeshDef
from sandbox.level.kinds.rope import RopeDef
from sandbox.level.reading.parse import parse_level
from sandbox.physics.step import step

REACH = 0.05


def rope(name, y, segments, **fields):
    return RopeDef(type="rope", id=name, start=(0.0, y), end=(10.0, y), segments=segments, **fields)


@pytest.fixture
def ropes():
    bodies = (rope("cable", 3.0, 20, pin=("start", "end")), rope("deck", 0.0, 10))
    return Document(replaced(empty_level(), bodies=bodies))


def hang(document, start, end, **options):
    """Drag from one place to another; the ghost too."""
    drawing = TOOLS["hangers"].drawing(reach=REACH)
    for name, value in options.items():
        drawing.set_option(name, value)

    def at(point):
        return snap(make_scene(document.level), point, REACH)

    drawing.down(at(start))
    drawing.move(at(end))
    ghost = drawing.ghost(document)
    hint, size = drawing.hint, drawing.measure
    drawing.up(at(end))
    return drawing.done(document), ghost, hint, size


def test_one_drag_hangs_one_rope_on_another_by_springs_that_are_plumb(ropes):
    document, ghost, _, size = hang(ropes, (1.0, 3.0), (9.0, 0.0), material="steel")
    springs = document.level.springs
    assert [(s.a, s.b) for s in springs] == [(f"cable.{2 * k}", f"deck.{k}") for k in range(1, 10)]
    assert {s.group for s in springs} == {"hangers"} and {s.material for s in springs} == {"steel"}
    assert size == "9 hangers" and len(ghost.level.springs) == 9
    assert document.selection == frozenset(Item("spring", k) for k in range(9))
    assert parse_level(level_text(document.level).encode(), "again") == document.level


def test_a_number_of_hangers_spreads_them_evenly_and_the_way_of_the_drag_does_not_matter(ropes):
    there, *_ = hang(ropes, (0.0, 3.0), (10.0, 0.0), count=3)
    back, *_ = hang(ropes, (10.0, 3.0), (0.0, 0.0), count=3)
    ends = {(s.a, s.b) for s in there.level.springs}
    assert ends == {("cable.0", "deck.0"), ("cable.10", "deck.5"), ("cable.20", "deck.10")}
    assert {(s.a, s.b) for s in back.level.springs} == ends


def test_what_is_joined_already_gets_no_second_hanger(ropes):
    once, *_ = hang(ropes, (1.0, 3.0), (5.0, 0.0))
    twice, *_ = hang(once, (1.0, 3.0), (9.0, 0.0))
    pairs = [frozenset((s.a, s.b)) for s in twice.level.springs]
    assert len(pairs) == len(set(pairs)) == 9
    with pytest.raises(EditError, match="joined there already"):
        hang(twice, (1.0, 3.0), (9.0, 0.0))


def test_welded_ends_get_none_and_a_bridge_is_hung_by_the_row_that_is_pointed_at(ropes):
    bridge = BridgeDef(type="bridge", id="truss", start=(0.0, 3.0), end=(10.0, 3.0), segments=10, height=1.0)
    deck = RopeDef(type="rope", id="deck", start=(0.0, 2.0), end=(10.0, -3.0), segments=10)
    level = replaced(ropes.level, bodies=(deck, bridge), welds=(("deck.0", "truss.11"),))
    document, *_ = hang(Document(level), (2.0, 2.0), (0.0, 2.0))
    assert [(s.a, s.b) for s in document.level.springs] == [("truss.13", "deck.2"), ("truss.12", "deck.1")]


def test_a_mesh_that_is_one_strand_is_as_good_as_a_rope_and_one_that_is_none_is_refused(ropes):
    bow = tuple((float(x), 3.0 + (x - 5) ** 2 / 10.0) for x in range(11))
    order = [0, 2, 1, 3, 4, 5, 6, 7, 8, 10, 9]
    links = [(order[k], order[k + 1]) for k in range(10)]
    places = tuple(bow[order.index(index)] for index in range(11))
    cable = MeshDef(type="mesh", id="cable", particles=places, springs=tuple(links))
    level = replaced(ropes.level, bodies=(cable, ropes.level.bodies[1]))
    document, *_ = hang(Document(level), bow[1], (9.0, 0.0))
    assert [(s.a, s.b) for s in document.level.springs] == [(f"cable.{order[k]}", f"deck.{k}") for k in range(1, 10)]
    net = replaced(cable, springs=(*links, (0, 5)))
    with pytest.raises(EditError, match="begin on a rope"):
        hang(Document(replaced(level, bodies=(net, level.bodies[1]))), bow[1], (9.0, 0.0))


@pytest.mark.parametrize("end", [(3.0, 3.0), (3.0, 1.5)])
def test_a_drag_that_ends_on_the_same_rope_or_on_none_is_refused_in_one_line(ropes, end):
    drawing = TOOLS["hangers"].drawing(reach=REACH)
    scene = make_scene(ropes.level)
    drawing.down(snap(scene, (1.0, 3.0), REACH))
    drawing.move(snap(scene, end, REACH))
    assert drawing.ghost(ropes) is None and drawing.hint.startswith(("end ", "finish "))


# Waves.


@pytest.fixture
def feet():
    """Five muscles side by side, and a spring that is none."""
    particles = [ParticleDef(id=f"p{k}", position=(k % 6 * 1.0, k // 6 * 1.0)) for k in range(12)]
    muscle = MuscleDef(amplitude=0.1, period=60)
    springs = [SpringDef(a=f"p{k}", b=f"p{k + 6}", drive=muscle if k < 5 else None) for k in range(6)]
    return Document(replaced(empty_level(), particles=tuple(particles), springs=tuple(springs)))


def phases(document):
    return [spring.drive.phase for spring in document.level.springs if spring.drive is not None]


def test_a_wave_runs_the_way_of_the_drag_with_phases_without_dust(feet):
    assert phases(wave_along(feet, (0.0, 0.5), (5.0, 0.5))) == [0.0, 0.8, 0.6, 0.4, 0.2]
    assert phases(wave_along(feet, (5.0, 0.5), (0.0, 0.5))) == [0.0, 0.2, 0.4, 0.6, 0.8]
    assert phases(wave_along(feet, (0.0, 0.5), (5.0, 0.5), 2.0)) == [0.0, 0.6, 0.2, 0.8, 0.4]


def test_the_peak_passes_along_the_muscles_in_the_direction_of_the_drag(feet):
    world = build_world(wave_along(feet, (0.0, 0.5), (5.0, 0.5)).level)
    lengths = []
    for _ in range(60):
        step(world)
        lengths.append(world.rest_length[:5].copy())
    assert (np.diff(np.argmax(lengths, axis=0)) % 60 == 12).all()


def test_only_selected_muscles_change_and_the_order_makes_a_wave_too(feet):
    two = replace_selection(feet, 1, 3)
    assert phases(wave_in_order(two)) == [0.0, 0.0, 0.0, 0.5, 0.0]
    assert phases(wave_in_order(feet)) == [0.0, 0.8, 0.6, 0.4, 0.2]


def replace_selection(document, *springs):
    return Document(document.level, frozenset(Item("spring", index) for index in springs))


def test_without_muscles_or_without_a_way_there_is_no_wave(feet):
    bare = Document(replaced(feet.level, springs=feet.level.springs[5:]))
    with pytest.raises(EditError, match="no muscle"):
        wave_in_order(bare)
    with pytest.raises(EditError, match="drag farther"):
        wave_along(feet, (1.0, 1.0), (1.0, 1.0))


# Begin at rest.


def rested(document):
    forecast = Forecast(document.level)
    while not forecast.advance(1.0):
        pass
    return begin_at_rest(document, forecast.position, forecast.falling), forecast


def test_a_rope_that_swings_begins_where_it_will_hang_and_stays_there():
    level = replaced(
        empty_level(), bodies=(rope("rope", 0.0, 8, pin=("start",), material="steel", velocity=(3.0, 0.0)),)
    )
    document, _ = rested(Document(level))
    assert document.level.bodies[0].velocity == (0.0, 0.0)
    x, y = document.level.bodies[0].pose[-1]
    assert (x, y) == (pytest.approx(0.0, abs=0.02), pytest.approx(-10.0, abs=0.1))
    assert all(round(value, 6) == value for point in document.level.bodies[0].pose for value in point)
    world = build_world(document.level)
    before = world.position.copy()
    for _ in range(60):
        step(world)
    assert np.abs(world.position - before).max() < 0.02
    assert rested(document)[0].level.bodies[0].pose[-1] == pytest.approx((x, y), abs=0.01)


def test_what_falls_away_stays_as_it_was_drawn():
    ball = ParticleDef(id="ball", position=(20.0, 5.0), velocity=(1.0, 2.0))
    held = rope("rope", 0.0, 4, pin=("start", "end"), rest_length=2.6)
    document, forecast = rested(Document(replaced(empty_level(), bodies=(held,), particles=(ball,))))
    assert forecast.falling == {Item("particle", "ball")}
    assert document.level.particles == (ball,) and document.level.bodies[0].pose is not None


def test_a_pile_on_the_ground_begins_lying():
    floor = TerrainDef(id="floor", polyline=((-20.0, 0.0), (20.0, 0.0)))
    ball = ParticleDef(id="ball", position=(0.0, 1.0), radius=0.5, spin=2.0)
    document, _ = rested(Document(replaced(empty_level(), terrain=(floor,), particles=(ball,))))
    (lying,) = document.level.particles
    assert lying.position[1] == pytest.approx(0.5, abs=0.01) and lying.spin == 0.0
