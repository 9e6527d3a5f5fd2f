"""A wheel that ships compiled kernels."""

import importlib.util
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture
def hook(monkeypatch):
    """The build hook, and the commands that it runs with their environments; each leaves a kernel in its cache."""
    specification = importlib.util.spec_from_file_location("hatch_build", ROOT / "hatch_build.py")
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    ran = []

    def run(command, env, **_):
        kernels = Path(env["NUMBA_CACHE_DIR"]) / "kernels"
        kernels.mkdir()
        (kernels / "one.kernel").touch()
        ran.append((command[1:], env))

    monkeypatch.setattr(module.subprocess, "run", run)

    def build(target):
        made = module.KernelBuildHook(str(ROOT), {}, None, None, "", target)
        data = {"force_include": {}}
        made.initialize("standard", data)
        shipped = {place: sorted(path.name for path in Path(source).iterdir())
                   for source, place in data["force_include"].items()}  # fmt: skip
        made.finalize("standard", data, "")
        return data, shipped

    return build, ran


def test_only_a_wheel_of_which_it_is_wished_ships_kernels(hook, monkeypatch):
    build, ran = hook
    monkeypatch.delenv("SANDBOX_SHIP_KERNELS", raising=False)
    assert build("wheel")[0] == {"force_include": {}}
    monkeypatch.setenv("SANDBOX_SHIP_KERNELS", "1")
    assert build("sdist")[0] == {"force_include": {}}
    assert ran == []


def test_shipped_kernels_are_for_any_processor_of_the_platform_that_the_wheel_is_for(hook, monkeypatch):
    build, ran = hook
    monkeypatch.setenv("SANDBOX_SHIP_KERNELS", "1")
    data, shipped = build("wheel")
    ((command, environment),) = ran
    assert command == ["-m", "sandbox", "prepare"]
    assert (environment["NUMBA_CPU_NAME"], environment["NUMBA_CPU_FEATURES"]) == ("generic", "")
    assert shipped == {"sandbox/_shipped/kernels": ["one.kernel"]}
    assert data["infer_tag"] and not data["pure_python"]
    assert not any(Path(source).exists() for source in data["force_include"])
