"""What a file of another program says of masses, filters, motors, mirrors and sizes holds here, or is named."""

import json
import math

import numpy as np
import pytest

from sandbox.bring.bring import bring
from sandbox.level.format.level_error import LevelError
from sandbox.level.kinds.bodies import expansion
from sandbox.session.session import Session
from tests.support.foreign_files import tiled

BOX = [(-1, -1), (1, -1), (1, 1), (-1, 1)]


def brought(tmp_path, data, name="a.json", kind=None):
    (tmp_path / name).write_bytes(data)
    return bring(tmp_path / name, kind)


def fixture(points, density=1.0, **more):
    xs, ys = zip(*points, strict=True)
    return {"density": density, "polygon": {"vertices": {"x": list(xs), "y": list(ys)}}} | more


def scaled(points, x, y, by=(0.0, 0.0)):
    return [(x * a + by[0], y * b + by[1]) for a, b in points]


def body(name, place, *fixtures, kind=2, **more):
    return {
        "name": name, "type": kind, "position": {"x": place[0], "y": place[1]}, "fixture": list(fixtures)
    } | more  # fmt: skip


def scene(tmp_path, *bodies, joints=(), gravity=-10.0):
    data = {"gravity": {"x": 0, "y": gravity}, "body": list(bodies), "joint": list(joints)}
    return brought(tmp_path, json.dumps(data).encode())


def of(level, name):
    return next(each for each in level.bodies if each.id == name)


def after(level, seconds):
    session = Session(level)
    for _ in range(round(60 * seconds)):
        session.advance()
    return session.world


def middle(world, name):
    own = world.owner == world.owner[world.particle_slot(f"{name}.0")]
    return np.average(world.position[own], axis=0, weights=world.mass[own])


# ---- masses


def test_a_body_weighs_what_its_fixtures_do_and_is_heavy_where_they_are(tmp_path):
    handle, head = fixture(scaled(BOX, 1.0, 0.1), 1.0), fixture(scaled(BOX, 0.2, 0.5, (1.2, 0.0)), 20.0)
    level = scene(
        tmp_path, body("hammer", (0, 0), handle, head), body("plank", (8, 0), fixture(scaled(BOX, 2, 0.05), 5))
    )
    hammer, plank = (expansion(of(level.level, name)) for name in ("hammer", "plank"))
    assert hammer.mass.sum() == pytest.approx(0.4 + 8.0, rel=1e-3)
    assert np.average(hammer.position[:, 0], weights=hammer.mass) == pytest.approx(9.6 / 8.4, abs=0.02)
    assert plank.mass.sum() == pytest.approx(2.0, rel=1e-3)


def test_what_overlaps_within_a_body_weighs_twice(tmp_path):
    level = scene(tmp_path, body("b", (0, 0), fixture(BOX, 3.0), fixture(BOX, 3.0))).level
    assert expansion(of(level, "b")).mass.sum() == pytest.approx(24.0, rel=1e-3)


@pytest.mark.parametrize("wide", [1.0, 20.0])
def test_a_drawing_weighs_by_its_area_however_slender(wide, tmp_path):
    data = f'<svg xmlns="http://www.w3.org/2000/svg"><rect width="{wide}" height="1"/></svg>'.encode()
    (made,) = brought(tmp_path, data, "a.svg").level.bodies
    size = 10.0 * 10.0 / wide
    assert expansion(made).mass.sum() == pytest.approx(20.0 * size, rel=0.02)


# ---- gravity, filters, friction


def test_gravity_scale_comes_in_and_damping_is_named(tmp_path):
    bodies = [
        body("up", (0, 5), fixture(BOX), gravityScale=-0.5),
        body("down", (5, 5), fixture(BOX), linearDamping=0.3),
    ]
    found = scene(tmp_path, *bodies, body("gone", (9, 9), fixture(BOX), active=False))
    world = after(found.level, 1.0)
    assert middle(world, "up")[1] == pytest.approx(7.5, abs=0.1)
    assert middle(world, "down")[1] == pytest.approx(0.0, abs=0.1)
    assert sorted(found.left_out) == ["1 body that is not active", "1 damping of a body"]


def filtered(category=1, mask=0xFFFF, group=0):
    keys = ("filter-categoryBits", "filter-maskBits", "filter-groupIndex")
    return fixture(BOX, 1.0, **dict(zip(keys, (category, mask, group), strict=True)))


