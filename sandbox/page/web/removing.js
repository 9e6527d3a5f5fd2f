// Removing: takes a particle out of a world, with all that springs join to it, as session/commands/removing.py has it.
import { Refusal } from './commands.js';
/** @import { About, NamedRecord, Runs, Told } from './types.js' */
/** @import { World } from './world.js' */

/** Carry out the cuts of a command that removes, and tell what else it changes. Throws a Refusal.
 * @type {(world: World, about: About, record: NamedRecord) => Told} */
export function removedFrom(world, about, record) {
  if (record.body !== undefined && record.body !== null) throw new Refusal('a page removes what hangs on a particle');
  const particle = world.commands.slot({ names: 'particle' }, record.particle, world.counts);
  if (!world.isInUse('particle', particle)) throw new Refusal('remove: it is not there any more');
  const gone = hangingOn(world, particle), { particle_a: a, particle_b: b } = ends(world);
  for (let hand = 0; hand < world.hands.count; hand++) {
    if (world.isHeld(hand) && gone.has(b[world.hands.spring + hand])) world.command({ type: 'release', grab: hand }, world.givers.PROGRAM);
  }
  const active = world.view('state.spring_active');
  const springs = Array.from(a.keys()).filter((s) => active[s] && (gone.has(a[s]) || gone.has(b[s])));
  if (springs.length) world.command({ type: 'cut_springs', springs }, world.givers.PROGRAM);
  /** @type {Record<string, Runs>} */
  const changes = {};
  /** @type {(name: string, slot: number, ...values: (number | string)[]) => void} */
  const write = (name, slot, ...values) => (changes[`state.${name}`] ??= []).push([slot, 1, ...values]);
  loseAreas(world, gone, (constraint, corners) => {
    write('constraint_active', constraint, 0);
    for (const corner of corners) write('energy_bank', corner, about.adding.unopened);
  });
  for (const slot of [...gone].sort((one, other) => one - other)) {
    write('particle_active', slot, 0);
    write('collides', slot, '0');
    write('velocity', slot, 0, 0);
    write('slow_velocity', slot, 0, 0);
    write('spin', slot, 0);
  }
  return { changes };
}

/** @type {(world: World) => { particle_a: Int32Array, particle_b: Int32Array }} */
const ends = (world) => ({ particle_a: world.view('state.particle_a').slice(),
  particle_b: world.view('state.particle_b').slice() });

/** The particles that go with one: those of its body, and what is pinned where all that it holds goes.
 * @type {(world: World, particle: number) => Set<number>} */
function hangingOn(world, particle) {
  const label = world.view('body_label'), there = world.view('state.particle_active');
  const a = world.view('state.particle_a'), b = world.view('state.particle_b');
  const active = world.view('state.spring_active'), material = world.view('state.material');
  const body = new Set(Array.from(there.keys()).filter((p) => there[p] && label[p] === label[particle]));
  const holds = Array.from(a.keys()).filter((s) => active[s] && material[s] >= 0);
  /** @type {(s: number, some: Set<number>) => boolean} */
  const isAt = (s, some) => some.has(a[s]) || some.has(b[s]);
  const anchors = new Set(holds.filter((s) => isAt(s, body)).flatMap((s) => [a[s], b[s]]).filter((p) => !body.has(p)));
  const others = holds.filter((s) => isAt(s, anchors) && !isAt(s, body)).flatMap((s) => [a[s], b[s]]);
  for (const other of others) anchors.delete(other);
  return new Set([...body, ...anchors]);
}

/** Each constraint that is there and has a corner among some particles, and the corners of all that have one; these where
 * one at least is there.
 * @type {(world: World, gone: Set<number>, lose: (constraint: number, corners: number[]) => void) => void} */
function loseAreas(world, gone, lose) {
  const first = world.view('state.constraint_first'), count = world.view('state.constraint_corners');
  const corner = world.view('state.corner_particle'), active = world.view('state.constraint_active');
  const corners = Array.from(first, (at, k) => Array.from(corner.subarray(at, at + count[k])));
  const lost = Array.from(first.keys()).filter((k) => corners[k].some((p) => gone.has(p)));
  if (lost.some((k) => active[k])) for (const k of lost) lose(k, corners[k]);
}
