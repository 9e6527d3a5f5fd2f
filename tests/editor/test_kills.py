"""Killed at a random moment, with no chance to do anything: no level is lost. More often in the nightly mode."""

import os
import random
import time

import pytest

from sandbox.editor.storage.autosave import orphans
from sandbox.level.document.canonical import level_text
from sandbox.level.reading.files import read_level
from tests.support.storage_children import NIGHTLY, Child, edit_forever, named, save_forever, write_forever

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="nothing like kill -9 here")

SAVES = 200 if NIGHTLY else 20
EDITS = 50 if NIGHTLY else 8
# Promised limit of what is lost [s].
LOST = 10.0


def texts(count):
    """Two levels of about so many particles, as files."""
    return [level_text(named(name, count + len(name))).encode() for name in ("first", "second")]


def killed(work, moments, *arguments):
    """Let a child write forever, for a moment."""
    child = Child(work, *arguments)
    assert child.hear() == "saved"
    child.kill(after=moments.uniform(0.0, 0.03))


def names(folder):
    return {name for name in os.listdir(folder) if not name.endswith(".tmp")}


@pytest.mark.parametrize("count", [3, 600])
def test_a_level_whose_saving_is_killed_is_the_old_or_the_new_one(tmp_path, count):
    moments = random.Random(count)
    path = tmp_path / "levels" / "x.json"
    path.parent.mkdir()
    levels = [named("first", count), named("second", count)]
    for _ in range(SAVES // 2):
        killed(save_forever, moments, path, tmp_path / "data", levels)
        assert read_level(path) in levels
        assert names(path.parent) == {"x.json"}


def test_a_large_file_whose_writing_is_killed_is_the_old_or_the_new_one(tmp_path):
    moments = random.Random(3)
    data = texts(30_000)
    for _ in range(SAVES // 2):
        killed(write_forever, moments, tmp_path / "x.json", data, True)
        assert (tmp_path / "x.json").read_bytes() in data
        assert names(tmp_path) == {"x.json"}


def test_a_large_file_whose_writing_in_place_is_killed_is_whole_itself_or_in_its_copy(tmp_path):
    moments = random.Random(5)
    data = texts(30_000)
    torn = 0
    for _ in range(SAVES // 2):
        killed(write_forever, moments, tmp_path / "x.json", data, False)
        is_torn = (tmp_path / "x.json").read_bytes() not in data
        assert not is_torn or (tmp_path / "x.json.bak").read_bytes() in data
        torn += is_torn
    print(f"{torn} of {SAVES // 2} files were torn and had a copy")


@pytest.mark.slow
def test_of_work_that_is_killed_at_most_one_edit_or_ten_seconds_are_lost(tmp_path):
    moments = random.Random(7)
    worst = 0.0
    for number in range(EDITS):
        folder = tmp_path / str(number)
        child = Child(edit_forever, folder, tmp_path / "x.json", moments.choice([0.001, 0.02, 0.2]))
        child.hear()
        child.kill(after=moments.uniform(0.0, 1.5))
        killed = time.monotonic()
        times = dict([(0, killed), *child.heard()])
        newest = max(times)
        found = orphans(folder)
        assert len(found) <= 1
        kept = -1
        for orphan in found:
            assert orphan.fault is None and orphan.edited == tmp_path / "x.json"
            kept = len(orphan.level().particles) - 1
            assert orphan.label == f"edit {kept}"
        lost = killed - times[kept + 1] if kept < newest else 0.0
        worst = max(worst, lost)
        assert kept >= newest - 1 or lost < LOST
    print(f"at most {worst:.2f} s of edits were lost")
    assert worst < 2.0
