// Toy: a level that plays on a canvas; and the handle by which a page of one's own plays, reads and listens.
import { Camera } from './camera.js';
import { Checks } from './checks.js';
import { Refusal } from './commands.js';
import { typed } from './cursor.js';
import { Picture } from './draw.js';
import { Drives } from './drives.js';
import { load } from './files.js';
import { Hands } from './hand.js';
import { linkOf } from './link.js';
import { Maker } from './maker.js';
import { Pace } from './pace.js';
import { contextOf } from './paint.js';
import { written } from './recording.js';
import { fired, outcome } from './rules.js';
import { Run } from './run.js';
import { Sound } from './sound.js';
/** @import { Box, Command, Fresh, Level, NamedRecord, Rank, Theme, ToyEvents } from './types.js' */

const KEY_ZOOM = 1.15, SLICE = 12;
// How long the view takes to where another part of the canvas is free [s].
const GLIDE = 0.3;
const TYPED_INTO = 'input, select, textarea, [contenteditable], .pad';
const light = matchMedia('(prefers-color-scheme: light)'), calm = matchMedia('(prefers-reduced-motion: reduce)');

/** @typedef {'dark' | 'light'} ThemeName */

// It tells what happens as events: tick, break { springs }, check { name, holds, value }, rules { actions },
// outcome { isWon, text, stars, tick }, way { done, all }, say { text, rank }, menu { particle, x, y }, speak { text }, pause,
// pace { isBehind }, jump, theme and draw.
export class Toy extends EventTarget {
  #pace = new Pace();
  #isDirty = true;
  #isMoved = false;
  #isSeen = true;
  /** @type {number} */
  #frame = 0;
  #checks;
  #previous;
  /** @type {ThemeName | null} */
  #chosenTheme = null;
  /** @type {Box | null} */
  #room = null;
  /** From where the view goes to where the room is, and when that began [s].
   * @type {{ x: number, y: number, zoom: number, began: number } | null} */
  #glide = null;
  // The tick to which the run goes on in slices, where it has not come to it.
  #ahead = 0;
  #closing = new AbortController();
  isPaused = false;
  // Whether the machine is too slow for it of late.
  isBehind = false;
  /** Draws what is seen behind everything.
   * @type {((part: number, seconds: number) => void) | null} */
  shade = null;
  // How fast time passes: 1 as in the world.
  speed = 1;

