"""Kernels in WebAssembly against the kernels of this process: a run as memory, calls, and what each call changed.

Run by hand: python -m tests.determinism.web TICKS [LEVEL ...]   (needs node; default: every shipped level)

The other machine needs no Python: it makes the same calls in an image of the same memory, and compares every byte that
a call changed, every result, and in the end all memory that kernels could reach.
"""

import shutil
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.physics import jit
from sandbox.physics.jit.library import FOLDER, read_manifest

MACHINE = Path(__file__).with_name("web.mjs")
# Where the image begins [bytes]: below lie the stack of the module, its constants, and the block of arguments.
BASE = 4 << 20
ALIGNED = 16
PATCH, CALL, CHECK = range(3)
GIVES = ("nothing", "integer", "float", "flag")


class Image:
    """Memory of this process as another machine is to have it, and what is to be done there, as bytes."""

    def __init__(self) -> None:
        self.entries = read_manifest()["entries"]
        self.symbols = [entry["symbol"] for entry in self.entries.values()]
        self.end, self.calls, self._parts = BASE, 0, [b""]
        self._places: dict[int, int] = {}
        self._owners: dict[int, np.ndarray] = {}
        self._shadows: dict[int, bytes] = {}
        self._bundles: dict[int, np.ndarray] = {}

    def _add(self, kind: int, where: int, content: bytes) -> None:
        self._parts.append(struct.pack("<3I", kind, where, len(content)) + content)

    def _place(self, start: int, size: int) -> int:
        if start not in self._places:
            self._places[start] = self.end
            self.end += -(-max(size, 1) // ALIGNED) * ALIGNED
        return self._places[start]

    def address(self, array: np.ndarray) -> int:
        """Where an array lies in the image; what it holds now is written there."""
        owner = array
        while isinstance(owner.base, np.ndarray):
            owner = owner.base
        start = owner.ctypes.data
        where = self._place(start, owner.nbytes)
        self._owners[start] = owner
        self._follow(start, PATCH)
        return where + array.ctypes.data - start

    def _follow(self, start: int, kind: int) -> None:
        """Patch, or check, what has changed of an array since it was last looked at."""
        now, before = self._owners[start].tobytes(), self._shadows.get(start)
        if before is None:
            self._add(kind, self._places[start], now)
        elif now != before:
            changed = np.flatnonzero(np.frombuffer(now, np.uint8) != np.frombuffer(before, np.uint8))
            first, last = int(changed[0]), int(changed[-1]) + 1
            self._add(kind, self._places[start] + first, now[first:last])
        self._shadows[start] = now

    def words(self, item: Any, form: Any) -> list[bytes]:
        """The words of an argument of this form."""
        if isinstance(form, str):
            return [struct.pack("<d", item) if form == "float" else struct.pack("<q", int(item))]
        if form[0] == "tuple":
            return [word for part, kind in zip(item, form[1:], strict=True) for word in self.words(part, kind)]
        where = self._bundle(item) if form[0] == "bundle" else self.address(item)
        return [struct.pack("<q", value) for value in self._of_array(item, where)]

    def _of_array(self, array: np.ndarray, where: int) -> tuple[int, ...]:
        return 0, 0, array.size, array.itemsize, where, *array.shape, *array.strides

    def _bundle(self, bundle: np.ndarray) -> int:
        base: Any = bundle.base
        values: list[int] = []

        def add(item: Any) -> None:
            if isinstance(item, np.ndarray):
                values.extend(self._of_array(item, self.address(item)))
            else:
                for part in item:
                    add(part)

        add((base.obj if isinstance(base, memoryview) else base).whole.item)
        start = bundle.ctypes.data
        where = self._place(start, bundle.nbytes)
        if start not in self._bundles:
            self._bundles[start] = bundle
            self._add(PATCH, where, struct.pack(f"<{len(values)}q", *values))
        return where

    def call(self, name: str, function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
        """Call an entry here, and note the call and what it did."""
        entry = self.entries[name]
        for start in self._owners:
            self._follow(start, PATCH)
        forms = zip(arguments, entry["takes"], strict=True)
        block = b"".join(word for item, form in forms for word in self.words(item, form))
        result = function(*arguments)
        gives = GIVES.index(entry["gives"])
        given = struct.pack("<d", result) if gives == 2 else struct.pack("<q", int(result or 0))
        self._add(CALL, self.symbols.index(entry["symbol"]), struct.pack("<I", gives) + given + block)
        for start in self._owners:
            self._follow(start, CHECK)
        self.calls += 1
        return result

    def content(self) -> bytes:
        """All that is to be done, and then to be checked."""
        for start, held in filter(lambda each: each[1], self._shadows.items()):
            self._add(CHECK, self._places[start], held)
        return b"".join(self._parts)


def watched(image: Image, work: Iterable[object]) -> None:
    """Go through `work` while every entry of kernels that it calls notes itself in the image."""
    changed: list[tuple[Any, str, Any]] = []

    def watch() -> None:
        for kernel in jit.entries():
            if kernel.name in image.entries:
                name, run = kernel.function.__name__, kernel.ready()
                for holder in [one for one in sys.modules.values() if getattr(one, name, None) is run]:
                    changed.append((holder, name, run))
                    setattr(holder, name, lambda *given, _name=kernel.name, _run=run: image.call(_name, _run, given))

    try:
        watch()
        for _ in work:
            watch()
    finally:
        for holder, name, run in changed:
            setattr(holder, name, run)


def differences(image: Image) -> str:
    """What node says of the image: the number of checks, and what differs."""
    node = shutil.which("node")
    assert node is not None
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "image"
        file.write_bytes(image.content())
        command = [node, str(MACHINE), str(FOLDER / "kernels.wasm"), str(file), str(image.end), *image.symbols]
        ended = subprocess.run(command, capture_output=True, text=True, check=False)
    return ended.stdout.strip() or ended.stderr[-2000:]


def main(ticks: int, names: list[str]) -> int:
    """Play levels; a line for each."""
    from sandbox.level.reading.files import load_level, shipped_levels
    from sandbox.session.session import Session

    differing = 0
    for name in names or [path.stem for path in shipped_levels()]:
        image, session = Image(), Session(load_level(name))

        def play(session: Session = session) -> Iterator[None]:
            for _ in range(ticks):
                session.advance()
                yield

        watched(image, play())
        said = differences(image)
        differing += not said.endswith(" 0 differ")
        print(f"{name}: {image.calls} calls, {said}", flush=True)
    return int(differing > 0)


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), sys.argv[2:]))
