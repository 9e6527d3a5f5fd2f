// Cursor: keys in place of a pointer. It goes from thing to thing, or where arrows take it, and uses the tool there.
/** @import { Camera } from './camera.js' */
/** @import { Run } from './run.js' */
/** @import { Point, Pressed, Theme } from './types.js' */

// How far an arrow key moves it, and with Shift [parts of the picture's height].
const STEP = 0.02, LEAP = 0.08;
// Its number among pointers.
export const CURSOR_POINTER = -1;
/** @type {Record<string, Point>} */
const WAYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** What a key is called here: letters as they are without CapsLock, with Shift+ before them where that is down.
 * @type {(event: Pick<KeyboardEvent, 'key' | 'shiftKey'>) => string} */
export const typed = ({ key, shiftKey }) =>
  `${shiftKey && (key.length > 1 || key.toLowerCase() !== key.toUpperCase()) ? 'Shift+' : ''}${key.length > 1 ? key : key.toLowerCase()}`;

/** The thing that a particle is of, by its name: 'rope' of 'rope.39'.
 * @type {(name: string) => string} */
export const thingOf = (name) => name.replace(/\.\w+$/, '');

/** What it does to the picture: a pointer comes down, moves and is lifted, whether the tool goes on; the menu of a
 * particle at a place [pixels]; and lets go of everything.
 * @typedef {{ press: (at: Pressed) => boolean, move: (at: Pressed) => void, lift: (at: Pressed) => void,
 *   menu: (asked: { particle: number, x: number, y: number }) => void, releaseAll: () => void }} Acts */

export class Cursor {
  /** The particle that it goes along with; null: it stays where arrows took it.
   * @type {number | null} */
  marked = null;
  /** @type {Point | null} */
  #place = null;
  #isPressed = false;

  /** speak: tells a person who listens where it is.
   * @param {Run} run @param {Camera} camera @param {Acts} acts @param {(text: string) => void} speak */
  constructor(run, camera, acts, speak) {
    this.run = run;
    this.camera = camera;
    this.acts = acts;
    this.speak = speak;
  }

  /** Where it is [m]; null: it is not there.
   * @type {Point | null} */
  get place() {
    const { world } = this.run, { marked } = this;
    if (marked !== null && !world.isShown(marked)) this.marked = null;
    else if (marked !== null && !this.#isPressed) {
      const [x, y] = world.view('state.position').subarray(2 * marked);
      this.#place = [x, y];
    }
    return this.#place;
  }

  forget() {
    this.marked = this.#place = null;
    this.#isPressed = false;
  }

  // It holds nothing any more, as time has jumped.
  lift() {
    this.#isPressed = false;
  }

  /** Whether a key was of use.
   * @type {(event: KeyboardEvent) => boolean} */
  key(event) {
    const name = typed(event), way = Object.hasOwn(WAYS, event.key) && WAYS[event.key];
    if (way) this.#go(way, event.shiftKey ? LEAP : STEP);
    else if (name === 'n' || name === 'Shift+n') this.#visitThing(name === 'n' ? 1 : -1);
    else if (['PageDown', 'PageUp'].includes(name) && this.place) this.#visitParticle(name === 'PageDown' ? 1 : -1);
    else if (['q', 'ContextMenu', 'Shift+F10'].includes(name)) this.#askMenu();
    else if (name === 'Enter' && this.place) this.#press();
    else if (name === 'Escape') {
      this.forget();
      this.acts.releaseAll();
    } else return false;
    return true;
  }

