"""How large the package is, as CHANGELOG.md says."""

from tests.size import kept_lines, lines_by_room

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
