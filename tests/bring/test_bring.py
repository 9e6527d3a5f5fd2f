"""Files of other programs become levels: outlines where they were, joints that hold, and a word for all left out."""

import io
import json

import numpy as np
import pytest
from PIL import Image, ImageDraw

from sandbox.bring.bring import bring
from sandbox.bring.making import with_floor
from sandbox.bring.picture import cut_out
from sandbox.bring.sketch import Pixels
from sandbox.cli import main
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.picture import PICTURE_LIMIT, check_picture, size_of
from sandbox.level.kinds.bodies import expansion
from sandbox.level.reading.files import parse_level, read_level, write_level
from sandbox.session.session import Session
from tests.support.foreign_files import SVG, TMX, png, rube, samples, tiled


def brought(tmp_path, data, name="a.svg", kind=None, width=None):
    path = tmp_path / name
    path.write_bytes(data)
    return bring(path, kind, width)


def svg(content, box="0 0 100 100"):
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}">{content}</svg>'.encode()


def extent(level):
    """Left, bottom, right, top of all bodies and terrain [m]."""
    places = [expansion(body).position for body in level.bodies]
    places += [np.array(piece.polygon or piece.polyline) for piece in level.terrain]
    whole = np.concatenate(places)
    return [*whole.min(axis=0).tolist(), *whole.max(axis=0).tolist()]


def solid_area(level):
    total = 0.0
    for piece in level.terrain:
        x, y = np.array(piece.polygon).T
        total += abs(float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))) / 2.0
    return total


def refusal(tmp_path, data, name="a.svg"):
    with pytest.raises(LevelError) as caught:
        brought(tmp_path, data, name)
    (fault,) = caught.value.faults
    return fault


@pytest.mark.parametrize("name", samples())
@pytest.mark.parametrize("kind", [None, "jelly", "ground"])
def test_every_kind_of_file_becomes_a_sound_level_of_either_kind(name, kind, tmp_path):
    path = tmp_path / name
    path.write_bytes(samples()[name])
    out = tmp_path / "out.json"
    assert main(["bring", str(path), "-o", str(out), *(["--as", kind] if kind else [])]) == 0
    level = read_level(out)
    assert level.bodies if kind == "jelly" else level.terrain
    session = Session(level)
    for _ in range(30):
        session.advance()


def test_y_points_up_and_the_drawing_is_ten_metres_wide_in_the_middle(tmp_path):
    low_left = svg('<path d="M0 100 H100 V90 H10 V50 H0 z"/>')
    level = brought(tmp_path, low_left, kind="ground").level
    assert extent(level) == pytest.approx([-5.0, 0.0, 5.0, 5.0])
    highest = max(level.terrain[0].polygon, key=lambda corner: corner[1])
    assert highest[0] < -3.9


def test_a_width_is_kept(tmp_path):
    level = brought(tmp_path, svg('<rect width="40" height="20"/>'), kind="ground", width=3.0).level
    assert extent(level) == pytest.approx([-1.5, 0.0, 1.5, 1.5])


@pytest.mark.parametrize(("rule", "area"), [("nonzero", 36.0), ("evenodd", 32.0)])
def test_the_fill_rule_says_what_is_a_hole(rule, area, tmp_path):
    twice = svg(f'<path fill-rule="{rule}" d="M0 0H60V60H0z M20 20H40V40H20z"/>')
    level = brought(tmp_path, twice, kind="ground", width=6.0).level
    assert solid_area(level) == pytest.approx(area, rel=1e-3)


def test_a_hole_against_the_way_of_its_outline_is_one_by_either_rule(tmp_path):
    level = brought(tmp_path, svg('<path d="M0 0H60V60H0z M20 20V40H40V20z"/>'), width=6.0).level
    (body,) = level.bodies
    assert len(body.holes) == 1 and body.mesh == "fitted"


def test_shapes_that_overlap_are_one_jelly_with_the_colour_of_the_largest(tmp_path):
    level = brought(
        tmp_path,
        svg(
            '<rect id="big" width="60" height="60" fill="#2040C0"/>'
            '<circle cx="60" cy="30" r="20" fill="red"/><rect x="90" width="9" height="9"/>'
        ),
    ).level
    assert [body.id for body in level.bodies] == ["big", "a"]
    assert level.bodies[0].look.colour == "#2040C0"


def test_transforms_copies_styles_and_classes_are_followed_and_the_rest_is_counted(tmp_path):
    found = brought(tmp_path, SVG)
    assert len(found.level.bodies) == 3
    assert set(found.left_out) == {"2 text elements", "1 hidden element", "1 gradient (its first colour came in)"}
    assert sorted(body.look.colour for body in found.level.bodies) == ["#2040C0", "#333333", "#FF8800"]


