"""A random maker at a document: every edit, undo and redo, beside a plain list of what the level was."""

import os
from dataclasses import dataclass

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)

from sandbox.editor.document import Document, EditError, empty_level, select
from sandbox.editor.edits import bake, copying, deleting, fields, grouping, materials, moving, placing, terrain
from sandbox.editor.held_joins import with_joins_held
from sandbox.editor.history import History
from sandbox.editor.items import Item, chosen_items, items_of
from sandbox.editor.scene import make_scene
from sandbox.level.assembly.build_world import build_world
from sandbox.level.checks import CheckDef
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import Level, NissenMaterial, ParticleDef, TerrainDef, WallsDef
from sandbox.level.kinds.jelly import JellyDef
from sandbox.level.kinds.rope import RopeDef
from sandbox.level.kinds.wheel import WheelDef
from sandbox.level.reading.parse import parse_level
from sandbox.physics.step import step
from tests.support.wholes import part_and_whole
from tests.support.zoo import zoo

# How many random makers whole-world tests have and how long each stays; HYPOTHESIS_PROFILE=nightly is the long run.
NIGHTLY = os.environ.get("HYPOTHESIS_PROFILE") == "nightly"
EXAMPLES, EDITS = (2_000, 50) if NIGHTLY else (100, 20)
# Levels that edits make larger than this are not worked on: the physics of large levels is tested elsewhere.
WORKED_ON = 3_000  # [particles]

# Most values can be used, so that edits build on each other; a few are what a person should not be able to enter.
LENGTHS = st.sampled_from([*[0.0, 0.25, -1.0, 3.0, 2.5] * 6, 1e6, 1e300, float("nan")])
POINTS = st.tuples(LENGTHS, LENGTHS)
FACTORS = st.sampled_from([*[0.5, 2.0, 1.0, 1.5, 0.2] * 4, 0.0, -1.0, 1e9])
ANGLES = st.sampled_from([0.0, 0.3, 1.5707963267948966, 3.141592653589793, -2.0, 1e5]) | st.floats(-4.0, 4.0)
SHARES = st.lists(st.floats(0.0, 0.999), min_size=1, max_size=4)
COUNTS = st.sampled_from([*[3, 2, 5, 8, 13] * 3, 1, 0, -1, 10**6])
TEXTS = st.sampled_from([*["rope", "deck 2", "fine", "more 7", "hook", "net"] * 3, "a.b", "", "+", "x" * 300])
FIELDS = {
    "segments": COUNTS,
    "spacing": st.sampled_from([0.1, 0.2, 0.3, 0.5, 0.0, 1e-9]),
    "spokes": COUNTS,
    "rings": COUNTS,
    "height": FACTORS,
    "start": POINTS,
    "end": POINTS.map(list),
    "position": POINTS,
    "angle": ANGLES,
    "radius": FACTORS,
    "thickness": FACTORS,
    "rest_length": st.none() | FACTORS,
    "shape": st.sampled_from([{"box": [1.0, 2.0]}, {"circle": 0.6}, {"polygon": [[0, 0], [1, 1], [1, 0]]}, {}, 3]),
    "pin": st.sampled_from([[], ["start"], ["start", "end"], ["hub"], ["rim"], "start"]),
    "pinned": st.sampled_from([[], [0], [0, 2], [90], True, False]),
    "cut": st.sampled_from([[], [1], [0, 1, 2], [900]]),
    "pose": st.none(),
    "mass": FACTORS,
    "particle_mass": FACTORS,
    "velocity": POINTS,
    "material": st.sampled_from(["steel", "wire", "default", "none"]),
    "group": st.none() | TEXTS,
    "a": st.sampled_from(["hook", "rope.2", "cube.0", "nobody"]),
    "id": TEXTS,
    "hub_mass": st.none() | FACTORS,
    "masses": st.sampled_from([None, [1.0], [1.0, 2.0, 3.0]]),
    "particles": st.sampled_from([[[0, 0], [1, 0]], [[0, 0], [2, 0], [3, 1]], [[0, 0], [2, 0], [3, 1], [4, 4]]]),
    "gravity_scale": FACTORS,
    "friction": st.none() | FACTORS,
    "bending": st.sampled_from([None, {}, {"stiffness": 0.2, "damping": 0.9}, {"stiffness": 2.0}]),
    "inflation": st.none() | FACTORS,
    "area": st.booleans(),
    "restitution": st.none() | FACTORS,
    "rolls": st.booleans(),
    "rolling": FACTORS,
    "spin": FACTORS,
    "particle_radius": st.none() | FACTORS,
    "collides": st.sampled_from([True, False, ["balls"], ["default", "terrain"], ["nobody"], 3]),
    "collision_group": st.sampled_from([None, "balls", "others", "terrain"]),
    "polyline": st.sampled_from([[[0, 0], [1, 0]], [[0, 0], [0, 0]], None]),
    "polygon": st.sampled_from([[[0, 0], [1, 0], [0, 1]], [[0, 0], [1, 1], [1, 0], [0, 1]], None]),
    "drive": st.sampled_from([None, {"amplitude": 0.2, "period": 60}, {"amplitude": 2.0, "period": 1}]),
    "motor": st.sampled_from([None, {"speed": -3.0, "torque": 5.0, "key": "d"}, {"speed": 1.0}]),
    "hydraulic": st.sampled_from([None, {"shortest": 0.5, "longest": 2.0, "rate": 1.0, "key": "u"}]),
    "springs": st.sampled_from([[], [[0, 1]], [[1, 2], [2, 0]], [[0, 7]]]),
}

