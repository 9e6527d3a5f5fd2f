// Kit: bodies as rows, packed as the kernel takes them that lets them join a world; their names, and what people see.
import { Refusal } from './commands.js';
import { checkLook, moved } from './look.js';
/**
 * @import { About, Command, Counts, Joined, Kit, KitNames, KitTable, Level } from './types.js'
 */
/** @import { World } from './world.js' */

// Of a kit beside the columns of its parts.
const KNOWN = ['bodies', 'names', 'areas', 'forms', 'keys', 'look'];
const PARTS = ['particles', 'springs', 'constraints', 'corners', 'parts', 'muscles', 'hydraulics', 'motors', 'rims', 'materials',
  'hulls', 'free_wheels'];
// Of a form of a body at rest: how many rows or particles each item of a list has.
/** @type {Record<string, number>} */
const FORM = { pairs: 2, areas: 3, bends: 3, springs: 1, constraints: 1 };
const FARTHEST_PLACE = 1e9, MOST = 5000, NAME = 256, TEXT = /^\w{1,40}$/;
/** @typedef {Record<string, unknown>} Columns */
/** @typedef {{ slots: BigInt64Array, numbers: Float64Array, counts: Record<string, number>, materials: string[] }} PackedKit */

/** @type {(message: string, ...values: unknown[]) => Refusal} */
const refusal = (message, ...values) => new Refusal(message.replace(/\{[^}]*\}/g, () => String(values.shift())));
/** @type {(value: unknown) => value is Columns} */
export function isTable(value) {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}
/** @type {(value: unknown, least: number, most: number) => value is number} */
export function isWhole(value, least, most) {
  return Number.isInteger(value) && Number(value) >= least && Number(value) <= most;
}

/** The kit of a command that adds. Throws a Refusal.
 * @type {(record: Extract<Command, { type: 'add_body' | 'add_particle' | 'add_spring' }>, world: World, about: About) =>
 *   Kit} */
export function kitOf(record, world, { adding: { surface, made }, kit: { words } }) {
  if (record.type === 'add_body') {
    const { kit } = record;
    const stranger = Object.keys(record).find((name) => !['type', 'kit'].includes(name)) ?? Object.keys(isTable(kit) ? kit : {}).find((name) => !KNOWN.includes(name)
      && !PARTS.includes(name));
    if (stranger !== undefined) throw refusal(words.unknown, stranger.slice(0, 60));
    if (!isTable(kit)) throw refusal(words.notATable, 'kit');
    return kit;
  }
  if (record.type === 'add_particle') {
    const { position: [x, y], velocity, mass, radius, pinned, friction, restitution } = record, [vx, vy] = velocity ?? [0, 0];
    return { particles: { x: [x], y: [y], vx, vy, mass, radius, pinned: Number(pinned), body: [-1], ...surface,
      friction: friction ?? surface.friction, restitution: restitution ?? surface.restitution },
    look: { balls: [{ slot: 0, kind: 'steel', colour: null }] } };
  }
  const { particle_a: a, particle_b: b, rest_length, stiffness = 0.5, damping = 0.9 } = record;
  if (a === b) throw refusal(words.sameEnds, world.names.particle[a]);
  return { springs: { a: [-1 - a], b: [-1 - b], rest_length, stiffness, damping }, materials: { name: [world.names.material[0]] },
    look: { joins: [{ spring: 0, skin: '', line: stiffness >= made.firm ? 'steel' : 'coil', colour: '#8e99a8', width: 1 }] } };
}

/** The columns of a kit for a world at its present tick. Throws a Refusal.
 * @type {(kit: Kit, world: World, about: About) => PackedKit} */
