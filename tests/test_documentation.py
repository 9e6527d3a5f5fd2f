"""What README and docs show works as they say, and what they point at is there."""

import ast
import functools
import json
import math
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sandbox.app.base.shortcuts import shortcuts
from sandbox.level.reading.files import load_level, parse_level, read_level, shipped_levels
from sandbox.physics.analysis.energy import kinetic_energy, spring_energy, spring_lengths
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.analysis.stability import report
from sandbox.physics.equation import of_body, of_springs
from sandbox.physics.settings import WorldSettings
from sandbox.physics.softness.firmness import lowest_mode_of
from sandbox.physics.step import PHYSICS_VERSION, step
from sandbox.physics.substeps import turned
from sandbox.physics.world import World
from sandbox.session.check_run import run_checks
from sandbox.session.commands import COMMAND_TYPES
from sandbox.session.outcome import outcome
from sandbox.session.replay.reader import read_script
from sandbox.session.session import Session
from tests.pictures import gallery, readme
from tests.support.failing import put_failing
from tests.support.wobbles import firm_world

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
HEADLESS = (ROOT / "docs" / "headless.md").read_text(encoding="utf-8")
ARCHITECTURE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
COMMANDS = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
PHYSICS = (ROOT / "docs" / "physics.md").read_text(encoding="utf-8")
PROSE = " ".join(PHYSICS.split())
BENCHMARKS = (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8")
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
# What kernels may take from math and numpy: results that IEEE 754 defines to the last bit, and types.
EXACT = {"sqrt", "floor", "ceil", "inf", "int32", "int64", "uint64", "float64"}
FOLDERS = "sandbox|levels|assets|docs|tests"


def test_the_level_that_is_written_as_text_keeps_its_own_checks():
    (text,) = re.findall(r"```json\n(.*?)```", (ROOT / "docs" / "how-to-levels.md").read_text("utf-8"), re.DOTALL)
    results = run_checks(parse_level(text.encode(), "how-to-levels.md"))
    assert results and all(result.passed for result in results), [result.text for result in results]


def test_the_program_that_uses_the_package_prints_that_every_tick_is_equal(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (program,) = re.findall(r"```python\n(.*?)```", HEADLESS, re.DOTALL)
    exec(compile(program, "headless.md", "exec"), {})
    assert capsys.readouterr().out == "None\n"


def test_the_program_that_finds_a_failure_finds_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    put_failing(tmp_path)
    page = (ROOT / "docs" / "testing.md").read_text(encoding="utf-8")
    (program,) = re.findall(r"```python\n(from sandbox\.replay .*?)```", page, re.DOTALL)
    exec(compile(program, "testing.md", "exec"), {})


def test_the_commands_in_the_documentation_are_all_there_are_and_every_one_is_carried_out(tmp_path):
    lines, driving, pressing, pumping, firming, weighing, joining = re.findall(
        r"```jsonl\n(.*?)```", COMMANDS, re.DOTALL
    )
    shown = (lines + driving + pressing + pumping + firming + weighing + joining).splitlines()
    assert {json.loads(line)["command"]["type"] for line in shown} == set(COMMAND_TYPES)
    table = COMMANDS.split("|---|---|---|")[1]
    named = {
        name
        for row in table.splitlines()
        if row.startswith("|")
        for name in re.findall(r"`(\w+)`", row[: row.index("|", 1)])
    }
    assert named == set(COMMAND_TYPES)
    (tmp_path / "moves.jsonl").write_text(lines)
    session = Session(load_level("rope"), read_script(tmp_path / "moves.jsonl"))
    for _ in range(140):
        session.advance()
    assert not session.messages
    assert session.world.settings.solver == "iterative"
    assert "+.0" in session.world.particle_names
    (tmp_path / "drop.jsonl").write_text(joining)
    session = Session(load_level("jelly_pile"), read_script(tmp_path / "drop.jsonl"))
    for _ in range(116):
        session.advance()
    assert not session.messages and session.world.particle_slot("+4.hub")
    (tmp_path / "fire.jsonl").write_text(driving)
    session = Session(load_level("catapult"), read_script(tmp_path / "fire.jsonl"))
    for _ in range(180):
        session.advance()
    assert len(session.messages) == 1 and session.messages[0].endswith(" broke")
    (tmp_path / "press.jsonl").write_text(pressing)
    level = read_level(ROOT / "docs" / "rules" / "chain.json")
    session = Session(level, read_script(tmp_path / "press.jsonl"))
    for _ in range(180):
        session.advance()
    assert not session.messages and outcome(level, session.world).text == "All down"
    (tmp_path / "weigh.jsonl").write_text(weighing)
    session = Session(load_level("jelly_pile"), read_script(tmp_path / "weigh.jsonl"))
    mass = session.world.mass.sum()
    for _ in range(61):
        session.advance()
    assert not session.messages and session.world.mass.sum() > mass
    (tmp_path / "pump.jsonl").write_text(pumping)
    session = Session(load_level("balloons"), read_script(tmp_path / "pump.jsonl"))
    wanted = session.world.constraint_rest.copy()
    for _ in range(70):
        session.advance()
    assert not session.messages
    assert np.count_nonzero(session.world.constraint_rest > wanted) == 1
    (tmp_path / "firm.jsonl").write_text(firming)
    session = Session(load_level("jelly_pile"), read_script(tmp_path / "firm.jsonl"))
    for _ in range(100):
        session.advance()
    assert not session.messages
    assert 0 < np.count_nonzero(session.world.lowest_mode) < len(session.world.lowest_mode) / 2


def rows(page, heading):
    """The rows of the first table under a heading, as cells without the back quotes."""
    section = page.split(f"{heading}\n", 1)[1].split("\n## ")[0]
    table = section[section.index("\n|") :].split("\n\n")[0].strip().splitlines()
    return [[cell.strip().strip("`") for cell in line.strip("|").split("|")] for line in table[2:]]


def anchor(heading):
    """What a link to a heading is called."""
    return re.sub(r"[^\w -]", "", heading.strip().lower()).replace(" ", "-")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_file_and_folder_that_a_page_names_exists(page):
    named = re.findall(rf"`((?:{FOLDERS})(?:/[\w.-]+)*/?)`", page.read_text(encoding="utf-8"))
    assert [name for name in named if not (ROOT / name).exists()] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_within_the_project_leads_somewhere(page):
    astray = []
    for target in re.findall(r"\]\(([^)]+)\)", page.read_text(encoding="utf-8")):
        name, _, place = target.partition("#")
        if "://" in target:
            continue
        found = page if not name else next(
            (path for path in (page.parent / name, page.parent / f"{name}.md") if path.is_file()), None
        )  # fmt: skip
        headings = re.findall(r"^#+ (.*)$", found.read_text(encoding="utf-8"), re.M) if found and place else []
        if found is None or (place and place not in map(anchor, headings)):
            astray.append(target)
    assert astray == []


def test_the_gallery_has_every_level_with_its_text_and_picture():
    assert gallery.PAGE.read_text(encoding="utf-8") == gallery.page(), "python -m tests.pictures gallery"
    named = set(re.findall(r"^sandbox play (\w+)$", gallery.page(), re.MULTILINE))
    assert named == {path.stem for path in shipped_levels()}
    assert {path.stem for path in gallery.FOLDER.glob("*")} == named


def test_the_pictures_of_the_documentation_are_few_bytes_and_each_is_shown_somewhere():
    folders = ("gallery", "how-to", "built-by-mouse", "sharing", "readme")
    pictures = [path for folder in folders for path in (ROOT / "docs" / folder).iterdir() if path.suffix != ".json"]
    assert sum(path.stat().st_size for path in pictures) < 5_000_000
    shown = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    assert [path.name for path in pictures if f"{path.parent.name}/{path.name}" not in shown] == []


def test_the_readme_is_short_and_begins_with_a_film_of_four_seconds():
    assert len(README.splitlines()) <= 140
    (first, *_) = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", README)
    path = ROOT / first
    assert path.stat().st_size < 1_500_000
    with Image.open(path) as film:
        lengths = []
        for number in range(film.n_frames):
            film.seek(number)
            film.load()
            lengths.append(film.info["duration"])
        assert film.info["loop"] == 0
    assert sum(lengths) / 1000 == pytest.approx(4.0, abs=0.1)


def test_the_film_of_the_readme_shows_steel_and_a_cut_and_nothing_leaves_its_pictures():
    performance = readme.Performance()
    moved = []
    for _ in range(round(readme.LENGTH * performance.rate)):
        performance.advance()
        moved.append(performance.session.world.position.copy())
    assert performance.share == 1.0 and not performance.session.messages
    assert not performance.session.world.spring_active.all()
    assert np.isfinite(moved[-1]).all()
    left, bottom, right, top = performance.session.level.view
    shown = shown_particles(performance.session.world)
    places = np.array([each[: len(shown)][shown] for each in moved])
    assert np.all((places > (left, bottom)) & (places < (right, top)))


def test_the_map_of_the_project_names_every_room_and_every_folder_and_no_other():
    mapped = {
        name
        for folders, _ in rows(ARCHITECTURE, "## Where things are")
        for name in re.findall(r"[\w/.]+", folders.replace("`", ""))
    }
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False).stdout.split()
    if not tracked:
        pytest.skip("no checkout: what belongs to the project cannot be told")
    folders = {path.split("/")[0] for path in tracked if "/" in path and not path.startswith(".")}
    public = {path for path in tracked if re.fullmatch(r"sandbox/(?!__)\w+\.py", path)}
    rooms = {"/".join(path.split("/")[:2]) for path in tracked if re.match(r"sandbox/\w+/", path)}
    assert mapped == (folders - {"sandbox"}) | rooms | public


def row_of_springs(solver, coefficient, count):
    """The springs worked out by hand in docs/physics.md: from a wall to the right, steps of 1 s."""
    world = World(WorldSettings(solver=solver, tick_rate=1, gravity=(0.0, 0.0)))
    places = [(0.0, 0.0), *((1.1 + k, 0.0) for k in range(count))]
    world.add_particles([f"p.{k}" for k in range(count + 1)], places, pinned=[True] + [False] * count)
    world.add_springs(
        [f"p:{k}" for k in range(count)], np.arange(count), np.arange(1, count + 1), rest_length=1.0,
        stiffness=coefficient, damping=coefficient,
    )  # fmt: skip
    return world


def errors(world):
    return world.position[1:, 0] - world.position[:-1, 0] - 1.0


@pytest.mark.parametrize("solver", ["single_pass", "iterative", "direct"])
def test_one_spring_worked_out_by_hand_moves_so(solver):
    world = row_of_springs(solver, 0.5, 1)
    step(world)
    assert errors(world) == pytest.approx([0.05])
    assert "J = -0.05 N s, u' = -0.05 m/s and x' = 0.05 m" in PROSE


def test_two_rigid_springs_in_a_row_explode_in_the_single_pass_as_the_table_says():
    table = rows(PHYSICS, "## 2. Many springs at once, and where 1/(n+1) comes from")
    foreseen = np.array([[float(value) for value in row[1:]] for row in table]).T
    world = row_of_springs("single_pass", 1.0, 2)
    for expected in foreseen:
        step(world)
        assert errors(world) == pytest.approx(expected)


def test_the_limits_of_the_row_are_those_that_the_page_names():
    limits = report(row_of_springs("single_pass", 0.5, 2))
    page = [
        float(value)
        for value in re.findall(r"(0\.\d+)(?= is (?:stable|proven|the article))", " ".join(PHYSICS.split()))
    ]
    assert page == pytest.approx([limits.estimated_limit, limits.proven_limit, limits.article_limit], abs=5e-4)


def test_two_springs_in_a_row_move_in_the_direct_solver_as_worked_out_by_hand():
    world = row_of_springs("direct", 0.5, 2)
    before = spring_energy(world)
    step(world)
    assert world.velocity[1:, 0] == pytest.approx([-3.0 / 70.0, -1.0 / 70.0])
    assert errors(world) == pytest.approx([0.0571, 0.0286], abs=5e-5)
    assert (before, kinetic_energy(world), spring_energy(world)) == pytest.approx((0.005, 0.00102, 0.00184), abs=5e-6)
    assert before - kinetic_energy(world) - spring_energy(world) == pytest.approx(0.00214, abs=5e-6)
    assert world.energy_bank[1] == pytest.approx(0.00025)
    rigid = row_of_springs("direct", 1.0, 2)
    step(rigid)
    assert spring_lengths(rigid) == pytest.approx([1.0, 1.0], abs=1e-6)


def test_the_triangle_worked_by_hand_is_what_the_code_finds():
    form = {"particles": [[0, 0], [1, 0], [0.5, math.sqrt(0.75)]], "springs": [[0, 1], [1, 2], [2, 0]]}
    world = firm_world({"sag": 0}, type="mesh", **form)
    assert lowest_mode_of(world.forms[0].shape) == pytest.approx(0.75)
    assert of_body(0.5, 0.5, 0.75) == pytest.approx((0.429, 0.429), abs=5e-4)
    assert of_springs(*of_body(0.5, 0.5, 0.75), 0.75) == pytest.approx((0.5, 0.5))
    assert "Cd_a = 0.75/1.75 = 0.429" in PROSE


def test_the_halved_coefficients_on_the_page_are_those_of_the_code():
    stiffness, damping = turned(np.array([0.5]), np.array([0.75]), np.zeros(1), 2)
    assert (stiffness[0], damping[0]) == pytest.approx((0.177, 0.5), abs=5e-4)
    assert "(Cs, Cd) = (0.5, 0.75) becomes (0.177, 0.5)" in PROSE


def test_every_test_that_a_figure_is_held_by_exists():
    sources = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("test_*.py"))
    named = [test for _, test in rows(PHYSICS, "## 12. Figures that hold") if test != "the same"]
    assert len(named) > 15
    assert [test for test in named if f"def {test}(" not in sources] == []


