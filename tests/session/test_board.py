"""Boards: entries are run again, those that win by a level's own rules have ranks, and no forged one enters."""

import base64
import gzip
import json
import random
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest
from markdown_it import MarkdownIt

from sandbox.cli import main
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import Level
from sandbox.level.reading.files import level_data, level_path
from sandbox.level.reading.parse import parse_level
from sandbox.physics.commands.command import PROGRAM
from sandbox.physics.snapshot import state_hash
from sandbox.session.board import Board
from sandbox.session.checking import solution_of
from sandbox.session.commands.records import script_of
from sandbox.session.judging import BoardEntry, BoardLevel, Win
from sandbox.session.judging import judged as judged_entry
from sandbox.session.outcome import outcome
from sandbox.session.replay.format import level_digest, seal
from sandbox.session.replay.link import MARK, fragment_of, run_of, unpack
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from sandbox.session.time_limit import TimeUp, time_limit
from tests.solutions import SOLUTIONS
from tests.support import rules_level
from tests.support.wholes import part_and_whole, some_and_whole

SHORT = ("basket_throw", "catapult_practice", "egg_drop", "bridge_budget", "trampoline_basket")
# What no hand may do in any level of SHORT, by which each is won nevertheless.
FORBIDDEN = (
    {"type": "set_gravity", "gravity": [0.0, -9.8]}, {"type": "push", "position": [0.0, 0.0], "radius": 90.0,
     "impulse": [0.001, 0.0]},
    {"type": "set_air", "drag": 0.001}, {"type": "set_solver", "iterations": 7},
)  # fmt: skip
PART = {"type": "add_particle", "position": [0.0, 9.0], "radius": 0.01}

Link = dict[str, Any]
Forged = str | bytes


def opened(link: str) -> Link:
    text = link.partition(MARK)[2]
    found: Link = json.loads(zlib.decompress(base64.urlsafe_b64decode(text + "=" * (-len(text) % 4)), -15))
    return found


def closed(data: Any) -> str:
    packer = zlib.compressobj(6, zlib.DEFLATED, -15)
    whole = packer.compress(json.dumps(data).encode()) + packer.flush()
    return f"#{MARK}" + base64.urlsafe_b64encode(whole).decode().rstrip("=")


def answering(**changes: Any) -> Level:
    """A level that is won while nobody does anything."""
    return rules_level.answering(**{"name": "Answering", "hands": {"may": []}} | changes)


@pytest.fixture(scope="module")
def honest(tmp_path_factory) -> dict[str, Path]:
    """A recording that wins of each of the shortest puzzles, and of one that is not shipped."""
    found = {name: solution_of(Path(level_path(name))) for name in SHORT}
    own = tmp_path_factory.mktemp("own") / "answering.replay.gz"
    session = Session(answering())
    session.record_to(own)
    rules_level.run(session, 90)
    session.stop_recording()
    return {**found, "answering": own}


def folder_of(path: Path, honest: dict[str, Path]) -> Path:
    """A board's folder with an own level, and entries that win, which stand before all others."""
    path.mkdir()
    (path / "answering.json").write_text(level_text(answering()), encoding="utf-8")
    (path / "0.txt").write_text("\n".join(fragment_of(read_replay(each)) for each in honest.values()), encoding="utf-8")
    return path


def judged(folder: Path) -> Board:
    board = Board(folder)
    for _ in board.judge(1, 60.0):
        pass
    return board


# Forgeries: each makes one of a recording that wins, as a link or as the bytes of a file.


def numbers_in(data: Any) -> list[tuple[Any, Any]]:
    """Where numbers stand in lists and objects inside each other: what holds them, and where in it."""
    items = enumerate(data) if isinstance(data, list) else data.items() if isinstance(data, dict) else ()
    return [
        place for key, value in items for place in ([(data, key)] if type(value) in (int, float) else numbers_in(value))
    ]


def records(link: Link) -> list[Any]:
    return [entry[2] for entry in link["commands"] if len(entry) == 3]


