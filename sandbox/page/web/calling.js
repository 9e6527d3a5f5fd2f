// Calling: kernels of a module, the memory that they are lent, and their arenas, which grow until there is room.
import { aligned } from './arrays.js';
/** @import { Kernels } from './types.js' */

export const WORD = 8, MORE = 2;
// What an arena has at first, and room for the arguments of a call [words].
const PAGE = 65536, FIRST_ARENA = 4096, ARGUMENTS = 64;

/** @typedef {[address: number, count: number, size: number]} Span */

export class Calling {
  #kernels;
  #symbols;
  #arguments;
  #end;
  /** @type {Record<string, Span>} */
  #arenas = {};
  /** Where arrays that a kernel is lent lie, and how many words there are.
   * @type {[address: number, most: number]} */
  #slots = [0, 0];

  /** symbols: what the module calls them.
   * @param {Kernels} kernels @param {Record<string, string>} symbols */
  constructor(kernels, symbols) {
    this.#kernels = kernels;
    this.#symbols = symbols;
    this.#arguments = aligned(kernels.__heap_base.value);
    this.#end = aligned(this.#arguments + ARGUMENTS * WORD);
  }

  get buffer() {
    return this.#kernels.memory.buffer;
  }

  /** Where there are so many more bytes of memory.
   * @type {(size: number) => number} */
  reserve(size) {
    const address = this.#end, { memory } = this.#kernels;
    this.#end = aligned(address + size);
    const pages = Math.ceil(this.#end / PAGE) - memory.buffer.byteLength / PAGE;
    if (pages > 0) memory.grow(pages);
    return address;
  }

  /** Two arrays of words where a kernel takes them, until others are.
   * @type {(...arrays: (BigInt64Array | Float64Array)[]) => Span[]} */
  lend(...arrays) {
    const words = arrays.reduce((sum, { length }) => sum + length, 0), { memory } = this.#kernels;
    if (words > this.#slots[1]) this.#slots = [this.reserve(MORE * words * WORD), MORE * words];
    let [address] = this.#slots;
    return arrays.map((array) => {
      new Uint8Array(memory.buffer).set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength), address);
      address += array.byteLength;
      return /** @type {Span} */ ([address - array.byteLength, array.length, WORD]);
    });
  }

  /** Call a kernel with numbers, and with arrays by their address, number of items and bytes of each.
   * @type {(name: string, ...given: (number | Span)[]) => number} */
  call(name, ...given) {
    const words = given.flatMap((each) => {
      if (!Array.isArray(each)) return [each];
      const [address, count, size] = each;
      return [0, 0, count, size, address, count, size];
    });
    const place = new BigInt64Array(this.buffer, this.#arguments, words.length);
    place.set(words.map(BigInt));
    if (this.#kernels[this.#symbols[name]](this.#arguments) !== 0) throw new Error(`the kernel ${name} failed`);
    return Number(new BigInt64Array(this.buffer, this.#arguments, 1)[0]);
  }

  // What was lent last stays; what comes is lent elsewhere.
  keep() {
    this.#slots = [0, 0];
  }

  /** What a kernel answers that takes numbers and no world, and its arena, as words and as floats.
   * @type {(name: string, numbers: number[]) => [answer: number, words: BigInt64Array, floats: Float64Array]} */
  answer(name, numbers) {
    const { memory } = this.#kernels, answer = this.inArena(name, [], ...this.lend(Float64Array.from(numbers)));
    const [address, size] = this.#arenas[name];
    return [answer, new BigInt64Array(memory.buffer, address, size), new Float64Array(memory.buffer, address, size)];
  }

  /** What a kernel answers that takes arrays of numbers and no world, and writes into them.
   * @type {(name: string, ...arrays: Float64Array[]) => number} */
  compute(name, ...arrays) {
    return this.#computed(arrays, (spans) => this.call(name, ...spans));
  }

  /** The same of a kernel that takes an arena first.
   * @type {(name: string, ...arrays: Float64Array[]) => number} */
  computeInArena(name, ...arrays) {
    return this.#computed(arrays, (spans) => this.inArena(name, [], ...spans));
  }

  /** @type {(arrays: Float64Array[], call: (spans: Span[]) => number) => number} */
  #computed(arrays, call) {
    const spans = this.lend(...arrays), answer = call(spans);
    arrays.forEach((array, k) => array.set(new Float64Array(this.buffer, spans[k][0], array.length)));
    return answer;
  }

  /** Call a kernel with what comes first, with its own arena, which grows until there is room, and what comes after that.
   * @type {(name: string, before: Span[], ...given: (number | Span)[]) => number} */
  inArena(name, before, ...given) {
    let arena = (this.#arenas[name] ??= this.#newArena(FIRST_ARENA));
    let result = this.call(name, ...before, arena, ...given);
    for (let used = this.#used(arena); used > arena[1]; used = this.#used(arena)) {
      arena = this.#arenas[name] = this.#newArena(MORE * used);
      result = this.call(name, ...before, arena, ...given);
    }
    return result;
  }

  /** @type {(words: number) => Span} */
  #newArena(words) {
    return [this.reserve(words * WORD), words, WORD];
  }

  /** @type {(range: Span) => number} */
  #used([address]) {
    return new Uint32Array(this.buffer, address, 1)[0];
  }
}
