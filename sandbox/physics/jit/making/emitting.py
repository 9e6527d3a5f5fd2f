"""Emitting: from the gathered module of all entries to an object file for one platform."""

import re
from collections.abc import Sequence
from typing import Any

import llvmlite.binding as llvm

from sandbox.physics.jit.making.gathering import EntryCode
from sandbox.physics.jit.making.platforms import Platform

_LEVEL = 3
# The machine's own root, in place of a library's.
_ROOT = """
declare double @llvm.sqrt.f64(double)
define double @sqrt(double %x) alwaysinline {
  %y = call double @llvm.sqrt.f64(double %x)
  ret double %y
}
"""
# In WebAssembly a pointer of 32 bits lies in 8 bytes, so that bundles look as everywhere.
_WEB_LAYOUT = "e-m:e-p:32:64-p10:8:8-p20:8:8-i64:64-i128:128-n32:64-S128-ni:1:10:20"
_SIZES = {"ptr": 8, "i64": 8, "double": 8, "i32": 4, "float": 4, "i16": 2, "i8": 1, "i1": 1}
# Sums whose terms may change places, and products that may melt into sums: there must be none of either.
_INEXACT = re.compile(r"llvm\.fma|llvm\.fmuladd| (?:contract|fast|reassoc|afn|arcp) ")


def _entry_text(code: EntryCode, function: Any, is_dll: bool) -> str:
    """The function of one entry: it reads the words of its block, and writes the result into the first of them."""
    kinds = [str(argument.type) for argument in function.arguments][2:]
    lines = [f"define {'dllexport ' if is_dll else ''}i32 @{code.symbol}(ptr %block) {{"]
    lines += ["  %gives = alloca [4 x i64], align 16", "  %fault = alloca ptr, align 8"]
    lines += ["  store i64 0, ptr %gives, align 8"]
    given = ["ptr %gives", "ptr %fault"]
    for k, kind in enumerate(kinds):
        lines += [f"  %p{k} = getelementptr i64, ptr %block, i64 {k}", f"  %w{k} = load {kind}, ptr %p{k}, align 8"]
        given.append(f"{kind} %w{k}")
    declared = ", ".join(["ptr", "ptr", *kinds])
    lines += [f'  %status = call i32 @"{code.function}"({", ".join(given)})']
    lines += ["  %result = load i64, ptr %gives, align 8", "  store i64 %result, ptr %block, align 8"]
    lines += ["  ret i32 %status", "}", f'declare i32 @"{code.function}"({declared})']
    return "\n".join(lines)


def _size(kind: str, start: int = 0) -> tuple[int, int]:
    """The size [bytes] of a type as LLVM writes it from `start` on, with pointers that lie in 8; where it ends."""
    start += len(kind) - start - len(kind[start:].lstrip())
    if kind[start] == "{":
        total, at = 0, start + 1
        while kind[at:].lstrip()[0] != "}":
            size, at = _size(kind, at)
            step = min(size, 8)
            total = -(-total // step) * step + size
            at += len(kind[at:]) - len(kind[at:].lstrip(" ,"))
        return -(-total // 8) * 8, kind.index("}", at) + 1
    if kind[start] == "[":
        cross = kind.index(" x ", start)
        size, at = _size(kind, cross + 3)
        return int(kind[start + 1 : cross]) * size, kind.index("]", at) + 1
    found = re.compile("|".join(_SIZES)).match(kind, start)
    if found is None:
        raise ValueError(f"no size is known of {kind[start:]}")
    return _SIZES[found[0]], found.end()


def _with_plain_stack(module: Any) -> Any:
    """The module with structures on the stack as so many bytes.

    LLVM's C interface gives a module the layout of its target machine before it makes code. Nothing may depend on the
    size of a pointer in memory by then.
    """

    def plain(found: re.Match[str]) -> str:
        return f"alloca [{_size(found[1])[0]} x i8], align"

    text = re.sub(r"alloca ([\[{].*[\]}]|ptr), align", plain, str(module))
    left = re.search(r"getelementptr [a-z ]*\{|(?:load|store) <[0-9]+ x ptr>|load \{|alloca [{p]", text)
    if left is not None:
        raise ValueError(f"the size of a pointer is left in {left[0]}")
    return llvm.parse_assembly(text)


def object_code(bitcode: bytes, codes: Sequence[EntryCode], platform: Platform) -> bytes:
    """The object file of all entries for one platform, the same bytes at every call.

    Raises:
        ValueError: for code whose results depend on more than IEEE 754, and for what has no place in WebAssembly.
    """
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    is_web = platform.suffix == "wasm"
    module = llvm.parse_bitcode(bitcode)
    for code in codes:
        module.link_in(
            llvm.parse_assembly(_entry_text(code, module.get_function(code.function), platform.suffix == "dll"))
        )
    module.link_in(llvm.parse_assembly(_ROOT))
    shared = {code.symbol for code in codes}
    for value in (*module.functions, *module.global_variables):
        if not value.is_declaration and value.name not in shared:
            value.linkage = "internal"
    machine = llvm.Target.from_triple(platform.triple).create_target_machine(
        cpu=platform.processor, features=platform.features, opt=_LEVEL, reloc="static" if is_web else "pic",
        codemodel="default",
    )  # fmt: skip
    module.triple = platform.triple
    module.data_layout = _WEB_LAYOUT if is_web else str(machine.target_data)
    options = llvm.create_pipeline_tuning_options(speed_level=_LEVEL)
    options.loop_vectorization = options.slp_vectorization = True
    passes = llvm.create_pass_builder(machine, options)
    passes.getModulePassManager().run(module, passes)
    module.verify()
    inexact = _INEXACT.search(str(module))
    if inexact is not None:
        raise ValueError(f"kernels hold {inexact[0].strip()}, whose bits differ from platform to platform")
    return bytes(machine.emit_object(_with_plain_stack(module) if is_web else module))
