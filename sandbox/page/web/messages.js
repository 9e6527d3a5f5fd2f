// Messages: what a page says, by ranks: what each gives way to, where it stands and what ends it.
/** @import { Message, Rank } from './types.js' */

/** place: where it stands, unless it was asked for elsewhere; lasts: how long [s]; ends: what ends it: 'deed', something
 * was done since; 'jump', time went elsewhere; 'back', time went back to before it; 'tool', another tool was chosen.
 * @typedef {{ place: string, lasts?: number, ends: ('deed' | 'jump' | 'back' | 'tool')[] }} Manner */
/** The highest first.
 * @type {Record<Rank, Manner>} */
export const RANKS = {
  // Of a recording or a link: nothing else stands in its place.
  verdict: { place: 'verdict', ends: [] },
  // Nothing goes on until it begins again.
  fault: { place: 'state', ends: ['jump'] },
  refusal: { place: 'state', lasts: 8, ends: ['deed', 'jump'] },
  // What came of something that was asked for.
  done: { place: 'state', lasts: 8, ends: ['deed', 'jump'] },
  // Of something that was asked for, until it is done; nobody is told of it by ear.
  progress: { place: 'state', lasts: 8, ends: ['deed', 'jump'] },
  // Of rules several stand, as time may go back to before the last.
  rule: { place: 'state', ends: ['back'] },
  tip: { place: 'state', ends: ['deed', 'tool'] },
};
const ORDER = /** @type {Rank[]} */ (Object.keys(RANKS)), MOST = 200;

/** A moment of a run: its tick, the number of its last gesture and of the last that did something, and now [s].
 * @typedef {{ tick: number, gesture: number, deed: number, now: number }} Moment */

export class Messages {
  /** @type {(Message & { place: string, at: Moment })[]} */
  #said = [];

  /** place: where it was asked for, if not where its rank stands.
   * @type {(message: Message, at: Moment) => void} */
  say(message, at) {
    const { place = RANKS[message.rank].place, rank, text } = message;
    const left = this.#said.filter((each) => each.rank !== rank || (rank === 'rule' && each.text !== text));
    this.#said = [...left, { ...message, place, at }].slice(-MOST);
  }

  /** Another tool was chosen, or time went elsewhere.
   * @type {(cause: 'tool' | 'jump') => void} */
  end(cause) {
    this.#said = this.#said.filter(({ rank }) => !RANKS[rank].ends.includes(cause));
  }

  /** End what has an end by now.
   * @type {(moment: Moment) => void} */
  follow({ tick, deed, now }) {
    this.#said = this.#said.filter(({ rank, at }) => {
      const { lasts = Infinity, ends } = RANKS[rank];
      return now - at.now < lasts && !(ends.includes('deed') && deed > at.gesture)
        && !(ends.includes('back') && tick < at.tick);
    });
  }

  /** What stands at a place: the highest of what was said there.
   * @type {(place: string) => Message | null} */
  shown(place) {
    const [first] = this.#said.filter((each) => each.place === place)
      .sort((one, other) => ORDER.indexOf(one.rank) - ORDER.indexOf(other.rank) || other.at.tick - one.at.tick);
    return first ?? null;
  }
}
