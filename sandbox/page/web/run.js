// Run: what was done to a world and when, so that time can go back; the commands of a run make it again, bit for bit.
import { Refusal } from './commands.js';
import { TUNING } from './shared.js';
/** @import { Command, Done } from './types.js' */
/** @import { World } from './world.js' */

/** @typedef {Extract<Command, { type: 'release' | 'set_drive' | 'hold_key' }>} Ending */

// Ticks from one kept state to the next at first, and how many are kept before every second one is dropped.
const KEEP_EVERY = 60, KEPT = 120;

/** Whether what a command would end goes on: a hand holds something, a part is driven, or a key is held.
 * @type {(world: World, ending: Ending) => boolean} */
function isGoing(world, ending) {
  if (ending.type === 'hold_key') return world.view('state.key_down')[ending.key] !== 0;
  if (ending.type === 'release') return world.isHeld(ending.grab);
  return world.view('state.actuator_value')[ending.part] !== 0;
}
/** What an undo took back: commands from a place on, which led from a tick on to another; count, last: the commands that
 * are left after it.
 * @typedef {{ place: number, tick: number, taken: Done[], to: number, end: number, count: number, last: Done | undefined }} Undone */

export class Run {
  /** The newest last.
   * @type {Undone[]} */
  #undone = [];
  // Whether what goes on now was begun by what is told again, so that nobody is there to end it.
  #isTold = true;

  /** commands: of a recording in order, with names, or with slots where they were carried out; ticks: of it.
   * @param {World} world @param {Done[]} [commands] @param {number} [ticks] */
  constructor(world, commands = [], ticks = 0) {
    this.world = world;
    this.commands = commands;
    this.last = ticks;
    this.every = KEEP_EVERY;
    this.kept = [world.save()];
    // The command that comes next; how often what would come later was forgotten.
    this.next = 0;
    this.revision = 0;
    this.gesture = commands.reduce((most, each) => Math.max(most, each.gesture), 0);
    this.#follow();
  }

  get time() {
    return this.world.time;
  }

  // Whether a recording still goes on from here.
  get isFollowing() {
    return this.time < this.last;
  }

  newGesture() {
    return (this.gesture += 1);
  }

  /** Carry out a command now, and forget what would have come later. Throws a Refusal where it cannot be.
   * @type {(record: Command, gesture: number) => void} */
  command(record, gesture) {
    this.takeUp(gesture);
    this.world.command(record, this.world.givers.HAND);
    this.commands.push({ tick: this.time, gesture, record });
    this.next = this.commands.length;
    this.last = this.time;
  }

  /** The same; where it cannot be, say why. Whether it could be.
   * @type {(record: Command, gesture: number, say: (text: string, refusal: Refusal) => void) => boolean} */
  submit(record, gesture, say) {
    try {
      this.command(record, gesture);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      say(error.message, error);
      return false;
    }
    return true;
  }

  /** Go on from here by hand, with a gesture that ends what goes on.
   * @type {(gesture: number) => void} */
  takeUp(gesture) {
    if (this.isFollowing) this.takeOver();
    if (this.#isTold) this.#endAll(gesture);
  }

  /** Let go what hands hold and stop what is driven, which nobody does any more. gesture: null: each belongs to what
   * began it.
   * @type {(gesture?: number | null) => void} */
  #endAll(gesture = null) {
    this.#isTold = false;
    /** @type {Map<string, [Ending, number]>} */
    const going = new Map();
    for (const { record, gesture: begun } of this.commands) {
      if (!record) continue;
      if (record.type === 'grab') going.set(`hand ${record.grab}`, [{ type: 'release', grab: record.grab }, begun]);
      else if (record.type === 'hold_key') going.set(`key ${record.key}`, [{ ...record, down: false }, begun]);
      else if (record.type === 'set_drive') going.set(`part ${record.part}`, [{ ...record, value: 0 }, begun]);
    }
    for (const [ending, begun] of going.values()) {
      if (isGoing(this.world, ending)) this.submit(ending, gesture ?? begun, () => {});
    }
  }

