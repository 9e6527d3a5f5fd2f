// Made: kits of what is drawn on the page, and what people see of them, by their looks.
import { bordersOf, spotIn } from './pieces.js';
import { THINGS } from './shared.js';
/** @import { Adding, Joined, Kit, Made, MadeBody, Point, SceneBody, SkinLook } from './types.js' */

const { LAID } = THINGS, HEX = /^#[0-9a-fA-F]{6}$/, DARK = [40, 0, 60], SHARE = 0.46, GREY = '#8e99a8';

/** The line around something of a colour: its own hue, darker.
 * @type {(colour: string) => string} */
function outlineOf(colour) {
  const parts = [1, 3, 5].map((k, n) => {
    const own = parseInt(colour.slice(k, k + 2), 16);
    return Math.round(own + (DARK[n] - own) * SHARE).toString(16).padStart(2, '0');
  });
  return `#${parts.join('')}`;
}

/** @type {(values: number[]) => number} */
const median = (values) => [...values].sort((one, other) => one - other)[values.length >> 1] ?? 1;

/** The kit of one body that says each particle, spring and triangle.
 * @type {(adding: Adding, body: MadeBody) => Kit} */
export function bodyKit(adding, body) {
  const { particles, springs, triangles, mass, radius, material, stiffness, damping, pinned = [], friction, collides } = body;
  const { friction: usual, restitution, group, collides: touched } = adding.body;
  const own = new Set(pinned), given = { stiffness, damping };
  return {
    bodies: 1, materials: { name: [material] }, names: {},
    particles: { x: particles.map(([x]) => x), y: particles.map(([, y]) => y), mass, radius, body: 0, restitution, group,
      friction: friction ?? usual, collides: collides ?? touched, pinned: particles.map((_, k) => Number(own.has(k))) },
    springs: { a: springs.map(([a]) => a), b: springs.map(([, b]) => b), ...given, edge: edgesOf(springs, triangles, adding) },
    ...(triangles.length ? { constraints: { corners: triangles.map(() => 3), ...given },
      corners: { particle: triangles.flat() } } : {}),
    look: madeScene(body, adding.made),
  };
}

/** A kit whose particles lie elsewhere by a way [m], with the forms at rest of their corners.
 * @type {(kit: Kit, way: Point) => Kit} */
export function movedKit(kit, [dx, dy]) {
  /** @type {(values: any, by: number) => any} */
  const shifted = (values, by) => (Array.isArray(values) ? values.map((each) => shifted(each, by))
    : typeof values === 'number' ? values + by : values);
  /** @type {(columns: any) => Record<string, unknown>} */
  const moved = (columns) => ({ ...columns, x: shifted(columns.x, dx), y: shifted(columns.y, dy) });
  return { ...kit, particles: moved(kit.particles), ...(kit.corners ? { corners: moved(kit.corners) } : {}) };
}

/** Kinds of edge of springs: solid along one triangle, none along two, else a line.
 * @type {(springs: number[][], triangles: number[][], adding: Adding) => number[]} */
function edgesOf(springs, triangles, { edges, touches }) {
  if (!touches) return springs.map(() => edges.none);
  const sides = new Set(triangles.flatMap(([a, b, c]) => [`${a} ${b}`, `${b} ${c}`, `${c} ${a}`]));
  return springs.map(([a, b]) => {
    const left = sides.has(`${a} ${b}`), right = sides.has(`${b} ${a}`);
    return left && right ? edges.none : left ? edges.left : right ? edges.right : edges.line;
  });
}

/** What people see of it, in its own slots. made: what shapes of each skin are like.
 * @type {(body: MadeBody, made: Made) => Joined} */
function madeScene({ particles, springs, triangles, look, radius }, made) {
  const lengths = springs.map(([a, b]) => Math.hypot(particles[b][0] - particles[a][0],
    particles[b][1] - particles[a][1]));
  const cell = median(lengths), given = String(look.colour ?? ''), skin = String(look.skin ?? 'jelly');
  const colour = made.palette[given] ?? (HEX.test(given) ? given.toLowerCase() : GREY);
  const line = typeof look.line === 'string' ? look.line : triangles.length ? 'paint' : 'steel';
  /** @type {SceneBody} */
  const body = { type: 'mesh', skin, line, colour, width: 1, cell, angle: 0, slots: [[0, particles.length]], spring: 0,
    springs: springs.length, segments: null, shapes: [], needs: [] };
  if (!triangles.length) return { bodies: [body] };
  // Without its picture something laid is as if it were painted.
  const shown = skin in made.skins ? skin : 'plain', template = made.skins[shown];
  const tone = LAID.includes(shown) ? made.wood : colour, borders = bordersOf(triangles.map((corners) => [...corners]));
  const middle = /** @type {Point} */ ([0, 1].map((k) => particles.reduce((sum, each) => sum + each[k], 0)
    / particles.length));
  /** @type {(slot: number) => Point} */
  const form = (slot) => [particles[slot][0] - middle[0], particles[slot][1] - middle[1]];
  const slots = particles.map((_, k) => k);
  const [[x, y], room] = spotIn({ left: triangles, slots, loops: borders, inside: [], face: false }, form, [0, 0]);
  const shape = { ...template, loops: borders, grown: radius,
    look: /** @type {SkinLook} */ ([tone, tone, ...template.look.slice(2)]),
    line: template.line === null ? null : outlineOf(tone) };
  return { bodies: [{ ...body, skin: shown, colour: tone, triangles: triangles.flat(),
    keeps_area: true, spacing: cell, spot: [x, y, room], face: Boolean(look.face), shapes: [shape] }] };
}
