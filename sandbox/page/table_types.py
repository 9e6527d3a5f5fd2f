"""Types of tables: arrays of the state and commands, for whoever checks the modules of pages by TypeScript.

python -m sandbox.page.table_types writes them.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from sandbox.page.about import is_done_by_pages
from sandbox.page.bundle import WEB
from sandbox.physics.commands.command_table import KINDS
from sandbox.physics.state import COLUMNS
from sandbox.session.commands.command import COMMAND_TYPES
from sandbox.session.commands.for_pages import table_of

FILE = WEB / "tables.d.ts"
_HEAD = (
    "// Types of the tables of Python. Made by `python -m sandbox.page.table_types`.\n"
    "import type { Kit } from './types.js';\n"
)
_ARRAYS = {
    "float64": "Float64Array", "int64": "BigInt64Array", "int32": "Int32Array", "int8": "Int8Array",
    "bool": "Uint8Array",
}  # fmt: skip


def table_types() -> str:
    """The types of all state arrays, and of the commands that pages carry out, with slots in place of names."""
    arrays = [f"  {column.name}: {_ARRAYS[np.dtype(column.dtype).name]};" for column in COLUMNS]
    return "\n".join(
        [
            _HEAD + "export interface StateArrays {",
            *arrays,
            "}",
            "",
            "export interface Commands {",
            *_commands(),
            "}",
            "",
        ]
    )


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
    FILE.write_text(table_types(), encoding="utf-8", newline="\n")
