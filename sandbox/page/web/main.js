// Main: the page around a toy: its bars, panel, timeline and keys, and what it says.
import { Best, OWN } from './best.js';
import { Refusal } from './commands.js';
import { typed } from './cursor.js';
import { Ears } from './ears.js';
import { Engineers } from './engineers.js';
import { FeelCard } from './feel_card.js';
import { Lost, read } from './files.js';
import { Goals, starText } from './goals.js';
import { Keys } from './keys.js';
import { Elsewhere, isLink, linked, raced, rivalOf } from './link.js';
import { Menu } from './menu.js';
import { Messages, RANKS } from './messages.js';
import { element, Panel } from './panel.js';
import { Race, resultOf } from './race.js';
import { verified } from './recording.js';
import { outcome } from './rules.js';
import { copied, shared } from './sending.js';
import { Toy } from './toy.js';
/** @import { Droppable, Fresh, Level, Message, Rival, ToyEvents } from './types.js' */

// Slow motion; free room around a level [pixels].
const SLOW = 0.2, BESIDE = 8;
// The least part of the height that words leave to a level.
const LEAST = 0.35;
// Where what there is to do, and a panel, leave room for a level.
const roomy = matchMedia('(min-width: 641px) and (min-height: 501px)');
// What is said stands at these places.
const PLACES = ['verdict', 'state', 'refused'];
const TOOLS = ['drag', 'pin', 'cut', 'jelly', 'wood', 'steel', 'rope', 'spring', 'rod', 'erase'];
const DRAW = 'Draw around a shape: it becomes ', PULL = 'Pull from one thing to another, or to the air: ';
/** @type {Record<string, string | undefined>} */
const MAKES = { jelly: `${DRAW}jelly.`, wood: `${DRAW}wood.`, steel: `${DRAW}steel.`, rope: `${PULL}a rope.`,
  spring: `${PULL}a spring.`, rod: `${PULL}a rod.`, erase: 'Touch a thing: it goes, with what hangs on it.' };
/** @type {Record<string, string | undefined>} */
const KEYS = { s: 'slow', r: 'again', d: 'drag', p: 'pin', c: 'cut', b: 'make', j: 'jelly', o: 'rope', x: 'erase', m: 'sound', h: 'tune', '?': 'hint' };
/** With Ctrl, or with Command on a Mac.
 * @type {Record<string, string | undefined>} */
const COMMANDS = { z: 'undo', y: 'redo', 'Shift+z': 'redo' };
/** Parts of the page that are no plain elements.
 * @typedef {{ picture: HTMLCanvasElement, solved: HTMLAnchorElement, verifying: HTMLProgressElement, time: HTMLInputElement }} Parts */
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

/** What a person is told who takes a part in hand.
 * @type {(part: Droppable) => string} */
function fallOf({ name, records }) {
  const keys = records.flatMap(({ kit }) => Object.keys(kit?.keys ?? {})).map((key) => key.toUpperCase()).sort();
  return `Press where the ${name} is to be.${keys.length ? ` ${keys.join(' and ')} drive it.` : ''}`;
}

class Page {
  #messages = new Messages();
  // The last gesture that a link or a file holds.
  #kept;
  #isLeaving = false;

