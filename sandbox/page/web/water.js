// Water: pools in front of what is in them, with waves and drops where something crosses the surface. Looks alone.
import { clamp, disc, linesOf, mixed, pathOf, stroke } from './paint.js';
import { WATER } from './shared.js';
/** @import { Camera } from './camera.js' */
/** @import { Drop, LinePiece, Point, Pool, Scene, Tones } from './types.js' */
/** @import { World } from './world.js' */

const { CLEAR, MURKY, DEEP, NEAR, SLOWEST, PER_SPEED, HIGHEST, LENGTH, PERIOD, FADE, MOST, STEP } = WATER;
const { LINE_HALF, LIGHT, STREAKS, STREAK, SPLASH, DROPS_A_SPEED, FASTEST_DROP, FALL, PLACES, DROP_LIFE } = WATER;
const { MOST_DROPS } = WATER, TURN = 2 * Math.PI;

/** Numbers that look thrown about, 0..1, the same each time.
 * @type {(k: number) => number} */
const chance = (k) => ((Math.sin(12.99 * k) * 43758.55) % 1 + 1) % 1;

/** A colour with an opacity, 0..1.
 * @type {(colour: string, alpha: number) => string} */
const seen = (colour, alpha) => colour + Math.round(255 * alpha).toString(16).padStart(2, '0');

export class Water {
  #scene;
  #world;
  /** @type {Drop[]} */
  #drops = [];
  #time = -1;

  /** @param {Pick<Scene, 'water' | 'ground'>} scene @param {World} world */
  constructor(scene, world) {
    this.#scene = scene;
    this.#world = world;
  }

  /** Draw all of it; at: where particles are [pixels]; previous: positions a tick ago.
   * @type {(context: CanvasRenderingContext2D, camera: Camera, theme: 'dark' | 'light', scale: number, seconds: number,
   *   at: Float64Array, previous: Float64Array) => void} */
  draw(context, camera, theme, scale, seconds, at, previous) {
    if (!this.#scene.water.length) return;
    context.save();
    this.#leaveGroundOut(context, camera);
    for (const pool of this.#scene.water) {
      const tones = pool.tones[theme], heights = this.#surface(pool, camera, scale, seconds, at);
      this.#fill(context, pool, camera, tones, scale, heights);
      if (pool.flow.some(Boolean)) this.#drawStreaks(context, pool, camera, tones, scale, seconds);
    }
    context.restore();
    this.#see(previous, seconds);
    this.#drawDrops(context, camera, theme, scale, seconds);
  }

  /** Clip what is drawn to where no solid ground is.
   * @type {(context: CanvasRenderingContext2D, camera: Camera) => void} */
  #leaveGroundOut(context, camera) {
    const { width, height } = camera;
    for (const { points, themes } of this.#scene.ground) {
      if (!themes) continue;
      const way = pathOf([points.slice(1).flatMap(([x, y]) => camera.toPixels(x, y))]);
      way.rect(-1, -1, width + 2, height + 2);
      context.clip(way, 'evenodd');
    }
  }

