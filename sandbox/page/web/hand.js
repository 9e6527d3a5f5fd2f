// Hand: mouse, fingers and keys on the picture become commands: drag, pin, cut; what holds nothing moves the view.
import { HANDS } from './shared.js';

const { STRENGTH, AT_LIMIT, SOFT_REACH, UNITS, PICK_RADIUS } = HANDS;
const REACH = { mouse: PICK_RADIUS, pen: 16, touch: 26 };
const NUDGE = 0.03, WHEEL_ZOOM = 1.0015;
// Two taps so soon after each other [ms] and so near to each other [pixels] are one gesture.
const TWICE = 350, BESIDE = 30;
const isNear = (one, two) => Math.hypot(one.x - two.x, one.y - two.y) < BESIDE;

// What of a world lies near a point [m].
class Near {
  constructor(world) {
    this.world = world;
    for (const name of ['position', 'radius', 'inverse_mass', 'particle_active', 'owner', 'origin', 'mass',
      'particle_a', 'particle_b',
      'spring_active', 'material']) this[name] = world.view(`state.${name}`);
  }

  #nearest(count, distance, within) {
    let best = null, least = within;
    for (let k = 0; k < count; k++) {
      const away = distance(k);
      if (away < least) [best, least] = [k, away];
    }
    return best;
  }

  #away(slot, [x, y]) {
    return Math.hypot(this.position[2 * slot] - x, this.position[2 * slot + 1] - y);
  }

  particle(point, within) {
    const away = (k) => (this.world.isShown(k) ? this.#away(k, point) - this.radius[k] : Infinity);
    return this.#nearest(this.mass.length, away, within);
  }

  // The free particle that a press takes: one within reach, else the nearest of a body with springs around the point.
  free(point, within) {
    const pressed = this.particle(point, within);
    if (pressed !== null && this.inverse_mass[pressed] > 0) return pressed;
    const sides = new Map();
    this.#eachSpring((s, a, b) => {
      const of = sides.get(this.owner[a]) ?? sides.set(this.owner[a], new Set()).get(this.owner[a]);
      for (const u of [0, 1]) {
        const low = this.position[2 * a + u], high = this.position[2 * b + u], v = 1 - u;
        if (low <= point[u] === high <= point[u]) continue;
        const part = (point[u] - low) / (high - low),
          at = this.position[2 * a + v] + (this.position[2 * b + v] - this.position[2 * a + v]) * part;
        of.add(`${u}${at <= point[v]}`);
      }
    });
    const isTaken = (k) => this.world.canMove(k) && sides.get(this.owner[k])?.size === 4;
    return this.#nearest(this.mass.length, (k) => (isTaken(k) ? this.#away(k, point) : Infinity), Infinity);
  }

  #eachSpring(act) {
    for (let s = 0; s < this.spring_active.length; s++) {
      if (this.spring_active[s] && this.material[s] >= 0) act(s, this.particle_a[s], this.particle_b[s]);
    }
  }

  spring([x, y], within) {
    let best = null, least = within;
    this.#eachSpring((s, a, b) => {
      const [ax, ay, bx, by] = this.#ends(a, b), dx = bx - ax, dy = by - ay;
      const part = Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1), 0), 1);
      const away = Math.hypot(ax + dx * part - x, ay + dy * part - y);
      if (away < least) [best, least] = [s, away];
    });
    return best === null ? [] : [best];
  }

  #ends(a, b) {
    return [this.position[2 * a], this.position[2 * a + 1], this.position[2 * b], this.position[2 * b + 1]];
  }

  crossing(p, q) {
    const found = [], area = (ux, uy, vx, vy, wx, wy) => (vx - ux) * (wy - uy) - (vy - uy) * (wx - ux);
    this.#eachSpring((s, a, b) => {
      const [ax, ay, bx, by] = this.#ends(a, b);
      const straddles = area(...p, ...q, ax, ay) * area(...p, ...q, bx, by) <= 0
        && area(ax, ay, bx, by, ...p) * area(ax, ay, bx, by, ...q) <= 0;
      const meets = (u, start, end) => Math.min(start, end) <= Math.max(p[u], q[u])
        && Math.max(start, end) >= Math.min(p[u], q[u]);
      if (straddles && meets(0, ax, bx) && meets(1, ay, by)) found.push(s);
    });
    return found;
  }

  // How far a hand reaches into a soft body [m]; 0 where it is not soft.
  grip(particle) {
    const view = (name) => this.world.view(`state.constraint_${name}`), active = view('active'), kind = view('kind');
    const first = view('first'), corner = this.world.view('state.corner_particle'), owner = this.owner[particle];
    if (!active.some((is, k) => is && kind[k] === this.world.areaKind
      && this.owner[corner[first[k]]] === owner)) return 0;
    let most = 0;
    for (let k = 0; k < this.mass.length; k++) {
      if (this.particle_active[k] && this.owner[k] === owner) {
        most = Math.max(most,
          Math.hypot(this.origin[2 * k] - this.origin[2 * particle],
          this.origin[2 * k + 1] - this.origin[2 * particle + 1]));
      }
    }
    return SOFT_REACH * most;
  }

  bodyMass(particle) {
    return this.mass.reduce((sum, mass, k) =>
      sum + (this.particle_active[k] && this.owner[k] === this.owner[particle] ? mass : 0), 0);
  }
}

