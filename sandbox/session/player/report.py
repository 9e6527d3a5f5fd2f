"""A page of all failures of a run of tests: one file, no network; each with its cause, its distances and a player."""

import html
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from sandbox.export.policy import policy
from sandbox.level.format.writing import write_file
from sandbox.session.compare.comparison import Comparison
from sandbox.session.compare.distance import TrajectoryDistance, metres
from sandbox.session.player import page

TEMPLATE = Path(__file__).with_name("report.html")
# What begins the line with the command that accepts a failure.
ACCEPT = "to accept"
# Points of a curve, at most; and its size, of which the browser makes what there is room for.
POINTS, WIDE, HIGH = 600, 1000.0, 100.0


@dataclass(frozen=True)
class ReportedFailure:
    """A test that failed. lines: the cause first; curve: HTML of its distances; player: the page of it, or ""."""

    name: str
    lines: tuple[str, ...]
    curve: str = ""
    player: str = ""

    @classmethod
    def of(
        cls, name: str, lines: Sequence[str], found: Comparison | None, watched: page.Watched = iter
    ) -> "ReportedFailure":
        """A failure with what is known of two runs that part; the run that diverged is advanced to its end."""
        if found is None:
            return cls(name, tuple(lines))
        shown = replace(page.report_page(found, watched), title="Both runs", lines=())
        rate = found.replay.level.settings.tick_rate
        curve = "" if found.distance is None else _curve(found.distance, rate)
        return cls(name, tuple(lines), curve, shown.text())

    @property
    def cause(self) -> str:
        """Why it failed, in a line."""
        return self.lines[0] if self.lines else ""

    def section(self, number: int) -> str:
        """The failure as HTML."""
        more = self.lines[1:]
        accept = [line for line in more if line.startswith(ACCEPT)]
        told = [line for line in more if line not in accept]
        commands = [[html.escape(each) for each in line.split(": ", 1)] for line in accept]
        return "\n".join([
            f'<section id="f{number}">',
            f"<h2>{html.escape(self.name)}</h2>",
            f"<pre><b>{html.escape(self.cause)}</b>\n{html.escape(chr(10).join(told))}</pre>",
            *(f'<small>{what}</small><pre class="accept">{command}</pre>' for what, command in commands),
            self.curve,
            f'<iframe loading="lazy" title="{html.escape(self.name)}" srcdoc="{html.escape(self.player)}"></iframe>'
            if self.player else "",
            "</section>",
        ])  # fmt: skip


def _curve(distance: TrajectoryDistance, rate: int) -> str:
    """The largest distance over time; of ticks that are drawn as one, the largest."""
    series = [(tick, far if math.isfinite(far) else 0.0) for tick, far in distance.series]
    most, last = max((far for _, far in series), default=0.0), max(1, distance.last)
    if not most:
        return ""
    size = -(-len(series) // POINTS)
    points = [max(series[place : place + size], key=lambda each: each[1]) for place in range(0, len(series), size)]
    drawn = " ".join(f"{WIDE * tick / last:.1f},{HIGH - HIGH * far / most:.1f}" for tick, far in points)
    words = f"how far apart: at most {metres(most)}, over {last / rate:g} s"
    return (
        f'<small>{words}</small><svg viewBox="0 0 {WIDE:g} {HIGH:g}" preserveAspectRatio="none" role="img" '
        f'aria-label="{words}"><rect width="{WIDE:g}" height="{HIGH:g}"/><polyline points="{drawn}"/></svg>'
    )


def write_report(failures: Sequence[ReportedFailure], tests: int, path: Path) -> str:
    """Write the page of the failures among so many tests; a line that says what is in it. Raises OSError."""
    title = f"{len(failures)} of {tests} tests failed" if failures else f"All {tests} tests passed"
    listed = "".join(
        f'<li><a href="#f{number}">{html.escape(each.name)}</a> {html.escape(each.cause)}</li>'
        for number, each in enumerate(failures)
    )
    sections = "\n".join(each.section(number) for number, each in enumerate(failures))
    text = TEMPLATE.read_text(encoding="utf-8").replace("@TITLE@", title)
    allowed = policy(text, page.TEMPLATE.read_text(encoding="utf-8"), img="data:")
    before, after = text.replace("@POLICY@", allowed).split("@CONTENT@")
    path.parent.mkdir(parents=True, exist_ok=True)
    write_file(path, f"{before}<ol>{listed}</ol>\n{sections}{after}".encode())
    return f"{path}: {title}"
