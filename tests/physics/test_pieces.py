"""What a cut parts becomes bodies of their own: they lie on each other and in none, and undo joins them again."""

import copy
import json
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

from sandbox.commands import CutSprings
from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.energy import total_energy
from sandbox.physics.analysis.query import shown_springs
from sandbox.physics.commands.command_table import RefusedCommand
from sandbox.physics.constraints import AREA
from sandbox.physics.equation import of_body
from sandbox.physics.geometry.segment import signed_area
from sandbox.physics.keeping.equipment import height_of
from sandbox.physics.marks import LINE, NO_EDGE, SOLID_LEFT, SOLID_RIGHT
from sandbox.physics.pipeline.block_owner import outline_of
from sandbox.physics.snapshot import state_hash
from sandbox.physics.softness.firmness import FirmnessRange, firm_bodies, lowest_mode_of
from sandbox.replay import read_replay, verify
from sandbox.session.commands.records import from_record
from sandbox.session.session import Session
from tests.support.cutting import SOFT_LEVELS, STROKES, actor_of, advance, begun, crossed, cut, level_with
from tests.support.overlaps import crossed_by_itself, overlaps

SOLVERS = ("direct", "iterative", "single_pass")
# Of the distance between particles: bodies overlap by no more than this.
DEEPEST = 1.0 / 20.0
JELLY = {
    "type": "jelly", "id": "it", "shape": {"box": [1.6, 1.6]}, "position": [0.0, 0.0], "spacing": 0.4,
    "material": "soft",
}  # fmt: skip


def small(gravity=(0.0, 0.0), material=None, **body):
    """A level of one jelly that can touch."""
    level = {
        "format": "spring-sandbox/level", "version": 3, "name": "one jelly", "contacts": {},
        "settings": {"solver": "direct", "gravity": gravity}, "bodies": [{**JELLY, **body}],
        "materials": {"soft": {"stiffness": 0.2, "damping": 0.4, **(material or {})}},
    }  # fmt: skip
    return parse_level(json.dumps(level).encode(), "one jelly")


def deepest(world, spacing, chosen):
    """How deep chosen shapes lie in others, and in themselves, [spacings]."""
    outline, own = outline_of(world), crossed_by_itself(world)
    others = [
        deep * float(world.radius[outline.member[outline.member_start[pair[0]]]])
        for pair, deep in overlaps(world).depth.items()
        if pair[0] != pair[1] and set(pair) & chosen
    ]
    return max([0.0, *others]) / spacing, max([0.0, *(own.get(shape, 0.0) for shape in chosen)]) / spacing


def pieces_of(world, actor):
    """The particles of each body that a body has become."""
    owners = world.owner[actor.slots]
    return [actor.slots[owners == owner] for owner in np.unique(owners)]


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", SOFT_LEVELS)
def test_three_seconds_after_a_cut_the_pieces_lie_in_nothing_and_cross_themselves_nowhere(name, solver):
    level = level_with(name, solver)
    before = begun(level).snapshot()
    for body in SOFT_LEVELS[name]:
        for stroke in STROKES:
            session = Session(level, start=before)
            actor = cut(session, body, stroke)
            advance(session, 180)
            world, outline = session.world, outline_of(session.world)
            pieces = pieces_of(world, actor)
            # A stroke may miss a corner.
            assert len(pieces) > 1 or stroke == "corner", (body, stroke)
            shapes = {int(outline.shape[piece[0]]) for piece in pieces} - {-1}
            assert shapes or not level.has_contacts
            assert max(deepest(world, actor.cell, shapes)) <= DEEPEST, (body, stroke)


