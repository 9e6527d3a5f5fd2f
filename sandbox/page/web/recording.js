// Recording: a run written line by line as the desktop's recordings are, and the run of a recording compared.
import { blake2b } from './hash.js';
import { RECORDING } from './shared.js';
import { canonical } from './world.js';

const { TICK_DIGITS, ARRAY_DIGITS, CHAIN_DIGITS, STATE_TICKS } = RECORDING, SLICE = 12;
const encoder = new TextEncoder();
// So that the page goes on meanwhile [ms].
const pause = () => new Promise((resolve) => setTimeout(resolve));

// Run commands on a world from its start; gives every tick its hash, and the commands that follow it.
async function* repeated(world, commands, ticks) {
  let next = 0, since = performance.now();
  for (;;) {
    const hash = world.hash(), first = next;
    while (next < commands.length && commands[next].tick === world.time) next += 1;
    yield { hash, commands: commands.slice(first, next) };
    for (const done of commands.slice(first, next)) world.carryOut(done);
    if (world.time >= ticks) return;
    world.tick();
    if (performance.now() - since > SLICE) {
      await pause();
      since = performance.now();
    }
  }
}

// The first tick of a recording that has not the hash that it says; null: each has.
export async function verified(world, { commands, hashes }) {
  for await (const { hash } of repeated(world, commands, hashes.length - 1)) {
    if (!hash.whole.startsWith(hashes[world.time])) return world.time;
  }
  return null;
}

// The file of a run, compressed. world: a fresh one; about: the table; header: the first line without its end.
export async function written(world, about, header, commands, ticks, progress) {
  const lines = [], columns = new Map(about.columns.map((column) => [column.stored, column]));
  let chain = '', before = new Map(), stored = new Map();
  const write = (body) => {
    chain = blake2b(encoder.encode(chain + body), 16);
    lines.push(`${body}, "chain": "${chain.slice(0, CHAIN_DIGITS)}"}\n`);
  };
  const line = (values) => write(spaced(values).slice(0, -1));
  const writeState = async (hash) => {
    const present = new Map([...columns].map(([name, column]) =>
      [name, `${hash.arrays.get(name)} ${world.rows(column).length}`]));
    const state = {};
    for (const [name, column] of columns) {
      if (present.get(name) !== stored.get(name)) state[name] = await packed(canonical(world.rows(column)));
    }
    stored = present;
    line({ tick: world.time, state, settings: world.settings() });
  };
  write(header);
  let last = null;
  for await (const { hash, commands: due } of repeated(world, commands, ticks)) {
    const isStored = world.time % STATE_TICKS === 0, arrays = {};
    for (const name of columns.keys()) {
      const digest = hash.arrays.get(name);
      if (isStored ? digest : digest !== before.get(name)) arrays[name] = digest ? digest.slice(0, ARRAY_DIGITS) : null;
    }
    before = hash.arrays;
    line({ tick: world.time, hash: isStored ? hash.whole : hash.whole.slice(0, TICK_DIGITS), arrays });
    if (isStored) await writeState(hash);
    for (const { gesture, record, changes } of due) {
      line({ tick: world.time, gesture, command: changes ? record : world.commands.named(record) });
    }
    last = { hash, isStored, isChanged: due.length > 0 };
    progress(world.time, ticks);
  }
  if (!last.isStored && !last.isChanged) await writeState(last.hash);
  line({ end: true, tick: world.time, hash: world.hash().whole });
  return new Blob([new Uint8Array(await through(encoder.encode(lines.join('')), new CompressionStream('gzip')))]);
}

// JSON with the spaces that Python puts into it.
function spaced(value) {
  if (Array.isArray(value)) return `[${value.map(spaced).join(', ')}]`;
  if (value === null || typeof value !== 'object') return JSON.stringify(value);
  return `{${Object.entries(value).map(([key, each]) => `${JSON.stringify(key)}: ${spaced(each)}`).join(', ')}}`;
}

async function packed(bytes) {
  const content = await through(bytes, new CompressionStream('deflate'));
  let text = '';
  for (let k = 0; k < content.length; k += 0x8000) text += String.fromCharCode(...content.subarray(k, k + 0x8000));
  return btoa(text);
}

async function through(bytes, stream) {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}
