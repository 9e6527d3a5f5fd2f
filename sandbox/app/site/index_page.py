"""Index page: the list of a site's levels, with a toy at its top, and what plays each level as a preview."""

import html
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import quote, urlsplit

import pygame

from sandbox.app.draw.camera import Box, Camera
from sandbox.app.draw.picture import crop_of, draw_picture, particles_of, view_of
from sandbox.app.draw.picture_cache import SIZE, SUFFIX
from sandbox.app.gallery.sections import SECTIONS, GallerySection
from sandbox.export.policy import policy
from sandbox.level.document.model import Level
from sandbox.level.format.slices import at_once
from sandbox.level.format.writing import write_file
from sandbox.page.bundle import BUNDLE
from sandbox.page.page import COMPILING, ICON, KERNELS, filled, hint_markup
from sandbox.physics.snapshot import Snapshot
from sandbox.session.solution import known_solution

# Folders of a site: pages of levels, their pictures, and the modules with the kernels.
LEVELS, PICTURES, SCRIPTS = "levels", "pictures", "sandbox"
STYLE = "site.css"
# Beside pictures in the size of the gallery's there are such [pixels], for screens of one pixel to a pixel of a page.
SMALL = (384, 216)
# What pages may load that are read from a disk too. To some browsers no file of a disk belongs to the page itself.
OWN = "'self' file:"
# The level at the top, where the site has it: light, it goes on for half a minute, and there is something to pull at.
HERO = "trampoline"
WORDS = "Springs, jelly, bridges and machines that play in your browser: drag, cut, and set Cs and Cd."
# Why nothing plays where the list is opened as a file.
FROM_DISK = "From a disk browsers load no modules, so nothing plays here. Put the whole site on a web server."
# How wide a picture is shown, in the style sheet's words.
SHOWN = "(max-width: 560px) 92vw, 290px"
# How much more of the height is shown at the top of the page above and below what is there at first.
ROOM = 0.45
# Digits of boxes [m].
DIGITS = 2


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

    @property
    def page(self) -> str:
        """The address of the level's page in the site."""
        return f"{LEVELS}/{self.address}.html"

    @property
    def toy(self) -> str:
        """The address of the page that plays the level."""
        return f"{LEVELS}/{self.address}.toy"

    @property
    def card_picture(self) -> str:
        """The address of the picture of links to its page."""
        return f"{PICTURES}/{self.address}-card{SUFFIX}"


@dataclass(frozen=True)
class IndexPage:
    """What the list of levels says beside them; links: addresses of other pages of the site by what they are called.

    address: absolute, where the site will be; None: unknown. opened: the folder of the pages that levels lead to.
    leaders: by stems of levels, who leads and by what, as markup.
    """

    title: str
    links: Mapping[str, str]
    address: str | None
    opened: str = LEVELS
    leaders: Mapping[str, tuple[str, str]] = field(default_factory=dict)


def index_text(levels: Mapping[str, SiteLevel], states: Mapping[str, Snapshot], page: IndexPage) -> str:
    """The page of levels by stem, each in a state as pictures show it."""
    sections = sections_of(levels)
    words = {stem: said or levels[stem].level.description for each in sections for stem, said in each.levels.items()
             if stem in levels}  # fmt: skip
    hero = levels[HERO if HERO in words else next(iter(words))]
    link = '<h2>Documents</h2><nav aria-label="Documents"><ul>{}</ul></nav>'
    script = filled("listed", BUNDLE=f"./{SCRIPTS}/{BUNDLE.name}")
    return filled(
        "index", TITLE=html.escape(page.title), WORDS=WORDS, SCRIPT=script,
        POLICY=policy(script, script=f"'self' {COMPILING}", connect="'self'", style=OWN, img=f"{OWN} {ICON}"),
        SHOWN=link_card(page.title, WORDS, "", hero.card_picture, page.address),
        PRELOADS=_preloads(hero),
        HERO=_hero(hero, states[hero.stem], words[hero.stem]),
        LEVELS="".join(_section(each, levels, states, words, page) for each in sections),
        DOCUMENTS=link.format(link_list(page.links)) if page.links else "",
    )  # fmt: skip


def sections_of(levels: Mapping[str, SiteLevel]) -> Sequence[GallerySection]:
    """Headings with the levels that a site has below them: those of the gallery, then all others."""
    known = {stem for section in SECTIONS for stem in section.levels}
    own = {stem: "" for stem in levels if stem not in known}
    sections = [*SECTIONS, GallerySection("Levels", "", own)]
    return [section for section in sections if set(section.levels) & set(levels)]


def link_list(links: Mapping[str, str]) -> str:
    """Links as items of a list; links: addresses by what they are called."""
    return "".join(f'<li><a href="{html.escape(at)}">{html.escape(name)}</a></li>' for name, at in links.items())


def _preloads(hero: SiteLevel) -> str:
    """Links that let the toy at the top load all its files at once."""
    files = f"{SCRIPTS}/{KERNELS.name}.gz", hero.toy
    return "".join(f'<link rel="preload" as="fetch" crossorigin href="{at}">\n' for at in files)


