"""Finds names that look alike: letters of other alphabets, digits for letters, invisible characters.

The letters are those of Unicode Technical Standard 39, "confusables", that look like Latin ones in common typefaces.
"""

import unicodedata

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
