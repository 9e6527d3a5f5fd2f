"""Levels that are enormous and malformed: large, deep, or large after expansion."""

from collections.abc import Iterator

MEGABYTE = 1024 * 1024


def enormous() -> Iterator[tuple[str, bytes]]:
    """Large or deep; every one must be refused at once."""
    head = b'{"format": "spring-sandbox/level", "version": 1, "name": "n", '
    size = 8 * MEGABYTE - 200
    yield "larger than 8 MiB", b" " * (8 * MEGABYTE + 1)
    yield "8 MiB of blanks", b" " * (8 * MEGABYTE)
    for name, opening in (("lists", b"["), ("objects", b'{"a":')):
        for depth in (33, 1_000, size // len(opening)):
            yield f"{depth} nested {name}", head + b'"extras": ' + opening * depth
    yield "deep and closed", head + b'"extras": {"a": ' + b"[" * 100_000 + b"]" * 100_000 + b"}}"
    yield "deep after quotes", head + b'"extras": {"a\\\\": "\\"[", "b": ' + b"[" * 40 + b"]" * 40 + b"}}"
    for name, item in (
        ("empty objects", b"{}"),
        ("numbers", b"1"),
        ("unknown keys", b'{"x":1}'),
        ("springs to nowhere", b'{"a":"x","b":"y"}'),
    ):
        for key in (b"springs", b"bodies", b"unknown"):
            count = size // (len(item) + 1)
            yield f"8 MiB of {name} in {key.decode()}", head + b'"%s": [' % key + b",".join([item] * count) + b"]}"
    for count, item in ((390_000, b"{}"), (390_000, b"1"), (390_000, b'{"a":"x","b":"y"}'), (90_000, b'{"id":"a"}')):
        key = b"particles" if b"id" in item else b"springs"
        yield f"{count} times {item.decode()}", head + b'"%s": [' % key + b",".join([item] * count) + b"]}"
    mesh = b'"bodies": [{"type": "mesh", "id": "m", "particles": ['
    yield "1,000,000 particles", head + mesh + b",".join([b"[0,0]"] * 1_000_000) + b"]}]}"
    yield "99,000 bad particles", head + mesh + b",".join([b'["",1]'] * 99_000) + b"]}]}"
    rope_with = b'"bodies": [{"type":"rope","id":"r","start":[0,0],"end":[1,0],"segments":3,"%s":['
    yield "500,000 cuts", head + rope_with % b"cut" + b",".join([b"1"] * 500_000) + b"]}]}"
    yield "99,000 bad cuts", head + rope_with % b"cut" + b",".join([b'""'] * 99_000) + b"]}]}"
    yield "99,000 cuts of nothing", head + rope_with % b"cut" + b",".join([b"77"] * 99_000) + b"]}]}"
    yield "200,000 pins", head + rope_with % b"pinned" + b",".join([b"1"] * 200_000) + b"]}]}"
    yield "200,000 places", head + rope_with % b"pose" + b",".join([b"[0,0]"] * 200_000) + b"]}]}"
    yield "150,000 welds", head + b'"welds": [' + b",".join([b'["a","b"]'] * 150_000) + b"]}"
    yield "99,000 welds to nowhere", head + b'"welds": [' + b",".join([b'["a","b"]'] * 99_000) + b"]}"
    keys = b",".join(b'"k%d":1' % number for number in range(600_000))
    yield "600,000 unknown keys", head + keys + b"}"
    yield "600,000 bad materials", head + b'"materials": {' + keys + b"}}"
    yield "one key a million times", head + b",".join([b'"k":1'] * 1_000_000) + b"}"
    yield "8 MiB name", head + b'"author": "' + b"x" * size + b'"}'
    yield "8 MiB of escapes", head + b'"author": "' + b"\\u0041" * (size // 6) + b'"}'
    yield "8 MiB of backslashes", head + b'"author": "' + b"\\" * size + b'"}'
    yield "8 MiB of quotes", head + b'"author": ' + b'"' * size
    yield "8 MiB integer", head + b'"extras": {"a": ' + b"9" * size + b"}}"
    yield "8 MiB of fraction", head + b'"settings": {"warm_start": 1.' + b"9" * size + b"}}"
    yield "8 MiB of exponent", head + b'"settings": {"warm_start": 1e' + b"9" * size + b"}}"
    yield "8 MiB of 4,000 digits", head + b'"extras": {"a": [' + b",".join([b"9" * 4_000] * (size // 4_001)) + b"]}}"
    rope = b'{"type":"rope","id":"r%d","start":[0,0],"end":[1,0],"segments":%d}'
    yield "ropes that add up", head + b'"bodies": [' + b",".join(rope % (n, 2_000) for n in range(51)) + b"]}"
    yield "100 huge ropes", head + b'"bodies": [' + b",".join(rope % (n, 10**12) for n in range(100)) + b"]}"
    yield "60,000 equal ids", head + b'"bodies": [' + b",".join([rope % (0, 0)] * 60_000) + b"]}"
    zigzag = b",".join(b"[%d,%d]" % (n % 2 * 1000 + n, n) for n in range(5_000))
    jelly = b'{"type":"jelly","id":"j%d","spacing":%s,"shape":{"polygon":[%s]}}'
    yield "5,000 corners", head + b'"bodies": [' + jelly % (0, b"1", zigzag) + b"]}"
    sliver = b"[0,0],[0.5,100000],[0.6,100000]"
    yield "slivers", head + b'"bodies": [' + b",".join(jelly % (n, b"1", sliver) for n in range(300)) + b"]}"
