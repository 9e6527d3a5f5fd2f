// Main: the page around a toy: its bars, panel, timeline and keys, and what it says.
import { Refusal } from './commands.js';
import { read } from './files.js';
import { controlsOf, Gamepads } from './gamepad.js';
import { Goals } from './goals.js';
import { isLink, linked } from './link.js';
import { Menu } from './menu.js';
import { element, Panel } from './panel.js';
import { verified } from './recording.js';
import { Toy } from './toy.js';
/** @import { Fresh, Level, ToyEvents } from './types.js' */

const SLOW = 0.2, NARROW = 640;
/** @type {Record<string, string | undefined>} */
const ARROWS = { left: '←', right: '→', up: '↑', down: '↓' };
const TOOLS = ['drag', 'pin', 'cut', 'jelly', 'wood', 'steel', 'rope', 'spring', 'rod', 'erase'];
const DRAW = 'Draw around a shape: it becomes ', PULL = 'Pull from one thing to another, or to the air: ';
/** @type {Record<string, string | undefined>} */
const MAKES = { jelly: `${DRAW}jelly.`, wood: `${DRAW}wood.`, steel: `${DRAW}steel.`, rope: `${PULL}a rope.`,
  spring: `${PULL}a spring.`, rod: `${PULL}a rod.`, erase: 'Touch a thing: it goes, with what hangs on it.' };
/** @type {Record<string, string | undefined>} */
const KEYS = { s: 'slow', r: 'again', d: 'drag', p: 'pin', c: 'cut', b: 'make', j: 'jelly', o: 'rope', x: 'erase', m: 'sound', h: 'tune', '?': 'hint' };
/** Parts of the page that are no plain elements.
 * @typedef {{ picture: HTMLCanvasElement, time: HTMLInputElement }} Parts */
/** @template {string} I @typedef {I extends keyof Parts ? Parts[I] : HTMLElement} Part */
/** @template {string} I @param {I} id @returns {Part<I>} */
function byId(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`this page has no ${id}`);
  return /** @type {Part<I>} */ (found);
}
/** @type {(button: Element | undefined, isOn: boolean) => void} */
const press = (button, isOn) => button?.setAttribute('aria-pressed', String(isOn));
/** @type {(target: EventTarget | null) => boolean} */
const isTypedInto = (target) => target instanceof Element && target.matches('input, select, .pad');

class Page {
  // Names of the keys that have buttons, and what ends with these.
  #keys = '';
  #closing = new AbortController();
  /** @type {Gamepads | undefined} */
  gamepads;

  /** words: what there is to say at first.
   * @param {Level} level @param {Fresh} fresh @param {string} words */
  constructor(level, fresh, words) {
    this.toy = new Toy(byId('picture'), level, fresh, window);
    this.panel = new Panel(byId('panel'), this.toy.run, level.materials, level);
    this.goals = new Goals(this.toy, level.goals, { goal: byId('goal'), score: byId('score'), end: byId('end-card'),
      again: byId('end-again'), on: byId('end-on') });
    this.menu = new Menu(byId('menu'), this.toy, level.about.adding.made.words);
    this.#bind();
    this.#listen();
    this.#addDriveKeys();
    this.#theme(this.toy.theme.name);
    this.#makeRoom();
    addEventListener('resize', () => {
      this.#makeRoom();
      this.panel.show();
    });
    // Who turns a phone has another picture, whatever was pinched before.
    matchMedia('(orientation: portrait)').addEventListener('change', () => this.toy.fit());
    if (level.recording) this.#verify();
    this.#say(words || (level.recording ? 'A recording. Touch it to take over.' : ''), words && 'bad');
    // A page of a disk has no address that others could open.
    byId('link').hidden = !location.protocol.startsWith('http');
    byId('picture').focus({ preventScroll: true });
  }

