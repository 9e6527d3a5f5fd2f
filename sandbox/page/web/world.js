// World: a block of arrays in the memory of WebAssembly, and the kernels that do all physics there.
import { addedTo } from './adding.js';
import { Commands, countedBy, isWithoutKernel, Refusal } from './commands.js';
import { blake2b, digestOf, hexOf } from './hash.js';
import { removedFrom } from './removing.js';
import { act } from './rules.js';
/**
 * @import { About, AnyArray, Column, Command, Counts, Done, Equipment, Kernels, NameKind, Runs, SavedState,
 *   Laid, NamedRecord, Settings, StateHash, View } from './types.js'
 */

const PAGE = 65536, WORD = 8, ALIGNED = 16, ADDRESS = 4, SHAPE = 5;
/** @type {Record<string, new (buffer: ArrayBuffer, offset: number, length: number) => AnyArray>} */
const KINDS = {
  f8: Float64Array, f4: Float32Array, i8: BigInt64Array, u4: Uint32Array, i4: Int32Array, i1: Int8Array, b1: Uint8Array,
};
// What is derived, in this order, each by a kernel of its own with an arena of its own; and words that one begins with.
const DERIVATIONS = ['derive_topology', 'derive_hands', 'make_room'], FIRST_ARENA = 4096, MORE = 2;
const HANDS = ['derive_hands'], ROOM = ['make_room'];
const CONTACTS = /** @type {const} */ (['collisions.kept.particle', 'collisions.kept.feature',
  'collisions.kept.impulse', 'collisions.kept.impact']);
// Room for the words of arguments of a call, and for the numbers of a command beside its springs [words].
const ARGUMENTS = 64, RECORD = 16, NONE = new Float64Array();
/** @type {(size: number) => number} */
const aligned = (size) => Math.ceil(size / ALIGNED) * ALIGNED;

/** @typedef {[address: number, count: number, size: number]} Span */
/** @typedef {Extract<Command, { type: 'release' | 'set_drive' | 'hold_key' }>} Ending */

export class World {
  /** @type {Kernels} */
  #kernels;
  /** @type {About} */
  #about;
  /** @type {number} */
  #arguments;
  /** Where slots of a command are given, or numbers of a stroke, and how many there may be.
   * @type {[address: number, most: number]} */
  #many = [0, 0];
  /** @type {number} */
  #base;
  /** @type {number} */
  #end;
  /** @type {Record<string, Span>} */
  #arenas = {};
  /** The words of what the block was given: what kernels derived lies in place of the others.
   * @type {Uint8Array} */
  #given;
  /** @type {Map<string, { word: number, kind: string, dimensions: number }>} */
  #table = new Map();
  /** @type {Map<string, AnyArray>} */
  #views = new Map();
  /** @type {Map<string, { array: AnyArray, digest: string | null }>} */
  #hashed = new Map();
  /** @type {Map<string, AnyArray>} */
  #saved = new Map();
  /** By path: how many rows there are room for, and how many there are at least.
   * @type {Map<string, { room: number, least: number }>} */
  #rows = new Map();
  /** Rows in use, by family: a page has room for what a recording adds later.
   * @type {Counts} */
  counts;
  /** Names of rows in use, and of others that there were once.
   * @type {Record<NameKind, string[]>} */
  names;
  /** What people see of what joined, and where arrays lie that came with it.
   * @type {SavedState['joined']} */
  #joined = [];
  /** Where arrays lay before others came in their place.
   * @type {Map<string, Laid>} */
  #bare = new Map();
  /** What of records is right, and what kernels take of it.
   * @type {Commands} */
  commands;
  // Ticks since the level's start; springs that broke in the last one.
  time = 0;
  /** @type {number[]} */
  broken = [];

