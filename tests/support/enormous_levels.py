"""Levels that are enormous and malformed: large, deep, or large after expansion."""

from collections.abc import Iterator

MEGABYTE = 1024 * 1024
HEAD = b'{"format": "spring-sandbox/level", "version": 3, "name": "n", '
# Of what a level of 8 MiB is filled with [bytes].
SIZE = 8 * MEGABYTE - 200


def _many(item: bytes, count: int) -> bytes:
    """A list of equal items."""
    return (item + b",") * (count - 1) + item


def deep() -> Iterator[tuple[str, bytes]]:
    """Nested deeply, or nothing at all."""
    yield "larger than 8 MiB", b" " * (8 * MEGABYTE + 1)
    yield "8 MiB of blanks", b" " * (8 * MEGABYTE)
    for name, opening in (("lists", b"["), ("objects", b'{"a":')):
        for depth in (33, 1_000, SIZE // len(opening)):
            yield f"{depth} nested {name}", HEAD + b'"extras": ' + opening * depth
    yield "deep and closed", HEAD + b'"extras": {"a": ' + b"[" * 100_000 + b"]" * 100_000 + b"}}"
    yield "deep after quotes", HEAD + b'"extras": {"a\\\\": "\\"[", "b": ' + b"[" * 40 + b"]" * 40 + b"}}"


def of_many_parts() -> Iterator[tuple[str, bytes]]:
    """Lists of as many equal items as 8 MiB hold."""
    for name, item in (
        ("empty objects", b"{}"),
        ("numbers", b"1"),
        ("unknown keys", b'{"x":1}'),
        ("springs to nowhere", b'{"a":"x","b":"y"}'),
    ):
        for key in (b"springs", b"bodies", b"unknown"):
            count = SIZE // (len(item) + 1)
            yield f"8 MiB of {name} in {key.decode()}", HEAD + b'"%s": [' % key + _many(item, count) + b"]}"


def of_many_springs() -> Iterator[tuple[str, bytes]]:
    """Lists as long as the limits allow, of items of which none is right."""
    for count, item in ((390_000, b"{}"), (390_000, b"1"), (390_000, b'{"a":"x","b":"y"}'), (90_000, b'{"id":"a"}')):
        key = b"particles" if b"id" in item else b"springs"
        yield f"{count} times {item.decode()}", HEAD + b'"%s": [' % key + _many(item, count) + b"]}"


def of_bodies_with_long_lists() -> Iterator[tuple[str, bytes]]:
    """Bodies of many particles, cuts, pins and places, and welds."""
    mesh = b'"bodies": [{"type": "mesh", "id": "m", "particles": ['
    yield "1,000,000 particles", HEAD + mesh + _many(b"[0,0]", 1_000_000) + b"]}]}"
    yield "99,000 bad particles", HEAD + mesh + _many(b'["",1]', 99_000) + b"]}]}"
    rope_with = b'"bodies": [{"type":"rope","id":"r","start":[0,0],"end":[1,0],"segments":3,"%s":['
    yield "500,000 cuts", HEAD + rope_with % b"cut" + _many(b"1", 500_000) + b"]}]}"
    yield "99,000 bad cuts", HEAD + rope_with % b"cut" + _many(b'""', 99_000) + b"]}]}"
    yield "99,000 cuts of nothing", HEAD + rope_with % b"cut" + _many(b"77", 99_000) + b"]}]}"
    yield "200,000 pins", HEAD + rope_with % b"pinned" + _many(b"1", 200_000) + b"]}]}"
    yield "200,000 places", HEAD + rope_with % b"pose" + _many(b"[0,0]", 200_000) + b"]}]}"
    yield "150,000 welds", HEAD + b'"welds": [' + _many(b'["a","b"]', 150_000) + b"]}"
    yield "99,000 welds to nowhere", HEAD + b'"welds": [' + _many(b'["a","b"]', 99_000) + b"]}"


def of_many_keys() -> Iterator[tuple[str, bytes]]:
    """Objects of many keys."""
    keys = b",".join(b'"k%d":1' % number for number in range(600_000))
    yield "600,000 unknown keys", HEAD + keys + b"}"
    yield "600,000 bad materials", HEAD + b'"materials": {' + keys + b"}}"
    yield "one key a million times", HEAD + _many(b'"k":1', 1_000_000) + b"}"


def of_long_words() -> Iterator[tuple[str, bytes]]:
    """Texts and numbers of 8 MiB."""
    yield "8 MiB name", HEAD + b'"author": "' + b"x" * SIZE + b'"}'
    yield "8 MiB of escapes", HEAD + b'"author": "' + b"\\u0041" * (SIZE // 6) + b'"}'
    yield "8 MiB of backslashes", HEAD + b'"author": "' + b"\\" * SIZE + b'"}'
    yield "8 MiB of quotes", HEAD + b'"author": ' + b'"' * SIZE
    yield "8 MiB integer", HEAD + b'"extras": {"a": ' + b"9" * SIZE + b"}}"
    yield "8 MiB of fraction", HEAD + b'"settings": {"warm_start": 1.' + b"9" * SIZE + b"}}"
    yield "8 MiB of exponent", HEAD + b'"settings": {"warm_start": 1e' + b"9" * SIZE + b"}}"
    yield "8 MiB of 4,000 digits", HEAD + b'"extras": {"a": [' + _many(b"9" * 4_000, SIZE // 4_001) + b"]}}"


def large_after_expansion() -> Iterator[tuple[str, bytes]]:
    """Small files of bodies that are enormous."""
    rope = b'{"type":"rope","id":"r%d","start":[0,0],"end":[1,0],"segments":%d}'
    yield "ropes that add up", HEAD + b'"bodies": [' + b",".join(rope % (n, 2_000) for n in range(51)) + b"]}"
    yield "100 huge ropes", HEAD + b'"bodies": [' + b",".join(rope % (n, 10**12) for n in range(100)) + b"]}"
    yield "60,000 equal ids", HEAD + b'"bodies": [' + _many(rope % (0, 0), 60_000) + b"]}"
    zigzag = b",".join(b"[%d,%d]" % (n % 2 * 1000 + n, n) for n in range(5_000))
    jelly = b'{"type":"jelly","id":"j%d","spacing":%s,"shape":{"polygon":[%s]}}'
    yield "5,000 corners", HEAD + b'"bodies": [' + jelly % (0, b"1", zigzag) + b"]}"
    sliver = b"[0,0],[0.5,100000],[0.6,100000]"
    yield "slivers", HEAD + b'"bodies": [' + b",".join(jelly % (n, b"1", sliver) for n in range(300)) + b"]}"


# Large or deep: every level of each must be refused at once.
ENORMOUS = (
    deep, of_many_parts, of_many_springs, of_bodies_with_long_lists, of_many_keys, of_long_words, large_after_expansion,
)  # fmt: skip
