"""`make whole-world` runs what takes long where kernels or formats changed, and says why."""

import os
import subprocess
from types import SimpleNamespace

import pytest

from tests import quick, whole_world

KERNEL, PAGE = "sandbox/physics/integrate.py", "docs/physics.md"


@pytest.fixture
def clone(tmp_path, monkeypatch):
    """A repository on main, of a commit: what runs git there, and what changes files and commits them."""
    monkeypatch.setattr(quick, "ROOT", tmp_path)
    monkeypatch.delenv("SINCE", raising=False)

    def git(*arguments, time=2 * whole_world.LAST):
        identity = ["-c", "user.name=a", "-c", "user.email=a@b", "-c", "init.defaultBranch=main"]
        environment = {**os.environ, "GIT_COMMITTER_DATE": f"{1_600_000_000 + time} +0000"}
        return subprocess.run(
            ["git", *identity, *arguments], cwd=tmp_path, env=environment, check=True, capture_output=True, text=True
        ).stdout.strip()

    def commit(*paths, **when):
        for path in paths:
            file = tmp_path / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(file.read_text() + "more\n" if file.exists() else "")
        git("add", ".")
        git("commit", "-m", "Change", **when)

    git("init")
    commit(KERNEL, PAGE, time=0)
    return SimpleNamespace(git=git, commit=commit)


def test_on_a_branch_what_differs_from_where_it_left_main_counts(clone):
    clone.git("checkout", "-b", "work")
    clone.commit(PAGE)
    assert whole_world.why()[0] is False
    clone.commit(KERNEL)
    clone.commit(PAGE)
    is_due, sentence = whole_world.why()
    assert is_due and sentence.startswith(f"run: {KERNEL} differs from ") and sentence.endswith("left main")


def test_a_kernel_that_is_not_committed_counts(clone, tmp_path):
    clone.git("checkout", "-b", "work")
    (tmp_path / KERNEL).write_text("other")
    assert whole_world.why()[0]


def test_on_main_the_commits_of_half_a_day_count(clone):
    clone.commit(KERNEL, time=10)
    clone.commit(PAGE, time=9 + whole_world.LAST)
    assert whole_world.why()[0]
    clone.commit(PAGE, time=11 + whole_world.LAST)
    is_due, sentence = whole_world.why()
    assert not is_due and sentence.endswith("the last commit of half a day before")


def test_since_names_the_commit_and_one_that_is_not_there_is_passed_over(clone, monkeypatch):
    clone.commit(KERNEL)
    before = clone.git("rev-parse", "HEAD")
    clone.commit(PAGE)
    monkeypatch.setenv("SINCE", before)
    assert whole_world.why() == (False, f"left out: no kernel and no format differs from {before}, which SINCE names")
    monkeypatch.setenv("SINCE", "0" * 40)
    assert whole_world.why()[0]


def test_without_a_commit_before_all_are_run(clone, tmp_path, monkeypatch):
    said = True, "run: there is no commit before this one to compare with"
    assert whole_world.why() == said
    monkeypatch.setattr(quick, "ROOT", tmp_path / "docs")
    (tmp_path / ".git").rename(tmp_path / "no git")
    assert whole_world.why() == said


def test_a_file_of_whole_world_tests_counts_and_another_one_does_not():
    assert whole_world.is_watched("tests/physics/test_direct.py")
    assert whole_world.is_watched("tests/physics/test_large.py")
    assert not whole_world.is_watched("tests/physics/test_settings.py")


def test_each_place_that_is_watched_exists():
    assert [place for place in whole_world.WATCHED if not (whole_world.ROOT / place).exists()] == []