@pytest.mark.parametrize("stroke", STROKES)
def test_each_piece_has_a_closed_outline_of_its_own_that_encloses_its_triangles(stroke):
    session = begun(level_with("jelly_pile", "direct"))
    actor = cut(session, "cube 1", stroke)
    session.apply_pending()
    world, outline = session.world, outline_of(session.world)
    areas = np.flatnonzero(world.constraint_active & (world.constraint_kind == AREA))
    corners = world.corner_particle[world.constraint_first[areas][:, None] + np.arange(3)]
    for piece in pieces_of(world, actor):
        own = np.flatnonzero(np.isin(corners[:, 0], piece))
        assert np.isin(corners[own], piece).all()
        edges = np.flatnonzero(
            np.isin(outline.edge_a[: outline.dynamic[0]], piece) & (outline.side[: outline.dynamic[0]] == 1)
        )
        a, b = outline.edge_a[edges], outline.edge_b[edges]
        assert sorted(a.tolist()) == sorted(b.tolist())
        place = world.corner_form[world.constraint_first[areas[own]][:, None] + np.arange(3)]
        form = np.zeros((world.particle_count, 2))
        form[corners[own]] = place
        inside = sum(signed_area(each, np.roll(each, -1, axis=0)) for each in place)
        assert signed_area(form[a], form[b]) == pytest.approx(inside)


def test_undo_joins_the_pieces_again_and_redo_parts_them_to_the_same_bits():
    session = begun(level_with("jelly_pile", "direct"))
    whole = session.snapshot()
    actor = cut(session, "cube 1", "across")
    advance(session, 30)
    parted = state_hash(session.world)
    assert len(pieces_of(session.world, actor)) == 2
    session.undo()
    session.apply_pending()
    assert len(pieces_of(session.world, actor)) == 1
    for name in ("owner", "edge", "constraint_active", "corner_particle", "corner_form", "constraint_rest"):
        np.testing.assert_array_equal(getattr(session.world, name), getattr(whole, name))
    session.redo()
    session.apply_pending()
    assert state_hash(session.world) == parted


def test_a_recording_of_cuts_is_verified_bit_for_bit(tmp_path):
    session = begun(level_with("jelly_pile", "direct"), 0)
    session.record_to(tmp_path / "cut.replay")
    advance(session, 40)
    for body, stroke in (("cube 1", "across"), ("wheel 4", "corner"), ("cube 1", "along")):
        cut(session, body, stroke)
        advance(session, 20)
    session.stop_recording()
    recording = read_replay(tmp_path / "cut.replay")
    assert verify(recording) is None and recording.ticks == 100


@pytest.mark.parametrize("stroke", STROKES)
@pytest.mark.parametrize(
    ("name", "body"), [("jelly_pile", "cube 1"), ("jelly_wheel", "wheel"), ("jelly_pile", "wheel 4")]
)
def test_a_level_whose_body_is_cut_is_built_as_a_run_cuts_it(name, body, stroke):
    session = begun(level_with(name, "direct"), 0)
    actor = actor_of(session.level, body)
    springs = crossed(session, actor, stroke)
    session.world.cut(springs)
    read = json.loads(session.level.model_dump_json(exclude_unset=True))
    own = next(each for each in read["bodies"] if each["id"] == body)
    own["cut"] = [spring - int(actor.springs[0]) for spring in springs]
    built = build_world(parse_level(json.dumps(read).encode(), name))
    kept = np.setdiff1d(np.arange(session.world.spring_count), springs)
    np.testing.assert_array_equal(built.owner, session.world.owner)
    np.testing.assert_array_equal(built.edge, session.world.edge[kept])
    areas = session.world.constraint_active
    assert np.count_nonzero(areas) == built.constraint_count
    np.testing.assert_array_equal(built.constraint_rest, session.world.constraint_rest[areas])


def test_a_cell_that_lost_a_corner_keeps_the_area_of_its_other_half():
    for corner in range(4):
        w = build_world(small(shape={"box": [0.4, 0.4]}))
        w.cut(np.flatnonzero(shown_springs(w) & ((w.particle_a == corner) | (w.particle_b == corner))))
        (left,) = np.flatnonzero(w.constraint_active)
        first = w.constraint_first[left]
        assert sorted(w.corner_particle[first : first + 3].tolist()) == sorted({0, 1, 2, 3} - {corner})
        assert w.constraint_rest[left].tolist() == pytest.approx([0.08, 0.08])
        assert np.isin(w.edge[shown_springs(w)], (SOLID_LEFT, SOLID_RIGHT)).all()
        assert len(set(w.owner[:4].tolist())) == 2


