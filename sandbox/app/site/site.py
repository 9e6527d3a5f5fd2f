"""Site: a folder of static files: a list of levels, and a page for each, which plays it at an address of its own."""

import gzip
from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path

import pygame

from sandbox.app.draw.colours import THEME_NAMES
from sandbox.app.draw.picture import run_ahead
from sandbox.app.draw.picture_cache import (
    PARTICLES,
    SECONDS,
    SUFFIX,
    draw_in_slices,
    keep_picture,
    picture_key,
    shipped_picture,
)
from sandbox.app.share.playing import playable
from sandbox.app.site.index_page import (
    LEVELS,
    PICTURES,
    SCRIPTS,
    SMALL,
    STYLE,
    IndexPage,
    SiteLevel,
    index_text,
    link_card,
    sections_of,
    write_card_picture,
)
from sandbox.level.format.slices import at_once
from sandbox.level.format.writing import write_file
from sandbox.level.hints import worded
from sandbox.page.bundle import BUNDLE
from sandbox.page.page import GZIP_LEVEL, KERNELS, MODULES, WEB, linked_page_text, toy_file
from sandbox.physics.snapshot import Snapshot


def write_site(levels: Mapping[str, SiteLevel], folder: Path, page: IndexPage) -> Iterator[None]:
    """Write a site of levels by stem into a folder; it goes on after each level. Raises OSError."""
    for name in MODULES:
        write_file(_made(folder / SCRIPTS / f"{name}.js"), (WEB / f"{name}.js").read_bytes())
    write_file(folder / SCRIPTS / BUNDLE.name, BUNDLE.read_bytes())
    kernels = gzip.compress(KERNELS.read_bytes(), GZIP_LEVEL, mtime=0)
    write_file(folder / SCRIPTS / f"{KERNELS.name}.gz", kernels)
    write_file(folder / STYLE, (WEB / STYLE).read_bytes())
    states, following = {}, _following(levels)
    for each in levels.values():
        ticks = round(SECONDS * each.level.settings.tick_rate)
        states[each.stem] = at_once(run_ahead(each.level, ticks, PARTICLES))
        _write_level(each, states[each.stem], folder, page.address, following.get(each.stem))
        yield
    write_file(folder / "index.html", index_text(levels, states, page).encode())


def _made(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def _following(levels: Mapping[str, SiteLevel]) -> dict[str, SiteLevel]:
    """By stems of levels with a goal: the next such level in the order of the list."""
    ordered = [levels[stem] for section in sections_of(levels) for stem in section.levels if stem in levels]
    asking = [each for each in ordered if each.level.goal]
    return {each.stem: after for each, after in pairwise(asking)}


def _write_level(each: SiteLevel, state: Snapshot, folder: Path, address: str | None, after: SiteLevel | None) -> None:
    made = playable(each.level, file=each.path)
    write_file(_made(folder / LEVELS / f"{each.stem}.toy"), toy_file(made.content))
    shown = link_card(made.title, worded(made.hints, "mouse"), each.page, each.card_picture, address)
    bundle = f"../{SCRIPTS}/{BUNDLE.name}"
    following = None if after is None else (f"{after.address}.html", after.level.name)
    page = linked_page_text(made.title, made.hints, f"{each.address}.toy", bundle, "../index.html", shown, following)
    write_file(folder / LEVELS / f"{each.stem}.html", page.encode())
    key = picture_key(each.path.read_bytes())
    for theme in THEME_NAMES:
        there, drawn = folder / PICTURES / f"{each.stem}-{theme}{SUFFIX}", shipped_picture(each.path, key, theme)
        if drawn.is_file():
            write_file(_made(there), drawn.read_bytes())
        else:
            keep_picture(at_once(draw_in_slices(each.level, theme)), there)
        smaller = pygame.transform.smoothscale(pygame.image.load(there), SMALL)
        keep_picture(smaller, there.with_stem(f"{there.stem}-small"))
    if address is not None:
        write_card_picture(each.level, state, folder / PICTURES / f"{each.stem}-card{SUFFIX}")
