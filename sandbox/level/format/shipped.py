"""Where what is shipped is found; loads nothing."""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[2]


def shipped_folder(kind: str) -> Path:
    """Folder of the shipped "levels" or "assets": the checkout's own where there is one, else the wheel's."""
    checkout = _PACKAGE.parent
    if (checkout / "pyproject.toml").is_file() and (checkout / kind).is_dir():
        return checkout / kind
    return _PACKAGE / "_shipped" / kind
