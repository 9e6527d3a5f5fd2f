// World: a block of arrays in the memory of WebAssembly, and the kernels that do all physics there.
import { KINDS, put } from './arrays.js';
import { Calling, MORE, WORD } from './calling.js';
import { Commands, Refusal } from './commands.js';
import { formCounts, formNames, formRows } from './forms.js';
import { Hashes, isEqual } from './hash.js';
import { answered, areasOf, checkForms, keysIn, keysOf, kitOf, looseNames, namesOf, packed, seen } from './kit.js';
import { act } from './rules.js';
/**
 * @import { About, AnyArray, Column, Command, Counts, Done, Joined, Kernels, Kit, Level, NameKind, SavedState,
 *   Settings, StateHash, View } from './types.js'
 * @import { Span } from './calling.js'
 */

const ADDRESS = 4, SHAPE = 5;
// What is derived, in this order, each by a kernel of its own with an arena of its own.
const DERIVATIONS = ['derive_topology', 'derive_hands', 'make_room'];
const HANDS = ['derive_hands'], ROOM = ['make_room'];
const CONTACTS = /** @type {const} */ (['collisions.kept.particle', 'collisions.kept.feature',
  'collisions.kept.impulse', 'collisions.kept.impact']);
const NONE = new Float64Array();

export class World {
  /** @type {About} */
  #about;
  /** @type {number} */
  #base;
  /** The words of what the block was given: what kernels derived lies in place of the others.
   * @type {Uint8Array} */
  #given;
  /** @type {Map<string, { word: number, kind: string, dimensions: number }>} */
  #table = new Map();
  /** @type {Map<string, AnyArray>} */
  #views = new Map();
  #hashes;
  /** @type {Map<string, AnyArray>} */
  #saved = new Map();
  /** Names of bodies whose form may be stiff.
   * @type {string[]} */
  #forms = [];
  /** By path: how many rows there are room for.
   * @type {Map<string, number>} */
  #room = new Map();
  /** Rows in use, by family.
   * @type {Counts} */
  counts;
  /** Names of rows in use.
   * @type {Record<NameKind, string[]>} */
  names;
  /** Second names of particles, with their slots.
   * @type {Record<string, number>} */
  #second;
  /** First particle and spring of hands, below 0 until there are any, and how many hands there are.
   * @type {About['hands']} */
  hands;
  /** What joined.
   * @type {{ scene: Joined, keys: Level['keys'], bodies: number }[]} */
  #joined = [];
  /** What kernels of kits go by.
   * @type {Span[]} */
  #tables;
  /** What of records is right, and what kernels take of it.
   * @type {Commands} */
  commands;
  // Ticks since the level's start; springs that broke in the last one.
  time = 0;
  /** @type {number[]} */
  broken = [];

