"""Journal: the rows of a sweep that is not whole yet, kept on the disk."""

import contextlib
import json
from pathlib import Path
from typing import Any

from sandbox.level.format.writing import write_file
from sandbox.session.sweep.grid import SweepGrid
from sandbox.session.sweep.table import table_text


class Journal:
    """The finished rows of a sweep, kept in a file beside its table until that is written.

    rows: by number; replaced: whether the file was of another level or grid, which is forgotten.
    fresh: forget what was there. Raises OSError.
    """

    def __init__(self, table: Path, grid: SweepGrid, fresh: bool = False) -> None:
        self.path = table.with_name(table.name + ".unfinished")
        self._table, self._grid = table, grid
        self.rows: dict[int, list[Any]] = {}
        self.replaced = False
        self._first = json.dumps({"level": grid.digest, "ticks": grid.ticks, "columns": dict(grid.columns),
                                  "figures": grid.figures})  # fmt: skip
        lines: list[str] = []
        if not fresh and self.path.exists():
            lines = self.path.read_text(encoding="utf-8", errors="replace").splitlines(keepends=True)
            self.replaced = bool(lines) and lines[0] != self._first + "\n"
        for line in [] if self.replaced else lines[1:]:
            # What was cut off in the middle of a line is no row.
            with contextlib.suppress(ValueError):
                number, row = json.loads(line)
                self.rows[number] = row
        self.save()

    def save(self) -> None:
        """Write the file again with all finished rows."""
        lines = [self._first, *(json.dumps([number, row]) for number, row in self.rows.items())]
        write_file(self.path, "".join(f"{line}\n" for line in lines).encode())

    def add(self, number: int, row: list[Any]) -> None:
        """Keep a row, on the disk too."""
        self.rows[number] = row
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps([number, row]) + "\n")

    def finish(self) -> None:
        """Write the table, rows in the order of the grid, and remove the journal."""
        write_file(self._table, table_text(self._grid, self.rows).encode())
        self.path.unlink(missing_ok=True)
