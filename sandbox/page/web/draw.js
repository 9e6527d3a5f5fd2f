// Picture: draws a scene as its world is now, on a canvas. It reads and never writes.
import { ball, darkEdge, disc, drawBar, fillGround, fillSkin, glow, grown, mixed, outlineOf, pathOf, sheetOf, stroke,
  turfOf } from './paint.js';
import { thingsOf, unfolded } from './things.js';

const HALF = { rope: 3.4, cable: 2.6, chain: 4.6, deck: 6, thread: 1.2, silk: 0.9 };
const ROUNDING = { balloon: 0.3, tyre: 0.16, wood: 0.05, stone: 0.07, brick: 0.07, window: 0.2 };
const SHADOW = 6, FLUSH_FROM = 0.03, FLUSH_RANGE = 0.22, SANDS = ['#f2c879', '#e3ae58', '#f7da9a', '#d99a4a'];
const BOLTS = { bone: ['#4a3a28', '#fff4de'], brass: ['#3a2a10', '#f2ce7c'], wood: ['#3a2614', '#d8a970'] };
const INK = '#2a1030', DARK = '#161b26', SMALLEST_FACE = 24;

export class Camera {
  constructor() {
    Object.assign(this, { x: 0, y: 0, zoom: 50, width: 1, height: 1 });
  }

  // Show a box [m] as large as it goes, above what covers `bottom` pixels of the lower edge.
  fit([left, low, right, high], bottom = 0) {
    const height = Math.max(this.height - bottom, 1);
    this.zoom = Math.min((this.width * 0.92) / Math.max(right - left, 0.5),
      (height * 0.88) / Math.max(high - low, 0.5));
    this.x = (left + right) / 2;
    this.y = (low + high) / 2 - bottom / 2 / this.zoom;
  }

  toWorld(x, y) {
    return [this.x + (x - this.width / 2) / this.zoom, this.y - (y - this.height / 2) / this.zoom];
  }

  toPixels(x, y) {
    return [this.width / 2 + (x - this.x) * this.zoom, this.height / 2 - (y - this.y) * this.zoom];
  }

  zoomAbout(x, y, factor) {
    const [heldX, heldY] = this.toWorld(x, y);
    this.zoom = Math.min(Math.max(this.zoom * factor, 0.5), 20000);
    const [nowX, nowY] = this.toWorld(x, y);
    this.x += heldX - nowX;
    this.y += heldY - nowY;
  }
}

// A box around points, with room for what is drawn beside them, as rect() takes it.
function boxOf(xs, ys, room = 60) {
  const left = Math.min(...xs) - room, top = Math.min(...ys) - room;
  return [left, top, Math.max(...xs) + room - left, Math.max(...ys) + room - top];
}

export class Picture {
  #canvas;
  #context;
  #scene;
  #world;
  #things = null;
  #active = new Uint8Array();
  #backdrop = document.createElement('canvas');
  #backdropKey = '';
  #shadow = document.createElement('canvas');

  constructor(canvas, scene, world) {
    this.#canvas = canvas;
    this.#context = canvas.getContext('2d');
    this.#scene = unfolded(scene, world);
    this.#world = world;
  }

