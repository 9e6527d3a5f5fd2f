// Run: what was done to a world and when, so that time can go back; the commands of a run make it again, bit for bit.
import { Refusal } from './world.js';

// Ticks from one kept state to the next at first, and how many are kept before every second one is dropped.
const KEEP_EVERY = 60, KEPT = 120;

export class Run {
  // commands: [{ tick, gesture, record }] of a recording, with slots in place of names, in order; ticks: of it.
  constructor(world, commands = [], ticks = 0) {
    Object.assign(this, { world, commands, last: ticks, every: KEEP_EVERY, kept: [world.save()], next: 0,
      revision: 0 });
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

  // Carry out a command now, and forget what would have come later. Whether it could be.
  submit(record, gesture) {
    if (!this.world.command(record)) return false;
    if (this.isFollowing) this.takeOver();
    this.commands.push({ tick: this.time, gesture, record });
    this.next = this.commands.length;
    this.last = this.time;
    return true;
  }

  // Go on from here by hand.
  takeOver() {
    this.commands.length = this.next;
    this.last = this.time;
    this.kept = this.kept.filter((state) => state.time <= this.time);
    this.revision += 1;
  }

  // One tick, and the commands that follow at its end.
  step() {
    this.world.tick();
    this.last = Math.max(this.last, this.time);
    if (this.time % this.every === 0 && this.time > this.kept.at(-1).time) {
      this.kept.push(this.world.save());
      if (this.kept.length > KEPT) {
        this.every *= 2;
        this.kept = this.kept.filter((state) => state.time % this.every === 0);
      }
    }
    this.#follow();
  }

  // The commands of this tick that a recording has.
  #follow() {
    while (this.next < this.commands.length && this.commands[this.next].tick === this.time) {
      const { record } = this.commands[this.next];
      if (!this.world.command(record)) throw new Refusal('This page cannot do what was done here.');
      this.next += 1;
    }
  }

  // Go to a tick that was reached, with those of its commands that come before one of this place.
  seek(tick, place = Infinity) {
    const state = this.kept.findLast((each) => each.time <= tick);
    this.world.restore(state);
    this.next = this.commands.findIndex((each) => each.tick >= state.time);
    if (this.next < 0) this.next = this.commands.length;
    const dropped = this.commands.splice(place);
    this.#follow();
    while (this.time < tick) this.step();
    return dropped;
  }

  // Go back to before the last gesture. Whether there was one.
  undo() {
    if (!this.next) return false;
    const { gesture } = this.commands[this.next - 1],
      place = this.commands.findIndex((each) => each.gesture === gesture);
    const { tick } = this.commands[place];
    this.seek(tick, place);
    this.takeOver();
    return true;
  }
}
