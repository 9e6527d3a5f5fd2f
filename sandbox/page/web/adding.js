// Adding: rows of what joins a world, for the commands that add to it: a particle, a spring, or a body that says each
// particle, spring and triangle, as session/commands/adding.py and level/assembly/joining.py have it, to the same bits.
import { Refusal } from './commands.js';
import { madeScene } from './made.js';
/**
 * @import { About, AddedBody, AddedParticle, AddedSpring, Adding, Counts, Family, NamedRecord, NameKind, Point, Runs,
 *   Told } from './types.js'
 */
/** @import { World } from './world.js' */

const CANNOT = 'a page cannot add a body with';
const BODY_RADIUS = 0.05, LONGEST = 1e6, MOST = 5000;

/** @type {(record: NamedRecord) => never} */
const refuse = (record) => { throw new Refusal(`${record.type}: it cannot be read`); };
/** @type {(value: unknown, least?: number) => value is number} */
function isNumber(value, least = -LONGEST) {
  return typeof value === 'number' && value >= least && value <= LONGEST;
}
/** @type {(value: unknown) => value is Point} */
function isPoint(value) {
  return Array.isArray(value) && value.length === 2 && value.every((each) => isNumber(each));
}
/** @type {(value: unknown, size: number, below: number) => boolean} */
const areRows = (value, size, below) => Array.isArray(value) && value.length <= MOST && value.every((row) =>
  Array.isArray(row) && row.length === size && new Set(row).size === size
  && row.every((each) => Number.isInteger(each) && each >= 0 && each < below));

/** What is told of a command that adds something to a world: its rows and their names. Throws a Refusal.
 * @type {(world: World, about: About, record: NamedRecord) => Told} */
export function addedTo(world, about, record) {
  const rows = new Rows(world, about, namesOf(record, world.names, world.counts).names);
  if (record.type === 'add_particle') addParticle(rows, /** @type {AddedParticle} */ (record));
  else if (record.type === 'add_spring') addSpring(rows, /** @type {AddedSpring} */ (record));
  else addBody(rows, /** @type {AddedBody} */ (record));
  return rows.told;
}

/** The first number from which on no name of a form is taken.
 * @type {(names: string[], count: number, form: RegExp) => number} */
export function unused(names, count, form) {
  const numbers = names.slice(0, count).map((name) => form.exec(name)?.[1]).filter((each) => each !== undefined);
  return numbers.reduce((most, each) => Math.max(most, Number(each) + 1), 0);
}

/** What a command adds is called, and the rows in use since then. Throws a Refusal.
 * @type {(record: NamedRecord, names: Record<NameKind, string[]>, counts: Counts) => Required<Pick<Told, 'names' |
 *   'counts'>>} */
export function namesOf(record, names, counts) {
  /** @type {(more: Partial<Counts>) => Counts} */
  const grown = (more) => /** @type {Counts} */ ({ ...counts, ...Object.fromEntries(Object.entries(more).map(
    ([family, count]) => [family, counts[/** @type {keyof Counts} */ (family)] + count])) });
  if (record.type === 'add_particle') {
    return { names: { particle: [`+.${unused(names.particle, counts.particle, /^\+\.(\d+)$/)}`] },
      counts: grown({ particle: 1 }) };
  }
  if (record.type === 'add_spring') {
    return { names: { spring: [`+:${unused(names.spring, counts.spring, /^\+:(\d+)$/)}`] }, counts: grown({ spring: 1 }) };
  }
  if (record.type === 'remove') return { names: {}, counts };
  const { body, materials } = /** @type {AddedBody} */ (record);
  const { particles, springs = [], triangles = [], material = 'default' } = body ?? {};
  if (![particles, springs, triangles].every(Array.isArray)) refuse(record);
  const number = Math.max(1, unused(names.particle, counts.particle, /^\+(\d+)\./));
  const isKnown = names.material.slice(0, counts.material).includes(material) || !(material in (materials ?? {}));
  return {
    names: { particle: particles.map((_, k) => `+${number}.${k}`), spring: springs.map((_, k) => `+${number}:${k}`),
      material: isKnown ? [] : [material] },
    counts: grown({ particle: particles.length, spring: springs.length, constraint: triangles.length,
      corner: 3 * triangles.length, material: Number(!isKnown) }),
  };
}

// Rows that are added behind those in use.
class Rows {
  /** @param {World} world @param {About} about @param {Told['names']} names */
  constructor(world, about, names) {
    if (about.hands.particle < 0) throw new Refusal('a page adds nothing to a level that begins with nothing');
    this.world = world;
    this.about = about;
    this.told = { changes: /** @type {Record<string, Runs>} */ ({}), counts: { ...world.counts },
      names, scene: {} };
  }

  /** Write a row of an array.
   * @type {(name: string, slot: number, values: (number | string)[]) => void} */
  write(name, slot, values) {
    (this.told.changes[`state.${name}`] ??= []).push([slot, 1, ...values]);
  }