export class Hands {
  tool = 'drag';
  marked = null;
  #pointers = new Map();
  // What each hand holds that a pointer or a key moves.
  #held = new Map();
  #tapped = null;
  #closing = new AbortController();

  // changed: called when the view has been moved by hand; fit: shows all again; say: tells a person something in a line.
  constructor(canvas, run, camera, { changed, fit, say }) {
    Object.assign(this, { canvas, run, camera, changed, fit, say });
    const how = { signal: this.#closing.signal, passive: false };
    const on = (name, act) => canvas.addEventListener(name, act, how);
    on('pointerdown', (event) => this.#press(event));
    on('pointermove', (event) => this.#move(event));
    // Whatever ends a press, it ends the capture.
    for (const name of ['pointerup', 'lostpointercapture']) on(name, (event) => this.#lift(event));
    on('contextmenu', (event) => event.preventDefault());
    on('wheel', (event) => this.#turn(event));
  }

  close() {
    this.#closing.abort();
  }

  // A wheel zooms, unless it would scroll the page and the picture was not clicked before.
  #turn(event) {
    const { scrollHeight, clientHeight } = document.documentElement;
    if (scrollHeight > clientHeight && document.activeElement !== this.canvas && !event.ctrlKey) return;
    event.preventDefault();
    this.camera.zoomAbout(event.offsetX, event.offsetY, WHEEL_ZOOM ** -event.deltaY);
    this.changed();
  }

  #press(event) {
    event.preventDefault();
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    const point = this.camera.toWorld(event.offsetX, event.offsetY),
      within = REACH[event.pointerType] / this.camera.zoom;
    const pointer = { x: event.offsetX, y: event.offsetY, kind: 'pan',
      began: { x: event.offsetX, y: event.offsetY, time: event.timeStamp } };
    this.#pointers.set(event.pointerId, pointer);
    if (event.button !== 0 || event.altKey) return;
    const near = new Near(this.run.world), touched = near.particle(point, within), free = near.free(point, within);
    pointer.isBeside = this.tool !== 'cut' && touched === null && free === null && this.#pointers.size === 1;
    if (this.tool === 'cut') {
      Object.assign(pointer, { kind: 'cut', point, gesture: this.run.newGesture() });
      this.#cut(pointer, near.spring(point, within / 2));
    } else if (this.tool === 'pin') this.#pin(near, touched, pointer);
    else if (free !== null) {
      pointer.hand = this.hold(free, point, within);
      if (pointer.hand !== null) pointer.kind = 'hold';
    } else if (touched !== null) this.say('This particle is pinned. Choose Pin and touch it to unpin it.');
  }

  // Two taps where nothing is show all again.
  #tap(began, ended) {
    const isSecond = ended - this.#tapped?.time < TWICE && isNear(began, this.#tapped);
    this.#tapped = isSecond ? null : began;
    if (isSecond) this.fit();
  }

  #pin(near, particle, pointer) {
    if (particle === null) return;
    pointer.kind = 'done';
    const type = near.inverse_mass[particle] > 0 ? 'pin' : 'unpin';
    if (!this.run.submit({ type, particle }, this.run.newGesture())) this.say('This page cannot pin.');
  }

  #cut(pointer, springs) {
    if (springs.length && !this.run.submit({ type: 'cut_springs', springs },
      pointer.gesture)) this.say('This page cannot cut.');
  }