  #bind() {
    const { toy } = this;
    /** @type {Record<string, () => unknown>} */
    const acts = {
      play: () => toy.toggle(), step: () => toy.step(), again: () => toy.restart(), undo: () => toy.undo(),
      slow: () => {
        toy.speed = toy.speed === 1 ? SLOW : 1;
        press(byId('slow'), toy.speed !== 1);
      },
      sound: () => {
        toy.sound.toggle();
        press(byId('sound'), toy.sound.isOn);
      },
      tune: () => this.#show('panel', 'tune'), make: () => this.#show('makers', 'make'), hint: () => this.#show('hints', 'hint'), save: () => this.#save(),
      link: () => this.#copyLink(),
    };
    for (const tool of TOOLS) acts[tool] = () => this.#choose(tool);
    for (const [id, act] of Object.entries(acts)) byId(id).addEventListener('click', act);
    byId('time').addEventListener('input', () => {
      toy.pause();
      toy.goTo(Number(byId('time').value));
    });
    // The toy hears keys first.
    addEventListener('keydown', (event) => {
      const isCommand = event.ctrlKey || event.metaKey;
      if (event.defaultPrevented || event.altKey || isTypedInto(event.target)) return;
      const act = isCommand ? event.key === 'z' && acts.undo : acts[KEYS[event.key] ?? ''];
      if (!act) return;
      act();
      event.preventDefault();
    });
  }

  #listen() {
    const { toy } = this;
    /** @type {<N extends keyof ToyEvents>(name: N, act: (detail: ToyEvents[N]) => void) => void} */
    const on = (name, act) => toy.addEventListener(name, (event) => {
      if (event instanceof CustomEvent) act(event.detail);
    });
    on('say', ({ text, kind }) => this.#say(text, kind));
    on('menu', (asked) => this.menu.open(asked));
    on('theme', ({ name }) => this.#theme(name));
    on('pace', ({ isBehind }) => { byId('pace').textContent = isBehind ? 'slower than real time' : ''; });
    on('jump', () => this.panel.show());
    on('draw', () => {
      this.#drawTime();
      if (Object.keys(toy.drives.keys).join() !== this.#keys) this.#addDriveKeys();
      if (!byId('panel').hidden) this.panel.follow();
    });
    on('pause', ({ isPaused }) => {
      const button = byId('play');
      press(button, isPaused);
      button.setAttribute('aria-label', isPaused ? 'Play' : 'Pause');
      button.querySelector('path')?.setAttribute('d', isPaused ? 'M8 5l11 7-11 7z' : 'M8 5v14M16 5v14');
    });
    // Who plays has read what there is to do.
    byId('picture').addEventListener('pointerdown', () => {
      if (!byId('hints').hidden) this.#show('hints', 'hint');
    });
  }

  /** @type {(name: string) => void} */
  #theme(name) {
    document.documentElement.dataset.theme = name;
    this.panel.show();
  }

  /** @type {(text: string, kind?: string) => void} */
  #say(text, kind = '') {
    byId('state').textContent = text;
    byId('state').className = kind;
  }

  /** Show a part of the page by its button, or hide it.
   * @type {(id: string, button: string) => void} */
  #show(id, button) {
    const part = byId(id);
    part.hidden = !part.hidden;
    press(byId(button), !part.hidden);
    byId(button).setAttribute('aria-expanded', String(!part.hidden));
    this.panel.show();
    this.#makeRoom();
  }

  // The level is shown above what covers the lower edge.
  #makeRoom() {
    const covers = innerWidth < NARROW && !byId('panel').hidden;
    this.toy.covered = covers ? innerHeight - byId('panel').getBoundingClientRect().top : byId('bars').offsetHeight;
  }

  /** @type {(tool: string) => void} */
  #choose(tool) {
    this.toy.hands.tool = tool;
    for (const name of TOOLS) press(byId(name), name === tool);
    if (tool in MAKES) this.#say(MAKES[tool] ?? '');
  }

  #drawTime() {
    const { toy } = this, shown = byId('time'), text = `${toy.seconds.toFixed(2)} s`;
    shown.max = String(toy.run.last);
    if (document.activeElement !== shown || !toy.isPaused) shown.value = String(toy.run.time);
    shown.setAttribute('aria-valuetext', text);
    byId('clock').textContent = text;
  }

  // A button for each key that drives something, or that a rule asks for; made again where something joined.
  #addDriveKeys() {
    const { drives } = this.toy;
    this.#keys = Object.keys(drives.keys).join();
    byId('keys').replaceChildren();
    this.#closing.abort();
    this.#closing = new AbortController();
    const { signal } = this.#closing;
    /** @type {Map<string, HTMLButtonElement>} */
    const buttons = new Map();
    drives.told = (name, isHeld) => press(buttons.get(name), isHeld);
    const controls = controlsOf(Object.keys(drives.keys));
    /** Caps say what presses them on what was used last.
     * @type {(isOnPad: boolean) => void} */
    const show = (isOnPad) => {
      byId('keys').classList.toggle('on-pad', isOnPad);
      for (const [name, button] of buttons) {
        const said = isOnPad ? controls.get(name) ?? name : name;
        button.textContent = ARROWS[said] ?? said.toUpperCase();
      }
    };
    // Who touches has them below both thumbs from then on.
    const spread = () => byId('keys').classList.add('spread');
    if (matchMedia('(hover: none)').matches) spread();
    addEventListener('keydown', (event) => { if (drives.has(event)) show(false); }, { signal });
    addEventListener('pointerdown', ({ pointerType }) => { if (pointerType === 'touch') spread(); }, { signal, capture: true });
    for (const name of Object.keys(drives.keys)) {
      const button = element('button', { type: 'button', className: 'key' });
      button.setAttribute('aria-label', `Key ${name}`);
      button.addEventListener('pointerdown', (event) => {
        if (event.button !== 0) return;
        show(false);
        button.setPointerCapture(event.pointerId);
        drives.press(name);
      });
      for (const end of ['lostpointercapture', 'blur', 'keyup']) button.addEventListener(end,
        () => drives.release(name));
      button.addEventListener('keydown', (event) => {
        if ([' ', 'Enter'].includes(event.key)) drives.press(name);
      });
      buttons.set(name, button);
    }
    byId('keys').append(...buttons.values());
    show(false);
    this.gamepads ??= new Gamepads(drives);
    this.gamepads.follow(() => show(true));
  }

  async #verify() {
    const { fresh, level: { recording } } = this.toy;
    if (!recording) return;
    const count = recording.hashes.length - 1, isLinked = recording.end !== undefined;
    /** @type {(text: string, kind?: string) => void} */
    const say = (text, kind = '') => {
      byId('verdict').textContent = text;
      byId('verdict').className = kind;
    };
    const bar = element('progress', { max: count });
    bar.setAttribute('aria-label', 'Verifying');
    byId('verdict').replaceChildren('Verifying ', bar);
    this.goals.isAsSent = isLinked;
    try {
      const wrong = await verified(fresh(), recording, (done) => { bar.value = done; });
      this.goals.isAsSent = isLinked && wrong !== null;
      const seconds = `${((wrong?.tick ?? 0) / this.toy.rate).toFixed(1)} s`;
      if (wrong?.words) say(`Not verified: at ${seconds} ${wrong.words}.`, 'bad');
      else if (wrong) say(`Not verified: this browser comes to other bits at ${seconds}, tick ${wrong.tick}.`, 'bad');
      else if (isLinked) say(`Verified: ${count} ticks, the very state that the sender had.`, 'good');
      else say(`Verified: every bit of ${count} ticks is that of the recording.`, 'good');
    } catch (error) {
      say('Not verified: this recording could not be compared.', 'bad');
      console.error(error);
    }
  }

  async #copyLink() {
    const { toy } = this;
    toy.pause();
    const fragment = await toy.link();
    if (fragment === null) {
      this.#say('This run is too long for a link: save it as a file, and send that.', 'bad');
      return;
    }
    // Without a new page: it is the address of what is here.
    history.replaceState(null, '', fragment);
    const isCopied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
    const length = location.href.length.toLocaleString('en');
    if (isCopied) this.#say(`The link is copied, ${length} characters. Whoever opens it sees what you did.`, 'good');
    else this.#say(`The address of this page is the link now, ${length} characters: copy it from there.`, 'good');
  }

  async #save() {
    const { toy } = this;
    toy.pause();
    try {
      const link = document.createElement('a');
      link.href = URL.createObjectURL(await toy.recording());
      link.download = `${toy.level.name.toLowerCase().replace(/[^a-z0-9]+/g, '_') || 'run'}.replay.gz`;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 60000);
      this.#say(`Saved ${link.download}: sandbox replay verifies it.`, 'good');
    } catch (error) {
      this.#say('The recording could not be written.', 'bad');
      console.error(error);
    }
  }
}

