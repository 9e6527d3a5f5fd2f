// Feel: how a thing comes back that is pulled aside and let go, and Cs and Cd with which it feels as asked. Kernels say what
// follows, see step_response.py and feel_search.py; here are the copies of the world that they are asked about.
import { Refusal } from './commands.js';
import { FEEL, RELEASE, RESPONSE, SEARCH } from './shared.js';
/** @import { Fresh, SavedState, Settings } from './types.js' */
/** @import { World } from './world.js' */

/** What was measured: errors of the way, 1 as it is let go, tick by tick; and numbers, see RESPONSE.
 * @typedef {{ errors: Float64Array, numbers: Float64Array, tick: number }} Feel */
/** @typedef {Feel & { pair: [stiffness: number, damping: number], missed: number }} Found */
/** @typedef {Record<string, string>} Words */

/** A number of three digits, for a person.
 * @type {(value: number) => string} */
export const short = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(3))) : 'infinite');

/** A text with values in place of the names in it.
 * @type {(text: string, values: Record<string, string>) => string} */
export const filled = (text, values) => text.replace(/\{(\w+)\}/g, (_, name) => values[name]);

/** The body, or what loose springs are, of the first spring that does something at a particle; null: there is none.
 * @type {(world: World, particle: number) => string | null} */
export function bodyAt(world, particle) {
  const a = world.view('state.particle_a'), b = world.view('state.particle_b');
  const spring = working(world).find((k) => a[k] === particle || b[k] === particle);
  return spring === undefined ? null : bodyOf(world.names.spring[spring]);
}

/** @type {(name: string) => string} */
const bodyOf = (name) => name.slice(0, Math.max(name.lastIndexOf(':'), 0));

/** Springs that do something.
 * @type {(world: World) => number[]} */
function working(world) {
  const a = world.view('state.particle_a'), b = world.view('state.particle_b'), inverse = world.view('state.inverse_mass');
  const material = world.view('state.material');
  return world.springs.filter((k) => world.isInUse('spring', k) && material[k] >= 0 && inverse[a[k]] + inverse[b[k]] > 0);
}

/** The springs of a body.
 * @type {(world: World, body: string) => number[]} */
const springsOf = (world, body) => working(world).filter((k) => bodyOf(world.names.spring[k]) === body);

/** The material that all springs of a body are of, null: they are of several. Throws a Refusal where none has Cs and Cd.
 * @type {(world: World, body: string) => number | null} */
export function materialOf(world, body) {
  const law = world.view('state.law'), material = world.view('state.material');
  const found = new Set(springsOf(world, body).filter((k) => law[k] !== FEEL.HOOKE).map((k) => material[k]));
  if (!found.size) throw new Refusal(`${FEEL.ALL_HOOKE}.`);
  return found.size === 1 ? [...found][0] : null;
}

export class Copies {
  /** Two copies of a world as it is; in the second one things are pulled.
   * @param {Fresh} fresh @param {World} world */
  constructor(fresh, world) {
    this.start = world.save();
    this.still = fresh();
    this.pulled = fresh();
  }

  /** How a body comes back that is pulled as gravity has it, or across that; a tick at a time, with how much is done, 0..1.
   * pair: Cs and Cd of the springs of a material, as in commands, in place of theirs. Throws a Refusal.
   * @param {string} body @param {boolean} isAside @param {{ pair: [number, number], material: number | null }} [other]
   * @returns {Generator<number, Feel>} */
  * release(body, isAside, other) {
    const { still, pulled } = this;
    still.restore(this.start);
    if (other) {
      const [stiffness, damping] = other.pair, { material } = other;
      this.#program(still, { type: 'set_coefficients', stiffness, damping, material, duration: 0 });
    }
    const rate = still.settings().tick_rate, numbers = new Float64Array(RELEASE.ERRORS + Math.round(RELEASE.MOST_SECONDS * rate) + 2);
    const slot = still.choosePull(springsOf(still, body), isAside, numbers);
    if (slot < 0) throw new Refusal(`${said(slot, numbers)}.`);
    let rested = this.start, follows = RELEASE.STEP;
    while (follows < RELEASE.FOUND) {
      if (follows === RELEASE.BEGIN) {
        if (numbers[RELEASE.NUMBER] === 0) rested = still.save();
        else still.restore(rested);
        pulled.restore(rested);
        this.#program(pulled, { type: 'pin', particle: slot });
      } else {
        if (follows !== RELEASE.STEP) this.#stepPulled(follows, slot, numbers);
        still.step();
        yield numbers[RELEASE.DONE];
      }
      follows = still.calls.compute('follow_release', numbers, ...[still, pulled].flatMap((world) =>
        [world.view('state.position').slice(), world.view('state.velocity').slice()]));
    }
    if (follows !== RELEASE.FOUND) throw new Refusal(`${said(follows, numbers)}.`);
    return this.#measured(numbers, rate);
  }

