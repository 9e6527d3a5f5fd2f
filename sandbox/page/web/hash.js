// Hash: blake2b (RFC 7693), with each number of 64 bits as two of 32; arrays as they are hashed; floats in Python's digits.
/** @import { AnyArray, Column, StateHash } from './types.js' */
/** @import { World } from './world.js' */

const START = new Uint32Array([
  0xf3bcc908, 0x6a09e667, 0x84caa73b, 0xbb67ae85, 0xfe94f82b, 0x3c6ef372, 0x5f1d36f1, 0xa54ff53a,
  0xade682d1, 0x510e527f, 0x2b3e6c1f, 0x9b05688c, 0xfb41bd6b, 0x1f83d9ab, 0x137e2179, 0x5be0cd19,
]);
// Which numbers of a block are mixed in, round by round.
const ORDER = Uint8Array.from([
  '0123456789abcdef', 'ea489fd61c02b753', 'b8c052fdae367194', '7931dcbe265a40f8', '905724afe1bc683d',
  '2c6a0b834d75fe19', 'c51fed4a0763928b', 'db7ec13950f4862a', '6fe9b308c2d714a5', 'a2847615fb9e3cd0',
  '0123456789abcdef', 'ea489fd61c02b753',
].join(''), (digit) => 2 * parseInt(digit, 16));
// Columns, then diagonals, of the 4 x 4 numbers that are mixed.
const LANES = Uint8Array.from('048c159d26ae37bf05af16bc278d349e', (digit) => 2 * parseInt(digit, 16));
const BLOCK = 128;
const state = new Uint32Array(32), words = new Uint32Array(32), bytes = new Uint8Array(words.buffer);

/** Mix four numbers of the state with two of a block; l and h are the low and the high half of each.
 * @type {(a: number, b: number, c: number, d: number, x: number, y: number) => void} */
function mix(a, b, c, d, x, y) {
  let al = state[a], ah = state[a + 1], bl = state[b], bh = state[b + 1];
  let cl = state[c], ch = state[c + 1], dl = state[d], dh = state[d + 1];
  let sum = al + bl + words[x], low, up;
  ah = (ah + bh + words[x + 1] + ((sum / 0x100000000) | 0)) >>> 0;
  al = sum >>> 0;
  low = dl ^ al;
  dl = (dh ^ ah) >>> 0;
  dh = low >>> 0;
  sum = cl + dl;
  ch = (ch + dh + ((sum / 0x100000000) | 0)) >>> 0;
  cl = sum >>> 0;
  low = bl ^ cl;
  up = bh ^ ch;
  bl = ((low >>> 24) | (up << 8)) >>> 0;
  bh = ((up >>> 24) | (low << 8)) >>> 0;
  sum = al + bl + words[y];
  ah = (ah + bh + words[y + 1] + ((sum / 0x100000000) | 0)) >>> 0;
  al = sum >>> 0;
  low = dl ^ al;
  up = dh ^ ah;
  dl = ((low >>> 16) | (up << 16)) >>> 0;
  dh = ((up >>> 16) | (low << 16)) >>> 0;
  sum = cl + dl;
  ch = (ch + dh + ((sum / 0x100000000) | 0)) >>> 0;
  cl = sum >>> 0;
  low = bl ^ cl;
  up = bh ^ ch;
  state[a] = al;
  state[a + 1] = ah;
  state[b] = (low << 1) | (up >>> 31);
  state[b + 1] = (up << 1) | (low >>> 31);
  state[c] = cl;
  state[c + 1] = ch;
  state[d] = dl;
  state[d + 1] = dh;
}

/** @type {(chain: Uint32Array, count: number, isLast: boolean) => void} */
function compress(chain, count, isLast) {
  state.set(chain);
  state.set(START, 16);
  state[24] ^= count;
  state[25] ^= Math.floor(count / 0x100000000);
  if (isLast) {
    state[28] = ~state[28];
    state[29] = ~state[29];
  }
  for (let k = 0; k < ORDER.length; k += 2) {
    const at = (2 * k) & 31;
    mix(LANES[at], LANES[at + 1], LANES[at + 2], LANES[at + 3], ORDER[k], ORDER[k + 1]);
  }
  for (let k = 0; k < 16; k++) chain[k] ^= state[k] ^ state[k + 16];
}