def values(path: Path, chance: random.Random) -> Forged:
    link = opened(fragment_of(read_replay(path)))
    places = numbers_in(records(link))
    if not places:
        return closed(link | {"ticks": -1})
    holder, key = chance.choice(places)
    holder[key] = chance.choice((holder[key] + 1, holder[key] * 0.9 - 1e-6, -holder[key] - 1, 1e300, 0.123))
    return closed(link)


def counts(path: Path, chance: random.Random) -> Forged:
    link = opened(fragment_of(read_replay(path)))
    commands = link["commands"]
    if not commands:
        commands.append([0, 1, PART])
    elif chance.random() < 0.5:
        commands.pop(chance.randrange(len(commands)))
    else:
        commands.insert(chance.randrange(len(commands)), chance.choice(commands))
    return closed(link)


def ticks(path: Path, chance: random.Random) -> Forged:
    link, by = opened(fragment_of(read_replay(path))), chance.choice((-200, -1, 1, 3, 10**6))
    entries = [entry for entry in link["commands"] if len(entry) == 3]
    if entries and chance.random() < 0.5:
        entries[0][0] += by
    else:
        link["ticks"] += by
    return closed(link)


def hashes(path: Path, chance: random.Random) -> Forged:
    link = opened(fragment_of(read_replay(path)))
    return closed(link | {"hash": f"{chance.getrandbits(128):032x}", "at": chance.randrange(link["ticks"])})


def whole_run(level: Level, link: Link, ticks: int) -> str:
    """A link to a run of another level, all of whose bits are right."""
    session = Session(level, script=unpack(link["commands"]))
    try:
        while session.tick < ticks:
            session.advance()
        session.apply_pending()
    except ValueError:
        pass
    run = run_of("forged", level, unpack(link["commands"]), ticks, state_hash(session.world))
    return fragment_of(run)


def other_level(path: Path, chance: random.Random) -> Forged:
    replay = read_replay(path)
    data, link = level_data(replay.level), opened(fragment_of(replay))
    if chance.random() < 0.3:
        return closed(link | {"level": chance.choice(SHORT[:2] if link["level"] != SHORT[0] else SHORT[1:])})
    # It is won at once.
    data["rules"] = [{"id": "at once", "when": {"time": 0.05}, "then": [{"win": "Won!"}]}, *data["rules"]]
    easier = parse_level(json.dumps(data).encode(), "easier")
    return whole_run(easier, link | {"commands": []}, 10)


def other_physics(path: Path, chance: random.Random) -> Forged:
    replay = read_replay(path)
    data, link = level_data(replay.level), opened(fragment_of(replay))
    if chance.random() < 0.4:
        return closed(link | {"physics": link["physics"] + chance.choice((-1, 1, 0.5))})
    data["settings"] = {**data.get("settings", {}), "gravity": [0.0, -9.81 - chance.random() * 1e-3]}
    return whole_run(parse_level(json.dumps(data).encode(), "lighter"), link, replay.ticks)


def lines_of(path: Path, change: Callable[[list[dict[str, Any]]], None]) -> bytes:
    """A recording whose lines were changed, and sealed again."""
    lines = [json.loads(line) for line in gzip.decompress(path.read_bytes()).splitlines()]
    change(lines)
    made, digest = b"", ""
    for line in lines:
        line.pop("chain", None)
        sealed, digest = seal(line, digest)
        made += sealed
    return made


def stars(path: Path, chance: random.Random) -> Forged:
    link = opened(fragment_of(read_replay(path)))
    if chance.random() < 0.3:
        return closed(link | {"stars": 3})
    if chance.random() < 0.3:
        return lines_of(path, lambda lines: lines[-1].update(stars=3))
    return edited(path, chance, "rule_stars", "rule_first", "counter")


def edited(path: Path, chance: random.Random, *names: str) -> bytes:
    """A recording with another array in one of its states."""
    return lines_of(path, lambda lines: edit_state(lines, chance, names))


