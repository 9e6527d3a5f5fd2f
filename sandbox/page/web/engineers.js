// Engineers: a fold of the panel that says how ticks are solved: the solver, substeps, and what the iterative one has.
import { element } from './panel.js';
import { SOLVING } from './shared.js';
/** @import { Run } from './run.js' */
/** @import { Command, Field, Level, Settings } from './types.js' */

/** @typedef {'solver' | 'substeps' | 'iterations' | 'warm_start'} Setting */
/** @typedef {HTMLSelectElement | HTMLInputElement} Control */
// What only the iterative solver uses.
/** @type {Setting[]} */
const ITERATIVE = ['iterations', 'warm_start'];

export class Engineers {
  #shown = '';
  /** @type {Map<Setting, Control>} */
  #controls = new Map();

  /** say: tells a person in the panel what was refused.
   * @param {HTMLElement} panel @param {Run} run @param {Level} level @param {(text: string) => void} say */
  constructor(panel, run, { about: { commands, solvers } }, say) {
    this.run = run;
    this.say = say;
    const fields = commands.set_solver?.fields ?? {}, labels = /** @type {Record<string, string>} */ (SOLVING.LABELS);
    const rows = [this.#choice('Solver', 'solver', solvers.map((name) => [name, labels[name]])),
      this.#choice('Substeps', 'substeps', (fields.substeps.enum ?? []).map((count) => [String(count), count === 'auto' ? 'Auto' : String(count)])),
      this.#number('Iterations', 'iterations', fields.iterations, '1'), this.#number('Warm start', 'warm_start', fields.warm_start, 'any')];
    this.tip = element('p', { className: 'says' });
    panel.append(element('details', { className: 'engineers' }, element('summary', { textContent: 'For engineers' }),
      element('div', { className: 'fields' }, ...rows), this.tip));
    this.follow();
  }

  /** @type {(text: string, setting: Setting, options: [value: string, label: string][]) => HTMLElement} */
  #choice(text, setting, options) {
    const select = element('select', {}, ...options.map(([value, label]) => new Option(label, value)));
    return this.#row(text, setting, select, () => (setting === 'substeps' && select.value !== 'auto' ? Number(select.value) : select.value));
  }

  /** @type {(text: string, setting: Setting, limits: Field, step: string) => HTMLElement} */
  #number(text, setting, { minimum, maximum }, step) {
    const field = element('input', { type: 'number', required: true, step, min: minimum, max: maximum });
    return this.#row(text, setting, field, () => (field.reportValidity() ? field.valueAsNumber : null));
  }

  /** value: what was chosen; null: nothing that could be, as the browser has said.
   * @type {(text: string, setting: Setting, control: Control, value: () => number | string | null) => HTMLElement} */
  #row(text, setting, control, value) {
    this.#controls.set(setting, control);
    control.addEventListener('change', () => {
      const { run } = this, chosen = value();
      const record = /** @type {Command} */ ({ type: 'set_solver', [setting]: chosen });
      if (chosen !== null && chosen !== run.world.settings()[setting]) run.submit(record, run.newGesture(), this.say);
      this.#show(run.world.settings());
    });
    return element('label', { id: `${setting}-row` }, text, control);
  }

  // Show what there is now, where it is other than what was shown.
  follow() {
    const settings = this.run.world.settings();
    if (this.#shown !== JSON.stringify(settings)) this.#show(settings);
  }

  /** @type {(settings: Settings) => void} */
  #show(settings) {
    for (const [setting, control] of this.#controls) {
      control.value = String(settings[setting]);
      if (control.parentElement) control.parentElement.hidden = ITERATIVE.includes(setting) && settings.solver !== 'iterative';
    }
    this.tip.textContent = `${/** @type {Record<string, string>} */ (SOLVING.TIPS)[settings.solver]}.`;
    this.#shown = JSON.stringify(settings);
  }
}
