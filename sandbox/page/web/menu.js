// Menu: what can be done to a thing: it softer or firmer, lighter or heavier, freed of what it is stuck in, its particle
// fixed or let go, or all of it gone.
import { thingOf } from './cursor.js';
import { element } from './panel.js';
/** @import { Refusal } from './commands.js' */
/** @import { Toy } from './toy.js' */
/** @import { Asked } from './types.js' */

/** @type {[word: string, factor: number][]} */
const WEIGHTS = [['half as heavy', 0.5], ['twice as heavy', 2]];

export class Menu {
  /** feel: shows how the thing of a particle feels. What it says of things: by words of firmness Cs and Cd of materials, the level's own bodies, and those that joined it
   * or were cut; and whether they touch.
   * @param {HTMLElement} box @param {Toy} toy @param {(particle: number) => void} feel */
  constructor(box, toy, feel) {
    const { touches, made: { words, sags, firmness } } = toy.level.about.adding;
    this.box = box;
    this.toy = toy;
    this.feel = feel;
    this.words = words;
    this.sags = sags;
    this.firmness = firmness;
    this.touches = touches;
    addEventListener('pointerdown', ({ target }) => {
      if (target instanceof Node && !box.contains(target)) this.close();
    }, true);
    box.addEventListener('keydown', (event) => this.#key(event));
    // What begins elsewhere, by whatever means, ends it.
    for (const name of ['outcome', 'jump']) toy.addEventListener(name, () => this.close());
    document.addEventListener('focusin', ({ target }) => {
      if (target instanceof Node && !box.contains(target)) this.close();
    });
  }

  // Who was in it is at the picture again.
  close() {
    const { box, toy } = this;
    if (box.contains(document.activeElement)) toy.canvas.focus({ preventScroll: true });
    box.hidden = true;
  }

  /** Arrow keys go from row to row; what leads out of it closes it.
   * @type {(event: KeyboardEvent) => void} */
  #key(event) {
    const rows = [...this.box.querySelectorAll('button')], last = rows.length - 1;
    const now = rows.findIndex((row) => row === document.activeElement);
    const to = { ArrowDown: now < last ? now + 1 : 0, ArrowUp: now > 0 ? now - 1 : last, Home: 0, End: last }[event.key];
    if (to !== undefined) rows[to].focus({ preventScroll: true });
    else if (['Escape', 'Tab'].includes(event.key)) this.close();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** @type {(asked: Asked) => void} */
  open({ particle, x, y }) {
    const { box, toy } = this, { world } = toy;
    /** @type {(text: string, act: () => void) => HTMLButtonElement} */
    const button = (text, act) => {
      const made = element('button', { type: 'button', textContent: text, tabIndex: -1 });
      made.setAttribute('role', 'menuitem');
      made.addEventListener('click', () => {
        this.close();
        act();
        toy.refresh();
      });
      return made;
    };
    const isFixed = world.view('state.inverse_mass')[particle] === 0;
    const spring = this.#springAt(particle), form = spring < 0 ? -1 : world.formOf(spring);
    const isWhole = world.names.form[form] === toy.level.about.names.form[form];
    const asked = isWhole ? { ...this.sags, ...this.firmness[form] } : this.sags;
    const words = form >= 0 ? Object.entries(asked).map(([word, each]) => button(word, () => this.#firm(form, word, each)))
      : Object.entries(this.words).map(([word, [stiffness, damping]]) => button(word, () =>
        this.#soften(world.view('state.material')[spring], word, stiffness, damping)));
    const softness = spring < 0 ? [] : words;
    const weights = WEIGHTS.map(([word, factor]) => button(word, () =>
      this.#change(particle, word, { type: 'scale_mass', particle, factor })));
    // What touches nothing is stuck in nothing.
    const free = this.touches ? [button('free it', () => this.#change(particle, 'free', { type: 'free', particle }))] : [];
    const feel = spring < 0 ? [] : [button('how it feels', () => this.feel(particle))];
    box.replaceChildren(...softness, ...weights, ...feel, ...free, button(isFixed ? 'let go' : 'fix here', () => this.#submit(
      { type: isFixed ? 'unpin' : 'pin', particle })), button('erase', () => toy.hands.remove(particle)));
    box.setAttribute('aria-label', thingOf(world.names.particle[particle]));
    box.hidden = false;
    box.style.left = `${Math.max(8, Math.min(x, innerWidth - box.offsetWidth - 8))}px`;
    box.style.top = `${Math.max(8, Math.min(y, innerHeight - box.offsetHeight - 8))}px`;
    box.querySelector('button')?.focus({ preventScroll: true });
  }

  /** A spring of a material at a particle; below 0: it has none.
   * @type {(particle: number) => number} */
  #springAt(particle) {
    const { world } = this.toy, a = world.view('state.particle_a'), b = world.view('state.particle_b');
    const material = world.view('state.material'), active = world.view('state.spring_active');
    return material.findIndex((own, k) => own >= 0 && active[k] !== 0 && (a[k] === particle || b[k] === particle));
  }

  /** Make a body as soft as a word says, or as near to it as it can be.
   * @type {(body: number, word: string, asked: { sag: number } | { hz: number, ratio: number }) => void} */
  #firm(body, word, asked) {
    const { run, level: { ramp_ticks: duration }, world } = this.toy, gesture = run.newGesture();
    const name = world.names.form[body], says = () => this.toy.say(`${name} is ${word} now.`, 'done');
    /** @type {(text: string, refusal: Refusal) => void} */
    const refused = (text, { nearest }) => {
      if (nearest === undefined) this.toy.say(text);
      else if (run.submit({ type: 'set_firmness', body, sag: nearest, duration }, gesture, (why) => this.toy.say(why))) says();
    };
    if (run.submit({ type: 'set_firmness', body, ...asked, duration }, gesture, refused)) says();
  }

  /** Make the body of a particle what a word says.
   * @type {(particle: number, word: string, record: import('./types.js').Command) => void} */
  #change(particle, word, record) {
    const name = thingOf(this.toy.world.names.particle[particle]);
    if (this.#submit(record)) this.toy.say(`${name} is ${word} now.`, 'done');
  }

  /** @type {(material: number, word: string, stiffness: number, damping: number) => void} */
  #soften(material, word, stiffness, damping) {
    const { ramp_ticks: duration } = this.toy.level;
    if (this.#submit({ type: 'set_coefficients', material, stiffness, damping, duration })) this.toy.say(`Everything of ${this.toy.world.names.material[material]} is ${word} now.`, 'done');
  }

  /** Do it, or say why it cannot be done. Whether it was.
   * @type {(record: import('./types.js').Command) => boolean} */
  #submit(record) {
    const { run } = this.toy;
    return run.submit(record, run.newGesture(), (text) => this.toy.say(text));
  }
}
