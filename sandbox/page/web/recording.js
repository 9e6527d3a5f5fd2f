// Recording: a run written line by line as the desktop's recordings are, and the run of a recording compared.
import { Refusal } from './commands.js';
import { blake2b, canonical } from './hash.js';
import { RECORDING } from './shared.js';
/** @import { About, Done, Recording, StateHash } from './types.js' */
/** @import { World } from './world.js' */

const { TICK_DIGITS, ARRAY_DIGITS, CHAIN_DIGITS, STATE_TICKS } = RECORDING, SLICE = 12;
const encoder = new TextEncoder();
/** So that the page goes on meanwhile [ms].
 * @type {() => Promise<void>} */
const pause = () => new Promise((resolve) => setTimeout(resolve));

/** Run commands on a world from its start; gives of every tick the commands that follow it, before they do. Throws a
 * Refusal at one that may not be. pausing: called with the ticks that are done, between slices.
 * @type {(world: World, commands: Done[], ticks: number, pausing?: (done: number) => void) => AsyncGenerator<Done[]>} */
async function* repeated(world, commands, ticks, pausing = () => {}) {
  let next = 0, since = performance.now();
  for (;;) {
    const first = next;
    while (next < commands.length && commands[next].tick === world.time) next += 1;
    const due = commands.slice(first, next);
    yield due;
    for (const done of due) {
      world.carryOut(done);
      if (performance.now() - since > SLICE) {
        await pause();
        since = performance.now();
      }
    }
    if (world.time >= ticks) return;
    world.tick();
    if (performance.now() - since > SLICE) {
      pausing(world.time);
      await pause();
      since = performance.now();
    }
  }
}

/** Where a recording, carried out as by hand, is not what it says: the tick, and why its command may not be; '': its bits
 * are others. null: it is. progress: told of the ticks that are done, between slices; ticked: called at each of them.
 * @type {(world: World, recording: Recording, progress: (done: number) => void, ticked?: () => void) => Promise<{
 *   tick: number, words: string } | null>} */
export async function verified(world, { commands, hashes, end }, progress, ticked = () => {}) {
  const ticks = repeated(world, commands.map((done) => ({ ...done })), hashes.length - 1, progress);
  try {
    while (!(await ticks.next()).done) {
      const hash = hashes[world.time];
      if (hash !== undefined && !world.hash().whole.startsWith(hash)) return { tick: world.time, words: '' };
      ticked();
    }
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    return { tick: world.time, words: error.message };
  }
  return end === undefined || world.hash().whole === end ? null : { tick: world.time, words: '' };
}

/** The file of a run, compressed. world: a fresh one; about: the table; header: the first line without its end.
 * @type {(world: World, about: About, header: string, commands: Done[], ticks: number, progress: (done: number,
 *   all: number) => void) => Promise<Blob>} */
export async function written(world, about, header, commands, ticks, progress) {
  /** @type {string[]} */
  const lines = [];
  const columns = new Map(about.columns.map((column) => [column.stored, column]));
  let chain = '', before = /** @type {Map<string, string>} */ (new Map());
  let stored = /** @type {Map<string, string>} */ (new Map());
  /** @type {(body: string) => void} */
  const write = (body) => {
    chain = blake2b(encoder.encode(chain + body), 16);
    lines.push(`${body}, "chain": "${chain.slice(0, CHAIN_DIGITS)}"}\n`);
  };
  /** @type {(values: object) => void} */
  const line = (values) => write(spaced(values).slice(0, -1));
  /** @type {(hash: StateHash) => Promise<void>} */
  const writeState = async (hash) => {
    const present = new Map([...columns].map(([name, column]) =>
      [name, `${hash.arrays.get(name)} ${world.rows(column).length}`]));
    /** @type {Record<string, string>} */
    const state = {};
    for (const [name, column] of columns) {
      if (present.get(name) !== stored.get(name)) state[name] = await packed(canonical(world.rows(column)));
    }
    stored = present;
    line({ tick: world.time, state, settings: world.settings() });
  };
  write(header);
  /** @type {{ hash: StateHash, isStored: boolean, isChanged: boolean } | null} */
  let last = null;
  for await (const due of repeated(world, commands, ticks)) {
    const hash = world.hash(), isStored = world.time % STATE_TICKS === 0;
    /** @type {Record<string, string | null>} */
    const arrays = {};
    for (const name of columns.keys()) {
      const digest = hash.arrays.get(name);
      if (isStored ? digest : digest !== before.get(name)) arrays[name] = digest ? digest.slice(0, ARRAY_DIGITS) : null;
    }
    before = hash.arrays;
    line({ tick: world.time, hash: isStored ? hash.whole : hash.whole.slice(0, TICK_DIGITS), arrays });
    if (isStored) await writeState(hash);
    for (const done of due) {
      const command = done.named ?? world.commands.named(done.record);
      line({ tick: world.time, gesture: done.gesture, command });
    }
    last = { hash, isStored, isChanged: due.length > 0 };
    progress(world.time, ticks);
  }
  if (last && !last.isStored && !last.isChanged) await writeState(last.hash);
  line({ end: true, tick: world.time, hash: world.hash().whole });
  return new Blob([new Uint8Array(await through(encoder.encode(lines.join('')), new CompressionStream('gzip')))]);
}

/** JSON with the spaces that Python puts into it.
 * @type {(value: unknown) => string} */
function spaced(value) {
  if (Array.isArray(value)) return `[${value.map(spaced).join(', ')}]`;
  if (value === null || typeof value !== 'object') return JSON.stringify(value);
  return `{${Object.entries(value).map(([key, each]) => `${JSON.stringify(key)}: ${spaced(each)}`).join(', ')}}`;
}

/** Bytes compressed, in the letters of base64.
 * @type {(bytes: Uint8Array, format?: CompressionFormat) => Promise<string>} */
export async function packed(bytes, format = 'deflate') {
  const content = await through(bytes, new CompressionStream(format));
  let text = '';
  for (let k = 0; k < content.length; k += 0x8000) text += String.fromCharCode(...content.subarray(k, k + 0x8000));
  return btoa(text);
}

/** @type {(bytes: Uint8Array, stream: CompressionStream) => Promise<Uint8Array<ArrayBuffer>>} */
async function through(bytes, stream) {
  const content = new Blob([/** @type {Uint8Array<ArrayBuffer>} */ (bytes)]).stream().pipeThrough(stream);
  return new Uint8Array(await new Response(content).arrayBuffer());
}
