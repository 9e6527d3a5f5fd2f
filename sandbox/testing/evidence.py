"""Evidence of failures: pictures, films, recordings and pages; where they go, and how many there are."""

import re
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from sandbox.session.compare.comparison import Comparison
    from sandbox.session.player.page import PlayerPage
    from sandbox.session.session import Session

# Of how many failures there are pictures: of none, of the first few of a process, of all.
CHOICES = ("none", "first", "all")
FIRST = 5
# What a run of a test in Python ends in: not the name of a recording that is a test itself.
KEPT_RUN = "recording.gz"

# What a file shows, how its name ends, and what writes it.
_Writer = tuple[str, str, Callable[[Path], object]]
_DRAWN = pytest.StashKey[int]()


def pictures_of(config: pytest.Config, found: "Comparison", path: Path) -> list[str]:
    """Draw where the run of a recording parts from it; a line each of where that is, or of why it is not."""

    def picture(target: Path) -> None:
        from sandbox.app.share.evidence import write_picture

        write_picture(found, target)

    def motion(target: Path) -> None:
        from sandbox.app.share.evidence import write_motion

        write_motion(found, target)

    def player(target: Path) -> None:
        from sandbox.session.player.page import report_page

        report_page(found).write(target)

    return _written(
        config,
        name_of(config, path),
        [("picture", "png", picture), ("motion", "gif", motion), ("player", "html", player)],
    )


def is_of_here(line: str) -> bool:
    """Whether a line of a failure names a file of evidence, which another computer does not have."""
    return line.removeprefix("no ").partition(": ")[0] in ("picture", "pictures", "motion", "player")


def name_of(config: pytest.Config, path: Path) -> str:
    """Name for the files of evidence about a file: where it lies, so that no two files share one."""
    return path.relative_to(config.rootpath).as_posix() if path.is_relative_to(config.rootpath) else path.name


def runs_of(config: pytest.Config, test: str, runs: Iterable["Session"], reason: str) -> list[str]:
    """Keep the runs of a test in Python that failed, and a page of each; test: its id, reason: why it failed."""
    lines = []
    name = re.sub(r"[^\w.-]+", "-", test).strip("-")
    for number, run in enumerate(runs, 1):

        def recording(target: Path, run: "Session" = run) -> None:
            if run.save_to(target) is None:
                raise OSError(0, run.refusals[-1])

        def player(target: Path) -> None:
            recording = target.with_name(f"{target.name.removesuffix('.html')}.{KEPT_RUN}")
            _page_of(recording, test, reason.splitlines()).write(target)

        one = name if number == 1 else f"{name}-{number}"
        # A run cannot be had otherwise: it is kept of every failure, pages are not.
        kept = _files(config, one, [("recording", KEPT_RUN, recording)])
        page = [] if kept[0].startswith("no ") else _written(config, one, [("player", "html", player)])
        lines += [*kept, *page]
    return lines


def _page_of(recording: Path, title: str, lines: Sequence[str]) -> "PlayerPage":
    from sandbox.session.player.page import PlayerPage, command_marks, played
    from sandbox.session.replay.reader import read_replay
    from sandbox.session.session import Session

    replay = read_replay(recording)
    run = Session(replay.level, script=replay.script)
    return PlayerPage(title, *played(["run"], [run], replay.ticks), marks=command_marks(replay), lines=lines)


def _written(config: pytest.Config, name: str, writers: Sequence[_Writer]) -> list[str]:
    """Write files about a failure, as many as are asked for: nothing that goes wrong here may hide the failure."""
    chosen, drawn = config.getoption("--replay-pictures"), config.stash.get(_DRAWN, 0)
    if chosen == "none":
        return []
    if chosen == "first" and drawn >= FIRST:
        return [f"no pictures: of the first {FIRST} failures only; --replay-pictures=all draws them of all"]
    config.stash[_DRAWN] = drawn + 1
    return _files(config, name, writers)


def _files(config: pytest.Config, name: str, writers: Sequence[_Writer]) -> list[str]:
    try:
        place = place_of(config, name)
    except OSError as error:
        return [f"no pictures: {_words(error)}; --replay-output DIR puts them where there is room"]
    lines: list[str] = []
    for what, ending, write in writers:
        target = place.with_name(f"{place.name}.{ending}")
        try:
            write(target)
        except OSError as error:
            with suppress(OSError):
                target.unlink()
            return [*lines, f"no {what}: {_words(error)}; --replay-output DIR puts it where there is room"]
        except Exception as error:
            lines.append(f"no {what}: {error or type(error).__name__}")
        else:
            lines.append(f"{what}: {target}")
    return lines


def _words(error: OSError) -> str:
    return f"{error.filename}: {error.strerror or error}" if error.filename else str(error.strerror or error)


def place_of(config: pytest.Config, name: str) -> Path:
    """Where evidence of this name goes, but for endings, in folders that are made. Raises OSError."""
    output, cache = config.getoption("--replay-output"), getattr(config, "cache", None)
    if output:
        folder = config.invocation_params.dir / output
    elif cache is None:
        raise OSError(0, "pytest's cache is switched off")
    else:
        folder = Path(cache.mkdir("replays"))
    place = folder / name
    place.parent.mkdir(parents=True, exist_ok=True)
    return place