  /** said: what there is to say at first.
   * @param {Level} level @param {Fresh} fresh @param {Message | null} said */
  constructor(level, fresh, said) {
    this.toy = new Toy(byId('picture'), level, fresh, window);
    /** @type {(text: string) => void} */
    const refuse = (text) => this.#say({ rank: 'refusal', text, place: 'refused' });
    this.panel = new Panel(byId('panel'), this.toy.run, level.materials, level, refuse);
    this.engineers = new Engineers(byId('panel'), this.toy.run, level, refuse);
    this.parts = level.about.adding.parts;
    this.catalogue = element('select', { id: 'catalogue', className: 'part' }, new Option('More', ''),
      ...level.about.adding.catalogue.map(({ id, name }) => new Option(name[0].toUpperCase() + name.slice(1), id)));
    this.goals = new Goals(this.toy, level.goals, { goal: byId('goal'), score: byId('score'), end: byId('end-card'),
      again: byId('end-again'), was: byId('end-was'), on: byId('end-on'), solved: byId('solved') });
    this.best = new Best(this.toy);
    this.feel = new FeelCard(byId('feel'), this.toy, (text) => this.ears.say(text));
    this.menu = new Menu(byId('menu'), this.toy, (particle) => this.#feelOf(particle));
    this.keys = new Keys(this.toy.drives, byId('keys-left'), byId('keys-right'));
    this.#kept = this.toy.run.gesture;
    this.ears = new Ears(byId('spoken'));
    this.#bind();
    this.#listen();
    this.#listenToPage();
    this.#theme(this.toy.theme.name);
    if (level.recording) {
      this.#say({ rank: 'tip', text: 'A recording. Touch it to take over.' });
      this.#verify();
    }
    if (level.rival) this.#race(level.rival);
    this.#showBest();
    if (said) this.#say(said);
    // Words that leave little of the level wait behind their button.
    if (byId('room').offsetHeight < innerHeight * LEAST) this.#show('hints', 'hint');
    // A page of a disk has no address that others could open.
    if (!location.protocol.startsWith('http')) for (const id of ['link', 'end-send', 'end-beat']) byId(id).remove();
    byId('picture').focus({ preventScroll: true });
  }

  #listenToPage() {
    const { toy } = this;
    // The level is shown where nothing covers it.
    new ResizeObserver(() => {
      const { left, top, right, bottom } = byId('room').getBoundingClientRect();
      if (right - left > 2 * BESIDE && bottom - top > 2 * BESIDE) {
        toy.room = [left + BESIDE, top + BESIDE, right - BESIDE, bottom - BESIDE];
      }
    }).observe(byId('room'));
    addEventListener('resize', () => this.panel.show());
    // Who turns a phone has another picture, whatever was pinched before.
    matchMedia('(orientation: portrait)').addEventListener('change', () => toy.fit());
    document.addEventListener('click', ({ target, ctrlKey, metaKey, shiftKey }) => {
      // Who follows a link of the page means to leave it, but not for another tab.
      if (target instanceof Element && target.closest('a')) this.#isLeaving = !(ctrlKey || metaKey || shiftKey);
    });
    addEventListener('pageshow', () => { this.#isLeaving = false; });
    addEventListener('beforeunload', (event) => {
      if (!this.#isLeaving && toy.run.commands.some(({ gesture }) => gesture > this.#kept)) event.preventDefault();
    });
  }

  get #tools() {
    return [...TOOLS, ...this.parts.map(({ id }) => id)];
  }

  #bind() {
    const { toy } = this;
    /** @type {Record<string, () => unknown>} */
    const acts = {
      play: () => toy.toggle(), step: () => toy.step(), again: () => toy.restart(), undo: () => toy.undo(), redo: () => toy.redo(),
      slow: () => {
        toy.speed = toy.speed === 1 ? SLOW : 1;
        press(byId('slow'), toy.speed !== 1);
      },
      sound: () => {
        toy.sound.toggle();
        press(byId('sound'), toy.sound.isOn);
      },
      tune: () => this.#show('panel', 'tune'), make: () => this.#show('makers', 'make'), hint: () => this.#show('hints', 'hint'), save: () => this.#save(),
      parts: () => {
        press(byId('parts'), byId('makers').classList.toggle('parts'));
        this.#choose('drag');
      },
      link: async () => this.#copy(await this.#linked()), 'end-send': () => this.#send(), 'end-beat': () => this.#send(raced),
      best: () => this.#raceBest(), 'end-best': () => this.#raceBest(),
      more: () => {
        press(byId('more'), byId('tools').classList.toggle('open'));
        byId('more').setAttribute('aria-expanded', String(byId('tools').classList.contains('open')));
      },
    };
    // What drives something has no other meaning.
    for (const [key, id] of Object.entries(KEYS)) {
      if (id && key in toy.drives.keys) byId(id).title = byId(id).title.replace(` (${key.toUpperCase()})`, '');
    }
    for (const { id, name } of this.parts) {
      const button = element('button', { type: 'button', id, className: 'part', textContent: name, title: `Drop a ${name}` });
      press(button, false);
      byId('makers').append(button);
    }
    this.catalogue.setAttribute('aria-label', 'More parts');
    this.catalogue.addEventListener('change', () => this.#choose(this.catalogue.value || 'drag'));
    byId('makers').append(this.catalogue);
    for (const tool of this.#tools) acts[tool] = () => this.#choose(tool);
    for (const [id, act] of Object.entries(acts)) byId(id).addEventListener('click', act);
    byId('time').addEventListener('input', () => {
      toy.pause();
      toy.goTo(Number(byId('time').value));
    });
    // What hands may not do here has no button, no part of the panel and no key.
    for (const name of toy.level.absent) {
      for (const each of document.querySelectorAll(`#${name}, #panel .${name}`)) Object.assign(each, { hidden: true });
      delete acts[name];
    }
    // The toy hears keys first.
    addEventListener('keydown', (event) => {
      const isCommand = event.ctrlKey || event.metaKey;
      if (event.defaultPrevented || event.altKey || isTypedInto(event.target)) return;
      const act = acts[(isCommand ? COMMANDS : KEYS)[typed(event)] ?? ''];
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
    on('say', (message) => this.#say(message));
    on('speak', ({ text }) => this.ears.say(text));
    on('outcome', ({ isWon, text, stars }) => this.ears.say(isWon ? `Won. ${text} ${starText(stars)}.` : `Lost. ${text}`));
    on('menu', (asked) => this.menu.open(asked));
    on('theme', ({ name }) => this.#theme(name));
    on('pace', ({ isBehind }) => { byId('pace').textContent = isBehind ? 'slower than real time' : ''; });
    on('jump', () => {
      this.#messages.end('jump');
      this.#showMessages();
      this.panel.show();
      this.engineers.follow();
    });
    // What somebody sent is nobody's best here.
    on('outcome', async (outcome) => {
      if (!toy.level.recording) await this.best.note(outcome);
      this.#showBest();
    });
    // Both would leave little of the level.
    on('outcome', () => {
      if (!byId('panel').hidden) this.#show('panel', 'tune');
      this.feel.close();
    });
    on('draw', () => {
      this.#drawTime();
      this.keys.follow();
      this.#showMessages();
      if (byId('panel').hidden) return;
      this.panel.follow();
      this.engineers.follow();
    });
    on('pause', ({ isPaused }) => {
      const button = byId('play');
      press(button, isPaused);
      button.setAttribute('aria-label', isPaused ? 'Play' : 'Pause');
      button.querySelector('path')?.setAttribute('d', isPaused ? 'M8 5l11 7-11 7z' : 'M8 5v14M16 5v14');
    });
    // Who has played has read what there is to do. While somebody plays the level stays where it is.
    byId('picture').addEventListener('pointerup', () => {
      if (!byId('hints').hidden) this.#show('hints', 'hint');
    });
  }

  /** @type {(name: string) => void} */
  #theme(name) {
    document.documentElement.dataset.theme = name;
    this.panel.show();
  }

  /** @type {(message: Message) => void} */
  #say(message) {
    const { lasts } = RANKS[message.rank];
    this.#messages.say(message, this.#moment);
    this.#showMessages();
    if (message.rank !== 'progress') this.ears.say(message.text);
    // Also while time stands, when nothing is drawn.
    if (lasts) setTimeout(() => this.#showMessages(), 1000 * lasts + 20);
  }

  get #moment() {
    const { run } = this.toy, { [run.commands.length - 1]: last } = run.commands;
    return { tick: run.time, gesture: run.gesture, deed: last?.gesture ?? 0, now: performance.now() / 1000 };
  }

  #showMessages() {
    this.#messages.follow(this.#moment);
    for (const place of PLACES) {
      const box = byId(place), { text = '', rank, isGood, href } = this.#messages.shown(place) ?? {};
      if (box.dataset.said === text) continue;
      box.dataset.said = text;
      box.className = rank === 'verdict' ? (isGood ? 'good' : 'bad') : rank ?? '';
      box.replaceChildren(text, ...(href ? [' ', element('a', { href, textContent: 'Open it there.' })] : []));
    }
  }

  /** Show a part of the page by its button, or hide it.
   * @type {(id: string, button: string) => void} */
  #show(id, button) {
    const part = byId(id);
    part.hidden = !part.hidden;
    press(byId(button), !part.hidden);
    byId(button).setAttribute('aria-expanded', String(!part.hidden));
    this.panel.show();
    if (id === 'panel' && !part.hidden) this.feel.close();
    // A tool is in hand as long as it is seen.
    const { tool } = this.toy.hands;
    if (id === 'makers' && part.hidden && (tool in MAKES || this.toy.hands.maker.makes(tool))) this.#choose('drag');
    if (id !== 'hints' && !part.hidden && !roomy.matches && !byId('hints').hidden) this.#show('hints', 'hint');
  }

  /** Show how the thing of a particle feels; there is room for one card.
   * @type {(particle: number) => void} */
  #feelOf(particle) {
    if (!byId('panel').hidden) this.#show('panel', 'tune');
    if (!roomy.matches && !byId('hints').hidden) this.#show('hints', 'hint');
    this.feel.open(particle);
  }

  /** @type {(tool: string) => void} */
  #choose(tool) {
    this.toy.hands.tool = tool;
    for (const name of this.#tools) press(byId(name), name === tool);
    this.#messages.end('tool');
    this.#showMessages();
    this.catalogue.value = [...this.catalogue.options].some(({ value }) => value === tool) ? tool : '';
    const part = this.toy.hands.maker.part(tool), text = part ? fallOf(part) : MAKES[tool];
    if (text) this.#say({ rank: 'tip', text });
  }

  #drawTime() {
    const { toy } = this, shown = byId('time'), text = `${toy.seconds.toFixed(2)} s`;
    shown.max = String(toy.run.last);
    if (document.activeElement !== shown || !toy.isPaused) shown.value = String(toy.run.time);
    shown.setAttribute('aria-valuetext', text);
    byId('clock').textContent = text;
  }

  async #verify() {
    const { fresh, level: { recording, goals: { solved } }, rate } = this.toy;
    if (!recording) return;
    const count = recording.hashes.length - 1, isLinked = recording.end !== undefined;
    /** @type {(text: string, isGood?: boolean) => void} */
    const say = (text, isGood = false) => {
      bar.hidden = true;
      this.#say({ rank: 'verdict', text, isGood });
    };
    const bar = byId('verifying');
    bar.max = count;
    bar.hidden = false;
    this.goals.isAsSent = isLinked;
    try {
      const world = fresh(), wrong = await verified(world, recording, (done) => { bar.value = done; });
      this.goals.isAsSent = isLinked && wrong !== null;
      const seconds = `${((wrong?.tick ?? 0) / this.toy.rate).toFixed(1)} s`;
      if (wrong?.words) say(`Not verified: at ${seconds} ${wrong.words}.`);
      else if (wrong) say(`Not verified: this browser comes to other bits at ${seconds}, tick ${wrong.tick}.`);
      else {
        const won = outcome(world), isOwn = solved && solved.fragment === location.hash;
        const end = isOwn ? ` ${solved.text}` : won?.isWon ? ` Solved in ${(won.tick / rate).toFixed(1)} s with ${starText(won.stars)}.` : '';
        say(`Verified: ${isLinked ? `${count} ticks, the very state that the sender had` : `every bit of ${count} ticks is that of the recording`}.${end}`, true);
      }
    } catch (error) {
      say('Not verified: this recording could not be compared.');
      console.error(error);
    }
  }