def edit_state(lines: list[dict[str, Any]], chance: random.Random, names: tuple[str, ...]) -> None:
    state = chance.choice([line["state"] for line in lines if "state" in line])
    name = chance.choice([each for each in state if not names or each in names] or list(state))
    data = bytearray(zlib.decompress(base64.b64decode(state[name])))
    if data:
        data[chance.randrange(len(data))] ^= 1 << chance.randrange(7)
        state[name] = base64.b64encode(zlib.compress(bytes(data))).decode()
    else:
        state.pop(name)


def states(path: Path, chance: random.Random) -> Forged:
    if chance.random() < 0.5:
        return edited(path, chance)

    def change(lines: list[dict[str, Any]]) -> None:
        hashed = [line for line in lines if "arrays" in line or "end" in line]
        chance.choice(hashed)["hash"] = f"{chance.getrandbits(128):032x}"

    return lines_of(path, change)


@contextmanager
def program_without_rules() -> Iterator[None]:
    """A program that somebody changed, so that hands may do everything."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sandbox.session.commands.command.HAND", PROGRAM)
        yield


def forbidden(path: Path, chance: random.Random) -> Forged:
    replay = read_replay(path)
    deeds = [chance.choice(FORBIDDEN)]
    if replay.level.name == "Bridge on a budget" and chance.random() < 0.5:
        deeds = [PART] * 6
    script = (*unpack([[0, 9000 + number, deed] for number, deed in enumerate(deeds)]), *replay.script)
    with program_without_rules():
        session = Session(replay.level, script=script)
        while session.tick < replay.ticks:
            session.advance()
        session.apply_pending()
    return fragment_of(run_of("forged", replay.level, script, session.tick, state_hash(session.world)))


def truncated(path: Path, chance: random.Random) -> Forged:
    link, data = fragment_of(read_replay(path)), path.read_bytes()
    if chance.random() < 0.5:
        return link[: chance.randrange(8, len(link) - 1)]
    return data[: chance.randrange(20, len(data) - 9)]


def too_short(path: Path, chance: random.Random) -> Forged:
    """A run that ends before it is won, with all its bits."""
    replay = read_replay(path)
    session = Session(replay.level, script=replay.script)
    until = chance.randrange(5, 70)
    while session.tick < until:
        session.advance()
    script = [line for line in replay.script if line.tick < until]
    return fragment_of(run_of("forged", replay.level, script, until, state_hash(session.world)))


def doubled(path: Path, chance: random.Random) -> Forged:
    """An honest run once more: by another name, from another file, or with more after it is won."""
    replay = read_replay(path)
    if chance.random() < 0.3:
        return f"Somebody else {fragment_of(replay, chance.randrange(replay.ticks))}"
    if chance.random() < 0.3:
        return path.read_bytes()
    session = Session(replay.level, script=replay.script)
    while session.tick < replay.ticks + chance.randrange(1, 40):
        session.advance()
    return fragment_of(run_of("doubled", replay.level, replay.script, session.tick, state_hash(session.world)))


KINDS = (
    values, counts, ticks, hashes, other_level, other_physics, stars, states, forbidden, truncated, too_short, doubled,
)  # fmt: skip


@pytest.mark.parametrize("count", part_and_whole(3, 84), ids=lambda count: f"{count}_of_each_kind")
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_no_forged_entry_enters(kind, count, honest, tmp_path):
    folder, chance = folder_of(tmp_path / "entries", honest), random.Random(f"{kind.__name__} {count}")
    for number in range(1, count + 1):
        made = kind(honest[chance.choice(list(honest))], chance)
        file = folder / (f"{number}.txt" if isinstance(made, str) else f"{number}.replay.jsonl")
        file.write_bytes(made.encode() if isinstance(made, str) else made)
    board = judged(folder)
    assert {win.stem for win in board.wins} == set(honest)
    assert [Path(win.entry.place).name.partition(":")[0] for win in board.wins] == ["0.txt"] * len(honest)
    assert len(board.faults) == count and not any("\n" in fault for fault in board.faults)
    if kind is doubled:
        assert all("once more" in fault for fault in board.faults), board.faults
    if kind is forbidden:
        assert all("hands may not" in fault or "not enough parts" in fault for fault in board.faults), board.faults


@pytest.mark.parametrize("name", some_and_whole(("catapult_practice", "basket_throw"), SOLUTIONS))
def test_the_solution_of_a_puzzle_enters_as_a_recording_and_the_same_run_as_a_link_is_one_with_it(name, tmp_path):
    solution = solution_of(Path(level_path(name)))
    (tmp_path / "first.replay.gz").write_bytes(solution.read_bytes())
    (tmp_path / "second.txt").write_text(f"Ada #beat=Bob&{fragment_of(read_replay(solution))}\n", encoding="utf-8")
    board = judged(tmp_path)
    (win,) = board.wins
    assert (win.stem, win.entry.name, win.stars) == (name, "first", 3)
    assert board.faults == [f"{tmp_path / 'second.txt'}:1: is the run of {tmp_path / 'first.replay.gz'} once more"]


def scored(second: int, third: int) -> Level:
    """A level with a counter that a key raises, and stars by it."""
    base = level_data(answering())
    base["rules"] = [
        {"id": "key", "when": {"key": "g"}, "then": [{"count": "score"}]},
        {
            "id": "done",
            "when": {"time": 1.0},
            "then": [{"win": "Done", "stars": {"counter": "score", "second": second, "third": third}}],
        },
    ]
    return parse_level(json.dumps(base).encode(), "scored")


def pressed(level: Level, times: int, late: int = 0) -> str:
    """A link to a run in which a key is pressed so many times."""
    session = Session(level)
    while outcome(level, session.world) is None:
        at = session.tick - late
        if 0 <= at < 4 * times and at % 2 == 0:
            session.do("hold_key", key="g", down=at % 4 == 0)
        session.advance()
    script = script_of(session.history.timeline, session.world)
    return fragment_of(run_of("made", level, script, session.tick, state_hash(session.world)))


@pytest.mark.parametrize(
    ("second", "third", "order"), [(2, 9, ["three", "two", "one"]), (9, 2, ["one", "two", "three"])]
)
def test_ranks_go_by_stars_then_by_what_the_level_measures(second, third, order, tmp_path):
    level = scored(second, third)
    (tmp_path / "scored.json").write_text(level_text(level), encoding="utf-8")
    lines = [f"{name} {pressed(level, times)}" for name, times in (("two", 2), ("three", 3), ("one", 1))]
    (tmp_path / "all.txt").write_text("\n".join(lines), encoding="utf-8")
    board = judged(tmp_path)
    assert board.faults == []
    assert [win.entry.name for win in board.ranks("scored")] == order


def test_what_is_no_entry_is_named_and_nothing_is_lost(honest, tmp_path, capsys):
    folder = folder_of(tmp_path / "entries", honest)
    (folder / "notes.md").write_text("Hello", encoding="utf-8")
    (folder / "text.txt").write_bytes(b"\xff\xfe")
    (folder / "plain.txt").write_text("\nhttps://example.org/\n", encoding="utf-8")
    (folder / "long.txt").write_text(f"{'x' * 61} {fragment_of(read_replay(honest['egg_drop']))}", encoding="utf-8")
    (folder / "turned.txt").write_text(f"a\u202eb {fragment_of(read_replay(honest['egg_drop']))}", encoding="utf-8")
    (folder / "egg_drop.json").write_bytes(Path(level_path("egg_drop")).read_bytes())
    (folder / "rope.json").write_bytes(Path(level_path("rope")).read_bytes())
    (folder / "broken.json").write_text("{", encoding="utf-8")
    (folder / "away.replay.gz").symlink_to(honest["egg_drop"])
    assert main(["board", str(folder), "--processes", "1"]) == 1
    out, said = capsys.readouterr()
    assert f"{len(honest)} of {len(honest) + 3} entries win" in out
    told = [line.removeprefix(f"{folder}/") for line in said.splitlines()]
    assert len(told) == 9
    assert {line.partition(":")[0] for line in told} == {
        "notes.md", "text.txt", "plain.txt", "long.txt", "turned.txt", "egg_drop.json", "rope.json", "broken.json",
        "away.replay.gz",
    }  # fmt: skip


def test_any_number_of_processes_says_the_same_and_a_comment_has_names_as_code(honest, tmp_path, capsys):
    folder, said = tmp_path / "entries", []
    folder.mkdir()
    (folder / "answering.json").write_text(level_text(answering()), encoding="utf-8")
    link, name = fragment_of(read_replay(honest["catapult_practice"])), "`@you` [x](http://x.example) <b>*A*</b> | ``"
    lines = [
        f"{name} {link}",
        f"Eve {link}",
        f"Short {link[:60]}",
        f"Ada {fragment_of(read_replay(honest['answering']))}",
    ]
    (folder / "all.txt").write_text("\n".join(lines), encoding="utf-8")
    for number in (1, 2):
        comment = tmp_path / f"{number}.md"
        asked = ["--processes", str(number), "--comment", str(comment), "--address", "https://toys.example/board/"]
        assert main(["board", str(folder), *asked]) == 1
        said.append((*capsys.readouterr(), comment.read_text(encoding="utf-8")))
    assert said[0] == said[1]
    out, faults, comment = said[0]
    assert [line.partition(": ")[0] for line in faults.splitlines()] == [f"{folder / 'all.txt'}:{k}" for k in (2, 3)]
    found = MarkdownIt("gfm-like", {"linkify": False}).parse(comment)
    parts = [part for block in found for part in block.children or ()]
    assert name in [part.content for part in parts if part.type == "code_inline"]
    raced = [part.attrs["href"] for part in parts if part.type == "link_open"]
    place = "https://toys.example/board/levels"
    assert [link.partition("&")[0] for link in raced] == [
        f"{place}/catapult_practice.html#beat={quote(name, safe='')}", f"{place}/answering.html#beat=Ada",
    ]  # fmt: skip
    assert all(f"     {link}\n" in out for link in raced)
    assert all(link.startswith(MARK) for link in (each.partition("&")[2] for each in raced))


def test_an_entry_that_takes_too_long_is_named_and_the_others_are_run(honest, tmp_path):
    levels = {level_digest(level_data(answering())): BoardLevel(tmp_path / "answering.json", "Answering")}
    (tmp_path / "answering.json").write_text(level_text(answering()), encoding="utf-8")
    entry = BoardEntry(str(honest["answering"]), "Ada", None)
    assert judged_entry(entry, levels, 0.01) == f"{entry.place}: took longer than 0.01 s of the processor"
    assert isinstance(judged_entry(entry, levels, 60.0), Win)


def test_what_never_ends_is_broken_off_where_it_is():
    reached = False
    with pytest.raises(TimeUp), time_limit(0.05):
        while True:
            try:
                reached = True
            except Exception:
                pytest.fail("no fault of its own")
    assert reached


def test_what_was_undone_is_no_deed(tmp_path):
    level = scored(2, 9)
    (tmp_path / "scored.json").write_text(level_text(level), encoding="utf-8")
    (tmp_path / "a.txt").write_text(pressed(level, 1), encoding="utf-8")
    session = Session(level)
    session.record_to(tmp_path / "b.replay.gz")
    while session.tick < 80:
        if session.tick in (0, 2):
            session.do("hold_key", key="g", down=session.tick == 0)
        if session.tick == 20:
            session.do("set_drive", part=session.world.actuators.names[0], value=1.0)
        if session.tick == 70:
            session.undo()
        session.advance()
    session.stop_recording()
    board = judged(tmp_path)
    assert [win.entry.name for win in board.wins] == ["a"]
    assert board.faults == [f"{tmp_path / 'b.replay.gz'}: is the run of {tmp_path / 'a.txt'}:1 once more"]


def test_a_board_of_no_folder_is_refused(tmp_path, capsys):
    assert main(["board", str(tmp_path / "none")]) == 2
    assert capsys.readouterr().err.endswith("none: is no folder\n")
    assert main(["board", str(tmp_path)]) == 0