@pytest.mark.parametrize("constant", rows(PHYSICS, "## 14. Constants"), ids=lambda row: row[0])
def test_every_constant_of_the_derivation_has_the_value_that_the_page_says(constant):
    name, value, file = constant
    assert re.search(rf"^{name} = {re.escape(value)}$", (ROOT / file).read_text(encoding="utf-8"), re.M)


def test_every_equation_of_the_derivation_has_a_number_that_stands_at_the_lines_that_compute_it():
    sources = (ROOT / "sandbox" / "physics").rglob("*.py")
    at_lines = {
        int(n) for path in sources for n in re.findall(r"#.*\((\d+)\)$", path.read_text(encoding="utf-8"), re.M)
    }
    on_page = [int(n) for n in re.findall(r"^    .*   \((\d+)\)$", PHYSICS, re.M)]
    assert on_page == list(range(1, len(on_page) + 1))
    assert at_lines == set(on_page)
    assert {int(n) for n in re.findall(r"(?<![\w`)(])\((\d{1,2})\)", PHYSICS)} <= at_lines


@functools.cache
def kernels():
    """Every function of the physics that is compiled, with its file."""
    return [
        (path.name, function)
        for path in sorted((ROOT / "sandbox" / "physics").rglob("*.py"))
        for function in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(function, ast.FunctionDef)
        and any("kernel" in ast.unparse(decorator) for decorator in function.decorator_list)
    ]


