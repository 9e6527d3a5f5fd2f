"""Compile the kernels for this machine: a library and its manifest, into a folder.

python -m sandbox.physics.jit.making FOLDER [checked]
"""

import json
import sys
from pathlib import Path

from sandbox.physics.jit.making.compiling import NotCompiled, all_entries, compiled, gathered
from sandbox.physics.jit.making.platforms import this_machine
from sandbox.physics.jit.sources import file_digest
from sandbox.physics.jit.translate.cpp_types import Untranslatable


def _main(folder: Path, *checked: str) -> int:
    platform = this_machine()
    try:
        found = gathered(all_entries())
        content = compiled(found.texts, found.symbols, platform, folder.parent / "zig", bool(checked), bool(checked))
    except (Untranslatable, NotCompiled) as fault:
        print(fault)
        return 1
    folder.mkdir(parents=True, exist_ok=True)
    (folder / platform.file).write_bytes(content)
    for name, text in found.texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    manifest = {"library": platform.file, "digest": file_digest(content), "entries": found.entries}
    (folder / "manifest.json").write_text(json.dumps(manifest))
    return 0


if __name__ == "__main__":
    sys.exit(_main(Path(sys.argv[1]), *sys.argv[2:]))
