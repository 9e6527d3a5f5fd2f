// Runs a flat level of the Spring Sandbox in plain JavaScript and prints where particles are.
//
// ```sh
// sandbox export walker --to flat -o walker.json
// node docs/examples/flat/read_flat.js walker.json 1 body.4        # for so many seconds, these particles; or all
// ```
//
// What differs: discs touch terrain alone; bends, motors, hydraulics and breaking are not there.
"use strict";

// Sweeps over the springs in a step: more make bodies stiffer.
const SWEEPS = 30;
// How fast discs leave what they are in [1/s].
const OUTWARD = 5;

class FlatLevel {
  constructor(level) {
    const parts = level.particles || [];
    this.level = level;
    this.h = 1 / (level.rate * level.steps);
    this.tick = 0;
    this.x = parts.map((part) => [...part.position]);
    this.v = parts.map((part) => [...(part.velocity || [0, 0])]);
    this.w = parts.map((part) => (part.pinned ? 0 : 1 / part.mass));
    this.springs = (level.springs || []).map((spring) => ({ ...spring }));
    this.edges = [];
    for (const piece of level.terrain || []) {
      const corners = piece.kind === "line" ? piece.corners : [...piece.corners, piece.corners[0]];
      for (let i = 1; i < corners.length; i++) this.edges.push([corners[i - 1], corners[i], piece]);
    }
  }

  advance() {
    this.drive();
    for (let step = 0; step < this.level.steps; step++) this.step();
    this.tick++;
  }

  drive() {
    for (const muscle of this.level.muscles || []) {
      let u = (this.tick % muscle.period) / muscle.period + muscle.phase;
      if (u >= 1) u -= 1;
      const wave = u < 0.5 ? 16 * u * (0.5 - u) : -16 * (u - 0.5) * (1 - u);
      const length = this.level.springs[muscle.spring].rest_length;
      this.springs[muscle.spring].rest_length = length * (1 + muscle.amplitude * wave);
    }
  }

  step() {
    const { x, v, w, h, level } = this, [wx, wy] = level.wind || [0, 0], drag = level.drag || 0;
    level.particles.forEach((part, p) => {
      if (w[p] === 0) return;
      const scale = part.gravity_scale === undefined ? 1 : part.gravity_scale, air = (drag * h) / (1 + drag * h);
      v[p][0] += level.gravity[0] * scale * h;
      v[p][1] += level.gravity[1] * scale * h;
      v[p][0] += air * (wx - v[p][0]);
      v[p][1] += air * (wy - v[p][1]);
    });
    // J = -K (u' + b), K = h (c + h k) and b = k x / (c + h k), as many springs agree on it after some sweeps.
    const rows = this.springs.map((s) => this.row(s)).filter((row) => row !== null);
    const touches = level.particles.flatMap((part, p) => this.touching(p, part, level.surfaces[part.surface]));
    for (let sweep = 0; sweep < SWEEPS; sweep++) {
      for (const row of rows) this.pull(row);
      for (const touch of touches) this.push(touch);
    }
    for (const area of level.areas || []) this.keepArea(area);
    x.forEach((place, p) => [0, 1].forEach((i) => (place[i] += v[p][i] * h)));
  }

  // Direction n, softness 1 / K and bias b of a spring in this step; a rod's softness is 0.
  row(s) {
    const { x, w, h } = this, weight = w[s.a] + w[s.b];
    const d = [x[s.b][0] - x[s.a][0], x[s.b][1] - x[s.a][1]], length = Math.hypot(...d);
    if (weight === 0 || length === 0) return null;
    // The step damps as k h by itself.
    const error = length - s.rest_length, c = Math.max(s.c - s.k * h, 0) + s.k * h;
    const n = [d[0] / length, d[1] / length], row = { a: s.a, b: s.b, n, j: 0 };
    if (s.rod) return { ...row, softness: 0, bias: error / h, response: weight };
    if (c === 0) return null;
    return { ...row, softness: 1 / (h * c), bias: (s.k * error) / c, response: weight + 1 / (h * c) };
  }

