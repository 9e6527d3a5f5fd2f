"""Level files: what is read, how it is written, and what is shipped."""

import json
import os
import stat

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.format import shipped
from sandbox.level.kinds.bodies import expansion
from sandbox.level.reading import files
from sandbox.level.reading.files import (
    LevelError,
    level_data,
    load_level,
    parse_level,
    read_level,
    shipped_folder,
    shipped_levels,
    write_level,
)
from sandbox.physics.snapshot import state_hash
from tests.support.malformed_levels import GOOD, encoded


def good():
    return parse_level(encoded(GOOD), "good")


def refusal(call, *arguments):
    with pytest.raises(LevelError) as refused:
        call(*arguments)
    (fault,) = refused.value.faults
    return fault


def test_what_is_saved_is_what_is_loaded(tmp_path):
    write_level(good(), tmp_path / "x.json")
    assert read_level(tmp_path / "x.json") == good()
    again = (tmp_path / "x.json").read_bytes()
    write_level(read_level(tmp_path / "x.json"), tmp_path / "x.json")
    assert (tmp_path / "x.json").read_bytes() == again


def test_the_canonical_form_leaves_defaults_out_but_for_the_solver():
    minimal = parse_level(b'{"format": "spring-sandbox/level", "version": 4, "name": "n"}', "x")
    assert level_data(minimal) == {
        "format": "spring-sandbox/level",
        "version": 4,
        "name": "n",
        "settings": {"solver": minimal.settings.solver},
    }


def test_the_canonical_form_gives_a_body_a_block_and_a_spring_a_line():
    level = parse_level(
        encoded(
            {
                "springs": [{"b": "r.1", "a": "p"}],
                "particles": [{"mass": 2, "id": "p"}],
                "bodies": [{"segments": 1, "end": [1, 0], "start": [0, 0], "id": "r", "type": "rope", "angle": 0}],
                "name": "n",
                "version": 4,
                "format": "spring-sandbox/level",
            }
        ).replace(b', "angle": 0', b""),
        "x",
    )
    assert level_text(level) == (
        "{\n"
        '  "format": "spring-sandbox/level",\n'
        '  "version": 4,\n'
        '  "name": "n",\n'
        f'  "settings": {{"solver": "{level.settings.solver}"}},\n'
        '  "bodies": [\n'
        "    {\n"
        '      "type": "rope",\n'
        '      "id": "r",\n'
        '      "start": [0.0, 0.0],\n'
        '      "end": [1.0, 0.0],\n'
        '      "segments": 1\n'
        "    }\n"
        "  ],\n"
        '  "particles": [\n'
        '    {"id": "p", "mass": 2.0}\n'
        "  ],\n"
        '  "springs": [\n'
        '    {"a": "p", "b": "r.1"}\n'
        "  ]\n"
        "}\n"
    )


def test_the_canonical_text_is_the_canonical_data():
    assert json.loads(level_text(good())) == level_data(good())


def test_text_outside_ascii_is_written_as_it_is():
    level = parse_level(encoded({**GOOD, "author": "Åsa Ø. 弹簧"}), "x")
    assert "Åsa Ø. 弹簧" in level_text(level)


def test_no_line_of_a_long_list_grows_beyond_the_page():
    mesh = {"type": "mesh", "id": "m", "particles": [[k, 0.125] for k in range(100)], "pinned": list(range(100))}
    text = level_text(parse_level(encoded({**GOOD, "bodies": [mesh], "springs": [], "welds": []}), "x"))
    assert max(map(len, text.splitlines())) <= 100


def test_a_write_that_fails_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch):
    path = tmp_path / "x.json"
    path.write_text("old")

    def full(_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files.os, "fsync", full)
    assert refusal(write_level, good(), path) == f"{path}: cannot be written: no space left on device"
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["x.json"]


def test_a_write_goes_through_a_link_and_keeps_the_permissions(tmp_path):
    path = tmp_path / "real.json"
    path.write_text("old")
    path.chmod(0o640)
    (tmp_path / "link.json").symlink_to(path)
    write_level(good(), tmp_path / "link.json")
    assert (tmp_path / "link.json").is_symlink()
    assert read_level(path) == good()
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_a_level_that_could_not_be_read_back_is_not_written(tmp_path):
    twice = good().model_copy(update={"particles": good().particles * 2})
    assert '"ball" is taken' in refusal(write_level, twice, tmp_path / "x.json")
    assert os.listdir(tmp_path) == []


def test_a_level_is_not_written_into_a_folder_that_does_not_exist(tmp_path):
    path = tmp_path / "none" / "x.json"
    assert refusal(write_level, good(), path) == f"{path}: cannot be written: no such file or directory"