/** blake2b of bytes: `size` bytes as hexadecimal digits.
 * @type {(content: Uint8Array, size: number) => string} */
export function blake2b(content, size) {
  const chain = START.slice();
  chain[0] ^= 0x01010000 ^ size;
  let at = 0;
  for (; content.length - at > BLOCK; at += BLOCK) {
    bytes.set(content.subarray(at, at + BLOCK));
    compress(chain, at + BLOCK, false);
  }
  bytes.fill(0);
  bytes.set(content.subarray(at));
  compress(chain, content.length, true);
  const digest = new Uint8Array(chain.buffer, 0, size);
  return Array.from(digest, (byte) => byte.toString(16).padStart(2, '0')).join('');
}

/** A float as Python's float.hex() writes it.
 * @type {(value: number) => string} */
export function hexOf(value) {
  const number = value + 0, view = new DataView(new ArrayBuffer(8));
  view.setFloat64(0, number);
  const power = (view.getUint16(0) >> 4) & 0x7ff, sign = number < 0 ? '-' : '';
  if (number === 0) return '0x0.0p+0';
  const digits = (view.getBigUint64(0) & 0xfffffffffffffn).toString(16).padStart(13, '0');
  const exponent = power === 0 ? -1022 : power - 1023;
  return `${sign}0x${power === 0 ? 0 : 1}.${digits}p${exponent < 0 ? '' : '+'}${exponent}`;
}

/** The bytes that are hashed and stored: -0 as 0, and every NaN as the same.
 * @type {(array: AnyArray) => Uint8Array} */
export function canonical(array) {
  const copy = array instanceof Float64Array ? array.map((value) => value + 0) : array;
  return new Uint8Array(copy.buffer, copy.byteOffset, copy.byteLength);
}

/** Nothing of an array of which all is as usual, and which is left out then.
 * @type {(column: Column, array: AnyArray) => string | null} */
function digestOf(column, array) {
  if (column.isSparse && array.every((value) => Number(value) === column.usual)) return null;
  return blake2b(canonical(array), 8);
}

/** @type {(one: AnyArray, other: AnyArray) => boolean} */
export function isEqual(one, other) {
  if (one.length !== other.length) return false;
  const a = new Uint8Array(one.buffer, one.byteOffset, one.byteLength);
  const b = new Uint8Array(other.buffer, other.byteOffset, other.byteLength);
  for (let k = 0; k < a.length; k++) if (a[k] !== b[k]) return false;
  return true;
}

// Hashes of a world's state; those of arrays that have not changed are kept.
export class Hashes {
  /** @type {Map<string, { array: AnyArray, digest: string | null }>} */
  #kept = new Map();

  /** @param {Column[]} columns */
  constructor(columns) {
    this.columns = columns;
  }

  /** The hash of the whole, and those of its arrays by their names in files.
   * @type {(world: World) => StateHash} */
  of(world) {
    /** @type {Map<string, string>} */
    const arrays = new Map();
    for (const column of this.columns) {
      const present = world.rows(column);
      let kept = this.#kept.get(column.stored);
      if (!kept || !isEqual(kept.array, present)) {
        kept = { array: present.slice(), digest: digestOf(column, present) };
        this.#kept.set(column.stored, kept);
      }
      if (kept.digest) arrays.set(column.stored, kept.digest);
    }
    const { gravity, tick_rate, substeps, solver, iterations, warm_start, wind, drag } = world.settings();
    const settings = [...gravity.map(hexOf), tick_rate, substeps, solver, iterations,
      ...[warm_start, ...wind, drag].map(hexOf)];
    const text = [...arrays.values(), world.time, ...settings].join('\n');
    return { whole: blake2b(new TextEncoder().encode(text), 16), arrays };
  }
}
