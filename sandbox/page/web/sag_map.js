// SagMap: what a body sags at every Cs and Cd of the pad, and the words for that, from the table that the window has.
import { PAD } from './shared.js';
/** @import { Point, SagMapData } from './types.js' */

// Values that have a number on an axis, where there is room; digits of a value, or of what it is below 1 by; from where
// on an axis it is 1.
const { NUMBERED, DIGITS, END } = PAD;

// An axis from its lowest value to 1; rest: what 1 - value fades out at, the less the wider the last tenth.
export class Scale {
  /** @param {number} lowest @param {number} rest */
  constructor(lowest, rest) {
    this.lowest = lowest;
    this.rest = rest;
    this.low = this.#height(lowest);
    this.high = -Math.log10(rest);
  }

  /** @type {(value: number) => number} */
  #height(value) {
    return Math.log10(value / (1 - value + this.rest));
  }

  /** @type {(value: number) => number} */
  placeOf(value) {
    if (value <= this.lowest) return 0;
    return Math.min((this.#height(Math.min(value, 1)) - this.low) / (this.high - this.low), 1);
  }

  /** @type {(place: number) => number} */
  valueAt(place) {
    if (place >= END) return 1;
    const power = 10 ** (this.low + Math.max(place, 0) * (this.high - this.low)),
      value = Math.min(1, (power * (1 + this.rest)) / (1 + power));
    if (value < 0.9) return Number(value.toPrecision(DIGITS));
    return Number((1 - Number((1 - value).toPrecision(DIGITS - 1))).toFixed(9));
  }

  numbers() {
    return NUMBERED.filter((value) => value >= this.lowest * 0.999);
  }
}

// Where nothing is known of what sags.
export const PLAIN = new Scale(PAD.LOWEST, PAD.REST);

export class SagMap {
  /** @type {Point[]} */
  #borders = [];
  #bordersOf = '';

  /** See SagMap.as_data in Python: logarithms of sags in steps, column by column, on an axis both ways.
   * @param {SagMapData} data */
  constructor({ lowest, rest, size, step, logs, names, edges, places }) {
    this.scale = new Scale(lowest, rest);
    this.size = size;
    this.logs = logs.map((value) => value * step);
    this.names = names;
    this.edges = edges.map(Math.log);
    this.places = places;
  }

  /** The logarithm of the sag at places 0..1 across and up, between the values around it.
   * @type {(across: number, up: number) => number} */
  #log(across, up) {
    const { size, logs } = this, x = across * (size - 1), y = up * (size - 1),
      left = Math.min(Math.floor(x), size - 2), low = Math.min(Math.floor(y), size - 2), right = x - left, above = y - low;
    /** @type {(column: number) => number} */
    const side = (column) => logs[column * size + low] * (1 - above) + logs[column * size + low + 1] * above;
    return side(left) * (1 - right) + side(left + 1) * right;
  }

  /** @type {(log: number) => number} */
  #number(log) {
    return this.edges.filter((edge) => log < edge).length;
  }

  /** @type {(stiffness: number, damping: number) => number} */
  #logAt(stiffness, damping) {
    return this.#log(this.scale.placeOf(stiffness), this.scale.placeOf(damping));
  }

  /** The sag at Cs and Cd.
   * @type {(stiffness: number, damping: number) => number} */
  at(stiffness, damping) {
    return Math.exp(this.#logAt(stiffness, damping));
  }

  /** @type {(stiffness: number, damping: number) => string} */
  wordAt(stiffness, damping) {
    return this.names[this.#number(this.#logAt(stiffness, damping))];
  }

  /** Pixels [x, y] of a map of that size between two words, y up.
   * @type {(wide: number, high: number) => Point[]} */
  borders(wide, high) {
    if (this.#bordersOf === `${wide} ${high}`) return this.#borders;
    this.#bordersOf = `${wide} ${high}`;
    this.#borders = [];
    const column = (/** @type {number} */ x) =>
      Array.from({ length: high }, (_, y) => this.#number(this.#log(x / (wide - 1), y / (high - 1))));
    let before = column(0);
    for (let x = 1; x < wide; x++) {
      const now = column(x);
      for (let y = 1; y < high; y++) if (now[y] !== before[y] || now[y] !== now[y - 1]) this.#borders.push([x, y]);
      before = now;
    }
    return this.#borders;
  }
}