  // Forget what would come later.
  takeOver() {
    this.commands.length = this.next;
    this.last = this.time;
    this.kept = this.kept.filter((state) => state.time <= this.time);
    this.revision += 1;
  }

  // One tick, and the commands that follow at its end.
  step() {
    if (this.#isTold && !this.isFollowing) this.#endAll();
    this.world.tick();
    this.last = Math.max(this.last, this.time);
    if (this.time % this.every === 0 && this.time > this.kept[this.kept.length - 1].time) {
      this.kept.push(this.world.save());
      if (this.kept.length > KEPT) {
        this.every *= 2;
        this.kept = this.kept.filter((state) => state.time % this.every === 0);
      }
    }
    this.#follow();
  }

  // The commands of this tick that a recording has; one that may not be ends it.
  #follow() {
    try {
      while (this.next < this.commands.length && this.commands[this.next].tick === this.time) {
        this.world.carryOut(this.commands[this.next]);
        this.next += 1;
      }
    } catch (error) {
      this.takeOver();
      throw error;
    }
  }

  /** Go to a tick that was reached, with those of its commands that come before one of this place.
   * @type {(tick: number, place?: number) => Done[]} */
  seek(tick, place = Infinity) {
    const state = this.kept.findLast((each) => each.time <= tick) ?? this.kept[0];
    this.world.restore(state);
    this.#isTold = true;
    this.next = this.commands.findIndex((each) => each.tick >= state.time);
    if (this.next < 0) this.next = this.commands.length;
    const dropped = this.commands.splice(place);
    this.#follow();
    while (this.time < tick) this.step();
    return dropped;
  }

  /** The tick of the last state that is kept until a tick.
   * @type {(tick: number) => number} */
  keptBefore(tick) {
    return (this.kept.findLast((each) => each.time <= tick) ?? this.kept[0]).time;
  }

  /** Go back to the beginning; keepsTuning: with what was set of materials, bodies, air and solver until now.
   * @type {(keepsTuning: boolean) => void} */
  beginAgain(keepsTuning) {
    /** @type {Map<string, Command>} */
    const tuned = new Map(), gesture = this.newGesture();
    for (const { record, tick } of keepsTuning ? this.commands : []) {
      if (!record || tick > this.time || !TUNING.KINDS.includes(record.type)) continue;
      const kept = /** @type {Command} */ ({ ...record, duration: 0 }), set = Object.entries(kept).filter(([, value]) => value !== null);
      const key = set.map(([name, value]) => (name === 'type' || TUNING.SUBJECTS.includes(name) ? `${name} ${value}` : name)).join();
      tuned.delete(key);
      tuned.set(key, kept);
    }
    this.seek(0, 0);
    this.takeOver();
    // What was set of a thing that joined later cannot be set yet.
    for (const record of tuned.values()) this.submit(record, gesture, () => {});
  }

  // Go back to before the last gesture. Whether there was one.
  undo() {
    if (!this.next) return false;
    const { gesture } = this.commands[this.next - 1],
      place = this.commands.findIndex((each) => each.gesture === gesture);
    const { tick } = this.commands[place], { time: to, last: end } = this;
    const taken = this.seek(tick, place);
    this.takeOver();
    this.#endAll();
    const { length: count, [count - 1]: last } = this.commands;
    this.#undone.push({ place, tick, taken, to, end, count, last });
    return true;
  }

  // Do again what was undone last, and go to where the run was then, unless something was done since. Whether there was it.
  redo() {
    const undone = this.#undone.pop(), { length, [length - 1]: last } = this.commands;
    if (!undone || undone.count !== length || undone.last !== last) {
      this.#undone = [];
      return false;
    }
    this.seek(undone.tick, undone.place);
    this.takeOver();
    this.commands.push(...undone.taken);
    this.last = undone.end;
    this.seek(undone.to);
    return true;
  }
}