@pytest.mark.parametrize(
    ("one", "other", "touch"),
    [
        (filtered(), filtered(), True),
        (filtered(group=-1), filtered(group=-1), False),
        (filtered(group=-1), filtered(group=-2), True),
        (filtered(2, 2), filtered(4, 4), False),
        (filtered(2, 4), filtered(4, 2), True),
        (filtered(2, 4), filtered(4, 1), False),
        (filtered(2, 2, 3), filtered(4, 4, 3), True),
    ],
)
def test_filters_say_what_touches(one, other, touch, tmp_path):
    level = scene(tmp_path, body("a", (0, 0), one), body("b", (1.5, 0), other), gravity=0.0).level
    world = after(level, 4.0)
    apart = middle(world, "b")[0] - middle(world, "a")[0]
    assert (apart > 1.95) == touch and (apart == pytest.approx(1.5, abs=1e-6)) != touch


def test_a_filter_lets_a_body_fall_through_the_ground(tmp_path):
    ground = body("ground", (0, -2), fixture(scaled(BOX, 9, 1)), kind=0)
    bodies = [body("ghost", (0, 1), filtered(2, 2)), body("solid", (4, 1), filtered())]
    world = after(scene(tmp_path, ground, *bodies).level, 1.0)
    assert middle(world, "ghost")[1] < -3.0 and middle(world, "solid")[1] == pytest.approx(0.0, abs=0.1)


def test_each_part_of_the_ground_has_its_own_friction(tmp_path):
    rough, ice = fixture(scaled(BOX, 2, 1), friction=0.8), fixture(scaled(BOX, 2, 1, (4, 0)), friction=0.0)
    level = scene(tmp_path, body("ground", (0, 0), rough, ice, kind=0)).level
    assert {(piece.polygon[0][0] > 1.5, piece.friction) for piece in level.terrain} == {(False, 0.8), (True, 0.0)}


# ---- joints


@pytest.mark.parametrize("pivot", [(0.0, 0.0), (0.2, -0.1)])
def test_a_rod_swings_from_a_hinge_within_its_bracket(pivot, tmp_path):
    bracket = body("bracket", (0, 5), fixture(scaled(BOX, 0.4, 0.4)), kind=0)
    rod = body("rod", (pivot[0], 4 + pivot[1]), fixture(scaled(BOX, 0.1, 1.0)), linearVelocity={"x": 0.3, "y": 0})
    hinge = {"type": "revolute", "bodyA": 0, "bodyB": 1, "anchorA": {"x": pivot[0], "y": pivot[1]},
             "anchorB": {"x": 0, "y": 1}}  # fmt: skip
    session = Session(scene(tmp_path, bracket, rod, joints=[hinge]).level)
    way = []
    for _ in range(720):
        session.advance()
        way.append(middle(session.world, "rod")[0] - pivot[0])
    crossings = [k for k in range(719) if way[k] < 0.0 <= way[k + 1]]
    period = (crossings[-1] - crossings[0]) / (len(crossings) - 1) / 60.0
    assert period == pytest.approx(math.tau * math.sqrt(((4 + 0.04) / 12 + 1.0) / 10.0), rel=0.03)


@pytest.mark.parametrize("kind", ["wheel", "revolute"])
@pytest.mark.parametrize("turned_round", [False, True])
def test_a_car_drives_by_the_motors_of_its_joints(kind, turned_round, tmp_path):
    ground = body("ground", (0, -1), fixture(scaled(BOX, 60, 1)), kind=0)
    car = body("car", (0, 1), fixture(scaled(BOX, 1.2, 0.3)))
    wheels = [
        body(f"w{k}", (x, 0.5), {"density": 1.0, "friction": 1.0, "circle": {"center": 0, "radius": 0.4}})
        for k, x in enumerate((-0.8, 0.8))
    ]
    joints = []
    for k, x in enumerate((-0.8, 0.8)):
        ends = [(1, {"x": x, "y": -0.5}), (2 + k, 0)]
        speed = -6.0
        if turned_round:
            ends, speed = ends[::-1], -speed
        (a, at_a), (b, at_b) = ends
        joints.append(
            {"type": kind, "bodyA": a, "bodyB": b, "anchorA": at_a, "anchorB": at_b, "enableMotor": True}
            | {"motorSpeed": speed, "maxMotorTorque": 20.0}
        )
    found = scene(tmp_path, ground, car, *wheels, joints=joints)
    world = after(found.level, 4.0)
    # 6 rad/s on wheels of 0.4 m, to the right.
    assert 6.0 < middle(world, "car")[0] < 10.0
    assert np.linalg.norm(middle(world, "w1") - middle(world, "w0")) == pytest.approx(1.6, abs=0.03)
    assert found.left_out == []


