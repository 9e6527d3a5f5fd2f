// Checks: what a level promises of its run, measured as time passes from its start; those that hold keys are left out.
import { CHECKS } from './shared.js';
/** @import { StateArrays } from './tables.js' */
/** @import { Check, CheckResult, Point } from './types.js' */
/** @import { World } from './world.js' */

/** @typedef {{ value: number, beyond: number }} Found */
/** @typedef {{ check: Check, from: number, to: number, found: Found | null }} Waiting */
/** @typedef {Waiting & { found: Found }} Decided */

/** What a check measures, by its name in files: of its particles, springs and box.
 * @type {Record<string, (gauge: Checks, check: Check) => number>} */
const METRICS = {
  x: (gauge, check) => gauge.middle(check, 'position')[0],
  y: (gauge, check) => gauge.middle(check, 'position')[1],
  speed: (gauge, check) => Math.hypot(...gauge.middle(check, 'velocity')),
  distance: (gauge, { particles: [one, other] = [0, 0] }) => Math.hypot(...[0, 1].map((axis) =>
    gauge.at('position', one)[axis] - gauge.at('position', other)[axis])),
  inside: (gauge, check) => least(gauge.shown(check).map((p) => {
    const [x, y] = gauge.at('position', p), [left, bottom, right, top] = check.box ?? NOWHERE;
    return Math.min(x - left, right - x, y - bottom, top - y);
  })),
  settled: (gauge, check) => gauge.still(check),
  held: ({ world }) => Array.from({ length: world.hands.count }, (_, k) => k).filter((k) => world.isHeld(k)).length,
  max_speed: (gauge, check) => most(gauge.speeds(check)),
  kinetic_energy: (gauge, check) => gauge.energy(check),
  strain: (gauge, check) => most(gauge.strains(check)),
  max_strain: ({ window }) => most(window.map(([largest]) => largest)),
  rms_strain: ({ window }) => {
    const [squares, count] = [1, 2].map((k) => window.reduce((sum, each) => sum + each[k], 0));
    return count ? Math.sqrt(squares / count) : 0;
  },
  broken_springs: (gauge, { springs = gauge.world.springs }) => {
    const active = gauge.of('spring_active');
    return springs.filter((s) => !active[s]).length;
  },
  non_finite: (gauge, check) => gauge.shown(check).filter((p) =>
    ![...gauge.at('position', p), ...gauge.at('velocity', p)].every(Number.isFinite)).length,
};
const { STILL, STRAIN_WINDOW } = CHECKS, NOWHERE = [0, 0, 0, 0];
/** @type {(values: number[]) => number} */
const most = (values) => values.reduce((a, b) => Math.max(a, b), 0);
/** @type {(values: number[]) => number} */
const least = (values) => values.reduce((a, b) => Math.min(a, b), Infinity);

export class Checks {
  /** @type {Map<Check, number>} */
  #still = new Map();
  /** @type {Waiting[]} */
  #waiting = [];
  /** @type {Decided[]} */
  #decided = [];
  /** @type {[largest: number, squares: number, count: number][]} */
  window = [];

  /** checks: what each measures, of slots; particles and springs are all where none are named.
   * @param {{ checks: Check[] }} level @param {World} world */
  constructor({ checks }, world) {
    this.checks = checks;
    this.world = world;
    this.begin();
  }

