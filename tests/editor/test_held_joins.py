"""Joins under an edit: whatever verb moves one of two joined things, the join holds or is let go aloud."""

import numpy as np
import pytest

from sandbox.editor.document import Document, empty_level
from sandbox.editor.edits import moving
from sandbox.editor.edits.fields import rename, set_field
from sandbox.editor.edits.placing import add_body, add_particle, weld
from sandbox.editor.held_joins import with_joins_held
from sandbox.editor.items import Item
from sandbox.level.document.model import ParticleDef
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.girder import GirderDef
from sandbox.level.kinds.jelly import BoxShape, JellyDef
from sandbox.level.kinds.rope import RopeDef

JELLY = JellyDef(type="jelly", id="jelly", shape=BoxShape(box=(2.0, 2.0)), spacing=0.5, position=(5.0, 0.0))
# Its last particle is the jelly's lower left corner.
ROPE = RopeDef(type="rope", id="rope", start=(0.0, 3.0), end=(4.0, -1.0), segments=8)
TAIL = RopeDef(type="rope", id="tail", start=(6.0, 1.0), end=(9.0, 1.0), segments=6)


def level(*bodies, welds=(), particles=()):
    document = Document(empty_level())
    for body in bodies:
        document = add_body(document, body)
    for part in particles:
        document = add_particle(document, part)
    for a, b in welds:
        document = weld(document, a, b)
    return document.level


def joined():
    return level(JELLY, ROPE, TAIL, welds=(("jelly.0", "rope.end"), ("jelly.24", "tail.start")))


def edited(before, verb, *ids, kind="body"):
    return with_joins_held(before, verb(Document(before, frozenset(Item(kind, name) for name in ids))))


def body(held, name):
    return next(part for part in held.document.level.bodies if part.id == name)


def place(held, name):
    """Where a body's particle lies by itself, whatever it is joined to."""
    owner, part = name.split(".")
    made = expansion(body(held, owner))
    return made.position[int(part) if part.isdigit() else made.named_particles[part]]


VERBS = {
    "move": lambda document: moving.move(document, -1.0, -1.5),
    "turn": lambda document: moving.rotate(document, 1.0, (2.0, 1.0)),
    "mirror": lambda document: moving.mirror(document, "x", (2.0, 1.0)),
    "scale": lambda document: moving.scale(document, 1.5, 1.5, (2.0, 1.0)),
}


@pytest.mark.parametrize("name", ["jelly", "rope", "tail"])
@pytest.mark.parametrize("verb", VERBS)
def test_no_verb_tears_what_is_joined(verb, name):
    held = edited(joined(), VERBS[verb], name)

    assert held.let_go == () and held.notice == ""
    assert len(held.document.level.welds) == 2
    for a, b in held.document.level.welds:
        np.testing.assert_allclose(place(held, a), place(held, b), atol=1e-9)


def test_a_rope_that_is_dragged_is_spanned_between_its_join_and_its_other_end():
    held = edited(joined(), VERBS["move"], "rope")

    assert (body(held, "rope").start, body(held, "rope").end) == ((-1.0, 1.5), (4.0, -1.0))
    assert body(held, "jelly") is joined().bodies[0] or body(held, "jelly") == JELLY


def test_ropes_follow_what_they_hang_on_and_their_other_ends_stay():
    held = edited(joined(), VERBS["move"], "jelly")

    assert (body(held, "rope").start, body(held, "rope").end) == ((0.0, 3.0), (3.0, -2.5))
    assert (body(held, "tail").start, body(held, "tail").end) == ((5.0, -0.5), (9.0, 1.0))


def test_a_rope_keeps_the_length_that_it_was_given():
    before = joined()
    before = set_field(Document(before), frozenset([Item("body", "rope")]), "rest_length", 1.0).level

    assert body(edited(before, VERBS["move"], "jelly"), "rope").rest_length == 1.0


def test_what_has_no_ends_comes_along_with_its_group():
    other = replaced(JELLY, id="other", position=(7.0, 0.0))
    third = replaced(JELLY, id="third", position=(12.0, 0.0), group="pair")
    before = level(JELLY, replaced(other, group="pair"), third, welds=(("jelly.4", "other.0"),))

    held = edited(before, VERBS["move"], "jelly")

    assert [body(held, name).position for name in ("jelly", "other", "third")] == [
        (4.0, -1.5),
        (6.0, -1.5),
        (11.0, -1.5),
    ]


