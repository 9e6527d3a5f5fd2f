// Drives: motors and hydraulics, driven while their keys are held, and keys that rules ask for.
/** @import { Run } from './run.js' */
/** @import { Command, Level } from './types.js' */

/** Where a key is on the keyboard: what it is called changes with others that are down.
 * @type {(event: Pick<KeyboardEvent, 'code' | 'key'>) => string} */
const placeOf = ({ code, key }) => code || key.toLowerCase();

/** What a level calls a key.
 * @type {(key: string) => string} */
const nameOf = (key) => key.replace('Arrow', '').toLowerCase();

export class Drives {
  /** @type {Map<string, number>} */
  #held = new Map();
  /** Names of keys that a keyboard holds, by their places.
   * @type {Map<string, string>} */
  #typed = new Map();

  /** keys: parts and values by the name of a key; ruleKeys: those that rules ask for; say: tells a person why a key does
   * nothing; told: called with a key's name and whether it is held now.
   * @param {Run} run @param {Level['keys']} keys @param {string[]} ruleKeys @param {(text: string) => void} say
   * @param {(name: string, isHeld: boolean) => void} [told] */
  constructor(run, keys, ruleKeys, say, told = () => {}) {
    this.run = run;
    this.own = { ...Object.fromEntries(ruleKeys.map((name) => [name, []])), ...keys };
    this.ruleKeys = ruleKeys;
    this.say = say;
    this.told = told;
  }

  /** Parts and values by the name of a key, those of what joined included.
   * @returns {Level['keys']} */
  get keys() {
    const found = { ...this.own };
    for (const [name, parts] of Object.entries(this.run.world.joinedKeys)) {
      found[name] = [...(Object.hasOwn(found, name) ? found[name] : []), ...parts];
    }
    return found;
  }

  /** Whether a key of a keyboard drives something.
   * @type {(event: KeyboardEvent) => boolean} */
  has({ key, ctrlKey, metaKey, altKey, shiftKey }) {
    return Object.hasOwn(this.keys, nameOf(key)) && !(ctrlKey || metaKey || altKey || shiftKey);
  }

  /** Whether a key that went down drives something; it does so until the key goes up.
   * @type {(event: KeyboardEvent) => boolean} */
  typed(event) {
    if (!this.has(event)) return false;
    const name = nameOf(event.key);
    if (!event.repeat) {
      this.press(name);
      this.#typed.set(placeOf(event), name);
    }
    return true;
  }

  /** A key went up. Of keys that go up while Meta is down a Mac tells nothing.
   * @type {(event: KeyboardEvent) => void} */
  lifted(event) {
    if (event.key === 'Meta') this.releaseTyped();
    const name = this.#typed.get(placeOf(event));
    if (name === undefined) return;
    this.release(name);
    this.#typed.delete(placeOf(event));
  }

  /** @type {(name: string) => void} */
  press(name) {
    if (this.#held.has(name)) return;
    const gesture = this.run.newGesture(), records = [...this.keys[name].map(([part, value]) =>
      /** @type {Command} */ ({ type: 'set_drive', part, value })), ...this.#forRules(name, true)];
    // A key is held where it does something.
    const done = records.filter((record) => this.run.submit(record, gesture, this.say));
    if (!done.length) return;
    this.#held.set(name, gesture);
    this.told(name, true);
  }

  /** Stop what the key drove, or let the key go on that still drives it another way.
   * @type {(name: string) => void} */
  release(name) {
    const gesture = this.#held.get(name);
    if (gesture === undefined) return;
    this.#held.delete(name);
    for (const [part] of this.keys[name] ?? []) {
      const others = [...this.#held.keys()].flatMap((other) => this.keys[other] ?? []);
      const value = others.findLast(([other]) => other === part)?.[1] ?? 0;
      this.run.submit({ type: 'set_drive', part, value }, gesture, this.say);
    }
    for (const record of this.#forRules(name, false)) this.run.submit(record, gesture, this.say);
    this.told(name, false);
  }

  /** What tells rules that ask for a key whether it is held.
   * @type {(name: string, down: boolean) => Command[]} */
  #forRules(name, down) {
    const key = this.ruleKeys.indexOf(name);
    return key < 0 ? [] : [{ type: 'hold_key', key, down }];
  }

  // Let go the keys that a keyboard holds, as it types elsewhere now.
  releaseTyped() {
    [...this.#typed.values()].forEach((name) => this.release(name));
    this.#typed.clear();
  }

  releaseAll() {
    [...this.#held.keys()].forEach((name) => this.release(name));
    this.#typed.clear();
  }

  // No key is held any more, as time has jumped.
  forget() {
    for (const name of this.#held.keys()) this.told(name, false);
    this.#held.clear();
    this.#typed.clear();
  }
}
