"""pymunk_program(flat): the example that reads flat levels, with one of them inside: a program of one file."""

from sandbox.export.flat import flat_text
from sandbox.export.flat_model import FlatLevel
from sandbox.level.format.shipped import shipped_folder

READER = "read_flat_pymunk.py"
# The line of the example in whose place the level goes, and how it is run without and with one.
NO_DATA = "DATA = None  # a level that this program carries with it\n"
USAGE, OWN_USAGE = f"python {READER} LEVEL.json [SECONDS", "python THIS_FILE [SECONDS"


def pymunk_program(level: FlatLevel) -> str:
    """The program; it needs pymunk and nothing of the sandbox, prints places, and has `run` for who imports it."""
    source = (shipped_folder("docs/examples/flat") / READER).read_text(encoding="utf-8")
    lines = "\n".join(f"    {line!r}" for line in flat_text(level).splitlines())
    assert NO_DATA in source and USAGE in source
    return source.replace(USAGE, OWN_USAGE).replace(NO_DATA, f"DATA = json.loads(\n{lines}\n)\n")
