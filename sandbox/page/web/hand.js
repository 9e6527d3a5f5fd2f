// Hand: mouse, fingers and keys on the picture become commands: drag, pin, cut, make; what is empty moves the view. While
// time stands what is dragged goes elsewhere.
import { Cursor, CURSOR_POINTER, thingOf } from './cursor.js';
import { HANDS } from './shared.js';
import { Stroke } from './stroke.js';
/** @import { Camera } from './camera.js' */
/** @import { Maker } from './maker.js' */
/** @import { Run } from './run.js' */
/** @import { Command, HandEvents, Point, Pressed, Theme } from './types.js' */
/** @import { World } from './world.js' */

const { STRENGTH, AT_LIMIT, SOFT_REACH, PICK_RADIUS } = HANDS;
// Units of force, and how many newtons each is.
const FORCES = /** @type {[size: number, name: string][]} */ (HANDS.UNITS);
/** @type {Record<string, number>} */
const REACH = { mouse: PICK_RADIUS, pen: 16, touch: 26 };
const WHEEL_ZOOM = 1.0015;
// Two taps so soon after each other [ms] and so near to each other [pixels] are one gesture.
const TWICE = 350, BESIDE = 30;
// A press that rests so long [ms] asks for a menu; what moves farther [pixels] rests no more: it drags.
const LONG = 500, RESTS = 10;
/** @typedef {{ x: number, y: number }} Pixel */
/** Where and when a finger came down [ms].
 * @typedef {Pixel & { time: number }} Touch */
/**
 * What a pointer does, and where it is; hand: that it moves; point: where it cut last [m]; within: how far it reaches
 * [m]; cut: how many springs it has cut, by a stroke; asks: of which particle it asks for a menu; timer: until it does.
 * @typedef {Pixel & { kind: 'pan' | 'cut' | 'hold' | 'carry' | 'make' | 'done', began: Touch, isBeside: boolean,
 *   hand: number | null, carried: number, point: Point, within: number, gesture: number, cut: number,
 *   stroke: Stroke | null, asks: number | null, timer: number }} Pointer
 */
/**
 * What a hand holds, where it draws it [m], how far that is from the pointer, how far that reaches [m], and its largest
 * force [N].
 * @typedef {{ particle: number, gesture: number, beside: Point, within: number, target: Point, isMoved: boolean,
 *   limit: number }} Held
 */
/** A place [m] beside a point, to millimetres or to what nobody sees where that is finer: links are short for it.
 * @type {(point: Point, beside: Point, within: number) => Point} */
function shifted(point, beside, within) {
  const grains = 10 ** Math.max(3, Math.ceil(-Math.log10(within / 28)));
  return [Math.round((point[0] + beside[0]) * grains) / grains, Math.round((point[1] + beside[1]) * grains) / grains];
}
/** @type {(one: Pixel, two: Pixel, within: number) => boolean} */
const isNear = (one, two, within) => Math.hypot(one.x - two.x, one.y - two.y) <= within;

// What of a world lies near a point [m].
class Near {
  /** @param {World} world */
  constructor(world) {
    this.world = world;
    this.position = world.view('state.position');
    this.origin = world.view('state.origin');
    this.radius = world.view('state.radius');
    this.mass = world.view('state.mass');
    this.inverse_mass = world.view('state.inverse_mass');
    this.particle_active = world.view('state.particle_active');
    this.owner = world.view('state.owner');
    this.particle_a = world.view('state.particle_a');
    this.particle_b = world.view('state.particle_b');
    this.spring_active = world.view('state.spring_active');
    this.material = world.view('state.material');
  }

