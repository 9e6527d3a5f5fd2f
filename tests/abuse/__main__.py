"""Every figure of this folder, each whole and in a process of its own, then which of them keep their limits.

Run by hand: python -m tests.abuse [NAME ...]. Takes hours; exit code 1 where a limit is broken, after all have run.
"""

import argparse
import os
import pkgutil
import subprocess
import sys
import time

from tests import abuse

ENDINGS = {0: "keeps its limits", 1: "BREAKS A LIMIT"}


def names() -> list[str]:
    """The scripts of this folder."""
    return sorted(module.name for module in pkgutil.iter_modules(abuse.__path__) if module.name != "__main__")


def main(arguments: list[str] | None = None) -> int:
    """Run them all, or those that are named."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", nargs="*", choices=names(), default=[])
    told = []
    for name in parser.parse_args(arguments).name or names():
        print(f"## {name}", flush=True)
        began = time.monotonic()
        quiet = os.environ | {"SDL_VIDEODRIVER": "dummy", "SDL_AUDIODRIVER": "dummy"}
        code = subprocess.run([sys.executable, "-m", f"tests.abuse.{name}", "--all"], env=quiet, check=False).returncode
        told.append((name, code, time.monotonic() - began))
    print("## in all")
    for name, code, seconds in told:
        print(f"{name:14} {ENDINGS.get(code, f'ENDED WITH {code}')} ({seconds / 60:.1f} min)")
    return int(any(code for _, code, _ in told))


if __name__ == "__main__":
    sys.exit(main())