def test_a_background_as_large_as_the_page_is_left_out(tmp_path):
    found = brought(tmp_path, svg('<rect width="100" height="100"/><circle cx="30" cy="30" r="9"/>'))
    assert found.left_out == ["1 background"] and len(found.level.bodies) == 1


def test_particles_are_bounded_however_fine_the_drawing(tmp_path):
    comb = "M0 0 " + "".join(f"L{k} 60 {k + 0.4} 60 {k + 0.4} 5 {k + 1} 5 " for k in range(100)) + "L100 0z"
    level = brought(tmp_path, svg(f'<path d="{comb}"/><circle cx="50" cy="80" r="15"/>')).level
    assert 20 < sum(expansion(body).count[0] for body in level.bodies) < 5_000


def test_a_picture_gives_outlines_holes_and_mean_colours(tmp_path):
    level = brought(tmp_path, png(), "a.png").level
    ring, box = level.bodies
    assert len(ring.holes) == 1 and not box.holes
    assert ring.look.colour == "#C82828" and box.look.colour == "#28B450"
    left, bottom, right, top = extent(level)
    assert right - left == pytest.approx(10.0, rel=0.02) and top - bottom == pytest.approx(10.0 * 300 / 570, rel=0.03)


def test_what_is_made_of_a_picture_wears_its_part_of_it(tmp_path):
    found = brought(tmp_path, png(), "a.png")
    assert found.left_out == []
    write_level(found.level, tmp_path / "a.json")
    worn = [Image.open(tmp_path / f"{name}-skin.png") for name in ("a", "a-2")]
    assert [body.look.picture for body in read_level(tmp_path / "a.json").bodies] == ["a-skin.png", "a-2-skin.png"]
    # Each as large as its part, and painted where it was transparent, from what is near.
    assert np.allclose([picture.size for picture in worn], [(300, 300), (180, 200)], atol=6)
    for picture, colour in zip(worn, [(200, 40, 40), (40, 180, 80)], strict=True):
        assert np.abs(np.asarray(picture).astype(int) - colour).max() < 40


def test_a_large_picture_is_made_smaller_until_it_can_be_worn():
    noise = np.random.default_rng(1).integers(0, 256, (400, 2400, 4), dtype=np.uint8)
    data = cut_out(Pixels(noise, (0.0, 0.0), 0.01), (0.0, 0.0, 24.0, 4.0))
    check_picture(data)
    wide, high = size_of(data)
    assert len(data) > 0.7 * PICTURE_LIMIT and wide / high == pytest.approx(6.0, rel=0.01)


def test_a_picture_without_transparency_says_what_to_do(tmp_path):
    held = io.BytesIO()
    Image.new("RGB", (40, 40), "red").save(held, "PNG")
    assert "make its background transparent" in refusal(tmp_path, held.getvalue(), "a.png")


def test_specks_of_a_picture_are_counted(tmp_path):
    picture, held = Image.new("RGBA", (300, 300)), io.BytesIO()
    draw = ImageDraw.Draw(picture)
    draw.rectangle((10, 10, 200, 200), fill="red")
    draw.rectangle((250, 250, 251, 251), fill="red")
    picture.save(held, "PNG")
    assert "1 speck" in brought(tmp_path, held.getvalue(), "a.png").left_out


@pytest.mark.parametrize(("name", "data"), [("a.tmj", tiled()), ("a.tmx", TMX)])
def test_a_map_gives_tiles_shapes_of_tiles_and_objects_a_metre_a_tile(name, data, tmp_path):
    found = brought(tmp_path, data, name)
    assert set(found.left_out) == {"1 image layer", "1 point"}
    pieces = {piece.id: piece for piece in found.level.terrain}
    assert set(pieces) == {"ball", "wire", "a"} and pieces["wire"].polyline
    floor = np.array(pieces["a"].polygon)
    assert np.ptp(floor, axis=0) == pytest.approx([5.0, 2.0])
    slope = 0.5 * 1.0
    assert solid_area(found.level.model_copy(update={"terrain": (pieces["a"],)})) == pytest.approx(5 + 1 + slope)


def test_a_mirrored_tile_has_its_shape_mirrored(tmp_path):
    layer = {"type": "tilelayer", "name": "ground", "width": 1, "height": 1, "data": [2 | 0x80000000]}
    (piece,) = brought(tmp_path, tiled(layers=[layer]), "a.tmj").level.terrain
    assert sorted(piece.polygon) == [(-0.5, 0.0), (-0.5, 1.0), (0.5, 0.0)]


