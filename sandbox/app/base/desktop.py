"""What the system around the window does: pictures on its clipboard, folders in its file manager."""

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Generator
from pathlib import Path

import pygame

# How long a tool of the system may take [s].
PATIENCE = 8.0
_POWERSHELL = (
    "Add-Type -AssemblyName System.Windows.Forms, System.Drawing;"
    "$picture = [System.Drawing.Image]::FromFile($env:SANDBOX_PICTURE);"
    "[System.Windows.Forms.Clipboard]::SetDataObject($picture, $true)"
)
_APPLESCRIPT = 'set the clipboard to (read (POSIX file (system attribute "SANDBOX_PICTURE")) as «class PNGf»)'


def _clipboard_tool() -> tuple[list[str], bool] | None:
    """The command that puts a PNG on the clipboard, and whether it reads it as its input; None where there is none."""
    if sys.platform == "win32":
        choices = [(["powershell", "-NoProfile", "-STA", "-Command", _POWERSHELL], False)]
    elif sys.platform == "darwin":
        choices = [(["osascript", "-e", _APPLESCRIPT], False)]
    else:
        choices = [(["xclip", "-selection", "clipboard", "-t", "image/png"], True)]
        if os.environ.get("WAYLAND_DISPLAY"):
            choices.insert(0, (["wl-copy", "--type", "image/png"], True))
    return next((choice for choice in choices if shutil.which(choice[0][0])), None)


def copying_picture(png: Path) -> Generator[None, None, bool]:
    """Put the picture of a PNG file on the system's clipboard, in slices; in the end whether a tool there did it."""
    tool = _clipboard_tool()
    if tool is None:
        return False
    command, reads = tool
    try:
        with open(png if reads else os.devnull, "rb") as source:
            # What a tool leaves behind to serve the clipboard must not keep pipes of ours open.
            running = subprocess.Popen(
                command, stdin=source, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                env={**os.environ, "SANDBOX_PICTURE": str(png)},
            )  # fmt: skip
    except OSError:
        return False
    end = time.monotonic() + PATIENCE
    while running.poll() is None:
        if time.monotonic() > end:
            running.kill()
            running.wait()
            return False
        yield
    return running.returncode == 0


def copy_text(text: str) -> bool:
    """Put a text on the system's clipboard; whether it took it."""
    try:
        pygame.scrap.put_text(text)
    except pygame.error:
        return False
    return True


def copied_text() -> str:
    """The text on the system's clipboard; nothing where there is none."""
    try:
        return pygame.scrap.get_text() if pygame.scrap.has_text() else ""
    except pygame.error:
        return ""


def open_path(path: Path) -> bool:
    """Open a folder in the system's file manager, or a file in what the system has for it; whether there is that."""
    if sys.platform == "win32":
        try:
            os.startfile(path)
        except OSError:  # no program has its kind
            return False
        return True
    opener = shutil.which("open" if sys.platform == "darwin" else "xdg-open")
    if opener is None:
        return False
    try:
        subprocess.Popen(
            [opener, str(path)], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            start_new_session=True,
        )  # fmt: skip
    except OSError:
        return False
    return True