  /** Add a row of a family: what it holds that is not as usual, by array; its slot.
   * @type {(family: Family, given: Record<string, number | string | number[]>) => number} */
  add(family, given) {
    const slot = this.told.counts[family]++;
    for (const { path, family: own, width, usual } of this.about.columns) {
      if (own !== family || !path.startsWith('state.')) continue;
      const name = path.slice('state.'.length), value = given[name] ?? (width > 1 ? [usual, usual] : usual);
      this.write(name, slot, Array.isArray(value) ? value : [value]);
    }
    return slot;
  }

  /** @type {(place: Point, velocity: Point, mass: number, pinned: boolean, more: Record<string, number | string>) =>
   *   number} */
  particle([x, y], velocity, mass, pinned, more) {
    const position = [x + 0, y + 0], speed = pinned ? [0, 0] : velocity.map((each) => each + 0);
    return this.add('particle', { position, origin: position, velocity: speed, slow_velocity: speed, mass,
      inverse_mass: pinned ? 0 : 1 / mass, gravity_scale: 1, particle_active: 1, unmoved: 1,
      energy_bank: this.about.adding.unopened, ...more });
  }

  /** @type {(a: number, b: number, rest: number, stiffness: number, damping: number, material: number, edge: number) =>
   *   number} */
  spring(a, b, rest, stiffness, damping, material, edge) {
    return this.add('spring', { particle_a: a, particle_b: b, rest_length: rest, natural_length: rest, stiffness,
      damping, material, edge, spring_active: 1 });
  }
}

/** @type {(rows: Rows, record: AddedParticle) => void} */
function addParticle(rows, record) {
  const { position, mass = 1, radius = BODY_RADIUS, pinned = false, velocity, friction, restitution } = record;
  const { surface } = rows.about.adding, known = ['type', 'position', 'mass', 'radius', 'pinned', 'velocity', 'friction',
    'restitution'];
  const isRight = Object.keys(record).every((name) => known.includes(name)) && isPoint(position) && isNumber(mass, 1e-9)
    && isNumber(radius, 0) && isPoint(velocity ?? [0, 0]) && [friction, restitution].every((each) => each == null
    || isNumber(each, 0));
  if (!isRight) refuse(record);
  const slot = rows.particle(position, velocity ?? [0, 0], mass, pinned, { radius, ...surface,
    friction: friction ?? surface.friction, restitution: restitution ?? surface.restitution,
    owner: -1 - rows.told.counts.particle });
  rows.told.scene = { balls: [{ slot, kind: 'steel', colour: null }] };
}

/** @type {(rows: Rows, record: AddedSpring) => void} */
function addSpring(rows, record) {
  const { particle_a: first, particle_b: second, rest_length: rest, stiffness = 0.5, damping = 0.9 } = record;
  const { world } = rows;
  const [a, b] = [first, second].map((name) => world.commands.slot({ names: 'particle' }, name, world.counts));
  const isRight = a !== b && isNumber(stiffness, 0) && stiffness <= 1 && isNumber(damping, 0) && damping <= 1
    && (rest == null || isNumber(rest, 0));
  if (!isRight) refuse(record);
  const position = world.view('state.position');
  const dx = position[2 * b] - position[2 * a], dy = position[2 * b + 1] - position[2 * a + 1];
  const spring = rows.spring(a, b, rest ?? Math.sqrt(dx * dx + dy * dy), stiffness, damping, 0, 0);
  for (const slot of [a, b]) {
    rows.write('spin', slot, [0]);
    rows.write('energy_bank', slot, [rows.about.adding.unopened]);
  }
  const line = stiffness >= rows.about.adding.made.firm ? 'steel' : 'coil';
  rows.told.scene = { joins: [{ spring, ends: [a, b], skin: '', line, colour: '#8e99a8', width: 1 }] };
}

/** Throw a Refusal where a page cannot add a body.
 * @type {(record: NamedRecord, adding: Adding) => void} */
export function checkBody(record, { fields, hasWater }) {
  const { body, materials, ...more } = /** @type {AddedBody} */ (record);
  if (typeof body !== 'object' || body?.type !== 'mesh' || Object.keys(more).length > 1) {
    throw new Refusal(`${CANNOT} more than particles, springs and triangles`);
  }
  const stranger = Object.keys(body).find((name) => !fields.includes(name));
  if (stranger) throw new Refusal(`${CANNOT} ${stranger}`);
  const given = Object.values(materials ?? {}), isTable = typeof (materials ?? {}) === 'object';
  if (!isTable || given.length > 1 || given.some((each) => typeof each !== 'object' || each === null)) {
    throw new Refusal(`${CANNOT} this material`);
  }
  if (hasWater) throw new Refusal('a page adds no bodies to a level with water');
}

