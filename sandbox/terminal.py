"""Terminal: arguments as text, streams that may be closed or full or lack a character, interrupts, progress."""

import argparse
import io
import os
import re
import signal
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, cast

# Longest run [s] and picture side [pixels] that a person can mean; more is a slip of the finger.
SECONDS_LIMIT = 1e6
PIXEL_LIMIT = 16384
# Most pictures a second that a film can use.
RATE_LIMIT = 60.0
# Most processes that a person can mean.
PROCESS_LIMIT = 256
# Longest number of ticks, in digits, for the same reason.
COUNT_DIGITS = 12
# What people are not told whole: links to runs have thousands of letters.
_LONG_WORD = re.compile(r"(scene=\S{16}(?=\S{40})|\S{60}(?=\S{200}))\S+")


def _number(low: float, high: float, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is not a number") from None
    if not low <= value <= high:
        raise argparse.ArgumentTypeError(f"{text} is outside {low:g} to {high:g}")
    return value


def seconds(text: str) -> float:
    """A simulated time [s]."""
    return _number(0.0, SECONDS_LIMIT, text)


def share(text: str) -> float:
    """A share, from 0 up to 1."""
    return _number(0.0, 1.0, text)


def rate(text: str) -> float:
    """Pictures a second."""
    return _number(1.0, RATE_LIMIT, text)


def scale(text: str) -> float:
    """A size of widgets."""
    return _number(0.5, 4.0, text)


def substeps(text: str) -> int | str:
    """Substeps of a tick, a whole number or the word auto; the level format says which."""
    return text if text == "auto" else int(text)


def count(text: str) -> int:
    """A number of ticks."""
    if not (text.isdecimal() and len(text) <= COUNT_DIGITS and int(text) >= 1):
        raise argparse.ArgumentTypeError(
            f"{text[:40]!r} is not a whole number from 1 on, of at most {COUNT_DIGITS} digits"
        )
    return int(text)


def processes(text: str) -> int:
    """A number of processes."""
    return int(_number(1, PROCESS_LIMIT, str(count(text))))


def size(text: str) -> tuple[int, int]:
    """A picture's width and height [pixels]."""
    width, _, height = text.lower().partition("x")
    if not (width.isdecimal() and height.isdecimal() and min(int(width), int(height)) >= 1):
        raise argparse.ArgumentTypeError(f"{text!r} is not WIDTHxHEIGHT, as in 1280x720")
    if max(int(width), int(height)) > PIXEL_LIMIT:
        raise argparse.ArgumentTypeError(f"a side of {text} is above {PIXEL_LIMIT} pixels")
    return int(width), int(height)


class _NamedFile(io.FileIO):
    """A stream whose errors in writing carry its name, as those of other files do theirs."""

    def __init__(self, stream: io.TextIOWrapper, name: str) -> None:
        super().__init__(stream.fileno(), "w", closefd=False)
        # A stream that nobody holds closes its file.
        self._stream = stream
        self._name = name

    def write(self, data: Any) -> int:
        try:
            return super().write(data)
        except OSError as error:
            error.filename = self._name
            raise


def prepare_streams() -> None:
    """Make printing safe: a stream that was closed swallows, a character that it cannot say is spelled out.

    An error in writing to standard output is told with that name.
    """
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    sys.stdout = _named(sys.stdout, "standard output")


def _named(stream: Any, name: str) -> Any:
    buffer = getattr(stream, "buffer", None)
    raw = getattr(buffer, "raw", buffer)
    if type(raw) is not io.FileIO:
        return stream
    file = _NamedFile(stream, name)
    return io.TextIOWrapper(
        cast(Any, file if raw is buffer else io.BufferedWriter(file)),
        encoding=stream.encoding,
        errors=stream.errors,
        line_buffering=stream.line_buffering,
        write_through=stream.write_through,
    )


def missing_folder() -> str | None:
    """The message for a working folder that is gone: no relative path, no compiler works in one."""
    try:
        os.getcwd()
    except OSError as error:
        return (
            f"the folder that this was started in cannot be used ({error.strerror}): change into another and try again"
        )
    return None


def refusal_of(error: OSError) -> str:
    """The line of an error that the system raised."""
    # An error without a file's name is of no file: memory, processes, or whatever else the system runs out of.
    return f"{error.filename or 'the system refuses'}: {error.strerror or error}"


def give_up_output() -> None:
    """Send what standard output and error cannot take to nowhere, so that leaving does not fail over it."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def shortened(text: str) -> str:
    """A text for people, with the beginning of links to runs, and of other words as long as they."""
    return _LONG_WORD.sub(r"\1...", text)


def plain(text: str) -> str:
    """A text as one line: a file's name may hold anything, a new line or a terminal's control codes too."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in shortened(text))


def tell(lines: Iterable[str]) -> None:
    """Print lines on standard error."""
    for line in lines:
        print(plain(line), file=sys.stderr)


class Progress:
    """A bar on standard error where a person looks at it."""

    def __init__(self, total: int | None, unit: str = "tick") -> None:
        """total: None where nobody knows, 0 for no bar."""
        self.done = 0
        self._bar: Any = None
        if total != 0 and sys.stderr.isatty():
            from tqdm import tqdm

            self._bar = tqdm(total=total, unit=unit, leave=False)

    def __enter__(self) -> "Progress":
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()

    def update(self, count: int = 1) -> None:
        """Note that this many units are done."""
        self.done += count
        if self._bar is not None:
            self._bar.update(count)

    def note(self, text: str) -> None:
        """Show a few words behind the bar."""
        if self._bar is not None:
            self._bar.set_postfix_str(text)

    @contextmanager
    def aside(self) -> Iterator[None]:
        """Print other lines in this context, above the bar."""
        if self._bar is None:
            yield
            return
        with self._bar.external_write_mode(file=sys.stderr):
            yield


@contextmanager
def interrupted_between_ticks() -> Iterator[Callable[[], None]]:
    """Hold an interrupt back until the function given is called: it never strikes in the middle of a recorded line.

    Before the first call it strikes at once: a first tick may take half a minute, where edited kernels are compiled.
    Where the program was started with interrupts ignored, as `nohup` and shells do for jobs in the background, they
    stay so.
    """
    asked, begun = False, False

    def note(*_: object) -> None:
        nonlocal asked
        if asked or not begun:
            raise KeyboardInterrupt
        asked = True

    def look_up() -> None:
        nonlocal begun
        begun = True
        if asked:
            raise KeyboardInterrupt

    previous = signal.getsignal(signal.SIGINT)
    if previous is not signal.default_int_handler:
        yield look_up
        return
    signal.signal(signal.SIGINT, note)
    try:
        yield look_up
    finally:
        signal.signal(signal.SIGINT, previous)
