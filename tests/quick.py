"""Run the tests of what differs from main, without slow ones: python -m tests.quick [options of pytest].

A changed file leads to the tests of its room, which have a folder of the room's name. Two rooms are too large for that:
for the window and for physics, those tests run that import from the folder of the changed file, or are called like one
of the two.
"""

import re
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# The rules of the house: they take seconds, and any change can break them.
ALWAYS = ("tests/test_architecture.py", "tests/test_contributing.py")
# Rooms of which all tests take minutes.
LARGE = ("app", "physics")
# Files and folders outside `sandbox` and `tests`, with what tests them.
ELSEWHERE = {
    "README.md": ("tests/test_documentation.py",),
    "CHANGELOG.md": ("tests/test_documentation.py",),
    "CONTRIBUTING.md": (),
    "docs/": ("tests/test_documentation.py", "tests/test_examples.py"),
    ".github/": ("tests/test_packaging.py",),
    "levels/": ("tests/level/test_shipped_levels.py", "tests/level/test_levels_keep_their_word.py"),
    "assets/": ("tests/app/test_fonts.py", "tests/test_packaging.py"),
    "pyproject.toml": ("tests/test_packaging.py",),
}
# Folders of tests that node runs, with what starts it.
IN_NODE = {"tests/page/modules": "tests/page/test_modules.py"}
# Rooms that are one file, or are tested by files of another name.
BY_ROOM = {
    "cli": ("tests/test_cli.py",), "terminal.py": ("tests/test_cli.py",), "__main__.py": ("tests/test_cli.py",),
    "__init__.py": ("tests/test_packaging.py",), "version.py": ("tests/test_packaging.py",),
    "processors.py": ("tests/physics/test_threads.py",),
    "commands.py": ("tests/test_examples.py",), "replay.py": ("tests/test_examples.py",),
    "bodies.py": ("tests/test_examples.py",),
}  # fmt: skip


def changed_files() -> list[str]:
    """Files that differ from where this branch left main, in commits or in the working tree, and new ones."""
    return files_since(left_branch("main") or left_branch("origin/main") or "HEAD")


def left_branch(name: str) -> str:
    """The commit where this branch left another one, empty where there is no such branch."""
    return "".join(git("merge-base", "HEAD", name))


def files_since(commit: str) -> list[str]:
    """Files that differ from a commit, in commits or in the working tree, and new ones."""
    return sorted({*git("diff", "--name-only", commit), *git("ls-files", "--others", "--exclude-standard")})


def git(*arguments: str) -> list[str]:
    """The lines that git prints; none where it fails."""
    ended = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    return ended.stdout.split("\n")[:-1] if ended.returncode == 0 else []


def tests_of(path: str) -> set[str]:
    """Test files and folders that a changed file leads to; a file that is gone leads to those that still name it."""
    if path.startswith("tests/"):
        return tests_of_tests(path)
    if path.startswith("sandbox/"):
        return tests_of_source(path)
    found = (
        tests for place, tests in ELSEWHERE.items() if path == place or (place[-1] == "/" and path.startswith(place))
    )
    return set().union(*found)


def tests_of_source(path: str) -> set[str]:
    """Test files and folders that a changed file of the package leads to."""
    room, *below = path.split("/")[1:]
    if room in BY_ROOM:
        return set(BY_ROOM[room])
    if room not in LARGE:
        return {f"tests/{room}"} if (ROOT / "tests" / room).is_dir() else set()
    folder = ".".join(["sandbox", room, *below[:-1]])
    stem = Path(path).stem
    # A file that lies loose in its room has no folder to be named by.
    found = naming(folder if len(below) > 1 else f"{folder}.{stem}", room)
    return found.union(*(called(name, room) for name in [*below[:-1], stem]))


def tests_of_tests(path: str) -> set[str]:
    """Test files that a changed file of the tests leads to: itself, or those that import it."""
    if not (ROOT / path).exists():
        return set()
    name = Path(path).name
    if name.startswith("test_") and name.endswith(".py"):
        return {path}
    if name == "conftest.py" and Path(path).parent.name in LARGE:
        return set()
    if name == "conftest.py" and path != "tests/conftest.py":
        return {str(Path(path).parent)}
    if str(Path(path).parent) in IN_NODE:
        return {IN_NODE[str(Path(path).parent)]}
    return naming(path.removesuffix(".py").replace("/", "."), "") if name.endswith(".py") else set()


def naming(module: str, room: str) -> set[str]:
    """Test files below a room's folder of tests in which a module, or one below it, is named."""
    pattern = re.compile(rf"{re.escape(module)}\b")
    return {
        str(path.relative_to(ROOT)) for path in test_files(room) if pattern.search(path.read_text(encoding="utf-8"))
    }


def called(stem: str, room: str) -> set[str]:
    """Test files below a room's folder of tests whose name has that of a changed file or its folder in it."""
    return {str(path.relative_to(ROOT)) for path in test_files(room) if stem in path.stem}


def test_files(room: str) -> Iterable[Path]:
    """Every test file below a room's folder of tests."""
    return sorted((ROOT / "tests" / room).rglob("test_*.py"))


def chosen(paths: Iterable[str]) -> list[str]:
    """What to run for changed files: folders, and files that are not in one of them."""
    found = set(ALWAYS).union(*map(tests_of, paths))
    folders = {path for path in found if not path.endswith(".py")}
    return sorted(path for path in found if path in folders or not any(path.startswith(f"{each}/") for each in folders))


def main() -> int:
    """Say what is run, and run it."""
    paths = chosen(changed_files())
    print("Tests of what differs from main:", *paths, sep="\n  ", flush=True)
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-m", "not slow and not whole_world", *sys.argv[1:], *paths], cwd=ROOT
    ).returncode


if __name__ == "__main__":
    raise SystemExit(main())
