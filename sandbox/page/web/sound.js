// Sound: what is heard of a run: blows, splashes, breaks, jerks of strings and motors, made of a few sines and a little noise.
import { SOUND } from './shared.js';
/** @import { Pool, Sounds } from './types.js' */
/** @import { World } from './world.js' */

const { SOFTEST, HARDEST, NEWS, MEMORY, MOST, JERK, HARD_JERK, REST, VOICES, LEVELS, MOTOR_FADE: FADE } = SOUND;
const { SOFT_SPLASH, HARD_SPLASH, SPLASH_PITCH } = SOUND;
const { SCALE, LOWEST, STEPS, TUNED, HIGHEST_STRING, SNAP_PITCH, MOTOR_PITCH, MOTOR_RISE, WIDTH } = SOUND;

/** The nearest note [Hz] of a scale of five steps, on which all things sound well together.
 * @type {(pitch: number) => number} */
function noteOf(pitch) {
  let best = LOWEST;
  for (let step = 0; step < STEPS; step++) {
    const note = LOWEST * 2 ** (Math.floor(step / 5) + SCALE[step % 5] / 12);
    if (Math.abs(Math.log(note / pitch)) < Math.abs(Math.log(best / pitch))) best = note;
  }
  return best;
}

/** How far to the right a particle is, -1..1.
 * @typedef {(particle: number) => number} Pan */

export class Sound {
  /** @type {AudioContext | null} */
  #context = null;
  /** @type {AudioBuffer | null} */
  #noise = null;
  /** @type {Float64Array} */
  #usual;
  /** @type {Float64Array} */
  #jerks;
  /** @type {Float64Array} */
  #splashes;
  /** @type {Map<string, number>} */
  #last = new Map();
  /** @type {Map<number, { hum: OscillatorNode, out: GainNode }>} */
  #motors = new Map();
  #voices = 0;
  isOn = false;
  /** @type {{ time: number, velocity: Float64Array } | null} */
  before = null;

  /** bodies: of each particle its body; of each body mass, pitch, weight, stuff, if it is a string. stuffs: modes.
   * @param {World} world @param {Sounds} sounds @param {Pool[]} water */
  constructor(world, { bodies, stuffs, motors }, water) {
    this.world = world;
    this.water = water;
    this.bodies = bodies;
    this.stuffs = stuffs;
    this.motors = motors;
    this.#usual = this.#jerks = this.#splashes = new Float64Array();
    this.forget();
  }

  // Only a touch may begin sound.
  toggle() {
    this.isOn = !this.isOn;
    const context = (this.#context ??= new AudioContext());
    if (!this.#noise) {
      this.#noise = context.createBuffer(1, context.sampleRate / 2, context.sampleRate);
      const samples = this.#noise.getChannelData(0);
      for (let k = 0, seed = 1; k < samples.length; k++) {
        seed = (seed * 16807) % 2147483647;
        samples[k] = (2 * seed) / 2147483647 - 1;
      }
    }
    if (this.isOn) context.resume();
    else context.suspend();
  }

  close() {
    this.#context?.close();
  }

  // Compare with nothing: time has jumped.
  forget() {
    this.before = null;
    this.#usual = new Float64Array(this.bodies.mass.length).fill(Infinity);
    this.#jerks = this.#usual.slice();
    this.#splashes = this.#usual.slice();
  }

  // Let motors fall silent until the next tick: time stands.
  rest() {
    for (const { out } of this.#motors.values()) out.gain.setTargetAtTime(0, out.context.currentTime, FADE);
  }

  /** Take in a tick. pan: of a place across the view, -1..1.
   * @type {(pan: Pan) => void} */
  hear(pan) {
    const { world, before } = this, velocity = world.view('state.velocity');
    if (this.isOn && before?.time === world.time - 1) {
      this.#hearBlows(velocity, before.velocity, pan);
      this.#hearSplashes(velocity, pan);
      this.#hearStrings(pan);
      if (world.broken.length) this.#hearBreak(world.broken, pan);
    }
    if (this.isOn) this.#hearMotors();
    this.before = { time: world.time, velocity: velocity.slice() };
  }

  /** What there is much more of than of late, the loudest bodies first.
   * @type {(now: Float64Array, usual: Float64Array, least: number) => number[]} */
  #new(now, usual, least) {
    const keep = Math.exp(-1 / (MEMORY * this.world.settings().tick_rate));
    /** @type {number[]} */
    const found = [];
    now.forEach((value, b) => {
      if (value > NEWS * usual[b] + least) found.push(b);
      usual[b] = usual[b] === Infinity ? value : Math.max(usual[b] * keep, value);
    });
    return found.sort((a, b) => now[b] - now[a]).slice(0, MOST);
  }

  /** @type {(velocity: Float64Array, earlier: Float64Array, pan: Pan) => void} */
  #hearBlows(velocity, earlier, pan) {
    const { of, mass, pitch, weight, stuff } = this.bodies, { world } = this, count = mass.length;
    const { gravity, tick_rate } = world.settings(), own = world.view('state.mass');
    const inverse = world.view('state.inverse_mass'), scale = world.view('state.gravity_scale');
    const speed = new Float64Array(count), blow = new Float64Array(count), place = new Int32Array(count);
    for (const p of new Set(this.world.contacts())) {
      if (!inverse[p]) continue;
      const jump = Math.hypot(...[0,
        1].map((k) => velocity[2 * p + k] - earlier[2 * p + k] - (gravity[k] * scale[p]) / tick_rate)), b = of[p];
      if (jump > speed[b]) [speed[b], place[b]] = [jump, p];
      blow[b] += jump * own[p];
    }
    const felt = speed.map((value, b) => Math.sqrt((value * blow[b]) / mass[b]));
    for (const b of this.#new(felt, this.#usual, SOFTEST)) {
      this.#play('thud', b, pitch[b], (felt[b] / HARDEST) ** 0.75 * weight[b], pan(place[b]), stuff[b]);
    }
  }