  // Take a particle into a free hand and draw it to a point [m]. The hand; null where none is free.
  hold(particle, point, within) {
    const gesture = this.run.newGesture();
    this.run.takeUp(gesture);
    const near = new Near(this.run.world), { world } = this.run, { position } = near;
    const hand = Array.from({ length: world.hands.count }, (_, k) => k).find((k) => !world.isHeld(k));
    if (hand === undefined) return null;
    const dx = position[2 * particle] - point[0], dy = position[2 * particle + 1] - point[1];
    // A particle at the pointer goes to it; one that is farther off keeps its distance, so that nothing jumps.
    const beside = Math.hypot(dx, dy) <= within + near.radius[particle] ? [0, 0] : [dx, dy];
    const target = [point[0] + beside[0], point[1] + beside[1]];
    // What a command changes may lie elsewhere after it: all is asked before.
    const limit = STRENGTH * near.bodyMass(particle),
      record = { type: 'grab', grab: hand, particle, target, strength: STRENGTH, radius: near.grip(particle) };
    if (!this.run.submit(record, gesture)) return null;
    this.#held.set(hand, { particle, gesture, beside, target, isMoved: false, limit });
    return hand;
  }

  #move(event) {
    const pointer = this.#pointers.get(event.pointerId);
    if (!pointer) return;
    if (!event.buttons) {
      this.#lift(event);
      return;
    }
    const [x, y] = [event.offsetX, event.offsetY], point = this.camera.toWorld(x, y),
      held = this.#held.get(pointer.hand);
    if (held) this.#aim(held, point);
    else if (pointer.kind === 'cut') {
      this.#cut(pointer, new Near(this.run.world).crossing(pointer.point, point));
      pointer.point = point;
    } else if (pointer.kind === 'pan') this.#moveView(pointer, x, y);
    Object.assign(pointer, { x, y });
    if (!isNear(pointer, pointer.began)) pointer.isBeside = false;
  }

  // One finger moves the view, two turn it larger or smaller as well.
  #moveView(pointer, x, y) {
    const other = [...this.#pointers.values()].find((each) => each.kind === 'pan' && each !== pointer);
    const share = other ? 0.5 : 1;
    this.camera.x -= (share * (x - pointer.x)) / this.camera.zoom;
    this.camera.y += (share * (y - pointer.y)) / this.camera.zoom;
    if (other) {
      const before = Math.hypot(pointer.x - other.x, pointer.y - other.y), after = Math.hypot(x - other.x, y - other.y);
      if (before > 1 && after > 1) this.camera.zoomAbout((x + other.x) / 2, (y + other.y) / 2, after / before);
    }
    this.changed();
  }

  #aim(held, [x, y]) {
    held.target = [x + held.beside[0], y + held.beside[1]];
    held.isMoved = true;
  }

  #lift(event) {
    const pointer = this.#pointers.get(event.pointerId);
    this.#pointers.delete(event.pointerId);
    if (this.#held.has(pointer?.hand)) this.release(pointer.hand);
    else if (pointer?.isBeside && event.type === 'pointerup') this.#tap(pointer.began, event.timeStamp);
  }

  release(hand) {
    const { gesture } = this.#held.get(hand);
    this.#held.delete(hand);
    if (this.run.world.isHeld(hand)) this.run.submit({ type: 'release', grab: hand }, gesture);
  }

  releaseAll() {
    [...this.#held.keys()].forEach((hand) => this.release(hand));
  }

  // End what pointers do, as if they were lifted.
  letGo() {
    for (const { hand } of this.#pointers.values()) if (this.#held.has(hand)) this.release(hand);
    this.#pointers.clear();
  }

  // Hold nothing any more, as time has jumped.
  forget() {
    this.#held.clear();
    for (const pointer of this.#pointers.values()) Object.assign(pointer, { kind: 'done', hand: null });
  }

  // Before a tick: send every hand to where its pointer is now.
  update() {
    for (const [hand, held] of this.#held) {
      if (!held.isMoved) continue;
      held.isMoved = false;
      this.run.submit({ type: 'move_grab', grab: hand, target: held.target }, held.gesture);
    }
  }

  // Keys: N marks the next particle, Enter takes it, arrows move it. Whether the key was of use.
  key(event) {
    const near = new Near(this.run.world),
      way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    const [hand, held] = [...this.#held].find(([, { particle }]) => particle === this.marked) ?? [];
    if (event.key === 'n' || event.key === 'N') {
      const free = Array.from(near.mass.keys()).filter((k) => near.world.canMove(k));
      this.marked = free.find((k) => k > (this.marked ?? -1)) ?? free[0] ?? null;
    } else if (event.key === 'Enter' && this.marked !== null) {
      if (held) this.release(hand);
      else this.hold(this.marked, Array.from(near.position.subarray(2 * this.marked, 2 * this.marked + 2)), 1);
    } else if (event.key === 'Escape') {
      this.marked = null;
      this.releaseAll();
    } else if (way && held) {
      const step = (NUDGE * this.camera.height) / this.camera.zoom;
      this.#aim(held, [held.target[0] + way[0] * step, held.target[1] + way[1] * step]);
    } else return false;
    return true;
  }

  // Lines from what is held to its cursor, with the force of each hand.
  draw(context, at, theme) {
    const { world } = this.run, { particle: first, spring, count } = world.hands, b = world.view('state.particle_b'),
      force = world.view('state.hand_force');
    if (this.marked !== null && world.isShown(this.marked)) circle(context, at, this.marked, 10, theme.accent);
    for (let hand = 0; hand < count; hand++) {
      if (!world.isHeld(hand)) continue;
      const held = b[spring + hand], pull = Math.hypot(force[2 * hand], force[2 * hand + 1]),
        own = this.#held.get(hand);
      const colour = own && pull > AT_LIMIT * own.limit ? '#ffb454' : theme.accent;
      context.strokeStyle = context.fillStyle = colour;
      context.lineWidth = 1.6;
      context.beginPath();
      context.moveTo(at[2 * held], at[2 * held + 1]);
      context.lineTo(at[2 * (first + hand)], at[2 * (first + hand) + 1]);
      context.stroke();
      circle(context, at, held, 7, colour);
      const [scale, unit] = UNITS.find(([size]) => pull >= size) ?? UNITS.at(-1),
        text = `${Number((pull / scale).toPrecision(3))} ${unit}`;
      context.font = '600 13px system-ui, sans-serif';
      context.lineWidth = 3;
      context.strokeStyle = theme.card;
      context.strokeText(text, at[2 * (first + hand)] + 14, at[2 * (first + hand) + 1] - 16);
      context.fillText(text, at[2 * (first + hand)] + 14, at[2 * (first + hand) + 1] - 16);
    }
  }
}

function circle(context, at, slot, radius, colour) {
  context.strokeStyle = colour;
  context.lineWidth = 2;
  context.beginPath();
  context.arc(at[2 * slot], at[2 * slot + 1], radius, 0, 7);
  context.stroke();
}
