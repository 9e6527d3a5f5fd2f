// Panel: Cs and Cd of each material by a pad, sliders and words, and the gravity of the world.
import { contextOf } from './paint.js';
import { PLAIN, SagMap, Scale } from './sag_map.js';
import { PAD } from './shared.js';
/** @import { Run } from './run.js' */
/** @import { Level, MaterialRow, Point } from './types.js' */

// Step of an arrow key, and around the pad's map [px].
const STEP = 0.02, MARGIN = 14;
const WAYS = new Map(Object.entries({ ArrowLeft: [-STEP, 0], ArrowRight: [STEP, 0], ArrowUp: [0, STEP],
  ArrowDown: [0, -STEP] }));

/** A share in per cent, of two digits.
 * @type {(share: number) => string} */
function perCent(share) {
  return share < PAD.UNSEEN ? '0 %' : `${Number((100 * share).toPrecision(2))} %`;
}

/** @type {<N extends keyof HTMLElementTagNameMap>(name: N,
 *   attributes?: Partial<HTMLElementTagNameMap[N]>,
 *   ...children: (Node | string)[]) => HTMLElementTagNameMap[N]} */
export const element = (name, attributes = {}, ...children) => {
  const made = Object.assign(document.createElement(name), attributes);
  made.append(...children);
  return made;
};

/** @typedef {MaterialRow & { sags: SagMap | null, scale: Scale }} Material */
/**
 * Where on the pad a place of an axis is, and the size of its map [pixels].
 * @typedef {{ across: (place: number) => number, up: (place: number) => number, wide: number, high: number }} PadMap
 */

export class Panel {
  /** @type {number | null} */
  #gesture = null;
  #shown = '';
  /** @type {Material | null} */
  chosen = null;

