"""Links: runs in the fragment of an address come back to the very bits; what is broken is one clear line."""

import base64
import json
import random
import zlib

import pytest

from sandbox.level.reading.files import load_level
from sandbox.session.commands.records import ScriptLine
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.link import LONGEST, MARK, PackingError, fragment_of, is_link, pack, replay_of, unpack
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import ReplayError
from tests.determinism.golden import golden_names, golden_path
from tests.determinism.seeds.player import recording

SITE = "https://example.org/toys/#"
MUTATIONS = 300


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A recording with random commands of every kind, of a level that is not shipped."""
    return recording(4, 40, tmp_path_factory.mktemp("runs"))


@pytest.fixture(scope="module")
def fragment(run):
    """The fragment of a link to it."""
    return fragment_of(run)


def opened(text: str) -> dict:
    """What a fragment holds."""
    packed = text.removeprefix(MARK)
    return json.loads(zlib.decompress(base64.urlsafe_b64decode(packed + "=" * (-len(packed) % 4)), -zlib.MAX_WBITS))


def closed(values) -> str:
    """The fragment that holds this."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    data = packer.compress(json.dumps(values).encode()) + packer.flush()
    return MARK + base64.urlsafe_b64encode(data).decode().rstrip("=")


def plain(script):
    """Commands as far as they count: gestures by the order in which they begin."""
    numbers: dict[int, int] = {}
    return [(line.tick, numbers.setdefault(line.gesture, len(numbers)), line.record) for line in script]


def test_a_run_comes_back_from_a_link_to_the_very_bits(run, fragment):
    back = replay_of(SITE + fragment)
    assert back.level == run.level and plain(back.script) == plain(run.script)
    assert verify(back) is None


@pytest.mark.parametrize("name", golden_names()[::9])
def test_goldens_are_held_whole(name):
    replay = read_replay(golden_path(name))
    try:
        fragment = fragment_of(replay)
    except ReplayError as error:
        assert "send the file" in str(error)
        return
    back = replay_of(fragment)
    assert plain(back.script) == plain(replay.script) and back.level == replay.level
    assert (back.ticks, back.end_hash) == (replay.ticks, replay.end_hash)


def test_a_shipped_level_goes_by_its_name_until_it_is_another(tmp_path):
    from sandbox.session.session import Session

    session = Session(load_level("rope"))
    session.record_to(tmp_path / "rope.replay.gz")
    for _ in range(30):
        session.advance()
    session.stop_recording()
    fragment = fragment_of(read_replay(tmp_path / "rope.replay.gz"))
    values = opened(fragment)
    assert values["level"] == "rope" and len(fragment) < 250
    with pytest.raises(ReplayError, match="is to another edition of the level 'Rope'"):
        replay_of(closed({**values, "digest": "00000000"}))
    with pytest.raises(ReplayError, match="a level that is not here: 'rape'"):
        replay_of(closed({**values, "level": "rape"}))


def test_a_hand_that_moves_in_every_tick_for_a_minute_fits_into_a_link(tmp_path):
    chance, script = random.Random(1), [ScriptLine(1, 7, {"type": "grab", "grab": 2, "particle": "rope.end",
                                                          "target": [1.0, 2.0]}, 1)]  # fmt: skip
    x, y = 1000, 2000
    for tick in range(2, 3602):
        x, y = x + chance.randint(-40, 40), y + chance.randint(-40, 40)
        script.append(ScriptLine(tick, 7, {"type": "move_grab", "grab": 2, "target": [x / 1000, y / 1000]}, tick))
    assert plain(unpack(json.loads(json.dumps(pack(script))))) == plain(script)
    data = json.dumps(pack(script), separators=(",", ":")).encode()
    assert len(base64.b64encode(zlib.compress(data, 9))) < 16_000


@pytest.mark.parametrize("target", [[0.0, -0.0], [1 / 3, 2.0], [1e300, 0.0], [5, 1.0]])
def test_places_that_are_no_whole_millimetres_keep_their_bits(target):
    script = [ScriptLine(0, 1, {"type": "grab", "grab": 0, "particle": "a", "target": [0.0, 0.0]}, 1)]
    script += [ScriptLine(tick, 1, {"type": "move_grab", "grab": 0, "target": target}, 1) for tick in (1, 2)]
    back = unpack(json.loads(json.dumps(pack(script))))
    assert [repr([float(each) for each in line.record["target"]]) for line in back[1:]] == [
        repr([float(each) for each in target])
    ] * 2


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"v": 1}, "is of version 1; this program reads 2"),
        ({"physics": 9}, "was made with physics version 9"),
        ({"ticks": -1}, "ticks: must be greater than or equal to 0"),
        ({"hash": "x"}, "hash"),
        ({"more": 1}, "more"),
        ({"commands": [[1, 1]]}, "neither a command nor moves"),
        ({"commands": [[0, 1, {"type": "pin"}], [50, 2, {"type": "undo"}]]}, "goes on after its end"),
        ({"commands": [[[1], [3], [0], [0]]]}, "a hand moves that holds nothing"),
        ({"level": {"format": "spring-sandbox/level"}}, "the level of the link"),
    ],
)
def test_what_a_link_cannot_mean_is_told(fragment, change, said):
    with pytest.raises(ReplayError) as refused:
        replay_of(closed({**opened(fragment), **change}))
    assert said in str(refused.value)


