"""The map of the house, kept true: imports point downward, heavy libraries stay in their rooms, files stay short."""

import ast
import functools
import importlib
import subprocess
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import sandbox
from tests import quick

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "sandbox"
# What users import: modules that only pass names on. They stand above the rooms that they take those from.
PUBLIC = ("commands", "replay", "bodies")
ROOMS = (
    "version", "processors", "physics", "level", "bring", "export", "session", "page", *PUBLIC, "tools", "editor",
    "app", "testing", "terminal", "cli", "__main__",
)  # fmt: skip
# Rooms of the window, from the ground up.
ROOMS_OF_APP = (
    "base", "run", "draw", "sound", "widgets", "film", "settings", "contracts", "graphs", "share", "parts",
    "panel", "play", "edit", "compare", "toy", "gallery", "site", "window",
)  # fmt: skip
# Folders that import each other both ways: the table of solvers says where joints bear a load.
BOTH_WAYS: dict[str, list[tuple[str, str]]] = {"physics": [], "level": []}
LIBRARIES = {
    "physics": {"numpy", "platformdirs", "filelock"},
    "level": {"numpy", "pydantic", "pydantic_core", "shapely", "mapbox_earcut"},
    "bring": {"numpy", "pydantic", "shapely", "svgelements", "defusedxml", "contourpy", "PIL"},
    "export": {"numpy", "pydantic"},
    "session": {"numpy", "pydantic", "filelock", "distributed"},
    "page": {"numpy"},
    **{name: set() for name in PUBLIC},
    "tools": {"numpy"},
    "editor": {"numpy", "pydantic", "platformdirs", "filelock"},
    "testing": {"numpy", "pytest"},
    "processors": set(),
    "terminal": {"tqdm"},
    "cli": set(),
    "__main__": set(),
}
# What the project is; all else has a place in one of the folders.
AT_THE_ROOT = {
    "sandbox", "levels", "assets", "tests", "docs", "pyproject.toml", "Makefile", "README.md", "CONTRIBUTING.md",
    "action.yml", "CHANGELOG.md", "LICENSE",
}  # fmt: skip
LONGEST_FILE = 600
LONGEST_FUNCTION = 60
MOST_FILES = 25
MOST_ARGUMENTS = 12


@functools.cache
def sources():
    """Syntax tree of every module of the package, by its dotted name."""
    trees = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        trees[name] = ast.parse(path.read_text(encoding="utf-8"), filename=str(path))
    return trees


@pytest.fixture(autouse=True, scope="module")
def no_tree_is_kept():
    """A million objects: each search for garbage in the tests after these would take ten times as long."""
    yield
    sources.cache_clear()


def statements(node):
    """Parts of a tree that a program runs: without what stands below `if TYPE_CHECKING:`."""
    yield node
    for child in ast.iter_child_nodes(node):
        if not (isinstance(child, ast.If) and isinstance(child.test, ast.Name) and child.test.id == "TYPE_CHECKING"):
            yield from statements(child)
        else:
            for other in child.orelse:
                yield from statements(other)


@functools.cache
def imported(name):
    """Dotted names that a module imports where it runs; what it names of our own are modules, not their contents."""
    found = set()
    for node in statements(sources()[name]):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{name}: imports are absolute"
            for alias in node.names:
                full = f"{node.module}.{alias.name}"
                found.add(full if full in sources() else str(node.module))
    return found


def room(name):
    """The room of one of our modules; None for the package itself, which loads nothing but the version."""
    return name.split(".")[1] if "." in name else None


def own_imports():
    """Pairs of our modules, importer and imported, without those of the package itself."""
    return [
        (name, other)
        for name in sources()
        for other in sorted(imported(name))
        if room(name) and other in sources() and room(other)
    ]


def test_the_package_is_found_and_every_module_is_in_a_known_room():
    assert len(sources()) > 15
    assert {room(name) for name in sources()} - {None} <= set(ROOMS)


def test_imports_point_downward():
    upward = [
        f"{name} imports {other}" for name, other in own_imports() if ROOMS.index(room(other)) > ROOMS.index(room(name))
    ]
    assert upward == []


def folder(name):
    """The folder of one of our modules below its room, or the module itself where it lies in the room."""
    below = name.split(".")[2:]
    is_package = any(other.startswith(f"{name}.") for other in sources())
    return ".".join(below if is_package or len(below) == 1 else below[:-1])


def test_imports_of_the_window_point_downward():
    inside = [(name, other) for name, other in own_imports() if room(name) == room(other) == "app"]
    rank = {name: ROOMS_OF_APP.index(folder(name).split(".")[0]) for pair in inside for name in pair}
    assert [f"{name} imports {other}" for name, other in inside if rank[other] > rank[name]] == []


@pytest.mark.parametrize("wanted", BOTH_WAYS)
def test_folders_of_a_room_do_not_import_each_other_both_ways(wanted):
    inside = [(folder(name), folder(other)) for name, other in own_imports() if room(name) == room(other) == wanted]
    arrows = {(one, other) for one, other in inside if one != other}
    assert sorted((one, other) for one, other in arrows if one < other and (other, one) in arrows) == BOTH_WAYS[wanted]


def test_no_file_lies_loose_in_the_window():
    assert [path.name for path in (PACKAGE / "app").glob("*.py")] == ["__init__.py"]


def test_no_room_imports_the_package_itself():
    """It passes on names of rooms, and stands above them all."""
    for name in sources():
        for node in ast.walk(sources()[name]):
            if isinstance(node, ast.ImportFrom) and node.module == "sandbox":
                assert {alias.name for alias in node.names} <= set(ROOMS), name


def test_no_modules_import_each_other_in_a_circle():
    graph = TopologicalSorter()
    for name, other in own_imports():
        graph.add(name, other)
    try:
        graph.prepare()
    except CycleError as circle:
        pytest.fail(" imports ".join(reversed(circle.args[1])))