def test_what_hangs_by_threads_is_a_line_and_inner_threads_are_none():
    w = build_world(small(shape={"box": [0.8, 0.4]}))
    # Cut the right cell's upper side and both diagonals: two sides are left, a rim that encloses nothing.
    ends = [set(pair) for pair in zip(w.particle_a.tolist(), w.particle_b.tolist(), strict=True)]
    w.cut([ends.index(pair) for pair in ({4, 5}, {1, 5}, {2, 4})])
    kinds = {frozenset(ends[s]): int(w.edge[s]) for s in np.flatnonzero(shown_springs(w))}
    assert kinds[frozenset({1, 2})] == kinds[frozenset({2, 5})] == LINE
    assert kinds[frozenset({1, 4})] in (SOLID_LEFT, SOLID_RIGHT)
    assert kinds[frozenset({0, 4})] == kinds[frozenset({1, 3})] == NO_EDGE
    assert len(set(w.owner[:6].tolist())) == 1


def test_what_breaks_by_strain_falls_into_bodies_too():
    torn = small((60.0, 0.0), {"tension_limit": 0.3}, pinned=[0, 5, 10, 15, 20])
    session = Session(torn)
    advance(session, 240)
    assert not shown_springs(session.world).all()
    linked = np.unique(session.world.owner[:25])
    assert len(linked) > 1


def test_a_cut_gives_no_energy_and_pieces_do_not_fly_apart():
    session = begun(level_with("jelly_pile", "direct"), 300)
    before = total_energy(session.world)
    actor = cut(session, "cube 1", "across")
    top = session.world.position[actor.slots, 1].max()
    for _ in range(60):
        session.advance()
        assert session.world.position[actor.slots, 1].max() < top + 0.2
    assert total_energy(session.world) <= before + 1e-6 * abs(before)


def turned_over(place):
    return place * np.array([-1.0, 1.0])


def folded(place):
    return np.stack([0.7 * np.abs(place[:, 0]), place[:, 1]], axis=1)


def wound(place):
    away = np.hypot(place[:, 0], place[:, 1])
    cosine, sine = np.cos(3.5 * away / away.max()), np.sin(3.5 * away / away.max())
    return np.stack([place[:, 0] * cosine - place[:, 1] * sine, place[:, 0] * sine + place[:, 1] * cosine], axis=1)


@pytest.mark.parametrize("solver", SOLVERS[:2])
@pytest.mark.parametrize("bent", [turned_over, folded, wound])
@pytest.mark.parametrize(
    ("name", "body"), [("jelly_pile", "cube 16"), ("jelly_pile", "wheel 10"), ("desk_toy", "lemon")]
)
def test_the_pieces_of_a_body_that_was_inside_out_come_apart_and_into_their_form(name, body, bent, solver):
    session = begun(level_with(name, solver))
    actor, world = actor_of(session.level, body), session.world
    springs, middle = crossed(session, actor, "across"), world.position[actor.slots].mean(axis=0)
    world.change("position", middle + bent(world.position[actor.slots] - middle), actor.slots)
    session.submit(CutSprings(springs))
    advance(session, 300)
    outline = outline_of(world)
    shapes = {int(outline.shape[piece[0]]) for piece in pieces_of(world, actor)} - {-1}
    assert len(shapes) > 1 and max(deepest(world, actor.cell, shapes)) <= DEEPEST


