"""`make libraries` and its check: what they say of libraries that are not those of the sources."""

import importlib.util
import json
import subprocess
import sys

import pytest

from sandbox.physics.jit.library import read_manifest
from sandbox.physics.jit.making import libraries
from sandbox.physics.jit.making.compiling import Gathered, all_entries, gathered
from tests.support.wants import needs


@pytest.fixture
def makers(monkeypatch):
    """The makers of the libraries that are there, whoever makes them here."""
    made_by = read_manifest()["makers"]
    monkeypatch.setattr(libraries, "makers_here", lambda: made_by)
    return made_by


def test_a_manifest_is_written_with_a_line_for_each_file_source_and_entry():
    manifest = read_manifest()
    text = libraries._text(manifest)
    assert json.loads(text) == manifest
    for part in ("files", "sources", "entries"):
        for name in manifest[part]:
            assert sum(line.startswith(f'  "{name}": ') for line in text.splitlines()) == 1, name


def test_a_check_names_files_whose_kernels_were_edited_and_makes_nothing(monkeypatch, makers):
    monkeypatch.setattr(libraries, "edited", lambda known: ["physics/integrate.py"])
    monkeypatch.setattr(libraries, "_made", lambda found, platforms: pytest.fail("nothing is to be made"))
    (line,) = libraries._differences(True)
    assert line == "physics/integrate.py: its kernels are not those that the libraries were made of"
    assert not libraries._are_current()


def test_bytes_are_not_compared_where_the_makers_are_others(monkeypatch, capsys):
    monkeypatch.setattr(libraries, "makers_here", lambda: {"ziglang": "0.0"})
    monkeypatch.setattr(libraries, "_made", lambda found, platforms: pytest.fail("nothing is to be made"))
    assert libraries._differences(True) == []
    assert capsys.readouterr().out.startswith("bytes are not compared: made by ")


def test_a_check_names_files_whose_bytes_are_others_and_entries_that_are(monkeypatch, makers):
    entries = read_manifest()["entries"]
    own = {"kernels.wasm": (libraries.FOLDER / "kernels.wasm").read_bytes()}
    monkeypatch.setattr(libraries, "gathered", lambda kernels: Gathered({}, entries))
    monkeypatch.setattr(libraries, "_made", lambda found, platforms: own)
    assert libraries._differences(False) == []
    monkeypatch.setattr(libraries, "gathered", lambda kernels: Gathered({}, {}))
    monkeypatch.setattr(libraries, "_made", lambda found, platforms: {"kernels.wasm": b"", "new.so": b""})
    said = libraries._differences(False)
    assert said == [
        "manifest.json: the entries are others", "kernels.wasm: its bytes are others", "new.so: its bytes are others",
    ]  # fmt: skip


def test_libraries_that_are_current_are_not_made_again(makers):
    assert libraries._are_current()


@pytest.mark.whole_world
@needs("zig", importlib.util.find_spec("ziglang"))
def test_the_library_of_this_platform_made_again_has_the_same_bytes():
    command = [sys.executable, "-m", "sandbox.physics.jit.making.libraries", "--check", "--here"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stdout + ended.stderr


def test_the_manifest_has_every_kernel_that_python_calls_with_the_types_of_its_annotations():
    assert gathered(all_entries()).entries == read_manifest()["entries"]
