"""`make libraries`: kernels become machine code for all platforms, with a manifest; or are compared with what is there.

It needs the extra `build`. From the same sources the same version of zig makes the same bytes, on every system.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from sandbox.physics.jit.library import FOLDER, MANIFEST, library_name, read_manifest
from sandbox.physics.jit.making.compiling import Gathered, all_entries, compiled, gathered
from sandbox.physics.jit.making.platforms import LIBRARIES, WEB, Platform
from sandbox.physics.jit.sources import NoLibrary, edited, file_digest, sources_now

# What a library is tried out with: it is to come to the state that the interpreter comes to.
_TRIAL = ("run", "balloons", "--seconds", "1", "--json")


def makers_here() -> dict[str, str]:
    """The versions of all that makes libraries here."""
    return {"ziglang": version("ziglang")}


def _made(found: Gathered, platforms: Sequence[Platform]) -> dict[str, bytes]:
    """Libraries by their file names."""
    made = {}
    with tempfile.TemporaryDirectory() as kept:
        for platform in platforms:
            names = platform.entries or tuple(found.entries)
            symbols = [found.entries[name]["symbol"] for name in names]
            made[platform.file] = compiled(found.texts, symbols, platform, Path(kept))
            print(f"{len(made[platform.file]):8d} bytes  {platform.file}", flush=True)
    return made


def _text(manifest: dict[str, Any]) -> str:
    """A manifest with a line for each file, source and entry."""
    parts = []
    for key, value in manifest.items():
        if isinstance(value, dict):
            lines = [f"  {json.dumps(name)}: {json.dumps(item)}" for name, item in sorted(value.items())]
            value_text = "{\n" + ",\n".join(lines) + "\n }"
        else:
            value_text = json.dumps(value)
        parts.append(f" {json.dumps(key)}: {value_text}")
    return "{\n" + ",\n".join(parts) + "\n}\n"


def _write(files: dict[str, bytes], entries: dict[str, Any]) -> None:
    FOLDER.mkdir(exist_ok=True)
    for old in FOLDER.iterdir():
        old.unlink()
    for name, content in files.items():
        (FOLDER / name).write_bytes(content)
    manifest = {
        "makers": makers_here(),
        "run_on": [],
        "files": {name: file_digest(content) for name, content in files.items()},
        "entries": entries,
        "sources": sources_now(),
    }
    _write_manifest(manifest)
    if _runs_here():
        _write_manifest(manifest | {"run_on": [library_name().partition(".")[0]]})


def _write_manifest(manifest: dict[str, Any]) -> None:
    MANIFEST.write_text(_text(manifest), encoding="utf-8", newline="\n")


def _runs_here() -> bool:
    """Whether the library of this platform gives the bits that the interpreter gives."""
    hashes = []
    for way in ("library", "interpreted"):
        command = [sys.executable, "-m", "sandbox", *_TRIAL]
        ended = subprocess.run(command, env={**os.environ, "SANDBOX_KERNELS": way}, capture_output=True, check=True)
        hashes.append(json.loads(ended.stdout)["hash"])
    return hashes[0] == hashes[1]


def _differences(here_only: bool) -> list[str]:
    """The differences from the sources, in lines; bytes are compared where the makers are the same."""
    try:
        manifest = read_manifest()
    except NoLibrary as fault:
        return [str(fault)]
    changed = edited(manifest["sources"])
    if changed:
        return [f"{name}: its kernels are not those that the libraries were made of" for name in changed]
    if manifest["makers"] != makers_here():
        print(f"bytes are not compared: made by {_said(manifest['makers'])}; here {_said(makers_here())}")
        return []
    here = [each for each in (*LIBRARIES, WEB) if not here_only or each.file == library_name()]
    now = gathered(all_entries())
    found = [] if now.entries == manifest["entries"] else ["manifest.json: the entries are others"]
    for name, content in _made(now, here).items():
        path = FOLDER / name
        if not path.exists() or path.read_bytes() != content:
            found.append(f"{name}: its bytes are others")
    return found


def _are_current() -> bool:
    """Whether libraries and manifest are whole, and made of these kernels by these makers."""
    try:
        manifest = read_manifest()
        whole = all(file_digest((FOLDER / name).read_bytes()) == digest for name, digest in manifest["files"].items())
    except (NoLibrary, OSError):
        return False
    return whole and manifest["makers"] == makers_here() and not edited(manifest["sources"])


def _said(makers: dict[str, str]) -> str:
    return ", ".join(f"{name} {what}" for name, what in makers.items())


def _main() -> int:
    parser = argparse.ArgumentParser(prog="make libraries", description=str(__doc__).partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="compare with what is there, and write nothing")
    parser.add_argument("--here", action="store_true", help="with --check: only the library of this platform")
    options = parser.parse_args()
    if options.check:
        differences = _differences(options.here)
        print(*differences or ["the libraries are those of the sources"], sep="\n")
        if differences:
            print("make libraries makes them again")
        return 1 if differences else 0
    if _are_current():
        # What was edited beside kernels is looked at no more at each start.
        _write_manifest(read_manifest() | {"sources": sources_now()})
        print("the libraries are those of the sources")
        return 0
    found = gathered(all_entries())
    _write(_made(found, (*LIBRARIES, WEB)), found.entries)
    return 0


if __name__ == "__main__":
    sys.exit(_main())