export function packed(kit, world, { kit: table, hands }) {
  const { parts, words } = table, { bodies = 0 } = kit, { counts: used } = world;
  if (!isWhole(bodies, 0, MOST)) throw refusal(words.notWhole, 'bodies');
  /** @type {Record<string, Columns>} */
  const given = {};
  for (const part of parts.slice(1)) given[part] = columnsOf(kit, part, table);
  const names = materialNames(given.materials, words), known = world.names.material.slice(0, used.material);
  const materials = [...known, ...names.filter((name) => !known.includes(name))];
  given.materials = { ...given.materials, slot: names.map((name) => materials.indexOf(name)) };
  delete given.materials.name;
  /** @type {Record<string, number>} */
  const counts = { bodies };
  for (const part of parts.slice(1)) counts[part] = rowsOf(part, given[part], words);
  const limited = Math.floor(table.limitedWork / Math.max(1, used.particle + counts.particles));
  /** @type {Record<string, number>} */
  const most = { ...table.most, muscles: Math.min(table.most.muscles, limited) };
  const owner = 1 + world.view('state.owner').subarray(0, used.particle).reduce((last, each) => Math.max(last, each), -1);
  const inUse = parts.map((part) => (part === 'bodies' ? owner : used[table.families[part]] ?? 0));
  const header = [...parts.map((part) => counts[part]), ...inUse, ...parts.map((part) => most[part] ?? table.far),
    world.time, hands.particle];
  const slots = table.slots.map((column) => wholes(world, column, valuesOf(given, column, counts, words), words));
  const numbers = table.numbers.flatMap((column) => reals(column, valuesOf(given, column, counts, words), words));
  return { slots: BigInt64Array.from([...header.map(BigInt), BigInt(table.groupBits), ...slots.flat()]),
    numbers: Float64Array.from(numbers), counts, materials };
}

/** @type {(kit: Kit, part: string, table: KitTable) => Columns} */
function columnsOf(kit, part, { slots, numbers, words }) {
  const columns = Object.hasOwn(kit, part) ? kit[part] : {};
  if (!isTable(columns)) throw refusal(words.notATable, part);
  const known = [...slots, ...numbers].filter(([own]) => own === part).map(([, name]) => name);
  const stranger = Object.keys(columns).find((name) => !known.includes(name) && !(part === 'materials' && name === 'name'));
  if (stranger !== undefined) throw refusal(words.unknown, `${part}.${stranger.slice(0, 60)}`);
  return columns;
}

/** @type {(columns: Columns, words: KitTable['words']) => string[]} */
function materialNames({ name = [] }, words) {
  const isRight = Array.isArray(name) && new Set(name).size === name.length && name.every((each) =>
    typeof each === 'string' && each.length <= NAME);
  if (!isRight) throw refusal(words.notRows, 'materials.name', 'different');
  return name;
}

/** How many rows a part has: as many as its first column that is a list.
 * @type {(part: string, columns: Columns, words: KitTable['words']) => number} */
function rowsOf(part, columns, words) {
  const values = Object.values(columns), count = values.find(Array.isArray)?.length ?? 0;
  if (count === 0 && values.some((each) => !Array.isArray(each))) throw refusal(words.notRows, part, 'some');
  return count;
}

/** @type {(given: Record<string, Columns>, column: KitTable['slots'][0] | KitTable['numbers'][0], counts: Record<string,
 *   number>, words: KitTable['words']) => unknown[]} */
function valuesOf(given, [part, name, usual], counts, words) {
  const count = counts[part], values = Object.hasOwn(given[part], name) ? given[part][name] ?? usual : usual;
  if (values === null && count) throw refusal(words.missing, `${part}.${name}`);
  if (!Array.isArray(values)) return Array.from({ length: count }, () => values);
  if (values.length !== count) throw refusal(words.notRows, `${part}.${name}`, count);
  return values.map((each) => each ?? usual);
}

/** Whole numbers; ends of springs in the world go by names, and bits by the digits of what may have 64.
 * @type {(world: World, column: KitTable['slots'][0], values: unknown[], words: KitTable['words']) => bigint[]} */
