"""Finds the files that the program ships; loads none of them."""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[2]


def shipped_folder(kind: str) -> Path:
    """The folder of the shipped "levels" or "assets": in a checkout its own, else the one in the wheel."""
    checkout = _PACKAGE.parent
    if (checkout / "pyproject.toml").is_file() and (checkout / kind).is_dir():
        return checkout / kind
    return _PACKAGE / "_shipped" / kind
