"""Board pages: a site whose levels lead to the ranks of runs that win them, each to watch, to race and to send on."""

import html
from collections.abc import Iterator
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
from sandbox.session.board import Board, Win, rank_text
from sandbox.session.replay.link import BEAT
from sandbox.session.replay.recording import ReplayError

RANKS = "ranks"


def write_board(board: Board, folder: Path, title: str) -> Iterator[None]:
    """Write the site of a board into a folder; it goes on after each level. Raises OSError."""
    levels = {stem: SiteLevel(stem, board.paths[stem], level) for stem, level in board.levels.items()}
    yield from write_site(levels, folder, IndexPage(title, {}, None, RANKS))
    (folder / RANKS).mkdir(exist_ok=True)
    for each in levels.values():
        write_file(folder / RANKS / f"{each.stem}.html", _page(each, board.ranks(each.stem)).encode())


def _page(each: SiteLevel, wins: list[Win]) -> str:
    """The page of a level's ranks, in which names are text."""
    script = filled("ranked", BUNDLE=f"../{SCRIPTS}/{BUNDLE.name}")
    rows = "".join(_row(each, number, win) for number, win in enumerate(wins, 1))
    return filled(
        "ranks", TITLE=html.escape(each.level.name), GOAL=html.escape(each.level.goal), PLAY=f"../{each.page}",
        POLICY=policy(script, script="'self'", style="'self'"), STYLE=f"../{STYLE}", SCRIPT=script,
        ROWS=rows or "<tr><td>Nobody has won it yet.</td></tr>",
    )  # fmt: skip


def _row(each: SiteLevel, number: int, win: Win) -> str:
    name = html.escape(win.entry.name)
    try:
        run = at_once(link_to(win.run, "", 0)).removeprefix("#")
    except ReplayError:
        links = "too long for a link"
    else:
        page = f"../{LEVELS}/{each.address}.html"
        race = html.escape(f"{page}#{BEAT}{quote(win.entry.name, safe='')}&{run}")
        links = (
            f'<a href="{page}#{run}">Watch</a> <a href="{race}">Race</a> '
            f'<button type="button" data-race="{race}">Send</button>'
        )
    ranked = html.escape(rank_text(each.level, win))
    return f"<tr><td>{number}</td><td><bdi>{name}</bdi></td><td>{ranked}</td><td>{links}</td></tr>\n"
