// Sound: what is heard of a run: blows, breaks, jerks of strings and motors, made of a few sines and a little noise.
import { SOUND } from './shared.js';

const { SOFTEST, HARDEST, NEWS, MEMORY, MOST, JERK, HARD_JERK, REST, VOICES, LEVELS, MOTOR_FADE: FADE } = SOUND;
const { SCALE, LOWEST, STEPS, TUNED, HIGHEST_STRING, SNAP_PITCH, MOTOR_PITCH, MOTOR_RISE, WIDTH } = SOUND;

// The nearest note [Hz] of a scale of five steps, on which all things sound well together.
function noteOf(pitch) {
  let best = LOWEST;
  for (let step = 0; step < STEPS; step++) {
    const note = LOWEST * 2 ** (Math.floor(step / 5) + SCALE[step % 5] / 12);
    if (Math.abs(Math.log(note / pitch)) < Math.abs(Math.log(best / pitch))) best = note;
  }
  return best;
}

export class Sound {
  #context = null;
  #noise;
  #usual;
  #jerks;
  #last = new Map();
  #motors = new Map();
  #voices = 0;
  isOn = false;

  // bodies: of each particle its body; of each body mass, pitch, weight, stuff, if it is a string. stuffs: modes.
  constructor(world, { bodies, stuffs, motors }) {
    Object.assign(this, { world, bodies, stuffs, motors });
    this.forget();
  }

  // Only a touch may begin sound.
  toggle() {
    this.isOn = !this.isOn;
    this.#context ??= new AudioContext();
    if (!this.#noise) {
      this.#noise = this.#context.createBuffer(1, this.#context.sampleRate / 2, this.#context.sampleRate);
      const samples = this.#noise.getChannelData(0);
      for (let k = 0, seed = 1; k < samples.length; k++) {
        seed = (seed * 16807) % 2147483647;
        samples[k] = (2 * seed) / 2147483647 - 1;
      }
    }
    if (this.isOn) this.#context.resume();
    else this.#context.suspend();
  }

  close() {
    this.#context?.close();
  }

  // Compare with nothing: time has jumped.
  forget() {
    this.before = null;
    this.#usual = new Float64Array(this.bodies.mass.length).fill(Infinity);
    this.#jerks = this.#usual.slice();
  }

  // Let motors fall silent until the next tick: time stands.
  rest() {
    for (const { out } of this.#motors.values()) out.gain.setTargetAtTime(0, this.#context.currentTime, FADE);
  }

  // Take in a tick. pan: of a place across the view, -1..1.
  hear(pan) {
    const { world, before } = this, velocity = world.view('state.velocity');
    if (this.isOn && before?.time === world.time - 1) {
      this.#hearBlows(velocity, before.velocity, pan);
      this.#hearStrings(pan);
      if (world.broken.length) this.#hearBreak(world.broken, pan);
    }
    if (this.isOn) this.#hearMotors();
    this.before = { time: world.time, velocity: velocity.slice() };
  }

  // What there is much more of than of late, the loudest bodies first.
  #new(now, usual, least) {
    const keep = Math.exp(-1 / (MEMORY * this.world.settings().tick_rate)), found = [];
    now.forEach((value, b) => {
      if (value > NEWS * usual[b] + least) found.push(b);
      usual[b] = usual[b] === Infinity ? value : Math.max(usual[b] * keep, value);
    });
    return found.sort((a, b) => now[b] - now[a]).slice(0, MOST);
  }

  #hearBlows(velocity, earlier, pan) {
    const { of, mass, pitch, weight, stuff } = this.bodies, view = (name) => this.world.view(`state.${name}`),
      count = mass.length;
    const { gravity, tick_rate } = this.world.settings(), own = view('mass'), inverse = view('inverse_mass'),
      scale = view('gravity_scale');
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

