"""The lines of the shell that documents show, and running them as they are written."""

import contextlib
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

from platformdirs import user_cache_path

from sandbox.cli import main
from tests.support.person import DEADLINE, VirtualScreen, Visitor, stranger_environment

ROOT = Path(__file__).resolve().parents[2]
# A fenced block, also one inside a program's comment.
FENCED = re.compile(r"^([ #/]*)```sh\n(.*?)^\1```", re.DOTALL | re.MULTILINE)
# Commands that open a window, and play until it is closed.
WINDOWS = re.compile(r"^(\.venv/bin/)?sandbox( (play|edit|toy)\b.*)?$")
# Calls of the program in which the shell has nothing to do but to tell words apart.
PLAIN = re.compile(r"sandbox [^|<>&;$*`]*")


@dataclass(frozen=True)
class ShellLine:
    """A line of a fenced block, with its page (from the project's root) and number there; text: without its comment."""

    page: str
    number: int
    text: str

    @property
    def opens_a_window(self) -> bool:
        return WINDOWS.match(self.text) is not None


def pages() -> list[Path]:
    """The documents that a person reads and copies lines from."""
    found = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md"), *(ROOT / "docs" / "examples").rglob("*")]
    return sorted(path for path in found if path.suffix in (".md", ".py", ".js", ".gd"))


def lines_of(page: Path) -> Iterator[ShellLine]:
    """All lines of its fenced blocks; one that a backslash continues is one line."""
    text = page.read_text(encoding="utf-8")
    for block in FENCED.finditer(text):
        number = text.count("\n", 0, block.start(2)) + 1
        whole, begun = "", number
        for line in block[2].splitlines():
            whole += line.removeprefix(block[1]).rstrip()
            number += 1
            if whole.endswith("\\"):
                whole = whole[:-1]
                continue
            words = re.sub(r"(^|\s)#.*", "", whole).strip()
            if words:
                yield ShellLine(page.relative_to(ROOT).as_posix(), begun, words)
            whole, begun = "", number


def _environment(home: Path) -> dict[str, str]:
    """Variables of a stranger with that home: kernels that were edited here and compiled need not be once more."""
    environment = stranger_environment(home)
    cache = home / ".cache" / "spring-sandbox"
    cache.mkdir(parents=True)
    (cache / "kernels").symlink_to(user_cache_path("spring-sandbox", appauthor=False) / "kernels")
    return environment


class Reader:
    """Copies lines into a shell: in a folder with the project's files, with a home where nobody has been."""

    def __init__(self, folder: Path, screen: VirtualScreen | None) -> None:
        self.folder, self.home, self._screen = folder / "project", folder / "home", screen
        self.folder.mkdir()
        for name in ("docs", "levels", "assets"):
            shutil.copytree(ROOT / name, self.folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        for path in (*ROOT.glob("*.md"), ROOT / "LICENSE"):
            shutil.copy(path, self.folder)
        (self.folder / ".venv").symlink_to(sys.prefix, target_is_directory=True)
        programs = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
        self.environment = {**_environment(self.home), "PATH": programs}

    def fault(self, line: ShellLine) -> str | None:
        """Carry a line out; what was wrong with it."""
        carry_out = self._visit if line.opens_a_window else self._call if PLAIN.fullmatch(line.text) else self._run
        told = carry_out(line.text)
        return told and f"{line.page}:{line.number}: {line.text}\n{told}"

    def _call(self, text: str) -> str | None:
        """Call the program in this process: a start of Python takes longer than most lines."""
        said = io.StringIO()
        with (
            contextlib.redirect_stdout(said), contextlib.redirect_stderr(said), contextlib.chdir(self.folder),
            mock.patch.dict(os.environ, self.environment, clear=True),
        ):  # fmt: skip
            try:
                code: object = main(shlex.split(text)[1:])
            except SystemExit as refused:
                code = refused.code
        return f"exit code {code}\n{said.getvalue()[-2500:]}" if code else None

    def _run(self, text: str) -> str | None:
        run = subprocess.run(
            text, shell=True, env=self.environment, cwd=self.folder, capture_output=True, text=True, timeout=DEADLINE
        )
        # What a line answers by || is a difference that was looked for; a refusal says so on the standard error.
        if run.returncode == 0 and not ("||" in text and run.stderr):
            return None
        return f"exit code {run.returncode}\n{run.stdout[-500:]}{run.stderr[-2000:]}"

    def _visit(self, text: str) -> str | None:
        """Open a window in a home of its own, click into it, close it; what was wrong."""
        assert self._screen is not None
        environment = {**self.environment, **_environment(Path(tempfile.mkdtemp(dir=self.home)))}
        visitor = Visitor(self._screen, f"exec {text}", self.folder, environment)
        try:
            visitor.wait_for(" - Spring Sandbox")
            visitor.click_inside()
            visitor.leave()
        except AssertionError as error:
            return str(error)
        else:
            return None
        finally:
            visitor.end()
