"""A browser for all tests of pages, where one is installed."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from filelock import FileLock

from sandbox.cli import main
from tests.page.browser import Browser, browser_path
from tests.page.firefox import Firefox, firefox_path
from tests.page.levels import level_page
from tests.page.opened import opened
from tests.page.site_server import AT
from tests.support.wants import skip_without

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """A browser that runs as long as the tests of this process do."""
    path = browser_path()
    if path is None:
        skip_without("Chromium")
    made = Browser(path)
    # As long as it is open, no other page has to compile kernels.
    opened(made, tmp_path_factory.mktemp("kept"), level_page("rope")).evaluate("page.toy.pause()")
    made.keep()
    yield made
    made.close()


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The whole site, as `make site` writes it, made once for the tests of all processes: nobody changes it."""
    own = tmp_path_factory.getbasetemp()
    folder = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "site"
    made = folder.with_suffix(".made")
    with FileLock(folder.with_suffix(".lock")):
        if not made.exists():
            assert main(["site", "--document", str(ROOT / "README.md"), "--address", AT, "-o", str(folder)]) == 0
            made.touch()
    return folder


@pytest.fixture(scope="session")
def firefox() -> Iterator[Firefox]:
    """Firefox, which runs as long as the tests of this process do."""
    path = firefox_path()
    if path is None:
        skip_without("Firefox")
    made = Firefox(path)
    yield made
    made.close()