/** @type {(rows: Rows, record: AddedBody) => void} */
function addBody(rows, record) {
  const { body, materials } = record, { about, world } = rows;
  checkBody(record, about.adding);
  const { particles, springs = [], triangles = [], masses, pinned = [], velocity = [0, 0] } = body;
  const count = Array.isArray(particles) ? particles.length : 0, isPinned = new Set(pinned === true
    ? particles.map((_, k) => k) : pinned || []);
  const isRight = count > 0 && count <= MOST && particles.every(isPoint) && isPoint(velocity)
    && areRows(springs, 2, count) && areRows(triangles, 3, count)
    && (masses === undefined || (masses.length === count && masses.every((mass) => isNumber(mass, 1e-9))));
  if (!isRight) refuse(record);
  const [material, stiffness, damping] = materialOf(rows, body.material ?? 'default', materials ?? {});
  const surface = surfaceOf(rows, body), owners = world.view('state.owner');
  const owner = 1 + owners.reduce((most, each) => Math.max(most, each), -1);
  const first = rows.told.counts.particle;
  particles.forEach((place, k) => {
    rows.particle(place, velocity, masses?.[k] ?? 1, isPinned.has(k), { ...surface, owner });
  });
  const edges = edgesOf(springs, triangles, about), spring = rows.told.counts.spring;
  springs.forEach(([a, b], k) => {
    const dx = particles[b][0] - particles[a][0], dy = particles[b][1] - particles[a][1];
    rows.spring(first + a, first + b, Math.sqrt(dx * dx + dy * dy), stiffness, damping, material, edges[k]);
  });
  for (const corners of triangles) {
    addTriangle(rows, corners.map((k) => particles[k]), corners.map((k) => first + k), [stiffness, damping, material]);
  }
  rows.told.scene = madeScene(body, { first, spring, made: about.adding.made });
}

/** An area that is kept. The sums are those of `rest_of_area`, in its order.
 * @type {(rows: Rows, places: Point[], slots: number[], coefficients: [number, number, number]) => void} */
function addTriangle(rows, places, slots, [stiffness, damping, material]) {
  const [[ax, ay], [bx, by], [cx, cy]] = places;
  const area = 0.5 * ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax));
  rows.add('constraint', { constraint_kind: rows.about.area, constraint_first: rows.told.counts.corner,
    constraint_corners: 3, constraint_rest: [area, area], constraint_stiffness: stiffness, constraint_damping: damping,
    constraint_material: material, constraint_active: 1 });
  places.forEach((form, k) => {
    const [nextX, nextY] = places[(k + 1) % 3], [lastX, lastY] = places[(k + 2) % 3];
    const dx = nextX - lastX, dy = nextY - lastY;
    rows.add('corner', { corner_particle: slots[k], corner_weight: 0.25 * (dx * dx + dy * dy), corner_form: form });
  });
}

/** Slot, Cs and Cd of a material: one that the world has, or one that comes with the body.
 * @type {(rows: Rows, name: string, given: Record<string, Record<string, unknown>>) => [number, number, number]} */
function materialOf({ world, about, told }, name, given) {
  const own = given[name], known = world.names.material.slice(0, world.counts.material).indexOf(name);
  const { stiffness = 0.5, damping = 0.9, ...more } = own ?? about.adding.materials[name] ?? { none: true };
  const isRight = !Object.keys(more).length && Object.keys(given).every((each) => each === name)
    && [stiffness, damping].every((value) => isNumber(value, 0) && value <= 1);
  if (!isRight) throw new Refusal(`${CANNOT} this material`);
  if (known >= 0) return [known, Number(stiffness), Number(damping)];
  return [told.counts.material++, Number(stiffness), Number(damping)];
}

/** What touches it, and how.
 * @type {(rows: Rows, body: AddedBody['body']) => Record<string, number | string>} */
function surfaceOf({ about: { adding } }, { particle_radius: radius = BODY_RADIUS, friction, restitution, collides = true }) {
  const bits = Array.isArray(collides) ? collides.map((name) => adding.groups[name]) : [];
  const isRight = isNumber(radius, 0) && [friction, restitution].every((each) => each == null || isNumber(each, 0))
    && bits.every((bit) => bit !== undefined);
  if (!isRight) throw new Refusal(`${CANNOT} this surface`);
  const touched = Array.isArray(collides) ? bits.reduce((all, bit) => all | BigInt(bit), 0n).toString()
    : collides ? adding.allGroups : '0';
  return { radius, friction: friction ?? adding.usual.friction, restitution: restitution ?? adding.usual.restitution,
    group: adding.group, collides: adding.touches ? touched : '0' };
}

/** Kinds of edge of springs: solid along one triangle, none along two, else a line.
 * @type {(springs: number[][], triangles: number[][], about: About) => number[]} */
function edgesOf(springs, triangles, { adding: { edges, touches } }) {
  if (!touches) return springs.map(() => edges.none);
  const sides = new Set(triangles.flatMap(([a, b, c]) => [`${a} ${b}`, `${b} ${c}`, `${c} ${a}`]));
  return springs.map(([a, b]) => {
    const left = sides.has(`${a} ${b}`), right = sides.has(`${b} ${a}`);
    return left && right ? edges.none : left ? edges.left : right ? edges.right : edges.line;
  });
}
