// FeelCard: how a thing feels, beside the level: its curve with two handles, its numbers, and what makes it feel as one wants.
import { thingOf } from './cursor.js';
import { bodyAt, Copies, css, materialOf, sentence, short } from './feel.js';
import { Refusal } from './commands.js';
import { contextOf } from './paint.js';
import { element } from './panel.js';
import { copied } from './sending.js';
import { FEEL, RESPONSE } from './shared.js';
/** @import { Feel, Found } from './feel.js' */
/** @import { Toy } from './toy.js' */
/** @import { Point } from './types.js' */

// How the window has it; and time of a frame for the work [ms].
const { ABOVE, BEHIND, LEAST_ABOVE, LEAST_TICKS, MOST_OVERSHOOT, MOST_SECONDS, READINGS, SHORTEST } = FEEL, BUDGET = 12;
// Around the chart, and of a handle [px].
const LEFT = 44, RIGHT = 16, TOP = 12, BOTTOM = 20, HANDLE = 7;
const DASH = '–';

export class FeelCard {
  /** @type {Generator<number, Feel | Found> | null} */
  #work = null;
  /** @type {Copies | null} */
  #copies = null;
  #body = '';
  #way = 0;
  /** @type {Feel | null} */
  #feel = null;
  /** @type {Found | null} */
  #found = null;
  /** Overshoot [1] and settling [s]; null until something was measured.
   * @type {Point | null} */
  #wanted = null;
  /** The material of its springs; null: they are of several.
   * @type {number | null} */
  #material = null;
  // Why nothing can be sought; which handle is dragged.
  #refusal = '';
  #held = -1;

