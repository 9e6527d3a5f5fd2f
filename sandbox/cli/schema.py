"""`sandbox schema`."""

import json
from dataclasses import dataclass

from sandbox.cli.base.command import Subcommand
from sandbox.cli.base.inputs import EXIT_OK


@dataclass(frozen=True)
class SchemaOptions:
    """None."""


def print_schema(options: SchemaOptions) -> int:
    """Print the schema."""
    from sandbox.level.document.schema import schema

    print(json.dumps(schema(), indent=2))
    return EXIT_OK


COMMAND = Subcommand("schema", "print the JSON Schema of level files", SchemaOptions, print_schema)