def test_a_bomb_is_not_unpacked_and_a_long_text_not_read():
    packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    bomb = packer.compress(b"[" * 2**24) + packer.flush()
    with pytest.raises(ReplayError, match="unpacks to more than 4 MiB"):
        replay_of(MARK + base64.urlsafe_b64encode(bomb).decode().rstrip("="))
    with pytest.raises(ReplayError, match="is longer than"):
        replay_of(MARK + "A" * (LONGEST + 1))


def test_a_link_is_told_from_a_file():
    assert is_link(f"{SITE}{MARK}abc") and is_link(f"{MARK}abc") and is_link(f" #{MARK}abc\n")
    assert not is_link("my scene=abc.json") and not is_link("levels/rope.json") and not is_link("rope")


def mutated(text: str, chance: random.Random) -> str:
    """A text with some letters changed, taken out or doubled."""
    for _ in range(chance.choice([1, 1, 2, 8])):
        place = chance.randrange(len(text) + 1)
        begin, rest = text[:place], text[place:]
        text = begin + chance.choice([chr(chance.randrange(33, 127)) + rest[1:], rest[1:], rest[:1] + rest, rest[50:]])
    return text


def mutate(seed: int, fragment: str) -> str:
    """A fragment that is broken in its letters, or a sound one that holds broken JSON."""
    chance = random.Random(seed)
    if chance.random() < 0.3:
        return MARK + mutated(fragment.removeprefix(MARK), chance)
    text = mutated(json.dumps(opened(fragment)), chance)
    packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    data = packer.compress(text.encode()) + packer.flush()
    return MARK + base64.urlsafe_b64encode(data).decode().rstrip("=")


@pytest.mark.parametrize("seed", range(4))
def test_whatever_is_broken_is_refused_in_lines_or_is_another_run(seed, fragment):
    for number in range(MUTATIONS // 4):
        try:
            replay_of(mutate(1000 * seed + number, fragment))
        except ReplayError as error:
            assert all(len(line) < 500 and line.isprintable() for line in error.faults)


@pytest.mark.parametrize("packed", [{}, [3], [[1, 2, 3]], [[[1], [2], [3]]], [[1, True, {}]], [[-1, 1, {}]]])
def test_packed_commands_that_are_none_are_refused(packed):
    with pytest.raises(PackingError):
        unpack(packed)


def test_the_shell_makes_a_link_and_takes_it_where_it_takes_a_recording(tmp_path, capsys):
    from sandbox.cli import main

    recording(4, 40, tmp_path)
    assert main(["link", str(tmp_path / "4.replay.gz"), "--site", SITE]) == 0
    link = capsys.readouterr().out.strip()
    assert link.startswith(SITE + MARK)
    assert main(["replay", link]) == 0
    assert capsys.readouterr().out.endswith(": equal at its end, 40 ticks\n")
    assert main(["replay", link[:-40]]) == 2
    assert capsys.readouterr().err.strip() == "the link is cut off: copy it again, whole"


def test_letters_behind_the_end_of_a_run_are_refused(fragment):
    for more in ("AAAA", " and more", "\n"):
        text = fragment + more
        if more.strip():
            with pytest.raises(ReplayError, match="copy it again"):
                replay_of(text)
        else:
            assert replay_of(text).ticks == replay_of(fragment).ticks


@pytest.mark.parametrize("command", ["info", "replay", "show", "diff"])
def test_a_link_is_told_by_its_beginning_alone(command, tmp_path, capsys):
    from sandbox.cli import main

    link = SITE + fragment_of(recording(4, 40, tmp_path))
    for said, expected in ((link, 0), (link + "A" * 300, 2), (link.replace(MARK, f"{MARK}% "), 2)):
        assert main([command, said, *[said] * (command == "diff")]) == expected
        told = "".join(capsys.readouterr())
        assert told.strip() and link[-40:] not in told and "Traceback" not in told
