"""Board comment: what a board says, in Markdown, of which no name is markup, a mention or a link."""

import re
from collections.abc import Iterator, Sequence

from sandbox.app.site.race_links import RaceLinks
from sandbox.session.board import Board, rank_text

# What a comment on GitHub may hold is some more [characters].
LIMIT = 60_000


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