  /** @type {(count: number, distance: (k: number) => number, within: number) => number | null} */
  #nearest(count, distance, within) {
    let best = /** @type {number | null} */ (null), least = within;
    for (let k = 0; k < count; k++) {
      const away = distance(k);
      if (away < least) [best, least] = [k, away];
    }
    return best;
  }

  /** @type {(slot: number, point: Point) => number} */
  #away(slot, [x, y]) {
    return Math.hypot(this.position[2 * slot] - x, this.position[2 * slot + 1] - y);
  }

  /** @type {(point: Point, within: number) => number | null} */
  particle(point, within) {
    /** @type {(k: number) => number} */
    const away = (k) => (this.world.isShown(k) ? this.#away(k, point) - this.radius[k] : Infinity);
    return this.#nearest(this.mass.length, away, within);
  }

  /** The free particle that a press takes: one within reach, else the nearest of a body with springs around the point.
   * @type {(point: Point, within: number) => number | null} */
  free(point, within) {
    const pressed = this.particle(point, within);
    if (pressed !== null && this.inverse_mass[pressed] > 0) return pressed;
    /** @type {Map<number, Set<string>>} */
    const sides = new Map();
    this.#eachSpring((s, a, b) => {
      const of = sides.get(this.owner[a]) ?? new Set();
      sides.set(this.owner[a], of);
      for (const u of [0, 1]) {
        const low = this.position[2 * a + u], high = this.position[2 * b + u], v = 1 - u;
        if (low <= point[u] === high <= point[u]) continue;
        const part = (point[u] - low) / (high - low),
          at = this.position[2 * a + v] + (this.position[2 * b + v] - this.position[2 * a + v]) * part;
        of.add(`${u}${at <= point[v]}`);
      }
    });
    /** @type {(k: number) => boolean} */
    const isTaken = (k) => this.world.canMove(k) && sides.get(this.owner[k])?.size === 4;
    return this.#nearest(this.mass.length, (k) => (isTaken(k) ? this.#away(k, point) : Infinity), Infinity);
  }

  /** @type {(act: (spring: number, a: number, b: number) => void) => void} */
  #eachSpring(act) {
    for (let s = 0; s < this.spring_active.length; s++) {
      if (this.spring_active[s] && this.material[s] >= 0) act(s, this.particle_a[s], this.particle_b[s]);
    }
  }

  /** @type {(point: Point, within: number) => number[]} */
  spring([x, y], within) {
    let best = /** @type {number | null} */ (null), least = within;
    this.#eachSpring((s, a, b) => {
      const [ax, ay, bx, by] = this.#ends(a, b), dx = bx - ax, dy = by - ay;
      const part = Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1), 0), 1);
      const away = Math.hypot(ax + dx * part - x, ay + dy * part - y);
      if (away < least) [best, least] = [s, away];
    });
    return best === null ? [] : [best];
  }

  /** @type {(a: number, b: number) => [number, number, number, number]} */
  #ends(a, b) {
    return [this.position[2 * a], this.position[2 * a + 1], this.position[2 * b], this.position[2 * b + 1]];
  }

  /** @type {(p: Point, q: Point) => number[]} */
  crossing(p, q) {
    /** @type {number[]} */
    const found = [];
    /** @type {(ux: number, uy: number, vx: number, vy: number, wx: number, wy: number) => number} */
    const area = (ux, uy, vx, vy, wx, wy) => (vx - ux) * (wy - uy) - (vy - uy) * (wx - ux);
    this.#eachSpring((s, a, b) => {
      const [ax, ay, bx, by] = this.#ends(a, b);
      const straddles = area(...p, ...q, ax, ay) * area(...p, ...q, bx, by) <= 0
        && area(ax, ay, bx, by, ...p) * area(ax, ay, bx, by, ...q) <= 0;
      /** @type {(u: 0 | 1, start: number, end: number) => boolean} */
      const meets = (u, start, end) => Math.min(start, end) <= Math.max(p[u], q[u])
        && Math.max(start, end) >= Math.min(p[u], q[u]);
      if (straddles && meets(0, ax, bx) && meets(1, ay, by)) found.push(s);
    });
    return found;
  }

  /** How far a hand reaches into a soft body [m]; 0 where it is not soft.
   * @type {(particle: number) => number} */
  grip(particle) {
    const active = this.world.view('state.constraint_active'), kind = this.world.view('state.constraint_kind');
    const first = this.world.view('state.constraint_first'), corner = this.world.view('state.corner_particle');
    const owner = this.owner[particle];
    if (!active.some((is, k) => is !== 0 && kind[k] === this.world.areaKind
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

  /** @type {(particle: number) => number} */
  bodyMass(particle) {
    return this.mass.reduce((sum, mass, k) =>
      sum + (this.particle_active[k] && this.owner[k] === this.owner[particle] ? mass : 0), 0);
  }
}

export class Hands {
  tool = 'drag';
  /** @type {Map<number, Pointer>} */
  #pointers = new Map();
  /** What each hand holds that a pointer or a key moves.
   * @type {Map<number, Held>} */
  #held = new Map();
  /** @type {Touch | null} */
  #tapped = null;
  #closing = new AbortController();

  /** isStill: whether time stands; changed: called when the view has been moved by hand; fit: shows all again; say: tells a person a line;
   * menu: asks what is to be done to a particle; speak: tells who listens what was done.
   * @param {HTMLCanvasElement} canvas @param {Run} run @param {Camera} camera @param {Maker} maker
   * @param {HandEvents} events */
  constructor(canvas, run, camera, maker, { isStill, changed, fit, say, menu, speak }) {
    this.maker = maker;
    this.isStill = isStill;
    this.speak = speak;
    this.menu = menu;
    this.canvas = canvas;
    this.run = run;
    this.camera = camera;
    this.changed = changed;
    this.fit = fit;
    this.say = say;
    this.cursor = new Cursor(run, camera, { press: (at) => this.#pressByKey(at), move: (at) => this.#move(at),
      lift: (at) => this.#lift(at), menu, releaseAll: () => this.releaseAll() }, speak);
    const how = { signal: this.#closing.signal, passive: false };
    /** @type {<N extends keyof HTMLElementEventMap>(name: N, act: (event: HTMLElementEventMap[N]) => void) => void} */
    const on = (name, act) => canvas.addEventListener(name, act, how);
    on('pointerdown', (event) => this.#press(event));
    on('pointermove', (event) => this.#move(event));
    // Whatever ends a press, it ends the capture.
    on('pointerup', (event) => this.#lift(event));
    on('lostpointercapture', (event) => this.#lift(event));
    on('contextmenu', (event) => event.preventDefault());
    on('wheel', (event) => this.#turn(event));
  }

  close() {
    this.#closing.abort();
  }

  // Whether a pointer or a key holds something.
  get isBusy() {
    return this.#held.size > 0;
  }

  /** The free particle that a press on the picture takes; null: none.
   * @type {(event: PointerEvent) => number | null} */
  reached({ offsetX, offsetY, pointerType }) {
    const within = REACH[pointerType] / this.camera.zoom;
    return new Near(this.run.world).free(this.camera.toWorld(offsetX, offsetY), within);
  }

  /** A wheel zooms, unless it would scroll the page and the picture was not clicked before.
   * @type {(event: WheelEvent) => void} */
  #turn(event) {
    const { scrollHeight, clientHeight } = document.documentElement;
    if (scrollHeight > clientHeight && document.activeElement !== this.canvas && !event.ctrlKey) return;
    event.preventDefault();
    this.camera.zoomAbout(event.offsetX, event.offsetY, WHEEL_ZOOM ** -event.deltaY);
    this.changed();
  }

  /** @type {(event: PointerEvent) => void} */
  #press(event) {
    event.preventDefault();
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    this.cursor.forget();
    this.#begin(event);
  }

  /** Use the tool at the cursor of keys. Whether that goes on until it is lifted.
   * @type {(at: Pressed) => boolean} */
  #pressByKey(at) {
    this.#begin(at);
    const kind = this.#pointers.get(at.pointerId)?.kind ?? 'done', drops = this.maker.part(this.tool) !== undefined;
    const goesOn = ['hold', 'carry', 'cut', 'make'].includes(kind) && !drops;
    // There is no way to go from where a part falls.
    if (drops) this.#lift({ ...at, type: 'pointerup' });
    if (!goesOn) this.#pointers.delete(at.pointerId);
    if (kind === 'pan' && at.particle === null) this.speak('Nothing is here. N goes to the next thing.');
    return goesOn;
  }

  /** Use the tool where a pointer or the cursor of keys came down.
   * @type {(event: Pressed) => void} */
  #begin(event) {
    const point = this.camera.toWorld(event.offsetX, event.offsetY),
      within = REACH[event.pointerType] / this.camera.zoom;
    /** @type {Pointer} */
    const pointer = { x: event.offsetX, y: event.offsetY, kind: 'pan', isBeside: false, hand: null, carried: -1, point, within,
      gesture: 0, cut: 0, stroke: null, asks: null, timer: 0, began: { x: event.offsetX, y: event.offsetY, time: event.timeStamp } };
    this.#pointers.set(event.pointerId, pointer);
    const near = new Near(this.run.world), { particle: marked = null } = event;
    const touched = marked ?? near.particle(point, within);
    const free = marked === null ? near.free(point, within) : near.world.canMove(marked) ? marked : null;
    if (event.button === 2) pointer.asks = touched ?? free;
    if (event.button !== 0 || event.altKey) return;
    pointer.isBeside = this.tool !== 'cut' && touched === null && free === null && this.#pointers.size === 1;
    if (this.tool === 'cut') {
      Object.assign(pointer, { kind: 'cut', gesture: this.run.newGesture() });
      pointer.stroke = new Stroke(near, point, within, (springs, at) => this.#cut(pointer, springs, at));
    } else if (this.tool === 'pin') this.#pin(near, touched, pointer);
    else if (this.tool === 'erase') this.#erase(touched ?? free, pointer);
    else if (this.maker.makes(this.tool)) {
      // A second finger moves the view, with the one that drew.
      if (this.#pointers.size > 1) {
        this.maker.forget();
        for (const each of this.#pointers.values()) if (each.kind === 'make') each.kind = 'pan';
      } else {
        pointer.kind = 'make';
        this.maker.begin(point, touched ?? free);
      }
    }
    else if (free !== null || (touched !== null && this.#canCarry)) this.#take(pointer, touched ?? free ?? -1, free, event);
    else if (touched !== null) this.say('This particle is pinned. Choose Pin and touch it to unpin it.');
  }

  /** Take hold of a particle that is free; while time stands, of the body of one that is touched, to put it elsewhere,
   * where the level lets hands do it.
   * @type {(pointer: Pointer, touched: number, free: number | null, event: Pressed) => void} */
  #take(pointer, touched, free, { pointerType }) {
    if (this.#canCarry) Object.assign(pointer, { kind: 'carry', carried: touched, gesture: this.run.newGesture() });
    else if (free !== null) {
      pointer.hand = this.hold(free, pointer.point, pointer.within);
      if (pointer.hand !== null) pointer.kind = 'hold';
      else if (this.isStill()) pointer.kind = 'done';
      if (pointer.hand !== null && this.isStill()) this.say(HANDS.TIME_STANDS);
    }
    const particle = pointer.kind === 'hold' && free !== null ? free : touched;
    if (pointer.kind === 'carry' || pointer.kind === 'hold') this.speak(`Holding ${this.#thing(particle)}.`);
    if (pointerType !== 'mouse') pointer.timer = setTimeout(() => this.#ask(pointer, particle), LONG);
  }

  get #canCarry() {
    const { world } = this.run;
    return this.isStill() && world.commands.lets('move_body', world.view('state.deed_refused'));
  }

  /** Put the body that a pointer carries elsewhere, as far as the pointer has gone.
   * @type {(pointer: Pointer, point: Point) => void} */
  #carry(pointer, [x, y]) {
    const [fromX, fromY] = pointer.point, by = shifted([x - fromX, y - fromY], [0, 0], pointer.within);
    if (!by[0] && !by[1]) return;
    const record = /** @type {Command} */ ({ type: 'move_body', particle: pointer.carried, by });
    if (this.run.submit(record, pointer.gesture, this.say)) pointer.point = [fromX + by[0], fromY + by[1]];
    else pointer.kind = 'done';
  }

  /** Ask what is to be done to a particle, with a finger that has rested on it.
   * @type {(pointer: Pointer, particle: number) => void} */
  #ask(pointer, particle) {
    if (pointer.hand !== null && !this.#heldBy(pointer)) return;
    if (pointer.hand !== null) this.release(pointer.hand);
    pointer.kind = 'done';
    this.menu({ particle, x: pointer.x, y: pointer.y });
  }

  /** Two taps where nothing is show all again.
   * @type {(began: Touch, ended: number) => void} */
  #tap(began, ended) {
    const first = this.#tapped, isSecond = first !== null && ended - first.time < TWICE
      && isNear(began, first, BESIDE);
    this.#tapped = isSecond ? null : began;
    if (isSecond) this.fit();
  }

  /** @type {(near: Near, particle: number | null, pointer: Pointer) => void} */
  #pin(near, particle, pointer) {
    if (particle === null) return;
    pointer.kind = 'done';
    const type = near.inverse_mass[particle] > 0 ? 'pin' : 'unpin';
    const isDone = this.run.submit({ type, particle }, this.run.newGesture(), this.say);
    if (isDone) this.speak(`${this.#thing(particle)} is ${type === 'pin' ? 'pinned' : 'free'}.`);
  }

  /** @type {(particle: number | null, pointer: Pointer) => void} */
  #erase(particle, pointer) {
    if (particle === null) return;
    pointer.kind = 'done';
    this.remove(particle);
  }

  /** Take a particle out, with what hangs on it.
   * @type {(particle: number) => void} */
  remove(particle) {
    const thing = this.#thing(particle);
    if (this.run.submit({ type: 'remove', particle }, this.run.newGesture(), this.say)) this.speak(`${thing} is gone.`);
  }

  /** @type {(pointer: Pointer, springs: number[], at: number[]) => void} */
  #cut(pointer, springs, at) {
    if (!springs.length) return;
    if (this.run.submit({ type: 'cut_springs', springs, at }, pointer.gesture, this.say)) pointer.cut += springs.length;
  }

  /** The thing that a particle is of, as it is spoken of.
   * @type {(particle: number) => string} */
  #thing(particle) {
    return thingOf(this.run.world.names.particle[particle]);
  }

  /** Take a particle into a free hand and draw it to a point [m]. The hand; null where none is free.
   * @type {(particle: number, point: Point, within: number) => number | null} */
  hold(particle, point, within) {
    const gesture = this.run.newGesture();
    this.run.takeUp(gesture);
    const near = new Near(this.run.world), { world } = this.run, { position } = near;
    const hand = Array.from({ length: world.hands.count }, (_, k) => k).find((k) => !world.isHeld(k));
    if (hand === undefined) return null;
    const dx = position[2 * particle] - point[0], dy = position[2 * particle + 1] - point[1];
    /** A particle at the pointer goes to it; one that is farther off keeps its distance, so that nothing jumps.
     * @type {Point} */
    const beside = Math.hypot(dx, dy) <= within + near.radius[particle] ? [0, 0] : [dx, dy];
    const target = shifted(point, beside, within);
    // What a command changes may lie elsewhere after it: all is asked before.
    const limit = STRENGTH * near.bodyMass(particle);
    /** @type {Command} */
    const record = { type: 'grab', grab: hand, particle, target, strength: STRENGTH, radius: near.grip(particle) };
    if (!this.run.submit(record, gesture, this.say)) return null;
    this.#held.set(hand, { particle, gesture, beside, within, target, isMoved: false, limit });
    return hand;
  }

  /** @type {(event: Pressed) => void} */
  #move(event) {
    const pointer = this.#pointers.get(event.pointerId);
    if (!pointer) return;
    if (!event.buttons) {
      this.#lift(event);
      return;
    }
    const [x, y] = [event.offsetX, event.offsetY], point = this.camera.toWorld(x, y),
      held = this.#heldBy(pointer);
    if (held) this.#aim(held, point);
    else if (pointer.kind === 'cut') pointer.stroke?.go(new Near(this.run.world), point);
    else if (pointer.kind === 'carry') this.#carry(pointer, point);
    else if (pointer.kind === 'make') this.maker.go(point, pointer.within);
    else if (pointer.kind === 'pan') this.#moveView(pointer, x, y);
    Object.assign(pointer, { x, y });
    pointer.isBeside &&= isNear(pointer, pointer.began, BESIDE);
    if (isNear(pointer, pointer.began, RESTS)) return;
    pointer.asks = null;
    clearTimeout(pointer.timer);
  }

  /** One finger moves the view, two turn it larger or smaller as well.
   * @type {(pointer: Pointer, x: number, y: number) => void} */
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

  /** @type {(held: Held, point: Point) => void} */
  #aim(held, point) {
    held.target = shifted(point, held.beside, held.within);
    held.isMoved = true;
  }

  /** @type {(event: Pressed) => void} */
  #lift(event) {
    const pointer = this.#pointers.get(event.pointerId);
    this.#pointers.delete(event.pointerId);
    if (!pointer) return;
    clearTimeout(pointer.timer);
    if (event.type === 'pointerup' && pointer.kind === 'make' && this.maker.isAtWork) this.#make(event, pointer.within);
    if (event.type === 'pointerup' && pointer.asks !== null) {
      this.menu({ particle: pointer.asks, x: pointer.x, y: pointer.y });
    }
    pointer.stroke?.end(this.run.world);
    if (pointer.cut) this.speak(`Cut: ${pointer.cut} ${pointer.cut === 1 ? 'spring' : 'springs'}.`);
    const held = this.#heldBy(pointer);
    if (pointer.hand !== null && held) {
      this.release(pointer.hand);
      this.speak(`Let go of ${this.#thing(held.particle)}.`);
    }
    else if (pointer.kind === 'carry') this.speak(`Let go of ${this.#thing(pointer.carried)}.`);
    else if (pointer.isBeside && event.type === 'pointerup') this.#tap(pointer.began, event.timeStamp);
  }

  /** Make what was drawn, up to where the pointer is lifted: the view may have moved since the pointer did.
   * @type {(at: Pressed, within: number) => void} */
  #make({ offsetX, offsetY }, within) {
    const near = new Near(this.run.world), point = this.camera.toWorld(offsetX, offsetY);
    const isMade = this.maker.end(this.tool, point, near.particle(point, within) ?? near.free(point, within), within);
    if (isMade) this.speak(`A new ${this.maker.part(this.tool)?.name ?? this.tool} is there.`);
  }

  /** @type {(pointer: Pointer) => Held | undefined} */
  #heldBy({ hand }) {
    return hand === null ? undefined : this.#held.get(hand);
  }

  /** @type {(hand: number) => void} */
  release(hand) {
    const held = this.#held.get(hand);
    if (!held) return;
    const { gesture } = held;
    this.#held.delete(hand);
    if (this.run.world.isHeld(hand)) this.run.submit({ type: 'release', grab: hand }, gesture, this.say);
  }

  releaseAll() {
    [...this.#held.keys()].forEach((hand) => this.release(hand));
  }

  // End what pointers do, as if they were lifted. What Enter took stays in hand.
  letGo() {
    for (const [id, { hand }] of [...this.#pointers].filter(([id]) => id !== CURSOR_POINTER)) {
      if (hand !== null) this.release(hand);
      this.#pointers.delete(id);
    }
  }

  // Hold nothing any more, as time has jumped.
  forget() {
    this.#held.clear();
    this.maker.forget();
    this.cursor.lift();
    for (const pointer of this.#pointers.values()) Object.assign(pointer, { kind: 'done', hand: null });
  }

  // Before a tick: send every hand to where its pointer is now.
  update() {
    for (const [hand, held] of this.#held) {
      // What is held may have gone.
      if (!this.run.world.isHeld(hand)) this.#held.delete(hand);
      else if (held.isMoved) {
        this.run.submit({ type: 'move_grab', grab: hand, target: held.target }, held.gesture, this.say);
      }
      held.isMoved = false;
    }
  }

  /** Lines from what is held to its cursor, with the force of each hand.
   * @type {(context: CanvasRenderingContext2D, at: Float64Array, theme: Theme) => void} */
  draw(context, at, theme) {
    const { world } = this.run, { particle: first, spring, count } = world.hands, b = world.view('state.particle_b'),
      force = world.view('state.hand_force');
    this.maker.draw(context, this.tool, (x, y) => this.camera.toPixels(x, y), theme);
    this.cursor.draw(context, at, theme);
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
      const [scale, unit] = FORCES.find(([size]) => pull >= size) ?? FORCES[FORCES.length - 1],
        text = `${Number((pull / scale).toPrecision(3))} ${unit}`;
      context.font = '600 13px system-ui, sans-serif';
      context.lineWidth = 3;
      context.strokeStyle = theme.card;
      context.strokeText(text, at[2 * (first + hand)] + 14, at[2 * (first + hand) + 1] - 16);
      context.fillText(text, at[2 * (first + hand)] + 14, at[2 * (first + hand) + 1] - 16);
    }
  }
}

/** @type {(context: CanvasRenderingContext2D, at: Float64Array, slot: number, radius: number,
 *   colour: string) => void} */
function circle(context, at, slot, radius, colour) {
  context.strokeStyle = colour;
  context.lineWidth = 2;
  context.beginPath();
  context.arc(at[2 * slot], at[2 * slot + 1], radius, 0, 7);
  context.stroke();
}
