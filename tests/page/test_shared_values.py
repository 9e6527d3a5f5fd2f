"""Pages go by the values that the window goes by."""

import re

from sandbox.app.site.shared_values import MODULE, as_module, shared_values
from sandbox.page.page import WEB


def test_the_module_of_shared_values_is_that_of_the_window() -> None:
    assert MODULE.read_text(encoding="utf-8") == as_module(shared_values()), "values were changed: run `make bundle`"


def test_pages_go_by_every_value_that_is_shared() -> None:
    whole = "".join(path.read_text(encoding="utf-8") for path in WEB.glob("*.js") if path != MODULE)
    unused = [
        f"{subject}.{name}"
        for subject, values in shared_values().items()
        for name in values
        if not re.search(rf"\b{subject}\.{name}\b|\b{name}\b[^;]*\}} = {subject}\b", whole)
    ]
    assert unused == []
