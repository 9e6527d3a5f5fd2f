// Menu: what can be done to a thing: its material softer or firmer, and its particle fixed or let go.
import { thingOf } from './cursor.js';
import { element } from './panel.js';
/** @import { Toy } from './toy.js' */
/** @import { Asked, Point } from './types.js' */

export class Menu {
  /** @param {HTMLElement} box @param {Toy} toy @param {Record<string, Point>} words Cs and Cd by words of firmness */
  constructor(box, toy, words) {
    this.box = box;
    this.toy = toy;
    this.words = words;
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
    const { box, toy } = this, { world } = toy, material = this.#materialOf(particle);
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
    const softness = material === null ? [] : Object.entries(this.words).map(([word, [stiffness, damping]]) =>
      button(word, () => this.#soften(material, word, stiffness, damping)));
    box.replaceChildren(...softness, button(isFixed ? 'let go' : 'fix here', () => this.#submit(
      { type: isFixed ? 'unpin' : 'pin', particle })), button('erase', () => toy.hands.remove(particle)));
    box.setAttribute('aria-label', thingOf(world.names.particle[particle]));
    box.hidden = false;
    box.style.left = `${Math.max(8, Math.min(x, innerWidth - box.offsetWidth - 8))}px`;
    box.style.top = `${Math.max(8, Math.min(y, innerHeight - box.offsetHeight - 8))}px`;
    box.querySelector('button')?.focus({ preventScroll: true });
  }

  /** The material of the springs at a particle; null: it has none.
   * @type {(particle: number) => number | null} */
  #materialOf(particle) {
    const { world } = this.toy, a = world.view('state.particle_a'), b = world.view('state.particle_b');
    const material = world.view('state.material'), active = world.view('state.spring_active');
    const spring = material.findIndex((own, k) => own >= 0 && active[k] !== 0 && (a[k] === particle || b[k] === particle));
    return spring < 0 ? null : material[spring];
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