  // At the start of a run all is open; elsewhere nobody can say what was before.
  begin() {
    const { tick_rate: rate } = this.world.settings();
    this.window = [];
    this.#still.clear();
    this.#waiting = this.world.time ? [] : this.checks.map((check) => ({ check, from: Math.round(check.from * rate),
      to: Math.round(check.to * rate), found: null }));
    this.#decided = this.#decide();
  }

  /** Measure at this tick: the checks that are decided by it, with what they came to.
   * @type {() => CheckResult[]} */
  look() {
    if (!this.#waiting.length && !this.#decided.length) return [];
    this.#follow();
    const told = [...this.#decided, ...this.#decide()];
    this.#decided = [];
    return told.map(({ check, found }) => ({ name: check.name, value: found.value, holds: found.beyond <= 0 }));
  }

  /** @type {() => Decided[]} */
  #decide() {
    const decided = this.#waiting.filter((each) => this.#isDecided(each));
    this.#waiting = this.#waiting.filter((each) => !decided.some((other) => other === each));
    return decided;
  }

  /** @type {(each: Waiting) => each is Decided} */
  #isDecided(each) {
    const { check, from, to, found } = each;
    if (this.world.time < from) return false;
    const value = METRICS[check.metric](this, check);
    const beyond = Number.isNaN(value) ? Infinity
      : Math.max((check.at_least ?? -Infinity) - value, value - (check.at_most ?? Infinity));
    if (!found || (check.is_eventual ? beyond < found.beyond : beyond > found.beyond)) each.found = { value, beyond };
    return this.world.time >= to || (Boolean(check.is_eventual) && beyond <= 0);
  }

  // What depends on more than the present tick.
  #follow() {
    if (this.checks.some(({ metric }) => metric.endsWith('_strain'))) {
      const strains = this.strains({});
      this.window.push([most(strains), strains.reduce((sum, each) => sum + each * each, 0), strains.length]);
      if (this.window.length > STRAIN_WINDOW * this.world.settings().tick_rate) this.window.shift();
    }
    for (const check of this.checks.filter(({ metric }) => metric === 'settled')) {
      const isStill = this.speeds(check).every((speed) => speed <= STILL);
      this.#still.set(check, isStill ? (this.#still.get(check) ?? 0) + 1 : 0);
    }
  }

  /** @template {keyof StateArrays} N @param {N} array */
  of(array) {
    return this.world.view(`state.${array}`);
  }

  /** @type {(array: 'position' | 'velocity', particle: number) => Float64Array} */
  at(array, particle) {
    return this.of(array).subarray(2 * particle, 2 * particle + 2);
  }

  /** The particles of a check that are there.
   * @type {(check: Partial<Check>) => number[]} */
  shown({ particles = this.world.particles }) {
    const active = this.of('particle_active');
    return particles.filter((p) => active[p]);
  }

  /** Mean place or velocity, by mass.
   * @type {(check: Check, array: 'position' | 'velocity') => Point} */
  middle(check, array) {
    const mass = this.of('mass');
    let [x, y, sum] = [0, 0, 0];
    for (const p of this.shown(check)) {
      const [u, v] = this.at(array, p);
      [x, y, sum] = [x + mass[p] * u, y + mass[p] * v, sum + mass[p]];
    }
    return [x / sum, y / sum];
  }

  /** @type {(check: Partial<Check>) => number[]} */
  speeds(check) {
    return this.shown(check).map((p) => Math.hypot(...this.at('velocity', p)));
  }

  /** @type {(check: Check) => number} */
  energy(check) {
    const mass = this.of('mass');
    return this.shown(check).reduce((sum, p) => sum + 0.5 * mass[p] * Math.hypot(...this.at('velocity', p)) ** 2, 0);
  }

  /** |l - L| / L of springs that have a free end.
   * @type {(check: Partial<Check>) => number[]} */
  strains({ springs = this.world.springs }) {
    const active = this.of('spring_active'), rest = this.of('rest_length'), inverse = this.of('inverse_mass');
    const a = this.of('particle_a'), b = this.of('particle_b');
    const bear = springs.filter((s) => active[s] && rest[s] > 0 && (inverse[a[s]] > 0 || inverse[b[s]] > 0));
    return bear.map((s) => {
      const [[x, y], [u, v]] = [this.at('position', a[s]), this.at('position', b[s])];
      return Math.abs(Math.hypot(u - x, v - y) - rest[s]) / rest[s];
    });
  }

  /** @type {(check: Check) => number} */
  still(check) {
    return (this.#still.get(check) ?? 0) / this.world.settings().tick_rate;
  }
}
