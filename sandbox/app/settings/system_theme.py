"""The theme that the system asks for, where it says."""

import shutil
import subprocess
import sys

from sandbox.app.draw.colours import ThemeName

# Longest wait [s] for the program that knows.
PATIENCE = 1.0
_QUESTIONS = {
    "darwin": ("defaults", "read", "-g", "AppleInterfaceStyle"),
    "linux": ("gsettings", "get", "org.gnome.desktop.interface", "color-scheme"),
}


def theme_of(chosen: str) -> ThemeName:
    """The theme that is meant by what was chosen: "dark", "light" or "system"; light where the system says nothing."""
    if chosen == "system":
        return "dark" if _is_dark() else "light"
    return "dark" if chosen == "dark" else "light"


def _is_dark() -> bool:
    if sys.platform == "win32":
        import winreg

        place = r"Software\Microsoft\Windows\CurrentVersion\Themes\Personalize"
        try:
            with winreg.OpenKey(winreg.HKEY_CURRENT_USER, place) as key:
                return not winreg.QueryValueEx(key, "AppsUseLightTheme")[0]
        except OSError:
            return False
    question = _QUESTIONS.get(sys.platform)
    if question is None or shutil.which(question[0]) is None:
        return False
    try:
        asked = subprocess.run(question, capture_output=True, text=True, timeout=PATIENCE, check=False)
    except (OSError, subprocess.SubprocessError):
        return False
    # On macOS the light one has no name.
    return "dark" in asked.stdout.casefold()
