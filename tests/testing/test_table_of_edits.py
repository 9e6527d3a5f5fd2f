"""The table of edits: each kind of edit of each part of a level, and all that compares its recording with it.

Every door tells what was edited, none ends in a traceback, and what is accepted is green.
"""

import json
import re
from functools import cache

import pytest

from sandbox.cli import main
from sandbox.level.document.schema import definitions
from sandbox.level.reading.files import keep_file, write_level
from sandbox.level.reading.parse import parse_level
from sandbox.session.commands import CommandError
from sandbox.session.compare.comparison import compare
from sandbox.session.level_edits import SILENT, level_edits
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import ReplayError
from sandbox.session.session import Session
from tests.support.level_edits import LevelEdit, edits_of
from tests.support.rules_level import answering
from tests.support.wholes import some_and_whole
from tests.support.zoo import zoo
from tests.testing.conftest import LOADED

pytest_plugins = ["pytester"]

FILE = "edited.json"
TICKS = 12
# Parts of every run of tests, each of another kind; the others are of whole-world tests.
USUAL = {"CounterDef", "ContactsDef", "WaterDef"}
PARTS = sorted({*definitions()["$defs"], "Level"})


@cache
def levels():
    """Levels in which each part of the format is."""
    found = [_pool(), answering(), zoo()]
    for level in found:
        keep_file(level, FILE)
    return found


def _pool():
    """Water, colours, contacts and a key that is held."""
    data = {
        "format": "spring-sandbox/level",
        "version": 3,
        "name": "Pool",
        "contacts": {"friction": 0.3},
        "look": {"faces": False},
        "materials": {"soft": {"stiffness": 0.1, "look": {"colour": "#336699"}}},
        "zones": [{"id": "pool", "box": [-5, -3, 5, 0], "water": {"flow": [0.5, 0]}, "look": {"colour": "#3366cc"}}],
        "bodies": [
            {"type": "wheel", "id": "wheel", "position": [0, 0.5], "radius": 0.5, "segments": 8, "thickness": 0.1,
             "motor": {"speed": 3, "torque": 5, "key": "d"}},
            {"type": "rope", "id": "rope", "start": [-4, -1], "end": [-2, -1], "segments": 4, "material": "soft"},
        ],
        "particles": [{"id": "ball", "position": [2, -0.5], "radius": 0.2, "look": {"colour": "#aa3333"}}],
        "checks": [{"name": "it drives", "metric": "x", "particle": "ball", "at_least": 0,
                    "hold": [{"key": "d", "during": [0, 1]}]}],
    }  # fmt: skip
    return parse_level(json.dumps(data).encode(), "pool")


def recorded(level, path):
    """A recording in which two things are taken and something is cut."""
    session = Session(level)
    session.record_to(path, 6)
    while session.tick < TICKS:
        if session.tick == 3:
            session.do({"type": "grab", "grab": 0, "particle": "rope.2", "target": [1, 4]})
            session.do({"type": "cut_springs", "springs": ["rope:1"]})
        if session.tick == 9:
            session.do({"type": "release", "grab": 0})
        session.advance()
    session.stop_recording()


@pytest.fixture
def table(request, pytester):
    """The edits of a part, each in a folder with the level as edited and a recording of it as it was."""
    cases = []
    for number, (level, edit) in enumerate(edits_of(request.param, levels())):
        folder = pytester.path / f"{number:03}"
        (folder / "levels").mkdir(parents=True)
        write_level(edit.level, folder / "levels" / FILE)
        write_level(level, folder / "before.json")
        recorded(level, folder / "play.replay.gz")
        cases.append((edit, folder))
    return cases


def comes_out_the_same(folder, edit):
    """Whether the recording runs on the edited level as it was; None: its commands do not fit that."""
    replay = read_replay(folder / "play.replay.gz")
    try:
        return compare(replay, level=edit.level) is None
    except (ReplayError, CommandError):
        return None


def named(edit: LevelEdit, before, text: str) -> bool:
    """Whether a text names the edit: the field, or the nearest part around it of which the file says something."""
    places = [str(each).partition(": ")[0] for each in level_edits(before, edit.level)]
    assert any(place.split(".")[0] == str(edit.path[0]) for place in places), edit
    return any(f"{place}: " in text for place in places) or any(
        words in text for words in (f", which {FILE} lacks", " is called ")
    )


@pytest.mark.parametrize("table", some_and_whole(USUAL, PARTS), indirect=True)
def test_every_door_tells_every_edit_and_what_is_accepted_is_green(table, pytester, capsys):
    assert table, "no level of the table has this part"
    outputs = pytest_outputs(pytester)
    for edit, folder in table:
        is_same = comes_out_the_same(folder, edit)
        before = read_replay(folder / "play.replay.gz").level
        is_silent = edit.path[0] in SILENT
        assert not is_silent or is_same, edit
        told = outputs.get(f"{folder.name}/play.replay.gz")
        replay, level = str(folder / "play.replay.gz"), str(folder / "levels" / FILE)
        doors = {
            "replay": ["replay", replay, "--against", level],
            "to the end": ["replay", replay, "--against", str(folder / "levels"), "--to-end"],
            "diff": ["diff", replay, level],
            "bisect": ["bisect", str(folder / "before.json"), level, "--replay", replay],
            "shrink": ["shrink", replay, "--against", level, "--processes", "1", "-o", str(folder / "least.replay.gz")],
        }
        said = {"pytest": told or ""}
        codes = {}
        for door, arguments in doors.items():
            codes[door] = main(arguments)
            said[door] = "".join(capsys.readouterr())
        for door, text in said.items():
            assert not re.search(r"Traceback|\w+Error\b|sealed again", text), (str(edit), door, text)
        if is_same:
            assert told is None and codes["replay"] == codes["to the end"] == 0, (str(edit), said)
            continue
        assert told is not None, str(edit)
        if is_same is None:
            assert codes["replay"] == codes["to the end"] == 2, (str(edit), said)
            assert "sandbox export" in told or " is called " in told, (str(edit), told)
            continue
        assert codes["replay"] == codes["to the end"] == 1 and codes["diff"] == 1, (str(edit), codes, said)
        for door in ("pytest", "replay", "to the end", "diff"):
            assert named(edit, before, said[door]), (str(edit), door, said[door])
        assert codes["bisect"] == 0, (str(edit), said["bisect"])
        assert "to accept: pytest --replay-update" in told or "sandbox export" in told, (str(edit), told)
    pytest_outputs(pytester, "--replay-update")
    left = pytest_outputs(pytester)
    for edit, folder in table:
        recording = f"{folder.name}/play.replay.gz"
        # Where a command cannot be carried out any more, the way out is to edit the commands.
        assert recording not in left or "sandbox export" in outputs[recording], (str(edit), left)


def pytest_outputs(pytester, *options):
    """What pytest says of each recording that fails."""
    found = pytester.inline_run("-q", "--replay-pictures=none", "-mreplay", *LOADED, *options)
    return {each.nodeid.partition("::")[0]: each.longreprtext for each in found.listoutcomes()[2]}
