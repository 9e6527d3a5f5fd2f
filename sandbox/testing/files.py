"""Which files are tests, told without reading more than is needed."""

import json
from pathlib import Path

import pytest

RECORDINGS = (".replay.jsonl", ".replay.gz", ".replay.jsonl.gz")
# What follows the name of a level in that of a recording that solves it.
SOLUTION = ".solution.replay.gz"
GOLDEN = ".golden.json"
LEVEL_FORMAT = "spring-sandbox/level"
# A level file is no longer [bytes], see docs/level-format.md.
LONGEST = 8 * 2**20

_LEVELS = pytest.StashKey[frozenset[Path]]()


def is_recording(path: Path) -> bool:
    """Whether a file is called as recordings are."""
    return path.name.endswith(RECORDINGS)


def is_golden(path: Path) -> bool:
    """Whether a file is called as golden files are."""
    return path.name.endswith(GOLDEN)


def level_files(config: pytest.Config) -> frozenset[Path]:
    """The files that the setting `sandbox_levels` names, from the root on. Raises UsageError."""
    if _LEVELS not in config.stash:
        found: set[Path] = set()
        for pattern in config.getini("sandbox_levels"):
            try:
                found.update(config.rootpath.glob(pattern))
            except (NotImplementedError, ValueError) as error:
                raise pytest.UsageError(f"sandbox_levels: {pattern!r}: {error}") from None
        config.stash[_LEVELS] = frozenset(found)
    return config.stash[_LEVELS]


def given_renames(config: pytest.Config) -> dict[str, str]:
    """The names that --replay-rename gives, old to new. Raises UsageError."""
    pairs = [given.partition("=") for given in config.getoption("--replay-rename")]
    for old, sign, new in pairs:
        if not (old and sign and new):
            raise pytest.UsageError(f"--replay-rename: {old + sign + new!r}: write OLD=NEW, as rope=chain")
    return {old: new for old, _, new in pairs}


def names_a_level(path: Path) -> bool:
    """Whether a JSON file says that it is a level; one that is damaged does where it holds those words."""
    try:
        with path.open("rb") as file:
            data = file.read(LONGEST + 1)
    except OSError:
        return False
    if LEVEL_FORMAT.encode() not in data:
        return False
    try:
        values = json.loads(data)
    except (ValueError, RecursionError):
        return True
    return isinstance(values, dict) and values.get("format") == LEVEL_FORMAT


def has_solution(path: Path) -> bool:
    """Whether a recording that solves a level lies beside its file."""
    return path.with_name(f"{path.name.removesuffix('.json')}{SOLUTION}").exists()


def check_names(path: Path) -> list[str]:
    """The names of a level's checks, as far as they can be read; numbers in place of others."""
    try:
        checks = json.loads(path.read_bytes()).get("checks", [])
    except (OSError, ValueError, RecursionError, AttributeError):
        return []
    listed = checks if isinstance(checks, list) else []
    return [
        str(each.get("name", number)) if isinstance(each, dict) else str(number) for number, each in enumerate(listed)
    ]
