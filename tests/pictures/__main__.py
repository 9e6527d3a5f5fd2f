"""Draws every picture of README and docs, or those of some pages: `python -m tests.pictures [gallery ...]`."""

import sys

from tests.pictures import cookbook, gallery, how_to, readme, sharing
from tests.pictures.photographer import own_home

PARTS = {
    "cookbook": cookbook.draw, "gallery": gallery.draw, "how_to": how_to.draw, "readme": readme.draw,
    "sharing": sharing.draw,
}  # fmt: skip


def main(names: list[str]) -> None:
    """Draw them."""
    for name in names or PARTS:
        with own_home():
            PARTS[name]()


if __name__ == "__main__":
    main(sys.argv[1:])
