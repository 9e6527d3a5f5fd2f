"""Failed: a test that fails with lines of its own."""


class Failed(Exception):
    """Why a test fails, a line each; shown without a traceback."""

    def __init__(self, *lines: str) -> None:
        super().__init__("\n".join(lines))
