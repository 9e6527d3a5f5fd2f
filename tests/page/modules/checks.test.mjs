import assert from 'node:assert/strict';
import test from 'node:test';
import { Checks } from '../../../sandbox/page/web/checks.js';
import { GIVEN, toy } from './toys.mjs';

const RATE = 60;

// A world of two free particles, 3 m apart, and a spring between them that is 2 m long at rest.
function small() {
  const state = { position: Float64Array.of(0, 0, 3, 0), velocity: Float64Array.of(0, 0, 0, 4),
    mass: Float64Array.of(1, 3), inverse_mass: Float64Array.of(1, 1 / 3), particle_active: Uint8Array.of(1, 1),
    spring_active: Uint8Array.of(1), rest_length: Float64Array.of(2), particle_a: Int32Array.of(0),
    particle_b: Int32Array.of(1) };
  return { time: 0, particles: [0, 1], springs: [0], state, view: (path) => state[path.replace('state.', '')],
    settings: () => ({ tick_rate: RATE }) };
}

// What a check comes to when it looks at this one tick.
function measured(metric, more = {}, change = () => {}) {
  const world = small();
  change(world.state);
  const [told] = new Checks({ checks: [{ name: 'it', metric, from: 0, to: 0, at_most: 1, ...more }] }, world).look();
  return told;
}

test('metrics measure what they are called', () => {
  assert.equal(measured('x').value, 2.25);
  assert.equal(measured('speed').value, 3);
  assert.equal(measured('distance', { particles: [0, 1] }).value, 3);
  assert.equal(measured('inside', { box: [-1, -2, 5, 2] }).value, 1);
  assert.equal(measured('max_speed').value, 4);
  assert.equal(measured('kinetic_energy').value, 24);
  assert.equal(measured('strain').value, 0.5);
  assert.equal(measured('broken_springs').value, 0);
  assert.equal(measured('broken_springs', {}, (state) => { state.spring_active[0] = 0; }).value, 1);
  assert.equal(measured('non_finite', {}, (state) => { state.velocity[0] = Infinity; }).value, 1);
});

test('a check holds within its bounds, and what is no number never does', () => {
  assert.equal(measured('x', { at_most: 2.25 }).holds, true);
  assert.equal(measured('x', { at_most: 2.2 }).holds, false);
  assert.equal(measured('x', { at_most: 9, at_least: 2.3 }).holds, false);
  assert.equal(measured('x', {}, (state) => { state.position[0] = NaN; }).holds, false);
});

test('a check of a time is decided at its end by the worst tick, and one that waits by the first good one', () => {
  const world = small(), end = 10 / RATE, checks = new Checks({ checks: [
    { name: 'always', metric: 'x', from: 0, to: end, at_most: 3 },
    { name: 'once', metric: 'x', from: 0, to: end, at_least: 2.5, is_eventual: true },
  ] }, world), told = [];
  for (world.time = 1; world.time <= 12; world.time++) {
    world.state.position[0] = world.time === 4 ? 40 : 0;
    for (const each of checks.look()) told.push([world.time, each.name, each.holds]);
  }
  assert.deepEqual(told, [[4, 'once', true], [10, 'always', false]]);
});

test('settled says for how long [s] nothing has moved', () => {
  const world = small(), checks = new Checks({ checks: [
    { name: 'still', metric: 'settled', from: 0, to: 1, at_least: 0.25, is_eventual: true },
  ] }, world), told = [];
  for (world.time = 1; world.time <= RATE; world.time++) {
    world.state.velocity[3] = world.time < 10 ? 4 : 0.01;
    told.push(...checks.look().map(({ value, holds }) => [world.time, value, holds]));
  }
  assert.deepEqual(told, [[24, 0.25, true]]);
});

test('after a jump nothing is measured until time starts from its beginning', () => {
  const world = small(), checks = new Checks({ checks: [{ name: 'it', metric: 'x', from: 0, to: 0, at_most: 3 }] }, world);
  world.time = 5;
  checks.begin();
  assert.deepEqual(checks.look(), []);
  world.time = 0;
  checks.begin();
  assert.equal(checks.look().length, 1);
});

test('the checks of a level come to what they come to on the desktop', async () => {
  for (const [name, expected] of Object.entries(GIVEN.checks)) {
    const [level, fresh] = await toy(name), world = fresh(), checks = new Checks(level, world), told = {};
    const end = Math.max(...level.checks.map(({ to }) => to)) * world.settings().tick_rate;
    for (; world.time <= end; world.tick()) for (const each of checks.look()) told[each.name] = each;
    assert.deepEqual(Object.keys(told).sort(), Object.keys(expected).sort());
    for (const [check, { passed, value }] of Object.entries(expected)) {
      assert.equal(told[check].holds, passed, check);
      assert.ok(Math.abs(told[check].value - value) <= 1e-9 * Math.max(Math.abs(value), 1), `${check}: ${value}`);
    }
  }
});
