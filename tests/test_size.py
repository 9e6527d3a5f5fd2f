"""How large the package is, as CHANGELOG.md says, and what a property touches, as docs/how-to-add.md says."""

import re

from tests.size import ROOT, kept_lines, lines_by_room, named_in

# A room may differ by so much from what is said, until somebody says it anew.
SHARE, LINES = 0.02, 60


def test_the_changelog_says_how_large_each_room_is():
    said, counted = kept_lines(), lines_by_room()
    print(counted)
    assert said.keys() == counted.keys()
    wrong = {
        name: (said[name], count)
        for name, count in counted.items()
        if abs(said[name] - count) > max(LINES, SHARE * count)
    }
    assert wrong == {}, "python -m tests.size --keep says it anew"


def test_the_recipe_for_what_people_see_names_every_file_that_names_a_belt():
    section = (ROOT / "docs/how-to-add.md").read_text(encoding="utf-8").partition("## A property that people see")[2]
    named = re.findall(r"`([\w/]+\.(?:py|js))`", section)
    assert sorted(named) == named_in("belt")
