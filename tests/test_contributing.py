"""CONTRIBUTING.md, docs/architecture.md and docs/how-to-add.md name what exists, and leave nothing out."""

import ast
import functools
import re
from pathlib import Path

import pytest

from sandbox.physics.jit.making import platforms
from sandbox.physics.pipeline import tick
from tests import test_architecture

ROOT = Path(__file__).resolve().parents[1]
CONTRIBUTING = ROOT / "CONTRIBUTING.md"
ARCHITECTURE = ROOT / "docs" / "architecture.md"
HOW_TO_ADD = ROOT / "docs" / "how-to-add.md"
# Files whose tests add something to a copy of the package.
ADDING = ("tests/test_additions.py", "tests/level/test_adding_a_body_kind.py")


def rows(page, heading):
    """Cells of the first table under a heading."""
    section = page.read_text(encoding="utf-8").split(f"## {heading}\n", 1)[1].split("\n## ")[0]
    lines = [line for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


def quoted(text):
    return re.findall(r"`([^`]+)`", text)


def folders(path):
    return {folder.name for folder in (ROOT / path).iterdir() if (folder / "__init__.py").is_file()}


@functools.cache
def defined(path):
    """Functions and classes of a file, and methods as `Class.method`."""
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    named = (ast.ClassDef, ast.FunctionDef)
    found = {node.name for node in tree.body if isinstance(node, named)}
    return found | {
        f"{node.name}.{each.name}"
        for node in tree.body
        if isinstance(node, ast.ClassDef)
        for each in node.body
        if isinstance(each, named)
    }


@pytest.mark.parametrize(
    ("heading", "rooms"),
    [("Rooms of the package", test_architecture.ROOMS), ("Rooms of the window", test_architecture.ROOMS_OF_APP)],
)
def test_the_map_lists_the_rooms_in_the_order_in_which_they_may_be_imported(heading, rooms):
    assert [quoted(room)[0] for room, _ in rows(ARCHITECTURE, heading)] == list(rooms)


@pytest.mark.parametrize(
    ("heading", "path"), [("Folders of a level", "sandbox/level"), ("Folders of physics", "sandbox/physics")]
)
def test_the_map_lists_every_folder_of_a_room_and_no_other(heading, path):
    assert {quoted(folder)[0] for folder, _ in rows(ARCHITECTURE, heading)} == folders(path)


def test_the_map_lists_every_module_of_a_page_behind_those_that_it_imports():
    web = ROOT / "sandbox" / "page" / "web"
    listed = [name for names, _ in rows(ARCHITECTURE, "The page that plays") for name in quoted(names)]
    assert sorted(listed) == sorted(path.name for path in web.glob("*.js"))
    for place, name in enumerate(listed):
        imported = set(re.findall(r"from '\./(\w+\.js)';", (web / name).read_text(encoding="utf-8")))
        assert imported <= set(listed[:place]), name


WALKS = (
    "A click, from the mouse to a button",
    "A drag, from the mouse to the recording",
    "A level, from its file to a world",
    "A tick",
)
STOPS = [
    (quoted(file)[0], name) for walk in WALKS for file, names, _ in rows(ARCHITECTURE, walk) for name in quoted(names)
]


@pytest.mark.parametrize(("path", "name"), STOPS, ids=[name for _, name in STOPS])
def test_every_stop_of_a_walk_is_a_function_of_the_file_that_it_names(path, name):
    assert name in defined(path)


@pytest.mark.parametrize("page", [CONTRIBUTING, ARCHITECTURE, HOW_TO_ADD], ids=lambda page: page.name)
def test_every_path_that_a_page_names_exists(page):
    named = re.findall(r"(?:sandbox|tests|docs|levels)/[\w./-]+\w", page.read_text(encoding="utf-8"))
    assert named and [path for path in named if not (ROOT / path).exists()] == []


@pytest.mark.parametrize("page", [CONTRIBUTING, HOW_TO_ADD], ids=lambda page: page.name)
def test_every_name_in_capitals_that_a_page_says_to_change_is_in_the_file_that_it_names(page):
    astray = []
    for name, path in re.findall(r"`([A-Z_]{4,})` in\s+`([\w/.]+\.py)`", page.read_text(encoding="utf-8")):
        if not re.search(rf"^{name}\b", (ROOT / path).read_text(encoding="utf-8"), re.MULTILINE):
            astray.append((name, path))
    assert astray == []


def test_every_test_that_proves_an_addition_exists_in_its_file():
    for addition, _, proof in additions():
        path, *names = quoted(proof)
        assert names and set(names) <= defined(path), addition


def additions():
    """What is added, files, and proof, of every row of the table."""
    lines = [line for line in HOW_TO_ADD.read_text(encoding="utf-8").splitlines() if line.startswith("| a ")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def test_every_addition_that_a_test_tries_is_in_the_table():
    tried = {name for path in ADDING for name in defined(path) if name.startswith("test_")}
    assert tried - {name for *_, proof in additions() for name in quoted(proof)} == set()


def test_every_row_of_the_table_has_a_section_with_as_many_files():
    text = HOW_TO_ADD.read_text(encoding="utf-8")
    for addition, files, _ in additions():
        section = text.split(f"\n## {addition[0].upper()}{addition[1:]}\n")
        assert len(section) == 2, addition
        steps = re.findall(r"^(\d)\. ", section[1].split("\n## ")[0], re.MULTILINE)
        assert int(files) == (int(steps[-1]) if steps else 1), addition


def test_every_target_of_make_that_is_named_exists():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    named = set(re.findall(r"make ([\w-]+)", CONTRIBUTING.read_text(encoding="utf-8")))
    assert {name for name in named if not re.search(rf"^{name}:", makefile, re.MULTILINE)} == set()


DRAWING = ARCHITECTURE.read_text(encoding="utf-8").split("## A kernel, from its source to the library", 1)[1]
DRAWING = DRAWING.split("```text\n", 1)[1].split("```", 1)[0]


def test_the_drawing_of_a_kernel_names_files_and_what_is_in_them():
    stops = re.findall(r"^((?:[a-z_]+/)+[a-z_]+\.(?:py|js)) *(\w*)", DRAWING, re.MULTILINE)
    found = {path: next(ROOT.glob(f"sandbox/**/{path.removeprefix('sandbox/')}"), None) for path, _ in stops}
    assert len(stops) == 6 and None not in found.values(), found
    known = {path: defined(found[path].relative_to(ROOT)) for path, _ in stops}
    assert [name for path, name in stops if name not in known[path] | {"the", "a", ""}] == []
    folders = re.findall(r"^(jit/\w+)", DRAWING, re.MULTILINE)
    assert folders == ["jit/translate"] and (ROOT / "sandbox/physics" / folders[0]).is_dir()


def test_the_drawing_of_a_kernel_names_the_platforms_and_how_many_entries_pages_call():
    systems = {each.name.partition("-")[0] for each in platforms.LIBRARIES}
    processors = {each.name.partition("-")[2].replace("_", "-") for each in platforms.LIBRARIES}
    line, below = re.search(r"make libraries --> (.*) -+\+.*\n *\|? *(.*)", DRAWING).groups()
    assert set(line.split(", ")) == systems and set(below.split(", ")) == processors
    assert f"kernels.wasm: the {len(platforms.WEB.entries)} entries that pages call" in DRAWING


def test_the_drawing_of_a_kernel_names_what_a_tick_says_and_what_python_and_pages_call():
    said = re.search(r"tick\(pointer\) --> (.*) \.\.\.", DRAWING).group(1).split(", ")
    assert set(said) <= set(vars(tick))
    derived = re.search(r"(derive_topology)\(pointer, arena\), (.*)", DRAWING)
    names = [derived.group(1), *derived.group(2).split(", ")]
    assert set(names) <= {name.rpartition(".")[2] for name in platforms.WEB.entries}
