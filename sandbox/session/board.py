"""Board: links and recordings of a folder, each run again; those that win by their level's own rules have ranks."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from sandbox.level.document.model import Level
from sandbox.level.format.writing import alike, refusal_of
from sandbox.level.reading.files import LevelError, level_data, read_level, shipped_levels
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import Redo, Undo
from sandbox.session.commands.records import ScriptLine, script_of
from sandbox.session.compare.comparison import verify
from sandbox.session.outcome import measure_of, measured, outcome, outcome_text
from sandbox.session.replay import is_recording
from sandbox.session.replay.format import level_digest
from sandbox.session.replay.link import is_link, replay_of, run_of
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.session import Session

LINKS, LEVELS = ".txt", ".json"
# What a file of links holds at most [bytes], and a name [characters].
FILE_LIMIT, NAME_LIMIT = 2**20, 60


@dataclass(frozen=True)
class BoardEntry:
    """A link or a recording; place: its file, of a link with the line; run: the link, None: the file itself."""

    place: str
    name: str
    run: str | None


@dataclass(frozen=True)
class Win:
    """An entry that wins a level.

    ticks: until it is won; value: of what the level measures, see outcome.measured; run: without what was undone, until
    the rule that wins has done what it does.
    """

    entry: BoardEntry
    stem: str
    stars: int
    ticks: int
    value: float
    run: Replay


class Board:
    """The levels of a board by stem, those that win them, and the faults of all else, one line each.

    Levels are those with a goal that are shipped or lie in the folder. Raises OSError.
    """

    def __init__(self, folder: Path) -> None:
        self.faults: list[str] = []
        self.levels: dict[str, Level] = {}
        self.paths = {path.stem: path for path in shipped_levels()}
        self._stems: dict[str, str] = {}
        for path in self.paths.values():
            self._add(path)
        for path in self._files(folder):
            if path.suffix == LEVELS:
                try:
                    self._add(path)
                except LevelError as error:
                    self.faults.append(error.faults[0])
        paths = [path for path in self._files(folder) if path.suffix != LEVELS]
        self.entries = [entry for path in paths for entry in self._entries(path)]
        self.wins: list[Win] = []
        self._seen: dict[tuple[str, int, str | None], str] = {}

    def _add(self, path: Path) -> None:
        """Add a level of which nothing is here yet. Raises LevelError."""
        level = read_level(path)
        digest, is_own = level_digest(level_data(level)), self.paths.get(path.stem) != path
        if is_own and (digest in self._stems or alike([*self.paths, path.stem])):
            raise LevelError(str(path), [("", "this level, or a file of this name, is here already")])
        if level.has_goal:
            self.levels[path.stem], self._stems[digest] = level, path.stem
        elif is_own:
            raise LevelError(str(path), [("", "no rule wins this level, so nobody can enter it")])
        self.paths[path.stem] = path

    def _files(self, folder: Path) -> list[Path]:
        """All files of a folder but hidden ones, by their names."""
        paths = sorted(path for path in folder.rglob("*") if not path.is_dir() or path.is_symlink())
        return [path for path in paths if not any(part.startswith(".") for part in path.relative_to(folder).parts)]

    def _entries(self, path: Path) -> list[BoardEntry]:
        """The entries of a file: of one of links a line each, with a name, which may be left out."""
        try:
            if path.is_symlink() or not path.is_file():
                raise ValueError("is no regular file")
            if is_recording(path):
                return [BoardEntry(str(path), path.name.partition(".")[0], None)]
            if path.suffix != LINKS or path.stat().st_size > FILE_LIMIT:
                raise ValueError(f"is neither a recording, nor a level, nor a {LINKS} of links up to 1 MiB")
            lines = [(number, line.split()) for number, line in enumerate(path.read_text("utf-8").splitlines(), 1)]
        except (OSError, ValueError) as error:
            said = "is no text in UTF-8" if isinstance(error, UnicodeDecodeError) else str(error)
            self.faults.append(f"{path}: {refusal_of(error) if isinstance(error, OSError) else said}")
            return []
        named = [(number, words[-1], " ".join(words[:-1])) for number, words in lines if words]
        return [BoardEntry(f"{path}:{number}", name or path.stem, link) for number, link, name in named]

    def judge(self, entry: BoardEntry) -> None:
        """Run an entry, and note that it wins, or why it does not enter."""
        try:
            win = self._win_of(entry)
            # Whatever was done after the win, and however it is written: the same deeds lead to the same state.
            key = win.stem, win.ticks, win.run.end_hash
            if (first := self._seen.setdefault(key, entry.place)) != entry.place:
                raise ReplayError(f"is the run of {first} once more")
        except (ReplayError, OSError) as error:
            said = error.faults[0] if isinstance(error, ReplayError) else f"cannot be read: {refusal_of(error)}"
            self.faults.append(f"{entry.place}: {said.removeprefix(f'{entry.place}: ')}")
        else:
            self.wins.append(win)

    def _win_of(self, entry: BoardEntry) -> Win:
        """An entry that wins. Raises ReplayError, OSError."""
        if len(entry.name) > NAME_LIMIT or not entry.name.isprintable():
            raise ReplayError(f"its name is longer than {NAME_LIMIT} characters, or has some that nobody sees")
        if entry.run is not None and not is_link(entry.run):
            raise ReplayError("is no link to a run: it has no #scene=")
        replay = read_replay(entry.place) if entry.run is None else replay_of(entry.run)
        stem = self._stems.get(level_digest(level_data(replay.level)))
        if stem is None:
            is_edited = any(level.name == replay.level.name for level in self.levels.values())
            raise ReplayError(f"its level is {'another edition of one' if is_edited else 'none'} of this board")
        level = self.levels[stem]
        replay = replace(replay, source=entry.place, level=level)
        found = verify(replay)
        if found is not None:
            raise ReplayError(f"its run is not what it says: {found}")
        session = _run(level, replay.script, replay.ticks)
        result, rate = outcome(level, session.world), level.settings.tick_rate
        if result is None or not result.is_won:
            raise ReplayError("does not win" if result is None else outcome_text(result, rate))
        script = replay.script
        if any(line.record["type"] in (Undo.type, Redo.type) for line in script):
            counted = [each for each in session.history.timeline if each.in_effect]
            script = script_of(counted, session.world)
        # The rule that wins does what it does in the tick after.
        script, ticks = tuple(line for line in script if line.tick < result.tick), result.tick + 1
        world = _run(level, script, ticks).world
        won, value = outcome(level, world) or result, measured(measure_of(level), world, result.tick)
        run = run_of(entry.place, level, script, ticks, state_hash(world))
        return Win(entry, stem, won.stars, result.tick, value, run)

    def ranks(self, stem: str) -> list[Win]:
        """Those that win a level, by stars, then by what the level measures, then by ticks; else in their order."""
        sign = -1.0 if measure_of(self.levels[stem]).is_most else 1.0
        wins = [win for win in self.wins if win.stem == stem]
        return sorted(wins, key=lambda win: (-win.stars, sign * win.value, win.ticks))


def _run(level: Level, script: Sequence[ScriptLine], ticks: int) -> Session:
    """A run of commands that can all be carried out, at its end."""
    session = Session(level, script=script)
    while session.tick < ticks:
        session.advance()
    session.apply_pending()
    return session


def rank_text(level: Level, win: Win) -> str:
    """What a win is ranked by, in words: "3 stars, Pushes 1, 9.90 s"."""
    measure, seconds = measure_of(level), f"{win.ticks / level.settings.tick_rate:.2f} s"
    counted = [] if measure.counter is None else [f"{measure.text} {win.value:g}"]
    return ", ".join([f"{win.stars} star{'s' * (win.stars > 1)}", *counted, seconds])


def board_lines(board: Board) -> Iterator[str]:
    """The ranks of each level that anybody has won."""
    for stem, level in board.levels.items():
        wins = board.ranks(stem)
        if wins:
            yield level.name
        for number, win in enumerate(wins, 1):
            yield f"  {number}. {win.entry.name}: {rank_text(level, win)} ({win.entry.place})"