  pull(row) {
    const { v, w } = this, { a, b, n } = row;
    const u = n[0] * (v[b][0] - v[a][0]) + n[1] * (v[b][1] - v[a][1]);
    const j = -(u + row.bias + row.softness * row.j) / row.response;
    row.j += j;
    for (const i of [0, 1]) {
      v[a][i] -= j * n[i] * w[a];
      v[b][i] += j * n[i] * w[b];
    }
  }

  // The same equation for an area: J = -(Cs C / h + Cd dC/dt) m along its gradient, a tick's part of it each step.
  keepArea({ particles, area, Cs, Cd }) {
    const { x, v, w, h, level } = this, count = particles.length, slopes = [];
    let present = 0, rate = 0, weight = 0;
    particles.forEach((p, k) => {
      const before = x[particles[(k + count - 1) % count]], after = x[particles[(k + 1) % count]];
      const slope = [(after[1] - before[1]) / 2, (before[0] - after[0]) / 2];
      present += (x[p][0] * after[1] - x[p][1] * after[0]) / 2;
      rate += slope[0] * v[p][0] + slope[1] * v[p][1];
      weight += w[p] * (slope[0] ** 2 + slope[1] ** 2);
      slopes.push(slope);
    });
    if (weight === 0) return;
    const j = -((Cs / level.steps ** 2) * (present - area) / h + (Cd / level.steps) * rate) / weight;
    particles.forEach((p, k) => [0, 1].forEach((i) => (v[p][i] += j * slopes[k][i] * w[p])));
  }

  // Edges that a disc may reach in this step: direction out, gap, friction; what they have pushed and rubbed so far.
  touching(p, part, surface) {
    const { x, v, h } = this, found = [];
    if (this.w[p] === 0 || !surface.touches.includes(0)) return found;
    for (const [a, b, piece] of this.edges) {
      const along = [b[0] - a[0], b[1] - a[1]], from = [x[p][0] - a[0], x[p][1] - a[1]];
      const share = (along[0] * from[0] + along[1] * from[1]) / (along[0] ** 2 + along[1] ** 2);
      const t = Math.min(1, Math.max(0, share)), away = [from[0] - t * along[0], from[1] - t * along[1]];
      const distance = Math.hypot(...away), gap = distance - part.radius;
      if (distance === 0 || gap > 2 * h * (1 + Math.hypot(...v[p]))) continue;
      const friction = Math.sqrt(surface.friction * piece.friction);
      // What is inside comes out slowly.
      const speed = gap > 0 ? -gap / h : Math.min(-gap * OUTWARD, 1);
      found.push({ p, n: away.map((each) => each / distance), speed, friction, pushed: 0, rubbed: 0 });
    }
    return found;
  }

  push(touch) {
    const { v } = this, { p, n, speed, friction } = touch, tangent = [-n[1], n[0]];
    const pushed = Math.max(0, touch.pushed + speed - n[0] * v[p][0] - n[1] * v[p][1]), most = friction * pushed;
    const slide = tangent[0] * v[p][0] + tangent[1] * v[p][1];
    const rubbed = Math.min(most, Math.max(-most, touch.rubbed - slide));
    for (const i of [0, 1]) v[p][i] += (pushed - touch.pushed) * n[i] + (rubbed - touch.rubbed) * tangent[i];
    [touch.pushed, touch.rubbed] = [pushed, rubbed];
  }
}

module.exports = { FlatLevel };

if (require.main === module) {
  const [path, seconds = "1", ...wanted] = process.argv.slice(2);
  const level = JSON.parse(require("fs").readFileSync(path, "utf-8")), world = new FlatLevel(level);
  for (let tick = 0; tick < Math.round(Number(seconds) * level.rate); tick++) world.advance();
  const names = level.particles.map((part) => part.name);
  for (const name of wanted.length ? wanted : names) console.log(name, ...world.x[names.indexOf(name)]);
}
