"""docs/how-to-rules.md: its levels are what its files say, in canonical form, and end as the page says."""

import re

import pytest

from sandbox.level.document.canonical import level_text
from sandbox.level.reading.files import read_level
from sandbox.session.commands import Grab, HoldKey, MoveGrab, Release
from sandbox.session.outcome import outcome
from sandbox.session.session import Session
from tests.test_documentation import ROOT

PAGE = (ROOT / "docs" / "how-to-rules.md").read_text(encoding="utf-8")
FOLDER = ROOT / "docs" / "rules"


def test_the_page_has_the_level_of_each_file():
    blocks = re.findall(r"```json\n(.*?)```", PAGE, re.DOTALL)
    assert sorted(blocks) == sorted(path.read_text(encoding="utf-8") for path in FOLDER.glob("*.json"))
    for path in FOLDER.glob("*.json"):
        assert path.read_text(encoding="utf-8") == level_text(read_level(path)), f"sandbox format {path}"


def throw(session):
    """Lift the ball over the rim and let it go."""
    if session.tick == 10:
        session.submit(Grab(0, session.world.particle_slot("ball"), (-2.0, 0.2)), 1)
    elif 10 < session.tick <= 100:
        across, up = min(1.0, max(0, session.tick - 50) / 40), min(1.0, (session.tick - 10) / 40)
        session.submit(MoveGrab(0, (-2.0 + 4.2 * across, 0.2 + 2.0 * up)), 1)
    elif session.tick == 110:
        session.submit(Release(0), 1)


def press(session):
    """Press the key that cuts the thread."""
    if session.tick == 30:
        session.submit(HoldKey(0, True))


def wait(session):
    """Do nothing."""


@pytest.mark.parametrize(
    ("name", "hands", "end"),
    [
        ("basket", throw, (True, "In the basket!", 3)),
        ("basket", wait, None),
        ("bumpers", wait, (False, "The ball is gone.", 0)),
        ("chain", press, (True, "All down", 3)),
        ("chain", wait, None),
    ],
)
def test_a_level_of_the_page_ends_as_its_rules_say(name, hands, end):
    session = Session(read_level(FOLDER / f"{name}.json"))
    while outcome(session.level, session.world) is None and session.tick < 600:
        hands(session)
        session.advance()
    found = outcome(session.level, session.world)
    assert (None if found is None else (found.is_won, found.text, found.stars)) == end
