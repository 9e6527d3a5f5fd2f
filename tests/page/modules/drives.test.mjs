import assert from 'node:assert/strict';
import test from 'node:test';
import { Drives } from '../../../sandbox/page/web/drives.js';

/** Drives of a run that refuses parts, and what came of them. */
function drives(refused) {
  const done = [], said = [], held = [];
  const run = { world: { joinedKeys: {} }, gesture: 0, newGesture: () => (run.gesture += 1), submit: (record, gesture, say) => {
    if (refused.includes(record.part)) say('it cannot be driven');
    else done.push(record);
    return !refused.includes(record.part);
  } };
  const made = new Drives(run, { d: [[0, 1], [1, 1]] }, [], (text) => said.push(text), (...what) => held.push(what));
  return { made, done, said, held };
}

test('a key whose parts are all refused says so and is not held', () => {
  const { made, done, said, held } = drives([0, 1]);
  made.press('d');
  assert.deepEqual([done, held], [[], []]);
  assert.deepEqual([...new Set(said)], ['it cannot be driven']);
  made.release('d');
  assert.deepEqual(held, []);
});

test('a key that drives one of its parts is held until it is let go', () => {
  const { made, done, held } = drives([1]);
  made.press('d');
  made.release('d');
  assert.deepEqual(done.map(({ value }) => value), [1, 0]);
  assert.deepEqual(held, [['d', true], ['d', false]]);
});
