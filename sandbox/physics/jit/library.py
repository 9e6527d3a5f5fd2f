"""Kernels of a library: machine code for a platform.

`make libraries` makes those that are shipped from the sources. The manifest beside them says of which sources, and what
their entries take. A library is called by one C function, `making/calling.c`, which Python sees as builtin functions.
"""

import ctypes
import importlib
import json
import os
import sys
import sysconfig
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.physics.jit import bundles, interpreted
from sandbox.physics.jit.sources import NoLibrary, edited, file_digest

COMPILED = True
FOLDER = Path(__file__).with_name("libraries")
MANIFEST = FOLDER / "manifest.json"
# What is added to the name of a platform whose library needs a processor of level v3: AVX2, of 2013 on.
WIDE = "-v3"


# As in calling.c.
_FORMS = {"integer": 0, "float": 1, "flag": 2, "array": 3, "bundle": 3, "tuple": 4}
_GIVES = {"nothing": 0, "integer": 1, "float": 2, "flag": 3}
_MOST_WORDS = 448
_FUNCTIONS = (
    "PyFloat_AsDouble", "PyLong_AsLongLong", "PyObject_IsTrue", "PyLong_AsVoidPtr", "PyTuple_Size", "PyTuple_GetItem",
    "PyObject_RichCompareBool", "PyErr_Occurred", "PyErr_Format", "PyObject_Vectorcall", "PyFloat_FromDouble",
    "PyLong_FromLongLong", "PyBool_FromLong", "Py_IncRef", "Py_FatalError", "PyThread_start_new_thread",
    "PyThread_allocate_lock", "PyThread_acquire_lock", "PyThread_release_lock",
)  # fmt: skip
_CONTIGUOUS_WRITEABLE = 0x401
_FASTCALL = 0x80


class _Method(ctypes.Structure):
    """Python's own description of a builtin function."""

    _fields_ = [("name", ctypes.c_char_p), ("call", ctypes.c_void_p), ("flags", ctypes.c_int), ("doc", ctypes.c_char_p)]


def library_name() -> str:
    """The file name of the library for this platform, whether there is one or not."""
    suffix = {"darwin": "dylib", "win32": "dll"}.get(sys.platform, "so")
    system = {"darwin": "macos", "win32": "windows"}.get(sys.platform, sys.platform)
    machine = sysconfig.get_platform().rpartition("-")[2] if sys.platform == "win32" else os.uname().machine
    usual = {"amd64": "x86_64", "aarch64": "arm64"}
    return f"{system}-{usual.get(machine.lower(), machine.lower())}.{suffix}"


def _has_known_layout() -> bool:
    """Whether arrays lie in memory as calling.c reads them."""
    probe = np.zeros((2, 3))
    head = ctypes.sizeof(ctypes.c_void_p) * 2
    if object.__basicsize__ != head or not bundles.HAS_KNOWN_ARRAYS:
        return False
    words = (ctypes.c_int64 * 7).from_address(id(probe) + head)
    shape = (ctypes.c_int64 * 2).from_address(words[2])
    return (
        words[1] & 0xFFFFFFFF == 2
        and tuple(shape) == (2, 3)
        and words[5] == id(probe.dtype)
        and words[6] & _CONTIGUOUS_WRITEABLE == _CONTIGUOUS_WRITEABLE
    )


def read_manifest() -> dict[str, Any]:
    """The manifest of the libraries. Raises NoLibrary."""
    try:
        manifest = json.loads(MANIFEST.read_text(encoding="utf-8"))
        if not all(isinstance(manifest[key], dict) for key in ("files", "sources", "entries")):
            raise ValueError("no manifest")
    except OSError as error:
        raise NoLibrary("the manifest of the libraries cannot be read") from error
    except (ValueError, KeyError, TypeError) as error:
        raise NoLibrary("the manifest of the libraries is damaged") from error
    return dict(manifest)


