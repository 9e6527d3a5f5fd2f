"""A browser for all tests of pages, where one is installed."""

from collections.abc import Iterator

import pytest

from tests.page.browser import Browser, browser_path


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """A browser that runs as long as the tests of this process do."""
    path = browser_path()
    if path is None:
        pytest.skip("no Chromium is installed")
    made = Browser(path)
    yield made
    made.close()
