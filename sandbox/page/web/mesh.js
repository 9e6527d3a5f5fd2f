// Mesh: an outline that was drawn, filled with particles and even triangles. What comes of it is written into a command
// whole, so that it need not be the mesh of another program.
import { Refusal } from './commands.js';
import { distance } from './pieces.js';
import { MAKING } from './shared.js';
/** @import { Point } from './types.js' */

const { PARTICLES, CROSSES, TOO_FINE } = MAKING, EPSILON = 1e-12, HALF = Math.sqrt(3) / 2;
// How often the spacing is made finer, and by what; how far places inside keep from the border, in spacings; and which part
// of an outline its triangles may leave.
const MOST_TRIES = 5, FINER = 0.8, INSIDE = 0.6, UNFILLED = 0.02;

/** @typedef {[a: number, b: number, c: number]} Triangle */
/** @typedef {{ particles: Point[], springs: [number, number][], triangles: Triangle[] }} Mesh */

/** @type {(one: Point, two: Point) => number} */
const apart = ([ax, ay], [bx, by]) => Math.hypot(bx - ax, by - ay);
/** @type {(a: Point, b: Point, c: Point) => number} */
const doubled = ([ax, ay], [bx, by], [cx, cy]) => (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
/** @type {(outline: Point[]) => number} */
export const areaOf = (outline) => outline.reduce((sum, [x, y], k) => {
  const [nextX, nextY] = outline[(k + 1) % outline.length];
  return sum + (x * nextY - nextX * y) / 2;
}, 0);

/** A line without the corners that change it by no more than a tolerance (Ramer 1972; Douglas and Peucker 1973).
 * @type {(line: Point[], tolerance: number) => Point[]} */
function simplified(line, tolerance) {
  if (line.length < 3) return line;
  const last = line[line.length - 1];
  let worst = 0, most = tolerance;
  for (let k = 1; k < line.length - 1; k++) {
    const off = distance(line[k], line[0], last);
    if (off > most) [worst, most] = [k, off];
  }
  if (!worst) return [line[0], last];
  return [...simplified(line.slice(0, worst + 1), tolerance), ...simplified(line.slice(worst), tolerance).slice(1)];
}

/** The outline of a closed stroke, counter-clockwise. Throws a Refusal where it crosses itself.
 * @type {(stroke: Point[], tolerance: number) => Point[]} */
export function outlineOf(stroke, tolerance) {
  const far = stroke.reduce((best, point, k) => (apart(point, stroke[0]) > apart(stroke[best], stroke[0]) ? k : best), 0);
  const there = simplified(stroke.slice(0, far + 1), tolerance);
  const back = simplified([...stroke.slice(far), stroke[0]], tolerance);
  const all = [...there, ...back.slice(1, -1)], outline = areaOf(all) < 0 ? all.reverse() : all;
  const sides = outline.map((a, k) => /** @type {[Point, Point]} */ ([a, outline[(k + 1) % outline.length]]));
  sides.forEach(([a, b], k) => sides.slice(k + 2).forEach(([c, d], n) => {
    const isBeside = k === 0 && n === sides.length - 3;
    const isCrossed = doubled(a, b, c) * doubled(a, b, d) <= 0 && doubled(c, d, a) * doubled(c, d, b) <= 0;
    if (!isBeside && isCrossed) throw new Refusal(CROSSES);
  }));
  return outline;
}

/** @type {(point: Point, outline: Point[]) => boolean} */
const isWithin = ([x, y], outline) => outline.reduce((is, [ax, ay], k) => {
  const [bx, by] = outline[(k + 1) % outline.length];
  return (ay > y) !== (by > y) && x < ax + ((bx - ax) * (y - ay)) / (by - ay) ? !is : is;
}, false);

/** Particles evenly along an outline, its corners among them.
 * @type {(outline: Point[], spacing: number) => Point[]} */
const along = (outline, spacing) => outline.flatMap((a, k) => {
  const b = outline[(k + 1) % outline.length], steps = Math.max(1, Math.round(apart(a, b) / spacing));
  return Array.from({ length: steps }, (_, n) => /** @type {Point} */ ([a[0] + ((b[0] - a[0]) * n) / steps,
    a[1] + ((b[1] - a[1]) * n) / steps]));
});

/** Places of a lattice of even triangles within an outline, none near its border.
 * @type {(border: Point[], outline: Point[], spacing: number) => Point[]} */
function within(border, outline, spacing) {
  const xs = outline.map(([x]) => x), ys = outline.map(([, y]) => y), rise = spacing * HALF;
  /** @type {Point[]} */
  const found = [];
  let row = 0;
  for (let y = Math.min(...ys) + rise / 2; y < Math.max(...ys); y += rise, row++) {
    for (let x = Math.min(...xs) + (row % 2 ? spacing / 2 : 0); x < Math.max(...xs); x += spacing) {
      const isClear = border.every((a, k) => distance([x, y], a, border[(k + 1) % border.length]) > INSIDE * spacing);
      if (isClear && isWithin([x, y], outline)) found.push([x, y]);
    }
  }
  return found;
}

/** Delaunay's triangles of places, counter-clockwise (Bowyer 1981; Watson 1981).
 * @type {(places: Point[]) => Triangle[]} */
function delaunay(places) {
  const xs = places.map(([x]) => x), ys = places.map(([, y]) => y), count = places.length;
  const x = Math.min(...xs), y = Math.min(...ys), size = 10 * Math.max(Math.max(...xs) - x, Math.max(...ys) - y, EPSILON);
  const all = [...places, ...(/** @type {Point[]} */ ([[x - size, y - size], [x + 2 * size, y - size], [x, y + 2 * size]]))];
  /** @type {Triangle[]} */
  let triangles = [[count, count + 1, count + 2]];
  places.forEach((place, k) => {
    const [cut, kept] = [true, false].map((is) => triangles.filter((each) => isAround(each.map((n) => all[n]), place) === is));
    const sides = new Map(cut.flatMap(([a, b, c]) => [[a, b], [b, c], [c, a]]).map((side) => [side.join(), side]));
    const border = [...sides.values()].filter(([a, b]) => !sides.has([b, a].join()));
    triangles = [...kept, ...border.map(([a, b]) => /** @type {Triangle} */ ([a, b, k]))];
  });
  return triangles.filter((each) => each.every((n) => n < count));
}

/** Whether the circle through the corners of a triangle holds a place.
 * @type {(corners: Point[], place: Point) => boolean} */
function isAround(corners, [x, y]) {
  const [[ax, ay], [bx, by], [cx, cy]] = corners.map(([px, py]) => [px - x, py - y]);
  const a = ax * ax + ay * ay, b = bx * bx + by * by, c = cx * cx + cy * cy;
  return ax * (by * c - b * cy) - ay * (bx * c - b * cx) + a * (bx * cy - by * cx) > EPSILON;
}

/** The mesh of an outline, of some thirty particles, at whole millimetres. Throws a Refusal.
 * @type {(outline: Point[]) => Mesh} */
export function meshed(outline) {
  const area = areaOf(outline);
  let spacing = Math.sqrt(area / PARTICLES);
  for (let tries = 0; tries < MOST_TRIES; tries++, spacing *= FINER) {
    const border = along(outline, spacing), inner = within(border, outline, spacing);
    const particles = [...border, ...inner].map((place) => /** @type {Point} */ (
      place.map((each) => Math.round(each * 1000) / 1000)));
    const triangles = delaunay(particles).filter((each) => {
      const corners = each.map((k) => particles[k]);
      return doubled(corners[0], corners[1], corners[2]) > EPSILON && isWithin(/** @type {Point} */ ([0, 1].map((u) =>
        (corners[0][u] + corners[1][u] + corners[2][u]) / 3)), outline);
    });
    const filled = triangles.reduce((sum, [a, b, c]) => sum + doubled(particles[a], particles[b], particles[c]) / 2, 0);
    const used = new Set(triangles.flat());
    if (Math.abs(filled - area) < UNFILLED * area && used.size === particles.length) {
      return { particles, springs: sidesOf(triangles), triangles };
    }
  }
  throw new Refusal(TOO_FINE);
}

/** @type {(triangles: Triangle[]) => [number, number][]} */
function sidesOf(triangles) {
  const sides = triangles.flatMap(([a, b, c]) => [[a, b], [b, c], [c, a]]);
  const keys = new Map(sides.map(([a, b]) => [Math.min(a, b) * 1e6 + Math.max(a, b), [Math.min(a, b), Math.max(a, b)]]));
  return [...keys].sort(([one], [other]) => one - other).map(([, side]) => /** @type {[number, number]} */ (side));
}
