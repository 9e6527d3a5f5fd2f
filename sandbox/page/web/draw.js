// Picture: draws a scene as its world is now, on a canvas. It reads and never writes.
import { Camera } from './camera.js';
import { ball, boxOf, canvasOf, castShadow, clamp, contextOf, disc, drawBar, drawMuscle, drawTurf, fillParts,
  fillSkin, glow, grown, keepPictures, layGrain, linesOf, makeSkin, mixed, outlineOf, partsOf, pathOf, radial, stroke,
} from './paint.js';
import { COLOURS, FACES, LINES, SHAPES, STRAIN, WHEELS } from './shared.js';
import { thingsOf, unfolded } from './things.js';
import { drawTread } from './treads.js';
import { Water } from './water.js';
import { drawWorn, Forms, unpacked, upright } from './worn.js';
/** @import { StateArrays } from './tables.js' */
/**
 * @import { Ball, Bars, Box, Face, FilledBody, LinePiece, Point, Scene, Shape, Sheet, Splat, Strand, Theme, Things,
 *   Wheel, Working } from './types.js'
 */
/** @import { World } from './world.js' */

const { USUAL_PERIOD, MOST_OF_STEP, LEAST, LEAST_BEND: BENT, PLANKS } = LINES, BAR_PERIOD = 8;
/** Of strands by their kinds.
 * @type {Record<string, number | undefined>} */
const HALVES = LINES.HALF;
/** @type {Record<string, number | undefined>} */
const PERIODS = LINES.PERIOD;
const { FLUSH_FROM, FLUSH_RANGE, LEAST_FLUSH } = STRAIN;
/** @type {Record<string, [rim: string, tone: string]>} */
const BOLTS = { bone: ['#4a3a28', '#fff4de'], brass: ['#3a2a10', '#f2ce7c'], wood: ['#3a2614', '#d8a970'] };
// How much of a shade is seen.
const SHADE = 0.33;
const INK = '#2a1030', DARK = '#161b26', LARGEST_PIN = 0.1;

export class Picture {
  #canvas;
  #context;
  #whole;
  #scene;
  #world;
  #water;
  #worn;
  #forms = new Forms();
  /** @type {Things | null} */
  #things = null;
  /** @type {Uint8Array[]} */
  #there = [];
  #backdrop = canvasOf(1, 1);
  #backdropKey = '';
  camera = new Camera();
  // Of the present picture: pixels of the screen to one of the page, and how large what has a size in pixels is.
  ratio = 1;
  // The largest ratio, where the screen has more.
  sharpest = 2;
  scale = 1;
  seconds = 0;
  /** Where particles are [pixels].
   * @type {Float64Array} */
  at = new Float64Array();
  /** Rest lengths [m] and strain of springs.
   * @type {Float64Array} */
  rest = new Float64Array();
  /** @type {Float64Array} */
  strain = new Float64Array();

  /** changed: called when there is more to see of the same world.
   * @param {HTMLCanvasElement} canvas @param {Scene} scene @param {World} world @param {() => void} [changed] */
  constructor(canvas, scene, world, changed = () => {}) {
    this.#canvas = canvas;
    this.#context = contextOf(canvas);
    this.theme = scene.themes.dark;
    this.#whole = scene;
    this.#scene = unfolded(scene, world);
    keepPictures(scene.pictures);
    this.#worn = unpacked(scene.worn, changed);
    this.#forms.note(this.#scene.bodies, world.view('state.origin'));
    this.#world = world;
    this.#water = new Water(scene, world);
  }