  /** Let a run that somebody sent go along, once it is known to win.
   * @type {(rival: Rival) => Promise<void>} */
  async #race(rival) {
    const { toy } = this, bar = byId('verifying');
    toy.pause();
    bar.max = rival.recording.hashes.length - 1;
    bar.hidden = false;
    try {
      const result = await resultOf(toy, rival, (done) => { bar.value = done; });
      this.goals.race?.close();
      this.goals.race = new Race(toy, rival, result);
      this.#say({ rank: 'verdict', text: `Race ${rival.name}: the shade is the run to beat.`, isGood: true });
    } catch (error) {
      this.#say({ rank: 'verdict', text: error instanceof Refusal ? error.message : 'No race: this run could not be compared.' });
      if (!(error instanceof Refusal)) console.error(error);
    }
    bar.hidden = true;
    toy.restart();
  }

  #showBest() {
    for (const id of ['best', 'end-best']) byId(id).hidden = !this.best.kept;
  }

  // Race the best run that is kept here.
  async #raceBest() {
    const { toy, best: { kept } } = this;
    if (!kept) return;
    this.goals.close();
    if (toy.level.recording) {
      // Who has watched a run plays by hand now.
      toy.level.recording = null;
      this.goals.isAsSent = false;
      toy.restart(false);
    }
    try {
      const [recording] = await linked(kept.link, toy.level.link);
      await this.#race({ name: OWN, recording });
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      this.#say({ rank: 'verdict', text: error.message });
    }
  }

  /** The address of this page with what was done, which it is from then on; null: that is too long. as: the fragment of a
   * link in other words.
   * @type {(as?: (fragment: string) => string) => Promise<string | null>} */
  async #linked(as = (/** @type {string} */ plain) => plain) {
    const { gesture } = this.toy.run, fragment = await this.toy.link();
    if (fragment === null) {
      this.#say({ rank: 'refusal', text: 'This run is too long for a link: save it as a file, and send that.' });
      return null;
    }
    // Without a new page: it is the address of what is here.
    history.replaceState(null, '', as(fragment));
    this.#kept = gesture;
    return location.href;
  }

  /** @type {(address: string | null) => Promise<void>} */
  async #copy(address) {
    if (address === null) return;
    const isCopied = await copied(address), length = address.length.toLocaleString('en');
    this.#say({ rank: 'done', text: isCopied ? `The link is copied, ${length} characters. Whoever opens it sees what you did.`
      : `The address of this page is the link now, ${length} characters: copy it from there.` });
  }

  /** To somebody, by what a device has for that; a link where it has nothing.
   * @type {(as?: (fragment: string) => string) => Promise<void>} */
  async #send(as) {
    const url = await this.#linked(as);
    if (url === null || !await shared(document.title, url)) await this.#copy(url);
  }

  async #save() {
    const { toy } = this, { isPaused: wasPaused, run: { gesture } } = toy;
    toy.pause();
    try {
      const link = document.createElement('a');
      link.href = URL.createObjectURL(await toy.recording());
      link.download = `${toy.level.name.toLowerCase().replace(/[^a-z0-9]+/g, '_') || 'run'}.replay.gz`;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 60000);
      this.#kept = gesture;
      this.#say({ rank: 'done', text: `Saved ${link.download}. Spring Sandbox plays it, and verifies each bit of it.` });
    } catch (error) {
      this.#say({ rank: 'refusal', text: 'The recording could not be written.' });
      console.error(error);
    }
    if (!wasPaused) toy.play();
  }
}

