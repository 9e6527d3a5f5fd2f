"""Libraries of kernels: what is taken where there is none that can be used, with one line each; how they are called."""

import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sandbox.level.format.quantities import replaced
from sandbox.level.reading.files import load_level
from sandbox.physics.analysis.energy import spring_forces
from sandbox.physics.components import label_bodies
from sandbox.physics.jit import library
from sandbox.physics.jit.making.platforms import LIBRARIES, WEB
from sandbox.session.session import Session
from tests.support.package_copy import copy_of_the_package
from tests.support.wants import needs

pytestmark = pytest.mark.skipif(
    library.library_name() not in {platform.file for platform in LIBRARIES},
    reason="no library is made for this platform",
)
STEPS = """
import sys
{before}
from sandbox.physics import jit
from sandbox.physics.snapshot import state_hash
from tests.determinism.kernel_script import busy_world
from sandbox.physics.step import step
world = busy_world("single_pass", 1)
step(world)
print(jit.way(), state_hash(world))
"""
WITHOUT_ZIG = "import importlib.util as util; util.find_spec = lambda name: None"
ROOT = Path(__file__).resolve().parents[2]


def outcome(package, before=WITHOUT_ZIG, **variables):
    """How kernels run in a fresh process with this copy of the package, the hash of a tick, and the lines of errors."""
    environment = {name: value for name, value in os.environ.items() if name != "SANDBOX_KERNELS"}
    kept = dict.fromkeys(("XDG_CACHE_HOME", "LOCALAPPDATA", "HOME"), str(package.parent))
    environment |= {"PYTHONPATH": os.pathsep.join([str(package.parent), str(ROOT)]), **kept, **variables}
    command = [sys.executable, "-P", "-c", STEPS.replace("{before}", before)]
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    way, state = ended.stdout.split()
    return way, state, ended.stderr.splitlines()


@pytest.fixture(scope="module")
def untouched(tmp_path_factory):
    package = copy_of_the_package(tmp_path_factory.mktemp("untouched"))
    return outcome(package)


@pytest.fixture
def package(tmp_path):
    return copy_of_the_package(tmp_path)


def own_library(package):
    return package / "physics" / "jit" / "libraries" / library.library_name()


def test_a_clone_runs_from_its_library_and_says_nothing(untouched):
    way, _, lines = untouched
    assert (way, lines) == ("library", [])


