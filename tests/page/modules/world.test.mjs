import assert from 'node:assert/strict';
import test from 'node:test';
import { Refusal } from '../../../sandbox/page/web/commands.js';
import { canonical } from '../../../sandbox/page/web/hash.js';
import { GIVEN, toy } from './toys.mjs';

const ticked = (world, count) => {
  for (let k = 0; k < count; k++) world.tick();
  return world.hash().whole;
};
const pull = { type: 'grab', grab: 0, particle: 20, target: [0.5, 1], strength: 80, radius: 0 };

test('a state that was saved goes on to the same bits, also from before a cut and a hold', async () => {
  const [, fresh] = await toy('rope');
  const world = fresh();
  ticked(world, 30);
  const saved = world.save(), expected = ticked(world, 60);
  world.command({ type: 'cut_springs', springs: [10] }, world.givers.PROGRAM);
  world.command(pull, world.givers.PROGRAM);
  assert.notEqual(ticked(world, 60), expected);
  world.restore(saved);
  assert.equal(world.time, 30);
  assert.equal(ticked(world, 60), expected);
});

test('a saved state is none of the world that it was saved of', async () => {
  const [, fresh] = await toy('rope');
  const world = fresh(), saved = world.save(), before = saved.arrays.get('state.position').slice();
  ticked(world, 10);
  assert.deepEqual(saved.arrays.get('state.position'), before);
});

test('two worlds of a toy share nothing', async () => {
  const [, fresh] = await toy('rope');
  const one = fresh(), other = fresh(), expected = other.hash().whole;
  ticked(one, 10);
  assert.equal(other.hash().whole, expected);
});

test('arrays are found where they are after memory has grown', async () => {
  const [, fresh] = await toy('jelly_wheel');
  const world = fresh(), old = world.view('state.position');
  world.command({ ...pull, particle: world.particles.find((slot) => world.canMove(slot)) }, world.givers.PROGRAM);
  ticked(world, 5);
  const view = world.view('state.position');
  assert.equal(view.length, old.length || view.length);
  assert.ok(view.every(Number.isFinite));
  assert.throws(() => world.view('state.nothing'), /there is no array state.nothing/);
});

test('what a kernel refuses changes nothing', async () => {
  const [, fresh] = await toy('rope');
  const world = fresh(), before = world.hash().whole;
  assert.throws(() => world.command({ type: 'pin', particle: 1e6 }, world.givers.PROGRAM), Refusal);
  assert.throws(() => world.command({ type: 'shake', acceleration: [NaN, 0] }, world.givers.PROGRAM), Refusal);
  assert.equal(world.hash().whole, before);
});

test('a particle whose motion no physics gives is held where it was last', async () => {
  const [, fresh] = await toy('rope');
  const world = fresh();
  ticked(world, 5);
  const [x, y] = world.view('state.position').slice(2 * 30);
  world.view('state.velocity')[2 * 30] = NaN;
  ticked(world, 1);
  assert.equal(world.view('state.inverse_mass')[30], 0);
  assert.deepEqual([...world.view('state.position').slice(2 * 30, 2 * 30 + 2)], [x, y]);
  assert.ok(world.view('state.position').every(Number.isFinite));
});

test('a value of any array that no physics gives is taken back to the bits of the desktop', async () => {
  const { level, ticks, tries } = GIVEN.spoilt, [, fresh] = await toy(level);
  for (const { path, place, hash } of tries) {
    const world = fresh();
    ticked(world, ticks);
    world.view(path)[place] = NaN;
    assert.equal(ticked(world, ticks), hash, path);
  }
});

test('the bytes of -0 are those of 0', () => {
  assert.deepEqual(canonical(Float64Array.of(-0, 1)), canonical(Float64Array.of(0, 1)));
  assert.notDeepEqual(canonical(Float64Array.of(2, 1)), canonical(Float64Array.of(0, 1)));
});