  /**
   * level: what Python says of it; fresh: gives its world before the first tick; keyboard: what keys are listened to.
   * @param {HTMLCanvasElement} canvas
   * @param {Level} level
   * @param {Fresh} fresh
   * @param {HTMLElement | Window} [keyboard]
   */
  constructor(canvas, level, fresh, keyboard = canvas) {
    super();
    this.canvas = canvas;
    this.level = level;
    this.fresh = fresh;
    this.world = fresh();
    this.camera = new Camera();
    const { commands = [], hashes = [''] } = level.recording ?? {};
    this.run = new Run(this.world, commands, hashes.length - 1);
    this.#ahead = level.begin;
    this.picture = new Picture(canvas, level.scene, this.world, () => { this.#isDirty = true; });
    const maker = new Maker(this.run, level.about.adding, (text) => this.say(text));
    this.hands = new Hands(canvas, this.run, this.camera, maker, {
      isStill: () => this.isPaused, menu: (asked) => this.#tell('menu', asked), speak: (text) => this.#tell('speak', { text }),
      changed: () => { this.#isMoved = this.#isDirty = true; }, fit: () => this.fit(), say: (text) => this.say(text),
    });
    this.drives = new Drives(this.run, level.keys, level.about.names.key, (text) => this.say(text));
    this.sound = new Sound(this.world, level.sounds, level.scene.water);
    this.#checks = new Checks(level, this.world);
    this.#previous = this.world.view('state.position').slice();
    this.#listen(keyboard);
    this.#frame = requestAnimationFrame((now) => this.#play(now));
  }

  /** @type {(keyboard: HTMLElement | Window) => void} */
  #listen(keyboard) {
    const { canvas } = this, { signal } = this.#closing;
    /** @type {<E extends Event>(target: EventTarget, name: string, act: (event: E) => void) => void} */
    const on = (target, name, act) => target.addEventListener(name, /** @type {EventListener} */ (act), { signal });
    if (!canvas.hasAttribute('tabindex')) canvas.tabIndex = 0;
    canvas.style.touchAction = 'none';
    const size = new ResizeObserver(() => this.#resize()), sight = new IntersectionObserver((seen) => {
      // Several may be told at once, the newest last.
      this.#isSeen = seen[seen.length - 1].isIntersecting;
      if (!this.#isSeen) this.#letGo();
    });
    size.observe(canvas);
    sight.observe(canvas);
    signal.addEventListener('abort', () => [size, sight].forEach((each) => each.disconnect()));
    on(keyboard, 'keydown', (/** @type {KeyboardEvent} */ event) => this.#key(event));
    on(keyboard, 'keyup', (/** @type {KeyboardEvent} */ event) => this.drives.lifted(event));
    on(keyboard, 'blur', () => this.drives.releaseTyped());
    for (const name of ['blur', 'pagehide']) on(globalThis, name, () => this.#letGo());
    on(document, 'visibilitychange', () => this.#letGo());
    // Also while time stands: what is drawn there is seen, and what was made.
    for (const name of ['pointerdown', 'pointermove', 'pointerup']) on(canvas, name, () => this.refresh());
    on(light, 'change', () => this.#dress());
    this.#dress();
    this.#resize();
  }

  // Let go what keys and pointers hold: who is elsewhere is not heard when they are lifted.
  #letGo() {
    this.hands.letGo();
    this.drives.releaseAll();
    this.sound.rest();
  }

  /** @type {(event: KeyboardEvent) => void} */
  #key(event) {
    const on = event.target instanceof Element ? event.target : this.canvas;
    if (on.matches(TYPED_INTO)) return;
    if (on.matches('button, a') && [' ', 'Enter'].includes(event.key)) return;
    if (!this.drives.typed(event) && !this.#does(event)) return;
    this.refresh();
    event.preventDefault();
  }

  /** Whether a key of no drive was of use.
   * @type {(event: KeyboardEvent) => boolean} */
  #does(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    if (event.key === ' ') this.toggle();
    else if (event.key === '.') this.step();
    else if (event.key === '+' || event.key === '-') {
      this.#isMoved = true;
      this.camera.zoomAbout(this.camera.width / 2, this.camera.height / 2, event.key === '+' ? KEY_ZOOM : 1 / KEY_ZOOM);
    } else if (['f', 'Home'].includes(typed(event))) this.fit();
    else return this.hands.cursor.key(event);
    return true;
  }

  // Draw at the next frame, also while time stands.
  refresh() {
    this.#isDirty = true;
  }

  /** @type {<N extends keyof ToyEvents>(name: N, detail?: ToyEvents[N]) => void} */
  #tell(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { detail }));
  }

  /** Tell a person something in a line; rank: see messages.js.
   * @type {(text: string, rank?: Rank) => void} */
  say(text, rank = 'refusal') {
    this.#tell('say', { text, rank });
  }

  /** @type {ThemeName} */
  get #themeName() {
    return this.#chosenTheme ?? this.level.scene.theme ?? (light.matches ? 'light' : 'dark');
  }

  /** @type {Theme} */
  get theme() {
    return this.level.scene.themes[this.#themeName];
  }

  /** 'dark', 'light', or null: that of the level, or else of the viewer.
   * @param {ThemeName | null} name */
  set theme(name) {
    this.#chosenTheme = name;
    this.#dress();
  }

  #dress() {
    this.#tell('theme', { name: this.#themeName });
    this.refresh();
  }

  /** Where nothing covers the canvas [pixels]: the level is shown there. null: nowhere something does.
   * @param {Box | null} box */
  set room(box) {
    const { x, y, zoom } = this.camera, isFirst = !this.#room;
    this.#room = box;
    this.#resize();
    if (!isFirst && !this.#isMoved && !calm.matches) this.#glide = { x, y, zoom, began: performance.now() / 1000 };
  }

  #resize() {
    this.camera.width = Math.max(this.canvas.clientWidth, 1);
    this.camera.height = Math.max(this.canvas.clientHeight, 1);
    this.#glide = null;
    if (!this.#isMoved) this.camera.fit(this.level.scene.view, this.#room);
    this.refresh();
  }

  /** Go on with the way to where the room is.
   * @type {(seconds: number) => void} */
  #follow(seconds) {
    const from = this.#glide, { camera } = this;
    if (!from || this.#isMoved) return;
    const part = Math.min((seconds - from.began) / GLIDE, 1), left = (1 - part) ** 2;
    camera.fit(this.level.scene.view, this.#room);
    for (const key of /** @type {const} */ (['x', 'y', 'zoom'])) camera[key] += (from[key] - camera[key]) * left;
    if (part < 1) this.refresh();
    else this.#glide = null;
  }

  // Show the whole level.
  fit() {
    this.#isMoved = false;
    this.#resize();
  }

  /** @type {(now: number) => void} */
  #play(now) {
    const pace = this.#pace;
    if (this.isPaused || !this.#isSeen || this.isOnItsWay) pace.rest(now);
    if (this.isOnItsWay) this.#goOn();
    else if (this.#isSeen) this.#guarded(() => {
      if (!this.isPaused) pace.pass(now, this.rate * this.speed, () => {
        this.tick();
        return !this.isPaused;
      });
      if (!this.isPaused || this.#isDirty) this.#draw(now / 1000);
    });
    if (this.isBehind !== pace.isBehind) {
      this.isBehind = pace.isBehind;
      this.#tell('pace', { isBehind: this.isBehind });
    }
    this.#frame = requestAnimationFrame((next) => this.#play(next));
  }

  /** @type {(seconds: number) => void} */
  #draw(seconds) {
    this.#isDirty = false;
    this.#follow(seconds);
    const part = this.isPaused ? 1 : this.#pace.part;
    this.picture.draw(this.camera, this.theme, this.#previous, part, seconds, () => this.shade?.(part, seconds));
    this.hands.draw(contextOf(this.canvas), this.picture.at, this.theme);
    this.#tell('draw');
  }

  /** Do something; where it fails, time stands and a line says why.
   * @type {(act: () => void) => void} */
  #guarded(act) {
    try {
      act();
    } catch (error) {
      this.#ahead = 0;
      this.pause();
      this.say(error instanceof Refusal ? error.message : 'Something went wrong here; start again.', 'fault');
      if (!(error instanceof Refusal)) console.error(error);
    }
  }

  // Whether it goes to a tick of its recording that it has not come to.
  get isOnItsWay() {
    return this.#ahead > this.run.time && this.run.isFollowing;
  }

  // A slice of the way to a tick.
  #goOn() {
    const until = performance.now() + SLICE, { run } = this;
    this.#guarded(() => {
      while (this.isOnItsWay && performance.now() < until) run.step();
    });
    this.#previous = this.world.view('state.position').slice();
    this.#tell('way', { done: run.time, all: this.#ahead });
    if (!this.isOnItsWay) this.#jump(() => { this.#ahead = 0; });
  }

