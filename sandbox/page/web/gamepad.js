// Gamepad: sticks and buttons press the keys of a level, as in the window.
import { GAMEPAD } from './shared.js';
/** @import { Drives } from './drives.js' */

const { BUTTONS, PRESSES, LETS_GO } = GAMEPAD;
// Buttons of the standard mapping: the four at the right in their order, and the cross.
const CROSS = /** @type {[number, string][]} */ ([[12, 'up'], [13, 'down'], [14, 'left'], [15, 'right']]);
const STICK = [['left', 'right'], ['up', 'down']];

/** What presses each key of a level: left, right, up, down, or a button; keys beyond those have none.
 * @type {(keys: string[]) => Map<string, string>} */
export function controlsOf(keys) {
  let left = [...keys].sort();
  /** @type {Map<string, string>} */
  const found = new Map();
  for (const [pairs, ways] of [[GAMEPAD.ACROSS, ['left', 'right']], [GAMEPAD.UPWARDS, ['down', 'up']]]) {
    const pair = /** @type {string[][]} */ (pairs).find((each) => each.every((key) => left.includes(key))) ?? [];
    pair.forEach((key, k) => found.set(key, /** @type {string[]} */ (ways)[k]));
    left = left.filter((key) => !pair.includes(key));
  }
  left.slice(0, BUTTONS.length).forEach((key, k) => found.set(key, BUTTONS[k]));
  return found;
}

export class Gamepads {
  /** Controls that are down.
   * @type {Set<string>} */
  #down = new Set();
  /** Keys that they hold, by control.
   * @type {Map<string, string>} */
  #held = new Map();
  #isHeard = false;

  /** @type {Map<string, string>} */
  keys = new Map();
  used = () => {};

  /** @param {Drives} drives */
  constructor(drives) {
    this.drives = drives;
    addEventListener('gamepadconnected', () => this.#hear());
    this.#hear();
  }

  /** Press the keys that there are now. used: called when one was pressed.
   * @type {(used?: () => void) => void} */
  follow(used = () => {}) {
    this.used = used;
    this.keys = new Map([...controlsOf(Object.keys(this.drives.keys))].map(([key, control]) => [control, key]));
  }

  // Look at gamepads in every frame, as long as there are any.
  #hear() {
    if (this.#isHeard) return;
    this.#isHeard = true;
    const look = () => {
      const pads = (navigator.getGamepads?.() ?? []).filter((pad) => pad?.connected);
      this.#take(new Set(pads.flatMap((pad) => this.#pressedOn(/** @type {Gamepad} */ (pad)))));
      this.#isHeard = pads.length > 0;
      if (this.#isHeard) requestAnimationFrame(look);
    };
    look();
  }

  /** @type {(pad: Gamepad) => string[]} */
  #pressedOn({ buttons, axes }) {
    const right = BUTTONS.filter((_, k) => buttons[k]?.pressed);
    const cross = CROSS.filter(([k]) => buttons[k]?.pressed).map(([, control]) => control);
    const stick = STICK.map((ways, k) => {
      const value = axes[k] ?? 0, control = ways[value > 0 ? 1 : 0];
      return Math.abs(value) >= (this.#down.has(control) ? LETS_GO : PRESSES) ? control : '';
    });
    return [...right, ...cross, ...stick];
  }

  /** @type {(down: Set<string>) => void} */
  #take(down) {
    const before = this.#down;
    this.#down = down;
    for (const [control, key] of [...this.#held]) {
      if (down.has(control)) continue;
      this.#held.delete(control);
      this.drives.release(key);
    }
    for (const control of down) {
      const key = this.keys.get(control);
      if (before.has(control) || key === undefined) continue;
      this.#held.set(control, key);
      this.drives.press(key);
      this.used();
    }
  }
}
