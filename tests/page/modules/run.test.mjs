import assert from 'node:assert/strict';
import test from 'node:test';
import { Refusal } from '../../../sandbox/page/web/commands.js';
import { Run } from '../../../sandbox/page/web/run.js';
import { hashAfter, toy } from './toys.mjs';

const grab = { type: 'grab', grab: 0, particle: 20, target: [0.5, 1], strength: 80, radius: 0 };
const pin = { type: 'pin', particle: 35 };

async function started() {
  const [, fresh] = await toy('rope');
  return new Run(fresh());
}

test('undo goes back to before a gesture, and time goes on as if it had not been', async () => {
  const run = await started(), other = await started();
  hashAfter(run, 70);
  const gesture = run.newGesture();
  run.command(grab, gesture);
  hashAfter(run, 20);
  run.command({ type: 'release', grab: 0 }, gesture);
  hashAfter(run, 20);
  assert.ok(run.undo());
  assert.equal(run.time, 70);
  assert.equal(run.commands.length, 0);
  assert.equal(hashAfter(run, 30), hashAfter(other, 100));
  assert.equal(run.undo(), false);
});

test('redo comes to the bits that were there before undo, until something else is done', async () => {
  const run = await started(), seen = [];
  for (const particle of [35, 30, 25]) {
    hashAfter(run, 30);
    run.command({ type: 'pin', particle }, run.newGesture());
    seen.push(hashAfter(run, 25));
  }
  for (const left of [2, 1, 0]) {
    assert.ok(run.undo());
    assert.equal(run.commands.length, left);
  }
  // Time that passes is nothing that is done.
  hashAfter(run, 70);
  // To where each undo was asked for: before the next of them, and to the end.
  for (const [count, tick] of [[1, 85], [2, 140], [3, 165]]) {
    assert.ok(run.redo());
    assert.deepEqual([run.commands.length, run.time, run.last], [count, tick, tick]);
  }
  assert.equal(run.world.hash().whole, seen[2]);
  assert.equal(run.redo(), false);
  run.undo();
  run.command({ type: 'pin', particle: 20 }, run.newGesture());
  assert.equal(run.redo(), false);
});

test('redo of a hold that was undone goes to where the run was, and lets go what it holds there', async () => {
  const run = await started();
  hashAfter(run, 40);
  run.command(grab, run.newGesture());
  const whole = hashAfter(run, 30);
  run.undo();
  hashAfter(run, 5);
  assert.ok(run.redo());
  assert.equal(run.time, 70);
  assert.equal(run.world.hash().whole, whole);
  run.step();
  assert.equal(run.world.isHeld(0), false);
});

test('seeking back and forth comes to the bits that were there', async () => {
  const run = await started(), seen = new Map();
  for (let tick = 0; tick < 200; tick++) {
    if (tick === 40) run.command(grab, run.newGesture());
    if (tick === 90) run.command({ type: 'cut_springs', springs: [10, 11] }, run.newGesture());
    seen.set(tick, run.world.hash().whole);
    run.step();
  }
  for (const tick of [41, 150, 0, 91, 40, 199, 60]) {
    run.seek(tick);
    assert.equal(run.time, tick);
    // What is done at a tick follows it.
    if (tick !== 40) assert.equal(run.world.hash().whole, seen.get(tick), `tick ${tick}`);
  }
  assert.equal(run.last, 200);
});

test('a command forgets what would have come later', async () => {
  const run = await started();
  hashAfter(run, 10);
  run.command(pin, run.newGesture());
  hashAfter(run, 90);
  run.seek(5);
  assert.ok(run.isFollowing);
  run.command({ type: 'pin', particle: 30 }, run.newGesture());
  assert.deepEqual(run.commands.map(({ tick, record }) => [tick, record.particle]), [[5, 30]]);
  assert.equal(run.isFollowing, false);
});

test('what cannot be done is refused in words, and is no part of the run', async () => {
  const run = await started(), said = [];
  run.command(pin, run.newGesture());
  assert.throws(() => run.command(pin, run.newGesture()), Refusal);
  assert.equal(run.submit({ type: 'release', grab: 3 }, run.newGesture(), (text) => said.push(text)), false);
  assert.deepEqual([run.commands.length, said], [1, ['hand 3 holds nothing']]);
  assert.throws(() => run.submit(null, 1, () => {}), TypeError);
});

test('who takes over a run lets go what it holds', async () => {
  const run = await started();
  run.command(grab, run.newGesture());
  hashAfter(run, 60);
  run.seek(30);
  assert.ok(run.world.isHeld(0));
  run.command(pin, run.newGesture());
  assert.equal(run.world.isHeld(0), false);
  assert.deepEqual(run.commands.map(({ record }) => record.type), ['grab', 'release', 'pin']);
});

test('states are kept in a number that does not grow with time', async () => {
  const run = await started();
  hashAfter(run, 60 * 125);
  assert.ok(run.kept.length <= 121, String(run.kept.length));
  assert.equal(run.kept[0].time, 0);
  assert.equal(run.every, 120);
});
