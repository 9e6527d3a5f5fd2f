"""LevelError: all faults of a level, one line each, with the place and the remedy."""

import difflib
import itertools
import json
import unicodedata
from collections.abc import Collection, Iterable
from typing import Any

from sandbox.level.format.limits import FAULT_LIMIT

# Where a fault is (a JSON path such as materials.steel.stiffness, or "line 3, column 5"; "" = the whole) and what.
Fault = tuple[str, str]

# A message shows at most this much of a value [characters], so that hostile values cannot flood a terminal.
_SHOWN = 60
# Looking for similar words among more than this is slow, and a guess is then worth little.
_CHOICES = 200


class LevelError(ValueError):
    """A level that is refused. `faults` has one line per fault, at most 50, with file, place and remedy."""

    def __init__(self, source: str, faults: Iterable[Fault]) -> None:
        first = list(itertools.islice(faults, FAULT_LIMIT + 1))
        if len(first) > FAULT_LIMIT:
            first[FAULT_LIMIT - 1 :] = [("", "there are more faults than these")]
        where = one_line(source)
        self.faults = [": ".join(part for part in (where, place, text) if part) for place, text in first]
        super().__init__("\n".join(self.faults))


def one_line(text: str) -> str:
    """A text as it is if one line can show it, else with escapes."""
    return text if text.isprintable() else json.dumps(text)[1:-1]


def shown(value: Any) -> str:
    """A value as a file has it, cut short; of lists and objects only the type."""
    if isinstance(value, list | tuple):
        return "a list"
    if isinstance(value, dict):
        return "an object"
    if isinstance(value, int) and not isinstance(value, bool) and value.bit_length() > 64:
        return "an integer of too many digits"
    text = json.dumps(value, ensure_ascii=False)
    if not text.isprintable():
        text = json.dumps(value)
    return text if len(text) <= _SHOWN else text[: _SHOWN - 4] + ('..."' if isinstance(value, str) else "...")


def suggestion(word: str, choices: Collection[str]) -> str:
    """`; did you mean "..."?` if one of few choices resembles the word, else an empty text.

    If both look the same, the text names the character that differs.
    """
    if len(choices) > _CHOICES or len(word) > _SHOWN:
        return ""
    same = next((choice for choice in choices if skeleton(choice) == skeleton(word)), None)
    if same is not None:
        return f"; it only looks like {shown(same)}{_odd_one(word, same)}"
    # Of names that are counted, another number is no help.
    close = [each for each in difflib.get_close_matches(word, choices) if _uncounted(each) != _uncounted(word)]
    return f"; did you mean {shown(close[0])}?" if close else ""


def _uncounted(name: str) -> str:
    return name.rstrip("0123456789")


def _odd_one(word: str, choice: str) -> str:
    at, char = next(((at, char) for at, char in enumerate(word) if char != choice[at : at + 1]), (0, ""))
    return f": its character {at + 1} is {unicodedata.name(char, f'U+{ord(char):04X}')}" if char else ""


def json_path(parts: Iterable[Any]) -> str:
    """Keys and indices joined by dots; keys that would be ambiguous in quotes."""
    return ".".join(_part(part) for part in parts)


def _part(part: Any) -> str:
    if isinstance(part, int):
        return str(part)
    plain = part and part.isprintable() and len(part) <= _SHOWN and not set(part) & set('." ')
    return part if plain else shown(part)


_LIKE_LATIN = str.maketrans(
    "\u0430\u0435\u043e\u0440\u0441\u0443\u0445\u0456\u0458\u0455\u04bb\u0501\u051b\u051d"
    "\u0410\u0412\u0415\u041a\u041c\u041d\u041e\u0420\u0421\u0422\u0425\u0406\u0408\u0405"
    "\u03bf\u03b1\u03bd\u03c1\u03b9\u03ba\u0391\u0392\u0395\u0396\u0397\u0399\u039a\u039c\u039d\u039f\u03a1\u03a4\u03a5\u03a7"
    "01I|",
    "aeopcyxijshdqwABEKMHOPCTXlJSoavpikABEZHlKMNOPTYXOlll",
)


def skeleton(name: str) -> str:
    """The skeleton of a name: names that look the same have the same one."""
    seen = "".join(char for char in unicodedata.normalize("NFKC", name) if unicodedata.category(char) != "Cf")
    return seen.translate(_LIKE_LATIN)
