"""Sentences: what is said to a person, from texts that name a fault in few words."""

from collections.abc import Sequence


def capitalised(text: str) -> str:
    """A text with a capital letter at its beginning."""
    return f"{text[:1].upper()}{text[1:]}"


def sentence(text: object) -> str:
    """A fault as a sentence."""
    line = capitalised(str(text))
    return line if line.endswith((".", "?")) else f"{line}."


def listed(words: Sequence[str], last: str) -> str:
    """Words as a sentence lists them, `last` before the last of them: "A, B or C"."""
    return f" {last} ".join(filter(None, (", ".join(words[:-1]), *words[-1:])))
