"""What a board is for readers: a site whose levels lead to the ranks of runs that win them, and a comment in Markdown.

Each run has links to watch it and to race it. In a comment no name is markup, a mention or a link.
"""

import html
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from urllib.parse import quote

from sandbox.app.share.runs_for_pages import link_to
from sandbox.app.site.index_page import LEVELS, SCRIPTS, STYLE, IndexPage, SiteLevel
from sandbox.app.site.site import write_site
from sandbox.export.policy import policy
from sandbox.level.format.slices import at_once
from sandbox.level.format.writing import write_file
from sandbox.page.bundle import BUNDLE
from sandbox.page.page import filled
from sandbox.session.board import Board, rank_text
from sandbox.session.judging import Win
from sandbox.session.replay.link import BEAT
from sandbox.session.replay.recording import ReplayError

RANKS = "ranks"
# What a comment on GitHub may hold is some more [characters].
LIMIT = 60_000


class RaceLinks:
    """Links to wins on a site; site: its address, or where it lies from a page of it."""

    def __init__(self, site: str) -> None:
        self._site = site.rstrip("/")
        self._runs: dict[str, str | None] = {}

    def watch(self, win: Win) -> str | None:
        """Where a win is seen; None: it is too long for a link."""
        return self._link(win, "")

    def race(self, win: Win) -> str | None:
        """Where a win is raced."""
        return self._link(win, f"{BEAT}{quote(win.entry.name, safe='')}&")

    def _link(self, win: Win, before: str) -> str | None:
        place = win.entry.place
        if place not in self._runs:
            try:
                self._runs[place] = at_once(link_to(win.run, "", 0)).removeprefix("#")
            except ReplayError:
                self._runs[place] = None
        run = self._runs[place]
        return None if run is None else f"{self._site}/{LEVELS}/{quote(win.stem)}.html#{before}{run}"


def write_board(board: Board, folder: Path, title: str, address: str | None) -> Iterator[None]:
    """Write the site of a board into a folder; it goes on after each level. Raises OSError.

    address: absolute, where the site will be; None: unknown, and links lead from page to page.
    """
    links = RaceLinks(address or "..")
    levels = {stem: SiteLevel(stem, board.paths[stem], level) for stem, level in board.levels.items()}
    ranks = {stem: board.ranks(stem) for stem in levels}
    leaders = {stem: _ranked(levels[stem], wins[0]) for stem, wins in ranks.items() if wins}
    yield from write_site(levels, folder, IndexPage(title, {}, address, RANKS, leaders))
    (folder / RANKS).mkdir(exist_ok=True)
    for stem, each in levels.items():
        write_file(folder / RANKS / f"{stem}.html", _page(each, ranks[stem], links).encode())


def _page(each: SiteLevel, wins: list[Win], links: RaceLinks) -> str:
    """The page of a level's ranks, in which names are text."""
    script = filled("ranked", BUNDLE=f"../{SCRIPTS}/{BUNDLE.name}")
    rows = "".join(_row(each, number, win, links) for number, win in enumerate(wins, 1))
    return filled(
        "ranks", TITLE=html.escape(each.level.name), GOAL=html.escape(each.level.goal), PLAY=f"../{each.page}",
        POLICY=policy(script, script="'self'", style="'self'"), STYLE=f"../{STYLE}", SCRIPT=script,
        ROWS=rows or "<tr><td>Nobody has won it yet.</td></tr>",
    )  # fmt: skip


def _row(each: SiteLevel, number: int, win: Win, links: RaceLinks) -> str:
    watch, race = (html.escape(link or "") for link in (links.watch(win), links.race(win)))
    shown = (
        f'<a href="{watch}">Watch</a> <a href="{race}">Race</a> <button type="button" data-race="{race}">Send</button>'
    )
    cells = "".join(f"<td>{cell}</td>" for cell in (*_ranked(each, win), shown if watch else "too long for a link"))
    return f"<tr><td>{number}</td>{cells}</tr>\n"


def _ranked(each: SiteLevel, win: Win) -> tuple[str, str]:
    """A name and what it is ranked by, as markup."""
    return f"<bdi>{html.escape(win.entry.name)}</bdi>", html.escape(rank_text(each.level, win))


def comment_text(board: Board, faults: Sequence[str], links: RaceLinks | None) -> str:
    """Who wins, and the faults, a line each; links: with which wins can be raced, as far as a comment has room."""
    lines = list(_lines(board, faults, links))
    left = LIMIT - sum(len(line) + 1 for line, _ in lines)
    text = ""
    for number, (line, link) in enumerate(lines):
        if len(text) + len(line) > LIMIT - 100:
            return f"{text}\n{len(lines) - number} lines more\n"
        is_room = len(link) <= left
        left -= len(link) * is_room
        text += line + link * is_room + "\n"
    return text


def _lines(board: Board, faults: Sequence[str], links: RaceLinks | None) -> Iterator[tuple[str, str]]:
    """Lines, each with a link that may follow it."""
    yield f"{len(board.wins)} of {len(board.entries)} entries win.", ""
    for stem, level in board.levels.items():
        wins = board.ranks(stem)
        if wins:
            yield f"\n**{_code(level.name)}**\n", ""
        for number, win in enumerate(wins, 1):
            link = None if links is None else links.race(win)
            said = f"{number}. {_code(win.entry.name)}: {_code(rank_text(level, win))}"
            yield said, f", [race it](<{link}>)" if link else ""
    if faults:
        yield "\nWhat does not enter:\n", ""
    for fault in faults:
        yield f"- {_code(fault)}", ""


def _code(text: str) -> str:
    """A line as code, whatever it holds."""
    marks = "`" * (1 + max(map(len, re.findall("`+", text)), default=0))
    return f"{marks} {text} {marks}"
