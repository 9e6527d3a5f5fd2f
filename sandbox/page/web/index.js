// Index: the list of levels: the toy at its top, which plays by itself, and previews of levels.
import { FIT } from './camera.js';
import { load } from './files.js';
import { Toy } from './toy.js';
/** @import { Point } from './types.js' */

// How long a toy plays that nobody touches before it begins again [s].
const LOOP = 20;
// How long a preview has played when it is as its picture shows it [s]: SECONDS of picture_cache.py.
const AHEAD = 0.8;
// How long a pointer, or a list that was moved, rests on a level before that plays [ms].
const REST = 150, SCROLL_REST = 400;
// What goes slower stands still [m/s]; how often it is stirred, and for how long [s]; how far, as a part of the view.
const SLOW = 0.3, STIR_EVERY = 2, STIRRED = 1.2, PULL = 0.16;
// So many frames are timed together; what is longer than a frame should be [ms]; the fewest pixels to one of the page.
const WINDOW = 20, LATE = 20, COARSEST = 1;
const calm = matchMedia('(prefers-reduced-motion: reduce)'), byFinger = matchMedia('(hover: none)');
const PAUSE = 'M8 5v14M16 5v14', PLAY = 'M8 5l11 7-11 7z';

/** @template {Element} E @param {Element} within @param {string} selector @returns {E} */
function part(within, selector) {
  const found = within.querySelector(selector);
  if (!found) throw new Error(`there is no ${selector}`);
  return /** @type {E} */ (found);
}

/** A toy of a file on a canvas, which shows a box [m] given as numbers with commas.
 * @type {(canvas: HTMLCanvasElement, given: DOMStringMap, shares?: Point) => Promise<() => Toy>} */
async function prepared(canvas, { toy: address = '', view = '' }, [wide, tall] = [1, 1]) {
  const [level, fresh] = await load(address), [left, low, right, high] = view.split(',').map(Number);
  const x = (left + right) / 2, y = (low + high) / 2, dx = (wide * (right - left)) / 2, dy = (tall * (high - low)) / 2;
  level.scene.view = [x - dx, y - dy, x + dx, y + dy];
  return () => {
    const toy = new Toy(canvas, level, fresh);
    toy.addEventListener('draw', () => canvas.classList.add('drawn'), { once: true });
    keepSmooth(toy);
    return toy;
  };
}

/** Draw fewer pixels where a machine cannot draw all of them in time.
 * @type {(toy: Toy) => void} */
function keepSmooth(toy) {
  let began = 0, drawn = 0;
  toy.addEventListener('draw', () => {
    const now = performance.now();
    if (drawn++ % WINDOW) return;
    if (drawn > 1 && now - began > WINDOW * LATE) toy.picture.sharpest = Math.max(toy.picture.sharpest - 0.5, COARSEST);
    began = now;
  });
}

// Lets something happen in a toy: holds a key now and then, or pulls at what stands still.
class Stirring {
  /** @type {number | null} */
  #hand = null;
  isOver = false;

