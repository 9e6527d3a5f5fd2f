"""Board: links and recordings of a folder, each run again; those that win by their level's own rules have ranks."""

from collections.abc import Generator
from pathlib import Path

from sandbox.level.document.model import Level
from sandbox.level.format.writing import alike, refusal_of
from sandbox.level.reading.files import LevelError, level_data, read_level, shipped_levels
from sandbox.session.judging import BoardEntry, BoardLevel, Win, judged
from sandbox.session.outcome import measure_of
from sandbox.session.replay import is_recording
from sandbox.session.replay.format import level_digest
from sandbox.session.worker_pool import done_in_order

LINKS, LEVELS = ".txt", ".json"
# What a file of links holds at most [bytes].
FILE_LIMIT = 2**20


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
        """All files of a folder but hidden ones, by their names, in one order on every system."""
        names = {path.relative_to(folder).parts: path for path in folder.rglob("*")}
        shown = [parts for parts in sorted(names) if not any(part.startswith(".") for part in parts)]
        return [names[parts] for parts in shown if not names[parts].is_dir() or names[parts].is_symlink()]

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

    def judge(self, processes: int, limit: float) -> Generator[None, None, None]:
        """Run all entries again, so many at a time, and note who wins, and why others do not enter; goes on after each.

        limit: time of the processor that each has [s]. Raises OSError where a process is gone before it has answered.
        """
        levels = {digest: BoardLevel(self.paths[stem], self.levels[stem].name) for digest, stem in self._stems.items()}
        tasks = [(entry, levels, limit) for entry in self.entries]
        for found in done_in_order(judged, tasks, processes):
            if isinstance(found, Win):
                self._enter(found)
            else:
                self.faults.append(found)
            yield

    def _enter(self, win: Win) -> None:
        """Note a win, but not that of the same commands twice."""
        # Whatever was done after the win, and however it is written: the same commands lead to the same state.
        first = self._seen.setdefault((win.stem, win.ticks, win.run.end_hash), win.entry.place)
        if first == win.entry.place:
            self.wins.append(win)
        else:
            self.faults.append(f"{win.entry.place}: is the run of {first} once more")

    def ranks(self, stem: str) -> list[Win]:
        """Those that win a level, by stars, then by what the level measures, then by ticks; else in their order."""
        sign = -1.0 if measure_of(self.levels[stem]).is_most else 1.0
        wins = [win for win in self.wins if win.stem == stem]
        return sorted(wins, key=lambda win: (-win.stars, sign * win.value, win.ticks))


def rank_text(level: Level, win: Win) -> str:
    """What a win is ranked by, in words: "3 stars, Pushes 1, 9.90 s"."""
    measure, seconds = measure_of(level), f"{win.ticks / level.settings.tick_rate:.2f} s"
    counted = [] if measure.counter is None else [f"{measure.text} {win.value:g}"]
    return ", ".join([f"{win.stars} star{'s' * (win.stars > 1)}", *counted, seconds])
