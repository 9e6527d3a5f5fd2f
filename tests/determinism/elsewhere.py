"""Kernels on other machines against those of this process: a run as memory, calls, and what each call changed.

Run by hand: python -m tests.determinism.elsewhere [--whole] [GOLDEN ...]   (default: the beginning of every golden)

Machines: WebAssembly in node, and the library for Linux on arm64, emulated by qemu; one that is not installed is left
out, with a line. Neither needs Python: it makes the same calls in an image of the same memory, and compares every byte
that a call changed, every result, and in the end all memory that kernels could reach.
"""

import shutil
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.page.bundle import node_path
from sandbox.physics import jit
from sandbox.physics.jit.library import FOLDER, read_manifest
from sandbox.physics.jit.making import platforms
from tests.support.calls import in_place_of

HERE = Path(__file__).parent
ALIGNED = 16
PATCH, CALL, CHECK = range(3)
GIVES = ("nothing", "integer", "float", "flag")
# Ticks of a golden that are one image: each begins with all memory; and ticks of one that is not played whole.
CHUNK, SOME = 60, 240


class Missing(Exception):
    """A machine needs this, and it is not installed here."""


@dataclass(frozen=True)
class Machine:
    """A machine: its name, where images begin there [bytes], and the command that goes through one.

    Below the image lie the stack of a module, its constants, and the block of arguments. entries: names of the only
    kernels that it has; empty: all.
    """

    name: str
    base: int
    command: Callable[[], list[str]]
    entries: tuple[str, ...] = ()


def _web() -> list[str]:
    node = node_path()
    if node is None:
        raise Missing("node")
    return [node, str(HERE / "web.mjs"), str(FOLDER / "kernels.wasm")]


ROOT_OF_ARM64 = Path("/usr/aarch64-linux-gnu")


@cache
def _arm64() -> list[str]:
    qemu = shutil.which("qemu-aarch64")
    if qemu is None or not ROOT_OF_ARM64.exists():
        raise Missing("qemu-user and libc6-arm64-cross")
    made = Path(tempfile.mkdtemp()) / "machine"
    source = str(HERE / "machine.c")
    compile_it = ["cc", "-target", "aarch64-linux-gnu", "-O1", source, "-o", str(made)]
    ended = subprocess.run([sys.executable, "-m", "ziglang", *compile_it], capture_output=True, text=True, check=False)
    if ended.returncode:
        raise Missing(f"a zig that can make the machine: {ended.stderr.strip()[:200]}")
    return [qemu, "-L", str(ROOT_OF_ARM64), str(made), str(FOLDER / "linux-arm64.so")]


WEB = Machine("WebAssembly", 4 << 20, _web, platforms.WEB.entries)
ARM64 = Machine("arm64", 0x5000_0000, _arm64)


class Image:
    """Memory of this process as another machine is to have it, and what is to be done there, as bytes."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        entries = read_manifest()["entries"]
        self.entries = {name: entries[name] for name in machine.entries or entries}
        self.symbols = [entry["symbol"] for entry in self.entries.values()]
        self.end, self.calls, self._parts = machine.base, 0, [b""]
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
        owner = _owner(array)
        start = owner.ctypes.data
        where = self._place(start, owner.nbytes)
        self._owners[start] = owner
        self._follow(start, PATCH)
        return where + array.ctypes.data - start

    def where(self, array: np.ndarray) -> int | None:
        """Where an array lies in the image, None where no call was given it."""
        owner = _owner(array)
        place = self._places.get(owner.ctypes.data)
        return None if place is None else place + array.ctypes.data - owner.ctypes.data

    def spoil(self, array: np.ndarray, there: np.ndarray) -> None:
        """Give the machine other values (equal in shape) than an array of the image has here, and let it compare."""
        where = self.address(array)
        self._add(PATCH, where, there.tobytes())
        self._add(CHECK, where, array.tobytes())

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
        values: list[int] = []

        def add(item: Any) -> None:
            if isinstance(item, np.ndarray):
                values.extend(self._of_array(item, self.address(item)))
            else:
                for part in item:
                    add(part)

        start = bundle.ctypes.data
        where = self._place(start, bundle.nbytes)
        if start not in self._bundles:
            add(jit.items_of(bundle))
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

    def differences(self) -> str:
        """What the machine says of the image: the number of checks, and what differs."""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "image"
            file.write_bytes(self.content())
            limits = [str(self.machine.base), str(self.end)]
            command = [*self.machine.command(), str(file), *limits, *self.symbols]
            ended = subprocess.run(command, capture_output=True, text=True, check=False)
        return ended.stdout.strip() or ended.stderr[-2000:]


def _owner(array: np.ndarray) -> np.ndarray:
    """The array that has the memory of another one."""
    while isinstance(array.base, np.ndarray):
        array = array.base
    return array


@contextmanager
def watched(images: list[Image]) -> Iterator[Callable[[], None]]:
    """While this lasts, every entry of kernels that is called notes itself in the first of `images`.

    It gives what is to be called now and then: entries that were never called before are watched from then on.
    """

    def note(kernel: jit.Kernel, run: Callable[..., Any], given: tuple[Any, ...]) -> Any:
        return images[0].call(kernel.name, run, given)

    with in_place_of(lambda: [one for one in jit.entries() if one.name in images[0].entries], note) as watch:
        yield watch


def verified(name: str, machine: Machine, end: int | None) -> str:
    """A golden, verified here to a tick while another machine makes the same calls: what it found."""
    from sandbox.session.compare.comparison import verify
    from sandbox.session.replay.reader import read_replay
    from tests.determinism.golden import golden_path

    images, said, calls, ticks = [Image(machine)], [], 0, 0

    def close() -> None:
        nonlocal calls
        calls += images[0].calls
        if images[0].calls:
            said.append(images[0].differences())
        images[0] = Image(machine)

    with watched(images) as watch:

        def on_tick(_: object) -> None:
            nonlocal ticks
            ticks += 1
            watch()
            if ticks % CHUNK == 0:
                close()

        divergence = verify(read_replay(golden_path(name)), end=end, on_tick=on_tick)
        close()
    wrong = [each for each in said if not each.endswith(", 0 differ")]
    checks = sum(int(each.splitlines()[-1].split()[0]) for each in said if each.endswith("differ"))
    return f"{ticks} ticks, {calls} calls, {checks} checks, {divergence or wrong[:1] or '0 differ'}"


def main(names: list[str]) -> int:
    """Go through goldens; a line for each on each machine."""
    from tests.determinism.golden import golden_names

    differing, end = 0, None if "--whole" in names else SOME
    chosen = [name for name in names if name != "--whole"] or golden_names()
    for machine in (WEB, ARM64):
        try:
            machine.command()
        except Missing as fault:
            print(f"{machine.name}: left out for want of {fault}", flush=True)
            continue
        for name in chosen:
            said = verified(name, machine, end)
            differing += not said.endswith(" 0 differ")
            print(f"{machine.name}, {name}: {said}", flush=True)
    return int(differing > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
