// Pieces: what is left of a body of triangles where springs of it were cut, and which face each piece has.
import { FACES } from './shared.js';
/** @import { Body, FilledBody, Flag, Piece, Point, Scene, SpringEnds, Spot } from './types.js' */
/** @import { World } from './world.js' */

/** @typedef {(slot: number) => Point} Form */

const { MOST_COMPARED } = FACES, NEARER = 0.12;

/** The triangles of a world that keep their areas, by slot, counter-clockwise in their form.
 * @type {(world: World) => number[][]} */
export function wholeTriangles(world) {
  const active = world.view('state.constraint_active'), kind = world.view('state.constraint_kind');
  const first = world.view('state.constraint_first'), corners = world.view('state.constraint_corners');
  const rest = world.view('state.constraint_rest'), particle = world.view('state.corner_particle');
  /** @type {number[][]} */
  const found = [];
  for (let k = 0; k < active.length; k++) {
    if (!active[k] || kind[k] !== world.areaKind || corners[k] !== 3) continue;
    const triangle = [0, 1, 2].map((c) => particle[first[k] + c]);
    found.push(rest[2 * k + 1] < 0 ? triangle.reverse() : triangle);
  }
  return found;
}

/** The springs that cuts have added and that are there.
 * @type {(world: World, active: Flag) => SpringEnds[]} */
export function splitSprings(world, active) {
  const split = world.view('state.is_split'), a = world.view('state.particle_a'), b = world.view('state.particle_b');
  /** @type {SpringEnds[]} */
  const found = [];
  split.forEach((is, s) => { if (is && active[s]) found.push([s, a[s], b[s]]); });
  return found;
}

/** A body with what cuts have added to it.
 * @type {<B extends Body | FilledBody>(body: B, split: SpringEnds[], world: World) => B} */
export function withSplit(body, split, world) {
  if (!('triangles' in body) || !body.triangles) return body;
  const from = world.view('state.split_from'), own = new Set(body.slots);
  const isOwn = (/** @type {number} */ slot) => own.has(slot) || own.has(from[slot]);
  const springs = split.filter(([, a, b]) => isOwn(a) && isOwn(b));
  if (!springs.length) return body;
  return { ...body, springs: [...body.springs, ...springs],
    slots: [...new Set([...body.slots, ...springs.flatMap(([, a, b]) => [a, b])])] };
}

/** The triangles of a body that are left. A body that keeps no areas has one while the springs along its sides are there.
 * @type {(body: FilledBody, active: Flag, whole: number[][]) => number[][]} */
function leftOf({ triangles, sides, slots, keeps_area: keepsArea }, active, whole) {
  /** @type {number[][]} */
  const all = [];
  for (let k = 0; k < triangles.length; k += 3) all.push(triangles.slice(k, k + 3));
  /** @type {(triangle: number[], n: number) => boolean} */
  const isThere = (_, n) => sides.slice(3 * n, 3 * n + 3).every((spring) => spring !== undefined && active[spring]);
  if (!keepsArea || all.every(isThere)) return all.filter(isThere);
  const own = new Set(slots);
  return whole.filter((triangle) => triangle.every((slot) => own.has(slot)));
}

/** What is left of a body, by what its springs join, the piece of most triangles first.
 * @type {(body: FilledBody, active: Flag, whole: number[][]) => Piece[]} */
export function piecesOf(body, active, whole) {
  const springs = body.springs.filter(([spring]) => active[spring]);
  /** @type {Map<number, number>} */
  const label = new Map();
  /** @type {(slot: number) => number} */
  const root = (slot) => {
    let at = slot;
    for (let next = label.get(at); next !== undefined; next = label.get(at)) at = next;
    return at;
  };
  for (const [, a, b] of springs) {
    const [low, high] = [root(a), root(b)].sort((one, other) => one - other);
    if (low !== high) label.set(high, low);
  }
  /** @type {Map<number, number[][]>} */
  const parts = new Map();
  for (const triangle of leftOf(body, active, whole)) {
    const part = root(triangle[0]);
    parts.set(part, [...(parts.get(part) ?? []), triangle]);
  }
  const sorted = [...parts].sort(([one, left], [other, right]) => right.length - left.length || one - other);
  return sorted.map(([, left]) => {
    const filled = new Set(left.flat());
    const inside = springs.filter(([, a, b]) => filled.has(a) && filled.has(b));
    return { left, slots: [...filled].sort((one, other) => one - other), loops: bordersOf(left), inside };
  });
}

/** Loops of particles around triangles of one winding: sides of one of them alone.
 * @type {(triangles: number[][]) => number[][]} */