def test_kernels_use_no_operation_whose_bits_differ_between_machines():
    differing = []
    for file, function in kernels():
        for node in (node for statement in function.body for node in ast.walk(statement)):
            if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow | ast.MatMult):
                differing.append(f"{file}: {function.name}: {ast.unparse(node)}")
            if (
                isinstance(node, ast.Attribute)
                and isinstance(node.value, ast.Name)
                and node.value.id in ("math", "np")
                and node.attr not in EXACT
            ):
                differing.append(f"{file}: {function.name}: {ast.unparse(node)}")
    assert len(kernels()) > 100
    assert differing == []


KEYS = re.compile(r"(?<![\w+])((?:Ctrl\+)?(?:Shift\+)?(?:F\d+|[A-Z]|Space|Escape))(?![\w+])")


@pytest.mark.parametrize(("heading", "mode"), [("## Play", "play"), ("## Edit", "edit")])
def test_every_key_of_the_page_of_controls_is_one_of_the_window(heading, mode):
    page = (ROOT / "docs" / "controls.md").read_text(encoding="utf-8")
    named = {key for _, does in rows(page, heading) for key in KEYS.findall(does)}
    known = {key for entry in shortcuts(mode) for key in entry.keys}
    assert len(named) > 20 and named - known == set()


def test_the_keys_of_the_readme_do_in_the_window_what_it_says():
    actions = {key: entry.action for entry in shortcuts("play") for key in entry.keys}
    told = [key for key, _ in rows(README, "## Start")]
    assert [actions[key] for key in told] == ["palette", "tool_cut", "pause", "undo", "edit", "save", "help"]


