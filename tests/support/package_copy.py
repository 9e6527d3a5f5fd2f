"""A copy of the package, to be changed and imported by processes of its own."""

import shutil
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2] / "sandbox"


def copy_of_the_package(folder: Path) -> Path:
    """The package in a folder, with byte code: else each process would compile every module."""
    return Path(shutil.copytree(PACKAGE, folder / "sandbox", ignore=_unwanted))


def _unwanted(folder: str, names: list[str]) -> set[str]:
    return shutil.ignore_patterns("_shipped", "*.pyc.*")(folder, names)
