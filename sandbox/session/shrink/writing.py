"""Writes what was found: the smallest run as a recording, and a test of pytest that runs it."""

import os
import re
from dataclasses import fields
from pathlib import Path

from sandbox.level.document.model import Level
from sandbox.session.session import Session
from sandbox.session.shrink.failure import Failure
from sandbox.session.shrink.play import Play, short_json
from sandbox.session.shrink.trials import carried_out

# Commands that are written in a test, at most; more are only in the recording.
MOST_SHOWN = 4


def write_recording(play: Play, level: Level, path: Path) -> None:
    """Record a play of a level; where a tick crashes, up to that. Raises OSError where the file cannot be written."""
    session = Session(level)
    session.record_to(path)
    lines = list(play.lines)
    try:
        while session.tick < play.ticks:
            while lines and lines[0].tick == session.tick:
                carried_out(session, lines.pop(0))
            session.advance()
    except OSError:
        session.abandon_recording()
        raise
    except Exception:
        # The crash is what is recorded.
        pass
    session.take_messages()
    if session.stop_recording() is None:
        raise OSError(0, "; ".join(session.messages), str(path))


def test_text(play: Play, failure: Failure, source: str, recording: Path, levels: dict[str, str | None]) -> str:
    """A test that passes once the smallest run does not fail any more.

    source: the recording that it was made from. levels: names or files, as seen from the test: `own`, of the level that
    the commands run on, None: the recorded one; `other`, of the level that the failure compares it with.
    """
    own, other = levels.get("own"), levels.get("other")
    name = re.sub(r"\W+", "_", recording.name.partition(".replay")[0], flags=re.ASCII).strip("_").lower()
    level = f", {_loaded(own)}" if own else ""
    imports = "CheckFails" if not other and type(failure).__name__ == "CheckFails" else type(failure).__name__
    needs_load = own is not None or other is not None
    shown = [f"    # tick {line.tick}: {short_json(line.record)}" for line in play.lines[:MOST_SHOWN]]
    more = len(play.lines) - MOST_SHOWN
    return "\n".join([
        f'"""The smallest run in which {_plain(failure)}, made from {source} by `sandbox shrink`."""',
        "",
        "from pathlib import Path",
        "",
        *(["from sandbox import load_level"] if needs_load else []),
        f"from sandbox.replay import {', '.join(sorted([imports, 'find_failure', 'read_replay'], key=str.casefold))}",
        "",
        "HERE = Path(__file__).parent",
        "",
        "",
        f"def test_{name}():",
        *shown,
        *([f"    # and {more} more"] if more > 0 else []),
        f'    run = read_replay(HERE / "{recording.name}", retold=True)',
        f"    found = find_failure(run, {code_of(failure, other)}{level})",
        "    assert found is None, found",
        "",
    ])  # fmt: skip


def code_of(failure: Failure, other: str | None) -> str:
    """A failure as Python makes it; other: where its other level is."""
    given = []
    for each in fields(failure):  # type: ignore[arg-type]
        value = getattr(failure, each.name)
        if isinstance(value, Level):
            given.append(_loaded(str(other)))
        elif value != each.default:
            given.append(f"{each.name}={_quoted(value)}" if given else _quoted(value))
    return f"{type(failure).__name__}({', '.join(given)})"


def _quoted(value: object) -> str:
    return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"' if isinstance(value, str) else repr(value)


def _plain(failure: Failure) -> str:
    return str(failure).replace("\\", "\\\\").replace('"""', "'''")


def _loaded(place: str) -> str:
    """How a level is read: a shipped one by its name, a file as seen from the test."""
    return f'load_level("{place}")' if "." not in place else f'load_level(HERE / "{place}")'


def seen_from(path: Path, folder: Path) -> str:
    """A file as seen from a folder, with slashes."""
    return Path(os.path.relpath(path.resolve(), folder.resolve())).as_posix()
