"""Markdown pages: Markdown files as pages of a site, with all files that they link to."""

import html
import os
import re
from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path, PurePosixPath
from urllib.parse import urlsplit

from markdown_it import MarkdownIt
from markdown_it.token import Token

from sandbox.app.site.index_page import OWN, STYLE, link_list
from sandbox.export.policy import policy
from sandbox.level.format.writing import alike, write_file
from sandbox.page.page import filled

MARKDOWN, PAGE = ".md", ".html"
# What is no letter of an address, as GitHub has it.
_NO_LETTER = re.compile(r"[^\w -]")
# Where something comes from that is no file of a site.
_SOURCE = re.compile(r"https?://[\w.-]+(:\d+)?(?=/|$)|data:")
# HTML in a document is text: whoever wrote it has no say in what a page of the site does.
_PARSER = MarkdownIt("commonmark", {"html": False}).enable("table")
# Pages that a site has anyway.
_TAKEN = ("index.html",)


class DocumentError(Exception):
    """Links that lead nowhere; faults: a line each."""

    def __init__(self, faults: list[str]) -> None:
        super().__init__(*faults)
        self.faults = faults


def documents_of(start: Path) -> dict[Path, list[Token]]:
    """A Markdown file and all that it leads to, directly or not, parsed. Raises OSError, DocumentError."""
    found: dict[Path, list[Token]] = {}
    waiting, faults = [start.resolve()], []
    while waiting:
        path = waiting.pop(0)
        if path in found:
            continue
        try:
            found[path] = _PARSER.parse(path.read_text(encoding="utf-8"))
        except UnicodeDecodeError:
            raise DocumentError([f"{path}: is no text in UTF-8"]) from None
        for token, name in _links(found[path]):
            linked = _file_at(path, str(token.attrs[name]))
            if linked is None:
                continue
            if not linked.is_file():
                faults.append(f"{path}: there is no {token.attrs[name]}")
            elif not linked.is_relative_to(start.resolve().parent):
                faults.append(f"{path}: {token.attrs[name]} lies outside of the folder of {start}")
            elif linked.suffix == MARKDOWN:
                waiting.append(linked)
    pages = [_address(path, start.resolve().parent) for path in found]
    for page in alike([*_TAKEN, *pages]):
        faults.append(f"{start}: two pages of the site would be {page}, where capitals do not count")
    if faults:
        raise DocumentError(faults)
    return found


def write_documents(documents: Mapping[Path, list[Token]], folder: Path) -> dict[str, str]:
    """Write documents as pages, with the files that they show; their addresses by their headings. Raises OSError."""
    root = next(iter(documents)).parent
    titles = {_title(path, tokens): _address(path, root) for path, tokens in documents.items()}
    for path, tokens in documents.items():
        page = folder / _address(path, root)
        page.parent.mkdir(parents=True, exist_ok=True)
        back = Path(os.path.relpath(folder, page.parent)).as_posix()
        for file in _turn(tokens, path):
            there = folder / file.relative_to(root)
            there.parent.mkdir(parents=True, exist_ok=True)
            write_file(there, file.read_bytes())
        others = {title: f"{back}/{at}" for title, at in titles.items()}
        first = {"Levels": f"{back}/index.html"} | dict(list(others.items())[:1])
        text = filled(
            "document", TITLE=html.escape(_title(path, tokens)), LINKS=link_list(first), STYLE=f"{back}/{STYLE}",
            POLICY=policy(style=OWN, img=" ".join([OWN, *_elsewhere(tokens)])),
            TEXT=_PARSER.renderer.render(tokens, _PARSER.options, {}), DOCUMENTS=link_list(others),
        )  # fmt: skip
        write_file(page, text.encode())
    return titles


def _address(path: Path, root: Path) -> str:
    return PurePosixPath(path.relative_to(root)).with_suffix(PAGE).as_posix()


def _title(path: Path, tokens: list[Token]) -> str:
    """The first heading of a document, or the name of its file."""
    headings = (inline.content for opening, inline in pairwise(tokens) if opening.type == "heading_open")
    return next(headings, path.stem)


def _links(tokens: list[Token]) -> Iterator[tuple[Token, str]]:
    """Links and pictures, each with the attribute that has its address."""
    for token in (child for each in tokens for child in each.children or ()):
        if token.type in ("link_open", "image"):
            yield token, "href" if token.type == "link_open" else "src"


def _elsewhere(tokens: list[Token]) -> list[str]:
    """Where pictures come from that lie outside of a site, as a policy names it."""
    addresses = (str(token.attrs[name]) for token, name in _links(tokens) if name == "src")
    return sorted({found[0] for found in map(_SOURCE.match, addresses) if found})


def _file_at(page: Path, address: str) -> Path | None:
    """The file that an address in a document stands for; None where it leads elsewhere, or into the document."""
    name = address.partition("#")[0]
    if not name or urlsplit(name).scheme:
        return None
    linked = page.parent / name
    return (linked if linked.is_file() or linked.suffix else linked.with_suffix(MARKDOWN)).resolve()


def _turn(tokens: list[Token], path: Path) -> list[Path]:
    """Give headings their names and links the addresses of pages; the files that are shown as they are."""
    shown = []
    for token in tokens:
        # A policy allows no styles beside those of the style sheet.
        if "style" in token.attrs:
            token.attrSet("class", str(token.attrs.pop("style")).removeprefix("text-align:"))
    for opening, inline in pairwise(tokens):
        if opening.type == "heading_open":
            opening.attrSet("id", _NO_LETTER.sub("", inline.content.strip().lower()).replace(" ", "-"))
    for token, name in _links(tokens):
        address = str(token.attrs[name])
        linked = _file_at(path, address)
        if linked is not None and linked.suffix == MARKDOWN:
            place = address.partition("#")[2]
            at = Path(os.path.relpath(linked.with_suffix(PAGE), path.parent)).as_posix()
            token.attrSet(name, f"{at}#{place}" if place else at)
        elif linked is not None:
            shown.append(linked)
    return shown
