// Things: the springs of a level, grouped into what is drawn; grouped again where one breaks.
import { piecesOf, splitSprings, wholeTriangles, withFaces, withSplit } from './pieces.js';
import { THINGS } from './shared.js';
/**
 * @import { Bars, Body, FilledBody, Flag, Join, Scene, SceneLook, SceneShape, Shape, SkinLook, Spot, SpringEnds,
 *   Things, Unfolded } from './types.js'
 */
/** @import { World } from './world.js' */

// Half widths of bars, TRUSS to LOOSE: as a part of their body's cells, from [pixels], to [pixels].
const { STRANDS, WORKING, LAID, TRUSS, MESH, LOOSE, BRACE, HANGER } = THINGS, THREADS = [...MESH], DECK = 0.95;
// Of a body without triangles.
const NO_SPOT = /** @type {Spot} */ ([0, 0, 0]);

/** @typedef {{ scene: Unfolded, world: World, active: Flag, whole: number[][] }} Now */
/** @typedef {SceneLook & Partial<Pick<Body, 'type' | 'cell' | 'slots' | 'segments'>>} LineLook */
/** @typedef {{ particles: number[], springs: number[] }} Chain */

/** The scene with all that joined, the slots of each body's particles and its springs as [spring, first end, second end].
 * @type {(scene: Scene, world: World) => Unfolded} */
export function unfolded(scene, world) {
  const a = world.view('state.particle_a'), b = world.view('state.particle_b'),
    key = (/** @type {number} */ p, /** @type {number} */ q) => Math.min(p, q) * 0x4000000 + Math.max(p, q);
  const bodies = [scene, ...world.joined].flatMap(({ bodies: each = [] }) => each).map((body) => {
    const slots = body.slots.flatMap(([first, count]) => Array.from({ length: count }, (_, k) => first + k));
    const springs = Array.from({ length: body.springs },
      (_, k) => /** @type {SpringEnds} */ ([body.spring + k, a[body.spring + k], b[body.spring + k]]));
    if (!body.triangles) return { ...body, slots, springs };
    // The springs along the sides of each triangle.
    const between = new Map(springs.map(([spring, p, q]) => [key(p, q), spring])), { triangles } = body;
    const sides = triangles.map((slot, k) => between.get(key(slot, triangles[k - (k % 3) + ((k + 1) % 3)])));
    const { spot = NO_SPOT, spacing = body.cell } = body;
    return { ...body, triangles, spot, spacing, slots, springs, sides };
  });
  const joins = [scene, ...world.joined].flatMap(({ joins: each = [] }) => each);
  const balls = [scene, ...world.joined].flatMap(({ balls: each = [] }) => each);
  return { ...scene, bodies, joins, balls };
}

/** What a picture finds out of each shape and line.
 * @type {() => Pick<Shape, 'box' | 'depth' | 'path' | 'splats' | 'reach'>} */
const untraced = () => ({ box: [0, 0, 0, 0], depth: 0, path: new Path2D(), splats: null, reach: 0 });
const unfollowed = () => ({ half: 0, pieces: [], path: new Path2D() });

/** What there is to draw of an unfolded scene, where active (m,) and present (n,) say which springs and particles there
 * are in a world.
 * @type {(scene: Unfolded, world: World, active: Flag, present: Flag) => Things} */
export function thingsOf(scene, world, active, present) {
  const now = { scene, world, active, whole: wholeTriangles(world) };
  /** @type {Things} */
  const things = { shapes: [], lines: [], working: [], wheels: [], sheets: [], worn: [], faces: [], balloons: [] };
  const split = splitSprings(world, active);
  for (const body of scene.bodies) {
    if (body.slots.some((slot) => present[slot])) addBody(things, split.length ? withSplit(body, split, world) : body, now);
  }
  /** Joins of one look may be strands together.
   * @type {Map<string | Join, { look: Join, springs: SpringEnds[] }>} */
  const looks = new Map();
  for (const join of scene.joins.filter(({ spring }) => active[spring])) {
    const key = STRANDS.includes(join.line) ? `${join.line} ${join.width}` : join;
    const group = looks.get(key) ?? { look: join, springs: [] };
    group.springs.push([join.spring, ...join.ends]);
    looks.set(key, group);
  }
  for (const { look, springs } of looks.values()) addLines(things, look, springs, LOOSE);
  things.lines.sort((first, second) => Number(!first.particles) - Number(!second.particles));
  if (things.balloons.length) tieBalloons(things, scene, active);
  return things;
}

/** A balloon has a knot where a spring joins its skin that is none of it.
 * @type {(things: Things, scene: Unfolded, active: Flag) => void} */
function tieBalloons(things, { bodies, joins }, active) {
  const joined = [...bodies.flatMap(({ springs }) => springs), ...joins.map(({ spring, ends }) => [spring, ...ends])];
  const there = joined.filter(([spring]) => active[spring]);
  things.balloons = things.balloons.map((body) => ({ ...body, knots: body.knots.filter((slot) =>
    there.filter(([, a, b]) => a === slot || b === slot).length > 2) }));
}