def test_tile_sets_beside_the_map_are_read_and_others_named(tmp_path):
    data = json.loads(tiled())
    (tile_set,) = data["tilesets"]
    (tmp_path / "t.tsj").write_text(json.dumps(tile_set))
    refs = [{"firstgid": 1, "source": "t.tsj"}, {"firstgid": 50, "source": "gone.tsx"}]
    found = brought(tmp_path, tiled(tilesets=refs), "a.tmj")
    assert "1 tile set that is not beside the map" in found.left_out
    assert brought(tmp_path, tiled(), "b.tmj").level.terrain[-1].polygon == found.level.terrain[-1].polygon


def test_objects_of_the_game_are_no_ground(tmp_path):
    player = {"id": 9, "type": "player", "x": 0, "y": 0, "width": 16, "height": 16}
    layers = [*json.loads(tiled())["layers"], {"type": "objectgroup", "name": "spawns", "objects": [player]}]
    assert '1 "player" (layer spawns)' in brought(tmp_path, tiled(layers=layers), "a.tmj").left_out


def test_a_scene_keeps_its_metres_and_moves_as_it_would(tmp_path):
    found = brought(tmp_path, rube(), "a.json")
    level = found.level
    assert [piece.id for piece in level.terrain] == ["ground"]
    assert {body.id for body in level.bodies} == {"upper", "lower", "disc", "left", "right"}
    assert sorted(found.left_out) == ["1 motor of a joint that is no axle of a disc", "1 prismatic joint"]
    session = Session(level)
    first = {name: place(session.world, name) for name in ("upper", "lower", "left", "right", "disc")}
    for _ in range(120):
        session.advance()
    now = {name: place(session.world, name) for name in first}
    for name in ("upper", "lower"):
        assert np.linalg.norm(now[name] - first[name]) < 0.05, "a pendulum that hangs"
    assert np.linalg.norm(now["left"] - now["right"]) == pytest.approx(1.0, abs=0.03)
    assert now["disc"][0] < first["disc"][0] - 0.5 and now["left"][1] < 0.3


def place(world, name):
    """Where the middle of a body's particles is [m]."""
    first = world.particle_slot(f"{name}.0")
    return world.position[world.owner == world.owner[first]].mean(axis=0)


def test_joined_bodies_pass_through_each_other_unless_the_scene_says_that_they_touch(tmp_path):
    level = brought(tmp_path, rube(), "a.json").level
    upper = next(body for body in level.bodies if body.id == "upper")
    assert "lower" not in upper.collides and {"terrain", "default", "left"} <= set(upper.collides)


def test_jellies_get_ground_under_them_where_there_is_none(tmp_path):
    level = with_floor(brought(tmp_path, SVG).level)
    (floor,) = level.terrain
    assert max(y for _, y in floor.polygon) == 0.0 and extent(level)[1] == -2.0
    assert with_floor(level) is level


def test_the_level_says_the_same_when_it_is_read_again(tmp_path):
    from sandbox.level.document.canonical import level_text

    level = brought(tmp_path, SVG).level
    assert parse_level(level_text(level).encode(), "x") == level


def test_what_is_no_such_file_is_named(tmp_path, capsys):
    (tmp_path / "x.gif").write_bytes(b"GIF89a")
    assert main(["bring", str(tmp_path / "x.gif"), "-o", str(tmp_path / "o.json")]) == 2
    assert "is a GIF picture; SVG, PNG, Tiled maps and R.U.B.E. scenes" in capsys.readouterr().err


def test_a_level_in_place_of_which_a_drawing_is_given_says_what_to_do(tmp_path, capsys):
    path = tmp_path / "a.svg"
    path.write_bytes(SVG)
    assert main(["check", str(path)]) != 0
    out = capsys.readouterr()
    assert "is an SVG drawing, not a Spring Sandbox level; `sandbox bring` makes a level of it" in out.err + out.out


def test_without_the_packages_one_line_says_how_to_get_them(tmp_path, monkeypatch):
    import importlib.util

    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert 'pip install "spring-sandbox[bring]"' in refusal(tmp_path, SVG)


def test_the_file_itself_is_not_written_over(tmp_path, capsys):
    path = tmp_path / "a.svg"
    path.write_bytes(SVG)
    assert main(["bring", str(path), "-o", str(path)]) == 2
    assert path.read_bytes() == SVG and "name another" in capsys.readouterr().err
