"""Board pages: a site whose levels lead to the ranks of runs that win them, each to watch, to race and to send on."""

import html
from collections.abc import Iterator
from pathlib import Path

from sandbox.app.site.index_page import SCRIPTS, STYLE, IndexPage, SiteLevel
from sandbox.app.site.race_links import RaceLinks
from sandbox.app.site.site import write_site
from sandbox.export.policy import policy
from sandbox.level.format.writing import write_file
from sandbox.page.bundle import BUNDLE
from sandbox.page.page import filled
from sandbox.session.board import Board, rank_text
from sandbox.session.judging import Win

RANKS = "ranks"


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
