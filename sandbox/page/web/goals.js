// Goals: what a level asks of who plays it, its counters and clock, and a card where it is won or lost.
import { element } from './panel.js';
import { TUNING } from './shared.js';
/** @import { Race } from './race.js' */
/** @import { Toy } from './toy.js' */
/** @import { Goals as Told } from './types.js' */

const STARS = 3, POINTS = 5;
/** A star as a path: its outer and inner points on circles about (12, 12).
 * @type {() => string} */
const starPath = () => `M${Array.from({ length: 2 * POINTS }, (_, k) => {
  const radius = k % 2 ? 4.2 : 10, turn = (Math.PI * k) / POINTS;
  return `${(12 + radius * Math.sin(turn)).toFixed(2)} ${(12 - radius * Math.cos(turn)).toFixed(2)}`;
}).join('L')}z`;
const number = new Intl.NumberFormat('en', { maximumFractionDigits: 2 });

/** Elements that it fills: the line of the goal, that of counters and clock, and the card with its parts.
 * @typedef {{ goal: HTMLElement, score: HTMLElement, end: HTMLElement, again: HTMLElement, was: HTMLElement,
 * on: HTMLElement, solved: HTMLAnchorElement }} Places */

export class Goals {
  #shown = '';
  #isAsSent = false;
  /** @type {Race | null} */
  race = null;

  /** told: what there is to show, see playing.py; nothing of it is shown where a level asks nothing.
   * @param {Toy} toy @param {Told} told @param {Places} places */
  constructor(toy, told, places) {
    this.toy = toy;
    this.told = told;
    this.places = places;
    places.goal.textContent = told.goal;
    places.goal.hidden = !told.goal;
    places.solved.hidden = !told.solved;
    if (told.solved) Object.assign(places.solved, { textContent: told.solved.text, href: told.solved.fragment, title: 'Watch it' });
    places.again.addEventListener('click', () => {
      this.close();
      toy.restart();
    });
    places.on.addEventListener('click', () => {
      this.close();
      toy.play();
    });
    places.end.addEventListener('keydown', (event) => this.#key(event));
    places.was.addEventListener('click', () => {
      this.close();
      toy.restart(false);
    });
    // What tells how the run ended has the card again.
    places.score.addEventListener('click', () => this.#open());
    places.score.addEventListener('keydown', ({ key }) => (key === 'Enter' || key === ' ') && this.#open());
    toy.addEventListener('outcome', () => this.#open());
    toy.addEventListener('jump', () => {
      if (toy.outcome?.tick !== toy.run.time) this.close();
    });
    toy.addEventListener('draw', () => this.#follow());
  }

  // Whether what is won here is what a sender says, which nothing has verified.
  get isAsSent() {
    return this.#isAsSent;
  }

  /** @param {boolean} isAsSent */
  set isAsSent(isAsSent) {
    this.#isAsSent = isAsSent;
    if (!this.places.end.hidden) this.#title();
  }

  #title() {
    const { outcome } = this.toy, isSent = this.#isAsSent && this.toy.run.time <= this.toy.sent;
    if (outcome) this.places.end.querySelector('h2')?.replaceChildren((outcome.isWon ? 'Won' : 'Lost') + (isSent ? ', as sent' : ''));
  }

  // Counters and clock, as they are here in time.
  #follow() {
    const { toy, told: { hasClock } } = this, { outcome } = toy, said = this.#counted();
    // The clock of a run that is over stands.
    if (hasClock) said.push(`${((outcome?.tick ?? toy.run.time) / toy.rate).toFixed(1)} s`);
    if (outcome) said.push(outcome.isWon ? '\u2605'.repeat(outcome.stars) + '\u2606'.repeat(STARS - outcome.stars) : 'Lost');
    const text = said.join('   ');
    if (text === this.#shown) return;
    this.#shown = this.places.score.textContent = text;
    this.places.score.hidden = !text;
    for (const [name, value] of [['role', 'button'], ['tabindex', '0'], ['title', 'How it ended']]) {
      if (outcome) this.places.score.setAttribute(name, value);
      else this.places.score.removeAttribute(name);
    }
  }

  // Counters with their names.
  #counted() {
    const values = this.toy.world.view('state.counter');
    return this.told.counters.map(([place, text]) => `${text} ${number.format(values[place])}`);
  }

  #open() {
    const { toy, places: { end } } = this, { outcome } = toy;
    if (!outcome) return;
    toy.pause();
    this.#title();
    const seconds = `${(outcome.tick / toy.rate).toFixed(2)} s`;
    const next = outcome.isWon ? this.told.stars[outcome.rule]?.[outcome.stars - 1] : undefined;
    const lines = [this.race?.said(outcome), outcome.text, [seconds, ...this.#counted()].join(', '), next].filter(Boolean);
    end.querySelector('p')?.replaceChildren(...lines.flatMap((line, k) => [k ? element('br') : '', line ?? '']));
    const earned = end.querySelector('div');
    earned?.replaceChildren(...stars(outcome.stars));
    earned?.setAttribute('aria-label', starText(outcome.stars));
    earned?.toggleAttribute('hidden', !outcome.isWon);
    end.classList.toggle('lost', !outcome.isWon);
    // Who has lost is not sent on.
    for (const link of end.querySelectorAll('a, #end-beat')) link.toggleAttribute('hidden', !outcome.isWon);
    this.places.was.hidden = !toy.run.commands.some(({ record }) => record && TUNING.KINDS.includes(record.type));
    end.hidden = false;
    this.places.again.focus({ preventScroll: true });
  }

  /** Escape closes the card; Tab goes round in it.
   * @type {(event: KeyboardEvent) => void} */
  #key(event) {
    /** @type {NodeListOf<HTMLElement>} */
    const all = this.places.end.querySelectorAll('a, button'), inside = [...all].filter((each) => !each.hidden);
    const now = inside.findIndex((each) => each === document.activeElement), by = event.shiftKey ? -1 : 1;
    if (event.key === 'Escape') this.close();
    else if (event.key === 'Tab') inside[(now + by + inside.length) % inside.length].focus({ preventScroll: true });
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  close() {
    const { end } = this.places;
    if (end.hidden) return;
    end.hidden = true;
    this.toy.canvas.focus({ preventScroll: true });
  }
}

/** @type {(earned: number) => string} */
export const starText = (earned) => `${earned} of ${STARS} stars`;

/** @type {(earned: number) => Element[]} */
function stars(earned) {
  return Array.from({ length: STARS }, (_, k) => {
    const drawn = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
    const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
    drawn.setAttribute('viewBox', '0 0 24 24');
    drawn.setAttribute('class', k < earned ? 'star earned' : 'star');
    path.setAttribute('d', starPath());
    drawn.append(path);
    return drawn;
  });
}