/** @type {(things: Things, body: Body | FilledBody, now: Now) => void} */
function addBody(things, body, now) {
  const { active } = now;
  const springs = body.springs.filter(([spring]) => active[spring]);
  if ('sides' in body) addFilled(things, body, springs, now);
  else if (body.shapes.length && body.needs.every((spring) => active[spring])) {
    const shapes = body.shapes.map((shape) => ({ ...shape, springs, cell: body.cell, ...untraced() }));
    things.shapes.push(...shapes);
    if (body.is_fan) {
      const [shape] = shapes, { loops: [loop] } = shape, triangles = loop.map((slot, k) => [-1, slot, loop[(k + 1) % loop.length]]);
      things.worn.push({ body, shape, triangles, loops: [loop], texels: [] });
    }
    if (body.skin === 'balloon' && !body.is_fan) things.balloons.push({ ...body, knots: body.knots ?? [] });
    if (body.wheel) things.wheels.push(body.wheel);
  } else addLines(things, body, springs, ['bridge', 'girder'].includes(body.type) ? TRUSS : MESH);
}

/** Springs of one look as strands, working springs or bars.
 * @type {(things: Things, look: LineLook, springs: SpringEnds[], size: number[]) => void} */
function addLines(things, look, springs, size) {
  if (!springs.length || look.line === 'hidden') return;
  const { line: kind, colour, width, cell } = look;
  /** @type {(some: SpringEnds[], share: number, more?: Partial<Bars>) => void} */
  const bars = (some, share, more) =>
    things.lines.push({ kind, colour, cell, size, springs: some, width: share * width, ...unfollowed(), ...more });
  const bolts = [...new Set(springs.flatMap(([, a, b]) => [a, b]))];
  if (STRANDS.includes(kind)) {
    for (const chain of chainsOf(springs)) {
      const isHanger = kind === 'rope' && chain.springs.length === 1;
      things.lines.push({ kind, width: width * (isHanger ? HANGER : 1), ...unfollowed(), ...chain });
    }
  } else if (WORKING.includes(kind)) {
    for (const [spring, ...ends] of springs) things.working.push({ kind, spring, ends, width });
  } else if (size === TRUSS) {
    // The first row of a bridge or girder has one particle more than there are cells.
    const { slots = [], segments } = look;
    const isLower = (/** @type {number} */ slot) => slots.indexOf(slot) > Number(segments);
    const isChord = (/** @type {SpringEnds} */ [, a, b]) => isLower(a) === isLower(b);
    bars(springs.filter((each) => !isChord(each)), BRACE);
    bars(springs.filter(isChord), 1);
    const deck = springs.filter((each) => look.type === 'bridge' && isChord(each) && !isLower(each[1]));
    if (deck.length) bars(deck, DECK, { kind: 'deck', raised: 1 / DECK });
    bars([], 1, { bolts, isTruss: true });
  } else bars(springs, 1, { bolts: size === MESH ? bolts : [] });
}

/** A body of triangles, in the pieces that are left of it.
 * @type {(things: Things, body: FilledBody, springs: SpringEnds[], now: Now) => void} */
function addFilled(things, body, springs, { scene, world, active, whole }) {
  const found = piecesOf(body, active, whole), inside = new Set(), isCloth = body.skin === 'cloth';
  const isLaid = LAID.includes(body.skin), [shape] = body.shapes;
  for (const piece of found.length ? withFaces(body, found, world.view('state.origin'), scene.pieces) : []) {
    const { left, loops, face } = piece, flat = piece.isCrumb && { look: flatOf(shape, scene), shows_strain: false };
    piece.inside.forEach(([spring]) => inside.add(spring));
    const own = { ...shape, ...flat, loops, springs: piece.inside, cell: body.cell, ...untraced() };
    if (body.picture) things.worn.push({ body, shape: own, triangles: left, loops, texels: [] });
    if (body.picture || !isCloth) things.shapes.push(own);
    if (body.picture) continue;
    if (isCloth || isLaid) things.sheets.push({ body, triangles: left, loops, isCloth });
    if (face) things.faces.push(face);
  }
  addLines(things, body, springs.filter(([spring]) => !inside.has(spring)), THREADS);
}

/** The look of a shape with its colour alone.
 * @type {(shape: SceneShape, scene: Unfolded) => SkinLook} */
const flatOf = ({ look }, { pieces: { flat } }) =>
  /** @type {SkinLook} */ ([...look.slice(0, 2), ...flat, ...look.slice(2 + flat.length)]);

/** Ways along springs through particles that just two of them meet in.
 * @type {(springs: SpringEnds[]) => Chain[]} */
function chainsOf(springs) {
  /** @type {Map<number, SpringEnds[]>} */
  const at = new Map();
  const left = new Set(springs);
  /** @type {Chain[]} */
  const chains = [];
  for (const spring of springs) for (const slot of spring.slice(1)) at.set(slot, [...(at.get(slot) ?? []), spring]);
  /** @type {(first: number, spring: SpringEnds) => void} */
  const walk = (first, spring) => {
    const chain = { particles: [first], springs: /** @type {number[]} */ ([]) };
    while (left.delete(spring)) {
      chain.springs.push(spring[0]);
      const end = spring[1] === chain.particles.at(-1) ? spring[2] : spring[1], near = at.get(end) ?? [];
      chain.particles.push(end);
      if (near.length === 2) spring = near[0] === spring ? near[1] : near[0];
    }
    chains.push(chain);
  };
  for (const [slot, near] of at) if (near.length !== 2) near.forEach((spring) => left.has(spring)
    && walk(slot, spring));
  for (const spring of springs) if (left.has(spring)) walk(spring[1], spring);
  return chains;
}
