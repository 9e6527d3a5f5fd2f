// Runs a flat level of the Spring Sandbox in plain JavaScript and prints where particles are.
//
//     node read_flat.js LEVEL.json [SECONDS [PARTICLE ...]]
//
// Made with: sandbox export LEVEL --to flat -o LEVEL.json
// What differs: discs touch terrain alone; bends, motors, hydraulics and breaking are not there.
"use strict";

// Sweeps over rods in a step: more make them stiffer.
const SWEEPS = 30;

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
    // Forces k x first, of the places before the step; then dampers one by one, which can never overshoot; rods last.
    for (const s of this.springs) if (!s.rod) this.pull(s, ([length]) => -s.k * (length - s.rest_length) * h);
    for (const s of this.springs)
      if (!s.rod) this.pull(s, ([, u, mass]) => -u * mass * (1 - Math.exp((-s.c * h) / mass)));
    for (const area of level.areas || []) this.keepArea(area);
    for (let sweep = 0; sweep < SWEEPS; sweep++)
      for (const s of this.springs)
        if (s.rod) this.pull(s, ([length, u, mass]) => -((length - s.rest_length) / h + u) * mass);
    level.particles.forEach((part, p) => {
      if (w[p] > 0) this.touch(p, part, level.surfaces[part.surface]);
      x[p][0] += v[p][0] * h;
      x[p][1] += v[p][1] * h;
    });
  }

  pull(s, impulse) {
    const { x, v, w } = this, weight = w[s.a] + w[s.b];
    const d = [x[s.b][0] - x[s.a][0], x[s.b][1] - x[s.a][1]], length = Math.hypot(...d);
    if (weight === 0 || length === 0) return;
    const n = [d[0] / length, d[1] / length];
    const u = n[0] * (v[s.b][0] - v[s.a][0]) + n[1] * (v[s.b][1] - v[s.a][1]);
    const j = impulse([length, u, 1 / weight]);
    for (const i of [0, 1]) {
      v[s.a][i] -= j * n[i] * w[s.a];
      v[s.b][i] += j * n[i] * w[s.b];
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

  // A disc that would be in an edge after the step stops there; friction takes what is along it, no more.
  touch(p, part, surface) {
    if (!surface.touches.includes(0)) return;
    const { x, v, h } = this;
    for (const [a, b, piece] of this.edges) {
      const along = [b[0] - a[0], b[1] - a[1]], from = [x[p][0] - a[0], x[p][1] - a[1]];
      const share = (along[0] * from[0] + along[1] * from[1]) / (along[0] ** 2 + along[1] ** 2);
      const t = Math.min(1, Math.max(0, share)), gap = [from[0] - t * along[0], from[1] - t * along[1]];
      const distance = Math.hypot(...gap);
      if (distance === 0) continue;
      const n = [gap[0] / distance, gap[1] / distance], u = n[0] * v[p][0] + n[1] * v[p][1];
      const push = Math.max(0, -u - Math.max(distance - part.radius, -0.01) / h);
      if (push === 0) continue;
      const tangent = [-n[1], n[0]], slide = tangent[0] * v[p][0] + tangent[1] * v[p][1];
      const most = push * Math.sqrt(surface.friction * piece.friction);
      const rub = Math.min(most, Math.max(-most, -slide));
      for (const i of [0, 1]) v[p][i] += push * n[i] + rub * tangent[i];
    }
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