def test_every_figure_of_the_readme_s_strip_stands_in_the_table_of_the_same_run():
    table = {row[0].split(" (")[0]: row[2] for row in reversed(rows(BENCHMARKS, "## The same rope after a second"))}
    (said,) = re.findall(r"!\[(The same rope[^\]]+)\]", README)
    figures = dict(re.findall(r"in (pymunk|Box2D v3|Rapier)(?: stretched)? by ([\d.]+ %)", said))
    (figures["Spring Sandbox"],) = re.findall(r"here by ([\d.]+ %)", said)
    assert figures == table and len(table) == 4


def test_every_benchmark_program_that_is_named_exists():
    named = re.findall(r"python -m tests\.bench\.(\w+)", BENCHMARKS)
    assert len(set(named)) > 5
    bench = ROOT / "tests" / "bench"
    places = {name: (bench / f"{name}.py", bench / name / "__main__.py") for name in named}
    assert [name for name, paths in places.items() if not any(path.is_file() for path in paths)] == []


def glossary():
    """Term, meaning, the window's word and file of every row of the glossary."""
    lines = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8").splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("| ")]
    return [(*row[:3], row[3].strip("`")) for row in cells if row[0] != "term"]


FIELDS_WORDS = (
    "collision", "contact", "manifold", "island", "constraint", "joint", "motor", "substep", "restitution",
    "penetration", "Gauss-Seidel", "multifrontal", "shape matching", "projected Newton", "mouse joint",
)  # fmt: skip