function wholes(world, [part, name], values, words) {
  const isEnd = part === 'springs' && ['a', 'b'].includes(name), isBits = ['group', 'collides'].includes(name);
  return values.map((value, k) => {
    const place = `${part}.${name}.${k}`;
    if (isEnd && typeof value === 'string') {
      const slot = world.commands.find('particle', value, world.counts);
      if (slot < 0) throw refusal(words.noParticle, place, value.slice(0, 60));
      return BigInt(-1 - slot);
    }
    if (isBits && typeof value === 'string' && /^\d{1,20}$/.test(value)) return clipped(BigInt(value));
    if (!Number.isInteger(value)) throw refusal(words.notWhole, place);
    return clipped(BigInt(/** @type {number} */ (value)));
  });
}

const FARTHEST = 2n ** 62n;
/** @type {(value: bigint) => bigint} */
const clipped = (value) => (value > FARTHEST ? FARTHEST : value < -FARTHEST ? -FARTHEST : value);

/** @type {(column: KitTable['numbers'][0], values: unknown[], words: KitTable['words']) => number[]} */
function reals([part, name, usual], values, words) {
  return values.map((value, k) => {
    if (value === usual && typeof usual === 'string') return Number(usual);
    if (typeof value !== 'number') throw refusal(words.notANumber, `${part}.${name}.${k}`);
    return value;
  });
}

/** A number in six digits, as Python writes it.
 * @type {(value: number) => string} */
function shown(value) {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? 'nan' : value > 0 ? 'inf' : '-inf';
  const [digits, exponent] = value.toExponential(5).split('e'), power = Number(exponent);
  if (value !== 0 && (power < -4 || power > 5)) {
    return `${Number(digits)}e${power < 0 ? '-' : '+'}${String(Math.abs(power)).padStart(2, '0')}`;
  }
  return String(Number(value.toPrecision(6)));
}

/** Why a kit cannot join, by the kernel's answer.
 * @type {(answer: number, kit: PackedKit, table: KitTable, would: (part: string) => number) => Refusal} */
export function answered(answer, { slots, numbers, counts }, { parts, codes, words, nouns, slots: whole, numbers: real }, would) {
  if (answer > codes.BAD_PLACE) {
    const part = parts[codes.TOO_MANY - answer], most = Number(slots[2 * parts.length + parts.indexOf(part)]);
    if (part === 'free_wheels') return new Refusal(words.tooManyWheels);
    const shown = [most - Number(part === 'materials'), nouns[part] ?? part, would(part)];
    return refusal(words.tooMuch, ...shown.map((each) => (typeof each === 'number' ? each.toLocaleString('en') : each)));
  }
  let place = codes.BAD_PLACE - answer;
  if (place < codes.HEADER) return refusal(words.doesNotFit, parts[place], counts[parts[place]]);
  const value = place < slots.length ? Number(slots[place]) : numbers[place - slots.length];
  place -= codes.HEADER;
  for (const [part, name, , range] of [...whole, ...real]) {
    if (place < counts[part]) {
      const where = `${part}.${name}.${place}`, [low, high, said] = range ?? [NaN, NaN, ''];
      const isWithin = !said || (value >= Number(low) && value <= Number(high));
      return isWithin ? refusal(words.doesNotFit, where, shown(value)) : refusal(words.outOfRange, where, shown(value), said);
    }
    place -= counts[part];
  }
  return new Refusal(words.doesNotFit);
}

/** What a kit calls its rows in a world: names of particles, springs and driven parts, second names of particles with
 * their slots. Throws a Refusal.
 * @type {(kit: Kit, packed: PackedKit, world: World, table: KitTable) => KitNames} */