def test_a_wheel_with_a_motor_has_the_mass_and_inertia_of_its_disc(tmp_path):
    disc = body("w", (0, 0), {"density": 3.0, "circle": {"center": 0, "radius": 0.5}})
    motor = {"type": "revolute", "bodyA": 0, "bodyB": 1, "anchorA": 0, "anchorB": 0, "enableMotor": True}
    level = scene(tmp_path, body("car", (0, 0), fixture(BOX)), disc, joints=[motor | {"maxMotorTorque": 1}]).level
    made = expansion(of(level, "w"))
    mass = 3.0 * math.pi * 0.25
    assert made.mass.sum() == pytest.approx(mass, rel=1e-6)
    assert (made.mass * (made.position**2).sum(axis=1)).sum() == pytest.approx(0.5 * mass * 0.25, rel=1e-6)


# ---- maps


CORNER = {
    "firstgid": 1, "tilewidth": 16, "tileheight": 32,
    "tiles": [{"id": 0, "objectgroup": {"objects": [{"id": 1, "x": 0, "y": 24, "width": 4, "height": 8}]}}],
}  # fmt: skip


@pytest.mark.parametrize(
    ("flips", "size", "turn", "box"),
    [
        (0, (16, 32), 0, (0, 0, 0.25, 0.5)),
        (0x80000000, (16, 32), 0, (0.75, 0, 1, 0.5)),
        (0x40000000, (16, 32), 0, (0, 1.5, 0.25, 2)),
        (0xC0000000, (32, 32), 0, (1.5, 1.5, 2, 2)),
        (0, (32, 64), 0, (0, 0, 0.5, 1)),
        (0, (32, 32), 90, (0, -0.5, 0.5, 0)),
        (0x80000000, (16, 64), 180, (-1, -1, -0.75, 0)),
    ],
)
def test_a_tile_object_is_mirrored_stretched_and_turned_with_its_picture(flips, size, turn, box, tmp_path):
    tile = {"id": 1, "name": "t", "gid": 1 | flips, "x": 32, "y": 32, "width": size[0], "height": size[1]}
    mark = {"id": 2, "name": "mark", "x": 0, "y": 24, "width": 8, "height": 8}
    layer = {"type": "objectgroup", "name": "solid", "objects": [tile | {"rotation": turn}, mark]}
    level = brought(tmp_path, tiled(tilesets=[CORNER], layers=[layer]), "a.tmj").level
    pieces = {piece.id: np.array(piece.polygon) for piece in level.terrain}
    # The mark ends half a metre left of, and lies on, where the tile object stands.
    at = pieces["mark"].max(axis=0) + np.array([1.5, -0.5])
    seen = [*(pieces["t"].min(axis=0) - at), *(pieces["t"].max(axis=0) - at)]
    assert seen == pytest.approx(box, abs=1e-3)


# ---- drawings


def widths(tmp_path, content, head='viewBox="0 0 100 100"'):
    data = f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{content}</svg>'.encode()
    level = brought(tmp_path, data, "a.svg", "ground").level
    spans = [np.ptp(np.array(piece.polygon), axis=0) for piece in level.terrain]
    return sorted((round(float(x), 3), round(float(y), 3)) for x, y in spans)


ICON = '<symbol id="i" viewBox="0 0 10 10"><rect width="10" height="10"/></symbol>'


@pytest.mark.parametrize(
    ("content", "right"),
    [
        (f'{ICON}<use href="#i" width="20" height="20"/><use href="#i" x="60" width="40" height="40"/>', [2.0, 4.0]),
        (f'{ICON}<use href="#i" width="20" height="50"/><rect x="60" width="40" height="40"/>', [2.0, 4.0]),
        ('<svg x="5" width="20" height="20" viewBox="0 0 4 4"><rect width="4" height="4"/></svg>'
         '<rect x="65" width="40" height="20"/>', [2.0, 4.0]),
        ('<svg x="5" width="20" height="20"><rect width="50%" height="100%"/></svg>'
         '<rect x="85" width="20" height="9"/>', [1.0, 2.0]),
        ('<rect style="transform: scale(2)" width="20" height="9"/><rect x="90" width="10" height="9"/>', [1.0, 4.0]),
        ('<switch><rect systemLanguage="de" width="99" height="9"/><rect width="20" height="9"/>'
         '<rect width="50" height="9"/></switch><rect x="90" width="10" height="9"/>', [1.0, 2.0]),
    ],
)  # fmt: skip
def test_symbols_inner_drawings_and_choices_are_as_large_as_a_browser_shows_them(content, right, tmp_path):
    found = [x for x, _ in widths(tmp_path, content)]
    whole = found[-1] / right[-1]
    assert [x / whole for x in found] == pytest.approx(right, abs=0.01)


def test_a_drawing_may_be_stretched(tmp_path):
    head = 'viewBox="0 0 10 10" width="100" height="40" preserveAspectRatio="none"'
    assert widths(tmp_path, '<rect width="10" height="10"/>', head) == [(10.0, 4.0)]


