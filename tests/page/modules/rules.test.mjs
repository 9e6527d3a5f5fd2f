import assert from 'node:assert/strict';
import test from 'node:test';
import { Drives } from '../../../sandbox/page/web/drives.js';
import { fired, outcome } from '../../../sandbox/page/web/rules.js';
import { Run } from '../../../sandbox/page/web/run.js';
import { GIVEN, toy } from './toys.mjs';

const { hashes, outcomes, keys } = GIVEN.rules;

async function started() {
  const [level, fresh] = await toy('rules'), run = new Run(fresh());
  return { run, level };
}

const ended = (world) => {
  const found = outcome(world);
  return found && [found.isWon, found.text, found.stars, found.tick];
};

function play(run, until) {
  while (run.time < until) {
    for (const down of keys[run.time] ?? []) run.command({ type: 'hold_key', key: 0, down }, run.newGesture());
    run.step();
  }
}

test('rules come to the bits and the outcome of the desktop at every tick', async () => {
  const { run } = await started();
  hashes.forEach((hash, k) => {
    play(run, k + 1);
    assert.equal(run.world.hash().whole, hash, `tick ${k + 1}`);
    assert.deepEqual(ended(run.world), outcomes[k], `tick ${k + 1}`);
  });
  assert.notEqual(outcomes.at(-1), null);
});

test('going back in time takes a win back, and it is won again at the same tick', async () => {
  const { run } = await started(), last = hashes.length;
  play(run, last);
  const [, , , won] = outcomes[last - 1];
  for (const tick of [won - 1, 10, won, last - 1, 60, won + 1]) {
    run.seek(tick);
    // Keys of a tick come after it.
    if (!keys[tick]) assert.equal(run.world.hash().whole, hashes[tick - 1], `tick ${tick}`);
    assert.deepEqual(ended(run.world), outcomes[tick - 1]);
  }
});

test('what a rule says is told at the tick at which it fires', async () => {
  const { run } = await started(), said = [];
  for (let tick = 1; tick <= hashes.length; tick++) {
    play(run, tick);
    for (const { say, win } of fired(run.world)) if (say || win) said.push([say ?? win, tick]);
  }
  assert.deepEqual(said.map(([text]) => text), ['Through the ring', 'In!', 'Still']);
  assert.equal(said[1][1], outcomes.at(-1)[3]);
});

test('a key that a rule asks for is held until it is let go', async () => {
  const { run, level } = await started(), drives = new Drives(run, level.keys, level.about.names.key);
  assert.deepEqual(level.about.names.key, ['g']);
  drives.press('g');
  assert.equal(run.world.view('state.key_down')[0], 1);
  drives.releaseAll();
  assert.equal(run.world.view('state.key_down')[0], 0);
});
