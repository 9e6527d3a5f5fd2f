"""Malformed replays: each is a name, its bytes, and what is wrong with it."""

import gzip
import io
import json
import random
from collections.abc import Callable, Iterator
from typing import Any

from sandbox.session.replay.format import level_digest, seal

Lines = list[dict[str, Any]]


def sealed(lines: Lines) -> bytes:
    """The lines as a file whose chain is whole, as a careful forger would write them."""
    chain, out = "", []
    for values in lines:
        data, chain = seal({key: value for key, value in values.items() if key != "chain"}, chain)
        out.append(data)
    return b"".join(out)


def compressed(data: bytes) -> bytes:
    """Bytes as a Recorder compresses them."""
    out = io.BytesIO()
    with gzip.GzipFile(filename="", mode="wb", compresslevel=9, fileobj=out, mtime=0) as file:
        file.write(data)
    return out.getvalue()


def cases(good: bytes) -> Iterator[tuple[str, bytes]]:
    """Malformed files made from the bytes of a good replay."""
    lines = [json.loads(line) for line in good.splitlines()]
    yield from _raw_cases(good)
    yield from _forged_cases(lines)
    generator = random.Random(3)
    for number in range(20):
        shorter = bytearray(good)
        for _ in range(1 + number):
            del shorter[generator.randrange(len(shorter))]
        yield f"{number + 1} bytes missing", bytes(shorter)


def _raw_cases(good: bytes) -> Iterator[tuple[str, bytes]]:
    lines = good.splitlines(keepends=True)
    yield "empty", b""
    yield "only a newline", b"\n"
    yield "binary", bytes(range(256)) * 40
    yield "not json", b"hello\nworld\n"
    yield "a json list", b"[]\n"
    yield "a json number", b"3\n"
    yield "null", b"null\n"
    yield "deep nesting", b"[" * 100_000 + b"]" * 100_000 + b"\n"
    yield "deep objects", b'{"a":' * 50_000 + b"1" + b"}" * 50_000 + b"\n"
    yield "a level", b'{"format": "spring-sandbox/level", "version": 3, "name": "x"}\n'
    yield "utf-16", good.decode().encode("utf-16")
    yield "invalid utf-8", good[:50] + b"\xff\xfe" + good[50:]
    yield "nul bytes", b"\0" * 1000
    yield "a huge integer", b'{"format": "spring-sandbox/replay", "version": ' + b"9" * 10_000 + b"}\n"
    yield "first line gone", b"".join(lines[1:])
    yield "second line gone", b"".join([lines[0], *lines[2:]])
    yield "last line gone", b"".join(lines[:-1])
    yield "last byte gone", good[:-1]
    yield "lines swapped", b"".join([*lines[:3], lines[4], lines[3], *lines[5:]])
    yield "a line twice", b"".join([*lines[:5], lines[4], *lines[5:]])
    yield "text after the end", good + b"and more\n"
    yield "two recordings", good + good
    yield "header only", lines[0]
    yield "gzip of nothing", gzip.compress(b"", mtime=0)
    yield "cut gzip", gzip.compress(good, mtime=0)[:-20]
    yield "gzip magic and rubbish", b"\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\xff" + b"rubbish" * 20


