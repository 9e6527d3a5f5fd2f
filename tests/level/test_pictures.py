"""Pictures that bodies wear: files beside a level, read within limits and written where they are not there."""

import json
import zlib

import pytest

from sandbox.level.format.picture import Picture
from sandbox.level.format.quantities import replaced
from sandbox.level.reading.files import LevelError, parse_level, read_level, write_level
from sandbox.level.reading.pictures import lacking, pictures_of
from sandbox.physics.snapshot import state_hash
from sandbox.session.level_edits import with_value
from sandbox.session.replay.format import level_digest
from sandbox.session.session import Session
from tests.support.worn import HEAD, NAME, box, four, level_file


def refused(path):
    with pytest.raises(LevelError) as caught:
        read_level(path)
    (fault,) = caught.value.faults
    return fault


def broken(data):
    return data[:60] + bytes([data[60] ^ 1]) + data[61:]


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"GIF89a", "is no PNG"),
        (four(kind="JPEG"), "is no PNG"),
        (b"", "is no PNG"),
        (four()[:-20], "is a damaged PNG"),
        (broken(four()), "is a damaged PNG"),
        (four((2049, 1)), "has 2,049 x 1 pixels; a side may have 1 to 2,048"),
        (four() + b" " * 1024 * 1024, "is larger than 1 MiB; make it smaller"),
    ],
)
def test_a_file_that_cannot_be_worn_is_refused_in_one_line(tmp_path, data, said):
    assert refused(level_file(tmp_path, picture=data)) == (
        f'{tmp_path}/worn.json: bodies.0.look.picture: "{NAME}": {said}'
    )


def test_a_picture_that_is_not_there_or_no_file_is_refused_in_one_line(tmp_path):
    path = level_file(tmp_path)
    (tmp_path / NAME).unlink()
    assert refused(path).endswith(f'bodies.0.look.picture: "{NAME}": there is no such file')
    (tmp_path / NAME).mkdir()
    assert refused(path).endswith(f'"{NAME}": is no file')


@pytest.mark.parametrize("name", ["../cat.png", "a/cat.png", "/cat.png", "a\\cat.png", "C:cat.png", "..png", "cat.gif"])
def test_a_name_that_leaves_the_folder_is_refused_in_one_line(tmp_path, name):
    assert "name a PNG that lies beside the level's file" in refused(level_file(tmp_path, box(look={"picture": name})))


def test_a_level_that_is_read_without_its_folder_lacks_the_picture_and_says_so(tmp_path):
    level = parse_level(json.dumps(HEAD | {"bodies": [box()]}).encode(), "text")
    assert pictures_of(level) == {} and lacking(level) == f'"{NAME}": not here; what wears it has its usual skin'
    with pytest.raises(LevelError, match="choose it again, or take it out"):
        write_level(level, tmp_path / "a.json")


def test_a_picture_goes_where_the_level_goes(tmp_path):
    level = with_value(read_level(level_file(tmp_path)), "name", "another")
    (other := tmp_path / "other").mkdir()
    write_level(level, other / "b.json")
    assert (other / NAME).read_bytes() == four() and lacking(read_level(other / "b.json")) is None


def test_what_lies_there_stays_and_another_picture_gets_another_name(tmp_path):
    path = level_file(tmp_path)
    level = read_level(path)
    (tmp_path / NAME).write_bytes(four((8, 8)))
    # It was changed since it was read: the file counts.
    write_level(level, path)
    assert [each.name for each in sorted(tmp_path.glob("*.png"))] == [NAME]
    worn = Picture(NAME, four((32, 32)))
    other = replaced(level, bodies=(replaced(level.bodies[0], look=replaced(level.bodies[0].look, picture=worn)),))
    for _ in range(2):
        write_level(other, path)
    assert (tmp_path / NAME).read_bytes() == four((8, 8)) and (tmp_path / "four-2.png").read_bytes() == worn.data
    assert read_level(path).bodies[0].look.picture == "four-2.png" and len(list(tmp_path.glob("*.png"))) == 2


def test_what_is_in_a_picture_changes_neither_the_level_nor_its_run(tmp_path):
    levels = [read_level(level_file(tmp_path, picture=data)) for data in (four(), four((8, 8)))]
    levels.append(read_level(level_file(tmp_path, box(look={}))))
    digests = [level_digest(json.loads(level.model_dump_json())) for level in levels]
    assert digests[0] == digests[1] != digests[2]
    sessions = [Session(level) for level in levels]
    for session in sessions:
        session.advance()
    assert len({state_hash(session.world) for session in sessions}) == 1


def test_a_checksum_alone_makes_no_picture(tmp_path):
    # A header that promises more pixels than may be unpacked is refused before any is.
    data = bytearray(four())
    data[16:24] = (2**31 - 1).to_bytes(4) * 2
    data[29:33] = zlib.crc32(data[12:29]).to_bytes(4)
    assert "pixels; a side may have" in refused(level_file(tmp_path, picture=bytes(data)))