def test_a_loose_particle_comes_along_with_the_body_that_it_weighs_down():
    weight = ParticleDef(id="weight", position=(6.0, -1.0), mass=10.0)
    before = level(JELLY, particles=[weight], welds=(("jelly.4", "weight"),))

    assert edited(before, VERBS["move"], "jelly").document.level.particles[0].position == (5.0, -2.5)
    assert body(edited(before, VERBS["move"], "weight", kind="particle"), "jelly").position == (4.0, -1.5)


def test_an_end_that_is_moved_on_its_own_lets_its_join_go_and_says_so():
    held = with_joins_held(joined(), set_field(Document(joined()), [Item("body", "rope")], "end", (1.0, 1.0)))

    assert body(held, "rope").end == (1.0, 1.0)
    assert held.document.level.welds == (("jelly.24", "tail.start"),)
    assert held.notice == 'No longer joined: "jelly" and "rope". Undo joins them again.'


def test_a_rope_with_both_ends_joined_stays_where_it_is():
    before = level(JELLY, replaced(TAIL, end=(9.0, 2.0)), replaced(JELLY, id="other", position=(10.0, 3.0)),
                   welds=(("jelly.24", "tail.start"), ("other.0", "tail.end")))  # fmt: skip

    held = edited(before, VERBS["move"], "tail")

    assert body(held, "tail") == before.bodies[1] and held.document.level.welds == before.welds


def test_two_joins_that_pull_one_body_apart_are_one_join_less():
    left, right = replaced(JELLY, id="left", position=(3.0, 0.0)), replaced(JELLY, id="right", position=(7.0, 0.0))
    before = level(JELLY, left, right, welds=(("jelly.0", "left.4"), ("jelly.4", "right.0")))

    def apart(document):
        document = moving.move(document, -1.0, 0.0)
        return moving.move(replaced_selection(document, "right"), 1.0, 0.0)

    held = edited(before, apart, "left")

    assert len(held.document.level.welds) == 1 and len(held.let_go) == 1
    assert held.notice.startswith("No longer joined: ")


def replaced_selection(document, name):
    return Document(document.level, frozenset([Item("body", name)]))


def test_a_finer_grid_keeps_the_rope_at_the_particle_that_took_over():
    held = with_joins_held(joined(), set_field(Document(joined()), [Item("body", "jelly")], "spacing", 0.3))

    jelly, rope = body(held, "jelly"), body(held, "rope")
    name = held.document.level.welds[0][0]
    assert rope.end == tuple(expansion(jelly).position[int(name.partition(".")[2])].tolist())


def test_a_girder_with_a_pose_keeps_it_when_its_end_is_taken_along():
    beam = GirderDef(type="girder", id="beam", start=(0.0, 0.0), end=(4.0, -1.0), segments=4)
    places = expansion(beam).form + np.array([[0.0, 0.1 * (k % 3 == 1)] for k in range(9)])
    beam = replaced(beam, pose=tuple(map(tuple, places.tolist())))
    before = level(JELLY, beam, welds=(("jelly.0", "beam.end"),))

    held = edited(before, VERBS["move"], "jelly")

    moved = body(held, "beam")
    assert moved.end == (3.0, -2.5)
    np.testing.assert_allclose(np.array(moved.pose) - expansion(moved).form, places - expansion(beam).form, atol=1e-9)


def test_a_gap_that_an_edit_closes_stays_closed():
    beside = replaced(ROPE, end=(4.1, -1.0))
    before = level(JELLY, beside, welds=(("jelly.0", "rope.end"),))

    held = with_joins_held(before, set_field(Document(before), [Item("body", "rope")], "end", (4.0, -1.0)))

    assert body(held, "rope").end == (4.0, -1.0) and held.document.level.welds == before.welds


def test_edits_that_move_nothing_leave_joins_alone():
    before = joined()
    for after in (rename(Document(before), Item("body", "rope"), "cable"), Document(before)):
        held = with_joins_held(before, after)
        assert held.document is after or held.document.level is after.level