  /** @template {keyof StateArrays} N @param {N} name */
  #state(name) {
    return this.#world.view(`state.${name}`);
  }

  /** Lay out everything as it is at a time; what there is, and the size of the picture [pixels].
   * @type {(camera: Camera, theme: Theme, previous: Float64Array, part: number, seconds: number) =>
   *   [things: Things, size: [number, number]]} */
  #laid(camera, theme, previous, part, seconds) {
    const { width, height } = camera, ratio = Math.min(devicePixelRatio || 1, this.sharpest), canvas = this.#canvas;
    /** @type {[number, number]} */
    const size = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    const scale = clamp(Math.min(width / 1280, height / 720), 0.6, 1);
    [this.camera, this.theme, this.seconds, this.ratio, this.scale] = [camera, theme, seconds, ratio, scale];
    this.#place(previous, part);
    const there = [this.#state('spring_active'), this.#state('particle_active')];
    let things = this.#things;
    if (!things || there.some((array, n) => array.length !== this.#there[n].length || array.some((value, k) => value !== this.#there[n][k]))) {
      this.#there = there.map((array) => array.slice());
      this.#scene = unfolded(this.#whole, this.#world);
      this.#forms.note(this.#scene.bodies, this.#state('origin'));
      things = this.#things = thingsOf(this.#scene, this.#world, this.#there[0], this.#there[1]);
    }
    things.shapes.forEach((shape) => this.#trace(shape));
    things.lines.forEach((line) => this.#follow(line));
    return [things, size];
  }

  /** Draw only where things are, in one colour, over what is drawn.
   * @type {(camera: Camera, theme: Theme, previous: Float64Array, part: number, seconds: number) => void} */
  shade(camera, theme, previous, part, seconds) {
    const [things, size] = this.#laid(camera, theme, previous, part, seconds), layer = this.#backdrop;
    // Which clears it.
    [layer.canvas.width, layer.canvas.height] = size;
    layer.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    layer.fillStyle = theme.accent;
    layer.lineCap = layer.lineJoin = 'round';
    this.#fillAll(layer, things, theme.accent);
    this.#context.globalAlpha = SHADE;
    this.#context.drawImage(layer.canvas, 0, 0, camera.width, camera.height);
    this.#context.globalAlpha = 1;
  }

  /** previous: positions a tick ago; part: how much of the way from them to the present ones, 0..1; behind: draws what is
   * behind things.
   * @type {(camera: Camera, theme: Theme, previous: Float64Array, part: number, seconds: number, behind?: () => void) =>
   *   void} */
  draw(camera, theme, previous, part, seconds, behind = () => {}) {
    const [things, size] = this.#laid(camera, theme, previous, part, seconds), { shapes } = things;
    const context = this.#context, { ratio, scale } = this;
    shapes.filter((shape) => shape.layer < 2).forEach((shape) => makeSkin(shape, camera.width, camera.height));
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.#backdropNow(size), 0, 0);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    behind();
    this.#drawTreads(true);
    this.#castShadows(things);
    things.working.forEach((spring) => this.#drawWorking(spring));
    things.lines.forEach((line) => this.#drawLine(line));
    things.wheels.forEach((wheel) => this.#drawLugs(wheel));
    shapes.filter((shape) => shape.layer === 0).forEach((shape) => this.#drawShape(shape));
    things.sheets.forEach((sheet) => this.#drawSheet(sheet));
    things.wheels.forEach((wheel) => this.#drawWheel(wheel));
    things.worn.forEach((worn) => {
      if (!worn.texels.length) worn.texels = this.#forms.places(worn, this.#state('origin'));
      drawWorn(context, worn, this.#worn.get(worn.body.picture ?? ''), this.at, camera.zoom);
    });
    shapes.filter((shape) => shape.layer === 1).forEach((shape) => this.#drawShape(shape));
    things.balloons.forEach((body) => this.#drawGleams(body));
    things.faces.forEach((face, k) => this.#drawFace(face, k));
    this.#drawTreads(false);
    this.#drawBalls();
    this.#water.draw(context, camera, theme.name, scale, seconds, this.at, previous);
  }

  /** Where particles are in the picture, and the strain of springs.
   * @type {(previous: Float64Array, part: number) => void} */
  #place(previous, part) {
    const position = this.#state('position'), { camera } = this, count = position.length;
    const at = (this.at = new Float64Array(count));
    for (let k = 0; k < count; k += 2) {
      // What has just joined was nowhere.
      const from = k < previous.length ? previous : position;
      const x = from[k] + (position[k] - from[k]) * part;
      const y = from[k + 1] + (position[k + 1] - from[k + 1]) * part;
      [at[k], at[k + 1]] = camera.toPixels(x, y);
    }
    const a = this.#state('particle_a'), b = this.#state('particle_b');
    this.rest = this.#state('rest_length');
    this.strain = Float64Array.from(this.rest, (length, s) => {
      const dx = position[2 * a[s]] - position[2 * b[s]], dy = position[2 * a[s] + 1] - position[2 * b[s] + 1];
      return length > 0 ? Math.hypot(dx, dy) / length - 1 : 0;
    });
  }

  /** @type {(slots: number[]) => Float64Array} */
  #points(slots) {
    return Float64Array.from({ length: 2 * slots.length }, (_, k) => this.at[2 * slots[k >> 1] + (k & 1)]);
  }

  /** The outline, the skin and the strain of a shape as they are now.
   * @type {(shape: Shape) => void} */
  #trace(shape) {
    const { scale, camera: { zoom } } = this;
    const by = Math.min(shape.grown * zoom, SHAPES.MOST_GROWN * scale) + shape.extra * scale;
    const loops = shape.loops.map((loop) => grown(this.#points(loop), by)), box = boxOf(loops[0]);
    shape.path = pathOf(loops, shape.keep);
    shape.box = box;
    const wide = Math.sqrt((box[2] - box[0]) * (box[3] - box[1]));
    shape.depth = clamp(wide * shape.rounding, SHAPES.LEAST_ROUNDING * scale, SHAPES.MOST_ROUNDING * scale);
    shape.splats = this.#splats(shape);
    shape.reach = shape.cell * zoom;
  }

  /** How much strain shows, from -1 where it is squeezed to 1.
   * @type {(strain: number) => number} */
  #flushOf(strain) {
    return Math.sign(strain) * clamp((Math.abs(strain) - FLUSH_FROM) / FLUSH_RANGE);
  }

  /** The strain of each particle of a shape, the mean of that of its springs; nothing where little of it shows.
   * @type {(shape: Shape) => Splat[] | null} */
  #splats({ shows_strain: isShown, springs }) {
    if (!isShown) return null;
    /** @type {Map<number, [sum: number, count: number]>} */
    const sums = new Map();
    for (const [spring, ...ends] of springs) {
      for (const slot of ends) {
        const sum = sums.get(slot) ?? [0, 0];
        sums.set(slot, [sum[0] + this.strain[spring], sum[1] + 1]);
      }
    }
    const splats = Array.from(sums, ([slot, [sum, count]]) => /** @type {Splat} */ (
      [this.at[2 * slot], this.at[2 * slot + 1], this.#flushOf(sum / count)]));
    return splats.some(([, , amount]) => Math.abs(amount) > LEAST_FLUSH) ? splats : null;
  }

  /** The colour of strain over a line, and how much of it.
   * @type {(spring: number) => [colour: string, alpha: number] | null} */
  #tintOf = (spring) => {
    const flush = this.#flushOf(this.strain[spring]);
    return flush ? [this.theme.strain[flush > 0 ? 2 : 0], 0.7 * Math.abs(flush)] : null;
  };

  /** The pieces of a line, as drawBar() takes them, a path through them and half its width.
   * @type {(line: Strand | Bars) => void} */
  #follow(line) {
    const { at, rest, scale, camera: { zoom } } = this;
    if (line.particles) {
      const { particles, springs } = line;
      const step = rest[springs[springs.length >> 1]] * zoom, { kind } = line;
      line.half = Math.max(Math.min((HALVES[kind] ?? 0) * line.width * scale, MOST_OF_STEP * step), LEAST);
      line.pieces = this.#curve(particles, springs, zoom / ((PERIODS[kind] ?? USUAL_PERIOD) * line.half));
    } else {
      const { springs } = line, [part, least, most] = line.size, usual = line.cell ?? rest[springs[0]?.[0]] ?? 0;
      line.half = clamp(usual * zoom * part, least * scale, most * scale) * line.width;
      const up = (line.raised ?? 0) * line.half;
      line.pieces = springs.map(([spring, a, b]) => {
        /** @type {[number, number, number, number]} */
        const ends = [at[2 * a], at[2 * a + 1] - up, at[2 * b], at[2 * b + 1] - up];
        const length = Math.hypot(ends[2] - ends[0], ends[3] - ends[1]);
        return [...ends, 0, line.raised ? PLANKS : length / (BAR_PERIOD * line.half), line.raised ? -1 : spring];
      });
    }
    line.path = linesOf(line.pieces);
  }

  /** A smooth way through particles, in pieces; rate: periods of the texture in a metre.
   * @type {(particles: number[], springs: number[], rate: number) => LinePiece[]} */
  #curve(particles, springs, rate) {
    const last = particles.length - 1, isClosed = particles[0] === particles[last];
    /** @type {LinePiece[]} */
    const pieces = [];
    const p = particles.map((slot) => this.#points([slot]));
    /** @type {(end: Float64Array, inner: Float64Array, other: Float64Array) => Float64Array} */
    const beyond = (end, inner, other) => (isClosed ? other : end.map((value, i) => 2 * value - inner[i]));
    const way = [beyond(p[0], p[1], p[last - 1]), ...p, beyond(p[last], p[last - 1], p[1])];
    let along = 0;
    for (let k = 0; k < last; k++) {
      const [a, b, c, d] = way.slice(k, k + 4), length = this.rest[springs[k]] * rate;
      /** @type {(q: Float64Array, r: Float64Array, s: Float64Array) => boolean} */
      const bends = (q, r, s) => q.some((_, i) => Math.abs(q[i] - 2 * r[i] + s[i]) > BENT);
      const count = bends(a, b, c) || bends(b, c, d) ? 3 : 1;
      /** Catmull and Rom's curve.
       * @type {(t: number, i: number) => number} */
      const coordinate = (t, i) => b[i] + (t / 2) * (c[i] - a[i]
        + t * (2 * a[i] - 5 * b[i] + 4 * c[i] - d[i] + t * (3 * (b[i] - c[i]) + d[i] - a[i])));
      /** @type {(t: number) => Point} */
      const place = (t) => [coordinate(t, 0), coordinate(t, 1)];
      for (let n = 0; n < count; n++) {
        const [from, to] = [n / count, (n + 1) / count];
        pieces.push([...place(from), ...place(to), along + length * from, along + length * to, springs[k]]);
      }
      along += length;
    }
    return pieces;
  }

  /** @type {(things: Things) => void} */
  #castShadows(things) {
    const { theme, scale } = this;
    castShadow(this.#context, this.camera, theme, scale, (context) => this.#fillAll(context, things, theme.shadow));
  }

  /** Fill all that is there with a colour, which the context fills with already.
   * @type {(context: CanvasRenderingContext2D, things: Things, colour: string) => void} */
  #fillAll(context, { shapes, sheets, lines: bars, working }, colour) {
    shapes.forEach((shape) => context.fill(shape.path, 'evenodd'));
    sheets.filter((sheet) => sheet.isCloth).forEach(({ loops }) =>
      context.fill(pathOf(loops.map((loop) => this.#points(loop)))));
    bars.forEach((bar) => stroke(context, bar.path, colour, bar.half + (bar.particles ? 0 : 1)));
    working.forEach(({ ends }) => stroke(context, linesOf([this.#points(ends)]), colour, 3 * this.scale));
    this.#eachBall((slot, x, y, radius) => disc(context, x, y, radius, colour));
  }

  /** Stage and ground, kept while the camera stands still.
   * @type {(size: [number, number]) => HTMLCanvasElement} */
  #backdropNow(size) {
    const { camera, theme, ratio } = this, { width, height } = camera, context = this.#backdrop;
    const key = [camera.x, camera.y, camera.zoom, width, height, theme.name, ratio].join();
    if (key === this.#backdropKey) return context.canvas;
    this.#backdropKey = key;
    [context.canvas.width, context.canvas.height] = size;
    context.scale(ratio, ratio);
    const fade = context.createLinearGradient(0, 0, 0, height);
    theme.stage.forEach((colour, k) => fade.addColorStop(k, colour));
    context.fillStyle = fade;
    context.fillRect(0, 0, width, height);
    /** A lamp behind the stage, which is darker towards the corners.
     * @type {(tone: (away: number) => string) => [number, string][]} */
    const stops = (tone) => Array.from({ length: 17 }, (_, k) => [k / 16, tone(k / 10)]);
    const rim = /** @type {[number, number, number]} */ ([0, 0, 1.6]);
    /** @type {(away: number) => string} */
    const lamp = (away) => mixed('#000000', theme.lamp, Math.max(1 - 1.25 * away, 0) ** 2);
    /** @type {(away: number) => string} */
    const dim = (away) => `rgb(0 0 0 / ${theme.vignette * clamp(away - 0.55, 0, 1.2) ** 1.6})`;
    context.save();
    context.translate(width / 2, 0.46 * height);
    context.scale(0.62 * width, 0.72 * height);
    context.globalCompositeOperation = 'lighter';
    radial(context, [0, 0], rim, stops(lamp));
    context.globalCompositeOperation = 'source-over';
    radial(context, [0, 0], rim, stops(dim));
    context.restore();
    this.#drawGround(context);
    return context.canvas;
  }

  /** @type {(context: CanvasRenderingContext2D) => void} */
  #drawGround(context) {
    const { theme, scale, camera } = this, { width, height } = camera, paler = { ...theme };
    const shapes = this.#scene.ground.map(({ kind, points, rounding = 0, grain, themes }) => {
      const way = points.map(([x, y]) => camera.toPixels(x, y)), corners = way.slice(1).flat();
      const pieces = way.slice(1).map((point, k) => /** @type {LinePiece} */ ([...way[k], ...point]));
      const depth = rounding * scale, path = pathOf([corners]), box = boxOf(corners), tones = themes?.[theme.name];
      return { kind, grain, pieces, path, skin: tones && { path, depth, box, ...tones } };
    });
    const solid = shapes.flatMap(({ kind, grain, skin }) => (skin ? [{ kind, grain, skin }] : []));
    paler.shadow_strength *= 0.7;
    castShadow(context, camera, paler, scale, (shadow) => {
      for (const { kind, skin } of solid) if (kind !== 'soil') shadow.fill(skin.path);
    });
    for (const { kind, grain, skin } of solid) {
      makeSkin(skin, width, height);
      fillSkin(context, skin);
      if (grain) layGrain(context, skin.path, grain, ...camera.toPixels(0, 0));
      stroke(context, skin.path, skin.line, 0.9 * scale, kind === 'glass' ? 0.5 : 0.9);
    }
    for (const { kind, pieces } of shapes) {
      if (kind === 'soil') drawTurf(context, pieces, theme, scale);
      if (kind === 'line') drawBar(context, pieces, linesOf(pieces), 2.4 * scale, 'steel', () => [theme.metal[0], 0.7]);
    }
  }

  /** Belts of the ground, or of bodies.
   * @type {(ofGround: boolean) => void} */
  #drawTreads(ofGround) {
    const active = this.#state('spring_active'), { camera, theme, scale, seconds } = this;
    for (const tread of this.#scene.treads.filter(({ points }) => !points !== ofGround)) {
      const way = tread.points?.map(([x, y]) => camera.toPixels(x, y))
        ?? (tread.slots ?? []).map((slot) => /** @type {Point} */ ([this.at[2 * slot], this.at[2 * slot + 1]]));
      drawTread(this.#context, tread, way, (spring) => !!active[spring], theme.tyre,
        [camera.width, camera.height], camera.zoom, scale, seconds);
    }
  }

  /** @type {(line: Strand | Bars) => void} */
  #drawLine(line) {
    const { half, kind } = line, context = this.#context, colour = line.particles ? '' : line.colour;
    drawBar(context, line.pieces, line.path, half, kind === 'paint' ? colour : kind, this.#tintOf);
    if (line.particles) return;
    const { bolts = [] } = line;
    if (!bolts.length || (line.cell ?? 0) * this.camera.zoom < LINES.BOLTS_FROM) return;
    const [rim, tone] = kind === 'paint' ? [outlineOf(colour), mixed(colour, '#ffffff', 0.24)]
      : BOLTS[kind] ?? [DARK, '#b9c4d8'];
    const sizes = line.isTruss ? [1.35, 1.05, 0.42] : [1.7, 1.25, 0.5];
    for (const slot of bolts) {
      const [x, y] = this.#points([slot]);
      sizes.forEach((size, k) => disc(context, x, y, size * half, k === 1 ? tone : rim, [0.85, 1, 0.8][k]));
    }
  }

  /** @type {(working: Working) => void} */
  #drawWorking({ kind, ends, spring, width }) {
    const { scale } = this, context = this.#context, rest = this.rest[spring] * this.camera.zoom;
    const [x, y, endX, endY] = this.#points(ends), dx = endX - x, dy = endY - y, length = Math.hypot(dx, dy) || 1;
    /** @type {(value: number, low: number, high: number) => number} */
    const size = (value, low, high) => clamp(value, low * scale, high * scale) * width;
    /** @type {(share: number, half: number, own: string) => void} */
    const bar = (share, half, own) => {
      /** @type {LinePiece} */
      const piece = [x, y, x + share * dx, y + share * dy];
      drawBar(context, [piece], linesOf([piece]), half, own);
    };
    if (kind === 'muscle') drawMuscle(context, [x, y, endX, endY], size((0.16 * rest * rest) / length, 2.5, 11));
    else if (kind === 'piston') {
      const half = size(0.07 * rest, 2, 4.5);
      bar(1, 0.5 * half, 'steel');
      bar(0.55, half, LINES.CYLINDER);
    } else {
      const wide = size(0.13 * rest, 2.5, 8) / length, points = Array.from({ length: 15 }, (_, k) => {
        const share = clamp(0.12 + (0.76 * (k - 1)) / 12), side = k < 2 || k > 12 ? 0 : k % 2 ? -wide : wide;
        const along = k % 14 ? share : k / 14;
        return /** @type {Point} */ ([x + dx * along - dy * side, y + dy * along + dx * side]);
      });
      const wire = points.slice(1).map((point, k) => /** @type {LinePiece} */ ([...points[k], ...point]));
      context.lineCap = context.lineJoin = 'round';
      stroke(context, linesOf(wire), DARK, 2.5 * scale, 0.75);
      ['#e8edf6', '#8e9ab2'].forEach((tone, odd) =>
        stroke(context, linesOf(wire.filter((_, k) => k % 2 === odd)), tone, 1.5 * scale));
    }
  }

  /** @type {(shape: Shape) => void} */
  #drawShape(shape) {
    fillSkin(this.#context, shape);
    if (shape.line) stroke(this.#context, shape.path, shape.line, SHAPES.LINE_HALF * this.scale);
  }

  /** Triangles of cloth, planks or stones: each is filled in the coordinates of its picture.
   * @type {(sheet: Sheet) => void} */
  #drawSheet(sheet) {
    const { body, isCloth } = sheet, context = this.#context;
    sheet.parts ??= partsOf(sheet.triangles, this.#texels(body, sheet.triangles, isCloth ? SHAPES.CLOTH_TEXELS
      : SHAPES.LAID_TEXELS));
    fillParts(context, `${body.skin} ${body.colour}`, sheet.parts, this.at);
    const hem = pathOf(sheet.loops.map((loop) => this.#points(loop)));
    const tone = isCloth ? outlineOf(body.colour) : mixed(body.colour, '#180a00', 0.66);
    stroke(context, hem, tone, (isCloth ? SHAPES.HEM_HALF : 2.2) * this.scale);
  }

  /** Where the corners of triangles of a body lie in its picture, so many texels to a cell.
   * @type {(body: FilledBody, triangles: number[][], texels: number) => number[][]} */
  #texels(body, triangles, texels) {
    const turned = upright(body, this.#state('origin')), by = texels / body.spacing;
    const [left, , , low] = boxOf(body.slots.flatMap(turned));
    return triangles.map((corners) => corners.flatMap(turned).map((value, k) => by * (value - (k % 2 ? low : left))));
  }

  /** How large a wheel is.
   * @type {(wheel: Pick<Wheel, 'hub' | 'outer'>) => number} */
  #sizeOf({ hub, outer }) {
    const [x, y, ...points] = this.#points([hub, ...outer]);
    return outer.reduce((sum, _, k) => sum + Math.hypot(points[2 * k] - x, points[2 * k + 1] - y), 0) / outer.length;
  }

  /** Lugs are dashes of a wide line under the tyre, two to a particle.
   * @type {(wheel: Wheel) => void} */
  #drawLugs(wheel) {
    const context = this.#context, size = this.#sizeOf(wheel), period = (Math.PI * size) / wheel.outer.length;
    if (!wheel.is_tyre || size < WHEELS.LUGS_FROM) return;
    const lug = Math.max(3, Math.min(0.11 * size, 0.4 * period));
    const high = WHEELS.LUG * size + wheel.radius * this.camera.zoom;
    context.lineCap = 'butt';
    context.setLineDash([lug, period - lug]);
    stroke(context, pathOf([this.#points(wheel.outer)]), this.theme.tyre, high);
    context.setLineDash([]);
  }

  /** @type {(wheel: Wheel) => void} */
  #drawWheel(wheel) {
    const context = this.#context, { scale } = this, { hub, inner, outer } = wheel, size = this.#sizeOf(wheel);
    /** @type {(pieces: LinePiece[], half: number) => void} */
    const bar = (pieces, half) => drawBar(context, pieces, linesOf(pieces), half, 'steel');
    const [x, y, firstX, firstY] = this.#points([hub, outer[0]]), radius = clamp(0.15 * size, 2.5, 22 * scale);
    if (wheel.is_tyre && size > WHEELS.RIM_FROM) {
      bar(this.#curve([...inner, inner[0]], [], 0), Math.max(1.6, 0.045 * size));
    }
    bar(wheel.spokes.map((slot) => [x, y, this.at[2 * slot], this.at[2 * slot + 1]]),
      clamp(0.034 * size, 1.2, 4 * scale));
    disc(context, x, y, radius + 0.8 * scale, DARK, 0.8);
    ball(context, x, y, radius, -Math.atan2(firstY - y, firstX - x), 'steel', '#aeb9cc');
  }

  /** Gleams of a balloon that stay where the light is, and a knot where something is tied.
   * @type {(balloon: Things['balloons'][number]) => void} */
  #drawGleams({ slots, knots, colour }) {
    const [left, top, right, low] = boxOf(this.#points(slots)), context = this.#context;
    /** @type {LinePiece[]} */
    const tips = [];
    const x = (left + right) / 2, y = (top + low) / 2, radius = (right - left + low - top) / 4;
    for (const [across, down, size, alpha] of [[-0.34, -0.42, 0.46, 0.45], [-0.42, -0.44, 0.17, 0.85],
      [-0.2, -0.56, 0.09, 0.8], [0.34, 0.5, 0.4, 0.16]]) {
      glow(context, x + radius * across, y + radius * down, radius * size, '#ffffff', alpha);
    }
    for (const slot of knots) {
      const [tieX, tieY] = this.#points([slot]), away = Math.hypot(tieX - x, tieY - y) || 1;
      const outX = (radius * (tieX - x)) / away, outY = (radius * (tieY - y)) / away;
      for (const by of [-0.07, 0, 0.07]) {
        tips.push([tieX, tieY, tieX + 0.15 * outX - by * outY, tieY + 0.15 * outY + by * outX]);
      }
    }
    context.lineCap = 'round';
    stroke(context, linesOf(tips), outlineOf(colour), Math.max(1.2, 0.03 * radius));
  }

  /** Eyes that look where it moves, cheeks, and a mouth that says how it feels.
   * @type {(face: Face, number: number) => void} */
  #drawFace(face, number) {
    const { slots, springs, angle } = face, { at, camera: { zoom } } = this;
    const count = slots.length, context = this.#context;
    const [spotX, spotY, room] = face.spot, size = Math.min(2 * room * zoom, FACES.LARGEST * this.scale);
    if (size < FACES.SMALLEST * this.scale) return;
    const origin = this.#state('origin'), velocity = this.#state('velocity');
    /** @type {(values: Float64Array, k: number) => number} */
    const middle = (values, k) => slots.reduce((sum, slot) => sum + values[2 * slot + k], 0) / count;
    const [x, y, u, v] = [middle(at, 0), middle(at, 1), middle(origin, 0), middle(origin, 1)];
    const right = middle(velocity, 0), down = -middle(velocity, 1), speed = Math.hypot(right, down);
    let cosine = 0, sine = 0;
    for (const slot of slots) {
      const ownX = origin[2 * slot] - u, ownY = v - origin[2 * slot + 1];
      const dx = at[2 * slot] - x, dy = at[2 * slot + 1] - y;
      cosine += ownX * dx + ownY * dy;
      sine += ownX * dy - ownY * dx;
    }
    const turn = Math.atan2(sine, cosine), beat = FACES.BLINK_EVERY + 0.77 * (number % 4);
    const load = springs.reduce((sum, [spring]) => sum + Math.abs(this.strain[spring]), 0) / springs.length;
    const isSqueezed = load > FACES.SQUEEZED;
    const isShut = !isSqueezed && (this.seconds + 1.7 * number) % beat > beat - FACES.BLINK;
    context.save();
    context.translate(x, y);
    context.rotate(turn);
    context.translate(spotX * zoom, -spotY * zoom);
    context.rotate(-angle);
    context.scale(size, size);
    // What is seen of a face turns with it, but for where it looks and where the light is.
    const back = angle - turn;
    /** @type {(across: number, below: number) => Point} */
    const seen = (across, below) => [across * Math.cos(back) - below * Math.sin(back),
      across * Math.sin(back) + below * Math.cos(back)];
    const wide = (0.05 * Math.min(1, 0.3 + speed / 4)) / (speed || 1);
    const gaze = speed <= 0.25 ? seen(0, 0.015) : seen(right * wide, down * wide), light = seen(-0.021, -0.028);
    /** @type {(way: string, half: number) => void} */
    const line = (way, half) => stroke(context, new Path2D(way), INK, Math.max(half, 0.9 / size));
    context.lineCap = context.lineJoin = 'round';
    for (const side of [-1, 1]) {
      const eye = 0.19 * side, level = -0.09, far = eye + side * 0.065, near = eye - side * 0.053;
      glow(context, 1.5 * eye, 0.075, 0.085, '#ff5a86', 0.45);
      if (isSqueezed) line(`M${far} -0.16L${near} -0.09L${far} -0.02`, 0.024);
      else if (isShut) line(`M${eye - 0.094} ${level}h0.188`, 0.021);
      else {
        disc(context, eye, level, 0.133, INK, 0.35);
        disc(context, eye, level, 0.118, '#ffffff');
        disc(context, eye + gaze[0], level + gaze[1], 0.067, INK);
        disc(context, eye + gaze[0] + light[0], level + gaze[1] + light[1], 0.024, '#ffffff', 0.95);
      }
    }
    const smile = 0.125 + 0.25 * (0.66 - Math.min(9 * load, 0.8));
    if (isSqueezed) line('M-0.125 0.125q0.042 -0.05 0.083 0t0.084 0t0.083 0', 0.02);
    else if (speed <= FACES.FAST) line(`M-0.125 0.125Q0 ${smile} 0.125 0.125`, 0.02);
    else {
      disc(context, 0, 0.145, 0.0725, INK);
      disc(context, 0, 0.17, 0.041, FACES.TONGUE);
    }
    context.restore();
  }

  /** Balls that are there: a small one that is held is a pin.
   * @type {(act: (slot: number, x: number, y: number, radius: number, ball: Ball, k: number) => void) => void} */
  #eachBall(act) {
    const active = this.#state('particle_active'), radius = this.#state('radius');
    const inverse = this.#state('inverse_mass');
    this.#scene.balls.forEach((one, k) => {
      if (!active[one.slot] || (inverse[one.slot] === 0 && radius[one.slot] <= LARGEST_PIN)) return;
      const size = Math.max(radius[one.slot] * this.camera.zoom, 2.5 * this.scale);
      act(one.slot, this.at[2 * one.slot], this.at[2 * one.slot + 1], size, one, k);
    });
  }

  // Balls, and a screw at each pin: of balls a smaller one, and none of a bumper.
  #drawBalls() {
    const angle = this.#state('angle'), inverse = this.#state('inverse_mass'), active = this.#state('particle_active');
    const context = this.#context, sizes = new Map();
    this.#eachBall((slot, x, y, radius, { kind, colour }, k) => {
      ball(context, x, y, radius, angle[slot], kind, colour ?? (kind === 'sand' ? COLOURS.SANDS[k % 4] : '#8d99b0'));
      sizes.set(slot, kind === 'bumper' ? 0 : 0.55);
    });
    inverse.forEach((value, slot) => {
      const size = this.scale * (sizes.get(slot) ?? 1);
      if (value !== 0 || !active[slot] || !size || this.#world.isCursor(slot)) return;
      const [x, y] = this.#points([slot]), slit = 2.5 * size;
      disc(context, x, y, 4.4 * size, '#141924', 0.9);
      disc(context, x, y, 3.5 * size, '#b4bcc9');
      stroke(context, linesOf([[x - slit, y - slit, x + slit, y + slit]]), '#4a5363', 0.6 * size);
    });
  }
}
