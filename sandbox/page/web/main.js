// Main: the page opens its parts, plays in real time, and gives buttons and keys their meaning.
import { Camera, Picture } from './draw.js';
import { Hands } from './hand.js';
import { DriveKeys, Panel } from './panel.js';
import { verified, written } from './recording.js';
import { Run } from './run.js';
import { Sound } from './sound.js';
import { Refusal, World } from './world.js';

const SLOW = 0.2, MOST_TICKS = 4, CLICK_ZOOM = 1.15;
const byId = (id) => document.getElementById(id);

class Page {
  #owed = 0;
  #then = performance.now();
  #isDirty = true;
  isPaused = false;
  isSlow = false;
  #isMoved = false;

  constructor(level, fresh) {
    Object.assign(this, { level, fresh, world: fresh(), camera: new Camera(), canvas: byId('picture') });
    const { commands = [], hashes = [''] } = level.recording ?? {};
    this.run = new Run(this.world, commands, hashes.length - 1);
    if (level.begin) this.run.seek(level.begin);
    this.picture = new Picture(this.canvas, level.scene, this.world);
    this.hands = new Hands(this.canvas, this.run, this.camera, {
      changed: () => { this.#isMoved = this.#isDirty = true; }, say: (text) => this.say(text),
    });
    this.panel = new Panel(byId('panel'), this.run, level.materials, level);
    this.keys = new DriveKeys(byId('keys'), this.run, level.keys);
    this.sound = new Sound(this.world, level.sounds);
    this.previous = this.world.view('state.position').slice();
    this.#bind();
    addEventListener('resize', () => this.#resize());
    matchMedia('(prefers-color-scheme: light)').addEventListener('change', () => this.#follow());
    this.#follow();
    this.#resize();
    if (level.recording) this.#verify();
    this.say(level.recording ? 'A recording. Touch it to take over.' : '');
    requestAnimationFrame((now) => this.#frame(now));
  }

  // The theme of the level, or that of the viewer.
  #follow() {
    const name = this.level.scene.theme ?? (matchMedia('(prefers-color-scheme: light)').matches ? 'light' : 'dark');
    this.theme = this.level.scene.themes[name];
    document.documentElement.dataset.theme = name;
    this.panel.show();
    this.#isDirty = true;
  }

  #resize() {
    this.camera.width = innerWidth;
    this.camera.height = innerHeight;
    if (!this.#isMoved) this.#fit();
    this.#isDirty = true;
  }

  // Show the level above what covers the lower edge.
  #fit() {
    const panel = byId('panel'),
      covers = innerWidth < 640
      && !panel.hidden ? innerHeight - panel.getBoundingClientRect().top : byId('bars').offsetHeight;
    this.camera.fit(this.level.scene.view, covers);
  }

  say(text, kind = '') {
    byId('state').textContent = text;
    byId('state').className = kind;
  }

  #frame(now) {
    const rate = this.world.settings().tick_rate, passed = Math.min((now - this.#then) / 1000, 0.25);
    this.#then = now;
    try {
      if (!this.isPaused) this.#owed = Math.min(this.#owed + passed * rate * (this.isSlow ? SLOW : 1), MOST_TICKS);
      for (; this.#owed >= 1; this.#owed -= 1) this.tick();
      if (!this.isPaused || this.#isDirty) this.#draw(now / 1000);
    } catch (error) {
      this.#stop(error);
    }
    requestAnimationFrame((next) => this.#frame(next));
  }

  #stop(error) {
    if (!this.isPaused) this.toggle('play');
    this.say(error instanceof Refusal ? error.message : 'Something went wrong here; start again.', 'bad');
    if (!(error instanceof Refusal)) console.error(error);
  }

  // One tick; at the end of a recording time stands still.
  tick() {
    this.hands.update();
    const wasFollowing = this.run.isFollowing;
    this.previous = this.world.view('state.position').slice();
    this.run.step();
    this.sound.hear((particle) => {
      const [x] = this.camera.toPixels(this.world.view('state.position')[2 * particle], 0);
      return Math.min(Math.max((2 * x) / this.camera.width - 1, -1), 1);
    });
    if (wasFollowing && !this.run.isFollowing) this.toggle('play');
    this.#isDirty = true;
  }

  #draw(seconds) {
    const part = this.isPaused ? 1 : this.#owed;
    this.picture.draw(this.camera, this.theme, this.previous, part, seconds);
    this.hands.draw(this.canvas.getContext('2d'), this.picture.at, this.theme);
    const { run } = this, rate = this.world.settings().tick_rate, shown = byId('time');
    shown.max = run.last;
    if (document.activeElement !== shown || !this.isPaused) shown.value = run.time;
    shown.setAttribute('aria-valuetext', `${(run.time / rate).toFixed(2)} s`);
    byId('clock').textContent = `${(run.time / rate).toFixed(2)} s`;
    this.#isDirty = false;
  }

  // Go to a tick, or by `go` anywhere; nothing is compared with what was before.
  jump(go) {
    try {
      go();
    } catch (error) {
      this.#stop(error);
    }
    this.previous = this.world.view('state.position').slice();
    this.sound.forget();
    this.#owed = 0;
    this.panel.show();
    this.#isDirty = true;
  }

  toggle(id) {
    const button = byId(id), isOn = button.getAttribute('aria-pressed') !== 'true';
    button.setAttribute('aria-pressed', isOn);
    if (id === 'play') {
      this.isPaused = isOn;
      button.setAttribute('aria-label', isOn ? 'Play' : 'Pause');
      button.querySelector('path').setAttribute('d', isOn ? 'M8 5l11 7-11 7z' : 'M8 5v14M16 5v14');
    } else if (id === 'slow') this.isSlow = isOn;
    else if (id === 'tune') {
      byId('panel').hidden = !isOn;
      button.setAttribute('aria-expanded', isOn);
      this.panel.show();
      if (!this.#isMoved) this.#fit();
    }
    this.#isDirty = true;
  }

  #choose(tool) {
    this.hands.tool = tool;
    for (const name of ['drag', 'pin', 'cut']) byId(name).setAttribute('aria-pressed', name === tool);
  }

  #bind() {
    const acts = {
      play: () => this.toggle('play'), slow: () => this.toggle('slow'), tune: () => this.toggle('tune'),
      step: () => {
        if (!this.isPaused) this.toggle('play');
        this.jump(() => this.tick());
      },
      again: () => this.jump(() => {
        this.hands.releaseAll();
        this.keys.releaseAll();
        this.run.seek(0);
        if (!this.level.recording) this.run.seek(0, 0);
        if (!this.level.recording) this.run.takeOver();
        if (this.isPaused) this.toggle('play');
      }),
      undo: () => this.jump(() => {
        if (!this.run.undo()) this.say('There is nothing to undo.');
        this.hands.releaseAll();
      }),
      drag: () => this.#choose('drag'), pin: () => this.#choose('pin'), cut: () => this.#choose('cut'),
      sound: () => {
        this.sound.toggle();
        byId('sound').setAttribute('aria-pressed', this.sound.isOn);
      },
      save: () => this.#save(),
    };
    for (const [id, act] of Object.entries(acts)) byId(id).addEventListener('click', act);
    byId('time').addEventListener('input', () => {
      if (!this.isPaused) this.toggle('play');
      this.jump(() => this.run.seek(Number(byId('time').value)));
    });
    const keys = { ' ': 'play', '.': 'step', s: 'slow', r: 'again', d: 'drag', p: 'pin', c: 'cut', m: 'sound',
      h: 'tune' };
    addEventListener('keydown', (event) => {
      if (event.target.matches('input, select, .pad')) return;
      const driven = this.keys.nameOf(event), isCommand = event.ctrlKey || event.metaKey;
      if (isCommand && event.key === 'z') acts.undo();
      else if (isCommand || event.altKey
        || (event.target.matches('button') && [' ', 'Enter'].includes(event.key))) return;
      else if (driven) this.keys.press(driven);
      else if (event.key in keys) acts[keys[event.key]]();
      else if (event.key === '+' || event.key === '-') {
        this.camera.zoomAbout(this.camera.width / 2, this.camera.height / 2,
          event.key === '+' ? CLICK_ZOOM : 1 / CLICK_ZOOM);
      } else if (!this.hands.key(event)) return;
      this.#isDirty = true;
      event.preventDefault();
    });
    addEventListener('keyup', (event) => this.keys.release(event.key.replace('Arrow', '').toLowerCase()));
    addEventListener('blur', () => this.keys.releaseAll());
    addEventListener('pointerdown', () => { this.#isDirty = true; });
  }

  async #verify() {
    const progress = (done, all) => done % 60 === 0
      && this.say(`Comparing each tick: ${Math.round((100 * done) / all)} %`);
    try {
      const wrong = await verified(this.fresh(), this.level.recording, progress);
      const count = this.level.recording.hashes.length - 1;
      if (wrong === null) this.say(`Verified: every bit of ${count} ticks is that of the recording.`, 'good');
      else this.say(`This browser comes to other bits at tick ${wrong}.`, 'bad');
    } catch (error) {
      this.say(error instanceof Refusal ? error.message : 'This recording could not be compared.', 'bad');
    }
  }

  // What was done as a file that `sandbox replay` verifies.
  async recording() {
    const { run, level } = this, commands = run.commands.filter(({ tick }) => tick <= run.time);
    const progress = (done, all) => done % 60 === 0
      && this.say(`Writing the recording: ${Math.round((100 * done) / Math.max(all, 1))} %`);
    return written(this.fresh(), level.about, level.header, commands, run.time, progress);
  }

  async #save() {
    if (!this.isPaused) this.toggle('play');
    try {
      const link = document.createElement('a'), file = await this.recording();
      link.href = URL.createObjectURL(file);
      link.download = `${this.level.name.toLowerCase().replace(/[^a-z0-9]+/g, '_') || 'run'}.replay.gz`;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 60000);
      this.say(`Saved ${link.download}: sandbox replay verifies it.`, 'good');
    } catch (error) {
      this.#stop(error);
    }
  }
}

export async function open() {
  let parts;
  try {
    parts = await Promise.all(['data', 'image', 'kernels'].map((id) => globalThis.unpacked(id)));
  } catch {
    throw new Refusal('This page was cut off or damaged. Ask for it again.');
  }
  const [data, image, kernels] = parts.map((part) => new Uint8Array(part)),
    level = JSON.parse(new TextDecoder().decode(data));
  const module = await WebAssembly.compile(kernels);
  return new Page(level, () => new World(new WebAssembly.Instance(module, {}).exports, image, level.about));
}

open().then((page) => { globalThis.page = page; }, (error) => {
  byId('error').textContent = error instanceof Refusal ? error.message : 'This page could not be opened here.';
  byId('error').hidden = false;
  if (!(error instanceof Refusal)) console.error(error);
});
