"""Making libraries: from what numba gives to object files, the same bytes each time, and nothing whose bits differ."""

import re

import pytest

pytest.importorskip("llvmlite", reason="needs numba")
pytest.importorskip("numba", reason="needs numba")

import llvmlite.binding as llvm

from sandbox.physics.jit.making.emitting import _size, _with_plain_stack, object_code
from sandbox.physics.jit.making.gathering import EntryCode
from sandbox.physics.jit.making.platforms import LIBRARIES, WEB

CODE = EntryCode("sandbox.physics.some.run", "made", (["array", "<f8", 1], "float"), "float", False)
MODULE = """
define weak_odr i32 @made(ptr %gives, ptr %fault, ptr %a, ptr %b, i64 %n, i64 %size, ptr %data, i64 %shape,
                          i64 %stride, double %share) {
  %first = load double, ptr %data, align 8
  %scaled = fmul {flags} double %first, %share
  %sum = fadd {flags} double %scaled, 1.0
  %root = call double @sqrt(double %sum)
  store double %root, ptr %gives, align 8
  ret i32 0
}
declare double @sqrt(double)
"""


def bitcode(flags=""):
    llvm.initialize_all_targets()
    return bytes(llvm.parse_assembly(MODULE.replace("{flags}", flags)).as_bitcode())


def test_a_symbol_is_a_name_that_c_can_say():
    assert CODE.symbol == "physics_some_run"


@pytest.mark.parametrize("platform", [*LIBRARIES, WEB], ids=lambda platform: platform.name)
def test_object_code_is_the_same_each_time_and_defines_the_symbol_of_its_entry(platform):
    made = object_code(bitcode(), [CODE], platform)
    assert made == object_code(bitcode(), [CODE], platform)
    assert CODE.symbol.encode() in made and b"made" not in made.replace(b"NumbaEnv", b"")


@pytest.mark.parametrize("flags", ["contract", "fast", "reassoc"])
def test_code_whose_bits_differ_between_platforms_is_refused(flags):
    with pytest.raises(ValueError, match="whose bits differ"):
        object_code(bitcode(flags), [CODE], LIBRARIES[0])


@pytest.mark.parametrize(
    ("kind", "size"),
    [
        ("ptr", 8), ("i1", 1), ("{ ptr, ptr, i64, i64, ptr, [1 x i64], [1 x i64] }", 56), ("[3 x ptr]", 24),
        ("{ i8, i32, double }", 16), ("{ { ptr, i8 }, [2 x { i64, i1 }] }", 48),
    ],
)  # fmt: skip
def test_a_pointer_takes_eight_bytes_in_webassembly_too(kind, size):
    assert _size(kind) == (size, len(kind))


def test_structures_on_the_stack_become_bytes_and_a_size_of_a_pointer_that_is_left_is_refused():
    text = """
define void @f(ptr %a) {{
  %s = alloca {{ ptr, i64 }}, align 8
  {body}
  ret void
}}
"""
    plain = _with_plain_stack(llvm.parse_assembly(text.format(body="store ptr %a, ptr %s, align 8")))
    assert re.search(r"alloca \[16 x i8\], align 8", str(plain))
    left = "%p = getelementptr { ptr, i64 }, ptr %s, i64 0, i32 1"
    with pytest.raises(ValueError, match="size of a pointer"):
        _with_plain_stack(llvm.parse_assembly(text.format(body=left)))
