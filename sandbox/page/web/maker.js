// Maker: what is drawn, pulled or dropped on the picture joins the world: a body inside an outline, a rope, a spring, a
// rod, a part.
import { Refusal } from './commands.js';
import { unused } from './kit.js';
import { bodyKit, movedKit } from './made.js';
import { MAKING, MESH } from './shared.js';
/** @import { Run } from './run.js' */
/** @import { Adding, AnyArray, Droppable, Mesh, NamedRecord, Point, Theme } from './types.js' */
/** @import { World } from './world.js' */

const { SEGMENTS, ROPE_MASS, ROPE_RADIUS, SHARE, PIN_RADIUS, PIN_SHARE, SKIN, THICKEST, HAND_TOLERANCE, TOO_SHORT,
  REFUSALS } = MAKING, MOST_POINTS = 400;

/** @typedef {{ place: Point, name: string | null }} End */

/** @type {(value: number) => number} */
const rounded = (value) => Number(value.toPrecision(6));
/** @type {(place: Point) => Point} */
const placed = ([x, y]) => [Math.round(x * 1000) / 1000, Math.round(y * 1000) / 1000];

/** The mesh of a stroke, with its spacing [m] and area [m^2]. numbers: its tolerance [m], the least area [m^2], and its
 * places [m]. Throws a Refusal.
 * @type {(world: World, numbers: number[]) => Mesh} */
export function filled(world, numbers) {
  const [code, words, floats] = world.calls.answer('fill_stroke', numbers);
  if (code) throw new Refusal(REFUSALS[code]);
  /** @type {(at: number, width: number, array: AnyArray) => any[]} */
  const rows = (at, width, array) => Array.from({ length: Number(words[at + 1]) }, (_, k) =>
    Array.from({ length: width }, (_, n) => Number(array[Number(words[at]) + width * k + n])));
  const [spacing, area] = floats.subarray(MESH.NUMBERS);
  return { spacing, area, particles: rows(MESH.PLACES, 2, floats), springs: rows(MESH.PAIRS, 2, words),
    triangles: rows(MESH.TRIANGLES, 3, words) };
}

export class Maker {
  /** @type {Point[]} */
  #stroke = [];
  /** @type {End | null} */
  #start = null;
  #count = 0;

  /** @param {Run} run @param {Adding} adding @param {(text: string) => void} say */
  constructor(run, adding, say) {
    this.run = run;
    this.adding = adding;
    this.say = say;
  }

  /** Whether a tool makes something.
   * @type {(tool: string) => boolean} */
  makes(tool) {
    return tool in this.adding.made.stuffs || ['rope', 'spring', 'rod'].includes(tool) || this.part(tool) !== undefined;
  }

  /** The part that a tool drops.
   * @type {(tool: string) => Droppable | undefined} */
  part(tool) {
    return [...this.adding.parts, ...this.adding.catalogue].find(({ id }) => id === tool);
  }

  get isAtWork() {
    return this.#stroke.length > 0;
  }

  /** particle: what lies at the point; null: nothing.
   * @type {(point: Point, particle: number | null) => void} */
  begin(point, particle) {
    this.#stroke = [point];
    this.#start = this.#end(point, particle);
  }

  /** @type {(point: Point, within: number) => void} */
  go(point, within) {
    const [x, y] = this.#stroke[this.#stroke.length - 1];
    const isFar = Math.hypot(point[0] - x, point[1] - y) > HAND_TOLERANCE * within;
    // Of what is long enough the end goes along.
    if (isFar) this.#stroke.splice(Math.min(this.#stroke.length, MOST_POINTS - 1), 1, point);
  }

  forget() {
    this.#stroke = [];
  }

