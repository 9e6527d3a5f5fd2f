// Things: the springs of a level, grouped into what is drawn; grouped again where one breaks.

const STRANDS = ['rope', 'cable', 'chain', 'deck', 'thread', 'silk'];
const WORKING = ['coil', 'muscle', 'piston'];
const LAID = ['wood', 'stone', 'brick'];
// Half widths of bars: as a part of their body's cells, from [pixels], to [pixels].
const TRUSS = [0.11, 1.6, 4.2], MESH = [0.075, 1.0, 3.4], LOOSE = [0.1, 1.2, 2.6];
const BRACE = 0.62, HANGER = 0.62;

// The scene with the slots of each body's particles and its springs as [spring, first end, second end].
export function unfolded(scene, world) {
  const a = world.view('state.particle_a'), b = world.view('state.particle_b'),
    key = (p, q) => Math.min(p, q) * 0x4000000 + Math.max(p, q);
  const bodies = scene.bodies.map((body) => {
    const slots = body.slots.flatMap(([first, count]) => Array.from({ length: count }, (_, k) => first + k));
    const springs = Array.from({ length: body.springs },
      (_, k) => [body.spring + k, a[body.spring + k], b[body.spring + k]]);
    if (!body.triangles) return { ...body, slots, springs };
    // The springs along the sides of each triangle.
    const between = new Map(springs.map(([spring, p, q]) => [key(p, q), spring])), { triangles } = body;
    const sides = triangles.map((slot, k) => between.get(key(slot, triangles[k - (k % 3) + ((k + 1) % 3)])));
    return { ...body, slots, springs, sides };
  });
  return { ...scene, bodies };
}

// What there is to draw of an unfolded scene, where active (m,) says which springs there are.
export function thingsOf(scene, active) {
  const things = { shapes: [], strands: [], bars: [], working: [], wheels: [], sheets: [], faces: [], balloons: [] };
  for (const body of scene.bodies) addBody(things, body, active);
  // How many springs each particle has.
  things.degree = new Map();
  const count = (slot) => things.degree.set(slot, (things.degree.get(slot) ?? 0) + 1);
  scene.bodies.forEach(({ springs }) => springs.forEach(([spring, ...ends]) => active[spring] && ends.forEach(count)));
  scene.joins.forEach((join) => active[join.spring] && join.ends.forEach(count));
  for (const join of scene.joins) {
    if (active[join.spring]) addLines(things, join, [[join.spring, ...join.ends]], LOOSE);
  }
  return things;
}

function addBody(things, body, active) {
  const springs = body.springs.filter(([spring]) => active[spring]), isWhole = springs.length === body.springs.length,
    shape = { springs, keep: 0.25, rounds: 2, extra: 0, ...own(body) };
  if (body.skin === 'lattice') addLines(things, body, springs, MESH);
  else if (body.triangles) addFilled(things, body, springs, active);
  else if (body.type === 'ring' && isWhole) {
    if (body.skin === 'balloon') things.balloons.push(body);
    things.shapes.push({ ...shape, loops: [body.slots], layer: 1 });
  } else if (body.type === 'wheel' && body.skin && hasRings(body, active)) {
    things.wheels.push(wheelOf(body));
    const isTyre = body.skin !== 'steel wheel', { inner, outer } = things.wheels.at(-1);
    const colour = !isTyre ? '#96a3ba' : ['rubber', 'jelly', 'plain'].includes(body.skin) ? body.colour : '#343842';
    things.shapes.push({ ...shape, loops: [outer, inner], skin: isTyre ? 'tyre' : 'rubber', colour, layer: 0 });
  } else if (body.panel) {
    const panel = { springs: [], grown: 0, layer: 0, keep: 0.2, rounds: 2 };
    things.shapes.push({ ...panel, loops: [body.hull], skin: 'rubber', colour: body.panel, extra: 4 });
    if (body.window.length > 2) things.shapes.push({ ...panel, loops: [body.window], skin: 'window', colour: '#bfe6ff',
      extra: -3 });
  } else addLines(things, body, springs, ['bridge', 'girder'].includes(body.type) ? TRUSS : MESH);
}

function own(body) {
  return { skin: body.skin, colour: body.colour, grown: body.radius, reach: body.cell };
}