  // previous: positions a tick ago; part: how much of the way from them to the present ones, 0..1.
  draw(camera, theme, previous, part, seconds) {
    const { width, height } = camera, ratio = Math.min(devicePixelRatio || 1, 2), context = this.#context;
    if (this.#canvas.width !== Math.round(width * ratio) || this.#canvas.height !== Math.round(height * ratio)) {
      this.#canvas.width = Math.round(width * ratio);
      this.#canvas.height = Math.round(height * ratio);
    }
    Object.assign(this, { camera, theme, seconds, ratio,
      scale: Math.min(1, Math.max(0.6, Math.min(width / 1280, height / 720))) });
    this.#place(previous, part);
    const active = this.#world.view('state.spring_active');
    if (!this.#things || active.some((value, k) => value !== this.#active[k])) {
      this.#active = active.slice();
      this.#things = thingsOf(this.#scene, this.#active);
    }
    const things = this.#things;
    things.shapes.forEach((shape) => this.#trace(shape));
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.#backdropNow(), 0, 0);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.#drawShadows(things);
    things.working.forEach((spring) => this.#drawWorking(spring));
    things.strands.forEach((strand) => this.#drawStrand(strand));
    things.bars.forEach((bars) => this.#drawBars(bars));
    things.wheels.forEach((wheel) => this.#drawLugs(wheel));
    things.shapes.filter((shape) => shape.layer === 0).forEach((shape) => this.#drawShape(shape));
    things.sheets.forEach((sheet) => this.#drawSheet(sheet));
    things.wheels.forEach((wheel) => this.#drawWheel(wheel));
    things.shapes.filter((shape) => shape.layer === 1).forEach((shape) => this.#drawShape(shape));
    things.balloons.forEach((body) => this.#drawGleams(body, things.degree));
    things.faces.forEach((body, k) => this.#drawFace(body, k));
    this.#drawBalls();
    this.#drawPins();
  }

  // Where particles are in the picture, and the strain of springs.
  #place(previous, part) {
    const position = this.#world.view('state.position'), { camera } = this, count = position.length;
    const at = (this.at = new Float64Array(count));
    for (let k = 0; k < count; k += 2) {
      const x = previous[k] + (position[k] - previous[k]) * part,
        y = previous[k + 1] + (position[k + 1] - previous[k + 1]) * part;
      [at[k], at[k + 1]] = camera.toPixels(x, y);
    }
    const a = this.#world.view('state.particle_a'), b = this.#world.view('state.particle_b');
    const rest = this.#world.view('state.rest_length');
    this.strain = Float64Array.from(rest, (length, s) => {
      const dx = position[2 * a[s]] - position[2 * b[s]], dy = position[2 * a[s] + 1] - position[2 * b[s] + 1];
      return length > 0 ? Math.hypot(dx, dy) / length - 1 : 0;
    });
  }

  #points(slots) {
    return Float64Array.from({ length: 2 * slots.length }, (_, k) => this.at[2 * slots[k >> 1] + (k & 1)]);
  }

  #trace(shape) {
    const by = Math.min(shape.grown * this.camera.zoom, 40) + shape.extra * this.scale;
    const loops = shape.loops.map((loop, k) =>
      grown(this.#points(loop), k && shape.skin !== 'tyre' ? -by : k ? -by : by));
    shape.path = pathOf(loops, shape.keep, shape.rounds);
    const xs = loops[0].filter((_, k) => k % 2 === 0), ys = loops[0].filter((_, k) => k % 2);
    const size = Math.sqrt((Math.max(...xs) - Math.min(...xs)) * (Math.max(...ys) - Math.min(...ys)));
    shape.size = size;
    shape.box = boxOf(xs, ys);
    shape.depth = Math.min(Math.max(size * (ROUNDING[shape.skin] ?? 0.17), 6 * this.scale), 34 * this.scale);
  }

  #drawShadows(things) {
    const { width, height } = this.camera, shadow = this.#shadow, context = shadow.getContext('2d');
    shadow.width = Math.ceil(width / SHADOW);
    shadow.height = Math.ceil(height / SHADOW);
    context.scale(1 / SHADOW, 1 / SHADOW);
    context.fillStyle = context.strokeStyle = this.theme.shadow;
    context.lineCap = context.lineJoin = 'round';
    things.shapes.forEach((shape) => context.fill(shape.path, 'evenodd'));
    things.sheets.filter((sheet) => sheet.isCloth).forEach(({ loops }) =>
      context.fill(pathOf(loops.map((loop) => this.#points(loop)))));
    const line = (ends, half) => stroke(context, this.#way(ends), this.theme.shadow, half);
    things.strands.forEach((strand) => line(strand.particles, this.#halfOf(strand)));
    things.bars.forEach((bars) =>
      stroke(context, this.#lines(bars.springs), this.theme.shadow, this.#halfOfBars(bars) + 1));
    things.working.forEach(({ ends }) => line(ends, 3 * this.scale));
    this.#eachBall((slot, x, y, radius) => disc(context, x, y, radius, this.theme.shadow));
    const main = this.#context;
    main.imageSmoothingQuality = 'high';
    main.globalAlpha = this.theme.shadow_strength;
    // Thrice, a little apart: the edge of a shadow is soft.
    const offset = [4 * this.scale, 8 * this.scale];
    for (const [x, y] of [[-2, -1], [2, -1], [0, 2]]) {
      main.globalAlpha = 0.4 * this.theme.shadow_strength;
      main.drawImage(shadow, offset[0] + x, offset[1] + y, shadow.width * SHADOW, shadow.height * SHADOW);
    }
    main.globalAlpha = 1;
  }

  // Stage and ground, kept while the camera stands still.
  #backdropNow() {
    const { camera, theme, ratio } = this, { width, height } = camera;
    const key = [camera.x, camera.y, camera.zoom, width, height, theme.name, ratio].join();
    if (key === this.#backdropKey) return this.#backdrop;
    this.#backdropKey = key;
    this.#backdrop.width = Math.round(width * ratio);
    this.#backdrop.height = Math.round(height * ratio);
    const context = this.#backdrop.getContext('2d');
    context.scale(ratio, ratio);
    const fade = context.createLinearGradient(0, 0, 0, height);
    theme.stage.forEach((colour, k) => fade.addColorStop(k, colour));
    context.fillStyle = fade;
    context.fillRect(0, 0, width, height);
    // A lamp behind the stage, which is darker towards the corners.
    const light = context.createRadialGradient(0, 0, 0, 0, 0, 1.6),
      dark = context.createRadialGradient(0, 0, 0, 0, 0, 1.6);
    for (let k = 0; k <= 16; k++) {
      const away = k / 10, lit = Math.max(1 - 1.25 * away, 0) ** 2,
        dim = theme.vignette * Math.min(Math.max(away - 0.55, 0), 1.2) ** 1.6;
      light.addColorStop(k / 16, mixed('#000000', theme.lamp, lit));
      dark.addColorStop(k / 16, `rgb(0 0 0 / ${dim})`);
    }
    context.save();
    context.translate(width / 2, 0.46 * height);
    context.scale(0.62 * width, 0.72 * height);
    for (const [fill, how] of [[light, 'lighter'], [dark, 'source-over']]) {
      context.globalCompositeOperation = how;
      context.fillStyle = fill;
      context.fillRect(-1, -1, 2, 2);
    }
    context.restore();
    this.#drawGround(context);
    return this.#backdrop;
  }

  #drawGround(context) {
    const { theme, scale, camera } = this, view = (name) => this.#world.view(`state.terrain.${name}`);
    const vertex = view('vertex'), first = view('edge_a'), second = view('edge_b'), solid = view('solid'),
      chains = new Map();
    const point = (slot) => camera.toPixels(vertex[2 * Number(slot)], vertex[2 * Number(slot) + 1]);
    view('chain').forEach((chain, edge) => {
      if (!chains.has(chain)) chains.set(chain, { points: [], edges: [], isSolid: Boolean(solid[edge]) });
      chains.get(chain).points.push(...point(first[edge]));
      chains.get(chain).edges.push([point(first[edge]), point(second[edge])]);
    });
    [...chains.values()].forEach(({ points, edges, isSolid }, k) => {
      const area = edges.reduce((sum, [a, b]) => sum + a[0] * b[1] - b[0] * a[1], 0), kind = this.#scene.ground[k];
      if (!isSolid || area > 0) {
        const way = new Path2D();
        edges.forEach(([a, b]) => {
          way.moveTo(...a);
          way.lineTo(...b);
        });
        drawBar(context, way, 2.4 * scale, '', theme.metal[0]);
        return;
      }
      const path = pathOf([points]), metal = [0.25, 0.55].map((share) => mixed(...theme.metal, share));
      const [near, deep, light, dark, alpha] = {
        soil: [...theme.soil, 0.1, 0.25, 1], rock: [...theme.rock, 0.25, 0.35, 1],
          wood: ['#c28e57', '#9a6c40', 0.3, 0.4, 1],
        glass: ['#d4eefa', '#8cc4e6', 0.6, 0.3, 0.42],
      }[kind] ?? [...metal, 0.45, 0.45, 1];
      const isEarth = ['soil', 'rock'].includes(kind), grain = isEarth ? 'earth' : kind === 'wood' ? 'wood' : null;
      fillGround(context, path, boxOf(points.filter((_, n) => n % 2 === 0), points.filter((_, n) => n % 2)), near, deep,
        (isEarth ? 26 : 9) * scale, light, dark, alpha, grain);
      stroke(context, path, mixed(kind === 'glass' ? '#6fa8c8' : deep, '#000000', 0.35), 0.9 * scale,
        kind === 'glass' ? 0.5 : 0.9);
      if (kind === 'soil') this.#layTurf(context, edges);
    });
  }

  // Turf on what faces up.
  #layTurf(context, edges) {
    const { scale, theme } = this;
    context.fillStyle = turfOf(context, theme.turf);
    let along = 0;
    for (const [a, b] of edges) {
      const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
      along += length;
      if ((a[0] - b[0]) / length <= 0.8) continue;
      context.save();
      context.translate(b[0], b[1] + 2 * scale);
      context.rotate(Math.atan2(a[1] - b[1], a[0] - b[0]));
      context.scale(0.72 * scale, scale);
      context.translate(along / (0.72 * scale), -12);
      context.fillRect(-along / (0.72 * scale), 0, length / (0.72 * scale), 24);
      context.restore();
    }
  }

  // A smooth way through particles; lines between the ends of springs.
  #way(slots) {
    const path = new Path2D(), p = this.#points(slots), last = slots.length - 1;
    path.moveTo(p[0], p[1]);
    if (last === 1) path.lineTo(p[2], p[3]);
    else {
      for (let k = 0; k < last; k++) {
        const [a, b, c, d] = [Math.max(k - 1, 0), k, k + 1, Math.min(k + 2, last)].map((i) => 2 * i);
        path.bezierCurveTo(
          p[b] + (p[c] - p[a]) / 6, p[b + 1] + (p[c + 1] - p[a + 1]) / 6,
          p[c] - (p[d] - p[b]) / 6, p[c + 1] - (p[d + 1] - p[b + 1]) / 6, p[c], p[c + 1],
        );
      }
    }
    return path;
  }

  #lines(springs, raised = 0) {
    const path = new Path2D(), { at } = this;
    for (const [, a, b] of springs) {
      path.moveTo(at[2 * a], at[2 * a + 1] - raised);
      path.lineTo(at[2 * b], at[2 * b + 1] - raised);
    }
    return path;
  }

  #halfOf({ kind, width, springs }) {
    const rest = this.#world.view('state.rest_length'), step = rest[springs[springs.length >> 1]] * this.camera.zoom;
    return Math.max(Math.min(HALF[kind] * width * this.scale, 0.45 * step), 0.55);
  }

  #halfOfBars({ size: [part, least, most], cell, springs, share }) {
    const usual = cell ?? this.#world.view('state.rest_length')[springs[0]?.[0]] ?? 0;
    return Math.min(most * this.scale, Math.max(least * this.scale, usual * this.camera.zoom * part)) * share;
  }

  #drawStrand(strand) {
    drawBar(this.#context, this.#way(strand.particles), this.#halfOf(strand), strand.kind, '#c89b62');
    const rows = strand.springs.map((spring, k) => [spring, strand.particles[k], strand.particles[k + 1]]);
    this.#flush(rows, this.#halfOf(strand));
  }

  #drawBars(bars) {
    const half = this.#halfOfBars(bars), context = this.#context;
    drawBar(context, this.#lines(bars.springs), half, bars.kind, bars.colour);
    this.#flush(bars.springs, half);
    if (bars.deck?.length) drawBar(context, this.#lines(bars.deck, 1.15 * half), 0.95 * half, 'deck');
    if (!bars.bolts.length || (bars.cell ?? 0) * this.camera.zoom < 9) return;
    const isTruss = bars.size[2] === 4.2, isPaint = bars.kind === 'paint';
    const [line, tone] = isPaint ? [outlineOf(bars.colour), mixed(bars.colour, '#ffffff', 0.24)]
      : BOLTS[bars.kind] ?? [DARK, '#b9c4d8'];
    const [rim, head, middle] = isTruss ? [1.35, 1.05, 0.42] : [1.7, 1.25, 0.5];
    for (const slot of bars.bolts) {
      const x = this.at[2 * slot], y = this.at[2 * slot + 1];
      disc(context, x, y, rim * half, line, 0.85);
      disc(context, x, y, head * half, tone);
      disc(context, x, y, middle * half, line, 0.8);
    }
  }

  // The colour of strain over lines: squeezed or stretched.
  #flush(springs, half) {
    for (const row of springs) {
      const strain = this.strain[row[0]], share = Math.min((Math.abs(strain) - FLUSH_FROM) / FLUSH_RANGE, 1);
      if (share > 0) stroke(this.#context, this.#lines([row]), this.theme.strain[strain > 0 ? 2 : 0], half,
        0.7 * share);
    }
  }

  #drawWorking({ kind, ends: [a, b], spring, width }) {
    const { at, scale } = this, context = this.#context,
      rest = this.#world.view('state.rest_length')[spring] * this.camera.zoom;
    const [x, y] = [at[2 * a], at[2 * a + 1]], dx = at[2 * b] - x, dy = at[2 * b + 1] - y,
      length = Math.hypot(dx, dy) || 1;
    const point = (share, side) => [x + dx * share - (dy / length) * side, y + dy * share + (dx / length) * side];
    const clamp = (value, low, high) => Math.min(Math.max(value, low * scale), high * scale) * width;
    if (kind === 'coil') {
      const wide = clamp(0.13 * rest, 2.5, 8), path = new Path2D();
      path.moveTo(x, y);
      for (let k = 0; k <= 12; k++) path.lineTo(...point(0.12 + (0.76 * k) / 12,
        k === 0 || k === 12 ? 0 : k % 2 ? wide : -wide));
      path.lineTo(...point(1, 0));
      context.lineCap = context.lineJoin = 'round';
      stroke(context, path, DARK, 2.5 * scale, 0.75);
      stroke(context, path, '#bcc5d4', 1.5 * scale);
    } else if (kind === 'muscle') {
      const belly = clamp((0.16 * rest * rest) / length, 2.5, 11), path = new Path2D();
      path.moveTo(x, y);
      path.quadraticCurveTo(...point(0.5, 2 * belly), ...point(1, 0));
      path.quadraticCurveTo(...point(0.5, -2 * belly), x, y);
      fillSkin(context, path, boxOf([x, x + dx], [y, y + dy], 2 * belly), 'rubber', '#de5462', belly);
      stroke(context, path, '#4a1622', 0.8 * scale);
    } else {
      const half = clamp(0.07 * rest, 2, 4.5), rod = new Path2D(), tube = new Path2D();
      rod.moveTo(x, y);
      rod.lineTo(...point(1, 0));
      tube.moveTo(x, y);
      tube.lineTo(...point(0.55, 0));
      drawBar(context, rod, 0.5 * half, 'steel');
      drawBar(context, tube, half, '', '#f6b83e');
    }
  }

  #drawShape(shape) {
    const context = this.#context;
    fillSkin(context, shape.path, shape.box, shape.skin, shape.colour, shape.depth, () => {
      if (!['jelly', 'rubber'].includes(shape.skin)) return;
      // A particle's strain is the mean of that of its springs.
      const sums = new Map();
      for (const [spring, ...ends] of shape.springs) {
        for (const slot of ends) {
          const sum = sums.get(slot) ?? [0, 0];
          sums.set(slot, [sum[0] + this.strain[spring], sum[1] + 1]);
        }
      }
      for (const [slot, [sum, count]] of sums) {
        const mean = sum / count, share = Math.min((Math.abs(mean) - FLUSH_FROM) / FLUSH_RANGE, 1);
        if (share < 0.02) continue;
        const reach = 2 * shape.reach * this.camera.zoom, colour = mean > 0 ? '#fff0b0' : '#4a3fd8';
        glow(context, this.at[2 * slot], this.at[2 * slot + 1], reach, colour, 0.7 * share);
      }
    });
    if (!['wood', 'stone', 'brick'].includes(shape.skin)) stroke(context, shape.path, outlineOf(shape.colour),
      0.75 * this.scale, 0.9);
  }

  // Triangles of cloth, planks or stones: each is filled in the coordinates of its picture.
  #drawSheet({ body, triangles, loops, isCloth }) {
    const context = this.#context, pattern = sheetOf(context, body.skin, body.colour),
      origin = this.#world.view('state.origin');
    const cosine = Math.cos(body.angle), sine = Math.sin(body.angle), texels = (isCloth ? 16 : 14) / body.spacing;
    const u = (slot) => origin[2 * slot] * cosine + origin[2 * slot + 1] * sine,
      v = (slot) => origin[2 * slot + 1] * cosine - origin[2 * slot] * sine;
    const left = Math.min(...body.slots.map(u)), low = Math.min(...body.slots.map(v));
    const texel = (slot) => [(u(slot) - left) * texels, (low - v(slot)) * texels];
    context.save();
    context.fillStyle = context.strokeStyle = pattern;
    for (const slots of triangles) {
      const [[u0, v0], [u1, v1], [u2, v2]] = slots.map(texel), p = this.#points(slots);
      const d = (u1 - u0) * (v2 - v0) - (u2 - u0) * (v1 - v0);
      const a = ((p[2] - p[0]) * (v2 - v0) - (p[4] - p[0]) * (v1 - v0)) / d,
        c = ((p[4] - p[0]) * (u1 - u0) - (p[2] - p[0]) * (u2 - u0)) / d;
      const b = ((p[3] - p[1]) * (v2 - v0) - (p[5] - p[1]) * (v1 - v0)) / d,
        e = ((p[5] - p[1]) * (u1 - u0) - (p[3] - p[1]) * (u2 - u0)) / d;
      context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
      context.transform(a, b, c, e, p[0] - a * u0 - c * v0, p[1] - b * u0 - e * v0);
      context.beginPath();
      context.moveTo(u0, v0);
      context.lineTo(u1, v1);
      context.lineTo(u2, v2);
      context.closePath();
      context.fill();
      context.lineWidth = 1;
      context.stroke();
    }
    context.restore();
    const hem = pathOf(loops.map((loop) => this.#points(loop)));
    stroke(context, hem, isCloth ? outlineOf(body.colour) : darkEdge(body.colour), (isCloth ? 1.5 : 2.2) * this.scale);
  }

  #sizeOf(wheel) {
    const [x, y] = [this.at[2 * wheel.hub], this.at[2 * wheel.hub + 1]];
    return wheel.outer.reduce((sum, slot) => sum + Math.hypot(this.at[2 * slot] - x, this.at[2 * slot + 1] - y),
      0) / wheel.outer.length;
  }

  #drawLugs(wheel) {
    const size = this.#sizeOf(wheel), [x, y] = this.#points([wheel.hub]), path = new Path2D(),
      feet = this.#points(wheel.outer);
    if (wheel.body.skin === 'steel wheel' || size < 22) return;
    for (let k = 0; k < feet.length; k += 2) {
      const next = (k + 2) % feet.length;
      for (const [fx, fy] of [[feet[k], feet[k + 1]],
        [(feet[k] + feet[next]) / 2, (feet[k + 1] + feet[next + 1]) / 2]]) {
        const out = (1.075 * size + wheel.body.radius * this.camera.zoom) / (Math.hypot(fx - x, fy - y) || 1);
        path.moveTo(fx, fy);
        path.lineTo(x + (fx - x) * out, y + (fy - y) * out);
      }
    }
    stroke(this.#context, path, this.theme.tyre, Math.max(1.5, Math.min(0.055 * size, (1.2 * size) / feet.length)));
  }

  #drawWheel(wheel) {
    const context = this.#context, size = this.#sizeOf(wheel), [x, y] = this.#points([wheel.hub]),
      isTyre = wheel.body.skin !== 'steel wheel';
    if (isTyre && size > 14) drawBar(context, pathOf([this.#points(wheel.inner)], 0.25, 2), Math.max(1.6, 0.045 * size),
      'steel');
    const spokes = new Path2D(), inner = this.#points(wheel.inner), step = wheel.body.segments >= 10 ? 4 : 2;
    for (let k = 0; k < inner.length; k += step) {
      spokes.moveTo(x, y);
      spokes.lineTo(inner[k], inner[k + 1]);
    }
    drawBar(context, spokes, Math.max(1.2, Math.min(0.034 * size, 4 * this.scale)), 'steel');
    const hub = Math.max(2.5, Math.min(0.15 * size, 22 * this.scale)),
      [firstX, firstY] = this.#points([wheel.outer[0]]);
    disc(context, x, y, hub + 0.8 * this.scale, DARK, 0.8);
    ball(context, x, y, hub, -Math.atan2(firstY - y, firstX - x), 'steel', '#aeb9cc');
  }

  #drawGleams(body, degree) {
    const points = this.#points(body.slots), context = this.#context, count = body.slots.length, mean = [0, 0];
    points.forEach((value, k) => { mean[k & 1] += value / count; });
    let radius = 0;
    for (let k = 0; k < count; k++) radius += Math.hypot(points[2 * k] - mean[0], points[2 * k + 1] - mean[1]) / count;
    for (const [x, y, size, alpha] of [[-0.34, -0.42, 0.46, 0.45], [-0.42, -0.44, 0.17, 0.85], [-0.2, -0.56, 0.09, 0.8],
      [0.34, 0.5, 0.4, 0.16]]) {
      glow(context, mean[0] + radius * x, mean[1] + radius * y, radius * size, '#ffffff', alpha);
    }
    // A knot where something is tied.
    const knots = new Path2D();
    for (const slot of body.slots.filter((each) => degree.get(each) > 2)) {
      const x = this.at[2 * slot], y = this.at[2 * slot + 1], away = Math.hypot(x - mean[0], y - mean[1]) || 1;
      const outX = ((x - mean[0]) / away) * radius, outY = ((y - mean[1]) / away) * radius;
      knots.moveTo(x, y);
      knots.lineTo(x + 0.15 * outX - 0.09 * outY, y + 0.15 * outY + 0.09 * outX);
      knots.lineTo(x + 0.15 * outX + 0.09 * outY, y + 0.15 * outY - 0.09 * outX);
      knots.closePath();
    }
    context.fillStyle = outlineOf(body.colour);
    context.fill(knots);
  }

  // Eyes that look where it moves, cheeks, and a mouth that says how it feels.
  #drawFace(body, number) {
    const [spotX, spotY, room] = body.face, size = Math.min(2 * room * this.camera.zoom, 120 * this.scale);
    if (size < SMALLEST_FACE * this.scale) return;
    const origin = this.#world.view('state.origin'), velocity = this.#world.view('state.velocity'), { slots } = body,
      { at } = this;
    const mean = { x: 0, y: 0, u: 0, v: 0, w: 0, z: 0 }, count = slots.length;
    for (const slot of slots) {
      mean.x += at[2 * slot] / count;
      mean.y += at[2 * slot + 1] / count;
      mean.u += origin[2 * slot] / count;
      mean.v += origin[2 * slot + 1] / count;
      mean.w += velocity[2 * slot] / count;
      mean.z -= velocity[2 * slot + 1] / count;
    }
    let cosine = 0, sine = 0, load = 0;
    for (const slot of slots) {
      const x = origin[2 * slot] - mean.u, y = mean.v - origin[2 * slot + 1], dx = at[2 * slot] - mean.x,
        dy = at[2 * slot + 1] - mean.y;
      cosine += x * dx + y * dy;
      sine += x * dy - y * dx;
    }
    const turn = Math.atan2(sine, cosine), springs = body.springs.length;
    for (const [spring] of body.springs) load += Math.abs(this.strain[spring]) / springs;
    const speed = Math.hypot(mean.w, mean.z), context = this.#context, zoom = this.camera.zoom,
      beat = 3.4 + 0.77 * (number % 4);
    const isSqueezed = load > 0.1, isShut = !isSqueezed && (this.seconds + 1.7 * number) % beat > beat - 0.13;
    context.save();
    context.translate(mean.x, mean.y);
    context.rotate(turn);
    context.translate(spotX * zoom, -spotY * zoom);
    context.rotate(-body.angle);
    context.scale(size, size);
    // What is seen of a face turns with it, but for where it looks and where the light is.
    const back = -(turn - body.angle),
      seen = (x, y) => [x * Math.cos(back) - y * Math.sin(back), x * Math.sin(back) + y * Math.cos(back)];
    const far = 0.42 * 0.118 * Math.min(1, 0.3 + speed / 4),
      gaze = speed <= 0.25 ? seen(0, 0.3 * 0.05) : seen((mean.w / speed) * far, (mean.z / speed) * far);
    const light = seen(-0.021, -0.028), least = 0.9 / size;
    const line = (path, half) => stroke(context, path, INK, Math.max(half, least));
    context.lineCap = context.lineJoin = 'round';
    for (const side of [-1, 1]) {
      const x = 0.19 * side, y = -0.09, lid = new Path2D();
      glow(context, 1.5 * x, 0.075, 0.085, '#ff5a86', 0.45);
      if (isSqueezed) {
        lid.moveTo(x + side * 0.065, y - 0.07);
        lid.lineTo(x - side * 0.053, y);
        lid.lineTo(x + side * 0.065, y + 0.07);
        line(lid, 0.024);
      } else if (isShut) {
        lid.moveTo(x - 0.094, y);
        lid.lineTo(x + 0.094, y);
        line(lid, 0.021);
      } else {
        disc(context, x, y, 0.133, INK, 0.35);
        disc(context, x, y, 0.118, '#ffffff');
        disc(context, x + gaze[0], y + gaze[1], 0.067, INK);
        disc(context, x + gaze[0] + light[0], y + gaze[1] + light[1], 0.024, '#ffffff', 0.95);
      }
    }
    if (speed > 2.5 && !isSqueezed) {
      disc(context, 0, 0.145, 0.0725, INK);
      disc(context, 0, 0.17, 0.041, '#f0708a');
    } else {
      const mouth = new Path2D(), smile = 0.125 * (0.66 - Math.min(9 * load, 0.8));
      for (let k = -4; k <= 4; k++) {
        const t = k / 4;
        mouth.lineTo(0.125 * t, 0.125 + (isSqueezed ? 0.0275 * Math.sin(3 * Math.PI * t) : smile * (1 - t * t)));
      }
      line(mouth, 0.02);
    }
    context.restore();
  }

  #eachBall(act) {
    const active = this.#world.view('state.particle_active'), radius = this.#world.view('state.radius'),
      inverse = this.#world.view('state.inverse_mass');
    this.#scene.balls.forEach((one, k) => {
      if (!active[one.slot] || (inverse[one.slot] === 0 && radius[one.slot] <= 0.1)) return;
      const size = Math.max(radius[one.slot] * this.camera.zoom, 2.5 * this.scale);
      act(one.slot, this.at[2 * one.slot], this.at[2 * one.slot + 1], size, one, k);
    });
  }

  #drawBalls() {
    const angle = this.#world.view('state.angle');
    this.#eachBall((slot, x, y, radius, { kind, colour }, k) => {
      ball(this.#context, x, y, radius, angle[slot], kind, colour ?? (kind === 'sand' ? SANDS[k % 4] : '#8d99b0'));
    });
  }

  // A pin is a screw.
  #drawPins() {
    const inverse = this.#world.view('state.inverse_mass'), active = this.#world.view('state.particle_active'),
      context = this.#context;
    const bumpers = new Set(this.#scene.balls.filter((one) => one.kind === 'bumper').map((one) => one.slot));
    const balls = new Set(this.#scene.balls.map((one) => one.slot)), hands = this.#world.hands;
    inverse.forEach((value, slot) => {
      if (value !== 0 || !active[slot] || bumpers.has(slot)
        || (slot >= hands.particle && slot < hands.particle + hands.count)) return;
      const k = this.scale * (balls.has(slot) ? 0.55 : 1), x = this.at[2 * slot], y = this.at[2 * slot + 1],
        slit = new Path2D();
      disc(context, x, y, 4.4 * k, '#141924', 0.9);
      disc(context, x, y, 3.5 * k, '#b4bcc9');
      slit.moveTo(x - 2.5 * k, y - 2.5 * k);
      slit.lineTo(x + 2.5 * k, y + 2.5 * k);
      stroke(context, slit, '#4a5363', 0.6 * k);
    });
  }
}
