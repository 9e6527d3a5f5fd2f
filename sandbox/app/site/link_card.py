"""Link cards: what chats and networks show of a link to a page: its title, its text, and a picture."""

import html
import io
from pathlib import Path
from urllib.parse import urlsplit

import pygame

from sandbox.app.draw.picture import crop_of, draw_picture
from sandbox.level.document.model import Level
from sandbox.level.format.writing import write_file
from sandbox.physics.snapshot import Snapshot

# A picture's size [pixels], which all who show it cut to, and how long its file is at most [bytes].
SIZE, MOST_BYTES = (1200, 630), 60_000
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
        card |= dict(zip(("og:image:width", "og:image:height"), map(str, SIZE), strict=True))
        card["twitter:card"] = "summary_large_image"
    return "".join(f'<meta {_naming(name)}="{name}" content="{html.escape(said)}">\n' for name, said in card.items())


def _naming(name: str) -> str:
    return "name" if name.startswith("twitter") else "property"


def write_card_picture(level: Level, snapshot: Snapshot, path: Path) -> None:
    """Draw a state of a level into a JPEG file. Raises OSError."""
    theme = None if level.look is None else level.look.theme
    picture = draw_picture(level, snapshot, SIZE, crop_of(level, snapshot), None, theme or "dark")
    content = _as_jpeg(picture)
    for blur in _BLURS:
        if len(content) <= MOST_BYTES:
            break
        smaller = pygame.transform.smoothscale(picture, (round(SIZE[0] * blur), round(SIZE[1] * blur)))
        content = _as_jpeg(pygame.transform.smoothscale(smaller, SIZE))
    write_file(path, content)


def _as_jpeg(picture: pygame.Surface) -> bytes:
    data = io.BytesIO()
    pygame.image.save(picture, data, "card.jpg")
    return data.getvalue()
