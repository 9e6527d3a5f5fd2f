// World: a block of arrays in the memory of WebAssembly, and the kernels that do all physics there.
import { blake2b, hexOf } from './hash.js';

const PAGE = 65536, WORD = 8, ALIGNED = 16, ADDRESS = 4, SHAPE = 5;
const KINDS = {
  f8: Float64Array, f4: Float32Array, i8: BigInt64Array, u4: Uint32Array, i4: Int32Array, i1: Int8Array, b1: Uint8Array,
};
// Numbers that a record of a command may have beside the springs that it names.
const RECORD = 16;

// What a person is to read, in one line.
export class Refusal extends Error {}

const aligned = (size) => Math.ceil(size / ALIGNED) * ALIGNED;

export class World {
  #kernels;
  #about;
  #base;
  #end;
  #views = new Map();
  #hashed = new Map();
  #saved = new Map();
  // Ticks since the level's start; springs that broke in the last one.
  time = 0;
  broken = [];

  // kernels: what the module exports; image: the block as bytes; about: what Python says of both, see about.py.
  constructor(kernels, image, about) {
    this.#kernels = kernels;
    this.#about = about;
    const heap = aligned(kernels.__heap_base.value), springs = about.names.spring.length;
    this.arguments = heap;
    this.record = heap + 32 * WORD;
    this.#base = aligned(this.record + (2 * RECORD + springs) * WORD);
    this.#end = this.#base + image.length;
    this.#reserve(this.#end);
    new Uint8Array(kernels.memory.buffer).set(image, this.#base);
    const words = new Uint32Array(kernels.memory.buffer);
    for (const [word] of Object.values(about.table)) words[this.#place(word) + 2 * ADDRESS] += this.#base;
  }

  #reserve(end) {
    const pages = Math.ceil(end / PAGE) - this.#kernels.memory.buffer.byteLength / PAGE;
    if (pages > 0) this.#kernels.memory.grow(pages);
  }

  // Where a word of the block is, as an index of numbers of 32 bits.
  #place(word) {
    return (this.#base + WORD * word) / 4;
  }

  // The array at a path of the block, such as 'state.position', flat.
  view(path) {
    const found = this.#views.get(path);
    if (found && found.buffer === this.#kernels.memory.buffer) return found;
    const place = this.#about.table[path];
    if (!place) throw new Error(`there is no array ${path}`);
    const [word, kind, dimensions] = place, words = new Uint32Array(this.#kernels.memory.buffer), at = this.#place(word);
    let size = 1;
    for (let k = 0; k < dimensions; k++) size *= words[at + 2 * (SHAPE + k)];
    const view = new KINDS[kind](this.#kernels.memory.buffer, words[at + 2 * ADDRESS], size);
    this.#views.set(path, view);
    return view;
  }

  // Call a kernel with arrays: addresses, numbers of items and bytes of each.
  #call(name, ...arrays) {
    const words = new BigInt64Array(this.#kernels.memory.buffer, this.arguments, 7 * arrays.length);
    arrays.forEach(([address, count, size], k) => {
      words.set([0, 0, count, size, address, count, size].map(BigInt), 7 * k);
    });
    const kernel = this.#kernels[this.#about.kernels[name]];
    if (kernel(this.arguments) !== 0) throw new Error(`the kernel ${name} failed`);
    return Number(words[0]);
  }

  get #block() {
    return [this.#base, 1, WORD * this.#about.words];
  }

  #progress(name) {
    return Number(this.view('progress')[this.#about.progress[name]]);
  }

  tick() {
    const progress = this.view('progress'), { TICK, MAY_FLY, COUNT, CHECKED } = this.#about.progress;
    const { NO_ROOM, UNSOUND, LOST, BROKE } = this.#about.codes;
    progress[TICK] = BigInt(this.time);
    progress[MAY_FLY] = 1n;
    progress[COUNT] = progress[CHECKED] = 0n;
    let code = this.#call('tick', this.#block);
    while (code === NO_ROOM) {
      this.#grow();
      code = this.#call('tick', this.#block);
    }
    if (code === UNSOUND || code === LOST) throw new Refusal('This level came to values that no physics gives.');
    this.time += 1;
    this.broken = code === BROKE ? Array.from(this.view('limits.broken').subarray(0, this.#progress('BROKEN')), Number) : [];
    if (this.broken.length) this.#apply({ type: 'break_springs', springs: this.broken });
  }

  #grow() {
    throw new Refusal('This level wants more memory than the page has.');
  }

  // Carry out a command: the record of a recording with slots in place of names. Whether it could be.
  command(record) {
    return this.#apply(record);
  }

  #apply(record) {
    const layout = this.#about.commands[record.type];
    if (!layout || !this.#about.kernels.command) return this.#write(record);
    const numbers = (fields, missing) => fields.map((field) => record[field] ?? missing).flat();
    const whole = [layout.kind, ...numbers(layout.integers, -1)], parts = numbers(layout.floats, NaN);
    const floats = this.record, integers = floats + WORD * RECORD, { buffer } = this.#kernels.memory;
    new Float64Array(buffer, floats, parts.length).set(parts);
    new BigInt64Array(buffer, integers, whole.length).set(whole.map(BigInt));
    const done = this.#call('command', this.#block, [integers, whole.length, WORD], [floats, parts.length, WORD]);
    if (done && layout.derives) this.derive();
    return done !== 0;
  }

  // Whether a command of this type can be carried out.
  can(type) {
    return Boolean(this.#about.kernels.command) || ['move_grab', 'set_coefficients', 'set_drive'].includes(type);
  }

  // What commands write that change no topology.
  #write(record) {
    const disturb = (particle) => { this.view('state.energy_bank')[particle] = -1; };
    if (record.type === 'set_drive') {
      this.view('state.actuator_value')[record.part] = record.value;
    } else if (record.type === 'set_coefficients') {
      const material = record.material ?? null, a = this.view('state.particle_a'), b = this.view('state.particle_b');
      for (const [family, of] of [['', this.view('state.material')], ['constraint_', this.view('state.constraint_material')]]) {
        of.forEach((own, k) => {
          if (material === null ? own < 0 : own !== material) return;
          for (const name of ['stiffness', 'damping']) {
            if (record[name] != null) this.view(`state.${family}${name}`)[k] = record[name];
            this.view(`good.${family}${name}`)[k] = this.view(`state.${family}${name}`)[k];
          }
          this.view(`state.${family}lowest_mode`)[k] = this.view(`good.${family}lowest_mode`)[k] = 0;
          if (!family) [a[k], b[k]].forEach(disturb);
          else {
            const first = this.view('state.constraint_first')[k], corners = this.view('state.constraint_corners')[k];
            this.view('state.corner_particle').subarray(first, first + corners).forEach(disturb);
          }
        });
      }
    } else {
      return false;
    }
    return true;
  }

  // Derive what follows from topology, after a change of it.
  derive() {
    if (!this.#about.kernels.derive) throw new Refusal('This page cannot follow a change of what is joined.');
    while (this.#call('derive', this.#block) === this.#about.codes.NO_ROOM) this.#grow();
    this.#views.clear();
  }

  // First particle and spring of hands, and how many hands there are.
  get hands() {
    return this.#about.hands;
  }

  get areaKind() {
    return this.#about.area;
  }

  isHeld(hand) {
    return Boolean(this.view('state.spring_active')[this.hands.spring + hand]);
  }

  // Particles that touched something in the last step.
  contacts() {
    const count = Number(this.view('collisions.counts')[this.#about.progress.KEPT]);
    return this.view('collisions.kept.particle').subarray(0, count);
  }

  // What ticks keep from one to the next, as a copy; arrays that have not changed are those of the copy before.
  save() {
    const arrays = new Map();
    for (const path of this.#about.kept) {
      const present = this.view(path), last = this.#saved.get(path);
      arrays.set(path, last && isEqual(last, present) ? last : present.slice());
    }
    this.#saved = arrays;
    return { time: this.time, arrays };
  }

  restore(saved) {
    let isOther = false;
    for (const [path, kept] of saved.arrays) {
      const present = this.view(path);
      isOther ||= this.#about.topology.includes(path) && !isEqual(present, kept);
      present.set(kept);
    }
    this.time = saved.time;
    this.broken = [];
    if (isOther) this.derive();
  }

  // The rows of a state array that are in use, flat.
  rows(column) {
    const view = this.view(column.path);
    if (!column.isContact) return view;
    return view.subarray(0, column.width * Number(this.view('collisions.counts')[this.#about.progress.KEPT]));
  }

  // The hash of the whole state, and those of its arrays that are in use, by their names in files.
  hash() {
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
    const settings = [...gravity.map(hexOf), tick_rate, substeps, solver, iterations, ...[warm_start, ...wind, drag].map(hexOf)];
    const text = [...arrays.values(), this.time, ...settings].join('\n');
    return { whole: blake2b(new TextEncoder().encode(text), 16), arrays };
  }

  // The settings of a tick, in the order in which they are hashed and stored.
  settings() {
    const [x, y, windX, windY, drag, warm] = this.view('numbers');
    const [solver, rate, substeps, isAuto, iterations] = Array.from(this.view('choices'), Number);
    return {
      gravity: [x, y], tick_rate: rate, substeps: isAuto ? 'auto' : substeps, solver: this.#about.solvers[solver],
      iterations, warm_start: warm, wind: [windX, windY], drag,
    };
  }
}

function isEqual(one, other) {
  if (one.length !== other.length) return false;
  const a = new Uint8Array(one.buffer, one.byteOffset, one.byteLength);
  const b = new Uint8Array(other.buffer, other.byteOffset, other.byteLength);
  for (let k = 0; k < a.length; k++) if (a[k] !== b[k]) return false;
  return true;
}

// The bytes that are hashed and stored: -0 as 0, and every NaN as the same.
export function canonical(array) {
  const copy = array instanceof Float64Array ? array.map((value) => value + 0) : array;
  return new Uint8Array(copy.buffer, copy.byteOffset, copy.byteLength);
}

// Nothing of an array of which all is as usual, and which is left out then.
function digestOf(column, array) {
  if (column.isSparse && array.every((value) => Number(value) === column.usual)) return null;
  return blake2b(canonical(array), 8);
}
