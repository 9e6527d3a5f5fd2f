"""`make quick` runs the tests of what was changed."""

import subprocess
from pathlib import Path

import pytest

from tests import quick

ROOT = Path(__file__).resolve().parents[1]


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ("sandbox/editor/edits/moving.py", "tests/editor"),
        ("sandbox/level/kinds/rope.py", "tests/level"),
        ("sandbox/session/session.py", "tests/session"),
        ("sandbox/tools/drag.py", "tests/tools"),
        ("sandbox/cli/run.py", "tests/test_cli.py"),
        ("sandbox/app/panel/panel.py", "tests/app/test_panel.py"),
        ("sandbox/app/gallery/card.py", "tests/app/test_gallery.py"),
        ("sandbox/physics/solvers/direct/solve.py", "tests/physics/test_direct.py"),
        ("sandbox/physics/snapshot.py", "tests/physics/test_snapshot.py"),
        ("tests/support/zoo.py", "tests/editor/test_edits.py"),
        ("tests/level/test_migrate.py", "tests/level/test_migrate.py"),
        ("tests/page/modules/toys.mjs", "tests/page/test_modules.py"),
        ("sandbox/page/web/world.js", "tests/page"),
        ("docs/physics.md", "tests/test_documentation.py"),
        ("levels/rope.json", "tests/level/test_shipped_levels.py"),
    ],
)
def test_a_changed_file_leads_to_its_tests(changed, expected):
    assert (ROOT / changed).exists()
    assert expected in quick.chosen([changed])


def test_a_change_of_one_file_runs_a_small_part_of_the_tests():
    everything = {str(path.relative_to(ROOT)) for path in quick.test_files("")}
    for changed in ("sandbox/app/panel/panel.py", "sandbox/physics/joints/hands.py"):
        assert len(quick.chosen([changed])) < len(everything) / 4


def test_every_room_of_the_package_leads_to_tests():
    for path in sorted((ROOT / "sandbox").iterdir()):
        if path.name.startswith(("__pycache__", "_shipped")) or (path.is_dir() and path.name in quick.LARGE):
            continue
        changed = path / "some.py" if path.is_dir() else path
        if path.suffix in ("", ".py"):
            assert quick.tests_of(changed.relative_to(ROOT).as_posix()), path.name


def test_every_test_that_is_named_for_a_file_exists():
    named = [*quick.ALWAYS, *(path for paths in [*quick.ELSEWHERE.values(), *quick.BY_ROOM.values()] for path in paths)]
    assert [path for path in named if not (ROOT / path).exists()] == []


def test_a_file_that_is_gone_or_new_counts_as_changed(tmp_path, monkeypatch):
    def git(*arguments):
        identity = ["-c", "user.name=a", "-c", "user.email=a@b", "-c", "init.defaultBranch=main"]
        subprocess.run(["git", *identity, *arguments], cwd=tmp_path, check=True, capture_output=True)

    git("init")
    for name in ("kept.py", "gone.py", "committed.py"):
        (tmp_path / name).write_text(name)
    git("add", ".")
    git("commit", "-m", "Begin")
    git("checkout", "-b", "work")
    (tmp_path / "committed.py").write_text("other")
    git("commit", "-am", "Change")
    (tmp_path / "gone.py").unlink()
    (tmp_path / "new.py").write_text("new")
    monkeypatch.setattr(quick, "ROOT", tmp_path)
    assert quick.changed_files() == ["committed.py", "gone.py", "new.py"]