@pytest.mark.parametrize(
    ("rule", "is_seen"),
    [
        ("@media print{.a{fill:none}}", True),
        ("@media screen{.a{fill:none}}", False),
        ("@media (prefers-color-scheme: dark){.a{fill:none}}", True),
        ("@media not print{.a{fill:none}}", False),
        ("@media print, screen{.a{fill:none}}", False),
        ("@media screen{@media print{.a{fill:none}}}", True),
        ("@supports (fill: red){.a{fill:none}}", False),
        ("@keyframes b{from{fill:red}} .a{fill:none}", False),
        ('@import url("x.css"); .a{fill:none}', False),
        ("@media print{.b{fill:red} .a{fill:none}} .b{fill:red}", True),
    ],
)
def test_rules_of_a_style_sheet_hold_where_they_would_on_a_screen(rule, is_seen, tmp_path):
    drawing = f'<style>{rule}</style><rect class="a" width="10" height="10"/><rect x="50" width="10" height="10"/>'
    assert len(widths(tmp_path, drawing)) == 1 + is_seen


# ---- maps of older programs, and tiles without shapes


def test_tiles_that_an_older_tiled_lists_by_number_have_their_shapes_and_properties(tmp_path):
    ramp = [{"x": 0, "y": 16}, {"x": 16, "y": 0}, {"x": 16, "y": 16}]
    old = {
        "firstgid": 1, "tilewidth": 16, "tileheight": 16, "tileproperties": {"0": {"solid": True}, "1": {"name": "r"}},
        "tiles": {"1": {"objectgroup": {"objects": [{"x": 0, "y": 0, "polygon": ramp}]}}},
    }  # fmt: skip
    layers = [{"type": "tilelayer", "name": "Tile Layer 1", "width": 3, "height": 1, "data": [1, 2, 3]}]
    got = brought(tmp_path, tiled(width=3, height=1, tilesets=[old], layers=layers), "a.tmj")
    block, ramp = (sorted(piece.polygon) for piece in got.level.terrain)
    assert block == [(-1.0, 0.0), (-1.0, 1.0), (0.0, 0.0), (0.0, 1.0)]
    assert ramp == [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]
    assert got.left_out == ["1 tile without a collision shape"]


@pytest.mark.parametrize(("name", "pieces"), [("ground", 1), ("things", 0)])
def test_tiles_without_shapes_are_whole_where_their_layer_is_solid(name, pieces, tmp_path):
    layers = [
        {"type": "objectgroup", "name": "collision", "objects": [{"x": 0, "y": 64, "width": 8, "height": 8}]},
        {"type": "objectgroup", "name": name, "objects": [{"gid": 1, "x": 32, "y": 32, "width": 32, "height": 16}]},
    ]
    got = brought(tmp_path, tiled(layers=layers), "a.tmj")
    assert len(got.level.terrain) == 1 + pieces
    if pieces:
        assert np.ptp(max(got.level.terrain, key=lambda piece: piece.polygon[0][1]).polygon, axis=0).tolist() == [2, 1]


def test_a_page_behind_thin_lines_is_a_background_and_a_word_says_how_lines_come_in(tmp_path):
    line = '<path stroke="red" fill="none" stroke-width=".2" d="M5 5L9 30"/>'
    data = f'<svg width="80" height="40"><rect width="80" height="40"/>{line}</svg>'.encode()
    with pytest.raises(LevelError, match=r"1 open line too thin for a jelly \(as ground it comes in\)"):
        brought(tmp_path, data, "a.svg")
    assert len(brought(tmp_path, data, "a.svg", "ground").level.terrain) == 1


def test_a_tile_set_is_called_one(tmp_path):
    with pytest.raises(LevelError, match="is a Tiled tile set, and no map"):
        brought(tmp_path, b'{"columns": 2, "image": "a.png", "imagewidth": 32, "tilewidth": 16, "tileheight": 16}')


@pytest.mark.parametrize(("end", "is_closed"), [("10.5 11", True), ("10.5 16", False)])
def test_a_stroke_whose_ends_lie_within_its_width_is_closed(end, is_closed, tmp_path):
    path = f'<path stroke="red" fill="none" stroke-width="2" d="M10 10H40V40H10L{end}"/>'
    data = f'<svg width="400" height="60">{path}<rect x="380" width="20" height="9"/></svg>'.encode()
    assert len(brought(tmp_path, data, "a.svg").level.bodies) == 1 + is_closed


def test_a_drawing_without_a_page_has_no_background_and_signs_part_numbers(tmp_path):
    data = b'<svg><rect width="300" height="100"/><polygon points="400,0 4e2-50,450-50\t450 0"/></svg>'
    got = brought(tmp_path, data, "a.svg")
    assert len(got.level.bodies) == 2 and got.left_out == []
