"""Kernels that look at each index, in every golden and alone: none is out of range, and the bits are the same."""

import importlib.util
import sys

import pytest

from tests.determinism.matrix import outcome
from tests.determinism.twins import compare
from tests.support.wants import needs


@needs("zig", importlib.util.find_spec("ziglang"))
@pytest.mark.whole_world
def test_no_index_is_out_of_range_in_any_golden():
    equal, text = outcome(sys.executable, "checked", [])
    assert equal and text.startswith("checked, ") and text.endswith(" 0 goldens differ"), text


@needs("zig", importlib.util.find_spec("ziglang"))
@pytest.mark.whole_world
def test_each_kernel_alone_gives_the_bits_of_its_source():
    differ, never, calls = compare(3, 1, [])
    assert differ == [] and calls > 2000
    # What these take does not come about by chance.
    assert len(never) < 150