  /** Go to a tick, in slices where that takes long.
   * @type {(tick: number) => void} */
  goTo(tick) {
    this.#jump(() => this.run.seek(this.run.keptBefore(tick)));
    this.#ahead = Math.min(tick, this.run.last);
    this.#goOn();
  }

  // One tick; at the end of a recording time stands still.
  tick() {
    this.hands.update();
    const wasFollowing = this.run.isFollowing, { world } = this;
    this.#previous = world.view('state.position').slice();
    this.run.step();
    this.sound.hear((particle) => {
      const [x] = this.camera.toPixels(world.view('state.position')[2 * particle], 0);
      return Math.min(Math.max((2 * x) / this.camera.width - 1, -1), 1);
    });
    this.#tell('tick');
    const { spring: names } = world.names;
    if (world.broken.length) this.#tell('break', { springs: world.broken.map((spring) => names[spring]) });
    for (const result of this.#checks.look()) this.#tell('check', result);
    this.#tellRules();
    if (wasFollowing && !this.run.isFollowing) this.pause();
    this.refresh();
  }

  // What rules that fired in this tick say, and whether one of them won or lost the level.
  #tellRules() {
    const { world } = this, actions = fired(world);
    for (const { say } of actions) if (say !== undefined) this.say(say, 'rule');
    if (actions.length) this.#tell('rules', { actions });
    const ended = actions.length ? outcome(world) : null;
    if (ended?.tick === world.time) this.#tell('outcome', ended);
  }

  // Until which tick the run is that of a recording, of what was not taken over.
  get sent() {
    return this.run.revision ? -1 : (this.level.recording?.hashes.length ?? 0) - 1;
  }

  // Whether the level is won or lost, here in time; null: neither yet.
  get outcome() {
    return outcome(this.world);
  }

  // Ticks in a second, and how much time has passed [s].
  get rate() {
    return this.world.settings().tick_rate;
  }

  get seconds() {
    return this.run.time / this.rate;
  }

  play() {
    if (this.isPaused) this.toggle();
  }

