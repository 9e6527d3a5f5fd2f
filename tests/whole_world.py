"""Run whole-world tests where what they tell of was changed: python -m tests.whole_world [options of pytest].

They take many seconds each and tell of kernels and formats alone, so other changes leave them out. What was changed is
what differs, in commits or in the working tree, from a base: from the commit that SINCE names; or where that is none,
from where this branch left main; or on main itself, from what it was half a day before. Without a base all are run.
"""

import os
import re
import subprocess
import sys

from tests.quick import ROOT, files_since, git, left_branch

# Where kernels, formats and what proves them lie, and what they are compiled with.
WATCHED = (
    "sandbox/physics/", "sandbox/app/draw/raster/", "sandbox/level/", "sandbox/session/",
    "sandbox/page/", "levels/", "tests/determinism/", "pyproject.toml",
)  # fmt: skip
# What a file of tests says in which there are such tests.
MARKS = re.compile(r"mark\.whole_world|(part|some)_and_whole")
# So much of main's time is looked at where nobody says since when [s]: what somebody pushes at once is made in hours.
LAST = 12 * 3600


def base() -> tuple[str, str]:
    """The commit to compare with, and in words which that is; an empty one where there is none."""
    since = os.environ.get("SINCE", "")
    if since and commit(since):
        return commit(since), f"{since}, which SINCE names"
    for left in filter(None, map(left_branch, ("main", "origin/main"))):
        if left != commit("HEAD"):
            return left, f"{left[:8]}, where this branch left main"
    made = "".join(git("show", "--no-patch", "--format=%ct", "HEAD"))
    found = made and "".join(git("rev-list", "-1", "--first-parent", f"--before={int(made) - LAST}", "HEAD"))
    return found, f"{found[:8]}, the last commit of half a day before"


def commit(name: str) -> str:
    """The commit of this name, empty where there is none."""
    return "".join(git("rev-parse", "--verify", "--quiet", f"{name}^{{commit}}"))


def is_watched(path: str) -> bool:
    """Whether a change of this file may change what whole-world tests find."""
    if not path.startswith("tests/"):
        return path.startswith(WATCHED)
    file = ROOT / path
    has_them = path.endswith(".py") and file.is_file() and MARKS.search(file.read_text(encoding="utf-8"))
    return path.startswith(WATCHED) or bool(has_them)


def why() -> tuple[bool, str]:
    """Whether whole-world tests are to be run, and why, in a sentence."""
    since, said = base()
    if not since:
        return True, "run: there is no commit before this one to compare with"
    changed = [*filter(is_watched, files_since(since))]
    if not changed:
        return False, f"left out: no kernel and no format differs from {said}"
    more = f" and {len(changed) - 1} more differ" if len(changed) > 1 else " differs"
    return True, f"run: {changed[0]}{more} from {said}"


def main() -> int:
    """Say whether they are run, and run them."""
    are_due, sentence = why()
    print(f"Whole-world tests are {sentence}.", flush=True)
    command = [sys.executable, "-m", "pytest", "-m", "whole_world", *sys.argv[1:]]
    return subprocess.run(command, cwd=ROOT, check=False).returncode if are_due else 0


if __name__ == "__main__":
    raise SystemExit(main())
