// Race: a run that somebody sent goes along as a shade, and who of the two wins by how much.
import { Picture } from './draw.js';
import { Refusal } from './commands.js';
import { verified } from './recording.js';
import { outcome } from './rules.js';
import { Run } from './run.js';
/** @import { Toy } from './toy.js' */
/** @import { Outcome, Rival } from './types.js' */

/** @typedef {{ outcome: Outcome, value: number }} Result */

const number = new Intl.NumberFormat('en', { maximumFractionDigits: 2 });

/** What a level measures at the end of a tick: a counter, or the tick.
 * @type {(toy: Toy, world: Toy['world'], tick: number) => number} */
function measured({ level: { goals: { measure: { counter } } } }, world, tick) {
  return counter === null ? tick : world.view('state.counter')[counter];
}

/** How the run of a rival ends, carried out as by hand. Throws a Refusal where it is not what it says, or does not win.
 * @type {(toy: Toy, rival: Rival, progress: (done: number) => void) => Promise<Result>} */
export async function resultOf(toy, { recording }, progress) {
  const world = toy.fresh();
  /** @type {Result | null} */
  let found = null;
  const wrong = await verified(world, recording, progress, () => {
    const ended = found ? null : outcome(world);
    if (ended) found = { outcome: ended, value: measured(toy, world, ended.tick) };
  });
  if (wrong) throw new Refusal(`No race: at ${(wrong.tick / toy.rate).toFixed(1)} s ${wrong.words || 'this browser comes to other bits'}.`);
  const { [0]: result } = /** @type {Result[]} */ ([found ?? []].flat());
  if (!result?.outcome.isWon) throw new Refusal('No race: the run of this link does not win.');
  return result;
}

export class Race {
  #run;
  #picture;
  #previous;

  /** @param {Toy} toy @param {Rival} rival @param {Result} result */
  constructor(toy, { name, recording: { commands, hashes } }, result) {
    const world = toy.fresh();
    this.toy = toy;
    this.name = name;
    this.result = result;
    this.#run = new Run(world, commands.map((done) => ({ ...done })), hashes.length - 1);
    this.#picture = new Picture(toy.canvas, toy.level.scene, world);
    this.#previous = world.view('state.position').slice();
    toy.addEventListener('tick', () => this.#follow());
    toy.addEventListener('jump', () => this.#follow());
    toy.shade = (part, seconds) => this.#picture.shade(toy.camera, toy.theme, this.#previous, part, seconds);
  }

  // Beyond its end it stands as it ended.
  #follow() {
    const run = this.#run, tick = Math.min(this.toy.run.time, run.last);
    if (tick < run.time) run.seek(tick);
    this.#previous = run.world.view('state.position').slice();
    while (run.time < tick) run.step();
  }

  /** Who wins by how much, in a sentence: by stars, then by what the level measures, then by time.
   * @type {(mine: Outcome) => string} */
  said({ isWon, stars, tick }) {
    const { name, toy, result: { outcome: theirs, value } } = this, { measure } = toy.level.goals;
    if (!isWon) return `${name} beats you.`;
    /** @type {(by: number) => string} */
    const seconds = (by) => `${(by / toy.rate).toFixed(2)} s`;
    const apart = measured(toy, toy.world, tick) - value;
    /** @type {[by: number, words: (by: number) => string][]} */
    const ways = [
      [stars - theirs.stars, (by) => `${by} star${by > 1 ? 's' : ''}`],
      [measure.is_most ? apart : -apart, measure.counter === null ? seconds : (by) => `${number.format(by)} (${measure.text})`],
      [theirs.tick - tick, seconds],
    ];
    const [by, words] = ways.find(([each]) => each) ?? [0, seconds];
    return by ? `${by > 0 ? `You beat ${name}` : `${name} beats you`} by ${words(Math.abs(by))}.` : `You and ${name} are even.`;
  }
}