def test_the_glossary_has_the_words_that_people_know_from_other_engines():
    assert {term.lower() for term in FIELDS_WORDS} <= {term.lower() for term, *_ in glossary()}


def test_the_glossary_has_each_word_once():
    terms = [term.lower() for term, *_ in glossary()]
    assert len(terms) > 40
    assert sorted(terms) == sorted(set(terms))


@pytest.mark.parametrize(("term", "file"), [(row[0], row[3]) for row in glossary()], ids=[row[0] for row in glossary()])
def test_a_search_for_a_word_of_the_glossary_leads_to_its_file(term, file):
    text = " ".join((ROOT / file).read_text(encoding="utf-8").lower().replace("_", " ").split())
    assert term.lower() in text


def test_the_changelog_says_in_short_entries_under_known_headings_what_was_changed_and_what_recordings_must_expect():
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    known = {"Recordings and levels made before", "Added", "Changed", "Fixed", "Size"}
    for release in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        headings = re.findall(r"^### (.*)$", release, re.MULTILINE)
        assert headings and set(headings) <= known
        assert "Recordings" in headings[0] or f"physics version {PHYSICS_VERSION}" not in release
    entries = re.split(r"^- ", text, flags=re.MULTILINE)[1:]
    assert [entry for entry in entries if len(entry.split("\n\n")[0]) > 330] == []
    assert f"physics version {PHYSICS_VERSION}" in text


# Words that plain English has better ones for, and the page that is made from the texts of levels.
NOT_PLAIN = re.compile(r"\b(anew|deeds?|whatever|so many|stuff|what is held)\b", re.IGNORECASE)
WRITTEN = [*PAGES, ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md"]
MADE = ("gallery.md",)


@pytest.mark.parametrize("page", [page for page in WRITTEN if page.name not in MADE], ids=lambda page: page.name)
def test_pages_are_in_plain_english(page):
    text = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    prose = "\n".join(line for line in text.splitlines() if not line.startswith("    "))
    assert [match.group() for match in NOT_PLAIN.finditer(prose)] == []
