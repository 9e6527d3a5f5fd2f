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
    """The theme that is meant by what was chosen: "dark", "light" or "system"; dark where the system says nothing."""
    if chosen == "system":
        return "light" if _is_light() else "dark"
    return "light" if chosen == "light" else "dark"


def _is_light() -> bool:
    if sys.platform == "win32":
        import winreg

        place = r"Software\Microsoft\Windows\CurrentVersion\Themes\Personalize"
        try:
            with winreg.OpenKey(winreg.HKEY_CURRENT_USER, place) as key:
                return bool(winreg.QueryValueEx(key, "AppsUseLightTheme")[0])
        except OSError:
            return False
    question = _QUESTIONS.get(sys.platform)
    if question is None or shutil.which(question[0]) is None:
        return False
    try:
        asked = subprocess.run(question, capture_output=True, text=True, timeout=PATIENCE, check=False)
    except (OSError, subprocess.SubprocessError):
        return False
    if sys.platform == "darwin":
        # Only the dark one has a name.
        return "Dark" not in asked.stdout
    return bool(asked.stdout) and "dark" not in asked.stdout
