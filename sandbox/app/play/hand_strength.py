"""The strength of the hand, remembered from run to run."""

from sandbox.editor.storage.preferences import preference, set_preference
from sandbox.tools.drag import STRENGTHS

# Under what it is remembered.
HAND = "hand"


def kept_strength(otherwise: str) -> str:
    """The strength that was chosen last, or another where none was."""
    kept = preference(HAND)
    return kept if isinstance(kept, str) and kept in STRENGTHS else otherwise


def keep_strength(name: str) -> None:
    """Remember a strength for later runs."""
    set_preference(HAND, name)


def next_strength(name: str) -> tuple[str, str]:
    """The strength after one in their order, and a line about it."""
    names = list(STRENGTHS)
    name = names[(names.index(name) + 1) % len(names)]
    return name, f"Hand: {name}, at most {STRENGTHS[name] / 10.0:g} times the weight of what it holds."
