// Panel: Cs and Cd of each material by a pad, sliders and words, and the gravity of the world.

// The axes of the pad: softest value, and how wide the last tenth is.
const LOWEST = 0.003, REST = 0.02, STEP = 0.02, MARGIN = 14;
const height = (value) => Math.log10(value / (1 - value + REST)), LOW = height(LOWEST), HIGH = -Math.log10(REST);
const placeOf = (value) => (value <= LOWEST ? 0 : Math.min((height(Math.min(value, 1)) - LOW) / (HIGH - LOW), 1));

function valueAt(place) {
  if (place >= 0.9995) return 1;
  const power = 10 ** (LOW + Math.max(place, 0) * (HIGH - LOW)),
    value = Math.min(1, (power * (1 + REST)) / (1 + power));
  return value < 0.9 ? Number(value.toPrecision(3)) : 1 - Number((1 - value).toPrecision(2));
}

export const element = (name, attributes = {}, ...children) => {
  const made = Object.assign(document.createElement(name), attributes);
  made.append(...children);
  return made;
};

export class Panel {
  #gesture = null;
  #shown = '';

  // materials: [{ name, slot, words }], slot null for all; words: Cs and Cd by the words of firmness.
  constructor(root, run, materials, level) {
    Object.assign(this, { run, materials, level, chosen: materials[0] });
    this.choice = element('select', { id: 'material' });
    materials.forEach((each, k) => this.choice.append(new Option(each.name, k)));
    this.choice.addEventListener('change', () => {
      this.chosen = materials[this.choice.value];
      this.show();
    });
    const all = element('label', { hidden: materials.length < 2 }, 'Material ', this.choice);
    this.springs = element('div', { className: 'springs' });
    this.words = element('div', { className: 'words' });
    this.words.setAttribute('role', 'group');
    this.words.setAttribute('aria-label', 'Firmness');
    this.pad = element('canvas', { tabIndex: 0, className: 'pad' });
    this.pad.setAttribute('role', 'img');
    this.sliders = ['Stiffness Cs', 'Damping Cd'].map((text, k) => {
      const slider = element('input', { type: 'range', min: 0, max: 1, step: 'any', id: `slider${k}` }),
        output = element('output');
      slider.addEventListener('input',
        () => this.#set(...this.pair.map((old, n) => (n === k ? valueAt(Number(slider.value)) : old))));
      slider.addEventListener('change', () => this.#end());
      return { row: element('label', { htmlFor: slider.id, className: 'slider' },
        element('span', { textContent: text }), slider, output), slider, output };
    });
    this.gravity = ['x', 'y'].map((axis, k) => this.#gravityField(axis, k));
    this.springs.append(all, this.words, this.pad, ...this.sliders.map(({ row }) => row));
    root.append(this.springs, element('h2', { textContent: 'World' }), element('div', { className: 'fields' }, ...this.gravity.map((field) => field.parentElement)));
    for (const name of ['pointerdown', 'pointermove']) this.pad.addEventListener(name, (event) => this.#drag(event));
    this.pad.addEventListener('lostpointercapture', () => this.#end());
    this.pad.addEventListener('keydown', (event) => this.#key(event));
    this.show();
  }

  #gravityField(axis, k) {
    const limit = this.level.gravity_limit, field = element('input', { type: 'number', step: 'any', required: true,
      min: -limit, max: limit });
    element('label', {}, `Gravity ${axis} [m/s²]`, field);
    field.addEventListener('change', () => {
      const { gravity } = this.run.world.settings(), value = field.valueAsNumber;
      // What is wrong with it, the browser says.
      if (!field.reportValidity()) field.value = gravity[k];
      else if (value !== gravity[k]) this.run.submit({ type: 'set_gravity', gravity: gravity.map((old, n) => (n === k
        ? value : old)), duration: this.level.ramp_ticks }, this.run.newGesture());
    });
    return field;
  }

  // Cs and Cd of the first spring of the material that is chosen.
  get pair() {
    const { world } = this.run, material = world.view('state.material'), { slot } = this.chosen;
    const spring = material.findIndex((own) => (slot === null ? own >= 0 : own === slot));
    return spring < 0 ? [1, 1] : ['stiffness', 'damping'].map((name) => world.view(`state.${name}`)[spring]);
  }

  #set(stiffness, damping) {
    this.#gesture ??= this.run.newGesture();
    const { slot: material } = this.chosen, { ramp_ticks: duration } = this.level;
    const record = { type: 'set_coefficients', stiffness, damping, material, duration };
    this.run.submit(record, this.#gesture);
    this.show();
  }

  #end() {
    this.#gesture = null;
  }

  #drag(event) {
    if (!(event.buttons & 1)) return;
    event.preventDefault();
    this.pad.setPointerCapture(event.pointerId);
    const { clientWidth: width, clientHeight: tall } = this.pad,
      inside = (at, size) => Math.min(Math.max((at - MARGIN) / (size - 2 * MARGIN), 0), 1);
    this.#set(valueAt(inside(event.offsetX, width)), valueAt(1 - inside(event.offsetY, tall)));
  }

  #key(event) {
    const way = { ArrowLeft: [-STEP, 0], ArrowRight: [STEP, 0], ArrowUp: [0, STEP], ArrowDown: [0, -STEP] }[event.key];
    if (!way) return;
    event.preventDefault();
    event.stopPropagation();
    this.#set(...this.pair.map((value, k) => valueAt(Math.min(placeOf(value) + way[k], 1))));
    this.#end();
  }

  // The word whose stiffness k = Cs / (1 - Cd) is nearest.
  #wordFor([stiffness, damping]) {
    const firmness = ([cs, cd]) => Math.log(Math.max(cs, 1e-9) / (1 - cd + 1e-9)), own = firmness([stiffness, damping]);
    return Object.entries(this.chosen.words).reduce((best, each) =>
      (Math.abs(firmness(each[1]) - own) < Math.abs(firmness(best[1]) - own) ? each : best))[0];
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
    if (!offered.includes(this.chosen)) [this.chosen] = offered;
    this.springs.hidden = !this.chosen;
    this.materials.forEach((each, k) => { this.choice.options[k].disabled = !offered.includes(each); });
    this.choice.value = this.materials.indexOf(this.chosen);
    const { gravity } = this.run.world.settings();
    this.gravity.forEach((field, k) => {
      if (document.activeElement !== field) field.value = gravity[k];
    });
    if (this.chosen) this.#showChosen(this.pair);
    this.#shown = this.#present;
  }

  #showChosen(pair) {
    const word = this.#wordFor(pair), { words } = this.chosen;
    if (this.words.childElementCount !== Object.keys(words).length) {
      this.words.replaceChildren(...Object.keys(words).map((name) =>
        element('button', { type: 'button', textContent: name, onclick: () => {
        this.#set(...this.chosen.words[name]);
        this.#end();
      } })));
    }
    for (const button of this.words.children) button.setAttribute('aria-pressed', button.textContent === word);
    this.sliders.forEach(({ slider, output }, k) => {
      if (document.activeElement !== slider || !this.#gesture) slider.value = placeOf(pair[k]);
      slider.setAttribute('aria-valuetext', String(pair[k]));
      output.textContent = Number(pair[k].toPrecision(3));
    });
    this.pad.setAttribute('aria-label', `Cs ${pair[0]} across, Cd ${pair[1]} up: ${word}. Arrow keys change them.`);
    this.#draw(pair, word);
  }

  #draw(pair, word) {
    const context = this.pad.getContext('2d'), ratio = devicePixelRatio || 1,
      { clientWidth: width, clientHeight: tall } = this.pad;
    if (!width) return;
    this.pad.width = width * ratio;
    this.pad.height = tall * ratio;
    context.scale(ratio, ratio);
    const style = getComputedStyle(this.pad), across = (place) => MARGIN + place * (width - 2 * MARGIN),
      up = (place) => tall - MARGIN - place * (tall - 2 * MARGIN);
    context.strokeStyle = style.getPropertyValue('--line');
    context.fillStyle = style.getPropertyValue('--muted');
    context.font = '11px system-ui, sans-serif';
    context.beginPath();
    for (const value of [0.01, 0.1, 0.5, 0.9, 1]) {
      context.moveTo(across(placeOf(value)), up(0));
      context.lineTo(across(placeOf(value)), up(1));
      context.moveTo(across(0), up(placeOf(value)));
      context.lineTo(across(1), up(placeOf(value)));
      context.fillText(value, across(placeOf(value)) - 8, tall - 2);
    }
    context.stroke();
    // Words where there is room for them; what is chosen comes first.
    const taken = [];
    for (const [name, own] of Object.entries(this.chosen.words).sort(([name]) => (name === word ? -1 : 1))) {
      const x = Math.min(across(placeOf(own[0])) + 12, width - 36), y = Math.max(up(placeOf(own[1])) - 8, 11);
      if (taken.some(([tx, ty]) => Math.abs(x - tx) < 34 && Math.abs(y - ty) < 12)) continue;
      taken.push([x, y]);
      context.fillText(name, x, y);
    }
    context.fillStyle = style.getPropertyValue('--accent');
    context.strokeStyle = style.getPropertyValue('--surface');
    context.lineWidth = 3;
    context.beginPath();
    context.arc(across(placeOf(pair[0])), up(placeOf(pair[1])), 9, 0, 7);
    context.stroke();
    context.fill();
  }
}