  /** As a pointer would have it.
   * @type {(place: Point) => Pressed} */
  #at(place) {
    const [offsetX, offsetY] = this.camera.toPixels(...place), particle = this.#isPressed ? null : this.marked;
    return { pointerId: CURSOR_POINTER, pointerType: 'mouse', type: 'pointerup', button: 0, buttons: 1, altKey: false,
      timeStamp: performance.now(), offsetX, offsetY, particle };
  }

  #press() {
    const { place } = this;
    if (!place) return;
    if (this.#isPressed) {
      this.acts.lift(this.#at(place));
      this.#isPressed = false;
    } else this.#isPressed = this.acts.press(this.#at(place));
  }

  /** @type {(way: Point, step: number) => void} */
  #go([dx, dy], step) {
    const { camera } = this, far = (step * camera.height) / camera.zoom;
    const [x, y] = this.place ?? camera.toWorld(camera.width / 2, camera.height / 2);
    this.marked = null;
    this.#move([x + dx * far, y + dy * far]);
  }

  /** @type {(place: Point) => void} */
  #move(place) {
    this.#place = place;
    if (this.#isPressed) this.acts.move(this.#at(place));
  }

  /** Slots of particles that people see, by their things, in their order.
   * @type {() => number[][]} */
  #things() {
    const { world } = this.run, owner = world.view('state.owner');
    /** @type {Map<number, number[]>} */
    const things = new Map();
    for (const slot of world.particles.filter((each) => world.isShown(each))) {
      const own = things.get(owner[slot]);
      if (own) own.push(slot);
      else things.set(owner[slot], [slot]);
    }
    return [...things.values()];
  }

  /** Distance of a particle from a place [m].
   * @type {(slot: number, place: Point) => number} */
  #away(slot, [x, y]) {
    const position = this.run.world.view('state.position');
    return Math.hypot(position[2 * slot] - x, position[2 * slot + 1] - y);
  }

  /** @type {(slots: number[], place: Point) => number} */
  #nearest(slots, place) {
    return slots.reduce((best, slot) => (this.#away(slot, place) < this.#away(best, place) ? slot : best));
  }

  /** The particle that it is at, or nearest to; null: it is not there.
   * @type {(things: number[][]) => number | null} */
  #here(things) {
    const { place } = this;
    return this.marked ?? (place && things.length ? this.#nearest(things.flat(), place) : null);
  }

  /** Go into the next thing, or the one before, where its middle is.
   * @type {(by: number) => void} */
  #visitThing(by) {
    const things = this.#things(), here = this.#here(things);
    if (!things.length) {
      this.speak('There is nothing here.');
      return;
    }
    // Without a cursor the first one comes, or the last one.
    const now = here === null ? Math.min(-by, 0) : things.findIndex((own) => own.includes(here));
    const next = (now + by + things.length) % things.length, own = things[next];
    const position = this.run.world.view('state.position');
    const middle = /** @type {Point} */ ([0, 1].map((u) =>
      own.reduce((sum, slot) => sum + position[2 * slot + u], 0) / own.length));
    const slot = this.#nearest(own, middle);
    this.#mark(slot);
    this.speak(`${thingOf(this.#name(slot))}, ${next + 1} of ${things.length}, ${this.#where(slot)}`);
  }

  /** @type {(by: number) => void} */
  #visitParticle(by) {
    const things = this.#things(), here = this.#here(things), own = things.find((each) => here !== null && each.includes(here));
    if (!own || here === null) return;
    const slot = own[(own.indexOf(here) + by + own.length) % own.length];
    this.#mark(slot);
    this.speak(`${this.#name(slot)}, ${this.#where(slot)}`);
  }

  /** @type {(slot: number) => void} */
  #mark(slot) {
    const [x, y] = this.run.world.view('state.position').subarray(2 * slot);
    this.marked = slot;
    this.#move([x, y]);
  }

  #askMenu() {
    const { place, run: { world } } = this;
    if (this.marked === null || !place) {
      this.speak('There is no thing at the cursor. N takes it to the next one.');
      return;
    }
    const [x, y] = this.camera.toPixels(...place);
    if (world.isShown(this.marked)) this.acts.menu({ particle: this.marked, x, y });
  }

  /** @type {(slot: number) => string} */
  #name(slot) {
    return this.run.world.names.particle[slot];
  }

  /** Where a particle is in the picture, in words, and whether it is pinned.
   * @type {(slot: number) => string} */
  #where(slot) {
    const { camera, run: { world } } = this, [x, y] = camera.toPixels(...this.place ?? [0, 0]);
    const across = ['left', '', 'right'][Math.min(Math.max(Math.floor((3 * x) / camera.width), 0), 2)];
    const up = ['top', '', 'bottom'][Math.min(Math.max(Math.floor((3 * y) / camera.height), 0), 2)];
    const isIn = x >= 0 && y >= 0 && x <= camera.width && y <= camera.height;
    const fixed = world.view('state.inverse_mass')[slot] === 0 ? ', pinned' : '';
    return `${[up, across].filter(Boolean).join(' ') || 'middle'}${isIn ? '' : ', out of the picture'}${fixed}`;
  }

  /** @type {(context: CanvasRenderingContext2D, at: Float64Array, theme: Theme) => void} */
  draw(context, at, theme) {
    const { place, marked } = this;
    if (!place) return;
    const isAlong = marked !== null && !this.#isPressed;
    const [x, y] = isAlong ? at.subarray(2 * marked) : this.camera.toPixels(...place);
    context.strokeStyle = theme.accent;
    context.lineWidth = 2;
    context.beginPath();
    context.arc(x, y, 10, 0, 7);
    for (const [dx, dy] of Object.values(WAYS)) {
      context.moveTo(x + 6 * dx, y + 6 * dy);
      context.lineTo(x + 15 * dx, y + 15 * dy);
    }
    context.stroke();
  }
}