  pause() {
    if (!this.isPaused) this.toggle();
  }

  toggle() {
    this.isPaused = !this.isPaused;
    if (this.isPaused) this.sound.rest();
    this.#tell('pause', { isPaused: this.isPaused });
    this.refresh();
  }

  step() {
    this.pause();
    this.#guarded(() => this.tick());
  }

  /** Go to a tick that was reached.
   * @type {(tick: number) => void} */
  seek(tick) {
    this.#jump(() => this.run.seek(tick));
  }

  // In a level with a goal what was tuned stays.
  restart(keepsTuning = this.level.goals?.goal !== '') {
    this.#jump(() => {
      if (this.level.recording) {
        this.run.seek(0);
        return;
      }
      this.run.beginAgain(keepsTuning);
    });
    this.play();
  }

  // Back to before the last thing that was done. Whether there was one.
  undo() {
    let isDone = false;
    this.#jump(() => { isDone = this.run.undo(); });
    if (!isDone) this.say('There is nothing to undo.');
    return isDone;
  }

  // Do again what was undone last. Whether there was something.
  redo() {
    let isDone = false;
    this.#jump(() => { isDone = this.run.redo(); });
    if (!isDone) this.say('There is nothing to redo.');
    return isDone;
  }

  /** Go elsewhere in time: nothing is compared with what was before.
   * @type {(go: () => void) => void} */
  #jump(go) {
    this.hands.forget();
    this.drives.forget();
    this.#guarded(go);
    this.#previous = this.world.view('state.position').slice();
    this.sound.forget();
    this.#checks.begin();
    this.#pace.rest(performance.now());
    this.#tell('jump');
    this.refresh();
  }

  // Names of the particles that are there, as in the level's file: 'rope.39' is the last of a body named rope.
  get particles() {
    return this.world.particles.filter((slot) => this.world.isShown(slot)).map((slot) => this.world.names.particle[slot]);
  }

  /** Where a particle is [m], its velocity [m/s], and whether it is pinned.
   * @type {(name: string) => { x: number, y: number, vx: number, vy: number, isPinned: boolean }} */
  particle(name) {
    const { world } = this, slot = world.commands.slot({ names: 'particle' }, name, world.counts);
    if (!world.isShown(slot)) throw new Refusal(`particle ${name} is not there any more`);
    const [x, y] = world.view('state.position').subarray(2 * slot);
    const [vx, vy] = world.view('state.velocity').subarray(2 * slot);
    return { x, y, vx, vy, isPinned: world.view('state.inverse_mass')[slot] === 0 };
  }

  /** Carry out a command as recordings have it, with names: { type: 'set_drive', part: 'wheel', value: 1 }.
   * @type {(record: NamedRecord) => void} */
  command(record) {
    this.run.command(this.world.commands.read(record, this.world.counts), this.run.newGesture());
    this.refresh();
  }

  /** The file of what was done, a Blob that `sandbox replay` verifies.
   * @type {() => Promise<Blob>} */
  async recording() {
    const { run, level } = this, commands = run.commands.filter(({ tick }) => tick <= run.time);
    /** @type {(done: number, all: number) => void} */
    const progress = (done, all) => {
      if (done % 60 === 0) this.say(`Writing the recording: ${Math.round((100 * done) / Math.max(all, 1))} %`, 'progress');
    };
    return written(this.fresh(), level.about, level.header, commands, run.time, progress);
  }

  /** The fragment of a link to what was done; null: a link would be too long.
   * @type {() => Promise<string | null>} */
  async link() {
    const { run, world, level } = this, commands = run.commands.filter(({ tick }) => tick <= run.time);
    let tick = 0;
    const entries = commands.map(({ tick: at, gesture, record, named }) => {
      const passed = at - tick;
      tick = at;
      return { passed, gesture, record: named ?? world.commands.named(record) };
    });
    return linkOf(level.link, { commands: entries, ticks: run.time, at: 0, hash: world.hash().whole });
  }

  // Stop for good.
  close() {
    cancelAnimationFrame(this.#frame);
    this.#closing.abort();
    this.hands.close();
    this.sound.close();
  }
}

/** Play a toy's file on a canvas. kernels: the address of kernels.wasm.gz, where it is not beside this module.
 * @type {(canvas: HTMLCanvasElement, address: string, options?: { kernels?: string | URL }) => Promise<Toy>} */
export async function open(canvas, address, { kernels } = {}) {
  return new Toy(canvas, ...await load(address, kernels));
}
