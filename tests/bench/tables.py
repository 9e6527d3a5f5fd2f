"""Measures all tables of docs/benchmarks.md anew, in one run, and writes them into it, with the day and the machine.

Run by hand, with the extra `bench`, on a machine that does nothing else: python -m tests.bench.tables [heading ...].
It takes half an hour. With headings it measures the tables below those alone, and leaves day and machine as they are.
"""

import datetime
import os
import platform
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "benchmarks.md"
# Headings of the page, and what prints the table below each.
PROGRAMS = {
    "Beside other engines": ["tests.bench.peers"],
    "One tick of small scenes": ["tests.bench.step_ratio"],
    "Joint grid": ["tests.bench.joint_grid"],
    "The same rope after a second": ["tests.bench.strip", "docs/readme/engines.png"],
    "Large bodies and heaps": ["tests.bench.large"],
}
RUN = re.compile(r"^One run of .*?:$", re.MULTILINE | re.DOTALL)


def table_of(printed: str) -> str:
    """The Markdown table in what a program prints.

    Raises:
        ValueError: there is none.
    """
    rows = [line for line in printed.splitlines() if line.startswith("|")]
    if len(rows) < 3:
        raise ValueError(f"no table: {printed.strip()[-200:]!r}")
    return "\n".join(rows)


def with_table(page: str, heading: str, table: str) -> str:
    """The page with a table in the place of the first one below a heading.

    Raises:
        ValueError: the page has no such heading, or no table below it.
    """
    pattern = re.compile(rf"(^## {re.escape(heading)}\n(?:(?!## |\|).*\n)*)((?:\|.*\n)+)", re.MULTILINE)
    changed, count = pattern.subn(lambda found: f"{found[1]}{table}\n", page)
    if count != 1:
        raise ValueError(f"no table below {heading!r}")
    return changed


def machine() -> str:
    """The day and the machine, in words."""
    cpu = Path("/proc/cpuinfo")
    names = re.findall(r"model name\s*: (.*)", cpu.read_text()) if cpu.is_file() else []
    name = names[0] if names else platform.processor() or platform.machine()
    return (
        f"One run of {datetime.date.today()}, Python {platform.python_version()}, {os.cpu_count()} processors ({name}):"
    )


def main() -> int:
    """Measure and write; 1 where a program prints no table or a heading is none of the page's."""
    wanted = sys.argv[1:] or list(PROGRAMS)
    if unknown := [heading for heading in wanted if heading not in PROGRAMS]:
        print(f"no such heading: {', '.join(unknown)}; there are: {', '.join(PROGRAMS)}", file=sys.stderr)
        return 1
    failed = False
    for heading in wanted:
        print(f"{heading} ...", flush=True)
        run = subprocess.run([sys.executable, "-m", *PROGRAMS[heading]], cwd=ROOT, capture_output=True, text=True)
        try:
            # Read again each time: a run of half an hour shall not undo what is written meanwhile.
            PAGE.write_text(with_table(PAGE.read_text(), heading, table_of(run.stdout)))
        except ValueError as error:
            print(f"{heading}: {error} {run.stderr.strip()[-200:]}", file=sys.stderr)
            failed = True
    if not sys.argv[1:] and not failed:
        PAGE.write_text(RUN.sub(machine(), PAGE.read_text(), count=1))
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
