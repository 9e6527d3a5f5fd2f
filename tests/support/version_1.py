"""Recordings as the first version of the format wrote them: every hash at every tick, every array in every state."""

import json
from pathlib import Path

from sandbox.physics.snapshot import hash_by_array
from sandbox.session.replay.format import encode_state, seal
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session


def version_1(path: Path) -> bytes:
    """The bytes of a plain recording of this version, made anew as the first version would have written it."""
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    replay = read_replay(path)
    session = Session(replay.level, script=replay.script)
    chain, out = "", []
    for line in lines:
        del line["chain"]
        if "format" in line:
            line["version"] = 1
        elif "arrays" in line:
            if line["tick"]:
                session.advance()
            line["arrays"] = hash_by_array(session.world)
        elif "state" in line:
            line.update(encode_state(session.world))
        data, chain = seal(line, chain, version=1)
        out.append(data)
    return b"".join(out)
