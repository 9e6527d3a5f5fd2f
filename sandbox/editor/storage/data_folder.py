"""Where the person's own data lie."""

from pathlib import Path

import platformdirs

_APPLICATION = "spring-sandbox"


def data_folder() -> Path:
    """The folder of the person's own data: autosaves, locks, backups, recent levels, preferences."""
    return Path(platformdirs.user_data_dir(_APPLICATION, appauthor=False))
