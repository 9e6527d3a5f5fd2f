"""What a person shares of a run: pictures and films of its last seconds."""

import os

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
