"""axe-core, which finds what keeps people from using a page: run in a tab, on what is seen there now."""

from typing import Any

from sandbox.page.bundle import NODE_MODULES
from tests.page.browser import Tab
from tests.support.wants import skip_without

AXE = NODE_MODULES / "axe-core" / "axe.min.js"


def violations(tab: Tab) -> list[Any]:
    """Rules that the page breaks, each with the elements that break it."""
    if not AXE.exists():
        skip_without("axe-core")
    tab.evaluate(f"{AXE.read_text(encoding='utf-8')}; undefined")
    found: list[Any] = tab.evaluate(
        "axe.run().then(({ violations }) => violations.map(({ id, nodes }) => [id, nodes.map(({ html }) => html)]))"
    )
    return found