  /** @type {(point: Point, particle: number | null) => End} */
  #end(point, particle) {
    const { world } = this.run;
    if (particle === null) return { place: placed(point), name: null };
    const [x, y] = world.view('state.position').subarray(2 * particle);
    return { place: [x, y], name: world.names.particle[particle] };
  }

  /** Make it: the tool's, of what was drawn until now. Whether it is there.
   * @type {(tool: string, point: Point, particle: number | null, within: number) => boolean} */
  end(tool, point, particle, within) {
    const stroke = this.#stroke, start = this.#start, part = this.part(tool);
    this.#stroke = [];
    try {
      const records = part ? this.#dropped(part, placed(point))
        : tool in this.adding.made.stuffs ? [this.#body(tool, [...stroke, point], within)]
        : this.#joined(tool, /** @type {End} */ (start), this.#end(point, particle), within);
      const gesture = this.run.newGesture();
      const { world } = this.run;
      for (const record of records) this.run.command(world.commands.read(record, world.counts), gesture);
      return true;
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      this.say(error.message);
      return false;
    }
  }

  /** @type {(stuff: string, stroke: Point[], within: number) => NamedRecord} */
  #body(stuff, stroke, within) {
    const numbers = [HAND_TOLERANCE * within, within * within, ...stroke.flat()];
    const { area, spacing, ...mesh } = filled(this.run.world, numbers);
    const { stiffness, damping, density, colours, more } = this.adding.made.stuffs[stuff], name = `drawn ${stuff}`;
    const mass = rounded((density * area) / mesh.particles.length);
    const look = { ...more.look, ...(colours.length ? { colour: colours[this.#count++ % colours.length] } : {}) };
    const radius = rounded(Math.min(SKIN * spacing, THICKEST));
    return { type: 'add_body', kit: bodyKit(this.adding, { ...mesh, ...more, mass, radius, material: name, stiffness, damping,
      look }) };
  }

  /** @type {(part: Droppable, point: Point) => NamedRecord[]} */
  #dropped({ records }, point) {
    return records.map((record) => {
      const { kit, position: [x, y] = [0, 0] } = record;
      return kit ? { ...record, kit: movedKit(kit, point) } : { ...record, position: [point[0] + x, point[1] + y] };
    });
  }

  /** @type {(tool: string, start: End, end: End, within: number) => NamedRecord[]} */
  #joined(tool, start, end, within) {
    const length = Math.hypot(end.place[0] - start.place[0], end.place[1] - start.place[1]);
    if (length < within || (start.name !== null && start.name === end.name)) throw new Refusal(TOO_SHORT);
    return tool === 'rope' ? this.#rope(start, end, length) : this.#bar(tool, start, end, length);
  }

  /** @type {(start: End, end: End, length: number) => NamedRecord[]} */
  #rope(start, end, length) {
    // Ends that are particles of the world are none of its own.
    const steps = Array.from({ length: SEGMENTS + 1 }, (_, k) => k).filter((k) =>
      (k > 0 || start.name === null) && (k < SEGMENTS || end.name === null));
    const particles = steps.map((k) => placed(/** @type {Point} */ ([0, 1].map((u) =>
      start.place[u] + ((end.place[u] - start.place[u]) * k) / SEGMENTS))));
    const { stiffness, damping } = this.adding.made.firmest, rest = rounded(length / SEGMENTS);
    const pinned = steps.flatMap((k, n) => (k === 0 || k === SEGMENTS ? [n] : []));
    const springs = steps.slice(1).map((_, k) => /** @type {[number, number]} */ ([k, k + 1]));
    const kit = bodyKit(this.adding, { particles, springs, triangles: [], pinned, stiffness, damping,
      mass: rounded((ROPE_MASS * length) / SEGMENTS), radius: rounded(Math.min(ROPE_RADIUS, SHARE * rest)),
      collides: this.adding.terrain, material: 'drawn rope', look: { line: 'rope' } });
    const own = this.#nextBody;
    const ties = [[start.name, `${own}.0`], [end.name, `${own}.${steps.length - 1}`]].filter(([name_]) => name_ !== null);
    return [{ type: 'add_body', kit }, ...ties.map(([a, b]) =>
      ({ type: 'add_spring', particle_a: a, particle_b: b, rest_length: rest, stiffness, damping }))];
  }

  /** @type {(tool: string, start: End, end: End, length: number) => NamedRecord[]} */
  #bar(tool, start, end, length) {
    const { stiffness, damping } = tool === 'rod' ? this.adding.made.firmest : this.adding.made.springy;
    /** @type {NamedRecord[]} */
    const pins = [];
    const ends = [start, end].map(({ place, name }) => {
      if (name !== null) return name;
      pins.push({ type: 'add_particle', position: place, radius: rounded(Math.min(PIN_RADIUS, PIN_SHARE * length)),
        pinned: true });
      return `+.${this.#nextPin + pins.length - 1}`;
    });
    return [...pins, { type: 'add_spring', particle_a: ends[0], particle_b: ends[1], stiffness, damping }];
  }

  /** @type {(form: RegExp) => number} */
  #next(form) {
    return unused(this.run.world.names.particle, form);
  }

  get #nextPin() {
    return this.#next(/^\+\.(\d+)$/);
  }

  get #nextBody() {
    return `+${this.run.world.bodyCount + 1}`;
  }

  /** What is drawn so far. toPixels: of places [m].
   * @type {(context: CanvasRenderingContext2D, tool: string, toPixels: (x: number, y: number) => Point, theme: Theme) =>
   *   void} */
  draw(context, tool, toPixels, theme) {
    if (!this.#stroke.length) return;
    const isBody = tool in this.adding.made.stuffs, last = this.#stroke[this.#stroke.length - 1], part = this.part(tool);
    /** @type {Point[][]} */
    const lines = part ? part.ghost.map((loop) => loop.map(([x, y]) => [x + last[0], y + last[1]]))
      : isBody ? [this.#stroke] : [[this.#start?.place ?? last, last]];
    context.strokeStyle = theme.accent;
    context.lineWidth = 2;
    context.setLineDash(isBody ? [] : [6, 5]);
    context.beginPath();
    for (const line of lines) line.forEach(([x, y], k) => context[k ? 'lineTo' : 'moveTo'](...toPixels(x, y)));
    context.stroke();
    context.setLineDash([]);
  }
}
