"""Prints the slowest malformed levels and those that take the most memory: `python tests/bench/malformed.py`."""

import itertools
import sys
import time
import tracemalloc
from pathlib import Path

from sandbox.level.reading.files import LevelError, parse_level

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from tests.support.enormous_levels import ENORMOUS
from tests.support.malformed_levels import small

SHOWN = 15


def refuse(data: bytes) -> str:
    """First line of the refusal."""
    try:
        parse_level(data, "x.json")
    except LevelError as error:
        return error.faults[0]
    return "ACCEPTED"


def main() -> None:
    """Refuse every malformed level twice: once for time, once for memory, whose tracing slows it down."""
    rows = []
    for name, data in itertools.chain(small(), *(make() for make in ENORMOUS)):
        start = time.perf_counter()
        line = refuse(data)
        seconds = time.perf_counter() - start
        tracemalloc.start()
        refuse(data)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        rows.append((seconds, peak, name, len(data), line))
    print(f"{len(rows)} malformed levels, {sum(row[0] for row in rows):.1f} s in all")
    for title, column in (("slowest", 0), ("most memory", 1)):
        print(f"\n{title}:")
        for seconds, peak, name, size, line in sorted(rows, key=lambda row: -row[column])[:SHOWN]:
            print(
                f"  {seconds * 1000:8.1f} ms {peak / 2**20:7.1f} MiB {size / 2**20:6.2f} MiB file  {name}: {line[:110]}"
            )


if __name__ == "__main__":
    main()
