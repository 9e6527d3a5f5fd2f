// Ears: what a screen reader says: a line for what somebody has done, and for how a run ends.

export class Ears {
  /** @type {string[]} */
  #said = [];

  /** @param {HTMLElement} box a live region that nobody sees */
  constructor(box) {
    this.box = box;
  }

  /** Lines of one frame are said together; a line that comes again is said again.
   * @type {(text: string) => void} */
  say(text) {
    if (!this.#said.length) {
      this.box.textContent = '';
      requestAnimationFrame(() => {
        this.box.textContent = this.#said.join(' ');
        this.#said = [];
      });
    }
    this.#said.push(text);
  }
}
