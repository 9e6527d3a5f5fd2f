// Best: the best run that somebody has won a level with here, which this browser keeps.
import { ahead, resultNow } from './race.js';
/** @import { Toy } from './toy.js' */
/** @import { Outcome, Result } from './types.js' */

/** @typedef {Result & { link: string }} Kept */

// What it is called in a race.
export const OWN = 'your best';

export class Best {
  #key;

  /** @param {Toy} toy */
  constructor(toy) {
    const { digest, physics } = toy.level.link;
    this.toy = toy;
    this.#key = `spring-sandbox best ${physics} ${digest}`;
  }

  /** null: there is none, or none that can be read.
   * @returns {Kept | null} */
  get kept() {
    try {
      const found = JSON.parse(localStorage.getItem(this.#key) ?? 'null');
      const isKept = typeof found?.link === 'string' && [found.stars, found.tick, found.value].every(Number.isFinite);
      return isKept ? found : null;
    } catch {
      return null;
    }
  }

  /** Keep the run that is won now, where it is better than the one that is kept, and not too long for a link.
   * @type {(outcome: Outcome) => Promise<void>} */
  async note(outcome) {
    const mine = resultNow(this.toy, outcome), { kept } = this;
    if (!outcome.isWon || (kept && ahead(this.toy, mine, kept).by <= 0)) return;
    const link = await this.toy.link();
    try {
      if (link !== null) localStorage.setItem(this.#key, JSON.stringify({ ...mine, link }));
    } catch { /* A browser that keeps nothing has no best run either. */ }
  }
}