def test_only_app_imports_pygame():
    for name in sources():
        libraries = {other.partition(".")[0] for other in imported(name)}
        if room(name) != "app":
            assert not libraries & {"pygame"}, name


def test_each_room_imports_the_libraries_that_it_may():
    for name in sources():
        libraries = {other.partition(".")[0] for other in imported(name)} - sys.stdlib_module_names - {"sandbox"}
        if room(name) in LIBRARIES:
            assert libraries <= LIBRARIES[room(name)], name


def loaded_after(statement):
    """Top-level names of the modules that a fresh process has loaded after a statement."""
    script = f"import sys\n{statement}\nprint(*sorted(sys.modules), file=sys.stderr)"
    ended = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    return set(ended.stderr.split())


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_module_only_passes_on_the_names_that_it_lists_and_no_room_needs_it(name):
    tree = sources()[f"sandbox.{name}"]
    assert all(isinstance(node, ast.Expr | ast.ImportFrom | ast.Assign | ast.AugAssign) for node in tree.body)
    passed_on = set()
    for node in tree.body:
        if isinstance(node, ast.ImportFrom):
            names = {alias.name for alias in node.names if not (alias.asname or "").startswith("_")}
            passed_on |= set(importlib.import_module(node.module).__all__) if "*" in names else names
    public = importlib.import_module(f"sandbox.{name}")
    assert sorted(public.__all__) == sorted(passed_on)
    assert all(hasattr(public, exported) for exported in public.__all__)
    assert [importer for importer, other in own_imports() if other == f"sandbox.{name}"] == []


def test_every_name_of_the_package_itself_can_be_had():
    assert set(sandbox.__all__) == {"__version__", *sandbox._HOME}
    assert all(getattr(sandbox, name) is not None for name in sandbox.__all__)


def test_physics_level_export_and_session_load_no_pygame():
    without = ("physics", "level", "bring", "export", "session", *PUBLIC, "tools", "editor")
    rooms = [name for name in sources() if room(name) in without]
    loaded = loaded_after(f"import {', '.join(rooms)}")
    assert "sandbox.physics.step" in loaded
    assert not loaded & {"pygame"}


def test_importing_the_package_loads_none_of_its_rooms_until_a_name_is_used():
    assert {name for name in loaded_after("import sandbox") if name.startswith("sandbox.")} == {"sandbox.version"}
    assert "sandbox.physics.world" in loaded_after("import sandbox; sandbox.World")


@pytest.mark.parametrize("arguments", [["--help"], ["run", "--help"], ["--version"]])
def test_help_loads_neither_pygame_nor_numpy(arguments):
    loaded = loaded_after(
        "import runpy\n"
        f"sys.argv = ['sandbox', *{arguments!r}]\n"
        "try:\n    runpy.run_module('sandbox', run_name='__main__')\n"
        "except SystemExit as end:\n    assert not end.code, end.code"
    )
    assert "sandbox.cli" in loaded
    assert not loaded & {"pygame", "numpy", "pydantic"}


def test_the_plugin_of_pytest_loads_nothing_heavy():
    loaded = loaded_after("import sandbox.testing.plugin")
    assert "sandbox.testing.items" in loaded
    assert not loaded & {"pygame", "numpy", "pydantic", "sandbox.level", "sandbox.app"}


def test_the_window_needs_none_of_the_libraries_that_take_long_to_import():
    loaded = loaded_after("from sandbox.app.window.opening import open_app")
    assert "pygame" in loaded
    assert not loaded & {"numpy", "pydantic", "platformdirs", "sandbox.physics.jit"}


def test_the_root_holds_what_the_project_is():
    kept = {name.partition("/")[0] for name in quick.git("ls-files")}
    assert {name for name in kept if not name.startswith(".")} in (AT_THE_ROOT, set())


def test_no_file_is_longer_than_600_lines():
    lengths = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in PACKAGE.rglob("*.py")}
    assert {str(path.relative_to(ROOT)): length for path, length in lengths.items() if length > LONGEST_FILE} == {}


def test_no_function_takes_more_than_12_arguments():
    many = {}
    for name, tree in sources().items():
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                given = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
                count = len([one for one in given if one.arg not in ("self", "cls")])
                if count > MOST_ARGUMENTS:
                    many[f"{name}.{node.name}"] = count
    assert many == {}


def test_no_folder_holds_more_than_25_files():
    counts = {folder: len(list(folder.glob("*.py"))) for folder in [PACKAGE, *PACKAGE.rglob("*")] if folder.is_dir()}
    crowded = {str(folder.relative_to(ROOT)): count for folder, count in counts.items() if count > MOST_FILES}
    assert crowded == {}


def test_no_function_is_longer_than_60_lines():
    long = {
        f"{name}.{node.name}": node.end_lineno - node.lineno + 1
        for name, tree in sources().items()
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and node.end_lineno - node.lineno + 1 > LONGEST_FUNCTION
    }
    assert long == {}


def shared(names):
    """Those of the names in (name, place) pairs that stand for several places, with these."""
    places = {}
    for name, place in names:
        places.setdefault(name, []).append(place)
    return {name: found for name, found in places.items() if len(found) > 1}


def test_no_two_classes_have_one_name():
    classes = (
        (node.name, name) for name, tree in sources().items() for node in tree.body if type(node) is ast.ClassDef
    )
    assert shared(classes) == {}


def test_no_two_files_of_a_room_have_one_name():
    files = (((room(name), name.rpartition(".")[2]), name) for name in sources() if name.count(".") > 1)
    folders = {name.rpartition(".")[0] for name in sources()}
    assert shared((key, name) for key, name in files if name not in folders) == {}