export function bordersOf(triangles) {
  /** @type {Map<number, [number, number]>} */
  const sides = new Map();
  /** @type {Map<number, number[]>} */
  const follow = new Map();
  /** @type {number[][]} */
  const loops = [];
  /** @type {(a: number, b: number) => number} */
  const key = (a, b) => a * 0x4000000 + b;
  for (const corners of triangles) {
    corners.forEach((a, k) => {
      const b = corners[(k + 1) % 3];
      if (!sides.delete(key(b, a))) sides.set(key(a, b), [a, b]);
    });
  }
  for (const [a, b] of sides.values()) follow.set(a, [...(follow.get(a) ?? []), b]);
  while (follow.size) {
    const [first] = follow.keys(), loop = [];
    let at = first;
    do {
      loop.push(at);
      /** @type {number[]} */
      const onward = follow.get(at) ?? [], after = onward.pop() ?? first;
      if (!onward.length) follow.delete(at);
      at = after;
    } while (at !== first && follow.has(at));
    if (loop.length > 2) loops.push(loop);
  }
  return loops;
}

/** @type {(places: Point[]) => Point} */
const middleOf = (places) => [places.reduce((sum, [x]) => sum + x, 0) / places.length,
  places.reduce((sum, [, y]) => sum + y, 0) / places.length];

/** How far a place is from a line from a to b.
 * @type {(place: Point, a: Point, b: Point) => number} */
export function distance([x, y], [ax, ay], [bx, by]) {
  const dx = bx - ax, dy = by - ay, along = ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1);
  const part = Math.min(Math.max(along, 0), 1);
  return Math.hypot(x - ax - part * dx, y - ay - part * dy);
}

/** The sides of a loop, by the places of their ends.
 * @type {(loop: number[], form: Form) => [Point, Point][]} */
const sidesOf = (loop, form) => loop.map((slot, k) => [form(slot), form(loop[(k + 1) % loop.length])]);

/** How far a place is from triangles of a piece, 0 inside of one.
 * @type {(place: Point, piece: Piece, form: Form) => number} */
function awayFrom(place, { left }, form) {
  return left.reduce((least, slots) => {
    const ends = sidesOf(slots, form);
    /** @type {(side: [Point, Point]) => boolean} */
    const isLeft = ([[ax, ay], [bx, by]]) => (bx - ax) * (place[1] - ay) - (by - ay) * (place[0] - ax) >= 0;
    return ends.every(isLeft) ? 0 : Math.min(least, ...ends.map(([a, b]) => distance(place, a, b)));
  }, Infinity);
}

/** Where the largest circle inside a piece lies in the form, rather near to a place, and its radius [m].
 * @type {(piece: Piece, form: Form, near: Point) => [place: Point, room: number]} */
export function spotIn({ left, slots, loops }, form, near) {
  const halves = left.flatMap((corners) => corners.map((slot, k) =>
    middleOf([form(slot), form(corners[(k + 1) % 3])])));
  const tries = [...slots.map(form), ...left.map((corners) => middleOf(corners.map(form))), ...halves];
  const sides = loops.flatMap((loop) => sidesOf(loop, form));
  const step = 1 + Math.floor((tries.length * sides.length) / MOST_COMPARED);
  let best = /** @type {[Point, number]} */ ([tries[0], 0]), most = -Infinity;
  for (let k = 0; k < tries.length; k += step) {
    const room = sides.reduce((least, [a, b]) => Math.min(least, distance(tries[k], a, b)), Infinity);
    const worth = room - NEARER * Math.hypot(tries[k][0] - near[0], tries[k][1] - near[1]);
    if (worth > most) [best, most] = [[tries[k], room], worth];
  }
  return best;
}

/** Faces of the pieces of a body, and which pieces are crumbs, too small for a skin: that of the whole stays with the
 * piece it lies on, where it fits. origin: places at creation; shares: of the room of the whole, see scene.py.
 * @type {(body: FilledBody, pieces: Piece[], origin: Float64Array, shares: Scene['pieces']) => Piece[]} */
export function withFaces(body, pieces, origin, shares) {
  const { slots, springs, angle, spot: [x, y, room], triangles } = body;
  if (pieces.length === 1 && 3 * pieces[0].left.length === triangles.length) {
    return [{ ...pieces[0], face: body.face && { slots, springs, angle, spot: body.spot } }];
  }
  /** @type {Form} */
  const at = (slot) => [origin[2 * slot], origin[2 * slot + 1]], middle = middleOf(slots.map(at));
  /** @type {Form} */
  const form = (slot) => [at(slot)[0] - middle[0], at(slot)[1] - middle[1]];
  const away = pieces.map((piece) => awayFrom([x, y], piece, form)), keeper = away.indexOf(Math.min(...away));
  return pieces.map((piece, k) => {
    const own = middleOf(piece.slots.map(form)), isKeeper = k === keeper, about = spotIn(piece, form, own);
    const [place, inner] = isKeeper ? spotIn(piece, form, [x, y]) : about;
    const fits = inner >= (isKeeper ? shares.kept : shares.own) * room;
    /** @type {Spot} */
    const spot = [place[0] - own[0], place[1] - own[1], Math.min(inner, room)];
    const face = body.face && fits && { slots: piece.slots, springs: piece.inside, angle, spot };
    return { ...piece, face, isCrumb: pieces.length > 1 && about[1] < shares.crumb * room };
  });
}