  #hearBreak(springs, pan) {
    const [spring] = springs, p = this.world.view('state.particle_a')[spring],
      length = this.world.view('state.rest_length')[spring];
    const pitch = SNAP_PITCH * Math.sqrt(0.3 / Math.max(length, 1e-3)) * (0.6 + this.world.view('state.stiffness')[spring]);
    this.#play('snap', this.bodies.of[p], pitch, 0.55 + 0.12 * Math.log2(springs.length), pan(p));
  }

  #play(kind, body, wanted, loudness, pan, stuff) {
    const context = this.#context, now = context.currentTime, key = `${kind}${body}`, pitch = noteOf(wanted);
    if (this.#voices >= VOICES || now - (this.#last.get(key) ?? -1) < REST
      || !Number.isFinite(pitch * loudness)) return;
    this.#last.set(key, now);
    const gain = LEVELS[kind] * Math.min(loudness, 1), out = this.#out(gain, pan);
    if (kind === 'thud') {
      const { modes, noise, cut, blow, glide } = this.stuffs[stuff];
      for (const [ratio, decay, strength] of modes) this.#tone(out, pitch * ratio, 0.4 * strength, decay, glide);
      this.#burst(out, 0.6 * noise, cut, blow);
    } else if (kind === 'snap') {
      this.#tone(out, pitch, 0.4, 0.02, 2.5);
      [0, 0.018, 0.04].forEach((at, k) => this.#burst(out, 0.8 / (k + 1), Math.min(5 * pitch + 2000, 9000), 0.01, at));
    } else {
      for (let k = 1; k < 7; k++) this.#tone(out, k * pitch, 0.5 / k ** 1.5, 0.5 / k, 1);
    }
  }

  #out(gain, pan) {
    const context = this.#context, volume = new GainNode(context, { gain: 0.6 * gain });
    volume.connect(new StereoPannerNode(context, { pan: WIDTH * pan })).connect(context.destination);
    return volume;
  }

  #fading(source, out, strength, decay, at = 0) {
    const begin = this.#context.currentTime + at, fade = new GainNode(this.#context, { gain: 0 });
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

  #tone(out, pitch, strength, decay, glide) {
    const tone = new OscillatorNode(this.#context, { frequency: pitch });
    tone.frequency.setValueAtTime(pitch * glide, this.#context.currentTime);
    tone.frequency.setTargetAtTime(pitch, this.#context.currentTime, 0.03);
    tone.connect(this.#fading(tone, out, strength, decay));
  }

  #burst(out, strength, cut, decay, at = 0) {
    const noise = new AudioBufferSourceNode(this.#context, { buffer: this.#noise, loop: true });
    noise.connect(new BiquadFilterNode(this.#context, { type: 'lowpass', frequency: cut })).connect(this.#fading(noise,
      out, strength, decay, at));
  }

  // Motors that are driven hum, the faster the higher.
  #hearMotors() {
    const value = this.world.view('state.actuator_value'), position = this.world.view('state.position'),
      velocity = this.world.view('state.velocity');
    for (const { part, hub, rim, speed } of this.motors) {
      let turning = 0;
      for (const p of rim) {
        const x = position[2 * p] - position[2 * hub], y = position[2 * p + 1] - position[2 * hub + 1];
        const u = velocity[2 * p] - velocity[2 * hub], v = velocity[2 * p + 1] - velocity[2 * hub + 1];
        turning += Math.abs(x * v - y * u) / (x * x + y * y || 1) / rim.length;
      }
      if (!this.#motors.has(part)) {
        const hum = new OscillatorNode(this.#context, { type: 'sawtooth' }), out = this.#out(1, 0);
        hum.connect(new BiquadFilterNode(this.#context, { type: 'lowpass', frequency: 500 })).connect(out);
        hum.start();
        this.#motors.set(part, { hum, out });
      }
      const { hum, out } = this.#motors.get(part),
        effort = value[part] ? 0.2 + 0.8 * Math.min(turning / (Math.abs(speed) || 1), 1) : 0;
      hum.frequency.setTargetAtTime(MOTOR_PITCH + MOTOR_RISE * turning, this.#context.currentTime, 0.05);
      out.gain.setTargetAtTime(0.35 * LEVELS.motor * effort, this.#context.currentTime, FADE);
    }
  }
}
