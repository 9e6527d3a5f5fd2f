"""Goldens under the sanitizer of threads: g++ compiles kernels, since zig has none that a process loads."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from sandbox.physics.jit.making.compiling import CALLING, all_entries, gathered
from tests.determinism.golden import SHORTER
from tests.support.wants import needs

FLAGS = ("-O1", "-g", "-fPIC", "-fno-builtin", "-ffp-contract=off", "-fsanitize=thread", "-fvisibility=hidden", "-w")
# What zig's compiler has built in.
PROLOGUE = """template <class T> struct Referred { typedef T type; };
template <class T> struct Referred<T &> { typedef T type; };
#define __remove_reference_t(x) typename Referred<x>::type
"""
RUN = """
import json, sys
from pathlib import Path
from sandbox.physics import jit
from sandbox.physics.jit import library
folder = Path(sys.argv[1])
library._opened = library.Library(folder / "kernels.so", json.loads((folder / "entries.json").read_text()))
assert jit.COMPILED
jit.use_threads(3, worth=0)
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from tests.determinism.golden import golden_path
from tests.physics.test_large import mesh, play
play(mesh(5), 8)
for name in sys.argv[2:]:
    # The arithmetic is another compiler's: where a run ends is another test's.
    verify(read_replay(golden_path(name)), end=40)
print(jit.threads_started())
"""


def preloaded() -> str | None:
    """Where g++ has the sanitizer's library; None: it has none."""
    if shutil.which("g++") is None:
        return None
    asked = subprocess.run(["g++", "-print-file-name=libtsan.so"], capture_output=True, text=True, check=True)
    found = Path(asked.stdout.strip())
    return str(found.resolve()) if found.is_absolute() else None


@pytest.mark.whole_world
@needs("g++ with its sanitizer of threads", preloaded() is not None)
def test_goldens_run_clean_under_the_sanitizer_of_threads(tmp_path):
    made = gathered(all_entries())
    (tmp_path / "prologue.h").write_text(PROLOGUE)
    (tmp_path / "entries.json").write_text(json.dumps(made.entries))
    commands = [["gcc", "-std=gnu11", *FLAGS, "-c", str(CALLING), "-o", "calling.o"]]
    for name, text in made.texts.items():
        (tmp_path / name).write_text(text)
        commands.append(
            ["g++", "-include", "prologue.h", "-std=c++20", "-fno-exceptions", "-fno-rtti", *FLAGS, "-c", name]
        )
    for command in commands:
        subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    subprocess.run(
        ["g++", "-shared", "-fsanitize=thread", "-o", "kernels.so", *(file.name for file in tmp_path.glob("*.o"))],
        cwd=tmp_path, check=True, capture_output=True,
    )  # fmt: skip
    environment = {
        **os.environ, "LD_PRELOAD": preloaded() or "", "TSAN_OPTIONS": "report_signal_unsafe=0 exitcode=66",
        "PYTHONPATH": os.pathsep.join(sys.path),
    }  # fmt: skip
    ended = subprocess.run(
        [sys.executable, "-c", RUN, str(tmp_path), *sorted(SHORTER)], env=environment, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert "WARNING: ThreadSanitizer" not in ended.stderr, ended.stderr[:4000]
    assert (ended.returncode, ended.stdout.split()) == (0, ["2"])
