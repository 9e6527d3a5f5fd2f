// Keys: buttons for the keys that drive something or that a rule asks for, below both thumbs.
import { controlsOf, Gamepads } from './gamepad.js';
import { element } from './panel.js';
/** @import { Drives } from './drives.js' */

/** @type {Record<string, string | undefined>} */
const ARROWS = { left: '←', right: '→', up: '↑', down: '↓' };

/** Those for the left thumb: the first of two; of more, those that lead sideways.
 * @type {(names: string[], controls: Map<string, string>) => string[]} */
function leftOf(names, controls) {
  const sideways = names.filter((name) => ['left', 'right'].includes(controls.get(name) ?? ''));
  return names.length > 2 && sideways.length && sideways.length < names.length ? sideways : names.slice(0, names.length / 2);
}

export class Keys {
  /** @type {Map<string, HTMLButtonElement>} */
  #buttons = new Map();
  // Those that have buttons.
  #names = '\n';
  /** @type {Map<string, string>} */
  controls = new Map();

  /** @param {Drives} drives @param {HTMLElement} left @param {HTMLElement} right */
  constructor(drives, left, right) {
    this.drives = drives;
    this.sides = [left, right];
    drives.told = (name, isHeld) => this.#buttons.get(name)?.setAttribute('aria-pressed', String(isHeld));
    // Who touches has large ones from then on.
    const enlarge = () => this.sides.forEach((side) => side.classList.add('large'));
    if (matchMedia('(hover: none)').matches) enlarge();
    addEventListener('keydown', (event) => { if (drives.has(event)) this.#name(false); });
    addEventListener('pointerdown', ({ pointerType }) => { if (pointerType === 'touch') enlarge(); }, true);
    this.gamepads = new Gamepads(drives);
    this.follow();
  }

  // Have a button for each key that there is by now: what joins brings keys, and undo takes them away.
  follow() {
    const names = Object.keys(this.drives.keys), [left, right] = this.sides;
    if (this.#names === names.join()) return;
    this.#names = names.join();
    this.controls = controlsOf(names);
    this.#buttons = new Map(names.map((name) => [name, this.#buttonOf(name)]));
    const first = leftOf(names, this.controls), buttons = [...this.#buttons];
    left.replaceChildren(...buttons.filter(([name]) => first.includes(name)).map(([, button]) => button));
    right.replaceChildren(...buttons.filter(([name]) => !first.includes(name)).map(([, button]) => button));
    this.#name(false);
    this.gamepads.follow(() => this.#name(true));
  }

  /** Caps say what presses them on what was used last.
   * @type {(isOnPad: boolean) => void} */
  #name(isOnPad) {
    this.sides.forEach((side) => side.classList.toggle('on-pad', isOnPad));
    for (const [name, button] of this.#buttons) {
      const said = isOnPad ? this.controls.get(name) ?? name : name;
      button.textContent = ARROWS[said] ?? said.toUpperCase();
    }
  }

  /** @type {(name: string) => HTMLButtonElement} */
  #buttonOf(name) {
    const { drives } = this, button = element('button', { type: 'button', className: 'key' });
    button.setAttribute('aria-label', `Key ${name}`);
    button.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      this.#name(false);
      button.setPointerCapture(event.pointerId);
      drives.press(name);
    });
    for (const end of ['lostpointercapture', 'blur', 'keyup']) button.addEventListener(end, () => drives.release(name));
    button.addEventListener('keydown', (event) => {
      if ([' ', 'Enter'].includes(event.key)) drives.press(name);
    });
    return button;
  }
}
