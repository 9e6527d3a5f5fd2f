"""What inner kernels lay out in an arena, called as the interpreter runs them."""

from collections.abc import Callable
from typing import Any

import numpy as np

WORDS = 1 << 20


def laid_out(make: Callable[..., Any], *arguments: Any, words: int = WORDS) -> Any:
    """What a kernel makes of arguments and an arena, as arrays of numpy."""
    arena = np.zeros(words, np.int64)
    arena[0] = 1
    made = make(*arguments, arena)
    assert arena[0] <= words
    return _as_arrays(made)


def _as_arrays(item: Any) -> Any:
    if isinstance(item, tuple):
        made: Any = item
        return made._make(map(_as_arrays, item))
    return np.asarray(item)
