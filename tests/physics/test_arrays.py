"""Named tuples of arrays know what they hold from markers of their own, not from the insides of numpy's aliases."""

import subprocess
import sys
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import pytest

from sandbox.physics.arrays import ArrayKind, FloatRows, Slots, empty, with_empty

ROOT = Path(__file__).resolve().parents[2]

# Runs a level where numpy's alias of arrays has no inside at all.
WITH_A_STAND_IN = """
import sys
import numpy.typing

class Opaque:
    def __class_getitem__(cls, item):
        return cls

numpy.typing.NDArray = Opaque
from sandbox.cli import main
sys.exit(main(["run", "breaking_bridge", "--ticks", "3"]))
"""


class Inner(NamedTuple):
    """Of one array, whose annotation says nothing."""

    flag: Annotated[object, ArrayKind(np.bool_, 3)]


class Outer(NamedTuple):
    """Of arrays and of another tuple."""

    row: FloatRows
    slot: Slots
    inner: Inner
    bare: int = 0


class Whole(NamedTuple):
    """As Outer, without what is no array."""

    row: FloatRows
    slot: Slots
    inner: Inner


def test_arrays_of_a_named_tuple_have_the_dtype_and_dimensions_of_their_markers():
    made = empty(Whole)
    assert (made.row.dtype, made.row.shape) == (np.float64, (0, 0))
    assert (made.slot.dtype, made.slot.shape) == (np.int64, (0,))
    assert (made.inner.flag.dtype, made.inner.flag.shape) == (np.bool_, (0, 0, 0))


def test_what_is_given_takes_the_place_of_an_empty_array():
    slots = np.arange(3)
    assert with_empty(Whole, slot=slots).slot is slots


def test_a_field_without_a_marker_is_named():
    with pytest.raises(TypeError, match=r"Outer\.bare"):
        empty(Outer)


def test_levels_run_whatever_the_aliases_of_numpy_look_like_inside():
    run = subprocess.run([sys.executable, "-c", WITH_A_STAND_IN], cwd=ROOT, capture_output=True, text=True)
    assert (run.returncode, run.stderr) == (0, ""), run.stderr
