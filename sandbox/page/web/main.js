// Main: the page around a toy: its bars, panel, timeline and keys, and what it says.
import { Refusal } from './commands.js';
import { read } from './files.js';
import { element, Panel } from './panel.js';
import { verified } from './recording.js';
import { Toy } from './toy.js';

const SLOW = 0.2, NARROW = 640, ARROWS = { left: '←', right: '→', up: '↑', down: '↓' };
const TOOLS = ['drag', 'pin', 'cut'];
const KEYS = { s: 'slow', r: 'again', d: 'drag', p: 'pin', c: 'cut', m: 'sound', h: 'tune', '?': 'hint' };
const byId = (id) => document.getElementById(id);
const press = (button, isOn) => button.setAttribute('aria-pressed', isOn);

class Page {
  constructor(level, fresh) {
    this.toy = new Toy(byId('picture'), level, fresh, window);
    this.panel = new Panel(byId('panel'), this.toy.run, level.materials, level);
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
    this.#say(level.recording ? 'A recording. Touch it to take over.' : '');
    byId('picture').focus({ preventScroll: true });
  }

  #bind() {
    const { toy } = this, acts = {
      play: () => toy.toggle(), step: () => toy.step(), again: () => toy.restart(), undo: () => toy.undo(),
      slow: () => {
        toy.speed = toy.speed === 1 ? SLOW : 1;
        press(byId('slow'), toy.speed !== 1);
      },
      sound: () => {
        toy.sound.toggle();
        press(byId('sound'), toy.sound.isOn);
      },
      tune: () => this.#show('panel', 'tune'), hint: () => this.#show('hints', 'hint'), save: () => this.#save(),
    };
    for (const tool of TOOLS) acts[tool] = () => this.#choose(tool);
    for (const [id, act] of Object.entries(acts)) byId(id).addEventListener('click', act);
    byId('time').addEventListener('input', () => {
      toy.pause();
      toy.seek(Number(byId('time').value));
    });
    // The toy hears keys first.
    addEventListener('keydown', (event) => {
      const isCommand = event.ctrlKey || event.metaKey;
      if (event.defaultPrevented || event.altKey || event.target.matches('input, select, .pad')) return;
      const act = isCommand ? event.key === 'z' && acts.undo : acts[KEYS[event.key]];
      if (!act) return;
      act();
      event.preventDefault();
    });
  }

  #listen() {
    const { toy } = this, on = (name, act) => toy.addEventListener(name, ({ detail }) => act(detail));
    on('say', ({ text, kind }) => this.#say(text, kind));
    on('theme', ({ name }) => this.#theme(name));
    on('pace', ({ isBehind }) => { byId('pace').textContent = isBehind ? 'slower than real time' : ''; });
    on('jump', () => this.panel.show());
    on('draw', () => {
      this.#drawTime();
      if (!byId('panel').hidden) this.panel.follow();
    });
    on('pause', ({ isPaused }) => {
      const button = byId('play');
      press(button, isPaused);
      button.setAttribute('aria-label', isPaused ? 'Play' : 'Pause');
      button.querySelector('path').setAttribute('d', isPaused ? 'M8 5l11 7-11 7z' : 'M8 5v14M16 5v14');
    });
    // Who plays has read what there is to do.
    byId('picture').addEventListener('pointerdown', () => byId('hints').hidden || this.#show('hints', 'hint'));
  }

  #theme(name) {
    document.documentElement.dataset.theme = name;
    this.panel.show();
  }

  #say(text, kind = '') {
    byId('state').textContent = text;
    byId('state').className = kind;
  }

  // Show a part of the page by its button, or hide it.
  #show(id, button) {
    const part = byId(id);
    part.hidden = !part.hidden;
    press(byId(button), !part.hidden);
    byId(button).setAttribute('aria-expanded', !part.hidden);
    this.panel.show();
    this.#makeRoom();
  }

  // The level is shown above what covers the lower edge.
  #makeRoom() {
    const covers = innerWidth < NARROW && !byId('panel').hidden;
    this.toy.covered = covers ? innerHeight - byId('panel').getBoundingClientRect().top : byId('bars').offsetHeight;
  }

  #choose(tool) {
    this.toy.hands.tool = tool;
    for (const name of TOOLS) press(byId(name), name === tool);
  }

  #drawTime() {
    const { toy } = this, shown = byId('time'), text = `${toy.seconds.toFixed(2)} s`;
    shown.max = toy.run.last;
    if (document.activeElement !== shown || !toy.isPaused) shown.value = toy.run.time;
    shown.setAttribute('aria-valuetext', text);
    byId('clock').textContent = text;
  }

  // A button for each key that drives something.
  #addDriveKeys() {
    const { drives } = this.toy, buttons = new Map();
    drives.told = (name, isHeld) => press(buttons.get(name), isHeld);
    for (const name of Object.keys(drives.keys)) {
      const button = element('button', { type: 'button', textContent: ARROWS[name] ?? name.toUpperCase(),
        className: 'key' });
      button.setAttribute('aria-label', `Drive with key ${name}`);
      button.addEventListener('pointerdown', (event) => {
        if (event.button !== 0) return;
        button.setPointerCapture(event.pointerId);
        drives.press(name);
      });
      for (const end of ['lostpointercapture', 'blur', 'keyup']) button.addEventListener(end,
        () => drives.release(name));
      button.addEventListener('keydown', (event) => [' ', 'Enter'].includes(event.key) && drives.press(name));
      buttons.set(name, button);
    }
    byId('keys').append(...buttons.values());
  }

  async #verify() {
    const { fresh, level: { recording } } = this.toy, count = recording.hashes.length - 1;
    try {
      const wrong = await verified(fresh(), recording);
      if (wrong === null) this.#say(`Verified: every bit of ${count} ticks is that of the recording.`, 'good');
      else this.#say(`This browser comes to other bits at tick ${wrong}.`, 'bad');
    } catch (error) {
      this.#say(error instanceof Refusal ? error.message : 'This recording could not be compared.', 'bad');
    }
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

// Open the page of a toy whose parts a promise gives: what its file holds, and the kernels.
export async function start(parts) {
  try {
    globalThis.page = new Page(...await parts);
  } catch (error) {
    byId('error').textContent = error instanceof Refusal ? error.message : 'This page could not be opened here.';
    byId('error').hidden = false;
    if (!(error instanceof Refusal)) console.error(error);
  }
}

// The parts that a page holds itself.
export async function unpack() {
  const parts = await Promise.all(['toy', 'kernels'].map((id) => globalThis.unpacked(id))).catch(() => {
    throw new Refusal('This page was cut off or damaged. Ask for it again.');
  });
  return read(parts[0], WebAssembly.compile(parts[1]));
}