export function namesOf(kit, { counts, materials }, world, { words }) {
  const { names = {}, bodies = 0 } = kit;
  if (!isTable(names)) throw refusal(words.notATable, 'names');
  const first = world.bodyCount + 1, loose = { particle: unused(world.names.particle, /^\+\.(\d+)$/),
    spring: unused(world.names.spring, /^\+:(\d+)$/) };
  /** @type {(kind: 'particle' | 'spring', part: string, mark: string) => string[]} */
  const listed = (kind, part, mark) => runsOf(names[part], counts[part], bodies, words, `names.${part}`).map(([body, number]) =>
    (body < 0 ? `+${mark}${loose[kind]++}` : `+${first + body}${mark}${number}`));
  const particle = listed('particle', 'particles', '.'), from = loose.spring, spring = listed('spring', 'springs', ':');
  const { parts = [], second = [] } = /** @type {Record<string, any>} */ (names);
  const stranger = Object.keys(names).find((name) => !['particles', 'springs', 'second', 'parts'].includes(name));
  const isRight = stranger === undefined && Array.isArray(parts) && parts.length === counts.parts && parts.every((each) => isWhole(each, from
    - loose.spring, bodies - 1)) && Array.isArray(second) && second.length <= MOST && second.every((each) =>
    Array.isArray(each) && each.length === 3 && isWhole(each[0], 0, bodies - 1) && typeof each[1] === 'string' && TEXT.test(each[1])
    && isWhole(each[2], 0, counts.particles - 1));
  if (!isRight) throw refusal(words.doesNotFit, 'names', '');
  const more = second.map((/** @type {[number, string, number]} */ [body, text, slot]) =>
    /** @type {[string, number]} */ ([`+${first + body}.${text}`, slot + world.counts.particle]));
  const all = [...particle, ...more.map(([name]) => name)];
  if (new Set(all).size < all.length || new Set(spring).size < spring.length) throw refusal(words.doesNotFit, 'names', '');
  const area = (kit.areas ?? []).map((/** @type {number[]} */ [body]) => `+${first + body}`);
  return { particle, spring, second: more, material: materials, area,
    part: parts.map((/** @type {number} */ part) => (part >= 0 ? `+${first + part}` : `+:${from - 1 - part}`)) };
}

/** Body and number of each row: runs of [body, first number, how many]; of one body, or of none, where nothing is said.
 * @type {(runs: unknown, count: number, bodies: number, words: KitTable['words'], place: string) => [number, number][]} */
function runsOf(runs, count, bodies, words, place) {
  const given = runs ?? (count ? [[bodies === 1 ? 0 : -1, 0, count]] : []);
  /** @type {[number, number][]} */
  const found = [];
  for (const run of Array.isArray(given) ? given : [null]) {
    const isRight = Array.isArray(run) && run.length === 3 && isWhole(run[0], -1, bodies - 1) && isWhole(run[1], 0, 2 ** 31)
      && isWhole(run[2], 1, count - found.length);
    if (!isRight) throw refusal(words.doesNotFit, place, '');
    for (let k = 0; k < run[2]; k++) found.push([run[0], run[1] + k]);
  }
  if (found.length !== count) throw refusal(words.doesNotFit, place, '');
  return found;
}

/** Throw a Refusal where bodies that keep areas, or forms of bodies at rest, do not fit the rows of their kit.
 * @type {(kit: Kit, counts: Record<string, number>, words: KitTable['words']) => void} */
