"""Every line of the shell that README, docs and examples show is run as it is written, by a person who comes new."""

import json
import os
import re
import shutil

import pytest

from sandbox.cli import main
from tests.support.failing import put_failing
from tests.support.person import HAS_A_SCREEN, VirtualScreen, needs_a_screen
from tests.support.shell_lines import ROOT, Reader, ShellLine, lines_of, pages

# Lines that are not run here, and why.
NOT_RUN = {
    r"make\b.*": "installs from the network, or runs all tests; continuous integration runs play, test and lint",
    r"python3 -m venv .*|.*pip install .*|uv .*": "installs from the network",
    r"(\.venv/bin/)?python -m (pytest|tests)\b.*|pytest\b.*": "runs these tests",
}
MOST_NOT_RUN = 3
# Lines of many runs, of a site of all levels, and of kernels that Python interprets.
LONG = re.compile(r"sandbox sweep .*|.* levels/\*\.json .*|sandbox site (--document \S+ )?-o site|SANDBOX_KERNELS=.*")
# Files that a line writes.
WRITTEN = re.compile(r"(?:-o|--record|>) (\S+)|^(?:cp|python) .*?(\S+)$")
LINES = {page: list(lines_of(page)) for page in pages()}
ROPE = ROOT / "levels" / "rope.json"

pytestmark = pytest.mark.skipif(os.name == "nt", reason="the lines are of a POSIX shell")


def is_run(line):
    has_program = not line.text.startswith("node ") or shutil.which("node")
    return has_program and not any(re.fullmatch(pattern, line.text) for pattern in NOT_RUN)


def kind_of(window):
    """What a line that opens a window has in common with others: its words, but for which level, file or body."""
    return tuple(word if word.startswith("-") or place < 2 else "" for place, word in enumerate(window.text.split()))


def firsts(key, lines):
    """Lines before which none has the same key."""
    found = {}
    for line in lines:
        found.setdefault(key(line), line)
    return set(found.values())


def with_what_they_need(chosen, usual):
    """Chosen lines in the order of their page, with those that write files which later ones name."""
    found, named = [], set()
    for line in sorted({*chosen, *usual}, key=lambda line: -line.number):
        written = {name for names in WRITTEN.findall(line.text) for name in names if name}
        if line in chosen or written & named:
            found.append(line)
            named |= {word for word in line.text.split() if "." in word}
    return found[::-1]


def batches():
    """A test's worth of lines each: those of a page that print and write, that take long, and that open windows."""
    found, all_lines = [], [line for lines in LINES.values() for line in lines if is_run(line)]
    # Each text once by day, and each kind of window; pages as a whole, and other levels, where formats changed.
    new = firsts(lambda line: line.text, all_lines)
    tried = firsts(kind_of, [line for line in all_lines if line.opens_a_window])
    for page, lines in LINES.items():
        run = [line for line in lines if is_run(line)]
        windows = [line for line in run if line.opens_a_window]
        long = [line for line in run if LONG.fullmatch(line.text)]
        usual = [line for line in run if line not in windows and line not in long]
        by_day = with_what_they_need([line for line in usual if line in new], usual)
        kinds = {
            "": (by_day, ()),
            ", whole": (usual if usual != by_day else [], pytest.mark.whole_world),
            ", long": (long, pytest.mark.whole_world),
            ", windows": (with_what_they_need([line for line in windows if line in tried], usual), needs_a_screen),
            ", more windows": (
                with_what_they_need([line for line in windows if line not in tried], usual),
                (needs_a_screen, pytest.mark.whole_world),
            ),
        }
        name = page.relative_to(ROOT).as_posix()
        found += [pytest.param(batch, id=name + kind, marks=marks) for kind, (batch, marks) in kinds.items() if batch]
    return found


def put_samples(folder):
    """Files that a person has who comes to these pages: levels of their own, commands, two recordings."""
    level = json.loads(ROPE.read_text(encoding="utf-8"))
    check = {"name": "stays up", "metric": "y", "particle": "rope.end", "after": 1.0, "at_least": -50.0}
    good = {**level, "checks": [check]}
    bad = {**good, "checks": [{**check, "at_least": 50.0}]}
    for name, data in {"my_level": good, "new": {**good, "name": "New"}, "good": good, "bad": bad}.items():
        (folder / f"{name}.json").write_text(json.dumps(data))
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    commands = re.findall(r"\{\"tick\".*?\}\}", readme) or [
        '{"tick": 12, "command": {"type": "pin", "particle": "rope.5"}}'
    ]
    (folder / "moves.jsonl").write_text("\n".join(commands) + "\n")
    put_failing(folder)
    for name in ("run", "other"):
        assert main(["run", "rope", "--seconds", "20", "--record", str(folder / f"{name}.replay.gz")]) == 0


@pytest.fixture(scope="module")
def reader(tmp_path_factory):
    """A person who comes new, before a screen where there is one."""
    folder = tmp_path_factory.mktemp("reader")
    (folder / "screen").mkdir()
    screen = VirtualScreen(folder / "screen") if HAS_A_SCREEN else None
    person = Reader(folder, screen)
    put_samples(person.folder)
    yield person
    if screen is not None:
        screen.close()


@pytest.mark.parametrize("lines", batches())
def test_every_line_works_as_it_is_written(reader, lines):
    faults = [fault for line in lines if (fault := reader.fault(line))]
    assert not faults, "\n\n".join(faults)


def test_what_is_not_run_is_named_with_its_reason_and_is_little():
    left_out = {
        pattern for lines in LINES.values() for line in lines for pattern in NOT_RUN if re.fullmatch(pattern, line.text)
    }
    assert left_out == set(NOT_RUN) and len(NOT_RUN) <= MOST_NOT_RUN


def test_the_readme_begins_with_make_play_and_lets_the_shell_find_the_program_before_it_is_called():
    lines = [line.text for line in lines_of(ROOT / "README.md")]
    assert lines[0] == "make play"
    assert lines.index(". .venv/bin/activate") < min(lines.index(line) for line in lines if line.startswith("sandbox"))


def test_a_line_that_breaks_is_told_with_its_place_and_what_it_said(reader):
    told = reader.fault(ShellLine("docs/made_up.md", 7, "sandbox run no_such_level"))
    assert told.startswith("docs/made_up.md:7: sandbox run no_such_level\nexit code 2")
    assert "there is no such file" in told


@needs_a_screen
def test_a_window_that_does_not_open_is_told_with_what_it_said(reader):
    assert "there is no such file" in reader.fault(ShellLine("docs/made_up.md", 7, "sandbox play no_such_level"))


def test_lines_are_found_in_pages_and_in_comments_without_their_own(tmp_path, monkeypatch):
    monkeypatch.setattr("tests.support.shell_lines.ROOT", tmp_path)
    page = tmp_path / "page.md"
    page.write_text(
        "Text\n\n```sh\nsandbox   # all\n\nsandbox run rope \\\n  --json\n```\n// ```sh\n// node a.js\n// ```\n"
    )
    assert list(lines_of(page)) == [
        ShellLine("page.md", 4, "sandbox"),
        ShellLine("page.md", 6, "sandbox run rope   --json"),
        ShellLine("page.md", 10, "node a.js"),
    ]


def test_a_window_opens_a_file_that_an_earlier_line_of_its_page_writes_whoever_runs_that():
    made = ShellLine("page.md", 1, "python make.py gap.json")
    other, window = ShellLine("page.md", 2, "sandbox run rope"), ShellLine("page.md", 3, "sandbox play gap.json")
    assert with_what_they_need([window], [made, other]) == [made, window]