  /** The surface of a pool, from left to right [pixels].
   * @type {(pool: Pool, camera: Camera, scale: number, seconds: number, at: Float64Array) => Point[]} */
  #surface({ box: [left, , right, top] }, camera, scale, seconds, at) {
    const active = this.#world.view('state.particle_active'), inverse = this.#world.view('state.inverse_mass');
    const velocity = this.#world.view('state.velocity'), radius = this.#world.view('state.radius');
    /** @type {[high: number, x: number][]} */
    const found = [];
    inverse.forEach((value, p) => {
      if (!active[p] || !value) return;
      const speed = Math.abs(velocity[2 * p + 1]) + 0.5 * Math.abs(velocity[2 * p]);
      const [x, y] = camera.toWorld(at[2 * p], at[2 * p + 1]), off = Math.abs(y - top) - radius[p];
      if (speed > SLOWEST && off < NEAR && x > left && x < right) {
        found.push([Math.min(PER_SPEED * speed, HIGHEST) * (1 - Math.max(off, 0) / NEAR), x]);
      }
    });
    const makers = found.sort(([a], [b]) => b - a).slice(0, MOST);
    const [from, level] = camera.toPixels(left, top), [to] = camera.toPixels(right, top);
    const first = Math.max(from, -STEP), last = Math.min(to, camera.width + STEP);
    const count = makers.length ? Math.max(1, Math.ceil((last - first) / (STEP * scale))) : 1;
    return Array.from({ length: count + 1 }, (_, k) => {
      const column = first + ((last - first) * k) / count, [place] = camera.toWorld(column, 0);
      const wave = makers.reduce((sum, [high, x]) => {
        const away = Math.abs(place - x);
        return sum + high * Math.exp(-away / FADE) * Math.sin(TURN * (away / LENGTH - seconds / PERIOD));
      }, 0);
      return /** @type {Point} */ ([column, level - camera.zoom * HIGHEST * Math.tanh(wave / HIGHEST)]);
    });
  }

  /** @type {(context: CanvasRenderingContext2D, pool: Pool, camera: Camera, tones: Tones, scale: number,
   *   heights: Point[]) => void} */
  #fill(context, { box: [, bottom, , top] }, camera, { near, deep, foam }, scale, heights) {
    const [, level] = camera.toPixels(0, top), [, low] = camera.toPixels(0, Math.max(bottom, top - DEEP));
    const [, floor] = camera.toPixels(0, bottom), share = clamp((top - bottom) / DEEP);
    const [first, last] = [heights[0][0], heights[heights.length - 1][0]];
    const body = pathOf([[...heights.flat(), last, floor, first, floor]]);
    const fade = context.createLinearGradient(0, level, 0, low);
    fade.addColorStop(0, seen(near, CLEAR));
    fade.addColorStop(1, seen(mixed(near, deep, share), CLEAR + (MURKY - CLEAR) * share));
    context.fillStyle = fade;
    context.fill(body);
    // The light under the surface.
    const glow = context.createLinearGradient(0, level, 0, level + 3 * LIGHT * scale);
    [0, 1, 2, 3].forEach((k) => glow.addColorStop(k / 3, seen(foam, k < 3 ? 0.3 * Math.exp(-k) : 0)));
    context.fillStyle = glow;
    context.fill(body);
    const line = heights.slice(1).map((point, k) => /** @type {LinePiece} */ ([...heights[k], ...point]));
    context.lineCap = 'round';
    stroke(context, linesOf(line), foam, LINE_HALF * scale, 0.85);
  }

  /** @type {(context: CanvasRenderingContext2D, pool: Pool, camera: Camera, tones: Tones, scale: number,
   *   seconds: number) => void} */
  #drawStreaks(context, { box: [left, bottom, right, top], flow: [u, v] }, camera, { foam }, scale, seconds) {
    const width = right - left, height = Math.min(top - bottom, DEEP), speed = Math.hypot(u, v);
    /** @type {(value: number, size: number) => number} */
    const inside = (value, size) => ((value % size) + size) % size;
    for (let k = 0; k < STREAKS; k++) {
      const x = left + inside(width * ((0.618034 * k) % 1) + u * seconds, width);
      const y = top - 0.15 * height - 0.8 * inside(height * ((0.414214 * k) % 1) - v * seconds, height);
      const half = (0.5 * STREAK * (0.5 + 0.5 * ((0.7548776 * k) % 1))) / speed;
      const ends = [...camera.toPixels(x - half * u, y - half * v), ...camera.toPixels(x + half * u, y + half * v)];
      const alpha = 0.3 * clamp((4 * Math.min(x - left, right - x)) / width);
      stroke(context, linesOf([/** @type {LinePiece} */ (ends)]), foam, 1.2 * scale, alpha);
    }
  }

  /** Throw drops where something went through a surface in the last tick.
   * @type {(previous: Float64Array, seconds: number) => void} */
  #see(previous, seconds) {
    const { time } = this.#world, position = this.#world.view('state.position');
    if (time !== this.#time + 1 || previous.length !== position.length) {
      if (time !== this.#time) this.#drops = [];
      this.#time = time;
      return;
    }
    this.#time = time;
    const active = this.#world.view('state.particle_active'), velocity = this.#world.view('state.velocity');
    this.#scene.water.forEach(({ box: [left, , right, top] }, pool) => {
      /** @type {number[]} */
      const found = [];
      active.forEach((value, p) => {
        const x = position[2 * p], passed = (previous[2 * p + 1] > top) !== (position[2 * p + 1] > top);
        if (value && passed && x > left && x < right && Math.abs(velocity[2 * p + 1]) > SPLASH) found.push(p);
      });
      found.sort((a, b) => Math.abs(velocity[2 * b + 1]) - Math.abs(velocity[2 * a + 1]));
      for (const p of found.slice(0, PLACES)) {
        const fast = Math.min(Math.abs(velocity[2 * p + 1]), FASTEST_DROP);
        for (let k = 0; k < Math.floor(DROPS_A_SPEED * fast); k++) {
          const [side, up, age, size] = [1, 2, 3, 4].map((n) => chance(n + 7 * k + 31 * p + 131 * time));
          this.#drops.push({ x: position[2 * p] + 0.1 * (size - 0.5), y: top, u: 1.2 * (side - 0.5) * fast,
            v: (0.25 + 0.5 * up) * fast, born: seconds, life: DROP_LIFE[0] + (DROP_LIFE[1] - DROP_LIFE[0]) * age,
            size: 0.012 + 0.023 * size, pool });
        }
      }
    });
    this.#drops = this.#drops.slice(-MOST_DROPS);
  }

  /** @type {(context: CanvasRenderingContext2D, camera: Camera, theme: 'dark' | 'light', scale: number,
   *   seconds: number) => void} */
  #drawDrops(context, camera, theme, scale, seconds) {
    this.#drops = this.#drops.filter(({ born, life }) => seconds >= born && seconds < born + life);
    for (const { x, y, u, v, born, life, size, pool } of this.#drops) {
      const age = seconds - born, [right, down] = camera.toPixels(x + u * age, y + v * age - (FALL / 2) * age * age);
      const radius = clamp(size * camera.zoom, 1.2 * scale, 5 * scale), { foam } = this.#scene.water[pool].tones[theme];
      disc(context, right, down, radius, foam, Math.min(1, 2 * (1 - age / life)));
    }
  }
}