// Springs of one look as strands, working springs or bars.
function addLines(things, look, springs, size) {
  if (!springs.length || look.line === 'hidden') return;
  if (STRANDS.includes(look.line)) {
    for (const chain of chainsOf(springs)) {
      const isHanger = look.line === 'rope' && chain.springs.length === 1;
      things.strands.push({ kind: look.line, width: look.width * (isHanger ? HANGER : 1), ...chain });
    }
  } else if (WORKING.includes(look.line)) {
    for (const [spring, ...ends] of springs) things.working.push({ kind: look.line, spring, ends, width: look.width });
  } else if (size === TRUSS) {
    // The first row of a bridge or girder has one particle more than there are cells.
    const row = (slot) => look.slots.indexOf(slot) > look.segments;
    const isChord = ([, a, b]) => row(a) === row(b);
    const isDeck = (spring) => look.type === 'bridge' && isChord(spring) && !row(spring[1]);
    const bar = { kind: look.line, colour: look.colour, cell: look.cell, size };
    things.bars.push({ ...bar, springs: springs.filter((each) => !isChord(each)), share: BRACE * look.width,
      bolts: [] });
    const bolts = [...new Set(springs.flatMap(([, a, b]) => [a, b]))];
    things.bars.push({ ...bar, springs: springs.filter(isChord), share: look.width, bolts,
      deck: springs.filter(isDeck) });
  } else {
    const bolts = size === MESH ? [...new Set(springs.flatMap(([, a, b]) => [a, b]))] : [];
    things.bars.push({ kind: look.line, colour: look.colour, cell: look.cell, size, springs, share: look.width,
      bolts });
  }
}

// A body of triangles, each of which is there while the springs along its sides are.
function addFilled(things, body, springs, active) {
  const left = [], filled = new Set();
  for (let k = 0; k < body.triangles.length; k += 3) {
    if (!body.sides.slice(k, k + 3).every((spring) => active[spring])) continue;
    const triangle = body.triangles.slice(k, k + 3);
    left.push(triangle);
    triangle.forEach((slot) => filled.add(slot));
  }
  const inside = ([, a, b]) => filled.has(a) && filled.has(b), loops = bordersOf(left), isCloth = body.skin === 'cloth';
  const isLaid = LAID.includes(body.skin);
  if (left.length) {
    const shape = { ...own(body), loops, springs: isLaid ? [] : springs.filter(inside), extra: 0 };
    if (!isCloth) things.shapes.push({ ...shape, layer: isLaid ? 0 : 1, keep: isLaid ? 0.12 : body.keep,
      rounds: isLaid ? 1 : 2 });
    if (isCloth || isLaid) things.sheets.push({ body, triangles: left, loops, isCloth });
    if (body.face) things.faces.push(body);
  }
  addLines(things, body, springs.filter((spring) => !inside(spring)), MESH);
}

function wheelOf(body) {
  const { segments, slots } = body;
  return { body, hub: slots[0], inner: slots.slice(1, segments + 1),
    outer: slots.slice(segments + 1, 2 * segments + 1) };
}

// Whether both rings of a wheel are closed.
function hasRings(body, active) {
  return body.numbers.every((number, k) => number < body.segments || number >= 3 * body.segments
    || active[body.spring + k]);
}

// Loops of particles around triangles of one winding.
function bordersOf(triangles) {
  const sides = new Map(), key = (a, b) => a * 0x4000000 + b, loops = [];
  for (const corners of triangles) corners.forEach((a, k) =>
    sides.set(key(a, corners[(k + 1) % 3]), [a, corners[(k + 1) % 3]]));
  const follow = new Map();
  for (const [a, b] of sides.values()) if (!sides.has(key(b, a))) follow.set(a, [...(follow.get(a) ?? []), b]);
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

// Ways along springs through particles that just two of them meet in.
function chainsOf(springs) {
  const at = new Map(), left = new Set(springs), chains = [];
  for (const spring of springs) for (const slot of spring.slice(1)) at.set(slot, [...(at.get(slot) ?? []), spring]);
  const walk = (first, spring) => {
    const chain = { particles: [first], springs: [] };
    while (left.delete(spring)) {
      chain.springs.push(spring[0]);
      const end = spring[1] === chain.particles.at(-1) ? spring[2] : spring[1], near = at.get(end);
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
