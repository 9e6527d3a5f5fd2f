"""python -m sandbox: the same as the command `sandbox`."""

import sys

from sandbox.cli import program

if __name__ == "__main__":
    sys.exit(program())