/** Take the run of a link in the address as the recording of a level. What there is to say: why it cannot be.
 * @type {(level: Level) => Promise<string>} */
async function follow(level) {
  if (!isLink(location.hash)) return '';
  try {
    [level.recording, level.begin] = await linked(location.hash, level.link);
    return '';
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    return error.message;
  }
}

/** Open the page of a toy whose parts a promise gives: what its file holds, and the kernels.
 * @type {(parts: Promise<[Level, Fresh]>) => Promise<void>} */
export async function start(parts) {
  try {
    const [level, fresh] = await parts, words = await follow(level);
    globalThis.page = new Page(level, fresh, words);
    addEventListener('hashchange', () => { if (isLink(location.hash)) location.reload(); });
  } catch (error) {
    byId('error').textContent = error instanceof Refusal ? error.message : 'This page could not be opened here.';
    byId('error').hidden = false;
    if (!(error instanceof Refusal)) console.error(error);
  }
}

/** The parts that a page holds itself.
 * @type {() => Promise<[Level, Fresh]>} */
export async function unpack() {
  const parts = await Promise.all(['toy', 'kernels'].map((id) => globalThis.unpacked(id))).catch(() => {
    throw new Refusal('This page was cut off or damaged. Ask for it again.');
  });
  return read(parts[0], WebAssembly.compile(parts[1]));
}
