"""Replay and command files with things done to them: refused in clear lines or read, soon, and in little memory.

Prints how many were refused and read, the longest time [s of CPU], and the memory [MB] beyond an idle process.
"""

import argparse
import gzip
import json
import random
import resource
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay, read_script
from sandbox.session.replay.recording import ReplayError
from sandbox.session.session import Session
from tests.support.limits import Limits
from tests.support.malformed_replays import compressed, sealed
from tests.support.play import play
from tests.support.rope_level import rope_level

# The longest that a file may take [s of CPU], and the most memory that all may [MB].
LONGEST, MOST_MEMORY = 2.0, 300.0
TOKENS = [
    b"",
    b"null",
    b"-1",
    b"1e400",
    b"[]",
    b"{}",
    b'""',
    b"[" * 500,
    b"9" * 400,
    b"\x00",
    b"\xff",
    b'"',
    b"\n",
    b",",
]
VALUES = [None, -1, 2**70, 1e308, "", "x" * 5_000_000, [], {}, [[]] * 200_000, {"a": 1}, True, "position", 0.5]


def recording(folder: Path) -> bytes:
    """A short recording with commands."""
    path = folder / "good.jsonl"
    session = Session(rope_level())
    session.record_to(path, state_ticks=60)
    play(session, 65)
    session.stop_recording()
    return path.read_bytes()


def mutated(data: bytes, chance: random.Random) -> bytes:
    """Bytes flipped, cut, doubled, or replaced by others."""
    data = bytes(data)
    for _ in range(chance.choice((1, 1, 2, 5))):
        start = chance.randrange(len(data) + 1)
        end = min(len(data), start + chance.choice((0, 1, 1, 4, 40, 4000)))
        data = data[:start] + chance.choice((*TOKENS, data[start:end] * 2)) + data[end:]
    return data


def forged(data: bytes, chance: random.Random) -> bytes:
    """A recording with values replaced, and sealed anew."""
    lines = [json.loads(line) for line in data.splitlines()]
    for _ in range(chance.choice((1, 1, 3))):
        holder = chance.choice(lines)
        while True:
            key = chance.choice(list(holder) or ["a"])
            inside = holder.get(key)
            if isinstance(inside, dict) and inside and chance.random() < 0.7:
                holder = inside
            else:
                holder[key] = chance.choice(VALUES)
                break
    return sealed(lines)


def attempt(read: Callable[[Path], object], path: Path, told: Counter[str]) -> float:
    """Read a file; the CPU time that it took [s]. What is raised besides ReplayError ends the script."""
    start = time.process_time()
    try:
        read(path)
    except ReplayError as error:
        assert 1 <= len(error.faults) <= 50
        assert all("\n" not in fault and len(fault) < 1000 for fault in error.faults)
        told["refused"] += 1
    else:
        told["read"] += 1
    return time.process_time() - start


def replays(limits: Limits, count: int, folder: Path) -> None:
    """Mutated replay files, plain, compressed, and forged."""
    good, told, longest = recording(folder), Counter[str](), 0.0
    idle = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    path = folder / "case"
    for number in range(count):
        chance = random.Random(number)
        plain = chance.choice((mutated, forged))(good, chance)
        path.write_bytes(chance.choice((lambda data: data, compressed, gzip.compress))(plain))
        if chance.random() < 0.1:
            path.write_bytes(mutated(path.read_bytes(), chance))
        longest = max(longest, attempt(lambda path: verify(read_replay(path, partial=True)), path, told))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(f"{count} replays: {dict(told)}")
    limits.at_most("longest [s]", longest, LONGEST)
    limits.at_most("memory above the empty process [MB]", (peak - idle) / 1024, MOST_MEMORY)


def scripts(limits: Limits, count: int, folder: Path) -> None:
    """Mutated command files."""
    good = recording(folder)
    kept = [json.loads(line) for line in good.splitlines() if b'"command"' in line]
    for line in kept:
        del line["chain"]
    text = b"\n".join(json.dumps(line).encode() for line in kept)
    told, longest, path = Counter[str](), 0.0, folder / "case"
    for number in range(count):
        path.write_bytes(mutated(text, random.Random(number)))
        longest = max(longest, attempt(read_script, path, told))
    path.write_bytes(b'{"tick": 1, "command": {"type": "undo"}}\n' * 249_000)
    start, idle = time.process_time(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    read_script(path)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(f"{count} scripts: {dict(told)}")
    limits.at_most("longest [s]", longest, LONGEST)
    limits.at_most("memory of the longest script allowed [MB]", (peak - idle) / 1024, MOST_MEMORY)
    print(f"the longest script allowed: {time.process_time() - start:.1f} s")


def main(arguments: list[str] | None = None) -> int:
    """Print what came of them; 1 where a limit is broken."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--all", action="store_true", help="10,000 replays and 1,000 scripts")
    everything, limits = parser.parse_args(arguments).all, Limits()
    with tempfile.TemporaryDirectory() as folder:
        replays(limits, 10_000 if everything else 300, Path(folder))
        scripts(limits, 1_000 if everything else 100, Path(folder))
    return int(limits.broken)


if __name__ == "__main__":
    sys.exit(main())