def test_a_body_that_is_cut_but_holds_together_keeps_its_number_and_gets_the_outline_of_the_notch():
    session = begun(level_with("jelly_pile", "direct"), 0)
    actor = actor_of(session.level, "cube 1")
    ends = np.sort(actor.pairs, axis=1).tolist()
    # A slit from the middle of the lowest row upwards.
    session.world.cut([int(actor.springs[ends.index(pair)]) for pair in ([2, 3], [7, 8], [2, 8], [3, 7])])
    assert len(pieces_of(session.world, actor)) == 1
    outline = outline_of(session.world)
    assert outline.shape[actor.slots[2]] == outline.shape[actor.slots[3]]
    solid = outline.side[np.isin(outline.edge_a[: outline.dynamic[0]], actor.slots).nonzero()[0]]
    assert solid.all()


def test_pieces_are_firm_bodies_with_names_and_forms_of_their_own():
    session = begun(level_with("jelly_pile", "direct"))
    whole = firm_bodies(session.world)
    assert [body.name for body in whole] == [body.name for body in session.world.forms]
    actor = cut(session, "cube 1", "across")
    session.apply_pending()
    world, parted = session.world, firm_bodies(session.world)
    # What was not cut keeps its place.
    assert [body.name for body in parted] == ["cube 1, 1 of 2", *(body.name for body in whole[1:]), "cube 1, 2 of 2"]
    for body, piece in zip(
        (parted[0], parted[-1]), sorted(pieces_of(world, actor), key=len, reverse=True), strict=True
    ):
        assert len(body.shape.points) == len(piece) and 0.0 < lowest_mode_of(body.shape) < 1.0
        assert np.isin(world.particle_a[body.springs], piece).all() and world.spring_active[body.springs].all()
        ends = world.origin[world.particle_b[body.springs]] - world.origin[world.particle_a[body.springs]]
        form = body.shape.points[body.shape.pairs[:, 1]] - body.shape.points[body.shape.pairs[:, 0]]
        np.testing.assert_allclose(ends, form, atol=1e-12)
        corners = body.shape.points[body.shape.areas]
        areas = world.constraint_rest[body.constraints, 1]
        np.testing.assert_allclose([signed_area(each, np.roll(each, -1, axis=0)) for each in corners], areas)


def test_each_piece_is_made_firm_by_its_name_alone_and_undo_keeps_to_what_it_was_said_of():
    session = begun(level_with("jelly_pile", "direct"))
    cut(session, "cube 1", "across")
    session.apply_pending()
    world = session.world
    larger, smaller, other = (firm_bodies(world)[k] for k in (0, -1, 1))
    before = world.stiffness.copy()
    for body, sag in ((smaller.name, 0.0), (larger.name, 0.25), (other.name, 0.1)):
        session.submit(from_record({"type": "set_firmness", "body": body, "sag": sag}, world), session.new_gesture())
        session.apply_pending()
    assert np.all(world.stiffness[smaller.springs] == 1.0)
    for body, sag in ((larger, 0.25), (other, 0.1)):
        # The command takes a sag for that of a square as high.
        reach = FirmnessRange.of(body.shape, world.settings.gravity, world.settings.tick_rate)
        reach = replace(reach, form=None, height=height_of(body.shape, *world.settings.gravity))
        mode = float(world.lowest_mode[body.springs[0]])
        pair = of_body(float(world.stiffness[body.springs[0]]), float(world.damping[body.springs[0]]), mode)
        assert reach.reading(*pair)[0] == pytest.approx(sag, rel=0.01)
    untouched = np.setdiff1d(
        np.arange(world.spring_count), np.concatenate([larger.springs, smaller.springs, other.springs])
    )
    np.testing.assert_array_equal(world.stiffness[untouched], before[untouched])
    session.undo()
    session.apply_pending()
    np.testing.assert_array_equal(world.stiffness[other.springs], before[other.springs])
    assert np.all(world.stiffness[smaller.springs] == 1.0)