  /** rows: materials, by the words of firmness their Cs and Cd; what sags, the sentence that says how far, and the map of
   * the pad, where something sags. say: tells a person in the panel what was refused.
   * @param {HTMLElement} root @param {Run} run @param {MaterialRow[]} rows @param {Level} level
   * @param {(text: string) => void} say */
  constructor(root, run, rows, level, say) {
    this.run = run;
    this.level = level;
    this.say = say;
    const materials = this.materials = rows.map((row) => ({ ...row, sags: row.map ? new SagMap(row.map) : null,
      scale: row.map ? new Scale(row.map.lowest, row.map.rest) : PLAIN }));
    this.chosen = materials.find((each) => each.is_first) ?? materials[0] ?? null;
    this.choice = element('select', { id: 'material' });
    materials.forEach((each, k) => this.choice.append(new Option(each.name, String(k))));
    this.choice.addEventListener('change', () => {
      this.chosen = materials[Number(this.choice.value)];
      this.show();
    });
    const all = element('label', { hidden: materials.length < 2 }, 'Material ', this.choice);
    this.springs = element('div', { className: 'springs' });
    this.words = element('div', { className: 'words' });
    this.words.setAttribute('role', 'group');
    this.words.setAttribute('aria-label', 'Firmness');
    this.says = element('p', { className: 'says' });
    this.pad = element('canvas', { tabIndex: 0, className: 'pad' });
    this.pad.setAttribute('role', 'img');
    this.sliders = ['Stiffness Cs', 'Damping Cd'].map((text, k) => {
      const slider = element('input', { type: 'range', min: '0', max: '1', step: 'any', id: `slider${k}` }),
        output = element('output');
      slider.addEventListener('input', () => {
        const { chosen, pair: [stiffness, damping] } = this, value = chosen?.scale.valueAt(Number(slider.value)) ?? 1;
        this.#set(k === 0 ? value : stiffness, k === 1 ? value : damping);
      });
      slider.addEventListener('change', () => this.#end());
      return { row: element('label', { htmlFor: slider.id, className: 'slider' },
        element('span', { textContent: text }), slider, output), slider, output };
    });
    this.gravity = ['x', 'y'].map((axis, k) => this.#gravityField(axis, k));
    this.springs.append(all, this.words, this.says, this.pad, ...this.sliders.map(({ row }) => row));
    root.append(this.springs, element('div', { className: 'world' }, element('h2', { textContent: 'World' }),
      element('div', { className: 'fields' }, ...this.gravity.map(({ label }) => label))));
    this.pad.addEventListener('pointerdown', (event) => this.#drag(event));
    this.pad.addEventListener('pointermove', (event) => this.#drag(event));
    this.pad.addEventListener('lostpointercapture', () => this.#end());
    this.pad.addEventListener('keydown', (event) => this.#key(event));
    this.show();
  }

  /** @type {(axis: string, k: number) => { field: HTMLInputElement, label: HTMLElement }} */
  #gravityField(axis, k) {
    const limit = this.level.gravity_limit, field = element('input', { type: 'number', step: 'any', required: true,
      min: String(-limit), max: String(limit) });
    field.addEventListener('change', () => {
      const { gravity } = this.run.world.settings(), value = field.valueAsNumber;
      // What is wrong with it, the browser says.
      if (!field.reportValidity()) field.value = String(gravity[k]);
      else if (value !== gravity[k]) {
        gravity[k] = value;
        const { ramp_ticks: duration } = this.level;
        this.run.submit({ type: 'set_gravity', gravity, duration }, this.run.newGesture(), this.say);
        field.value = String(this.run.world.settings().gravity[k]);
      }
    });
    return { field, label: element('label', {}, `Gravity ${axis} [m/s²]`, field) };
  }

  /** Cs and Cd of the first spring of the material that is chosen.
   * @type {Point} */
  get pair() {
    const { world } = this.run, material = world.view('state.material'), slot = this.chosen?.slot ?? null;
    const spring = material.findIndex((own) => (slot === null ? own >= 0 : own === slot));
    return spring < 0 ? [1, 1] : [world.view('state.stiffness')[spring], world.view('state.damping')[spring]];
  }

  /** @type {(stiffness: number, damping: number) => void} */
  #set(stiffness, damping) {
    if (!this.chosen) return;
    this.#gesture ??= this.run.newGesture();
    const { slot: material } = this.chosen, { ramp_ticks: duration } = this.level;
    const isDone = this.run.submit({ type: 'set_coefficients', stiffness, damping, material, duration }, this.#gesture,
      this.say);
    // What shows the values goes back, also what is still being moved.
    if (!isDone) this.#end();
    this.show();
  }

  #end() {
    this.#gesture = null;
  }

  /** @type {(event: PointerEvent) => void} */
  #drag(event) {
    if (!(event.buttons & 1) || !this.chosen) return;
    event.preventDefault();
    this.pad.setPointerCapture(event.pointerId);
    const { clientWidth: width, clientHeight: tall } = this.pad;
    /** @type {(at: number, size: number) => number} */
    const inside = (at, size) => Math.min(Math.max((at - MARGIN) / (size - 2 * MARGIN), 0), 1);
    const { scale } = this.chosen;
    this.#set(scale.valueAt(inside(event.offsetX, width)), scale.valueAt(1 - inside(event.offsetY, tall)));
  }

  /** @type {(event: KeyboardEvent) => void} */
  #key(event) {
    const way = WAYS.get(event.key);
    if (!way || !this.chosen) return;
    event.preventDefault();
    event.stopPropagation();
    const { scale } = this.chosen;
    const [stiffness, damping] = this.pair.map((value, k) =>
      (way[k] ? scale.valueAt(Math.min(scale.placeOf(value) + way[k], 1)) : value));
    this.#set(stiffness, damping);
    this.#end();
  }

  /** The word for how far it sags; where nothing is known of that, the word whose stiffness Cs / (1 - Cd) is nearest.
   * @type {(chosen: Material, pair: Point) => string} */
  #wordFor({ sags, words }, [stiffness, damping]) {
    if (stiffness === 1 && damping === 1) return PAD.RIGID;
    if (sags) return sags.wordAt(stiffness, damping);
    /** @type {(pair: Point) => number} */
    const firmness = ([cs, cd]) => Math.log(Math.max(cs, 1e-9) / (1 - cd + 1e-9));
    const own = firmness([stiffness, damping]);
    return Object.entries(words).reduce((best, each) =>
      (Math.abs(firmness(each[1]) - own) < Math.abs(firmness(best[1]) - own) ? each : best))[0];
  }