class Library:
    """A library, opened; entries: as its manifest has them. Raises NoLibrary."""

    def __init__(self, path: Path, entries: dict[str, Any]) -> None:
        self.entries = entries
        self._kept: list[Any] = []
        try:
            self._code = ctypes.CDLL(str(path))
            self._call = ctypes.cast(self._code.call, ctypes.c_void_p).value
            self._connect()
        except (OSError, AttributeError) as error:
            raise NoLibrary(f"the library {path.name} cannot be opened: {error}") from error

    @property
    def runs_wide(self) -> bool:
        """Whether the processor runs libraries for x86-64 level v3 too."""
        return bool(self._code.runs_wide())

    def use_threads(self, count: int, worth: int) -> None:
        """Let so many threads share loops of so many multiplications, the caller among them."""
        self._code.use_threads(ctypes.c_int64(count), ctypes.c_int64(worth))

    @property
    def threads_started(self) -> int:
        """Threads beside callers that were started, in this process."""
        return int(self._code.threads_started())

    def _connect(self) -> None:
        """Give the library the addresses of Python's functions."""
        functions = [ctypes.cast(getattr(ctypes.pythonapi, name), ctypes.c_void_p).value for name in _FUNCTIONS]
        words = [id(np.ndarray), id(None), id(TypeError), id(RuntimeError), *functions]
        self._code.connect((ctypes.c_void_p * len(words))(*words))
        if hasattr(os, "register_at_fork"):
            os.register_at_fork(after_in_child=self._code.forget_threads)

    def function(self, name: str) -> Any:
        """A builtin function that runs an entry.

        It takes the types that the entry was compiled for. Arrays are taken as they are where they are contiguous and
        writeable, else by way of a copy.

        Raises:
            TypeError: when it is called with others.
        """
        plain = self._builtin(name, None)

        def otherwise(*arguments: Any) -> Any:
            fitted = _fitted(arguments)
            result = plain(*fitted)
            _bring_back(arguments, fitted)
            return result

        return self._builtin(name, otherwise)

    def _builtin(self, name: str, otherwise: Any) -> Any:
        entry = self.entries[name]
        words: list[int] = []
        size = sum(self._add_kind(form, words) for form in entry["takes"])
        assert size <= _MOST_WORDS, name
        title = name.rpartition(".")[2].encode()
        code = ctypes.cast(getattr(self._code, entry["symbol"]), ctypes.c_void_p).value
        head = [code, ctypes.cast(ctypes.c_char_p(title), ctypes.c_void_p).value, _GIVES[entry["gives"]]]
        head += [len(entry["takes"]), 0 if otherwise is None else id(otherwise)]
        table = np.array([*head, *words], dtype=np.int64)
        method = _Method(title, self._call, _FASTCALL, None)
        make = ctypes.pythonapi.PyCFunction_NewEx
        make.restype, make.argtypes = ctypes.py_object, (ctypes.c_void_p, ctypes.py_object, ctypes.c_void_p)
        self._kept += (title, table, method, otherwise)
        return make(ctypes.addressof(method), int(table.ctypes.data), None)

    def _add_kind(self, form: Any, words: list[int]) -> int:
        """Add the form of an argument as calling.c needs it; its number of words in a block."""
        if isinstance(form, str):
            words += (_FORMS[form], 0, 0, 0)
            return 1
        kind, *details = form
        if kind == "tuple":
            words += (_FORMS[kind], 0, len(details), 0)
            return sum(self._add_kind(part, words) for part in details)
        dtype = bundles.dtype_of(*details) if kind == "bundle" else np.dtype(details[0])
        dimensions = 1 if kind == "bundle" else details[1]
        self._kept.append(dtype)
        words += (_FORMS[kind], id(dtype), dimensions, dtype.itemsize)
        return bundles.HEAD_WORDS + 2 * dimensions


def _fitted(arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    """Arguments with copies of arrays that are not contiguous or not writeable, those in tuples too."""
    fitted: list[Any] = []
    for argument in arguments:
        if isinstance(argument, tuple):
            fitted.append(_fitted(argument))
        elif isinstance(argument, np.ndarray) and not (argument.flags.c_contiguous and argument.flags.writeable):
            fitted.append(np.array(argument, order="C"))
        else:
            fitted.append(argument)
    return tuple(fitted)


def _bring_back(arguments: tuple[Any, ...], fitted: tuple[Any, ...]) -> None:
    """Copy results back to arrays that a kernel got as copies; read-only ones stay as they are."""
    for argument, copy in zip(arguments, fitted, strict=True):
        if isinstance(argument, tuple):
            _bring_back(argument, copy)
        elif copy is not argument and argument.flags.writeable:
            argument[...] = copy


_opened: Library | None = None


def open_library(wish: str = "library") -> Library:
    """The library of this platform; wish: see SANDBOX_KERNELS. Raises NoLibrary."""
    global _opened
    if _opened is None:
        if sys.implementation.name != "cpython" or not _has_known_layout():
            raise NoLibrary("this Python or numpy lays objects out in another way than libraries of kernels know")
        _opened = _compiled_here("kernels are to be checked", True) if wish == "checked" else _shipped(wish)
    return _opened


def _shipped(wish: str) -> Library:
    name = library_name()
    manifest = read_manifest()
    if name not in manifest["files"]:
        return _compiled_here(f"there is no library for this platform, {name.partition('.')[0]}", False)
    changed = edited(manifest["sources"])
    if changed:
        others = f" and {len(changed) - 1} more" if len(changed) > 1 else ""
        return _compiled_here(f"kernels were edited in {changed[0]}{others}", False)
    found = Library(_whole(name, manifest), manifest["entries"])
    wide = WIDE.join(os.path.splitext(name))
    if wish != "generic" and wide in manifest["files"] and found.runs_wide:
        return Library(_whole(wide, manifest), manifest["entries"])
    return found


def _whole(name: str, manifest: dict[str, Any]) -> Path:
    """Where a file of the manifest lies, as it was made."""
    path = FOLDER / name
    try:
        content = path.read_bytes()
    except OSError as error:
        raise NoLibrary(f"the library {name} is missing") from error
    if file_digest(content) != manifest["files"][name]:
        raise NoLibrary(f"the library {name} is damaged, or not the one of its manifest")
    return path


def _compiled_here(why: str, checked: bool) -> Library:
    # Of no use to whoever has not edited a kernel, and not for nothing: it reads every source.
    path, manifest = importlib.import_module("sandbox.physics.jit.edited").compiled_here(why, checked)
    return Library(path, manifest["entries"])


def make(kernel: Any) -> Any:
    """The function that modules get for a kernel which Python calls; one of an unknown program is interpreted."""
    library = open_library()
    return library.function(kernel.name) if kernel.name in library.entries else interpreted.make(kernel)


def use_threads(count: int, worth: int) -> None:
    """Let so many threads share loops of so many multiplications, the caller among them."""
    open_library().use_threads(count, worth)


def threads_started() -> int:
    """Threads beside callers that were started, in this process."""
    return open_library().threads_started


bundle, hold, items_of = bundles.bundle, bundles.hold, bundles.items_of
