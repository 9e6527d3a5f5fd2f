"""`sandbox schema`."""

import argparse
import json

from sandbox.cli.command import Commands, add_command
from sandbox.cli.inputs import EXIT_OK


def add(commands: Commands) -> None:
    """The command."""
    add_command(commands, "schema", print_schema, "print the JSON Schema of level files")


def print_schema(options: argparse.Namespace) -> int:
    """Print the schema."""
    from sandbox.level.document.schema import schema

    print(json.dumps(schema(), indent=2))
    return EXIT_OK
