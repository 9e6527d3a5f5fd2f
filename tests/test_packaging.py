import os
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
import yaml

from sandbox.app.film.kinds import KINDS
from sandbox.page.bundle import BUNDLE
from sandbox.page.page import KERNELS
from tests.page.packed import unpacked

ROOT = Path(__file__).resolve().parents[1]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
# One for a repository of somebody else.
BOARD = ROOT / "docs" / "sharing" / "board.yml"


def test_an_installed_wheel_finds_its_levels_parts_and_assets_from_another_folder(tmp_path):
    build = [
        sys.executable,
        "-m",
        "pip",
        "wheel",
        "--no-deps",
        "--no-build-isolation",
        "-q",
        "-w",
        str(tmp_path),
        str(ROOT),
    ]
    subprocess.run(build, check=True, capture_output=True, text=True)
    (wheel,) = tmp_path.glob("spring_sandbox-*.whl")
    installed, elsewhere = tmp_path / "installed", tmp_path / "elsewhere"
    elsewhere.mkdir()
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(installed)
    assert (installed / "sandbox" / "py.typed").is_file()
    readers = {path.name for path in (installed / "sandbox" / "_shipped" / "docs" / "examples" / "flat").iterdir()}
    assert readers == {path.name for path in (ROOT / "docs" / "examples" / "flat").iterdir() if path.is_file()}
    # Nothing of what checks and bundles pages.
    assert not [path for path in (installed / "sandbox" / "page" / "web").iterdir() if path.suffix in (".json", ".mjs")]
    libraries = Path("sandbox", "physics", "jit", "libraries")
    shipped = {path.name: path.read_bytes() for path in (installed / libraries).iterdir()}
    assert shipped == {path.name: path.read_bytes() for path in (ROOT / libraries).iterdir()}
    program = (
        "import sandbox; from sandbox.level.reading.files import load_level, shipped_folder, shipped_levels\n"
        "assert load_level('rope').name and shipped_levels()\n"
        "print(sandbox.__file__, len(shipped_levels()), len(list(shipped_folder('assets').iterdir())),\n"
        "len(list((shipped_folder('levels') / 'parts').glob('*.json'))))"
    )
    environment = {**os.environ, "PYTHONPATH": str(installed)}
    command = [sys.executable, "-P", "-c", program]
    run = subprocess.run(command, cwd=elsewhere, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    file, levels, assets, parts = run.stdout.split()
    assert Path(file).is_relative_to(installed)
    assert int(levels) == len(list((ROOT / "levels").glob("*.json")))
    assert int(parts) == len(list((ROOT / "levels" / "parts").glob("*.json"))) > 0
    assert int(assets) == len(list((ROOT / "assets").iterdir()))
    # Who writes a page needs neither node nor anything else on the path.
    page = [sys.executable, "-P", "-m", "sandbox", "page", "rope", "-o", "rope.html"]
    subprocess.run(page, cwd=elsewhere, env=environment | {"PATH": str(elsewhere)}, check=True, capture_output=True)
    text = (elsewhere / "rope.html").read_text(encoding="utf-8")
    assert unpacked(text, "modules") == BUNDLE.read_bytes() and unpacked(text, "kernels") == KERNELS.read_bytes()


def test_make_play_installs_what_shared_files_need_and_no_compiler_and_dev_all_extras():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    assert {f"{project['name']}[{name}]" for name in ("export", "sweep", "build")} <= set(extras["dev"])
    packages = {name: {re.split(r"[<>=]", needed)[0] for needed in extras[name]} for name in ("export", "sweep")}
    assert packages["export"] == {kind.package for kind in KINDS.values() if kind.package} | {"matplotlib"}
    assert packages["sweep"] == {"dask", "distributed"}
    needed = {re.split(r"[<>=]", each)[0] for each in project["dependencies"]}
    assert not needed & {"ziglang"}
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    recipe = makefile.split("$(VENV)/installed:")[1].split("\n\n")[0]
    assert '--editable ".[export]"' in recipe
    assert "play: $(VENV)/installed\n" in makefile


def steps_of(workflow):
    return [step for job in workflow["jobs"].values() for step in job.get("steps", ())]


@pytest.mark.parametrize("path", [*WORKFLOWS, BOARD], ids=lambda path: path.name)
def test_a_workflow_names_only_targets_of_make_and_files_that_exist(path):
    workflow = yaml.safe_load(path.read_text(encoding="utf-8"))
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    lines = "\n".join(step.get("run", "") for step in steps_of(workflow))
    for target in re.findall(r"\bmake ([\w-]+)", lines):
        assert re.search(rf"^{target}:", makefile, re.MULTILINE), target
    used = [job["uses"] for job in workflow["jobs"].values() if "uses" in job]
    named = [*re.findall(r"(?<!\S)(\.[\w-]+/[\w./-]+)", path.read_text(encoding="utf-8")), *used]
    assert [name for name in named if not (ROOT / name).exists()] == []
    assert all(re.search(r"@(v\d+|release/v\d+)$", step["uses"]) for step in steps_of(workflow) if "uses" in step)


def test_only_tests_run_by_themselves_and_each_other_workflow_is_in_the_guide_for_owners():
    guide = (ROOT / "docs" / "releasing.md").read_text(encoding="utf-8")
    for path in WORKFLOWS:
        # YAML reads the word `on` as true.
        triggers = set(yaml.safe_load(path.read_text(encoding="utf-8"))[True])
        assert path.stem == "test" or triggers <= {"workflow_dispatch", "workflow_call"}, path.name
        assert f"| `{path.stem}` |" in guide


def test_only_what_publishes_may_write_and_only_to_where_it_publishes():
    allowed = {"site": {"pages", "id-token"}, "release": {"id-token"}, "board": {"pages", "id-token", "pull-requests"}}
    for path in [*WORKFLOWS, BOARD]:
        workflow = yaml.safe_load(path.read_text(encoding="utf-8"))
        given = [workflow["permissions"], *(job.get("permissions", {}) for job in workflow["jobs"].values())]
        writing = {name for each in given for name, right in each.items() if right == "write"}
        assert writing == allowed.get(path.stem, set()), path.name


def test_the_workflow_of_a_board_waits_for_an_owner_and_no_job_that_reads_entries_of_others_may_write():
    workflow = yaml.safe_load(BOARD.read_text(encoding="utf-8"))
    assert set(workflow[True]) == {"workflow_dispatch"}
    for job in workflow["jobs"].values():
        steps = "\n".join(step.get("run", "") + str(step.get("with", "")) for step in job["steps"])
        if "refs/pull" in steps:
            assert "permissions" not in job and "sandbox board pull/entries" in steps
    assert workflow["permissions"] == {"contents": "read"}
