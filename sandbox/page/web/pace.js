// Pace: how many ticks a frame makes, so that time passes as it does outside, or as fast as the machine can.
import { PACE } from './shared.js';

// The longest frame that is made up for, and what the ticks of a frame may take [s]: what is beyond is lost, but the page
// goes on answering.
const { LONGEST, BUDGET } = PACE;
// How long what was lost counts [s]; the part of all time from which it is slow, and that below which it is no more.
const MEMORY = 2, SLOW = 0.1, FAIR = 0.02;

export class Pace {
  #then = 0;
  #owed = 0;
  #lost = 0;
  // How far the present lies between the last two ticks, 0..1.
  part = 1;
  // Whether it has been slower than it should be of late.
  isBehind = false;

  /** clock: what time it is [ms].
   * @param {() => number} [clock] */
  constructor(clock = () => performance.now()) {
    this.clock = clock;
    this.#then = clock();
  }

  /** Let time pass until now [ms], at so many ticks a second. tick: makes one, and says whether time still passes.
   * @type {(now: number, rate: number, tick: () => boolean) => void} */
  pass(now, rate, tick) {
    const passed = Math.max(now - this.#then, 0) / 1000, counted = Math.min(passed, LONGEST), began = this.clock();
    this.#then = now;
    this.#owed += counted * rate;
    for (let goesOn = true; this.#owed >= 1 && goesOn; this.#owed -= 1) {
      goesOn = tick() && this.clock() - began < 1000 * BUDGET;
    }
    const cut = Math.floor(this.#owed);
    this.#owed = cut ? 0 : this.#owed;
    this.part = cut ? 1 : this.#owed;
    this.#remember(counted, Math.min((cut + (passed - counted) * rate) / (passed * rate || 1), 1));
  }

  /** lost: which part of the time that passed.
   * @type {(counted: number, lost: number) => void} */
  #remember(counted, lost) {
    this.#lost += (lost - this.#lost) * (1 - Math.exp(-counted / MEMORY));
    this.isBehind = this.#lost > (this.isBehind ? FAIR : SLOW);
  }

  /** Time stands until now [ms]: nothing is owed.
   * @type {(now: number) => void} */
  rest(now) {
    [this.part, this.isBehind] = [1, false];
    [this.#then, this.#owed, this.#lost] = [now, 0, 0];
  }
}