/** Where the page of another level is on this site, with a link to a run of it; undefined: nowhere.
 * @type {(stem: unknown) => Promise<string | undefined>} */
async function pageOf(stem) {
  if (!document.querySelector('header a') || !/^[\w-]+$/.test(String(stem))) return undefined;
  const answer = await fetch(`${stem}.html`, { method: 'HEAD' }).catch(() => null);
  return answer?.ok ? `${stem}.html${location.hash}` : undefined;
}

/** Take the run of a link in the address as the recording of a level. What there is to say: why it cannot be.
 * @type {(level: Level) => Promise<Message | null>} */
async function follow(level) {
  if (!isLink(location.hash)) return null;
  try {
    const [recording, begin] = await linked(location.hash, level.link), name = rivalOf(location.hash);
    if (name === null) Object.assign(level, { recording, begin });
    else level.rival = { name, recording };
    return null;
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    const href = error instanceof Elsewhere ? await pageOf(error.level) : undefined;
    return { rank: 'verdict', text: error.message, href };
  }
}

/** Open the page of a toy whose parts come of a promise: what its file holds, and the kernels.
 * @type {(parts: () => Promise<[Level, Fresh]>) => Promise<void>} */
export async function start(parts) {
  const fault = byId('error'), retry = byId('retry');
  fault.hidden = retry.hidden = true;
  try {
    const [level, fresh] = await parts(), said = await follow(level);
    globalThis.page = new Page(level, fresh, said);
    addEventListener('hashchange', () => { if (isLink(location.hash)) location.reload(); });
  } catch (error) {
    fault.textContent = error instanceof Refusal ? error.message : 'This page could not be opened here.';
    fault.hidden = false;
    // What did not come may come yet.
    retry.hidden = !(error instanceof Lost);
    retry.onclick = () => start(parts);
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
