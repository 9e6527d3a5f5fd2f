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

  /** @param {Drives} drives @param {HTMLElement} left @param {HTMLElement} right */
  constructor(drives, left, right) {
    this.drives = drives;
    this.sides = [left, right];
    const names = Object.keys(drives.keys);
    this.controls = controlsOf(names);
    for (const name of names) this.#buttons.set(name, this.#buttonOf(name));
    const first = leftOf(names, this.controls);
    for (const [name, button] of this.#buttons) (first.includes(name) ? left : right).append(button);
    drives.told = (name, isHeld) => this.#buttons.get(name)?.setAttribute('aria-pressed', String(isHeld));
    // Who touches has large ones from then on.
    const enlarge = () => this.sides.forEach((side) => side.classList.add('large'));
    if (matchMedia('(hover: none)').matches) enlarge();
    addEventListener('keydown', (event) => { if (drives.has(event)) this.#name(false); });
    addEventListener('pointerdown', ({ pointerType }) => { if (pointerType === 'touch') enlarge(); }, true);
    this.#name(false);
    this.gamepads = new Gamepads(drives, () => this.#name(true));
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