def _hero(each: SiteLevel, state: Snapshot, words: str) -> str:
    name = html.escape(each.level.name)
    return (
        f'<section id="hero" aria-label="A toy to begin with" data-toy="{each.toy}" '
        f'data-view="{_numbers(_around(each.level, state))}">{_picture(each)}'
        f'<canvas tabindex="0" role="application" aria-label="{name}. N goes to the next thing, arrows move the '
        f'cursor, Enter takes what is there, Space pauses."></canvas>'
        f'<button type="button" hidden><svg viewBox="0 0 24 24"><path d=""/></svg></button>'
        f'<p><a href="{each.page}">{name}</a> <span>{hint_markup(words)}</span></p>'
        f'<p id="why" hidden>{FROM_DISK}</p></section>\n'
    )


def _section(
    section: GallerySection, levels: Mapping[str, SiteLevel], states: Mapping[str, Snapshot], words: Mapping[str, str],
    page: IndexPage,
) -> str:  # fmt: skip
    cards = "".join(_card(levels[stem], states[stem], words[stem], page) for stem in section.levels if stem in levels)
    return f"<section><h2>{section.title}</h2><p>{section.line}</p><ul class=cards>{cards}</ul></section>\n"


def _card(each: SiteLevel, state: Snapshot, words: str, page: IndexPage) -> str:
    seen = Camera(viewport=(0, 0, *SIZE)).picture_of(crop_of(each.level, state))
    leads = "<p class=leads>{} leads: {}</p>".format(*page.leaders[each.stem]) if each.stem in page.leaders else ""
    return (
        f'<li><a href="{page.opened}/{each.address}.html" data-toy="{each.toy}" data-view="{_numbers(seen)}">'
        f"{_picture(each, 'data-')}"
        f"<h3>{html.escape(each.level.name)}</h3><p>{hint_markup(words)}</p>{_solved(each)}{leads}</a></li>"
    )


def _solved(each: SiteLevel) -> str:
    """What the solution beside a level's file says; "" where none is known to win."""
    known = at_once(known_solution(each.level, each.path))
    return f"<p class=solved>{html.escape(known[1])}</p>" if known else ""


def _picture(each: SiteLevel, before: str = "") -> str:
    """The picture of a level; before: what stands before the names of its addresses until a script fetches it."""
    names = [f"{PICTURES}/{each.address}-{theme}" for theme in ("dark", "light")]
    dark, light = (f"{name}-small{SUFFIX} {SMALL[0]}w, {name}{SUFFIX} {SIZE[0]}w" for name in names)
    return (
        f'<picture><source media="(prefers-color-scheme: light)" {before}srcset="{light}" sizes="{SHOWN}">'
        f'<img {before}src="{names[0]}{SUFFIX}" {before}srcset="{dark}" sizes="{SHOWN}" alt="" '
        f'width="{SIZE[0]}" height="{SIZE[1]}"></picture>'
    )


def _around(level: Level, state: Snapshot) -> Box:
    """The box [m] of what moves at first, with margins above and below, as far as the level is shown at all."""
    left, low, right, high = particles_of(state)
    _, bottom, _, top = view_of(level, state)
    margin = ROOM * (high - low)
    return left, max(low - margin, bottom), right, min(high + margin, top)


def _numbers(box: Box) -> str:
    return ",".join(f"{value:.{DIGITS}f}" for value in box)


# A picture's size [pixels], which all who show it cut to, and how long its file is at most [bytes].
CARD_SIZE, MOST_BYTES = (1200, 630), 60_000
# A picture of a longer file is blurred by one step after the other, until it fits.
_BLURS = (0.85, 0.7, 0.6, 0.5, 0.4, 0.3)


def is_address(text: str) -> bool:
    """Whether a text is where a site may be: an absolute address without a query or a place in the page."""
    parts = urlsplit(text)
    return parts.scheme in ("http", "https") and bool(parts.netloc) and not (parts.query or parts.fragment)


def link_card(title: str, words: str, page: str, picture: str, address: str | None) -> str:
    """The elements of a page's head; page, picture: quoted addresses in the site, which is at an absolute address.

    address: without one what asks for absolute addresses is left out.
    """
    card = {"og:type": "website", "og:title": title, "og:description": words}
    if address is not None:
        root = address.rstrip("/")
        card |= {"og:url": f"{root}/{page}", "og:image": f"{root}/{picture}", "og:image:alt": title}
        card |= dict(zip(("og:image:width", "og:image:height"), map(str, CARD_SIZE), strict=True))
        card["twitter:card"] = "summary_large_image"
    return "".join(f'<meta {_naming(name)}="{name}" content="{html.escape(said)}">\n' for name, said in card.items())


def _naming(name: str) -> str:
    return "name" if name.startswith("twitter") else "property"


def write_card_picture(level: Level, snapshot: Snapshot, path: Path) -> None:
    """Draw a state of a level into a JPEG file. Raises OSError."""
    theme = None if level.look is None else level.look.theme
    picture = draw_picture(level, snapshot, CARD_SIZE, crop_of(level, snapshot), None, theme or "dark")
    content = _as_jpeg(picture)
    for blur in _BLURS:
        if len(content) <= MOST_BYTES:
            break
        smaller = pygame.transform.smoothscale(picture, (round(CARD_SIZE[0] * blur), round(CARD_SIZE[1] * blur)))
        content = _as_jpeg(pygame.transform.smoothscale(smaller, CARD_SIZE))
    write_file(path, content)


def _as_jpeg(picture: pygame.Surface) -> bytes:
    data = io.BytesIO()
    pygame.image.save(picture, data, "card.jpg")
    return data.getvalue()