  /** @type {(velocity: Float64Array, pan: Pan) => void} */
  #hearSplashes(velocity, pan) {
    if (!this.water.length) return;
    const { of, mass, pitch, weight } = this.bodies, { world } = this, { tick_rate } = world.settings();
    const position = world.view('state.position'), active = world.view('state.particle_active');
    const inverse = world.view('state.inverse_mass');
    const speed = new Float64Array(mass.length), place = new Int32Array(mass.length);
    inverse.forEach((value, p) => {
      if (!value || !active[p]) return;
      const [x, y, v] = [position[2 * p], position[2 * p + 1], velocity[2 * p + 1]];
      const passes = this.water.some(({ box: [left, , right, top] }) =>
        x > left && x < right && (y > top) !== (y - v / tick_rate > top));
      if (passes && Math.abs(v) > speed[of[p]]) [speed[of[p]], place[of[p]]] = [Math.abs(v), p];
    });
    for (const b of this.#new(speed, this.#splashes, SOFT_SPLASH)) {
      const loudness = (speed[b] / HARD_SPLASH) ** 0.8 * weight[b];
      this.#play('splash', b, SPLASH_PITCH * Math.sqrt(pitch[b] / 200), loudness, pan(place[b]));
    }
  }

  /** @type {(pan: Pan) => void} */
  #hearStrings(pan) {
    const { of, mass, strand } = this.bodies;
    if (!strand.some(Boolean)) return;
    const a = this.world.view('state.particle_a'), tension = this.world.view('state.tension'),
      rest = this.world.view('state.rest_length');
    const active = this.world.view('state.spring_active'), material = this.world.view('state.material');
    const most = new Float64Array(mass.length), long = most.slice(), place = new Int32Array(mass.length),
      { tick_rate } = this.world.settings();
    a.forEach((p, s) => {
      const b = of[p];
      if (!strand[b] || !active[s] || material[s] < 0) return;
      long[b] += rest[s];
      if (tension[s] > most[b]) [most[b], place[b]] = [tension[s], p];
    });
    const jerk = most.map((value, b) => value / mass[b]);
    for (const b of this.#new(jerk, this.#jerks, JERK)) {
      const pull = Math.max(most[b] * tick_rate, 3 * mass[b]),
        pitch = Math.min((TUNED * Math.sqrt((pull * long[b]) / mass[b])) / (2 * long[b]), HIGHEST_STRING);
      this.#play('pluck', b, pitch, 0.8 * (jerk[b] / HARD_JERK) ** 0.8, pan(place[b]));
    }
  }

  /** @type {(springs: number[], pan: Pan) => void} */
  #hearBreak(springs, pan) {
    const [spring] = springs, p = this.world.view('state.particle_a')[spring],
      length = this.world.view('state.rest_length')[spring];
    const stiffness = this.world.view('state.stiffness')[spring];
    const pitch = SNAP_PITCH * Math.sqrt(0.3 / Math.max(length, 1e-3)) * (0.6 + stiffness);
    this.#play('snap', this.bodies.of[p], pitch, 0.55 + 0.12 * Math.log2(springs.length), pan(p));
  }

  /** @type {(kind: 'thud' | 'splash' | 'pluck' | 'snap', body: number, wanted: number, loudness: number, pan: number,
   *   stuff?: string) => void} */
  #play(kind, body, wanted, loudness, pan, stuff) {
    const context = this.#context;
    if (!context) return;
    const now = context.currentTime, key = `${kind}${body}`, pitch = noteOf(wanted);
    if (this.#voices >= VOICES || now - (this.#last.get(key) ?? -1) < REST
      || !Number.isFinite(pitch * loudness)) return;
    this.#last.set(key, now);
    const gain = LEVELS[kind] * Math.min(loudness, 1), out = this.#out(context, gain, pan);
    if (kind === 'thud' && stuff !== undefined) {
      const { modes, noise, cut, blow, glide } = this.stuffs[stuff];
      for (const [ratio, decay, strength] of modes) this.#tone(out, pitch * ratio, 0.4 * strength, decay, glide);
      this.#burst(out, 0.6 * noise, cut, blow);
    } else if (kind === 'splash') {
      this.#burst(out, 1.2, 12 * pitch + 1500, 0.09);
      [0.04, 0.09, 0.15].forEach((at, k) => this.#tone(out, pitch * (2 + k), 0.2, 0.03, 1, at));
    } else if (kind === 'snap') {
      this.#tone(out, pitch, 0.4, 0.02, 2.5);
      [0, 0.018, 0.04].forEach((at, k) => this.#burst(out, 0.8 / (k + 1), Math.min(5 * pitch + 2000, 9000), 0.01, at));
    } else {
      for (let k = 1; k < 7; k++) this.#tone(out, k * pitch, 0.5 / k ** 1.5, 0.5 / k, 1);
    }
  }

  /** @type {(context: AudioContext, gain: number, pan: number) => GainNode} */
  #out(context, gain, pan) {
    const volume = new GainNode(context, { gain: 0.6 * gain });
    volume.connect(new StereoPannerNode(context, { pan: WIDTH * pan })).connect(context.destination);
    return volume;
  }

  /** @type {(source: AudioScheduledSourceNode, out: AudioNode, strength: number, decay: number,
   *   at?: number) => GainNode} */
  #fading(source, out, strength, decay, at = 0) {
    const begin = out.context.currentTime + at, fade = new GainNode(out.context, { gain: 0 });
    fade.gain.setValueAtTime(0, begin);
    fade.gain.linearRampToValueAtTime(strength, begin + 0.002);
    fade.gain.setTargetAtTime(0, begin + 0.002, decay);
    this.#voices += 0.25;
    source.onended = () => { this.#voices -= 0.25; };
    source.start(begin);
    source.stop(begin + 6 * decay + 0.01);
    fade.connect(out);
    return fade;
  }

  /** @type {(out: AudioNode, pitch: number, strength: number, decay: number, glide: number, at?: number) => void} */
  #tone(out, pitch, strength, decay, glide, at = 0) {
    const tone = new OscillatorNode(out.context, { frequency: pitch }), { currentTime } = out.context;
    tone.frequency.setValueAtTime(pitch * glide, currentTime);
    tone.frequency.setTargetAtTime(pitch, currentTime, 0.03);
    tone.connect(this.#fading(tone, out, strength, decay, at));
  }

  /** @type {(out: AudioNode, strength: number, cut: number, decay: number, at?: number) => void} */
  #burst(out, strength, cut, decay, at = 0) {
    const noise = new AudioBufferSourceNode(out.context, { buffer: this.#noise, loop: true });
    noise.connect(new BiquadFilterNode(out.context, { type: 'lowpass', frequency: cut })).connect(this.#fading(noise,
      out, strength, decay, at));
  }

  // Motors that are driven hum, the faster the higher.
  #hearMotors() {
    const context = this.#context;
    if (!context) return;
    const value = this.world.view('state.actuator_value'), position = this.world.view('state.position'),
      velocity = this.world.view('state.velocity');
    for (const { part, hub, rim, speed } of this.motors) {
      let turning = 0;
      for (const p of rim) {
        const x = position[2 * p] - position[2 * hub], y = position[2 * p + 1] - position[2 * hub + 1];
        const u = velocity[2 * p] - velocity[2 * hub], v = velocity[2 * p + 1] - velocity[2 * hub + 1];
        turning += Math.abs(x * v - y * u) / (x * x + y * y || 1) / rim.length;
      }
      const { hum, out } = this.#motors.get(part) ?? this.#newMotor(context, part),
        effort = value[part] ? 0.2 + 0.8 * Math.min(turning / (Math.abs(speed) || 1), 1) : 0;
      hum.frequency.setTargetAtTime(MOTOR_PITCH + MOTOR_RISE * turning, context.currentTime, 0.05);
      out.gain.setTargetAtTime(0.35 * LEVELS.motor * effort, context.currentTime, FADE);
    }
  }

  /** @type {(context: AudioContext, part: number) => { hum: OscillatorNode, out: GainNode }} */
  #newMotor(context, part) {
    const hum = new OscillatorNode(context, { type: 'sawtooth' }), out = this.#out(context, 1, 0);
    hum.connect(new BiquadFilterNode(context, { type: 'lowpass', frequency: 500 })).connect(out);
    hum.start();
    this.#motors.set(part, { hum, out });
    return { hum, out };
  }
}