  /** @type {(numbers: Float64Array, rate: number) => Feel} */
  #measured(numbers, rate) {
    const errors = numbers.slice(RELEASE.ERRORS, RELEASE.ERRORS + numbers[RELEASE.COUNT]), tick = 1 / rate;
    const response = new Float64Array(RESPONSE.RESPONSE);
    response[RESPONSE.TICK] = tick;
    this.still.calls.compute('measure_response', errors, response);
    return { errors, numbers: response, tick };
  }

  /** @type {(follows: number, slot: number, numbers: Float64Array) => void} */
  #stepPulled(follows, slot, numbers) {
    const { pulled } = this;
    if (follows === RELEASE.LET_GO) this.#program(pulled, { type: 'unpin', particle: slot });
    if (follows !== RELEASE.FREE) {
      const [x, y, u, v] = numbers.subarray(RELEASE.HELD, RELEASE.HELD + 4);
      pulled.view('state.position').set([x, y], 2 * slot);
      pulled.view('state.velocity').set([u, v], 2 * slot);
    }
    pulled.step();
  }

  /** @type {(world: World, record: import('./types.js').Command) => void} */
  #program(world, record) {
    world.command(record, world.givers.PROGRAM);
  }

  /** The Cs and Cd of the springs of a material with which a body overshoots [1] and settles [s] nearest to what is asked; a
   * tick at a time. Throws a Refusal.
   * @param {string} body @param {boolean} isAside @param {[overshoot: number, settling: number]} asked
   * @param {number | null} material @returns {Generator<number, Found>} */
  * seek(body, isAside, asked, material) {
    const { still } = this, search = new Float64Array(SEARCH.SEARCH);
    still.restore(this.start);
    search.set([...asked, 1 / still.settings().tick_rate, ...pairNow(still, material)]);
    /** @type {Map<number, Found>} */
    const found = new Map();
    let why = '', follows = still.calls.computeInArena('seek', search);
    while (follows === SEARCH.TRY) {
      const round = search[SEARCH.ROUND], [stiffness, damping] = search.subarray(SEARCH.TRIED, SEARCH.HAS);
      try {
        /** @type {[number, number]} */
        const pair = [stiffness, damping], run = this.release(body, isAside, { pair, material });
        let step = run.next();
        for (; !step.done; step = run.next()) yield (round - 1 + step.value) / SEARCH.SOUGHT;
        const feel = step.value, { numbers } = feel;
        search.set([RESPONSE.OVERSHOOT, RESPONSE.SETTLING, RESPONSE.STIFFNESS, RESPONSE.DAMPING].map((at) => numbers[at]),
          SEARCH.GOT);
        found.set(round, { ...feel, pair, missed: 0 });
      } catch (error) {
        if (!(error instanceof Refusal)) throw error;
        why = error.message;
      }
      search[SEARCH.HAS] = Number(found.has(round));
      follows = still.calls.computeInArena('seek', search);
    }
    const best = found.get(search[SEARCH.BEST_ROUND]);
    if (follows === SEARCH.OVER && best) return { ...best, missed: search[SEARCH.MISSED] };
    const refusal = /** @type {Words} */ (FEEL.REFUSALS)[follows];
    throw new Refusal(refusal ? `${refusal.replace('{}', short(search[SEARCH.SOONEST]))}.` : why);
  }
}

/** Why there is no curve.
 * @type {(why: number, numbers: Float64Array) => string} */
function said(why, numbers) {
  const seconds = (numbers[RELEASE.COUNT] / numbers[RELEASE.RATE]).toFixed(0), left = (100 * numbers[RELEASE.REST]).toFixed(0);
  return filled(/** @type {Words} */ (FEEL.REASONS)[why], { seconds, left });
}

/** Cs and Cd of the springs of a material as they are, those in the middle where they differ.
 * @type {(world: World, material: number | null) => [number, number]} */
function pairNow(world, material) {
  const own = world.view('state.material'), law = world.view('state.law');
  const mine = world.springs.filter((k) => world.isInUse('spring', k) && law[k] !== FEEL.HOOKE
    && (material === null ? own[k] >= 0 : own[k] === material));
  /** @type {(values: ArrayLike<number>) => number} */
  const median = (values) => {
    const sorted = Float64Array.from(mine, (k) => values[k]).sort(), half = sorted.length >> 1;
    return sorted.length % 2 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
  };
  return [median(world.view('state.stiffness')), median(world.view('state.damping'))];
}

/** How it feels, in one sentence.
 * @type {(feel: Feel) => string} */
export function sentence({ numbers }) {
  const overshoot = numbers[RESPONSE.OVERSHOOT], [, text] = FEEL.FEELS.find(([most]) => overshoot <= Number(most)) ?? [0, ''];
  return filled(String(text), { overshoot: `${short(100 * overshoot)} %`, time: `${short(numbers[RESPONSE.SETTLING])} s` });
}

/** The curve as a transition of CSS, of few points.
 * @type {(world: World, feel: Feel) => string} */
export function css(world, { errors, tick }) {
  const kept = new Float64Array(errors.length), count = world.calls.compute('thin_curve', errors, kept);
  const ticks = [...kept.subarray(0, count)], last = ticks[count - 1];
  /** @type {(value: number) => string} */
  const written = (value) => String(Number(value.toFixed(4)));
  const stops = ticks.slice(1, -1).map((k) => `${written(1 - errors[k])} ${written(100 * k / last)}%`);
  return filled(FEEL.CSS, { milliseconds: (1000 * tick * last).toFixed(0), stops: ['0', ...stops, '1'].join(', ') });
}