  /** kernels: what the module exports; image: the block as bytes; about: what Python says of both, see about.py.
   * @param {Kernels} kernels @param {Uint8Array} image @param {About} about */
  constructor(kernels, image, about) {
    this.#kernels = kernels;
    this.#about = about;
    this.counts = about.counts;
    this.names = structuredClone(about.names);
    this.commands = new Commands(about, this.names);
    this.#arguments = aligned(kernels.__heap_base.value);
    this.#base = aligned(this.#arguments + (ARGUMENTS + RECORD) * WORD);
    this.#end = this.#base;
    this.#reserve(image.length);
    const memory = new Uint8Array(kernels.memory.buffer);
    memory.set(image, this.#base);
    for (const [to, from, size] of about.copies) memory.copyWithin(this.#base + to, this.#base + from,
      this.#base + from + size);
    const words = new Uint32Array(kernels.memory.buffer);
    let word = 0;
    for (const [path, [kind, dimensions]] of Object.entries(about.table)) {
      this.#table.set(path, { word, kind, dimensions });
      words[this.#place(word) + 2 * ADDRESS] += this.#base;
      word += SHAPE + 2 * dimensions;
    }
    this.#given = new Uint8Array(kernels.memory.buffer, this.#base, about.words * WORD).slice();
    for (const path of Object.keys(about.grows)) {
      const rows = this.#dimension(path);
      this.#rows.set(path, { room: rows, least: rows });
    }
    this.#derive(DERIVATIONS);
    Object.defineProperty(this.names, 'form', { get: () => this.#formNames(about.names.form) });
  }

  /** Names of bodies whose form may be stiff, by their numbers: of one that was cut its pieces, as firm_bodies.py has it.
   * @type {(bodies: string[]) => string[]} */
  #formNames(bodies) {
    const place = this.#placeFor(bodies.length);
    this.#inArena('count_pieces', [], this.#block, [place, bodies.length, WORD]);
    const counts = Array.from(new BigInt64Array(this.#kernels.memory.buffer, place, bodies.length), Number);
    const pieces = bodies.map((name, k) => (counts[k] < 2 ? [name]
      : Array.from({ length: counts[k] }, (_, at) => `${name}, ${at + 1} of ${counts[k]}`)));
    return [...pieces.map(([first]) => first), ...pieces.flatMap(([, ...others]) => others)];
  }

  /** Where there are so many more bytes of memory.
   * @type {(size: number) => number} */
  #reserve(size) {
    const address = this.#end, { memory } = this.#kernels;
    this.#end = aligned(address + size);
    const pages = Math.ceil(this.#end / PAGE) - memory.buffer.byteLength / PAGE;
    if (pages > 0) memory.grow(pages);
    return address;
  }

  /** Where a word of the block is, as an index of numbers of 32 bits.
   * @type {(word: number) => number} */
  #place(word) {
    return (this.#base + WORD * word) / 4;
  }

  /** The array at a path of the block, such as 'state.position', flat.
   * @template {string} P @param {P} path @returns {View<P>} */
  view(path) {
    const found = this.#views.get(path);
    if (found && found.buffer === this.#kernels.memory.buffer) return /** @type {View<P>} */ (found);
    const place = this.#table.get(path);
    if (!place) throw new Error(`there is no array ${path}`);
    const { word, kind, dimensions } = place, words = new Uint32Array(this.#kernels.memory.buffer),
      at = this.#place(word);
    let size = 1;
    for (let k = 0; k < dimensions; k++) size *= words[at + 2 * (SHAPE + k)];
    const view = new KINDS[kind](this.#kernels.memory.buffer, words[at + 2 * ADDRESS], size);
    this.#views.set(path, view);
    return /** @type {View<P>} */ (view);
  }

  /** How many rows an array has.
   * @type {(path: string) => number} */
  #dimension(path) {
    const { word } = this.#table.get(path) ?? { word: 0 };
    return new Uint32Array(this.#kernels.memory.buffer)[this.#place(word) + 2 * SHAPE];
  }

  /** Numbers in a row of an array.
   * @type {(path: string) => number} */
  #width(path) {
    const { word, dimensions } = this.#table.get(path) ?? { word: 0, dimensions: 1 };
    return dimensions > 1 ? new Uint32Array(this.#kernels.memory.buffer)[this.#place(word) + 2 * (SHAPE + 1)] : 1;
  }

  /** Let an array lie elsewhere, with so many rows.
   * @type {(path: string, laid: Laid) => void} */
  #lay(path, { address, rows }) {
    const { word } = this.#table.get(path) ?? { word: 0 };
    const words = [[2, rows * this.#width(path)], [ADDRESS, address], [SHAPE, rows]];
    for (const buffer of [this.#kernels.memory.buffer, this.#given.buffer]) {
      const from = buffer === this.#given.buffer ? 0 : this.#base, all = new Uint32Array(buffer);
      for (const [at, value] of words) all[(from + WORD * (word + at)) / 4] = value;
    }
    this.#views.delete(path);
  }

  /** Put arrays that are constant otherwise in place of those there are; where they lie.
   * @type {(equipment: Equipment) => Map<string, Laid>} */
  #equip(equipment) {
    /** @type {Map<string, Laid>} */
    const laid = new Map();
    for (const [path, values] of Object.entries(equipment)) {
      const before = this.view(path), rows = values.length / this.#width(path), size = before.BYTES_PER_ELEMENT;
      if (!this.#bare.has(path)) this.#bare.set(path, { address: before.byteOffset, rows: this.#dimension(path) });
      laid.set(path, { address: this.#reserve(Math.max(values.length, 1) * size), rows });
      this.#layAgain(path, /** @type {Laid} */ (laid.get(path)));
      const view = this.view(path);
      put(view, view instanceof BigInt64Array ? BigInt64Array.from(values, BigInt) : Float64Array.from(values, Number));
    }
    return laid;
  }

  /** The same, of one that may be of those that grow.
   * @type {(path: string, laid: Laid) => void} */
  #layAgain(path, laid) {
    const known = this.#rows.get(path);
    if (known) known.room = laid.rows;
    this.#lay(path, laid);
  }

  /** Give all arrays as many rows as are in use. It is derived again afterwards.
   * @type {(counts: Counts) => void} */
  #grow(counts) {
    for (const [path, [family, fill]] of Object.entries(this.#about.grows)) {
      const known = this.#rows.get(path) ?? { room: 0, least: 0 };
      const rows = Math.max(counts[family], known.least), before = this.view(path), had = this.#dimension(path);
      if (rows === had) continue;
      const width = this.#width(path), kept = before.slice(), isMoved = rows > known.room;
      if (isMoved) known.room = MORE * rows;
      const address = isMoved ? this.#reserve(known.room * width * kept.BYTES_PER_ELEMENT) : before.byteOffset;
      this.#rows.set(path, known);
      this.#lay(path, { address, rows });
      const view = this.view(path);
      put(view, kept.subarray(0, Math.min(kept.length, view.length)));
      if (view instanceof BigInt64Array) view.fill(BigInt(fill), had * width);
      else view.fill(Number(fill), had * width);
    }
  }

  /** Call a kernel with numbers, and with arrays by their address, number of items and bytes of each.
   * @type {(name: string, ...given: (number | Span)[]) => number} */
  #call(name, ...given) {
    const words = given.flatMap((each) => {
      if (!Array.isArray(each)) return [each];
      const [address, count, size] = each;
      return [0, 0, count, size, address, count, size];
    });
    const place = new BigInt64Array(this.#kernels.memory.buffer, this.#arguments, words.length);
    place.set(words.map(BigInt));
    if (this.#kernels[this.#about.kernels[name]](this.#arguments) !== 0) throw new Error(`the kernel ${name} failed`);
    return Number(new BigInt64Array(this.#kernels.memory.buffer, this.#arguments, 1)[0]);
  }

  /** @type {Span} */
  get #block() {
    return [this.#base, 1, WORD * this.#about.words];
  }

  /** @type {(name: keyof About['progress']) => number} */
  #progress(name) {
    return Number(this.view('progress')[this.#about.progress[name]]);
  }

  tick() {
    act(this, this.#about);
    const progress = this.view('progress'), { TICK, MAY_FLY, COUNT, CHECKED } = this.#about.progress;
    const { NO_ROOM, UNSOUND, LOST, BROKE } = this.#about.codes;
    progress[TICK] = BigInt(this.time);
    progress[MAY_FLY] = 1n;
    progress[COUNT] = progress[CHECKED] = 0n;
    let code = this.#call('tick', this.#block);
    while (code === NO_ROOM || code === UNSOUND) {
      if (code === NO_ROOM) this.#derive(ROOM);
      else {
        this.#takeBack(code);
        this.view('progress')[CHECKED] = 1n;
      }
      code = this.#call('tick', this.#block);
    }
    this.time += 1;
    if (code === LOST) {
      this.#takeBack(code);
      code = this.#call('find_broken', this.#block) ? BROKE : code;
    }
    this.broken = code === BROKE ? Array.from(this.view('limits.broken').subarray(0, this.#progress('BROKEN')), Number)
      : [];
    if (this.broken.length) this.command({ type: 'break_springs', springs: this.broken }, this.#about.givers.PROGRAM);
    if (this.#about.rules.length) this.#call('judge', this.#block);
  }

  /** Take back what a tick has said of that no physics gives it, see sanitise.py.
   * @type {(code: number) => void} */
  #takeBack(code) {
    this.#inArena('take_back', [this.#block], code);
    this.#derive(DERIVATIONS);
  }

  /** Carry out what was done: a command, or what it changes where no kernel carries it out.
   * @type {(done: Done) => void} */
  carryOut(done) {
    if (!done.changes) {
      this.command(done.record, this.#about.givers.HAND);
      return;
    }
    const { changes, counts, names, scene, equipment = {} } = done;
    if (counts) this.#grow(counts);
    for (const [kind, added] of /** @type {[NameKind, string[]][]} */ (Object.entries(names ?? {}))) {
      this.names[kind].splice(this.counts[countedBy(kind)], Infinity, ...added);
    }
    this.counts = counts ?? this.counts;
    if (scene) this.#joined.push({ scene, laid: this.#equip(equipment) });
    for (const [path, runs] of Object.entries(changes)) {
      this.#change(path, runs);
      const good = path.replace('state', 'good');
      if (good !== path && this.#table.has(good)) this.#change(good, runs);
    }
    if (this.#about.topology.some((path) => path in changes)) this.#derive(DERIVATIONS);
  }

  /** Write rows of an array: the first, how many, and what each is to hold.
   * @type {(path: string, runs: Runs) => void} */
  #change(path, runs) {
    const view = this.view(path);
    for (const [first, count, ...row] of runs) {
      const values = view instanceof BigInt64Array ? BigInt64Array.from(row, BigInt) : Float64Array.from(row, Number);
      for (let k = first; k < first + count; k++) put(view, values, row.length * k);
    }
  }

  /** Carry out a command that somebody gives: the record of a recording with slots in place of names. Throws a Refusal
   * where it cannot be carried out, or where hands may not.
   * @type {(record: Command, giver: number) => void} */
  command(record, giver) {
    if (isWithoutKernel(record.type)) {
      this.#withoutKernel(record, giver);
      return;
    }
    const { tick_rate } = this.settings(), { particle: first_cursor, spring: first_spring } = this.hands;
    const packed = this.commands.packed(record, { first_cursor, first_spring, tick_rate });
    const { code, slots, numbers, changes } = packed;
    const many = this.#placeFor(slots.length);
    const at = this.#arguments + ARGUMENTS * WORD, { buffer } = this.#kernels.memory;
    new BigInt64Array(buffer, many, slots.length).set(slots.map(BigInt));
    new Float64Array(buffer, at, numbers.length).set(numbers);
    /** @type {(number | Span)[]} */
    const given = [giver, code, [many, slots.length, WORD], [at, numbers.length, WORD]];
    const result = this.#inArena('command', [this.#block], ...given);
    const answers = new Float64Array(this.#kernels.memory.buffer, at, numbers.length);
    this.commands.answer(record, packed, result, answers);
    if (changes === 'solver') {
      const factor = answers[numbers.length - 1];
      const impulse = this.view('collisions.kept.impulse');
      impulse.forEach((value, k) => { impulse[k] = factor ? value * factor : 0; });
    }
    if (changes) this.#derive(changes === 'hands' ? HANDS : DERIVATIONS);
  }

  /** @type {(record: Command, giver: number) => void} */
  #withoutKernel(record, giver) {
    const { givers, codeOf } = this.#about, named = /** @type {NamedRecord} */ (record);
    const refusal = giver === givers.HAND ? this.commands.refusalOf(this, record) : null;
    if (refusal) throw new Refusal(refusal);
    const tell = named.type === 'remove' ? removedFrom : addedTo;
    this.carryOut({ tick: this.time, gesture: 0, record: named, ...tell(this, this.#about, named) });
    const row = giver === givers.HAND ? this.view('state.deed_budget')[codeOf[named.type]] ?? -1 : -1;
    if (row >= 0) this.view('state.counter')[row] -= 1;
  }

  /** Whether what a command would end goes on: a hand holds something, a part is driven, or a key is held.
   * @type {(ending: Ending) => boolean} */
  isGoing(ending) {
    if (ending.type === 'hold_key') return this.view('state.key_down')[ending.key] !== 0;
    if (ending.type === 'release') return this.isHeld(ending.grab);
    return this.view('state.actuator_value')[ending.part] !== 0;
  }

  /** Derive what follows from topology, which is everything, or from hands alone, or room; contacts of the last step stay.
   * @type {(names: string[], contacts?: AnyArray[]) => void} */
  #derive(names, contacts = this.#contactRows()) {
    if (names === DERIVATIONS) new Uint8Array(this.#kernels.memory.buffer).set(this.#given, this.#base);
    this.#views.clear();
    this.view('collisions.counts')[this.#about.progress.KEPT] = BigInt(contacts[0].length);
    for (const name of names) this.#inArena(name, [this.#block]);
    if (names !== HANDS) CONTACTS.forEach((path, k) => put(this.view(path), contacts[k]));
  }

  /** Where so many words of a call can be written.
   * @type {(words: number) => number} */
  #placeFor(words) {
    if (words > this.#many[1]) this.#many = [this.#reserve(MORE * words * WORD), MORE * words];
    return this.#many[0];
  }

  /** What a kernel answers that takes numbers and no world, and its arena, as words and as floats.
   * @type {(name: string, numbers: number[]) => [answer: number, words: BigInt64Array, floats: Float64Array]} */
  answer(name, numbers) {
    const place = this.#placeFor(numbers.length), { memory } = this.#kernels;
    new Float64Array(memory.buffer, place, numbers.length).set(numbers);
    const answer = this.#inArena(name, [], [place, numbers.length, WORD]), [address, size] = this.#arenas[name];
    return [answer, new BigInt64Array(memory.buffer, address, size), new Float64Array(memory.buffer, address, size)];
  }

  /** Call a kernel with what comes first, with its own arena, which grows until there is room, and what comes after that.
   * @type {(name: string, before: Span[], ...given: (number | Span)[]) => number} */
  #inArena(name, before, ...given) {
    let arena = (this.#arenas[name] ??= this.#newArena(FIRST_ARENA));
    let result = this.#call(name, ...before, arena, ...given);
    for (let used = this.#used(arena); used > arena[1]; used = this.#used(arena)) {
      arena = this.#arenas[name] = this.#newArena(MORE * used);
      result = this.#call(name, ...before, arena, ...given);
    }
    this.#views.clear();
    return result;
  }

  /** @type {(words: number) => Span} */
  #newArena(words) {
    return [this.#reserve(words * WORD), words, WORD];
  }

  /** @type {(range: Span) => number} */
  #used([address]) {
    return new Uint32Array(this.#kernels.memory.buffer, address, 1)[0];
  }

  /** @type {() => AnyArray[]} */
  #contactRows() {
    const count = Number(this.view('collisions.counts')[this.#about.progress.KEPT]);
    return CONTACTS.map((path, k) => this.view(path).slice(0, count * (k === 2 ? 2 : 1)));
  }

  // What people see of what joined.
  get joined() {
    return this.#joined.map(({ scene }) => scene);
  }

  // First particle and spring of hands, and how many hands there are.
  get hands() {
    return this.#about.hands;
  }

  // Who gives a command; what each rule of the level does, in order.
  get givers() {
    return this.#about.givers;
  }

  get rules() {
    return this.#about.rules;
  }

  get areaKind() {
    return this.#about.area;
  }

  /** Whether a particle is the cursor of a hand.
   * @type {(particle: number) => boolean} */
  isCursor(particle) {
    const first = this.hands.particle;
    return particle >= first && particle < first + this.hands.count;
  }

  /** Whether what a name stands for is in use, and no hand's; parts and materials always are.
   * @type {(kind: NameKind, slot: number) => boolean} */
  isInUse(kind, slot) {
    if (kind !== 'particle' && kind !== 'spring') return true;
    const { [kind]: first, count } = this.hands;
    return Boolean(this.view(`state.${kind}_active`)[slot]) && (slot < first || slot >= first + count);
  }

  /** Whether people see a particle, and whether it can move.
   * @type {(particle: number) => boolean} */
  isShown(particle) {
    return this.isInUse('particle', particle);
  }

  /** @type {(particle: number) => boolean} */
  canMove(particle) {
    return this.isShown(particle) && this.view('state.inverse_mass')[particle] > 0;
  }

  // All particles and springs but those of hands.
  get particles() {
    return Array.from({ length: this.counts.particle }, (_, p) => p).filter((p) => !this.isCursor(p));
  }

  get springs() {
    const { spring: first, count } = this.hands, { spring } = this.counts;
    return Array.from({ length: spring }, (_, s) => s).filter((s) => s < first || s >= first + count);
  }

  /** @type {(hand: number) => boolean} */
  isHeld(hand) {
    return Boolean(this.view('state.spring_active')[this.hands.spring + hand]);
  }

  // Particles that touched something in the last step.
  contacts() {
    const count = Number(this.view('collisions.counts')[this.#about.progress.KEPT]);
    return this.view('collisions.kept.particle').subarray(0, count);
  }

  /** What ticks keep from one to the next, as a copy; arrays that have not changed are those of the copy before.
   * @type {() => SavedState} */
  save() {
    /** @type {Map<string, AnyArray>} */
    const arrays = new Map();
    for (const path of this.#about.kept) {
      const present = this.view(path), last = this.#saved.get(path);
      arrays.set(path, last && isEqual(last, present) ? last : present.slice());
    }
    this.#saved = arrays;
    return { time: this.time, counts: this.counts, arrays, contacts: this.#contactRows(), joined: [...this.#joined] };
  }

  /** @type {(state: SavedState) => void} */
  restore({ time, counts, arrays, contacts, joined }) {
    const isOther = this.#about.topology.some((path) => !isEqual(this.view(path), arrays.get(path) ?? NONE));
    this.#joined = [...joined];
    for (const [path, bare] of this.#bare) {
      this.#layAgain(path, this.#joined.findLast(({ laid }) => laid.has(path))?.laid.get(path) ?? bare);
    }
    this.#grow(counts);
    for (const [path, kept] of arrays) put(this.view(path), kept);
    [this.time, this.counts, this.broken] = [time, counts, []];
    if (isOther) this.#derive(DERIVATIONS, contacts);
    else if (contacts[0].length > this.view(CONTACTS[0]).length) this.#derive(ROOM, contacts);
    else {
      this.view('collisions.counts')[this.#about.progress.KEPT] = BigInt(contacts[0].length);
      CONTACTS.forEach((path, k) => put(this.view(path), contacts[k]));
    }
  }

  /** The rows of a state array that are in use, flat.
   * @type {(column: Column) => AnyArray} */
  rows(column) {
    const count = column.isContact ? this.contacts().length : this.counts[column.family];
    return this.view(column.path).subarray(0, column.width * count);
  }

  /** The hash of the whole state, and those of its arrays that are in use, by their names in files.
   * @type {() => StateHash} */
  hash() {
    /** @type {Map<string, string>} */
    const arrays = new Map();
    for (const column of this.#about.columns) {
      const present = this.rows(column);
      let kept = this.#hashed.get(column.stored);
      if (!kept || !isEqual(kept.array, present)) {
        kept = { array: present.slice(), digest: digestOf(column, present) };
        this.#hashed.set(column.stored, kept);
      }
      if (kept.digest) arrays.set(column.stored, kept.digest);
    }
    const { gravity, tick_rate, substeps, solver, iterations, warm_start, wind, drag } = this.settings();
    const settings = [...gravity.map(hexOf), tick_rate, substeps, solver, iterations,
      ...[warm_start, ...wind, drag].map(hexOf)];
    const text = [...arrays.values(), this.time, ...settings].join('\n');
    return { whole: blake2b(new TextEncoder().encode(text), 16), arrays };
  }

  /** The settings of a tick, in the order in which they are hashed and stored.
   * @type {() => Settings} */
  settings() {
    const [x, y, windX, windY, drag, warm] = this.view('numbers');
    const [solver, rate, substeps, isAuto, iterations] = Array.from(this.view('choices'), Number);
    return {
      gravity: [x, y], tick_rate: rate, substeps: isAuto ? 'auto' : substeps, solver: this.#about.solvers[solver],
      iterations, warm_start: warm, wind: [windX, windY], drag,
    };
  }
}

/** Write numbers into an array that holds such, from a place on.
 * @type {(array: AnyArray, values: AnyArray, at?: number) => void} */
function put(array, values, at = 0) {
  // Both are of 64 bits and whole, or neither is.
  /** @type {Float64Array} */ (array).set(/** @type {Float64Array} */ (values), at);
}

/** @type {(one: AnyArray, other: AnyArray) => boolean} */
function isEqual(one, other) {
  if (one.length !== other.length) return false;
  const a = new Uint8Array(one.buffer, one.byteOffset, one.byteLength);
  const b = new Uint8Array(other.buffer, other.byteOffset, other.byteLength);
  for (let k = 0; k < a.length; k++) if (a[k] !== b[k]) return false;
  return true;
}
