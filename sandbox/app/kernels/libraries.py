"""`make libraries`: kernels become machine code for all platforms, with a manifest; or are compared with what is there.

It needs the extra `build`. From the same sources the same versions of Python, numba, llvmlite and zig make the same
bytes on the same system.
"""

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from importlib.metadata import version
from typing import Any

from sandbox.app.kernels.compiling import needed_kernels
from sandbox.physics.jit.library import FOLDER, MANIFEST, NoLibrary, file_digest, library_name, read_manifest
from sandbox.physics.jit.sources import edited, sources_now

# No instruction that only the maker's processor has, and no order that changes from run to run.
_SETTINGS = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "", "NUMBA_OPT": "3", "PYTHONHASHSEED": "0"}
# What a library is tried out with: it is to come to the state that the interpreter comes to.
_TRIAL = ("run", "balloons", "--seconds", "1", "--json")


def makers_here() -> dict[str, str]:
    """The versions of all that makes libraries here."""
    names = ("numba", "llvmlite", "ziglang")
    own = {"system": library_name().partition(".")[0], "python": "{}.{}".format(*sys.version_info)}
    return own | {name: version(name) for name in names}


def _made(here_only: bool) -> tuple[dict[str, bytes], dict[str, Any]]:
    """Libraries by their file names, and what the manifest says of their entries; only this platform's, or all."""
    from sandbox.physics.jit.making.gathering import gather
    from sandbox.physics.jit.making.platforms import LIBRARIES, WEB

    kernels = sorted(needed_kernels(), key=lambda kernel: kernel.name)
    bitcode, codes = gather([(kernel, kinds) for kernel in kernels for kinds in kernel.signatures.values()])
    wanted = [each for each in (*LIBRARIES, WEB) if not here_only or each.file == library_name()]
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        contents = pool.map(_library, [bitcode] * len(wanted), [codes] * len(wanted), wanted)
        files = dict(zip((platform.file for platform in wanted), contents, strict=True))
    return files, {code.name: _entry(code) for code in codes}


def _library(bitcode: bytes, codes: Sequence[Any], platform: Any) -> bytes:
    from sandbox.physics.jit.making.emitting import object_code
    from sandbox.physics.jit.making.linking_by_zig import linked

    called = [code.symbol for code in codes if not platform.entries or code.name in platform.entries]
    return linked(object_code(bitcode, codes, platform), called, platform)


def _entry(code: Any) -> dict[str, Any]:
    return {"symbol": code.symbol, "takes": list(code.arguments), "gives": code.gives}


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
    """What differs from the sources, in lines; bytes are compared where the makers are the same."""
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
    files, entries = _made(here_only)
    found = [] if entries == manifest["entries"] else ["manifest.json: the entries are others"]
    for name, content in files.items():
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
    if any(os.environ.get(name) != value for name, value in _SETTINGS.items()):
        command = [sys.executable, "-m", "sandbox.app.kernels.libraries", *sys.argv[1:]]
        return subprocess.run(command, env={**os.environ, **_SETTINGS}, check=False).returncode
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
    files, entries = _made(here_only=False)
    _write(files, entries)
    print(*(f"{len(content):8d} bytes  {name}" for name, content in files.items()), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(_main())