  /** kernels: what the module exports; image: the block as bytes; about: what Python says of both, see start.py.
   * @param {Kernels} kernels @param {Uint8Array} image @param {About} about */
  constructor(kernels, image, about) {
    this.#about = about;
    this.#hashes = new Hashes(about.columns);
    this.counts = about.counts;
    this.hands = about.hands;
    this.names = structuredClone(about.names);
    this.#second = { ...about.second.particle };
    this.commands = new Commands(about, this.names, { ...about.second, particle: this.#second });
    this.calls = new Calling(kernels, about.kernels);
    this.#base = this.calls.reserve(image.length);
    const memory = new Uint8Array(this.calls.buffer);
    memory.set(image, this.#base);
    for (const [to, from, size] of about.copies) memory.copyWithin(this.#base + to, this.#base + from,
      this.#base + from + size);
    const words = new Uint32Array(this.calls.buffer);
    let word = 0;
    for (const [path, [kind, dimensions]] of Object.entries(about.table)) {
      this.#table.set(path, { word, kind, dimensions });
      words[this.#place(word) + 2 * ADDRESS] += this.#base;
      word += SHAPE + 2 * dimensions;
    }
    this.#given = new Uint8Array(this.calls.buffer, this.#base, about.words * WORD).slice();
    for (const path of Object.keys(about.grows)) this.#room.set(path, this.#dimension(path));
    const { table, ranges } = about.kit;
    this.#tables = this.calls.lend(BigInt64Array.from(table, BigInt), Float64Array.from(ranges, Number));
    this.calls.keep();
    this.#derive(DERIVATIONS);
    this.#forms = [...about.names.form];
    Object.defineProperty(this.names, 'form', { enumerable: false, get: () => this.#formNames(this.#forms) });
  }

  /** Names of bodies whose form may be stiff, by their numbers: of one that was cut its pieces, as firmness.py has it.
   * @type {(bodies: string[]) => string[]} */
  #formNames(bodies) {
    if (!bodies.length) return [];
    const [listed] = this.calls.lend(new BigInt64Array(bodies.length));
    this.#inArena('count_pieces', [], this.#block, listed);
    const counts = Array.from(new BigInt64Array(this.calls.buffer, listed[0], bodies.length), Number);
    const pieces = bodies.map((name, k) => (counts[k] < 2 ? [name]
      : Array.from({ length: counts[k] }, (_, at) => `${name}, ${at + 1} of ${counts[k]}`)));
    return [...pieces.map(([first]) => first), ...pieces.flatMap(([, ...others]) => others)];
  }

  /** The number of the body, or piece of one, that may be stiff by its form and has a spring; -1: none has.
   * @type {(spring: number) => number} */
  formOf(spring) {
    return this.#inArena('form_of_spring', [], this.#block, spring);
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
    if (found && found.buffer === this.calls.buffer) return /** @type {View<P>} */ (found);
    const place = this.#table.get(path);
    if (!place) throw new Error(`there is no array ${path}`);
    const { word, kind, dimensions } = place, words = new Uint32Array(this.calls.buffer),
      at = this.#place(word);
    let size = 1;
    for (let k = 0; k < dimensions; k++) size *= words[at + 2 * (SHAPE + k)];
    const view = new KINDS[kind](this.calls.buffer, words[at + 2 * ADDRESS], size);
    this.#views.set(path, view);
    return /** @type {View<P>} */ (view);
  }

  /** How many rows an array has.
   * @type {(path: string) => number} */
  #dimension(path) {
    const { word } = this.#table.get(path) ?? { word: 0 };
    return new Uint32Array(this.calls.buffer)[this.#place(word) + 2 * SHAPE];
  }

  /** Numbers in a row of an array.
   * @type {(path: string) => number} */
  #width(path) {
    const { word, dimensions } = this.#table.get(path) ?? { word: 0, dimensions: 1 };
    return dimensions > 1 ? new Uint32Array(this.calls.buffer)[this.#place(word) + 2 * (SHAPE + 1)] : 1;
  }

  /** Let an array lie elsewhere, with so many rows.
   * @type {(path: string, address: number, rows: number) => void} */
  #lay(path, address, rows) {
    const { word } = this.#table.get(path) ?? { word: 0 };
    const words = [[2, rows * this.#width(path)], [ADDRESS, address], [SHAPE, rows]];
    for (const buffer of [this.calls.buffer, this.#given.buffer]) {
      const from = buffer === this.#given.buffer ? 0 : this.#base, all = new Uint32Array(buffer);
      for (const [at, value] of words) all[(from + WORD * (word + at)) / 4] = value;
    }
    this.#views.delete(path);
  }

  /** Give all arrays as many rows as are in use. It is derived again afterwards.
   * @type {(counts: Counts) => void} */
  #grow(counts) {
    for (const [path, [family, fill, more]] of Object.entries(this.#about.grows)) {
      const rows = counts[family] + more, before = this.view(path), had = this.#dimension(path);
      if (rows === had) continue;
      const width = this.#width(path), kept = before.slice(), isMoved = rows > (this.#room.get(path) ?? 0);
      if (isMoved) this.#room.set(path, MORE * rows);
      const address = isMoved ? this.calls.reserve(MORE * rows * width * kept.BYTES_PER_ELEMENT) : before.byteOffset;
      this.#lay(path, address, rows);
      const view = this.view(path);
      put(view, kept.subarray(0, Math.min(kept.length, view.length)));
      if (view instanceof BigInt64Array) view.fill(BigInt(fill), had * width);
      else view.fill(Number(fill), had * width);
    }
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
    this.step();
    if (this.#about.rules.length) this.calls.call('judge', this.#block);
  }

  // Physics alone: a tick in which no rule does anything.
  step() {
    const progress = this.view('progress'), { TICK, MAY_FLY, COUNT, CHECKED } = this.#about.progress;
    const { NO_ROOM, UNSOUND, LOST, BROKE } = this.#about.codes;
    progress[TICK] = BigInt(this.time);
    progress[MAY_FLY] = 1n;
    progress[COUNT] = progress[CHECKED] = 0n;
    let code = this.calls.call('tick', this.#block);
    while (code === NO_ROOM || code === UNSOUND) {
      if (code === NO_ROOM) this.#derive(ROOM);
      else {
        this.#takeBack(code);
        this.view('progress')[CHECKED] = 1n;
      }
      code = this.calls.call('tick', this.#block);
    }
    this.time += 1;
    if (code === LOST) {
      this.#takeBack(code);
      code = this.calls.call('find_broken', this.#block) ? BROKE : code;
    }
    this.broken = code === BROKE ? Array.from(this.view('limits.broken').subarray(0, this.#progress('BROKEN')), Number)
      : [];
    if (this.broken.length) this.command({ type: 'break_springs', springs: this.broken }, this.#about.givers.PROGRAM);
  }

  /** Take back what a tick has said of that no physics gives it, see sanitise.py.
   * @type {(code: number) => void} */
  #takeBack(code) {
    this.#inArena('take_back', [this.#block], code);
    this.#derive(DERIVATIONS);
  }

  /** Carry out what was done; its record has names until then, if it came with names. Throws a Refusal.
   * @type {(done: Done) => void} */
  carryOut(done) {
    done.record ??= this.commands.read(done.named, this.counts);
    this.command(done.record, this.#about.givers.HAND);
  }

  /** Carry out a command that somebody gives: the record of a recording with slots in place of names. Throws a Refusal
   * where it cannot be carried out, or where hands may not.
   * @type {(record: Command, giver: number) => void} */
  command(record, giver) {
    if (record.type === 'remove') {
      this.#remove(record, giver);
      return;
    }
    if (record.type === 'add_particle' || record.type === 'add_spring' || record.type === 'add_body') {
      this.#join(kitOf(record, this, this.#about), giver, record.type);
      return;
    }
    if (record.type === 'grab' && this.hands.particle < 0 && this.isInUse('particle', record.particle)) this.#reserveHands();
    const { tick_rate } = this.settings(), { particle: first_cursor, spring: first_spring } = this.hands;
    const packed = this.commands.packed(record, { first_cursor, first_spring, tick_rate, materials: this.counts.material });
    const { code, slots, numbers, changes } = packed;
    const given = this.calls.lend(BigInt64Array.from(slots, BigInt), Float64Array.from(numbers));
    const call = () => this.#inArena('command', [this.#block], giver, code, ...given);
    const answered = () => new Float64Array(this.calls.buffer, given[1][0], numbers.length);
    let result = call();
    if (this.commands.wantsRows(result)) {
      const [particle, spring, constraint, corner] = this.commands.rowsIn(answered());
      this.#addRows({ particle, spring, constraint, corner }, looseNames(this.names, particle, spring));
      result = call();
    }
    const answers = answered();
    this.commands.answer(record, packed, result, answers);
    if (changes === 'solver') {
      const factor = answers[numbers.length - 1];
      const impulse = this.view('collisions.kept.impulse');
      impulse.forEach((value, k) => { impulse[k] = factor ? value * factor : 0; });
    }
    if (changes) this.#derive(changes === 'hands' ? HANDS : DERIVATIONS);
  }

  /** @type {(hands: About['hands']) => void} */
  #hold(hands) {
    const plan = this.view('plan'), { GRAB_PARTICLE, GRAB_SPRING } = this.#about.plan;
    [plan[GRAB_PARTICLE], plan[GRAB_SPRING]] = [BigInt(hands.particle), BigInt(hands.spring)];
    this.hands = hands;
  }

  /** Name rows that come behind those there are; states that are kept have the lists of before.
   * @type {(added: Partial<Record<NameKind, string[]>>) => void} */
  #name(added) {
    for (const [kind, names] of /** @type {[NameKind, string[]][]} */ (Object.entries(added))) {
      this.names[kind] = [...this.names[kind], ...names];
    }
  }

  /** Add rows of families, with these names.
   * @type {(more: Partial<Counts>, names: Partial<Record<NameKind, string[]>>) => void} */
  #addRows(more, names) {
    const added = Object.entries(more).map(([family, count]) => [family, this.counts[/** @type {keyof Counts} */ (family)] + count]);
    /** @type {Counts} */
    const then = { ...this.counts, ...Object.fromEntries(added) };
    this.#grow(Object.assign(then, { breakable: then.breakable ? then.spring : 0 }));
    this.counts = then;
    this.#name(names);
  }

  // Give hands their slots, in a level that began with nothing, once there is something to hold.
  #reserveHands() {
    const { count } = this.hands, { particle, spring } = this.counts, names = Array.from({ length: count },
      (_, hand) => `+hand.${hand}`);
    this.#addRows({ particle: count, spring: count, hand: count }, { particle: names, spring: names });
    this.calls.call('reserve', this.#block, particle, spring);
    this.#hold({ particle, spring, count });
    this.#derive(DERIVATIONS);
  }

  /** Let a kit join, by a type of command. Throws a Refusal.
   * @type {(kit: Kit, giver: number, type: string) => void} */
  #join(kit, giver, type) {
    const table = this.#about.kit, { codes, families } = table, made = packed(kit, this, this.#about), { counts } = made;
    checkForms(kit, counts, table.words);
    const names = namesOf(kit, made, this, table), before = this.counts, scene = seen(kit, before, counts);
    const keys = keysOf(kit, before.actuator, counts.parts);
    const rows = this.calls.lend(made.slots, made.numbers), code = this.#about.codeOf[type];
    const call = () => this.#inArena('join', [this.#block], giver, code, ...this.#tables, ...rows);
    /** @type {Counts} */
    const then = { ...before, ...formCounts(kit, before), material: made.materials.length, area: before.area + names.area.length };
    for (const [part, family] of Object.entries(families)) if (part !== 'materials') then[family] += counts[part];
    let answer = call();
    if (answer === codes.NO_ROWS || answer === codes.NO_LIMIT_ROWS) {
      const isLimited = answer === codes.NO_LIMIT_ROWS;
      this.#grow(Object.assign(then, { limit: isLimited ? then.material : 0, breakable: isLimited ? then.spring : 0 }));
      answer = call();
    }
    this.commands.check(type, answer, (slot) => this.names.particle[slot]);
    if (answer !== 0) throw answered(answer, made, table, (part) => (part === 'materials' ? made.materials.length - 1
      : then[families[part]]));
    // Of what has no rows for a kernel too, areas and forms are to be named.
    this.#grow(then);
    this.counts = then;
    put(this.view('areas'), areasOf(kit, before.constraint), 2 * before.area);
    for (const [path, values, at] of formRows(kit, before)) put(this.view(path), values, at);
    this.#forms = [...this.#forms, ...formNames(kit, this.bodyCount + 1)];
    const { particle, spring, material, part, second, area } = names;
    this.#name({ particle, spring, part, area });
    this.names.material = material;
    for (const [name, slot] of second) this.#second[name] = slot;
    const a = this.view('state.particle_a'), b = this.view('state.particle_b');
    const joins = (scene.joins ?? []).map((join) => ({ ...join, ends: /** @type {[number, number]} */ ([a[join.spring],
      b[join.spring]]) }));
    this.#joined = [...this.#joined, { scene: { ...scene, joins }, keys, bodies: counts.bodies }];
    this.#derive(DERIVATIONS);
  }

  /** Take out what hangs on a particle, or a body by its name. Throws a Refusal.
   * @type {(record: Extract<Command, { type: 'remove' }>, giver: number) => void} */
  #remove({ type, particle, body }, giver) {
    const { codes, ways } = this.#about.kit;
    const isBody = particle === undefined || particle === null, isBoth = isBody === (body === undefined || body === null);
    if (isBoth) throw new Refusal(this.#about.kit.words.oneOfTwo);
    /** @type {(kind: 'particle' | 'spring', mark: string) => number[]} */
    const named = (kind, mark) => this.names[kind].flatMap((name, slot) =>
      (name.startsWith(`${body}${mark}`) && this.isInUse(kind, slot) ? [slot] : []));
    const particles = isBody ? named('particle', '.') : [particle], springs = isBody ? named('spring', ':') : [];
    if (!particles.length && !springs.length) throw new Refusal(this.#about.kit.words.notThere);
    const rows = this.calls.lend(BigInt64Array.from(particles, BigInt), BigInt64Array.from(springs, BigInt));
    const answer = this.#inArena('remove', [this.#block], giver, isBody ? ways.BODY : ways.HANGING, ...rows);
    this.commands.check(type, answer, (k) => (k < particles.length ? this.names.particle[particles[k]]
      : this.names.spring[springs[k - particles.length]]));
    if (answer <= codes.BAD_SLOT) throw new Refusal(this.#about.kit.words.notThere);
    this.#derive(DERIVATIONS);
  }

  /** Derive what follows from topology, which is everything, or from hands alone, or room; contacts of the last step stay.
   * @type {(names: string[], contacts?: AnyArray[]) => void} */
  #derive(names, contacts = this.#contactRows()) {
    if (names === DERIVATIONS) new Uint8Array(this.calls.buffer).set(this.#given, this.#base);
    this.#views.clear();
    this.view('collisions.counts')[this.#about.progress.KEPT] = BigInt(contacts[0].length);
    for (const name of names) this.#inArena(name, [this.#block]);
    if (names !== HANDS) CONTACTS.forEach((path, k) => put(this.view(path), contacts[k]));
  }

  /** The particle to pull of the thing of some springs, and a release of it, see step_response.py; below 0: why none.
   * @type {(springs: number[], isAside: boolean, release: Float64Array) => number} */
  choosePull(springs, isAside, release) {
    const [own, touching, numbers] = this.calls.lend(BigInt64Array.from(springs, BigInt),
      BigInt64Array.from(this.contacts(), BigInt), release);
    const slot = this.#inArena('choose_pull', [], this.#block, own, touching, Number(isAside), numbers);
    release.set(new Float64Array(this.calls.buffer, numbers[0], release.length));
    return slot;
  }

  /** Call a kernel with what comes first, with its own arena, and what comes after that; arrays may lie elsewhere then.
   * @type {(name: string, before: Span[], ...given: (number | Span)[]) => number} */
  #inArena(name, before, ...given) {
    const result = this.calls.inArena(name, before, ...given);
    this.#views.clear();
    return result;
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

  // How many bodies have joined.
  get bodyCount() {
    return this.#joined.reduce((sum, { bodies }) => sum + bodies, 0);
  }

  // Keys that drive parts of what joined, by their names.
  get joinedKeys() {
    return keysIn(this.#joined);
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
    return this.#isOfHands('particle', particle);
  }

  /** @type {(kind: 'particle' | 'spring', slot: number) => boolean} */
  #isOfHands(kind, slot) {
    const { [kind]: first, count } = this.hands;
    return first >= 0 && slot >= first && slot < first + count;
  }

  /** Whether what a name stands for is in use, and no hand's; parts and materials always are.
   * @type {(kind: NameKind, slot: number) => boolean} */
  isInUse(kind, slot) {
    if (kind !== 'particle' && kind !== 'spring') return true;
    return Boolean(this.view(`state.${kind}_active`)[slot]) && !this.#isOfHands(kind, slot);
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
    return Array.from({ length: this.counts.spring }, (_, s) => s).filter((s) => !this.#isOfHands('spring', s));
  }

  /** @type {(hand: number) => boolean} */
  isHeld(hand) {
    return this.hands.spring >= 0 && Boolean(this.view('state.spring_active')[this.hands.spring + hand]);
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
    return { time: this.time, counts: this.counts, arrays, contacts: this.#contactRows(), joined: this.#joined,
      names: { ...this.names, form: this.#forms }, second: { ...this.#second }, hands: this.hands };
  }

  /** @type {(state: SavedState) => void} */
  restore({ time, counts, arrays, contacts, joined, names: { form, ...names }, second, hands }) {
    const isOther = this.#about.topology.some((path) => !isEqual(this.view(path), arrays.get(path) ?? NONE));
    this.#joined = joined;
    this.#forms = form;
    Object.assign(this.names, names);
    for (const name of Object.keys(this.#second)) delete this.#second[name];
    Object.assign(this.#second, second);
    this.#hold(hands);
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
    return this.#hashes.of(this);
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