def _forged_cases(lines: Lines) -> Iterator[tuple[str, bytes]]:
    """Files whose chain fits, so that what they say is what must be refused."""

    def changed(number: int, change: Callable[[dict[str, Any]], Any]) -> bytes:
        copies = json.loads(json.dumps(lines))
        change(copies[number])
        if number == 0 and isinstance(copies[0].get("level"), dict):
            copies[0]["level_sha256"] = level_digest(copies[0]["level"])
        return sealed(copies)

    tick = next(place for place, line in enumerate(lines) if line.get("tick") == 3 and "arrays" in line)
    state = next(place for place, line in enumerate(lines) if "state" in line)
    command = next(place for place, line in enumerate(lines) if "command" in line)
    for key, value in (
        ("version", 3), ("version", "2"), ("version", True), ("physics_version", 999), ("physics_version", None),
        ("sandbox_version", 5), ("format", "spring-sandbox/level"), ("format", None), ("level", []), ("level", None),
        ("level", {}), ("level", {"format": "spring-sandbox/level", "version": 3}), ("surprise", 1),
    ):  # fmt: skip
        yield f"header {key} {value!r}", changed(0, lambda line, k=key, v=value: line.__setitem__(k, v))
    yield "level refused", changed(0, lambda line: line["level"].__setitem__("settings", {"tick_rate": 0}))
    for key in ("format", "version", "physics_version", "sandbox_version", "level"):
        yield f"header without {key}", changed(0, lambda line, k=key: line.pop(k))
    for key, value in (("tick", 2), ("tick", -1), ("tick", 3.5), ("tick", True), ("tick", "3"), ("hash", 7),
                       ("hash", ""), ("arrays", {"a": "0"}), ("arrays", []), ("arrays", {"position": 3}),
                       ("noise", 0)):  # fmt: skip
        yield f"tick line {key} {value!r}", changed(tick, lambda line, k=key, v=value: line.__setitem__(k, v))
    for key, value in (("tick", 10**6), ("gesture", -1), ("gesture", 1.5), ("gesture", True), ("command", []),
                       ("command", "undo"), ("surprise", 0)):  # fmt: skip
        yield f"command {key} {value!r}", changed(command, lambda line, k=key, v=value: line.__setitem__(k, v))
    for key, value in (("state", []), ("state", {"position": 3}), ("settings", {}), ("settings", None), ("tick", 59)):
        yield f"state {key} {value!r}", changed(state, lambda line, k=key, v=value: line.__setitem__(k, v))
    yield "wrong level digest", sealed([{**lines[0], "level_sha256": "0" * 64}, *lines[1:]])
    yield "an unknown line", sealed([*lines[:2], {"note": "hello"}, *lines[2:]])
    yield "ticks out of order", sealed([*lines[:tick], *lines[tick + 1 :]])
    yield "end twice", sealed([*lines, lines[-1]])


def bad_commands() -> Iterator[tuple[str, Any]]:
    """Command objects that a forger might put into a recording."""
    yield "unknown type", {"type": "explode"}
    yield "no type", {}
    yield "type is a list", {"type": ["pin"]}
    yield "unknown particle", {"type": "pin", "particle": "nobody.3"}
    yield "slot instead of a name", {"type": "pin", "particle": 3}
    yield "surprise key", {"type": "pin", "particle": "rope.3", "hard": True}
    yield "missing key", {"type": "pin"}
    yield "boolean as a number", {"type": "set_coefficients", "stiffness": True}
    yield "text as a number", {"type": "set_coefficients", "stiffness": "0.5"}
    yield "above the limit", {"type": "set_coefficients", "stiffness": 1.5}
    yield "unknown material", {"type": "set_coefficients", "stiffness": 0.5, "material": "gold"}
    yield "a point of three", {"type": "grab", "grab": 0, "particle": "rope.3", "target": [1, 2, 3]}
    yield "a hand of no strength", {"type": "grab", "grab": 0, "particle": "rope.3", "target": [1, 2], "strength": 0}
    yield "an endless grip", {"type": "grab", "grab": 0, "particle": "rope.3", "target": [1, 2], "radius": 1e300}
    yield "hand 99", {"type": "grab", "grab": 99, "particle": "rope.3", "target": [1, 2]}
    yield "far away", {"type": "grab", "grab": 0, "particle": "rope.3", "target": [1e300, 0]}
    yield "springs is text", {"type": "cut_springs", "springs": "rope:3"}
    yield "unknown spring", {"type": "cut_springs", "springs": ["rope:3000"]}
    yield "negative mass", {"type": "add_particle", "position": [0, 0], "mass": -1}
    yield "substeps 3", {"type": "set_solver", "substeps": 3}
    yield "unknown solver", {"type": "set_solver", "solver": "magic"}
    yield "release of nothing", {"type": "release", "grab": 0}
    yield "a hand's own particle", {"type": "pin", "particle": "+hand.0"}
    yield "nothing to redo", {"type": "redo"}