  /** @param {Toy} toy */
  constructor(toy) {
    this.toy = toy;
    const names = Object.keys(toy.drives.keys);
    this.key = names.includes('d') ? 'd' : names[0];
    toy.addEventListener('tick', () => this.#tick());
    toy.addEventListener('jump', () => { this.#hand = null; });
  }

  #tick() {
    const { run, rate } = this.toy, tick = run.time % Math.round(STIR_EVERY * rate);
    if (tick === Math.round(STIRRED * rate)) this.end();
    else if (tick === 1 && !this.isOver) this.#begin();
  }

  #begin() {
    const { toy } = this, [left, low, right, high] = toy.level.scene.view;
    if (this.key !== undefined) {
      toy.drives.press(this.key);
      return;
    }
    if (toy.world.view('state.velocity').some((speed) => Math.abs(speed) > SLOW)) return;
    const position = toy.world.view('state.position');
    const middle = [(left + right) / 2, (low + high) / 2], way = PULL * (high - low);
    /** @type {(k: number) => number} */
    const away = (k) => Math.hypot(position[2 * k] - middle[0], position[2 * k + 1] - middle[1]);
    const free = toy.world.particles.filter((k) => toy.world.canMove(k)).sort((a, b) => away(a) - away(b));
    if (!free.length) return;
    const [x, y] = position.subarray(2 * free[0]);
    this.#hand = toy.hands.hold(free[0], [x + way / 2, y + way], Infinity);
  }

  end() {
    if (this.key !== undefined) this.toy.drives.release(this.key);
    if (this.#hand !== null) this.toy.hands.release(this.#hand);
    this.#hand = null;
  }
}

/** The toy at the top. A finger or the wheel where nothing is to be taken moves the page, not the view.
 * @type {(box: HTMLElement) => Promise<Toy>} */
async function beginHero(box) {
  /** @type {HTMLCanvasElement} */
  const canvas = part(box, 'canvas');
  /** @type {HTMLButtonElement} */
  const button = part(box, 'button');
  const toy = (await prepared(canvas, box.dataset))(), stirring = new Stirring(toy);
  let isTaken = false, touched = 0;
  canvas.style.touchAction = 'pan-y pinch-zoom';
  box.addEventListener('pointerdown', (event) => {
    if (event.target !== canvas) return;
    isTaken = toy.hands.reached(event) !== null;
    if (!isTaken) {
      event.stopPropagation();
      return;
    }
    stirring.isOver = true;
    stirring.end();
    touched = toy.run.time;
    toy.play();
  }, true);
  canvas.addEventListener('touchstart', (event) => {
    if (isTaken) event.preventDefault();
  }, { passive: false });
  box.addEventListener('wheel', (event) => event.stopPropagation(), true);
  toy.addEventListener('tick', () => {
    if (toy.hands.isBusy) touched = toy.run.time;
    if (toy.run.time - touched < LOOP * toy.rate) return;
    touched = 0;
    toy.restart();
  });
  const show = () => {
    button.setAttribute('aria-label', toy.isPaused ? 'Play' : 'Pause');
    part(button, 'path').setAttribute('d', toy.isPaused ? PLAY : PAUSE);
  };
  toy.addEventListener('pause', show);
  button.addEventListener('click', () => toy.toggle());
  calm.addEventListener('change', () => (calm.matches ? toy.pause() : toy.play()));
  if (calm.matches) toy.pause();
  show();
  button.hidden = false;
  return toy;
}

// The one preview that plays in the list.
class Previews {
  /** @type {{ link: HTMLElement, canvas: HTMLCanvasElement, toy: Toy | null } | null} */
  shown = null;
  #timer = 0;

  /** @param {HTMLElement[]} links */
  constructor(links) {
    for (const link of links) {
      link.addEventListener('pointerenter', ({ pointerType }) => {
        if (pointerType === 'mouse') this.#soon(link, REST);
      });
      link.addEventListener('pointerleave', ({ pointerType }) => {
        if (pointerType === 'mouse') this.#soon(null, 0);
      });
      link.addEventListener('focus', () => { if (link.matches(':focus-visible')) this.#soon(link, REST); });
      link.addEventListener('blur', () => this.#soon(null, 0));
    }
    addEventListener('scroll', () => this.#follow(links), { passive: true });
    calm.addEventListener('change', () => this.#end());
  }

  /** By touch the level plays that is in the middle of the screen, once the list rests.
   * @type {(links: HTMLElement[]) => void} */
  #follow(links) {
    if (!byFinger.matches || 'connection' in navigator && Object(navigator.connection).saveData) return;
    const middle = innerHeight / 2, found = links.find((link) => {
      const { top, bottom } = link.getBoundingClientRect();
      return top <= middle && bottom >= middle;
    });
    this.#soon(found ?? null, SCROLL_REST);
  }

  /** @type {(link: HTMLElement | null, after: number) => void} */
  #soon(link, after) {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => (link ? this.#begin(link) : this.#end()), after);
  }

  #end() {
    this.shown?.toy?.close();
    this.shown?.canvas.remove();
    this.shown = null;
  }

  /** @type {(link: HTMLElement) => Promise<void>} */
  async #begin(link) {
    if (this.shown?.link === link || calm.matches) return;
    this.#end();
    const canvas = document.createElement('canvas');
    canvas.tabIndex = -1;
    canvas.setAttribute('aria-hidden', 'true');
    /** @type {{ link: HTMLElement, canvas: HTMLCanvasElement, toy: Toy | null }} */
    const own = { link, canvas, toy: null };
    this.shown = own;
    // A level whose file cannot be had has its picture.
    const made = await prepared(canvas, link.dataset, FIT).catch(() => null);
    if (made === null || this.shown !== own) return;
    link.append(canvas);
    const toy = own.toy = made();
    new Stirring(toy);
    for (let k = Math.round(AHEAD * toy.rate); k > 0; k--) toy.tick();
  }
}

// Begin: what the page of a list of levels does.
export async function list() {
  const links = [...document.querySelectorAll('.cards a')].filter((each) => each instanceof HTMLElement);
  const previews = new Previews(links);
  // Where the toy cannot play there is its picture.
  const toy = await beginHero(part(document.body, '#hero'));
  globalThis.page = { toy, previews };
}
