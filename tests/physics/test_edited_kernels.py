"""What is kept of edited kernels that were compiled: taken while it is whole, and made by one process at a time."""

import importlib.util
import json
import threading

import pytest
from filelock import FileLock

from sandbox.physics.jit import edited
from sandbox.physics.jit.sources import NoLibrary, file_digest
from tests.support.wants import needs

pytestmark = needs("zig", importlib.util.find_spec("ziglang"))
CONTENT = b"machine code"


def write(folder):
    """Keep a library as one that was compiled is kept."""
    folder.mkdir(parents=True)
    (folder / "kernels.so").write_bytes(CONTENT)
    manifest = {"library": "kernels.so", "digest": file_digest(CONTENT), "entries": {}}
    (folder / "manifest.json").write_text(json.dumps(manifest))


@pytest.fixture
def compiled(monkeypatch, tmp_path):
    """The folders that were compiled into, one after the other; zig is left out."""
    folders = []

    def compile_into(folder, checked):
        folders.append(folder)
        write(folder)

    monkeypatch.setattr(edited, "_folder", lambda: tmp_path / "kernels")
    monkeypatch.setattr(edited, "_compile", compile_into)
    return folders


@pytest.fixture
def said(monkeypatch):
    lines = []
    monkeypatch.setattr(edited, "say", lines.append)
    return lines


DAMAGES = {
    "no manifest": lambda folder: (folder / "manifest.json").unlink(),
    "an empty manifest": lambda folder: (folder / "manifest.json").write_text(""),
    "half a manifest": lambda folder: (folder / "manifest.json").write_text('{"library": "kernels.so"}'),
    "a list": lambda folder: (folder / "manifest.json").write_text("[]"),
    "no library": lambda folder: (folder / "kernels.so").unlink(),
    "half a library": lambda folder: (folder / "kernels.so").write_bytes(CONTENT[:6]),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_what_is_kept_and_damaged_is_compiled_again(damage, compiled, said):
    path, _ = edited.compiled_here("kernels were edited", False)
    assert edited.compiled_here("kernels were edited", False)[0] == path and len(compiled) == len(said) == 1
    DAMAGES[damage](path.parent)
    path, _ = edited.compiled_here("kernels were edited", False)
    assert path.read_bytes() == CONTENT and len(compiled) == len(said) == 2


def test_a_process_waits_for_another_that_compiles_the_same_kernels(compiled, monkeypatch):
    waits, found = threading.Event(), []
    monkeypatch.setattr(edited, "say", lambda line: waits.set())
    folder = edited._folder() / edited._version(False)
    folder.parent.mkdir()
    with FileLock(folder.parent / ".lock"):
        other = threading.Thread(target=lambda: found.append(edited.compiled_here("kernels were edited", False)))
        other.start()
        assert waits.wait(60.0)
        write(folder)
    other.join()
    assert found[0][0] == folder / "kernels.so" and compiled == []


def test_a_folder_that_cannot_be_written_is_named_in_one_line(compiled, said, tmp_path):
    (tmp_path / "kernels").write_text("a file")
    with pytest.raises(NoLibrary, match=r"^kernels were edited, and no library can be kept in .*kernels: [A-Z].*$"):
        edited.compiled_here("kernels were edited", False)
    assert compiled == []
