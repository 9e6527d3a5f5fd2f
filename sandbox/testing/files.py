"""Which files are tests, told without reading more than is needed."""

import difflib
import fnmatch
import json
import zlib
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from sandbox.session.replay import FORMAT, RECORDINGS, is_recording, smallest_test, stem_of

if TYPE_CHECKING:
    from sandbox.session.compare.comparison import Comparison

# What follows the name of a level in that of a recording that solves it.
SOLUTION = ".solution.replay.gz"
GOLDEN = ".golden.json"
USUAL_LEVELS = ["levels/*.json"]
LEVEL_FORMAT = "spring-sandbox/level"
# What is read of a file to see whether it is a recording [bytes].
HEAD = 4096
# Where levels lie unless the setting says otherwise: in folders of this name.
LEVELS = "levels"
# A level file is no longer [bytes], see docs/level-format.md.
LONGEST = 8 * 2**20
_LEVELS = pytest.StashKey[frozenset[Path]]()


class Failed(Exception):
    """Why a test fails, a line each; shown without a traceback. found: two runs that part, where there are."""

    def __init__(self, *lines: str, found: "Comparison | None" = None) -> None:
        super().__init__("\n".join(lines))
        self.found = found


def is_golden(path: Path) -> bool:
    """Whether a file is called as golden files are."""
    return path.name.endswith(GOLDEN)


def has_test(path: Path) -> bool:
    """Whether a recording is the smallest run of a failure, beside a test in Python that tells of it."""
    return stem_of(path.name).endswith(".smallest") and smallest_test(path).is_file()


def level_files(config: pytest.Config) -> frozenset[Path]:
    """The files that the setting `sandbox_levels` names, from the root on. Raises UsageError."""
    if _LEVELS not in config.stash:
        found: set[Path] = set()
        for pattern in config.getini("sandbox_levels"):
            try:
                named = set(config.rootpath.glob(pattern))
            except (NotImplementedError, ValueError) as error:
                raise pytest.UsageError(f"sandbox_levels: {pattern!r}: {error}") from None
            if not named and pattern not in USUAL_LEVELS:
                raise pytest.UsageError(f"sandbox_levels: {pattern!r}: there is no such file in {config.rootpath}")
            found |= named
        config.stash[_LEVELS] = frozenset(found)
    return config.stash[_LEVELS]


def is_asked_level(config: pytest.Config, path: Path) -> bool:
    """Whether a file is among those of `sandbox_levels`; without that setting also in any folder `levels`."""
    if path in level_files(config):
        return True
    is_usual = config.getini("sandbox_levels") == USUAL_LEVELS
    return is_usual and LEVELS in path.parts[:-1] and says_it_is_a_level(path)


def levels_around(path: Path, name: str) -> list[Path]:
    """The file of a level's name beside a recording, those in a folder `levels` there, and so in the folders around it.

    No further than the repository.
    """
    found: list[Path] = []
    for folder in path.parents:
        found += [each for each in [folder / name] if name and each.is_file()]
        found += (folder / LEVELS).glob("*.json")
        if (folder / ".git").exists():
            break
    return found


def why_untested(path: Path) -> str | None:
    """Why a file that looks like one of ours is no test, in words; None: it is one, or looks like none."""
    name, small = path.name, path.name.casefold()
    if name.startswith("."):
        return None
    if path.is_symlink() and not path.exists():
        is_ours = is_recording(path) or is_golden(path) or path.parent.name == LEVELS
        return "a link to nothing" if is_ours else None
    if is_recording(path):
        level = path.with_name(f"{name.partition('.solution.')[0]}.json")
        if ".solution." in name and not name.endswith(SOLUTION):
            return f"solves no level: a solution ends in {SOLUTION}"
        return (
            f"solves no level: there is no {level.name} beside it" if SOLUTION in name and not level.exists() else None
        )
    if small.endswith((*RECORDINGS, ".replay", ".replay.json")) or _holds_recording(path):
        return f"a recording ends in {' or '.join(RECORDINGS[:2])}"
    if small.endswith("golden.json") and not is_golden(path):
        return f"a golden file ends in {GOLDEN}"
    if path.suffix != ".json" and small.endswith(".json") and says_it_is_a_level(path):
        return "a level ends in .json"
    return None


def _holds_recording(path: Path) -> bool:
    """Whether a file of another name holds a recording."""
    if path.suffix.casefold() not in (".rec", ".gz", ".jsonl"):
        return False
    try:
        with path.open("rb") as file:
            head = file.read(HEAD)
        if head.startswith(b"\x1f\x8b"):
            head = zlib.decompressobj(31).decompress(head, HEAD)
    except (OSError, zlib.error):
        return False
    return FORMAT.encode() in head


def asked_renames(config: pytest.Config) -> dict[str, str]:
    """The names that --replay-rename gives, old to new. Raises UsageError."""
    pairs = [pair.partition("=") for pair in config.getoption("--replay-rename")]
    for old, sign, new in pairs:
        if not (old and sign and new):
            raise pytest.UsageError(f"--replay-rename: {old + sign + new!r}: write OLD=NEW, as rope=chain")
    return {old: new for old, _, new in pairs}


def marked(config: pytest.Config) -> list[tuple[str, str]]:
    """The marks of the setting `sandbox_marks`, each with the pattern of its files. Raises UsageError."""
    found = []
    for line in config.getini("sandbox_marks"):
        mark, colon, pattern = (part.strip() for part in line.partition(":"))
        if not (colon and pattern and mark.isidentifier()):
            raise pytest.UsageError(f"sandbox_marks: {line!r}: write a mark, a colon and a pattern of files")
        found.append((mark, pattern))
    return found


def marks_of(config: pytest.Config, path: Path) -> list[str]:
    """The marks that the setting gives a file."""
    return [mark for mark, pattern in marked(config) if fits(config, path, pattern)]


def fits(config: pytest.Config, path: Path, pattern: str) -> bool:
    """Whether a pattern of the setting `sandbox_marks` fits a file."""
    root = config.rootpath
    return path.is_relative_to(root) and fnmatch.fnmatchcase(path.relative_to(root).as_posix(), pattern)


def is_level(path: Path) -> bool:
    """Whether a JSON file that lies where levels lie is to be one: all but what says that it is something else.

    That is a `format` that is another's, or the keys of a JSON Schema or of another program. What is empty, cut off,
    damaged, or has a format that resembles that of levels, is a level, and so its test fails.
    """
    try:
        values = json.loads(_read(path))
    except (OSError, ValueError, RecursionError):
        return True
    if not isinstance(values, dict) or values.get("format") == LEVEL_FORMAT:
        return True
    kind = values.get("format")
    if kind is not None:
        return isinstance(kind, str) and bool(difflib.get_close_matches(kind.strip().casefold(), [LEVEL_FORMAT]))
    from sandbox.level.format.foreign import foreign_keys

    return foreign_keys(values) is None


def says_it_is_a_level(path: Path) -> bool:
    """Whether a file holds the format of levels, also one that is damaged."""
    try:
        return LEVEL_FORMAT.encode() in _read(path)
    except OSError:
        return False


def _read(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(LONGEST + 1)


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