def damage(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def forget_platform(path):
    manifest = json.loads(path.with_name("manifest.json").read_text())
    del manifest["files"][path.name]
    path.with_name("manifest.json").write_text(json.dumps(manifest))


def write_manifest(text):
    return lambda path: path.with_name("manifest.json").write_text(text)


OWN = f"the library {library.library_name()}"
NOT_THE_ONE = "is damaged, or not the one of its manifest"
DAMAGED = "the manifest of the libraries is damaged"
CHANGES = {
    "missing": (Path.unlink, f"{OWN} is missing"),
    "damaged": (damage, f"{OWN} {NOT_THE_ONE}"),
    "cut off": (lambda path: path.write_bytes(path.read_bytes()[:999]), NOT_THE_ONE),
    "of another": (lambda path: shutil.copy(path.with_name(WEB.file), path), NOT_THE_ONE),
    "platform": (forget_platform, "there is no library for this platform, "),
    "no manifest": (lambda path: path.with_name("manifest.json").unlink(), "of the libraries cannot be read"),
    "half a manifest": (write_manifest('{"files"'), DAMAGED),
    "a list": (write_manifest("[]"), DAMAGED),
}


@pytest.mark.parametrize("change", CHANGES)
def test_without_a_sound_library_one_line_says_why_and_the_bits_stay(change, package, untouched):
    break_it, why = CHANGES[change]
    break_it(own_library(package))
    way, state, lines = outcome(package)
    assert (way, state) == ("interpreted", untouched[1])
    assert len(lines) == 1 and why in lines[0]
    assert lines[0].endswith(": kernels are interpreted, a hundred times slower")


def test_an_edited_kernel_is_not_run_from_the_library(package, untouched):
    file = package / "physics" / "integrate.py"
    text = file.read_text()
    assert text.count("position[p, 0] += velocity[p, 0] * h") == 1
    file.write_text(text.replace("position[p, 0] += velocity[p, 0] * h", "position[p, 0] += velocity[p, 0] * h * 2.0"))
    way, state, lines = outcome(package)
    assert way == "interpreted" and state != untouched[1]
    why = "kernels were edited in physics/integrate.py, and zig is not installed (the extra `build`)"
    assert lines == [f"{why}: kernels are interpreted, a hundred times slower"]


@pytest.mark.whole_world
@needs("zig", importlib.util.find_spec("ziglang"))
def test_edited_kernels_are_compiled_once_on_this_machine(package, untouched):
    file = package / "physics" / "integrate.py"
    text = file.read_text()
    file.write_text(text.replace("position[p, 0] += velocity[p, 0] * h", "position[p, 0] += velocity[p, 0] * h * 2.0"))
    way, state, lines = outcome(package, "")
    why = "kernels were edited in physics/integrate.py: they are compiled once, which takes about 15 s"
    assert (way, lines) == ("library", [why]) and state != untouched[1]
    assert outcome(package, "") == (way, state, [])
    assert outcome(package, "", SANDBOX_KERNELS="interpreted")[1] == state
    file.write_text(text.replace("position[p, 0] += velocity[p, 0] * h", "position[p, 0] **= 2.0"))
    way, _, lines = outcome(package, "")
    assert way == "interpreted" and lines[0].startswith("kernels were edited in physics/integrate.py: ")
    assert re.match(r"sandbox/physics/integrate\.py:\d+: kernels have no such operator of these: ", lines[1])


@needs("zig", importlib.util.find_spec("ziglang"))
def test_edited_kernels_are_interpreted_where_no_library_can_be_kept(package, untouched):
    source = package / "physics" / "integrate.py"
    source.write_text(source.read_text() + "\n\n@inner_kernel\ndef more() -> None:\n    return\n")
    file = package / "a_file"
    file.write_text("no folder")
    caches = dict.fromkeys(("XDG_CACHE_HOME", "LOCALAPPDATA", "HOME"), str(file))
    way, state, lines = outcome(package, "", **caches)
    assert (way, state, len(lines)) == ("interpreted", untouched[1], 2)
    assert lines[1].startswith("kernels were edited in physics/integrate.py, and no library can be kept in ")
    assert lines[1].endswith(": kernels are interpreted, a hundred times slower")


def test_what_is_no_kernel_may_be_edited(package, untouched):
    file = package / "physics" / "integrate.py"
    file.write_text(file.read_text() + "\n\n# a remark\ndef plain(value: int) -> int:\n    return value + 1\n")
    assert outcome(package) == untouched


@pytest.mark.parametrize("wish", ["generic", "interpreted", "library"])
def test_a_way_can_be_wished_for(wish, package, untouched):
    assert outcome(package, SANDBOX_KERNELS=wish) == (wish, untouched[1], [])


ENTRY = "sandbox.physics.substeps._turn_into_substep"


def weighed(*arguments):
    """Cs of three springs of Cs 1 and Cd 0 whose ends are half as heavy."""
    given = [np.ones(3), np.zeros(3), np.zeros(3), 1, 0, 1.0, 0.5]
    for place, value in arguments:
        given[place] = value
    library.open_library().function(ENTRY)(*given)
    return given[0]


def test_an_entry_takes_whole_numbers_and_numbers_of_numpy_for_a_float():
    for ease in (2, np.float64(2.0), np.float32(2.0), True):
        assert weighed((6, ease))[0] == 1.0 / float(ease)


def test_an_entry_takes_arrays_that_are_not_contiguous_and_writes_into_them():
    wide = np.ones((3, 2))
    weighed((0, wide[:, 0]))
    assert wide.tolist() == [[2.0, 1.0]] * 3


def test_an_entry_reads_arrays_that_are_read_only_and_leaves_them_as_they_are():
    damping = np.full(3, 0.5)
    damping.setflags(write=False)
    assert weighed((1, damping))[0] == 1.0 / 0.75 and damping.tolist() == [0.5] * 3
    still = np.broadcast_to(1.0, 3)
    weighed((0, still))
    assert still.tolist() == [1.0] * 3


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (0, np.zeros(3, dtype=np.float32)),
        (0, np.zeros((3, 2))),
        (0, [0.0] * 3),
        (0, None),
        (2, np.ones(3, dtype=bool)),
        (5, "0.5"),
        (5, None),
    ],
)
def test_an_entry_refuses_what_it_was_not_compiled_for(place, value):
    with pytest.raises(TypeError):
        weighed((place, value))


def test_every_entry_of_the_manifest_is_in_the_library_and_its_arguments_have_room():
    opened = library.open_library()
    assert len(opened.entries) > 15
    assert all(callable(opened.function(name)) for name in opened.entries)


def test_an_entry_refuses_too_few_arguments():
    with pytest.raises(TypeError, match="_turn_into_substep takes 7 arguments, not 1"):
        library.open_library().function(ENTRY)(np.zeros(3))


def test_kernels_of_the_package_are_builtin_functions_here_once_they_were_called():
    if library.read_manifest() and os.environ.get("SANDBOX_KERNELS", "library") == "library":
        from sandbox.physics import jit

        kernel = jit.kernel_of(label_bodies)
        assert kernel is not None and jit.kernel_of(kernel.ready()) is kernel


def test_the_manifest_names_every_library_and_is_that_of_the_sources():
    manifest = library.read_manifest()
    assert set(manifest["files"]) == {platform.file for platform in (*LIBRARIES, WEB)}
    for name, digest in manifest["files"].items():
        assert library.file_digest((library.FOLDER / name).read_bytes()) == digest, name
    assert {path.name for path in library.FOLDER.iterdir()} == {*manifest["files"], "manifest.json"}
    assert library.edited(manifest["sources"]) == [], "make libraries makes them anew"


@pytest.mark.parametrize("solver", ["single_pass", "iterative", "direct"])
def test_a_snapshot_whose_arrays_are_read_only_has_the_forces_of_its_world(solver):
    level = load_level("rope")
    settings = replaced(level.settings, solver=solver, substeps=4)
    session = Session(replaced(level, settings=settings))
    for _ in range(20):
        session.advance()
    assert np.array_equal(spring_forces(session.snapshot()), spring_forces(session.world))
