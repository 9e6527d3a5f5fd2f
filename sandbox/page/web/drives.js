// Drives: motors and hydraulics, driven while their keys are held.

export class Drives {
  #held = new Map();

  // keys: parts and values by the name of a key; told: called with a key's name and whether it is held now.
  constructor(run, keys, told = () => {}) {
    Object.assign(this, { run, keys, told });
  }

  // The key of a keyboard event, where it drives something.
  nameOf(event) {
    const name = event.key.replace('Arrow', '').toLowerCase();
    return name in this.keys && !event.ctrlKey && !event.metaKey && !event.altKey && !event.shiftKey ? name : null;
  }

  press(name) {
    if (this.#held.has(name)) return;
    const gesture = this.run.newGesture();
    this.#held.set(name, gesture);
    for (const [part, value] of this.keys[name]) this.run.submit({ type: 'set_drive', part, value }, gesture);
    this.told(name, true);
  }

  // Stop what the key drove, or let the key go on that still drives it another way.
  release(name) {
    const gesture = this.#held.get(name);
    if (!this.#held.delete(name)) return;
    for (const [part] of this.keys[name]) {
      const others = [...this.#held.keys()].flatMap((other) => this.keys[other]);
      const value = others.findLast(([other]) => other === part)?.[1] ?? 0;
      this.run.submit({ type: 'set_drive', part, value }, gesture);
    }
    this.told(name, false);
  }

  releaseAll() {
    [...this.#held.keys()].forEach((name) => this.release(name));
  }

  // No key is held any more, as time has jumped.
  forget() {
    for (const name of this.#held.keys()) this.told(name, false);
    this.#held.clear();
  }
}