  /** speak: says it to who does not see the card.
   * @param {HTMLElement} box @param {Toy} toy @param {(text: string) => void} speak */
  constructor(box, toy, speak) {
    this.box = box;
    this.toy = toy;
    this.speak = speak;
    this.title = element('h2');
    this.said = element('p', { className: 'says' });
    this.chart = element('canvas', { className: 'curve' });
    this.chart.setAttribute('role', 'img');
    this.chart.setAttribute('aria-label', 'No curve yet');
    this.ways = FEEL.WAYS.map((way, k) => element('button', { type: 'button', textContent: way, onclick: () => {
      this.#way = k;
      this.#measure();
    } }));
    this.fields = ['Overshoot [%]', 'Still after [s]'].map((text, k) => {
      const field = element('input', { type: 'number', step: 'any', required: true });
      field.addEventListener('change', () => { if (field.reportValidity()) this.#type(k, field.valueAsNumber); });
      return { field, label: element('label', {}, text, field) };
    });
    this.readings = READINGS.map((name) => ({ name, value: element('dd', { textContent: DASH }) }));
    this.bar = element('progress', { max: 1 });
    this.bar.setAttribute('aria-label', 'Measuring');
    this.note = element('p', { className: 'says' });
    this.use = element('button', { type: 'button', textContent: 'Use', title: 'Set this Cs and Cd; undo takes it back', onclick: () => this.#use() });
    this.take = element('button', { type: 'button', textContent: 'Copy CSS', title: 'A transition that moves as the thing does', onclick: () => this.#copy() });
    const close = element('button', { type: 'button', textContent: 'Close', onclick: () => this.close() });
    box.append(this.title, this.said, element('div', { className: 'words' }, ...this.ways), this.chart,
      element('div', { className: 'fields' }, ...this.fields.map(({ label }) => label)),
      element('dl', {}, ...this.readings.map(({ name, value }) => element('div', {}, element('dt', { textContent: name }), value))),
      this.bar, this.note, element('div', { className: 'acts' }, this.use, this.take, close));
    box.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape') return;
      event.stopPropagation();
      this.close();
    });
    this.chart.addEventListener('pointerdown', (event) => this.#press(event));
    this.chart.addEventListener('pointermove', (event) => this.#drag(event));
    this.chart.addEventListener('lostpointercapture', () => this.#letGo());
    addEventListener('resize', () => this.#show());
    toy.addEventListener('theme', () => this.#show());
  }

  /** Show how the thing of a particle feels; who asks of what has no springs is told so.
   * @type {(particle: number) => void} */
  open(particle) {
    const { toy, box } = this, body = bodyAt(toy.world, particle);
    if (body === null) {
      toy.say('It has no springs whose feel could be measured.');
      return;
    }
    this.#body = body;
    this.title.textContent = body || 'Loose springs';
    box.setAttribute('aria-label', `How ${thingOf(this.title.textContent)} feels`);
    box.hidden = false;
    this.#measure();
    this.ways[this.#way].focus({ preventScroll: true });
  }

  close() {
    const { box, toy } = this;
    this.#work = this.#copies = this.#feel = this.#found = null;
    if (box.contains(document.activeElement)) toy.canvas.focus({ preventScroll: true });
    box.hidden = true;
  }

  // Measure it as it is now.
  #measure() {
    const { toy } = this;
    this.#copies = new Copies(toy.fresh, toy.world);
    this.#feel = this.#found = this.#wanted = null;
    this.#refusal = this.#why();
    this.#begin(this.#copies.release(this.#body, this.#way === 1), FEEL.MEASURING);
  }

  #why() {
    if (this.toy.level.absent.includes('springs')) return FEEL.NO_HANDS;
    try {
      this.#material = materialOf(this.toy.world, this.#body);
      return '';
    } catch (error) {
      return told(error);
    }
  }

  /** @type {(work: Generator<number, Feel | Found>, note: string) => void} */
  #begin(work, note) {
    this.#work = work;
    this.note.textContent = note;
    this.bar.value = 0;
    this.#show();
    requestAnimationFrame(() => this.#go(work));
  }

  /** Work for a moment of each frame, until it is done or other work was begun.
   * @type {(work: Generator<number, Feel | Found>) => void} */
  #go(work) {
    if (this.#work !== work) return;
    const end = performance.now() + BUDGET;
    try {
      let step = work.next();
      while (!step.done && performance.now() < end) step = work.next();
      if (!step.done) {
        this.bar.value = step.value;
        requestAnimationFrame(() => this.#go(work));
        return;
      }
      this.#take(step.value);
    } catch (error) {
      this.note.textContent = told(error);
    }
    this.#work = null;
    this.#show();
    this.speak(`${this.said.textContent} ${this.note.textContent}`.trim());
  }

  /** @type {(made: Feel | Found) => void} */
  #take(made) {
    if ('pair' in made) {
      this.#found = made;
      this.note.textContent = `${this.#pairText(made)}: ${this.#nearness(made)}.`;
    } else {
      this.#feel = made;
      this.note.textContent = this.#refusal || FEEL.HINT;
      this.#wanted = askedOf(made);
    }
  }

  get shown() {
    return this.#found ?? this.#feel;
  }

  /** @type {(found: Found) => string} */
  #pairText({ pair: [stiffness, damping] }) {
    const least = Math.max(Math.min(stiffness, damping), 1e-9), decimals = Math.max(3, 2 - Math.floor(Math.log10(least)));
    const pair = `Cs ${stiffness.toFixed(decimals)}, Cd ${damping.toFixed(decimals)}`;
    if (this.#material === null) return FEEL.PAIR_OF_ALL.replace('{}', pair);
    const name = this.toy.world.names.material[this.#material];
    return FEEL.PAIR.replace('{}', pair).replace('{}', () => `"${name}"`);
  }

  /** @type {(found: Found) => string} */
  #nearness(found) {
    if (found.missed <= FEEL.AS_ASKED) return 'as asked';
    /** @type {(asked: Point) => string} */
    const text = ([overshoot, settling]) => `${short(100 * overshoot)} % and ${short(settling)} s`;
    return FEEL.CLOSEST.replace('{}', text(askedOf(found))).replace('{}', text(this.#wanted ?? [0, 0]));
  }

  // What is asked.

  /** @type {(k: number, value: number) => void} */
  #type(k, value) {
    const [overshoot, settling] = this.#wanted ?? [0, 0];
    this.#want(k === 0 ? value / 100 : overshoot, k === 1 ? value : settling);
    this.#seek();
  }

  /** @type {(overshoot: number, settling: number) => void} */
  #want(overshoot, settling) {
    const least = LEAST_TICKS / this.toy.rate;
    this.#wanted = [Math.min(Math.max(overshoot, 0), MOST_OVERSHOOT), Math.max(settling, least)];
    this.#show();
  }

  #seek() {
    if (!this.#wanted || !this.#copies || this.#refusal) return;
    this.#found = null;
    this.#begin(this.#copies.seek(this.#body, this.#way === 1, this.#wanted, this.#material), FEEL.LOOKING);
  }

  #use() {
    const { toy } = this, found = this.#found;
    if (!found) return;
    const [stiffness, damping] = found.pair, material = this.#material, { ramp_ticks: duration } = toy.level;
    const isDone = toy.run.submit({ type: 'set_coefficients', stiffness, damping, material, duration }, toy.run.newGesture(),
      (text) => { this.note.textContent = text; });
    if (!isDone) return;
    this.note.textContent = `Set: ${this.#pairText(found)}. Undo takes it back.`;
    this.#feel = found;
    this.#found = null;
    this.#show();
    toy.refresh();
  }

  async #copy() {
    const { toy } = this, shown = this.shown;
    if (!shown) return;
    const text = css(toy.world, shown);
    this.note.textContent = await copied(text) ? `Copied: ${text}` : text;
  }

  // What is shown.

  #show() {
    const { box } = this, shown = this.shown, isBusy = this.#work !== null, canAsk = this.#feel !== null && !this.#refusal;
    if (box.hidden) return;
    this.ways.forEach((button, k) => button.setAttribute('aria-pressed', String(k === this.#way)));
    this.said.textContent = shown ? sentence(shown) : '';
    const [overshoot, settling] = this.#wanted ?? [0, 0], tick = 1 / this.toy.rate;
    const limits = [[0, 100 * MOST_OVERSHOOT], [LEAST_TICKS * tick, MOST_SECONDS]];
    this.fields.forEach(({ field }, k) => {
      field.disabled = !canAsk;
      [field.min, field.max] = [short(Math.ceil(1000 * limits[k][0]) / 1000), String(limits[k][1])];
      if (document.activeElement !== field || !isBusy) field.value = this.#wanted ? short(k === 0 ? 100 * overshoot : settling) : '';
    });
    const texts = shown ? readingsOf(shown) : READINGS.map(() => DASH);
    this.readings.forEach(({ value }, k) => { value.textContent = texts[k]; });
    this.bar.style.visibility = isBusy ? 'visible' : 'hidden';
    this.use.disabled = !this.#found;
    this.take.disabled = !shown;
    this.chart.setAttribute('aria-label', shown ? `${sentence(shown)} The numbers are below.` : 'No curve yet');
    this.#draw();
  }

  // Seconds and heights that are shown, and where they are on the chart [px].
  get #axes() {
    const { clientWidth: width, clientHeight: tall } = this.chart, [overshoot, settling] = this.#wanted ?? [0, 0.5];
    const errors = [this.#feel, this.#found].flatMap((feel) => (feel ? [...feel.errors] : []));
    const peak = Math.max(overshoot, ...errors.map((error) => -error)), low = Math.min(0, ...errors.map((error) => 1 - error));
    const span = Math.max(BEHIND * settling, SHORTEST), high = 1 + Math.max(ABOVE * peak, LEAST_ABOVE);
    const wide = width - LEFT - RIGHT, deep = tall - TOP - BOTTOM;
    return {
      span, high, low, width, tall,
      x: (/** @type {number} */ seconds) => LEFT + wide * seconds / span,
      y: (/** @type {number} */ way) => TOP + deep * (high - way) / (high - low),
      at: (/** @type {Point} */ [x, y]) => [(x - LEFT) / wide * span, high - (y - TOP) / deep * (high - low)],
    };
  }

  /** Where the handles are [px]: of the peak, and of where it is still; none before a measure.
   * @type {() => Point[]} */
  handles() {
    const shown = this.shown;
    if (!this.#wanted || !shown || this.#refusal) return [];
    const { x, y, span } = this.#axes, [overshoot, settling] = this.#wanted, { errors, tick } = shown;
    const hasPeak = shown.numbers[RESPONSE.OVERSHOOT] > 0, peak = hasPeak ? tick * errors.indexOf(Math.min(...errors)) : 0.5 * settling;
    return [[x(Math.min(peak, 0.9 * span)), y(1 + overshoot)], [x(Math.min(settling, span)), y(1)]];
  }

  /** @type {(event: PointerEvent) => void} */
  #press(event) {
    const away = this.handles().map(([x, y]) => Math.hypot(x - event.offsetX, y - event.offsetY));
    if (!away.length) return;
    event.preventDefault();
    this.chart.setPointerCapture(event.pointerId);
    this.#held = away[0] < away[1] ? 0 : 1;
  }

  /** @type {(event: PointerEvent) => void} */
  #drag(event) {
    if (this.#held < 0 || !this.#wanted) return;
    const [seconds, way] = this.#axes.at([event.offsetX, event.offsetY]), [overshoot, settling] = this.#wanted;
    if (this.#held === 0) this.#want(Number((way - 1).toFixed(3)), settling);
    else this.#want(overshoot, Number(Math.min(seconds, MOST_SECONDS).toFixed(3)));
  }

  #letGo() {
    if (this.#held < 0) return;
    this.#held = -1;
    this.#seek();
  }

  #draw() {
    const { chart } = this, ratio = devicePixelRatio || 1, axes = this.#axes, { x, y, width, tall, span, low, high } = axes;
    if (!width) return;
    chart.width = width * ratio;
    chart.height = tall * ratio;
    const context = contextOf(chart), style = getComputedStyle(chart);
    /** @type {(name: string) => string} */
    const tone = (name) => style.getPropertyValue(name);
    context.scale(ratio, ratio);
    context.font = '11px system-ui, sans-serif';
    context.fillStyle = tone('--muted');
    context.strokeStyle = tone('--line');
    // Within this band it is still.
    context.globalAlpha = 0.25;
    context.fillRect(LEFT, y(1 + RESPONSE.SETTLED), width - LEFT - RIGHT, y(1 - RESPONSE.SETTLED) - y(1 + RESPONSE.SETTLED));
    context.globalAlpha = 1;
    context.textAlign = 'right';
    for (const way of [0, 1]) {
      line(context, [[x(0), y(way)], [x(span), y(way)]]);
      context.fillText(`${100 * way} %`, LEFT - 5, y(way) + 4);
    }
    context.textAlign = 'center';
    const step = roundStep(span / 4);
    for (let at = 0; at <= span; at += step) context.fillText(`${short(at)} s`, Math.min(x(at), width - RIGHT), tall - 5);
    context.save();
    context.rect(LEFT, y(high), width - LEFT - RIGHT, y(low) - y(high));
    context.clip();
    for (const [feel, name] of /** @type {[Feel | null, string][]} */ ([[this.#feel, this.#found ? '--muted' : '--accent'], [this.#found, '--accent']])) {
      if (!feel) continue;
      context.strokeStyle = tone(name);
      context.lineWidth = 2;
      line(context, Array.from(feel.errors, (error, k) => [x(k * feel.tick), y(1 - error)]));
    }
    context.restore();
    for (const [left, top] of this.handles()) {
      context.beginPath();
      context.arc(left, top, HANDLE, 0, 7);
      context.fillStyle = tone('--accent');
      context.strokeStyle = tone('--surface');
      context.lineWidth = 2;
      context.fill();
      context.stroke();
    }
  }
}

/** The next of 1, 2 and 5, times a power of ten.
 * @type {(value: number) => number} */
function roundStep(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * ([1, 2, 5].find((each) => each * power >= value) ?? 10);
}

/** @type {(context: CanvasRenderingContext2D, points: Point[]) => void} */
function line(context, points) {
  context.beginPath();
  for (const point of points) context.lineTo(...point);
  context.stroke();
}

/** @type {(feel: Feel) => Point} */
const askedOf = ({ numbers }) => [numbers[RESPONSE.OVERSHOOT], numbers[RESPONSE.SETTLING]];

/** The readings of a card, in the order of READINGS.
 * @type {(feel: Feel) => string[]} */
function readingsOf({ numbers }) {
  const hz = numbers[RESPONSE.FREQUENCY], isSeen = Number.isFinite(hz);
  return [isSeen ? `${short(hz)} Hz` : 'quicker than a tick', isSeen ? short(numbers[RESPONSE.RATIO]) : DASH,
    String(numbers[RESPONSE.SWINGS]), `${short(100 * numbers[RESPONSE.DIFFERENCE])} %`];
}

/** @type {(error: unknown) => string} */
function told(error) {
  if (!(error instanceof Refusal)) throw error;
  return error.message[0].toUpperCase() + error.message.slice(1);
}
