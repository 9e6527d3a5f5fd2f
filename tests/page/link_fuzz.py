"""Links that were changed by chance: values, counts, kits and names; what a page in node and the desktop say of each.

python -m tests.page.link_fuzz [links] [seed] tries many, and prints how they ended.
"""

import base64
import json
import random
import subprocess
import sys
import tempfile
import zlib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from sandbox.app.share.runs_for_pages import link_to
from sandbox.level.document.model import Level
from sandbox.level.format.slices import at_once
from sandbox.page.page import KERNELS, WEB
from sandbox.page.start import adding, start_of
from sandbox.physics.snapshot import state_hash
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.session.commands import (
    AddBody,
    AddParticle,
    AddSpring,
    CutSprings,
    Grab,
    MoveGrab,
    Pin,
    Release,
    Remove,
    SetDrive,
)
from sandbox.session.commands.records import script_of
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.link import MARK, level_record, replay_of, run_of
from sandbox.session.replay.recording import ReplayError
from sandbox.session.session import Session
from tests.page.in_node import NODE
from tests.session.test_kits import DEFINITIONS
from tests.support.parts import furnished, placed_cart

TICKS = 24
ODD = (
    0, 1, -1, 0.5, 2, 1e9, -1e9, 1e300, 2**31, 2**53, 10**400, None, True, "", "0", "toString", "__proto__",
    "constructor", "cube.0", "+1.0", [], {}, [0], [[]],
)  # fmt: skip
_PROGRAM = """
import { readFileSync } from 'node:fs';
import { monitorEventLoopDelay } from 'node:perf_hooks';
import { Refusal } from 'WEB/commands.js';
import { linked } from 'WEB/link.js';
import { verified } from 'WEB/recording.js';
import { World } from 'WEB/world.js';
const [folder, kernels] = process.argv.slice(1);
const { about, link, fragments } = JSON.parse(readFileSync(`${folder}/given.json`, 'utf8'));
const image = new Uint8Array(readFileSync(`${folder}/image`));
const module = await WebAssembly.compile(readFileSync(kernels));
const fresh = () => new World(new WebAssembly.Instance(module, {}).exports, image, about);
const said = [];
for (const fragment of fragments) {
  const delay = monitorEventLoopDelay({ resolution: 5 });
  delay.enable();
  let words = 'verified';
  try {
    const [recording] = await linked(fragment, link);
    const wrong = await verified(fresh(), recording, () => {});
    if (wrong) words = `not verified: ${wrong.words || 'other bits'}`;
  } catch (error) {
    words = error instanceof Refusal ? `refused: ${error.message}` : `fault: ${error.stack}`;
  }
  delay.disable();
  said.push([words, Math.round(delay.max / 1e6)]);
}
console.log(JSON.stringify(said));
"""


def base_runs() -> list[dict[str, Any]]:
    """What links to short runs hold, by which everything can be made, cut, pinned, taken out and driven."""
    found = []
    for kinds in (("jelly", "cart"), ("rope", "wheel", "weak"), ("ring", "in pieces"), ()):
        session = Session(furnished())
        world = session.world
        session.submit(Grab(0, world.particle_slot("cube.0"), (1.0, 2.0)))
        session.submit(AddParticle((0.5, 6.0), velocity=(1.0, 0.0)))
        session.advance()
        for kind in kinds:
            definition = placed_cart(0.0, 3.0) if kind == "cart" else DEFINITIONS[kind]
            session.submit(AddBody(**definition))
            session.advance()
        session.submit(MoveGrab(0, (1.5, 2.5)))
        session.submit(AddSpring(world.particle_slot("+.0"), world.particle_slot("cube.1")))
        session.submit(CutSprings((world.spring_slot("rope:2"),)))
        session.submit(Pin(world.particle_slot("cube.2")))
        for part in range(len(world.actuators.names)):
            session.submit(SetDrive(part, 1.0))
        session.advance()
        session.submit(Release(0))
        session.submit(Remove(particle=world.particle_slot("ball")))
        while session.tick < TICKS:
            session.advance()
        assert not session.messages, session.messages
        script = script_of(session.history.timeline, world)
        replay = run_of("run", session.level, script, session.tick, state_hash(world))
        found.append(unpacked(at_once(link_to(replay, "", 0))))
    return found


def unpacked(link: str) -> dict[str, Any]:
    text = link.partition(f"{MARK}")[2]
    plain: dict[str, Any] = json.loads(zlib.decompress(base64.urlsafe_b64decode(text + "=" * (-len(text) % 4)), -15))
    return plain