def test_files_that_cannot_be_read_are_refused_in_a_line(tmp_path, monkeypatch):
    missing, empty = tmp_path / "missing.json", tmp_path / "empty.json"
    empty.write_bytes(b"")
    assert refusal(read_level, missing) == f"{missing}: there is no such file"
    assert refusal(read_level, empty) == f"{empty}: is empty; a level is a JSON object {{...}}"
    assert refusal(read_level, tmp_path) == f"{tmp_path}: is a folder; name a level file"
    assert refusal(read_level, "x\0.json") == "x\\u0000.json: cannot be read: the name holds a null character"
    assert "cannot be read: file name too long" in refusal(read_level, "x" * 5_000)
    assert refusal(read_level, "a\nb.json") == "a\\nb.json: there is no such file"

    def forbidden(*_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("builtins.open", forbidden)
    assert refusal(read_level, empty) == f"{empty}: cannot be read: permission denied"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes here")
def test_a_pipe_is_refused_instead_of_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.json")
    assert "is no regular file" in refusal(read_level, tmp_path / "pipe.json")


def test_a_file_beyond_the_limit_is_not_read_to_its_end(tmp_path):
    path = tmp_path / "huge.json"
    with open(path, "wb") as file:
        file.truncate(1 << 40)
    assert refusal(read_level, path) == f"{path}: is larger than 8 MiB; make it smaller"


def test_shipped_levels_load_by_their_bare_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert load_level("rope") == load_level("rope.json") == read_level(shipped_folder("levels") / "rope.json")


def test_a_file_here_wins_over_a_shipped_level_of_its_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_level(good(), "rope.json")
    assert load_level("rope.json") == good()
    (tmp_path / "rope").mkdir()
    assert load_level("rope").name == "Rope"
    (tmp_path / "none").mkdir()
    assert refusal(load_level, "none") == "none: is a folder; name a level file"


def test_a_name_that_is_nowhere_is_answered_with_what_is_shipped(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert refusal(load_level, "girdr").endswith('no shipped level of that name; did you mean "girder"?')
    names = ", ".join(path.stem for path in shipped_levels())
    assert refusal(load_level, "zzz").endswith(f"shipped are {names}")
    assert refusal(load_level, "folder/rope") == "folder/rope: there is no such file"
    assert "no such file" in refusal(load_level, "")


def test_the_wheel_s_folder_is_used_where_there_is_no_checkout(tmp_path, monkeypatch):
    package = tmp_path / "site-packages" / "sandbox"
    (package / "_shipped" / "levels").mkdir(parents=True)
    (tmp_path / "site-packages" / "levels").mkdir()
    (package / "_shipped" / "levels" / "only.json").write_text(level_text(good()))
    monkeypatch.setattr(shipped, "_PACKAGE", package)
    assert [path.stem for path in shipped_levels()] == ["only"]
    assert load_level("only") == good()


numbers = st.floats(-1e6, 1e6)
points = st.tuples(numbers, numbers).map(list)
masses = st.floats(1e-9, 1e8)  # ten of them can be welded into one
coefficients = st.floats(0, 1)
texts = st.text(st.characters(exclude_categories=("Cs", "Cc")), max_size=20)
ids = st.text(st.characters(exclude_categories=("Cs", "Cc"), exclude_characters="+.:,"), min_size=1, max_size=8)
finite = st.floats(allow_nan=False, allow_infinity=False)
extras = st.dictionaries(
    texts,
    st.recursive(
        st.none()
        | st.booleans()
        | st.integers(-(2**70), 2**70)
        | st.floats(allow_nan=False, allow_infinity=False)
        | texts,
        lambda inner: st.lists(inner, max_size=3) | st.dictionaries(texts, inner, max_size=3),
        max_leaves=6,
    ),
    max_size=3,
)


def some(required, **optional):
    return st.fixed_dictionaries(required, optional=optional)


def bodies(name, material):
    """Any body of that name and material."""
    common = {"velocity": points, "extras": extras, "material": st.just(material), "group": ids}
    pin = st.lists(st.sampled_from(["start", "end"]), max_size=2)
    near = st.tuples(st.floats(-99, 99), st.floats(-99, 99)).map(list)
    size = st.floats(0.01, 3)
    shapes = (
        some({"box": st.tuples(size, size).map(list)})
        | some({"circle": size})
        | some({"polygon": st.just([[0.0, 0.0], [2.5, 0.0], [0.0, 2.5]])})
    )
    ends = {"id": st.just(name), "start": near, "end": near, "segments": st.integers(1, 50)}
    jelly = {"id": st.just(name), "shape": shapes, "spacing": st.floats(0.1, 2)}
    round_one = {"id": st.just(name), "radius": st.floats(0.5, 3)}
    web = {"type": st.just("web"), **round_one, "spokes": st.integers(3, 9), "rings": st.integers(1, 5)}
    wheel = {"type": st.just("wheel"), **round_one, "thickness": st.floats(0.01, 0.4), "segments": st.integers(3, 9)}
    mesh = {"id": st.just(name), "particles": st.lists(points, min_size=2, max_size=2), "springs": st.just([[0, 1]])}
    return st.one_of(
        some({"type": st.just("rope"), **ends}, end_mass=masses, rest_length=st.floats(0, 10), pin=pin, **common),
        some({"type": st.just("bridge"), **ends}, height=size, particle_mass=masses, pin=pin, **common),
        some({"type": st.just("girder"), **ends}, height=size, pin=pin, **common).filter(is_long),
        some(web, angle=st.floats(-10, 10), position=near, pin=st.just(["rim"]), **common),
        some(wheel, angle=st.floats(-10, 10), hub_mass=masses, pin=st.just(["hub"]), **common),
        some({"type": st.just("jelly"), **jelly}, angle=st.floats(-10, 10), position=near, **common),
        some({"type": st.just("mesh"), **mesh}, masses=st.lists(masses, min_size=2, max_size=2), **common),
    )


def is_long(girder):
    return max(abs(end - start) for start, end in zip(girder["start"], girder["end"], strict=True)) > 1e-5


@st.composite
def changed_bodies(draw, name, material):
    """Any body, perhaps with pins, cuts and a pose."""
    body = draw(bodies(name, material))
    head = {"format": "spring-sandbox/level", "version": 4, "name": "n", "materials": {material: {}}}
    particles, springs = expansion(parse_level(encoded({**head, "bodies": [body]}), "x.json").bodies[0]).form_count
    changes = some(
        {},
        pinned=st.lists(st.integers(0, particles - 1), max_size=4),
        cut=st.lists(st.integers(0, springs - 1), max_size=4) if springs else st.just([]),
        pose=points.map(lambda first: [first] + [[0.0, 0.0]] * (particles - 1)),
    )
    return body | draw(changes)


@st.composite
def levels(draw):
    names = draw(st.lists(ids, min_size=3, max_size=8, unique=True))
    breaking = {
        "tension_limit": st.floats(1e-6, 1e3),
        "compression_limit": st.floats(1e-6, 1.0),
        "yield_strain": st.floats(1e-6, 0.5),
        "yield_limit": st.floats(0, 0.9),
    }
    material = some({}, stiffness=coefficients, damping=coefficients, **breaking)
    classic = some({"law": st.just("hooke")}, k=st.floats(0, 1e15), c=st.floats(0, 1e15), **breaking)
    wave = some({"amplitude": st.floats(0, 0.9), "period": st.integers(2, 10**6)}, phase=coefficients)
    jack = some({"shortest": st.just(0.5), "longest": st.just(2.0), "rate": st.floats(0, 1e6)}, key=st.just("q"))
    materials = draw(st.dictionaries(ids, material | classic, max_size=3))
    chosen = st.sampled_from(["default", *materials])
    optional = {
        "group": ids,
        "position": points,
        "velocity": points,
        "mass": masses,
        "radius": st.floats(0, 10),
        "extras": extras,
        "gravity_scale": st.floats(-1e3, 1e3),
    }
    turning = {"rolls": st.booleans(), "rolling": coefficients, "angle": st.floats(-9, 9), "spin": st.floats(-9, 9)}
    settings = some(
        {},
        gravity=points,
        tick_rate=st.integers(1, 10_000),
        substeps=st.sampled_from([1, 2, 64, "auto"]),
        solver=st.sampled_from(["single_pass", "iterative", "direct"]),
        warm_start=coefficients,
        wind=points,
        drag=st.floats(0, 1e6),
    )
    head = {"format": st.just("spring-sandbox/level"), "version": st.just(1), "name": ids, "settings": settings}
    return draw(some(head, description=texts, tags=st.lists(texts, max_size=3), extras=extras)) | {
        "materials": materials,
        "bodies": [draw(changed_bodies(name, draw(chosen))) for name in names[3:]],
        "particles": [
            draw(some({"id": st.just(name)}, pinned=st.booleans(), **turning, **optional)) for name in names[:3]
        ],
        "springs": [
            {"a": names[0], "b": names[1], "material": draw(chosen)} | draw(some({}, drive=wave)),
            {"a": names[1], "b": names[2], "hydraulic": draw(jack)},
            {"a": names[2], "b": names[0], "rest_length": draw(st.floats(0, 1e6))},
        ],
        "welds": draw(st.lists(st.sampled_from([[names[1], f"{name}.0"] for name in [*names[3:]]]), max_size=4))
        if names[3:]
        else [],
    }


@pytest.mark.slow
@settings(deadline=None)
@given(levels())
def test_any_level_is_loaded_as_it_was_saved(data):
    level = parse_level(encoded(data), "x.json")
    text = level_text(level)
    again = parse_level(text.encode(), "x.json")
    assert again == level
    assert list(again.materials) == list(level.materials)
    assert level_text(again) == text
    assert state_hash(build_world(again)) == state_hash(build_world(level))