COUNTED = {"segments", "spacing", "spokes", "rings", "shape", "particles"}
FORM = {"start", "end", "position", "angle", "radius", "thickness", "height", "springs"}


def definitions(level, items):
    """What a level says of items."""
    return list(chosen_items(level, frozenset(items)).values())


@dataclass(frozen=True)
class State:
    """What the level was: the object, and its text at the time."""

    level: Level
    text: str


def state(level: Level) -> State:
    return State(level, level_text(level))


class EditingMachine(RuleBasedStateMachine):
    @initialize(empty=st.integers(0, 9))
    def open(self, empty: int) -> None:
        level = empty_level() if empty == 9 else zoo()
        self.history = History(Document(level))
        self.scene = make_scene(level)
        self.states, self.index, self.key = [state(level)], 0, None
        # What was looked at last: of the same again nothing else could come.
        self.fresh, self.read = (level, self.scene), None
        self.clipboard = level_text(zoo())

    @property
    def document(self) -> Document:
        return self.history.document

    def _edit(self, edit, *values, merge=None) -> None:
        before = self.document
        try:
            after = with_joins_held(before.level, edit(before, *values)).document
        except EditError as error:
            assert str(error) and "\n" not in str(error)
            return
        finally:
            assert self.document is before
        if len(self._fresh_scene(after.level).mass) > WORKED_ON:
            return
        self.history.apply(edit.__name__, after, merge)
        if after.level is before.level:
            return
        if merge is None or merge != self.key:
            self.index += 1
        self.states[self.index :] = [state(after.level)]
        self.key = merge

    def _fresh_scene(self, level):
        """The scene of a level, made of nothing else."""
        if self.fresh[0] is not level:
            self.fresh = level, make_scene(level)
        return self.fresh[1]

    def _item(self, share: float) -> Item | None:
        items = self.scene.items
        return items[int(share * len(items))] if items else None

    def _particle(self, share: float) -> str:
        return self.scene.names(int(share * len(self.scene.mass))) if len(self.scene.mass) else "nobody"

    @rule(shares=SHARES, whole=st.booleans(), groups=st.booleans())
    def select_some(self, shares, whole, groups) -> None:
        chosen = frozenset(item for share in shares if (item := self._item(share)))
        chosen = frozenset(self.scene.items) if whole else chosen
        self.history.select(grouping.with_groups(self.document.level, chosen) if groups else chosen)

    @rule(at=POINTS, kind=st.sampled_from(["rope", "jelly", "wheel", "particle"]), name=TEXTS, size=COUNTS)
    def add(self, at, kind, name, size) -> None:
        if kind == "particle":
            part = ParticleDef.model_construct(id=name, position=at)
            self._edit(placing.add_particle, part)
        else:
            parts = {
                "rope": RopeDef.model_construct(type="rope", id=name, start=(0.0, 0.0), end=at, segments=size),
                "jelly": JellyDef.model_construct(
                    type="jelly", id=name, shape={"circle": 0.5}, position=at, spacing=0.5
                ),
                "wheel": WheelDef.model_construct(
                    type="wheel", id=name, position=at, radius=1.0, thickness=0.2, segments=size
                ),
            }
            self._edit(placing.add_body, parts[kind])

    @rule(a=st.floats(0, 0.999), b=st.floats(0, 0.999), rest=st.none() | FACTORS, material=st.none() | TEXTS)
    def add_spring(self, a, b, rest, material) -> None:
        self._edit(placing.add_spring, self._particle(a), self._particle(b), material, rest)

    @rule(a=st.floats(0, 0.999), b=st.floats(0, 0.999), back=st.booleans())
    def weld(self, a, b, back) -> None:
        welds = self.document.level.welds
        if back and welds:
            self._edit(placing.unweld, welds[int(a * len(welds))][1])
        else:
            self._edit(placing.weld, self._particle(a), self._particle(b))

    @rule(at=st.lists(POINTS, min_size=1, max_size=5), form=st.sampled_from(terrain.FORMS), name=TEXTS)
    def add_terrain(self, at, form, name) -> None:
        piece = TerrainDef.model_construct(id=name)
        self._edit(terrain.add_terrain, terrain.with_corners(piece, at, form))

    @precondition(lambda self: self.document.level.terrain)
    @rule(
        share=st.floats(0, 0.999),
        corner=st.integers(0, 6),
        to=POINTS,
        way=st.sampled_from(["move", "add", "delete"]),
    )
    def change_corner(self, share, corner, to, way) -> None:
        pieces = self.document.level.terrain
        piece = pieces[int(share * len(pieces))]
        index = min(corner, len(terrain.corners_of(piece)) - 1)
        if way == "delete":
            self._edit(terrain.delete_corner, piece.id, index)
        else:
            self._edit(terrain.move_corner if way == "move" else terrain.insert_corner, piece.id, index, to)

    @rule(box=st.none() | st.tuples(LENGTHS, LENGTHS, LENGTHS, LENGTHS))
    def set_walls(self, box) -> None:
        self._edit(terrain.set_walls, None if box is None else WallsDef.model_construct(box=box))

    @rule(shares=SHARES, pinned=st.booleans())
    def pin(self, shares, pinned) -> None:
        self._edit(placing.set_pinned, [self._particle(share) for share in shares], pinned)

    @rule(shares=SHARES)
    def cut(self, shares) -> None:
        cut, count = {"": set()}, len(self.scene.rest_length)
        for share in shares if count else ():
            body, _, number = self.scene.spring_name(int(share * count)).rpartition(":")
            cut.setdefault(body, set()).add(int(number))
        if count:
            self._edit(placing.without_springs, cut, cut.pop(""))

    @rule(by=POINTS, drag=st.none() | st.just("drag"))
    def move(self, by, drag) -> None:
        self._edit(moving.move, *by, merge=drag)

    @rule(angle=ANGLES, centre=POINTS)
    def rotate(self, angle, centre) -> None:
        self._edit(moving.rotate, angle, centre)

    @rule(sx=FACTORS, sy=FACTORS, even=st.booleans(), centre=POINTS)
    def scale(self, sx, sy, even, centre) -> None:
        self._edit(moving.scale, sx, sx if even else sy, centre)

    @rule(axis=st.sampled_from(["x", "y"]), centre=POINTS)
    def mirror(self, axis, centre) -> None:
        self._edit(moving.mirror, axis, centre)

    @rule(edge=st.sampled_from(["left", "right", "top", "bottom", "centre_x", "centre_y", "x", "y"]))
    def line_up(self, edge) -> None:
        self._edit(moving.distribute if edge in ("x", "y") else moving.align, edge)

    @rule(at=st.none() | POINTS)
    def copy_and_paste(self, at) -> None:
        try:
            self.clipboard = copying.copy_text(self.document)
        except EditError as error:
            assert "select" in str(error)
        self._edit(copying.paste, self.clipboard, at)

    @rule(text=st.sampled_from(["", "{}", "[1, 2", "\ud800", '{"format": "spring-sandbox/level"}']))
    def paste_something_else(self, text) -> None:
        self._edit(copying.paste, text)

    @rule(by=POINTS, count=COUNTS, angle=ANGLES, way=st.sampled_from(["copy", "line", "circle"]))
    def repeat(self, by, count, angle, way) -> None:
        if way == "copy":
            self._edit(copying.duplicate, *by)
        elif way == "line":
            self._edit(copying.array_line, count, *by)
        else:
            self._edit(copying.array_circle, count, by, angle)

    @rule(apart=st.booleans())
    def delete(self, apart) -> None:
        self._edit(deleting.break_apart if apart else deleting.delete)

    def _set_field(self, data, names, share, chosen=False) -> None:
        item = self._item(share)
        part = definitions(self.document.level, [item])[0]
        known = [name for name in sorted(names) if name in type(part).model_fields]
        if known:
            field = data.draw(st.sampled_from(known))
            items = self.document.selection if chosen else frozenset([item])
            self._edit(fields.set_field, items, field, data.draw(FIELDS[field]), merge=f"set {field}")

    @precondition(lambda self: self.scene.items)
    @rule(data=st.data(), chosen=st.booleans(), share=st.floats(0, 0.999))
    def set_form(self, data, chosen, share) -> None:
        self._set_field(data, FORM, share, chosen)

    @precondition(lambda self: self.document.level.bodies)
    @rule(data=st.data(), share=st.floats(0, 0.999))
    def set_count(self, data, share) -> None:
        self._set_field(data, COUNTED, share * len(self.document.level.bodies) / len(self.scene.items))

    @precondition(lambda self: self.scene.items)
    @rule(data=st.data(), chosen=st.booleans(), share=st.floats(0, 0.999))
    def set_another_field(self, data, chosen, share) -> None:
        self._set_field(data, set(FIELDS) - FORM - COUNTED, share, chosen)

    @rule(
        value=st.sampled_from(
            [
                *(
                    ("name", "Zoo 2"),
                    ("name", ""),
                    ("tags", ["a", "b"]),
                    ("view", [0, 0, 1, 1]),
                    ("view", [1, 0, 0, 1]),
                ),
                *(("gravity", [0, 1]), ("substeps", "auto"), ("substeps", 3), ("tick_rate", 120), ("solver", "magic")),
                *(("bodies", []), ("version", 2), ("nonsense", 1)),
            ]
        )
    )
    def set_level(self, value) -> None:
        settings_too = value[0] in ("gravity", "substeps", "tick_rate", "solver")
        self._edit(fields.set_setting if settings_too else fields.set_level_field, *value)

    @rule(way=st.integers(0, 5), name=st.sampled_from(["steel", "wire", "unused", "default", "fine", ""]), new=TEXTS)
    def change_materials(self, way, name, new) -> None:
        soft = NissenMaterial.model_construct(stiffness=0.1 * way, damping=0.5 * way)
        edits = [
            (materials.add_material, name, soft),
            (materials.rename_material, name, new),
            (materials.delete_material, name),
            (materials.set_material, name, soft),
            (materials.assign, name),
            (materials.assign, "default"),
        ]
        self._edit(*edits[way])

    @rule(share=st.floats(0, 0.999), bound=st.none() | FACTORS, metric=st.sampled_from(["x", "max_speed"]))
    def set_checks(self, share, bound, metric) -> None:
        particle = self._particle(share) if metric == "x" else None
        check = CheckDef.model_construct(name="c", metric=metric, particle=particle, at_most=bound)
        self._edit(materials.set_checks, [*self.document.level.checks, check][-3:])

    @rule(way=st.sampled_from([grouping.group, grouping.ungroup]))
    def regroup(self, way) -> None:
        self._edit(way)

    @rule(to=st.sampled_from(["front", "back", "forward", "backward"]))
    def reorder(self, to) -> None:
        self._edit(grouping.reorder, to)

    @precondition(lambda self: len(self.scene.mass))
    @rule(shares=SHARES, ticks=st.integers(0, 3), soft=st.booleans())
    def play_and_keep(self, shares, ticks, soft) -> None:
        world = build_world(self.document.level)
        springs = len(self.scene.rest_length)
        if springs:
            world.cut([int(share * springs) for share in shares[:1]])
        for share in shares:
            slot = int(share * int((self.scene.first_of_weld == range(len(self.scene.mass))).sum()))
            if (world.inverse_mass[slot] == 0.0) != soft:
                (world.pin if soft else world.unpin)(slot)
        if soft:
            world.set_coefficients(0.05, None, None)
        for _ in range(ticks):
            step(world)
        self._edit(bake.keep_coefficients, world)
        self._edit(bake.keep_pose, world)
        if self.document.level is self.states[self.index].level:
            self._edit(bake.keep_pins, world)
            self._edit(bake.keep_cuts, world)

    @rule(to=st.floats(0, 1), way=st.sampled_from(["undo", "undo", "redo", "go"]))
    def travel(self, to, way) -> None:
        last = len(self.states) - 1
        if way == "go":
            self.index = round(to * last)
            self.history.go_to(self.index)
        else:
            self.index = max(0, self.index - 1) if way == "undo" else min(last, self.index + 1)
            getattr(self.history, way)()
        self.key = None

    @invariant()
    def the_history_is_where_the_list_is(self) -> None:
        assert len(self.history.labels) == len(self.states)
        assert self.history.index == self.index
        expected = self.states[self.index]
        assert self.document.level is expected.level
        assert level_text(expected.level) == expected.text
        assert (self.history.can_undo, self.history.can_redo) == (self.index > 0, self.index < len(self.states) - 1)

    @invariant()
    def the_level_can_be_saved_and_read_again(self) -> None:
        present = self.states[self.index]
        if self.read is not present:
            read = parse_level(present.text.encode(), "saved")
            assert read == present.level
            assert level_text(read) == present.text
            self.read = present

    @invariant()
    def what_is_selected_is_there(self) -> None:
        assert self.document.selection <= set(items_of(self.document.level))
        assert select(self.document, self.document.selection).selection == self.document.selection

    @invariant()
    def the_scene_made_of_the_last_one_is_the_scene(self) -> None:
        self.scene = make_scene(self.document.level, self.scene)
        fresh = self._fresh_scene(self.document.level)
        assert self.scene.items == fresh.items
        for name in (
            "position",
            "mass",
            "pinned",
            "particle_item",
            "particle_a",
            "rest_length",
            "spring_item",
            "welds",
        ):
            assert (getattr(self.scene, name) == getattr(fresh, name)).all(), name


@pytest.mark.slow
@pytest.mark.parametrize("examples", part_and_whole(10, EXAMPLES))
def test_any_edits_can_be_undone_and_redone_and_leave_a_level_that_can_be_saved(examples):
    run_state_machine_as_test(
        EditingMachine,
        settings=settings(
            max_examples=examples,
            stateful_step_count=EDITS,
            deadline=None,
            suppress_health_check=list(HealthCheck),
        ),
    )
