"""Site: a folder of static files: a list of levels, and a page for each, which plays it at an address of its own."""

import html
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from sandbox.app.draw.colours import THEME_NAMES
from sandbox.app.draw.picture_cache import SIZE, SUFFIX, draw_at_once, keep_picture, picture_key, shipped_picture
from sandbox.app.gallery.sections import SECTIONS, GallerySection
from sandbox.app.share.playing import playable
from sandbox.export.policy import policy
from sandbox.level.document.model import Level
from sandbox.level.format.writing import write_file
from sandbox.page.page import KERNELS, MODULES, WEB, filled, linked_page_text, toy_file

# Folders of a site: pages of levels, their pictures, and the modules with the kernels.
LEVELS, PICTURES, SCRIPTS = "levels", "pictures", "sandbox"
STYLE = "site.css"
# What pages without scripts may load. To some browsers no file of a disk belongs to the page itself.
OWN = "'self' file:"


@dataclass(frozen=True)
class SiteLevel:
    """A level of a site; stem: of its files, path: of the level's own."""

    stem: str
    path: Path
    level: Level

    @property
    def address(self) -> str:
        """The stem as addresses have it."""
        return quote(self.stem)


def write_site(levels: Mapping[str, SiteLevel], folder: Path, title: str, links: Mapping[str, str]) -> Iterator[None]:
    """Write a site of levels by stem into a folder; it goes on after each level. Raises OSError.

    links: addresses of other pages of the site by what they are called.
    """
    for name in MODULES:
        write_file(_made(folder / SCRIPTS / f"{name}.js"), (WEB / f"{name}.js").read_bytes())
    write_file(folder / SCRIPTS / KERNELS.name, KERNELS.read_bytes())
    write_file(folder / STYLE, (WEB / STYLE).read_bytes())
    for each in levels.values():
        _write_level(each, folder)
        yield
    cards = "".join(_section(section, levels) for section in sections_of(levels))
    documents = f'<h2>Documents</h2><nav aria-label="Documents"><ul>{link_list(links)}</ul></nav>' if links else ""
    held_to = policy(style=OWN, img=OWN)
    text = filled("index", TITLE=html.escape(title), POLICY=held_to, LEVELS=cards, DOCUMENTS=documents)
    write_file(folder / "index.html", text.encode())


def sections_of(levels: Mapping[str, SiteLevel]) -> Sequence[GallerySection]:
    """Headings with the levels that a site has below them: those of the gallery, then all others."""
    known = {stem for section in SECTIONS for stem in section.levels}
    own = {stem: "" for stem in levels if stem not in known}
    sections = [*SECTIONS, GallerySection("Levels", "", own)]
    return [section for section in sections if set(section.levels) & set(levels)]


def link_list(links: Mapping[str, str]) -> str:
    """Links as items of a list; links: addresses by what they are called."""
    return "".join(f'<li><a href="{html.escape(at)}">{html.escape(name)}</a></li>' for name, at in links.items())


def _made(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def _write_level(each: SiteLevel, folder: Path) -> None:
    made = playable(each.level)
    write_file(_made(folder / LEVELS / f"{each.stem}.toy"), toy_file(made.content))
    page = linked_page_text(made.title, made.hints, f"{each.address}.toy", f"../{SCRIPTS}", "../index.html")
    write_file(folder / LEVELS / f"{each.stem}.html", page.encode())
    key = picture_key(each.path.read_bytes())
    for theme in THEME_NAMES:
        there, drawn = folder / PICTURES / f"{each.stem}-{theme}{SUFFIX}", shipped_picture(each.path, key, theme)
        if drawn.is_file():
            write_file(_made(there), drawn.read_bytes())
        else:
            keep_picture(draw_at_once(each.level, theme), there)


def _section(section: GallerySection, levels: Mapping[str, SiteLevel]) -> str:
    cards = "".join(_card(levels[stem], words) for stem, words in section.levels.items() if stem in levels)
    return f"<section><h2>{section.title}</h2><p>{section.line}</p><ul class=cards>{cards}</ul></section>\n"


def _card(each: SiteLevel, words: str) -> str:
    dark, light = (f"{PICTURES}/{each.address}-{theme}{SUFFIX}" for theme in ("dark", "light"))
    width, height = SIZE
    return (
        f'<li><a href="{LEVELS}/{each.address}.html"><picture><source media="(prefers-color-scheme: light)" '
        f'srcset="{light}"><img src="{dark}" alt="" width="{width}" height="{height}" loading="lazy"></picture>'
        f"<h3>{html.escape(each.level.name)}</h3><p>{html.escape(words or each.level.description)}</p></a></li>"
    )
