// Race: a run that somebody sent goes along as a shade, and who of the two wins by how much.
import { Picture } from './draw.js';
import { Refusal } from './commands.js';
import { verified } from './recording.js';
import { outcome } from './rules.js';
import { Run } from './run.js';
/** @import { Toy } from './toy.js' */
/** @import { Outcome, Result, Rival } from './types.js' */

const number = new Intl.NumberFormat('en', { maximumFractionDigits: 2 });

/** A win by what it is ranked by: stars, what the level measures (a counter, or the tick), the tick.
 * @type {(toy: Toy, outcome: Outcome, world?: Toy['world']) => Result} */
export function resultNow(toy, { stars, tick }, world = toy.world) {
  const { counter } = toy.level.goals.measure;
  return { stars, tick, value: counter === null ? tick : world.view('state.counter')[counter] };
}

/** By how much a win is ahead of another, and in words: by stars, then by what the level measures, then by time.
 * @type {(toy: Toy, mine: Result, theirs: Result) => { by: number, words: string }} */
export function ahead({ level: { goals: { measure } }, rate }, mine, theirs) {
  /** @type {(by: number) => string} */
  const seconds = (by) => `${(by / rate).toFixed(2)} s`;
  const apart = mine.value - theirs.value;
  /** @type {[by: number, words: (by: number) => string][]} */
  const ways = [
    [mine.stars - theirs.stars, (by) => `${by} star${by > 1 ? 's' : ''}`],
    [measure.is_most ? apart : -apart, measure.counter === null ? seconds : (by) => `${number.format(by)} (${measure.text})`],
    [theirs.tick - mine.tick, seconds],
  ];
  const [by, words] = ways.find(([each]) => each) ?? [0, seconds];
  return { by, words: words(Math.abs(by)) };
}

/** How the run of a rival ends, carried out as by hand. Throws a Refusal where it is not what it says, or does not win.
 * @type {(toy: Toy, rival: Rival, progress: (done: number) => void) => Promise<Result>} */
export async function resultOf(toy, { recording }, progress) {
  const world = toy.fresh();
  /** @type {{ isWon: boolean, result: Result }[]} */
  const found = [];
  const wrong = await verified(world, recording, progress, () => {
    const ended = found.length ? null : outcome(world);
    if (ended) found.push({ isWon: ended.isWon, result: resultNow(toy, ended, world) });
  });
  if (wrong) throw new Refusal(`No race: at ${(wrong.tick / toy.rate).toFixed(1)} s ${wrong.words || 'this browser comes to other bits'}.`);
  if (!found[0]?.isWon) throw new Refusal('No race: the run of this link does not win.');
  return found[0].result;
}

export class Race {
  #run;
  #picture;
  #previous;
  #closing = new AbortController();

  /** @param {Toy} toy @param {Rival} rival @param {Result} result */
  constructor(toy, { name, recording: { commands, hashes } }, result) {
    const world = toy.fresh(), { signal } = this.#closing;
    this.toy = toy;
    this.name = name;
    this.result = result;
    this.#run = new Run(world, commands.map((done) => ({ ...done })), hashes.length - 1);
    this.#picture = new Picture(toy.canvas, toy.level.scene, world);
    this.#previous = world.view('state.position').slice();
    for (const name of ['tick', 'jump']) toy.addEventListener(name, () => this.#follow(), { signal });
    toy.shade = (part, seconds) => this.#picture.shade(toy.camera, toy.theme, this.#previous, part, seconds);
  }

  // Beyond its end it stands as it ended.
  #follow() {
    const run = this.#run, tick = Math.min(this.toy.run.time, run.last);
    if (tick < run.time) run.seek(tick);
    this.#previous = run.world.view('state.position').slice();
    while (run.time < tick) run.step();
  }

  /** Who wins by how much, in a sentence.
   * @type {(mine: Outcome) => string} */
  said(mine) {
    const { name, toy, result } = this;
    if (!mine.isWon) return `You do not beat ${name}.`;
    const { by, words } = ahead(toy, resultNow(toy, mine), result);
    return by ? `You ${by > 0 ? 'beat' : 'lose to'} ${name} by ${words}.` : `You and ${name} are even.`;
  }

  // The shade is seen no more.
  close() {
    this.#closing.abort();
    this.toy.shade = null;
  }
}