@pytest.mark.parametrize("stroke", STROKES)
def test_what_is_kept_of_a_form_is_that_of_its_pieces_as_they_are_now(stroke):
    session = begun(level_with("jelly_pile", "direct"), 1)
    ask = {"type": "set_firmness", "body": "cube 1", "sag": 0.1}
    session.submit(from_record(ask, session.world))
    for other in (*STROKES, stroke):
        cut(session, "cube 1", other)
        session.apply_pending()
        pieces = [number for number, body in enumerate(firm_bodies(session.world)) if body.name.startswith("cube 1,")]
        # A copy has nothing that was found before.
        fresh = copy.deepcopy(session.world)
        for world in (session.world, fresh):
            for number in pieces:
                with suppress(RefusedCommand):
                    world.command("set_firmness", body=number, sag=0.2, hz=None, ratio=None)
        assert len(pieces) > 1
        assert state_hash(session.world) == state_hash(fresh)
        session.undo()
        session.apply_pending()


def test_every_body_of_a_level_begins_with_the_firmness_that_it_says():
    data = json.loads(small(firmness={"sag": 0.1}).model_dump_json(exclude_unset=True))
    data["bodies"].append({**data["bodies"][0], "id": "other", "position": [4.0, 0.0]})
    world = build_world(parse_level(json.dumps(data).encode(), "two jellies"))
    assert [body.name for body in firm_bodies(world)] == ["it", "other"]
    one, other = (world.stiffness[body.springs] for body in firm_bodies(world))
    assert np.array_equal(one, other) and one[0] != 0.2


def hinged(world):
    """The springs that are left of a jelly without its upper left and lower right quarter, and the hinge."""
    both = world.position[world.particle_a] + world.position[world.particle_b]
    gone = np.flatnonzero((both[:, 0] * both[:, 1] < -1e-9) & shown_springs(world))
    return gone, int(np.argmin(np.abs(world.position[world.particle_active]).sum(axis=1)))


def test_lobes_that_hang_together_by_one_particle_part_there_and_undo_joins_them_again():
    session = Session(small())
    world = session.world
    gone, middle = hinged(world)
    lower, upper = (int(np.argmin(np.abs(world.position - at).sum(axis=1))) for at in ((-0.8, -0.8), (0.8, 0.8)))
    before = shown_springs(world).copy()
    session.submit(CutSprings(tuple(gone.tolist())), session.new_gesture())
    session.advance()
    assert world.owner[lower] != world.owner[upper]
    # The hinge stays with one of them, whole; the other lost the springs to it alone.
    here = (world.particle_a == middle) | (world.particle_b == middle)
    sides = np.concatenate([world.particle_a, world.particle_b])[np.tile(here & shown_springs(world), 2)]
    assert here.any() and np.all(world.owner[sides] == world.owner[middle])
    lost = before & ~shown_springs(world)
    lost[gone] = False
    assert np.count_nonzero(lost) == 3 and here[lost].all()
    outline = outline_of(world)
    assert outline.side[: outline.dynamic[0]].all()
    session.undo()
    session.apply_pending()
    assert np.array_equal(shown_springs(world), before) and world.owner[lower] == world.owner[upper]


@pytest.mark.parametrize("shape", [{"box": [1.0, 1.0]}, {"box": [1.5, 0.5]}, {"circle": 0.5}])
def test_a_coarse_jelly_loses_no_spring_but_the_one_that_is_cut(shape):
    for spring in np.flatnonzero(shown_springs(build_world(small(shape=shape, spacing=0.5)))).tolist():
        world = build_world(small(shape=shape, spacing=0.5))
        before = np.flatnonzero(shown_springs(world))
        world.cut([spring])
        assert np.setdiff1d(before, np.flatnonzero(shown_springs(world))).tolist() == [spring]


def test_a_triangle_that_hangs_by_its_corner_stays():
    world = build_world(small(shape={"box": [0.8, 0.4]}))
    ends = [set(pair) for pair in zip(world.particle_a.tolist(), world.particle_b.tolist(), strict=True)]
    world.cut([ends.index(pair) for pair in ({4, 5}, {2, 4})])
    assert all(world.spring_active[ends.index(pair)] for pair in ({1, 2}, {1, 5}, {2, 5}))
    assert np.count_nonzero(world.constraint_active) == 3 and len(set(world.owner[:6].tolist())) == 1
