"""A browser for all tests of pages, where one is installed."""

from collections.abc import Iterator

import pytest

from tests.page.browser import Browser, browser_path
from tests.page.firefox import Firefox, firefox_path
from tests.support.wants import skip_without


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """A browser that runs as long as the tests of this process do."""
    path = browser_path()
    if path is None:
        skip_without("Chromium")
    made = Browser(path)
    yield made
    made.close()


@pytest.fixture(scope="session")
def firefox() -> Iterator[Firefox]:
    """Firefox, which runs as long as the tests of this process do."""
    path = firefox_path()
    if path is None:
        skip_without("Firefox")
    made = Firefox(path)
    yield made
    made.close()