def fragment_of(data: Any) -> str:
    """The fragment of a link that holds this."""
    packer = zlib.compressobj(6, zlib.DEFLATED, -15)
    whole = packer.compress(json.dumps(data).encode()) + packer.flush()
    return f"#{MARK}" + base64.urlsafe_b64encode(whole).decode().rstrip("=")


def _places(data: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Where something lies, in lists and tables inside each other."""
    if path:
        yield path
    items = enumerate(data) if isinstance(data, list) else data.items() if isinstance(data, dict) else ()
    for key, value in items:
        yield from _places(value, (*path, key))


def changed(data: dict[str, Any], chance: random.Random) -> dict[str, Any]:
    """What a link holds with one to three things changed in its commands."""
    made: dict[str, Any] = json.loads(json.dumps(data))
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        if not isinstance(made.get("commands"), list):
            break
        records = [entry[2] for entry in made["commands"] if isinstance(entry, list) and len(entry) == 3]
        kits = [record["kit"] for record in records if isinstance(record, dict) and isinstance(record.get("kit"), dict)]
        roots: list[Any] = [made["commands"], *kits, *kits] if kits and chance.random() < 0.95 else [made]
        root = chance.choice(roots)
        places = list(_places(root))
        if not places:
            continue
        *way, last = chance.choice(places)
        holder = root
        for key in way:
            holder = holder[key]
        before, what = holder[last], chance.random()
        if what < 0.12:
            del holder[last]
        elif what < 0.22 and isinstance(holder, list):
            holder.insert(last, before)
        elif what < 0.3 and isinstance(holder, dict):
            holder[chance.choice(("toString", "__proto__", "constructor", "bodies", "mass"))] = holder.pop(last)
        elif what < 0.6 and isinstance(before, int | float) and not isinstance(before, bool):
            holder[last] = chance.choice((before + 1, before - 1, -before, before * 1e6, before * 0.5, before + 1e-9))
        else:
            holder[last] = chance.choice(ODD)
    return made


def in_node(folder: Path, level: Level, fragments: list[str]) -> list[tuple[str, int]]:
    """What a page says of each link, and its longest time without a pause [ms]."""
    world = Session(level).world
    start = start_of(world)
    given = {
        "about": start.about | {"adding": adding(world) | {"made": {"firm": 0.85}}},
        "link": level_record(level) | {"physics": PHYSICS_VERSION},
        "fragments": fragments,
    }
    (folder / "given.json").write_text(json.dumps(given), encoding="utf-8")
    (folder / "image").write_bytes(start.image.content)
    arguments = [
        str(NODE),
        "--input-type=module",
        "--eval",
        _PROGRAM.replace("WEB", WEB.as_uri()),
        str(folder),
        str(KERNELS),
    ]
    ended = subprocess.run(arguments, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr[-3000:]
    return [(words, delay) for words, delay in json.loads(ended.stdout)]


def on_the_desktop(fragment: str) -> str:
    """What the desktop says of a link."""
    try:
        wrong = verify(replay_of(fragment))
    except ReplayError as error:
        return f"refused: {error}"
    return "verified" if wrong is None else f"not verified: {wrong}"


def tried(folder: Path, count: int, seed: int) -> list[tuple[str, str, int]]:
    """So many changed links: each fragment, what a page says, and its longest time without a pause [ms]."""
    chance, bases = random.Random(seed), base_runs()
    fragments = [fragment_of(changed(chance.choice(bases), chance)) for _ in range(count)]
    said = in_node(folder, furnished(), fragments)
    return [(fragment, words, delay) for fragment, (words, delay) in zip(fragments, said, strict=True)]


def _main(count: int = 10_000, seed: int = 1) -> None:
    kinds, longest, wrong = Counter[str](), 0, 0
    for part in range(0, count, 500):
        with tempfile.TemporaryDirectory() as folder:
            for fragment, words, delay in tried(Path(folder), min(500, count - part), seed + part):
                kinds[words.partition(":")[0]] += 1
                longest = max(longest, delay)
                here = on_the_desktop(fragment) if words == "verified" else ""
                if words.startswith("fault") or (words == "verified" and here != "verified"):
                    wrong += 1
                    print(words, here, flush=True)
        print(part, dict(kinds), f"longest {longest} ms, wrong {wrong}", flush=True)


if __name__ == "__main__":
    _main(*map(int, sys.argv[1:]))