export function checkForms({ areas = [], forms = [] }, { bodies, constraints, springs }, words) {
  const areAreas = isShort(areas) && areas.every((row) => Array.isArray(row) && row.length === 3 && isWhole(row[0], 0, bodies - 1)
    && isWhole(row[1], 0, constraints - 1) && isWhole(row[2], 1, constraints - row[1]));
  if (!areAreas || new Set(areas.map((/** @type {number[]} */ [body]) => body)).size < areas.length) {
    throw refusal(words.doesNotFit, 'areas', 'a row');
  }
  const areForms = isShort(forms) && forms.every((form) => {
    if (!isTable(form) || Object.keys(form).length !== 9 || !isWhole(form.body, 0, bodies - 1)) return false;
    const { x, y, mass } = form, points = isShort(x) ? x.length : 0;
    const areReal = points > 0 && [x, y, mass].every((list) => isShort(list) && list.length === points && list.every((each) =>
      typeof each === 'number' && Math.abs(each) < FARTHEST_PLACE)) && isShort(mass) && mass.every((each) => each > 0);
    const areRows = form.pairs?.length === 2 * form.springs?.length
      && form.areas?.length + form.bends?.length === 3 * form.constraints?.length;
    return areReal && areRows && Object.entries(FORM).every(([name, size]) => {
      const list = form[name], most = { springs, constraints }[name] ?? points;
      return isShort(list) && list.length % size === 0 && list.every((each) => isWhole(each, 0, most - 1));
    });
  });
  if (!areForms) throw refusal(words.doesNotFit, 'forms', 'a form');
}

/** The keys of all that joined, by their names.
 * @type {(joined: { keys: Level['keys'] }[]) => Level['keys']} */
export function keysIn(joined) {
  /** @type {Level['keys']} */
  const found = {};
  for (const { keys } of joined) {
    for (const [name, parts] of Object.entries(keys)) found[name] = [...(Object.hasOwn(found, name) ? found[name] : []), ...parts];
  }
  return Object.fromEntries(Object.entries(found).sort());
}

/** First constraint of each body of a kit that keeps areas, and the one behind its last, in a world.
 * @type {(kit: Kit, constraint: number) => BigInt64Array} */
export function areasOf({ areas = [] }, constraint) {
  return BigInt64Array.from(areas.flatMap((/** @type {number[]} */ [, first, count]) => [constraint + first,
    constraint + first + count]), BigInt);
}

/** @type {(value: unknown) => value is any[]} */
function isShort(value) {
  return Array.isArray(value) && value.length <= MOST;
}

/** The first number from which on no name of a form is taken.
 * @type {(names: string[], form: RegExp) => number} */
export function unused(names, form) {
  const numbers = names.map((name) => form.exec(name)?.[1]).filter((each) => each !== undefined);
  return numbers.reduce((most, each) => Math.max(most, Number(each) + 1), 0);
}

/** Names of so many more particles and springs that are of no body.
 * @type {(names: { particle: string[], spring: string[] }, particles: number, springs: number) => { particle: string[], spring: string[] }} */
export function looseNames({ particle, spring }, particles, springs) {
  const dot = unused(particle, /^\+\.(\d+)$/), colon = unused(spring, /^\+:(\d+)$/);
  return { particle: Array.from({ length: particles }, (_, k) => `+.${dot + k}`),
    spring: Array.from({ length: springs }, (_, k) => `+:${colon + k}`) };
}

/** What people see of a kit, which joins a world with these rows in use. Throws a Refusal.
 * @type {(kit: Kit, used: Counts, counts: Record<string, number>) => Joined} */
export function seen({ look = {} }, { particle, spring }, counts) {
  checkLook(look, counts);
  return moved(look, particle, spring);
}

/** The keys that drive parts of a kit, by their names. Throws a Refusal.
 * @type {(kit: Kit, first: number, count: number) => Record<string, [part: number, value: number][]>} */
export function keysOf({ keys = {} }, first, count) {
  const isRight = isTable(keys) && Object.entries(keys).every(([name, parts]) => name.length <= 40 && Array.isArray(parts)
    && parts.every((each) => Array.isArray(each) && each.length === 2 && isWhole(each[0], 0, count - 1)
      && [1, -1].includes(each[1])));
  if (!isRight) throw new Refusal('keys: they do not fit');
  return Object.fromEntries(Object.entries(keys).map(([name, parts]) => [name, parts.map(([part, value]) =>
    /** @type {[number, number]} */ ([part + first, value]))]));
}