  /** The sentence that says how far it sags.
   * @type {(chosen: Material, pair: Point) => string} */
  #sentence({ says, sags }, pair) {
    if (!says || !sags) return '';
    const sag = pair.every((value) => value === 1) ? 0 : sags.at(...pair);
    if (sag < says.none_below) return `${says.none}.`;
    return `${sag >= says.flat_from ? says.flat : says.sag.replace('{}', perCent(sag))}.`;
  }

  // Materials that there are by now: a recording may bring more.
  get #offered() {
    return this.materials.filter(({ slot }) => slot === null || slot < this.run.world.counts.material);
  }

  // What is shown, as a text.
  get #present() {
    const { counts } = this.run.world, { gravity } = this.run.world.settings();
    return [counts.material, ...gravity, ...(this.chosen ? this.pair : [])].join();
  }

  // Show what there is now, where it is other than what was shown.
  follow() {
    if (this.#shown !== this.#present) this.show();
  }

  show() {
    const offered = this.#offered;
    if (!this.chosen || !offered.includes(this.chosen)) this.chosen = offered[0] ?? null;
    this.springs.hidden = this.level.absent.includes('springs') || !this.chosen;
    this.materials.forEach((each, k) => { this.choice.options[k].disabled = !offered.includes(each); });
    this.choice.value = String(this.chosen ? this.materials.indexOf(this.chosen) : -1);
    const { gravity } = this.run.world.settings();
    this.gravity.forEach(({ field }, k) => {
      if (document.activeElement !== field) field.value = String(gravity[k]);
    });
    if (this.chosen) this.#showChosen(this.chosen, this.pair);
    this.#shown = this.#present;
  }

  /** @type {(chosen: Material, pair: Point) => void} */
  #showChosen(chosen, pair) {
    const word = this.#wordFor(chosen, pair), { words } = chosen;
    if (this.words.childElementCount !== Object.keys(words).length) {
      this.words.replaceChildren(...Object.keys(words).map((name) =>
        element('button', { type: 'button', textContent: name, onclick: () => {
          this.#set(...(this.chosen ?? chosen).words[name]);
          this.#end();
        } })));
    }
    this.says.textContent = this.#sentence(chosen, pair);
    for (const button of this.words.children) {
      button.setAttribute('aria-pressed', String(button.textContent === word));
    }
    this.sliders.forEach(({ slider, output }, k) => {
      if (document.activeElement !== slider || !this.#gesture) slider.value = String(chosen.scale.placeOf(pair[k]));
      slider.setAttribute('aria-valuetext', String(pair[k]));
      output.textContent = String(Number(pair[k].toPrecision(3)));
    });
    this.pad.setAttribute('aria-label', `Cs ${pair[0]} across, Cd ${pair[1]} up: ${word}. Arrow keys change them.`);
    this.#draw(chosen, pair);
  }

  /** @type {(chosen: Material, pair: Point) => void} */
  #draw(chosen, pair) {
    const context = contextOf(this.pad), ratio = devicePixelRatio || 1, { scale, sags, subject = '' } = chosen;
    const { clientWidth: width, clientHeight: tall } = this.pad;
    if (!width) return;
    this.pad.width = width * ratio;
    this.pad.height = tall * ratio;
    context.scale(ratio, ratio);
    const style = getComputedStyle(this.pad), wide = width - 2 * MARGIN, high = tall - 2 * MARGIN,
      across = (/** @type {number} */ place) => MARGIN + place * wide,
      up = (/** @type {number} */ place) => tall - MARGIN - place * high;
    context.strokeStyle = style.getPropertyValue('--line');
    context.fillStyle = style.getPropertyValue('--muted');
    context.font = '11px system-ui, sans-serif';
    context.textAlign = 'center';
    context.beginPath();
    let last = -Infinity;
    for (const value of scale.numbers()) {
      const place = scale.placeOf(value);
      context.moveTo(across(place), up(0));
      context.lineTo(across(place), up(1));
      context.moveTo(across(0), up(place));
      context.lineTo(across(1), up(place));
      if (across(place) - last < 28 || (value !== 1 && across(1) - across(place) < 14)) continue;
      context.fillText(String(value), across(place), tall - 2);
      last = across(place);
    }
    context.stroke();
    const x = across(scale.placeOf(pair[0])), y = up(scale.placeOf(pair[1]));
    if (sags) this.#drawWords(context, sags, subject, style, { across, up, wide, high }, [x, y]);
    context.fillStyle = style.getPropertyValue('--accent');
    context.strokeStyle = style.getPropertyValue('--surface');
    context.lineWidth = 3;
    context.beginPath();
    context.arc(x, y, 9, 0, 7);
    context.stroke();
    context.fill();
    if (!sags) return;
    const word = this.#wordFor(chosen, pair);
    context.fillStyle = style.getPropertyValue('--text');
    context.font = 'bold 12px system-ui, sans-serif';
    context.textAlign = 'center';
    const half = context.measureText(word).width / 2 + 2;
    context.fillText(word, Math.min(Math.max(x, across(0) + half), across(1) - half), y - 24 < up(1) ? y + 22 : y - 13);
  }

  /** Lines between the words for how far it sags, and the words, as the window draws them: what it is called as it is
   * stands at the knob, and no other word there.
   * @type {(context: CanvasRenderingContext2D, sags: SagMap, subject: string, style: CSSStyleDeclaration,
   *   map: PadMap, knob: Point) => void} */
  #drawWords(context, sags, subject, style, { across, up, wide, high }, knob) {
    context.fillStyle = style.getPropertyValue('--accent');
    context.globalAlpha = 0.45;
    for (const [x, y] of sags.borders(Math.round(wide), Math.round(high)))
      context.fillRect(across(0) + x, up(0) - y - 1, 1.2, 1.2);
    context.globalAlpha = 1;
    context.fillStyle = style.getPropertyValue('--muted');
    context.font = '12px system-ui, sans-serif';
    for (const [word, [x, y]] of Object.entries(sags.places)) {
      const half = context.measureText(word).width / 2 + 2;
      const middle = Math.min(Math.max(across(x), across(0) + half), across(1) - half);
      if (Math.abs(middle - knob[0]) < 2 * half && Math.abs(up(y) - knob[1]) < 30) continue;
      context.fillText(word, middle, up(y) + 4);
    }
    context.textAlign = 'right';
    context.font = '11px system-ui, sans-serif';
    context.fillText(`sag of ${subject}`, across(1), up(1) - 3);
  }
}
