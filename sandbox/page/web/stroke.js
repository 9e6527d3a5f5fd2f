// Stroke: cuts what it crosses; bodies of triangles once it has left them, along the line through them, as CutTool does.
import { wholeTriangles } from './pieces.js';
import { HANDS } from './shared.js';
/** @import { Point } from './types.js' */
/** @import { World } from './world.js' */

/** @typedef {{ world: World, spring: (point: Point, within: number) => number[], crossing: (p: Point, q: Point) => number[] }} Near */
/** @typedef {(springs: number[], at: number[]) => void} Cut */

const { SOLID, SHARES } = HANDS;

export class Stroke {
  #point;
  #cut;
  /** The spring of triangles that it came down on: perhaps a stroke begins there, which parts the body.
   * @type {number[]} */
  #pressed = [];
  /** What it has cut, or is to.
   * @type {Set<number>} */
  #crossed = new Set();
  /** By owner, of bodies that it is in: springs, and at which share of each it crosses it.
   * @type {Map<number, Map<number, number>>} */
  #entered = new Map();

  /** @param {Near} near @param {Point} point @param {number} within @param {Cut} cut */
  constructor(near, point, within, cut) {
    this.#point = point;
    this.#cut = cut;
    const pressed = near.spring(point, within / 2), inTriangles = inTrianglesOf(near.world);
    if (pressed.some((spring) => inTriangles[spring])) this.#pressed = pressed;
    else {
      pressed.forEach((spring) => this.#crossed.add(spring));
      cut(pressed, []);
    }
  }

  /** Go on to a point [m].
   * @type {(near: Near, point: Point) => void} */
  go(near, point) {
    const { world } = near, crossed = near.crossing(this.#point, point).filter((spring) => !this.#crossed.has(spring));
    const inTriangles = inTrianglesOf(world), owner = world.view('state.owner'), a = world.view('state.particle_a');
    const others = crossed.filter((spring) => !inTriangles[spring]), edge = world.view('state.edge');
    others.forEach((spring) => this.#crossed.add(spring));
    for (const [spring, share] of sharesOf(world, crossed.filter((each) => inTriangles[each]), this.#point, point)) {
      const own = owner[a[spring]], noted = this.#entered.get(own) ?? new Map();
      this.#entered.set(own, noted.set(spring, share));
      this.#crossed.add(spring);
    }
    this.#point = point;
    const left = [...this.#entered].flatMap(([own, noted]) => {
      const borders = [...noted.keys()].filter((spring) => edge[spring] >= SOLID).length;
      return borders > 0 && borders % 2 === 0 ? [own] : [];
    });
    this.#cut(others, []);
    this.#part(world, left);
  }

  /** End it: what it is still inside of is cut as far as it came, and where it crossed nothing, what was pressed.
   * @type {(world: World) => void} */
  end(world) {
    if (!this.#crossed.size) this.#cut(this.#pressed.filter((spring) => world.isInUse('spring', spring)), []);
    else this.#part(world, [...this.#entered.keys()]);
  }

  /** @type {(world: World, owners: number[]) => void} */
  #part(world, owners) {
    for (const owner of owners) {
      const noted = [...this.#entered.get(owner) ?? []].filter(([spring]) => world.isInUse('spring', spring));
      this.#entered.delete(owner);
      // One spring alone is no line.
      this.#cut(noted.map(([spring]) => spring), noted.length > 1 ? noted.map(([, share]) => share) : []);
    }
  }
}

/** Where a line crosses springs, as a share of each from its first end; what only touches it is left out.
 * @type {(world: World, springs: number[], p: Point, q: Point) => [spring: number, share: number][]} */
function sharesOf(world, springs, p, q) {
  const a = world.view('state.particle_a'), b = world.view('state.particle_b'), place = world.view('state.position');
  const area = (/** @type {number} */ slot) => (q[0] - p[0]) * (place[2 * slot + 1] - p[1])
    - (q[1] - p[1]) * (place[2 * slot] - p[0]);
  return springs.flatMap((spring) => {
    const one = area(a[spring]), other = area(b[spring]);
    return (one >= 0) === (other >= 0) ? [] : [/** @type {[number, number]} */ ([spring,
      Math.round((one / (one - other)) * SHARES) / SHARES])];
  });
}

/** Which springs act within a body that keeps areas of triangles, which a cut parts along its line.
 * @type {(world: World) => boolean[]} */
function inTrianglesOf(world) {
  const owner = world.view('state.owner'), b = world.view('state.particle_b');
  const owners = new Set(wholeTriangles(world).map(([slot]) => owner[slot]));
  return Array.from(world.view('state.particle_a'), (p, spring) => owner[p] === owner[b[spring]] && owners.has(owner[p]));
}
