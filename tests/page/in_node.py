"""A world of a page in node, which needs no browser: commands tried on it, each from the same state."""

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

from sandbox.app.draw.scene import made_looks
from sandbox.app.share.playing import materials_for
from sandbox.page.page import KERNELS, WEB
from sandbox.page.start import adding, start_of
from sandbox.physics.world import World

NODE = shutil.which("node")
_PROGRAM = """
import { readFileSync } from 'node:fs';
import { Commands, Refusal } from 'WEB/commands.js';
import { Run } from 'WEB/run.js';
import { World } from 'WEB/world.js';
const [folder, kernels] = process.argv.slice(1);
const { about, before, tried, areSlots } = JSON.parse(readFileSync(`${folder}/given.json`, 'utf8'));
const image = new Uint8Array(readFileSync(`${folder}/image`));
const module = await WebAssembly.compile(readFileSync(kernels));
const world = new World(new WebAssembly.Instance(module, {}).exports, image, about), run = new Run(world);
const read = (text) => world.commands.read((0, eval)(`(${text})`), world.counts);
for (const text of before) run.command(read(text), 1);
world.tick();
const start = world.save(), said = [];
const isTouched = () => about.kept.some((path) => world.view(path).some((value, k) =>
  !Object.is(value, start.arrays.get(path)[k])));
for (const text of tried) {
  let words = 'taken', isChanged = false;
  try {
    const record = areSlots ? eval(`(${text})`) : read(text);
    world.command(record, areSlots ? world.givers.PROGRAM : world.givers.HAND);
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    words = error.message;
    isChanged = isTouched();
  }
  said.push({ words, isChanged, hash: world.hash().whole });
  world.restore(start);
}
console.log(JSON.stringify(said));
"""


def tried_in_node(
    folder: Path, world: World, before: list[Any], tried: list[Any], are_slots: bool = False
) -> list[dict[str, Any]]:
    """What comes of each record, after others and a tick, in a page of a world at its start: words, hash, whether a
    refused one has changed anything. are_slots: what is tried has slots, and goes to the kernel as it is."""
    start = start_of(world)
    added = adding(world) | {"made": made_looks() | materials_for(world.settings.tick_rate)}
    given = {
        "about": start.about | {"adding": added},
        "before": list(map(literal, before)),
        "tried": list(map(literal, tried)),
    }
    given["areSlots"] = are_slots
    (folder / "given.json").write_text(json.dumps(given), encoding="utf-8")
    (folder / "image").write_bytes(start.image.content)
    program = _PROGRAM.replace("WEB", WEB.as_uri())
    arguments = [str(NODE), "--input-type=module", "--eval", program, str(folder), str(KERNELS)]
    ended = subprocess.run(arguments, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr[-3000:]
    found: list[dict[str, Any]] = json.loads(ended.stdout)
    return found


def literal(record: Any) -> str:
    """A record as JavaScript writes it; JSON, but for what is not finite."""
    return json.dumps(record, ensure_ascii=False)
