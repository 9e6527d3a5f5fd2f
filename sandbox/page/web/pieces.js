// Pieces: what is left of a body of triangles where springs of it were cut, and which face each piece has.
import { FACES } from './shared.js';

const { MOST_COMPARED } = FACES, NEARER = 0.12;

// The triangles of a world that keep their areas, by slot, counter-clockwise in their form.
export function wholeTriangles(world) {
  const view = (name) => world.view(`state.${name}`), active = view('constraint_active'), found = [];
  const kind = view('constraint_kind'), first = view('constraint_first'), corners = view('constraint_corners');
  const rest = view('constraint_rest'), particle = view('corner_particle');
  for (let k = 0; k < active.length; k++) {
    if (!active[k] || kind[k] !== world.areaKind || corners[k] !== 3) continue;
    const triangle = [0, 1, 2].map((c) => particle[first[k] + c]);
    found.push(rest[2 * k + 1] < 0 ? triangle.reverse() : triangle);
  }
  return found;
}

// The triangles of a body that are left. A body that keeps no areas has one while the springs along its sides are there.
function leftOf({ triangles, sides, slots, keeps_area: keepsArea }, active, whole) {
  const all = [];
  for (let k = 0; k < triangles.length; k += 3) all.push(triangles.slice(k, k + 3));
  const isThere = (_, n) => sides.slice(3 * n, 3 * n + 3).every((spring) => active[spring]);
  if (!keepsArea || all.every(isThere)) return all.filter(isThere);
  const own = new Set(slots);
  return whole.filter((triangle) => triangle.every((slot) => own.has(slot)));
}

// What is left of a body, by what its springs join, the piece of most triangles first.
export function piecesOf(body, active, whole) {
  const springs = body.springs.filter(([spring]) => active[spring]), label = new Map();
  const root = (slot) => {
    let at = slot;
    while (label.has(at)) at = label.get(at);
    return at;
  };
  for (const [, a, b] of springs) {
    const [low, high] = [root(a), root(b)].sort((one, other) => one - other);
    if (low !== high) label.set(high, low);
  }
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

// Loops of particles around triangles of one winding: sides of one of them alone.
function bordersOf(triangles) {
  const sides = new Map(), key = (a, b) => a * 0x4000000 + b, follow = new Map(), loops = [];
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
      const onward = follow.get(at), after = onward.pop();
      if (!onward.length) follow.delete(at);
      at = after;
    } while (at !== first && follow.has(at));
    if (loop.length > 2) loops.push(loop);
  }
  return loops;
}

const middleOf = (places) => [0, 1].map((axis) => places.reduce((sum, place) => sum + place[axis], 0) / places.length);

// How far a place is from a line from a to b.
function distance([x, y], [ax, ay], [bx, by]) {
  const dx = bx - ax, dy = by - ay, along = ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1);
  const part = Math.min(Math.max(along, 0), 1);
  return Math.hypot(x - ax - part * dx, y - ay - part * dy);
}

// How far a place is from triangles of a piece, 0 inside of one.
function awayFrom(place, { left }, form) {
  return left.reduce((least, slots) => {
    const ends = slots.map((slot, k) => [form(slot), form(slots[(k + 1) % 3])]);
    const isLeft = ([[ax, ay], [bx, by]]) => (bx - ax) * (place[1] - ay) - (by - ay) * (place[0] - ax) >= 0;
    return ends.every(isLeft) ? 0 : Math.min(least, ...ends.map(([a, b]) => distance(place, a, b)));
  }, Infinity);
}

// Where the largest circle inside a piece lies in the form, rather near to a place, and its radius [m].
function spotIn({ left, slots, loops }, form, near) {
  const halves = left.flatMap((corners) => corners.map((slot, k) =>
    middleOf([form(slot), form(corners[(k + 1) % 3])])));
  const tries = [...slots.map(form), ...left.map((corners) => middleOf(corners.map(form))), ...halves];
  const sides = loops.flatMap((loop) => loop.map((slot, k) => [form(slot), form(loop[(k + 1) % loop.length])]));
  const step = 1 + Math.floor((tries.length * sides.length) / MOST_COMPARED);
  let best = [tries[0], 0], most = -Infinity;
  for (let k = 0; k < tries.length; k += step) {
    const room = sides.reduce((least, [a, b]) => Math.min(least, distance(tries[k], a, b)), Infinity);
    const worth = room - NEARER * Math.hypot(tries[k][0] - near[0], tries[k][1] - near[1]);
    if (worth > most) [best, most] = [[tries[k], room], worth];
  }
  return best;
}

// Faces of the pieces of a body, and which pieces are crumbs, too small for a skin: that of the whole stays with the
// piece it lies on, where it fits. origin: places at creation; shares: of the room of the whole, see scene.py.
export function withFaces(body, pieces, origin, shares) {
  const { slots, springs, angle, spot: [x, y, room], triangles } = body;
  if (pieces.length === 1 && 3 * pieces[0].left.length === triangles.length) {
    return [{ ...pieces[0], face: body.face && { slots, springs, angle, spot: body.spot } }];
  }
  const at = (slot) => [origin[2 * slot], origin[2 * slot + 1]], middle = middleOf(slots.map(at));
  const form = (slot) => at(slot).map((value, axis) => value - middle[axis]);
  const away = pieces.map((piece) => awayFrom([x, y], piece, form)), keeper = away.indexOf(Math.min(...away));
  return pieces.map((piece, k) => {
    const own = middleOf(piece.slots.map(form)), isKeeper = k === keeper, about = spotIn(piece, form, own);
    const [place, inner] = isKeeper ? spotIn(piece, form, [x, y]) : about;
    const fits = inner >= (isKeeper ? shares.kept : shares.own) * room;
    const spot = [...place.map((value, axis) => value - own[axis]), Math.min(inner, room)];
    const face = body.face && fits && { slots: piece.slots, springs: piece.inside, angle, spot };
    return { ...piece, face, isCrumb: pieces.length > 1 && about[1] < shares.crumb * room };
  });
}
